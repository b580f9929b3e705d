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

/* Writes what is known of a word's cells; returns the number of their loops. */
uint write_loops(uint slot, uint word, uvec4 lower, uvec4 upper, uvec3 first, uint cells)
{
    uint low = 0u, high = 0u, turned = 0u, rest = cells;
    while (rest != 0u) {
        uint bit = uint(findLSB(rest));
        rest &= rest - 1u;
        uint pattern = cell_pattern(lower, upper, bit);
        uvec4 entry = dual_entry(pattern, false);
        /* A loop, since a CPU device jumps over that, but takes all arms of a branch. */
        for (uint face = entry_doubtful_face(entry); face != DUAL_NO_FACE; face = DUAL_NO_FACE) {
            uint number = 32u * word + bit;
            if (is_turned(slot, uvec3(number, number >> 3, number >> 6) & 7u, first, face)) {
                entry = dual_entry(pattern, true);
                turned |= 1u << bit;
            }
        }
        uint further = entry_loops(entry) - 1u;
        low |= (further & 1u) << bit;
        high |= further >> 1 << bit;
    }
    uint at = slot * HEWN_BRICK_DUAL_WORDS + word * HEWN_DUAL_WORDS;
    push.loops.at[at + HEWN_DUAL_CELLS] = cells;
    push.loops.at[at + HEWN_DUAL_LOW] = low;
    push.loops.at[at + HEWN_DUAL_HIGH] = high;
    push.loops.at[at + HEWN_DUAL_TURNED] = turned;
    return uint(bitCount(cells) + bitCount(low) + 2 * bitCount(high));
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
            crossings += write_crossed(push.edges, slot, word, under, over, first, cells);
            uint cut = surface_cells(under, over, below(first, word, cells));
            vertices += write_loops(slot, word, under, over, first, cut);
            ivec3 counts = bitCount(own_quads(under, over, first, word, cells));
            quads += uint(counts.x + counts.y + counts.z);
        }
        lower = upper;
    }
    push.crossing_counts.at[slot] = crossings;
    push.vertex_counts.at[slot] = vertices;
    push.quad_counts.at[slot] = quads;
}
