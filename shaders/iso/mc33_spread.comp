/* Writes one record a vertex and one a triangle where each will be: one invocation a brick. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/spread.h"
#include "iso/walk.h"
#include "shared/invocation.h"

layout(local_size_x = 32) in;
layout(push_constant, scalar) uniform Push
{
    hewn_mc33_spread_push push;
};

uint asked = 0u;
uint triangle = 0u;
uint centre = 0u;

void visit_cell(uint slot, uint number, uint pattern)
{
    uint head = push.table.at[pattern], place = head & 0xFFFFu;
    if ((head & MC33_DECIDES) != 0u)
        place = push.asked.at[2u * asked++];
    uint record = push.table.at[place];
    uint count = record & 255u, centres = record >> 8, from = record_triangles(place, centres);
    for (uint i = 0u; i < count; i++) {
        push.indices.at[3u * triangle] = slot;
        push.indices.at[3u * triangle + 1u] = number + 512u * half_word(push.table, from, i);
        push.indices.at[3u * triangle + 2u] = centre;
        triangle++;
    }
    for (uint i = 0u; i < centres; i++) {
        push.vertices.at[3u * centre] = slot;
        push.vertices.at[3u * centre + 1u] = number + 512u * half_word(push.table, place + 1u, i);
        centre++;
    }
}

void main()
{
    uint slot = invocation();
    if (slot >= push.count)
        return;
    spread_vertices(push.edges, push.vertices, slot, push.bricks.at[slot], push.vertex_bases.at[slot]);
    asked = push.ranks.at[slot];
    triangle = push.triangle_bases.at[slot];
    centre = push.first + push.centre_bases.at[slot];
    uvec3 cells = uvec3(push.cells[0], push.cells[1], push.cells[2]);
    walk_cells(push.links, push.signs, 8u * unpack_brick(push.bricks.at[slot]), cells, slot);
}
