/* Turns quads that no diagonal cuts without leaving their envelope into fans around a point of their grid edge: four
 * triangles, two in the place of the quad's and two behind those of all quads. One invocation a quad, run twice: first
 * it marks those quads, and when the marks are summed it makes the fans. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "shared/iso.h"
#include "shared/invocation.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_fan_push push;
};

void write_triangle(uint triangle, uint tip, uint first, uint second)
{
    push.indices.at[3u * triangle] = tip;
    push.indices.at[3u * triangle + 1u] = first;
    push.indices.at[3u * triangle + 2u] = second;
}

void main()
{
    uint quad = invocation();
    if (quad >= push.count)
        return;
    uint crossing = push.crossings.at[quad];
    bool fan = crossing != HEWN_NO_FAN;
    if (push.makes == 0u)
        push.ranks.at[quad] = fan ? 1u : 0u;
    if (push.makes == 0u || !fan)
        return;
    uint rank = push.ranks.at[quad], tip = push.vertices + rank, more = 2u * (push.count + rank);
    uint corners[4] = uint[4](push.indices.at[6u * quad], push.indices.at[6u * quad + 1u], push.indices.at[6u * quad + 2u],
                              push.indices.at[6u * quad + 5u]);
    for (uint i = 0u; i < 3u; i++) {
        push.positions.at[3u * tip + i] = push.points.at[3u * crossing + i];
        push.normals.at[3u * tip + i] = push.point_normals.at[3u * crossing + i];
    }
    write_triangle(2u * quad, tip, corners[0], corners[1]);
    write_triangle(2u * quad + 1u, tip, corners[1], corners[2]);
    write_triangle(more, tip, corners[2], corners[3]);
    write_triangle(more + 1u, tip, corners[3], corners[0]);
}
