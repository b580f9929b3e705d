/* Finds the crossed edges, the loops of each cell, and how much each brick will emit: one invocation a brick. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/crossed.h"
#include "iso/dual_loops.h"
#include "iso/dual_table.h"
#include "iso/dual_quad_masks.h"
#include "shared/invocation.h"

layout(local_size_x = 32) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_classify_push push;
};

uint doubts = 0u; /* words with cells whose doubtful face may have to be turned */

/* Whether a cell's doubtful face is doubtful in the cell beyond it too. That cell has surface, so that its brick is
 * active, or it is not in the grid. */
bool is_turned(uint slot, uvec3 at, uvec3 first, uint face)
{
    uint axis = face >> 1, brick = slot;
    bool up = (face & 1u) != 0u;
    uint limit = up ? push.cells[axis] - 1u : 0u;
    if (first[axis] + at[axis] == limit)
        return false;
    if (!up && at[axis] == 0u) {
        brick = push.lower.at[3u * slot + axis];
        at[axis] = 8u;
    }
    if (brick >= HEWN_ALL_OUTSIDE)
        return false;
    at[axis] += up ? 1u : ~0u;
    uint beyond = load_pattern(push.links, push.signs, brick, at);
    return entry_doubtful_face(dual_entry(beyond, false)) == (face ^ 1u);
}

/* Writes what is known of a word's cells, with those in doubt in the place of the turned ones; returns the number of their
 * loops. */
uint write_loops(uint slot, uint word, uvec4 lower, uvec4 upper, uint cells)
{
    uint low = 0u, high = 0u, doubtful = 0u, rest = cells;
    while (rest != 0u) {
        uint bit = uint(findLSB(rest));
        rest &= rest - 1u;
        uvec3 entry = dual_entry(cell_pattern(lower, upper, bit), false);
        uint further = entry_loops(entry) - 1u;
        low |= (further & 1u) << bit;
        high |= further >> 1 << bit;
        doubtful |= entry_doubtful_face(entry) != DUAL_NO_FACE ? 1u << bit : 0u;
    }
    uint at = slot * HEWN_BRICK_DUAL_WORDS + word * HEWN_DUAL_WORDS;
    push.loops.at[at + HEWN_DUAL_CELLS] = cells;
    push.loops.at[at + HEWN_DUAL_LOW] = low;
    push.loops.at[at + HEWN_DUAL_HIGH] = high;
    push.loops.at[at + HEWN_DUAL_TURNED] = doubtful;
    doubts |= doubtful != 0u ? 1u << word : 0u;
    return uint(bitCount(cells) + bitCount(low) + 2 * bitCount(high));
}

/* Settles the cells in doubt: a turned face makes two loops of their one. Returns how many were turned. It stands after
 * the walk, and is one loop through words and cells, because a CPU device runs the body of a loop at least once. */
uint settle_doubts(uint slot, uvec3 first)
{
    uint word = 0u, mask = 0u, count = 0u;
    while (doubts != 0u || mask != 0u) {
        if (mask == 0u) {
            word = uint(findLSB(doubts));
            doubts &= doubts - 1u;
            mask = push.loops.at[slot * HEWN_BRICK_DUAL_WORDS + word * HEWN_DUAL_WORDS + HEWN_DUAL_TURNED];
        }
        uint at = slot * HEWN_BRICK_DUAL_WORDS + word * HEWN_DUAL_WORDS;
        uint bit = uint(findLSB(mask)), number = 32u * word + bit;
        mask &= mask - 1u;
        uvec3 cell = uvec3(number, number >> 3, number >> 6) & 7u;
        uint face = entry_doubtful_face(dual_entry(load_pattern(push.links, push.signs, slot, cell), false));
        if (is_turned(slot, cell, first, face)) {
            push.loops.at[at + HEWN_DUAL_LOW] |= 1u << bit;
            count++;
        } else {
            push.loops.at[at + HEWN_DUAL_TURNED] &= ~(1u << bit);
        }
    }
    return count;
}

void main()
{
    uint slot = invocation();
    if (slot >= push.count)
        return;
    uvec3 first = 8u * unpack_brick(push.bricks.at[slot]);
    uvec3 cells = uvec3(push.cells[0], push.cells[1], push.cells[2]);
    uint link = slot * HEWN_BRICK_LINKS;
    uvec4 slots = lower_slots(push.links, link);
    Layer lower = load_layer(push.signs, slots, 0u);
    uint crossings = 0u, vertices = 0u, quads = 0u;
    for (uint z = 0u; z < 8u; z++) {
        Layer upper = load_layer_above(push.signs, push.links, link, slots, z);
        for (uint half_of = 0u; half_of < 2u; half_of++) {
            uint word = 2u * z + half_of;
            uvec4 under = lower.rows[half_of], over = upper.rows[half_of];
            uvec3 exist = below_each(first, word, cells), inner = below_each(first, word, cells - 1u);
            crossings += write_crossed(push.edges, slot, word, under, over, exist);
            uint cut = surface_cells(under, over, exist.x & exist.y & exist.z);
            vertices += write_loops(slot, word, under, over, cut);
            ivec3 counts = bitCount(own_quads(under, over, exist, inner));
            quads += uint(counts.x + counts.y + counts.z);
        }
        lower = upper;
    }
    push.crossing_counts.at[slot] = crossings;
    push.vertex_counts.at[slot] = vertices + settle_doubts(slot, first);
    push.quad_counts.at[slot] = quads;
}
