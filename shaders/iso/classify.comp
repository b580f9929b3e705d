/* Counts what each active brick will emit, and which edges are crossed: one invocation a brick. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/crossed.h"
#include "iso/table.h"
#include "shared/invocation.h"

layout(local_size_x = 32) in;
layout(push_constant, scalar) uniform Push
{
    hewn_classify_push push;
};

uint count_triangles(uvec4 lower, uvec4 upper, uint cut)
{
    uint count = 0u;
    while (cut != 0u) {
        uint bit = uint(findLSB(cut));
        cut &= cut - 1u;
        count += table[cell_pattern(lower, upper, bit)].x;
    }
    return count;
}

void main()
{
    uint slot = invocation();
    if (slot >= push.count)
        return;
    uvec3 base = 8u * unpack_brick(push.bricks.at[slot]);
    uvec3 cells = uvec3(push.cells[0], push.cells[1], push.cells[2]);
    uint link = slot * HEWN_BRICK_LINKS;
    uvec4 slots = lower_slots(push.links, link);
    Layer lower = load_layer(push.signs, slots, 0u);
    uint triangle_count = 0u;
    uint crossings = 0u;
    for (uint z = 0u; z < 8u; z++) {
        Layer upper = load_layer_above(push.signs, push.links, link, slots, z);
        for (uint half_of = 0u; half_of < 2u; half_of++) {
            uint word = 2u * z + half_of;
            uvec4 under = lower.rows[half_of], over = upper.rows[half_of];
            uvec3 exist = below_each(base, word, cells);
            crossings += write_crossed(push.edges, slot, word, under, over, exist);
            triangle_count += count_triangles(under, over, surface_cells(under, over, exist.x & exist.y & exist.z));
        }
        lower = upper;
    }
    push.vertex_counts.at[slot] = crossings;
    push.triangle_counts.at[slot] = triangle_count;
}
