/* Counts what each brick will emit where values have decided: one invocation a brick. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/walk.h"
#include "shared/invocation.h"

layout(local_size_x = 32) in;
layout(push_constant, scalar) uniform Push
{
    hewn_mc33_count_push push;
};

uint asked = 0u;
uint triangles = 0u;
uint centres = 0u;

void visit_cell(uint slot, uint number, uint pattern)
{
    uint head = push.table.at[pattern], place = head & 0xFFFFu;
    if ((head & MC33_DECIDES) != 0u)
        place = push.asked.at[2u * asked++];
    uint record = push.table.at[place];
    triangles += record & 255u;
    centres += record >> 8;
}

void main()
{
    uint slot = invocation();
    if (slot >= push.count)
        return;
    asked = push.ranks.at[slot];
    uvec3 cells = uvec3(push.cells[0], push.cells[1], push.cells[2]);
    walk_cells(push.links, push.signs, 8u * unpack_brick(push.bricks.at[slot]), cells, slot);
    push.triangle_counts.at[slot] = triangles;
    push.centre_counts.at[slot] = centres;
}
