/* Writes one record a vertex and one a triangle where each will be, so that the kernels that do the work have one invocation for each.
 * One invocation a brick. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/spread.h"
#include "iso/table.h"
#include "shared/invocation.h"

layout(local_size_x = 32) in;
layout(push_constant, scalar) uniform Push
{
    hewn_spread_push push;
};

/* One record a triangle of the cells at `cut`; returns the next triangle's number. */
uint spread_cells(uint slot, uint word, uvec4 lower, uvec4 upper, uint cut, uint triangle)
{
    while (cut != 0u) {
        uint bit = uint(findLSB(cut));
        cut &= cut - 1u;
        uint pattern = cell_pattern(lower, upper, bit);
        uint count = table[pattern].x;
        uint record = 32u * word + bit + 512u * pattern;
        for (uint i = 0u; i < count; i++) {
            push.indices.at[3u * triangle] = slot;
            push.indices.at[3u * triangle + 1u] = record + 131072u * i;
            triangle++;
        }
    }
    return triangle;
}

void spread_triangles(uint slot)
{
    uvec3 base = 8u * unpack_brick(push.bricks.at[slot]);
    uvec3 cells = uvec3(push.cells[0], push.cells[1], push.cells[2]);
    uint link = slot * HEWN_BRICK_LINKS;
    uvec4 slots = lower_slots(push.links, link);
    Layer lower = load_layer(push.signs, slots, 0u);
    uint triangle = push.triangle_bases.at[slot];
    for (uint z = 0u; z < 8u; z++) {
        Layer upper = load_layer_above(push.signs, push.links, link, slots, z);
        for (uint half_of = 0u; half_of < 2u; half_of++) {
            uvec4 under = lower.rows[half_of], over = upper.rows[half_of];
            uint word = 2u * z + half_of;
            uint cut = surface_cells(under, over, below(base, word, cells));
            triangle = spread_cells(slot, word, under, over, cut, triangle);
        }
        lower = upper;
    }
}

void main()
{
    uint slot = invocation();
    if (slot >= push.count)
        return;
    spread_vertices(push.edges, push.vertices, slot, push.bricks.at[slot], push.vertex_bases.at[slot]);
    spread_triangles(slot);
}
