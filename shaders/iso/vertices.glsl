/* Solves each crossing on the field itself, and takes its normal from the exact gradient there: one invocation for
 * HEWN_VERTICES_EACH of them. */
#include "iso/grid.h"
#include "iso/root_search.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_vertex_push push;
};

float value_along(vec3 start, uint axis, float side, float t)
{
    precise vec3 at = start;
    at[axis] = start[axis] + side * t;
    return field_point(at.x, at.y, at.z);
}

/* Nothing is searched where the root is `known`. */
float crossing(vec3 start, uint axis, float side, float at_start, float at_end, bool known)
{
    Search search = search_begin(start[axis], start[axis] + side, at_start, at_end, known);
    for (uint trial = 0u; trial < MOST_TRIALS && !search.settled; trial++) {
        next_guess(search, trial);
        take_value(search, value_along(start, axis, side, search.guess));
    }
    return search.guess;
}

void write_vertex(uint vertex, vec3 at, vec3 normal)
{
    for (uint i = 0u; i < 3u; i++) {
        push.positions.at[3u * vertex + i] = at[i];
        push.normals.at[3u * vertex + i] = normal[i];
    }
}

/* A crossing's vertex; the residual grows, or the number of vertices that were cut off at the bounds. */
void solve(uint vertex, inout float most, inout uint caps)
{
    uint brick = floatBitsToUint(push.positions.at[3u * vertex]);
    uint record = floatBitsToUint(push.positions.at[3u * vertex + 1u]);
    uint axis = record >> 9;
    uvec3 first = 8u * unpack_brick(brick) + (uvec3(record, record >> 3, record >> 6) & 7u);
    vec3 start;
    for (uint i = 0u; i < 3u; i++)
        start[i] = sample_coordinate(push.grid, i, first[i]);
    float end = sample_coordinate(push.grid, axis, first[axis] + 1u);
    precise float side = end - start[axis];
    float at_start = value_along(start, axis, side, 0.0);
    precise vec3 last = start;
    last[axis] = end;
    float at_end = field_point(last.x, last.y, last.z);
    bool closed = push.grid.open == 0u;
    bool cap_start = closed && first[axis] == 0u && at_start < 0.0;
    bool cap_end = closed && first[axis] + 1u == push.grid.cells[axis] && at_end < 0.0;
    bool capped = cap_start || cap_end;
    vec3 outward = vec3(0.0);
    outward[axis] = cap_start || (!cap_end && at_end < 0.0) ? -1.0 : 1.0;
    float least = push.dual != 0u ? 0.0 : NEAREST;
    float t = clamp(crossing(start, axis, side, at_start, at_end, capped), least, 1.0 - least);
    precise vec3 at = start;
    at[axis] = capped ? (cap_start ? start[axis] : end) : start[axis] + side * t;
    vec4 gradient = field_gradient(at.x, at.y, at.z);
    float size = length(gradient.xyz);
    bool sloped = !capped && finite(size) && size > 0.0;
    /* Dual methods ask for the tangent plane, not for the place on the edge: what the search left is taken off. */
    float off = gradient.w / size;
    if (push.dual != 0u && sloped && abs(off) <= push.grid.cell * CORRECTED)
        at -= off * (gradient.xyz / size);
    /* Written in one place: a CPU driver runs each write for all lanes, and writing costs more than most fields. */
    write_vertex(vertex, at, sloped ? gradient.xyz / size : outward);
    float residual = sloped ? abs(gradient.w) / (size * push.grid.cell) : 0.0;
    most = finite(residual) ? max(most, residual) : most;
    caps += capped ? 1u : 0u;
}

void main()
{
    uint local = gl_LocalInvocationID.x, begin = HEWN_VERTICES_EACH * (invocation() - local) + local;
    float most = 0.0;
    uint caps = 0u;
    for (uint i = 0u; i < HEWN_VERTICES_EACH; i++) {
        uint vertex = begin + gl_WorkGroupSize.x * i;
        if (vertex < push.count)
            solve(vertex, most, caps);
    }
    if (caps != 0u)
        atomicAdd(push.summary.at[HEWN_SUMMARY_CAPS], caps);
    if (floatBitsToUint(most) > push.summary.at[HEWN_SUMMARY_RESIDUAL])
        atomicMax(push.summary.at[HEWN_SUMMARY_RESIDUAL], floatBitsToUint(most));
}
