/* Solves each crossing on the field itself, and takes its normal from the exact gradient there: one invocation for
 * HEWN_VERTICES_EACH of them. */
#include "iso/grid.h"
#include "iso/root_search.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_vertex_push push;
};

/* Nothing is searched where the root is `known`. */
float crossing(float start, float side, float at_start, float at_end, bool known)
{
    Search search = search_begin(start, start + side, at_start, at_end, known);
    for (uint trial = 0u; trial < MOST_TRIALS && !search.settled; trial++) {
        next_guess(search, trial);
        precise float at = start + side * search.guess;
        take_value(search, field_along(at));
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

/* Coordinates of bricks do not fit the short form. */
bool long_bricks;

/* A crossing's vertex; the residual grows, or the number of vertices that were cut off at the bounds. */
void solve(uint vertex, inout float most, inout uint caps)
{
    uint record = floatBitsToUint(push.positions.at[3u * vertex + 1u]), axis = record >> 9 & 3u;
    uvec3 brick = unpack_short_brick(record >> 11);
    /* A loop, since a CPU device jumps back and never ahead, and reading a word costs as much as evaluating a field. */
    for (bool more = long_bricks; more; more = false)
        brick = unpack_brick(floatBitsToUint(push.positions.at[3u * vertex]));
    uvec3 first = 8u * brick + (uvec3(record, record >> 3, record >> 6) & 7u);
    /* All ends, since a number that is picked by the axis would be read lane by lane. */
    vec3 start, ends;
    bvec3 last;
    for (uint i = 0u; i < 3u; i++) {
        start[i] = sample_coordinate(push.grid, i, first[i]);
        ends[i] = sample_coordinate(push.grid, i, first[i] + 1u);
        last[i] = first[i] + 1u == push.grid.cells[i];
    }
    float end = ends[axis];
    precise float side = end - start[axis];
    field_stand(start, axis);
    float at_start = field_along(start[axis]), at_end = field_along(end);
    bool closed = push.grid.open == 0u;
    bool cap_start = closed && first[axis] == 0u && at_start < 0.0;
    bool cap_end = closed && last[axis] && at_end < 0.0;
    bool capped = cap_start || cap_end;
    vec3 outward = vec3(0.0);
    outward[axis] = cap_start || (!cap_end && at_end < 0.0) ? -1.0 : 1.0;
    float least = push.dual != 0u ? 0.0 : NEAREST;
    float t = clamp(crossing(start[axis], side, at_start, at_end, capped), least, 1.0 - least);
    precise vec3 at = start;
    at[axis] = capped ? (cap_start ? start[axis] : end) : start[axis] + side * t;
    vec4 gradient = field_slope_along(at[axis]);
    float size = length(gradient.xyz);
    bool sloped = !capped && finite(size) && size > 0.0;
    /* Dual methods ask for the tangent plane, not for the place on the edge: what the search left is taken off. */
    float off = gradient.w / size;
    if (push.dual != 0u && sloped && abs(off) <= push.grid.cell * CORRECTED)
        at -= off * (gradient.xyz / size);
    /* Written in one place: a CPU driver runs each write for all lanes, and writing costs more than most fields. */
    write_vertex(vertex, at, plain_zeros(sloped ? gradient.xyz / size : outward));
    float residual = sloped ? abs(gradient.w) / (size * push.grid.cell) : 0.0;
    most = finite(residual) ? max(most, residual) : most;
    caps += capped ? 1u : 0u;
}

void main()
{
    uint local = gl_LocalInvocationID.x, begin = HEWN_VERTICES_EACH * (invocation() - local) + local;
    float most = 0.0;
    uint caps = 0u;
    uint longest = max(max(push.grid.cells[0], push.grid.cells[1]), push.grid.cells[2]);
    long_bricks = longest + push.grid.open > HEWN_SHORT_SAMPLES; /* an open grid's last samples are in bricks too */
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
