/* Turns the record of each quad into two triangles, cut along the better diagonal: one invocation a quad. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/dual_loops.h"
#include "iso/dual_record.h"
#include "iso/dual_table.h"
#include "shared/invocation.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_quad_push push;
};

/* The vertex of the loop that passes an edge of a cell. */
uint loop_vertex(uint slot, uvec3 at, uint edge)
{
    uint owner = owner_slot(push.links, slot, at), number = sample_number(at), bit = number & 31u;
    uint words = loop_words(owner, number), before = (1u << bit) - 1u;
    uint cells = push.loops.at[words + HEWN_DUAL_CELLS], low = push.loops.at[words + HEWN_DUAL_LOW];
    uint high = push.loops.at[words + HEWN_DUAL_HIGH];
    uint vertex = push.loops.at[words + HEWN_DUAL_FIRST];
    vertex += uint(bitCount(cells & before) + bitCount(low & before) + 2 * bitCount(high & before));
    /* Few cells have several loops; a loop, since a CPU device jumps over that, but takes all arms of a branch. */
    for (uint several = (low | high) >> bit & 1u; several != 0u; several = 0u) {
        bool turned = (push.loops.at[words + HEWN_DUAL_TURNED] >> bit & 1u) != 0u;
        uint pattern = load_pattern(push.links, push.signs, owner, at & 7u);
        vertex += entry_edge_loop(dual_entry(pattern, turned), edge);
    }
    return vertex;
}

/* Whether corners 1 and 3 are nearer to each other than 0 and 2. */
bool cut_other_way(uint corners[4])
{
    vec3 one = load_vector(push.positions, corners[2]) - load_vector(push.positions, corners[0]);
    vec3 other = load_vector(push.positions, corners[3]) - load_vector(push.positions, corners[1]);
    precise float length_one = dot(one, one), length_other = dot(other, other);
    return length_other < length_one;
}

void main()
{
    uint quad = invocation();
    if (quad >= push.count)
        return;
    uint slot = push.indices.at[6u * quad], record = push.indices.at[6u * quad + 1u];
    uvec3 at = uvec3(record, record >> 3, record >> 6) & 7u;
    uint axis = record >> 9, u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
    uvec3 step_u = uvec3(0u), step_v = uvec3(0u), along = uvec3(0u);
    step_u[u] = 1u;
    step_v[v] = 1u;
    along[axis] = 1u;
    /* (axis, u, v) is right-handed: around the edge from u to v is counter-clockwise seen from its end. */
    uint corners[4];
    bool low_u = u < v;
    for (uint i = 0u; i < 4u; i++) {
        bool at_u = i == 1u || i == 2u, at_v = i >= 2u;
        uvec3 cell = at + (at_u ? step_u : uvec3(0u)) + (at_v ? step_v : uvec3(0u));
        /* Where the edge is in that cell: far along those axes that the cell did not step along. */
        uint bit_u = at_u ? 0u : 1u, bit_v = at_v ? 0u : 1u;
        corners[i] = loop_vertex(slot, cell, 4u * axis + (low_u ? bit_u | bit_v << 1 : bit_v | bit_u << 1));
    }
    uvec3 start = at + step_u + step_v;
    uint number = sample_number(start);
    uint word = sign_word(push.signs, owner_slot(push.links, slot, start), number >> 5);
    /* Seen from outside: from the edge's end where it starts inside, else from its start. */
    if ((word >> (number & 31u) & 1u) == 0u) {
        uint swapped = corners[1];
        corners[1] = corners[3];
        corners[3] = swapped;
    }
    if (push.named != 0u)
        push.crossings.at[quad] = edge_vertex(push.links, push.edges, slot, at, 4u * axis + 3u);
    uint turn = cut_other_way(corners) ? 1u : 0u;
    const uint order[6] = uint[6](0u, 1u, 2u, 0u, 2u, 3u);
    for (uint i = 0u; i < 6u; i++)
        push.indices.at[6u * quad + i] = corners[order[i] + turn & 3u];
}
