/* Counts the cells whose values decide how they are cut, or lists them: one invocation a brick. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/walk.h"
#include "shared/invocation.h"

layout(local_size_x = 32) in;
layout(push_constant, scalar) uniform Push
{
    hewn_mc33_ask_push push;
};

uint at = 0u;

void visit_cell(uint slot, uint number, uint pattern)
{
    if ((push.table.at[pattern] & MC33_DECIDES) == 0u)
        return;
    if (push.lists != 0u) {
        push.asked.at[2u * at] = slot;
        push.asked.at[2u * at + 1u] = number + 512u * pattern;
    }
    at++;
}

void main()
{
    uint slot = invocation();
    if (slot >= push.count)
        return;
    if (push.lists != 0u)
        at = push.ranks.at[slot];
    uvec3 cells = uvec3(push.cells[0], push.cells[1], push.cells[2]);
    walk_cells(push.links, push.signs, 8u * unpack_brick(push.bricks.at[slot]), cells, slot);
    if (push.lists == 0u)
        push.ranks.at[slot] = at;
}
