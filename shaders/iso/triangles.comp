/* Turns the record of each triangle into its three vertex indices: one invocation a triangle. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/brick.h"
#include "iso/table.h"
#include "shared/invocation.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_triangle_push push;
};

/* The vertex on an edge of the cell at `sample_at`: the brick that owns the edge knows its rank. */
uint edge_vertex(uint slot, uvec3 sample_at, uint edge)
{
    uint axis = edge >> 2;
    uint low = edge & 1u, high = edge >> 1 & 1u;
    uvec3 at = sample_at;
    at += axis == 0u ? uvec3(0u, low, high) : axis == 1u ? uvec3(low, 0u, high) : uvec3(low, high, 0u);
    uvec3 beyond = at >> 3;
    uint link = beyond.x | beyond.y << 1 | beyond.z << 2;
    uint owner = slot;
    if (link != 0u)
        owner = push.links.at[slot * HEWN_BRICK_LINKS + link];
    at &= 7u;
    uint number = at.x | at.y << 3 | at.z << 6;
    uint pair = 2u * (owner * HEWN_BRICK_EDGE_WORDS + axis * HEWN_BRICK_WORDS + (number >> 5));
    uint before = push.edges.at[pair] & ((1u << (number & 31u)) - 1u);
    return push.edges.at[pair + 1u] + uint(bitCount(before));
}

void main()
{
    uint triangle = invocation();
    if (triangle >= push.count)
        return;
    uint slot = push.indices.at[3u * triangle];
    uint record = push.indices.at[3u * triangle + 1u];
    uint number = record & 511u, pattern = record >> 9 & 255u, which = record >> 17;
    uvec3 sample_at = uvec3(number, number >> 3, number >> 6) & 7u;
    uint edges = triangle_edges(table[pattern], which);
    for (uint corner = 0u; corner < 3u; corner++)
        push.indices.at[3u * triangle + corner] = edge_vertex(slot, sample_at, edges >> 4u * corner & 15u);
}
