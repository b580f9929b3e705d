/* Solves each crossing on the field itself, and takes its normal from the exact gradient there: one invocation a vertex. */
#include "iso/grid.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_vertex_push push;
};

/* No vertex comes nearer to a grid point than this share of a cell, so that no two of them fall together. */
const float NEAREST = 1.25 / 4096.0;
/* A value that the edge's mean slope takes back in this share of a cell ends the search. */
const float NEAR_ENOUGH = 1.0e-5;
const uint MOST_TRIALS = 24u;
const float CORRECTED = 1.0e-3; /* of a cell: a place that is farther off than this lies on no surface */

float value_along(vec3 start, uint axis, float side, float t)
{
    precise vec3 at = start;
    at[axis] = start[axis] + side * t;
    return field_point(at.x, at.y, at.z);
}

bool finite(float value)
{
    return abs(value) <= 3.0e38;
}

/* Where the field changes sign along the edge, as a share of it. False position with the Illinois weight (Dowell and Jarratt 1971),
 * halving where the values give no better guess; the bracket always holds an inside end and an outside end. Where it is
 * `known`, nothing is searched. */
float crossing(vec3 start, uint axis, float side, float at_start, float at_end, bool known)
{
    float a = 0.0, b = 1.0, fa = at_start, fb = at_end, guess = 0.5;
    float enough = NEAR_ENOUGH * abs(at_end - at_start);
    bool start_inside = at_start < 0.0;
    int kept = 0;
    for (uint trial = 0u; trial < MOST_TRIALS && !known; trial++) {
        float slope = fb - fa;
        guess = a - fa * (b - a) / slope;
        if (!(finite(slope) && guess > a && guess < b) || trial > 8u)
            guess = 0.5 * (a + b);
        float value = value_along(start, axis, side, guess);
        if (abs(value) <= enough || b - a < 2.0e-6)
            break;
        if ((value < 0.0) == start_inside) {
            a = guess;
            fa = value;
            fb = kept == 1 ? 0.5 * fb : fb;
            kept = 1;
        } else {
            b = guess;
            fb = value;
            fa = kept == 2 ? 0.5 * fa : fa;
            kept = 2;
        }
    }
    return guess;
}

void write_vertex(uint vertex, vec3 at, vec3 normal)
{
    for (uint i = 0u; i < 3u; i++) {
        push.positions.at[3u * vertex + i] = at[i];
        push.normals.at[3u * vertex + i] = normal[i];
    }
}

void note_vertex(bool capped, float residual)
{
    if (capped)
        atomicAdd(push.summary.at[HEWN_SUMMARY_CAPS], 1u);
    else if (finite(residual) && floatBitsToUint(residual) > push.summary.at[HEWN_SUMMARY_RESIDUAL])
        atomicMax(push.summary.at[HEWN_SUMMARY_RESIDUAL], floatBitsToUint(residual));
}

void main()
{
    uint vertex = invocation();
    if (vertex >= push.count)
        return;
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
    note_vertex(capped, sloped ? abs(gradient.w) / (size * push.grid.cell) : 0.0);
}
