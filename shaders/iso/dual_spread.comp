/* Writes one record a crossing, a vertex and a quad where each will be: one invocation a brick. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/dual_quad_masks.h"
#include "iso/dual_table.h"
#include "iso/spread.h"
#include "shared/invocation.h"

layout(local_size_x = 32) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_spread_push push;
};

/* The vertices of a word's cells; returns the next vertex's number. */
uint spread_loops(uint slot, uint word, uvec4 lower, uvec4 upper, uint vertex)
{
    uint at = slot * HEWN_BRICK_DUAL_WORDS + word * HEWN_DUAL_WORDS;
    uint cells = push.loops.at[at + HEWN_DUAL_CELLS], turned = push.loops.at[at + HEWN_DUAL_TURNED];
    push.loops.at[at + HEWN_DUAL_FIRST] = vertex;
    while (cells != 0u) {
        uint bit = uint(findLSB(cells));
        cells &= cells - 1u;
        uvec3 entry = dual_entry(cell_pattern(lower, upper, bit), (turned >> bit & 1u) != 0u);
        uint number = 32u * word + bit, count = entry_loops(entry);
        for (uint loop = 0u; loop < count; loop++) {
            push.positions.at[3u * vertex] = slot;
            push.positions.at[3u * vertex + 1u] = number + 512u * entry_loop_edges(entry, loop);
            push.positions.at[3u * vertex + 2u] = count;
            push.passed.at[vertex] = entry_loop_edges(entry, loop);
            vertex++;
        }
    }
    return vertex;
}

/* `inside`: signs of the samples where the edges start. */
uint spread_quads(uint slot, uint word, uint axis, uint mask, uint inside, uint quad)
{
    while (mask != 0u) {
        push.indices.at[6u * quad] = slot;
        uint bit = uint(findLSB(mask));
        push.indices.at[6u * quad + 1u] = 32u * word + bit + 512u * axis + 2048u * (inside >> bit & 1u);
        mask &= mask - 1u;
        quad++;
    }
    return quad;
}

void main()
{
    uint slot = invocation();
    if (slot >= push.count)
        return;
    spread_vertices(push.edges, push.points, slot, push.bricks.at[slot], push.crossing_bases.at[slot]);
    uvec3 first = 8u * unpack_brick(push.bricks.at[slot]);
    uvec3 cells = uvec3(push.cells[0], push.cells[1], push.cells[2]);
    uint link = slot * HEWN_BRICK_LINKS;
    uvec4 slots = lower_slots(push.links, link);
    Layer lower = load_layer(push.signs, slots, 0u);
    uint vertex = push.vertex_bases.at[slot], quad = push.quad_bases.at[slot];
    for (uint z = 0u; z < 8u; z++) {
        Layer upper = load_layer_above(push.signs, push.links, link, slots, z);
        for (uint half_of = 0u; half_of < 2u; half_of++) {
            uint word = 2u * z + half_of;
            uvec4 under = lower.rows[half_of], over = upper.rows[half_of];
            vertex = spread_loops(slot, word, under, over, vertex);
            uvec3 exist = below_each(first, word, cells), inner = below_each(first, word, cells - 1u);
            uvec3 masks = own_quads(under, over, exist, inner), inside = uvec3(over.zy, under.w);
            for (uint axis = 0u; axis < 3u; axis++)
                quad = spread_quads(slot, word, axis, masks[axis], inside[axis], quad);
        }
        lower = upper;
    }
}
