#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
/* Solves problems of their own for test_qef.c: one invocation a problem. */
#include "iso/qef.h"
#include "shared/types.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    uint count;
    uint stride;
    Floats problems; /* low and high corner of the box, crossings and planes as counts, then point and normal of each */
    Floats results;  /* the point, the rank, the free direction */
};

vec3 triple(uint at)
{
    return vec3(problems.at[at], problems.at[at + 1u], problems.at[at + 2u]);
}

void main()
{
    uint problem = gl_GlobalInvocationID.x;
    if (problem >= count)
        return;
    uint at = problem * stride;
    vec3 lo = triple(at), hi = triple(at + 3u);
    uint crossings = floatBitsToUint(problems.at[at + 6u]), planes = floatBitsToUint(problems.at[at + 7u]);
    qef_begin();
    for (uint i = 0u; i < planes; i++) {
        vec3 point = triple(at + 8u + 6u * i), normal = triple(at + 11u + 6u * i);
        if (i < crossings)
            qef_add_crossing(point, normal);
        else
            qef_add_plane(point, normal);
    }
    Qef solved = qef_solve(lo, hi);
    for (uint i = 0u; i < 3u; i++) {
        results.at[7u * problem + i] = solved.at[i];
        results.at[7u * problem + 4u + i] = solved.free[i];
    }
    results.at[7u * problem + 3u] = float(solved.rank);
}
