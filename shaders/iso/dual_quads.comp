/* Turns the record of each quad into two triangles, cut along the better diagonal: one invocation a quad. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/dual_loops.h"
#include "iso/dual_record.h"
#include "iso/grid.h"
#include "iso/quad.h"
#include "shared/invocation.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_quad_push push;
};

/* The vertex of the loop that passes an edge of a cell. */
uint loop_vertex(uint slot, uvec3 at, uint edge)
{
    uint number = sample_number(at), bit = number & 31u, before = (1u << bit) - 1u;
    uint words = loop_words(owner_slot(push.links, slot, at), number);
    uint cells = push.loops.at[words + HEWN_DUAL_CELLS], low = push.loops.at[words + HEWN_DUAL_LOW];
    uint high = push.loops.at[words + HEWN_DUAL_HIGH];
    uint vertex = push.loops.at[words + HEWN_DUAL_FIRST];
    vertex += uint(bitCount(cells & before) + bitCount(low & before) + 2 * bitCount(high & before));
    uint last = vertex + (low >> bit & 1u) + 2u * (high >> bit & 1u);
    while (vertex < last && (push.passed.at[vertex] >> edge & 1u) == 0u)
        vertex++;
    return vertex;
}

/* The edge along `axis` of the cell at `at` that is far along both other axes is the quad's; its vertices in order. */
void load_corners(uint slot, uvec3 at, uint axis, bool inside, out uint corners[4], out uvec3 start)
{
    uint u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
    uvec3 step_u = uvec3(0u), step_v = uvec3(0u);
    step_u[u] = 1u;
    step_v[v] = 1u;
    start = at + step_u + step_v;
    for (uint i = 0u; i < 4u; i++) {
        /* (axis, u, v) is right-handed: from u to v is counter-clockwise seen from the edge's end, which is outside
         * where the edge starts inside. */
        bool one = i == 1u || i == 2u, other = i >= 2u;
        bool at_u = inside ? one : other, at_v = inside ? other : one;
        uvec3 cell = at + (at_u ? step_u : uvec3(0u)) + (at_v ? step_v : uvec3(0u));
        uint bit_u = at_u ? 0u : 1u, bit_v = at_v ? 0u : 1u; /* where the edge is in that cell */
        corners[i] = loop_vertex(slot, cell, 4u * axis + (u < v ? bit_u | bit_v << 1 : bit_v | bit_u << 1));
    }
}

void main()
{
    uint quad = invocation();
    if (quad >= push.count)
        return;
    uint slot = push.indices.at[6u * quad], record = push.indices.at[6u * quad + 1u];
    uvec3 at = uvec3(record, record >> 3, record >> 6) & 7u;
    uint axis = record >> 9 & 3u, corners[4];
    uvec3 start;
    load_corners(slot, at, axis, record >> 11 != 0u, corners, start);
    uint crossing = edge_vertex(push.links, push.edges, slot, at, 4u * axis + 3u);
    start += 8u * unpack_brick(push.bricks.at[slot]);
    vec3 places[4], low;
    for (uint i = 0u; i < 4u; i++)
        places[i] = load_vector(push.positions, corners[i]);
    for (uint i = 0u; i < 3u; i++)
        low[i] = sample_coordinate(push.grid, i, start[i]);
    float high = sample_coordinate(push.grid, axis, start[axis] + 1u);
    float surface = push.points.at[3u * crossing + axis];
    uint cut = quad_cut(places, low, high, surface, axis), turn = cut & 1u;
    bool fan = push.keep == HEWN_KEEP_FANS && (cut & QUAD_FAN) != 0u;
    if (push.keep != HEWN_KEEP_NONE)
        push.crossings.at[quad] = fan || push.keep == HEWN_KEEP_ALL ? crossing : HEWN_NO_FAN;
    if (fan) {
        low[axis] = fan_height(low[axis], high, surface);
        for (uint i = 0u; i < 3u; i++)
            push.points.at[3u * crossing + i] = low[i];
    }
    const uint order[6] = uint[6](0u, 1u, 2u, 0u, 2u, 3u);
    for (uint i = 0u; i < 6u; i++)
        push.indices.at[6u * quad + i] = corners[order[i] + turn & 3u];
}
