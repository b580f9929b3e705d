/* Turns the record of each triangle into its three vertex indices: one invocation a triangle. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/edge_vertex.h"
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
    uint centres = push.indices.at[3u * triangle + 2u];
    uvec3 sample_at = uvec3(record, record >> 3, record >> 6) & 7u;
    for (uint i = 0u; i < 3u; i++) {
        uint corner = record >> 9u + 4u * i & 15u;
        uint vertex = centres + corner - 12u;
        if (corner < 12u)
            vertex = edge_vertex(push.links, push.edges, slot, sample_at, corner);
        push.indices.at[3u * triangle + i] = vertex;
    }
}
