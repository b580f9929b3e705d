/* Turns the record of each triangle into its three vertex indices: one invocation a triangle. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/edge_vertex.h"
#include "iso/table.h"
#include "shared/invocation.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_triangle_push push;
};

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
        push.indices.at[3u * triangle + corner] = edge_vertex(push.links, push.edges, slot, sample_at, edges >> 4u * corner & 15u);
}
