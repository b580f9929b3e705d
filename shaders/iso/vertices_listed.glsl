/* As vertices.glsl, with the same arithmetic for each vertex, for fields in lists: an invocation solves four vertices of
 * a brick at once, so that one walk over its list serves them all. */
#include "iso/grid.h"
#include "iso/root_search.h"
#include "iso/together.h"
#include "iso/whole_loops.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_listed_vertex_push push;
};

const uint A_BRICK = 8u; /* invocations */

struct Edge {
    vec3 start;
    uint axis;
    float end, side;
    uvec2 place; /* along the axis, and its last */
};

Edge edges[4];

/* Past the end any edge will do: what comes of it is not used. */
void load_edge(uint vertex, uint end, uvec3 base, out Edge edge)
{
    uint record = 0u;
    if (vertex < end)
        record = floatBitsToUint(push.positions.at[3u * vertex + 1u]);
    edge.axis = record >> 9 & 3u;
    uvec3 first = base + (uvec3(record, record >> 3, record >> 6) & 7u);
    /* All ends, since a number that is picked by the axis would be read lane by lane. */
    vec3 ends;
    uvec3 cells;
    for (uint i = 0u; i < 3u; i++) {
        edge.start[i] = sample_coordinate(push.grid, i, first[i]);
        ends[i] = sample_coordinate(push.grid, i, first[i] + 1u);
        cells[i] = push.grid.cells[i];
    }
    edge.end = ends[edge.axis];
    precise float side = edge.end - edge.start[edge.axis];
    edge.side = side;
    edge.place = uvec2(first[edge.axis], cells[edge.axis]);
}

vec3 point_along(const Edge edge, float t)
{
    precise float along = edge.start[edge.axis] + edge.side * t;
    vec3 at = edge.start;
    return mix(at, vec3(along), equal(uvec3(0u, 1u, 2u), uvec3(edge.axis)));
}

vec4 values_at(vec3 at[4])
{
    return field_points(vec4(at[0].x, at[1].x, at[2].x, at[3].x), vec4(at[0].y, at[1].y, at[2].y, at[3].y),
                        vec4(at[0].z, at[1].z, at[2].z, at[3].z));
}

Search searches[4];

/* The values at both ends and then the search, in one loop so that the kernel has the field once: compilers copy what is
 * called to each place. */
void solve(const vec3 starts[4], const vec3 ends[4], uint count, out vec4 at_start, out vec4 at_end)
{
    bool settled = false;
    at_start = at_end = vec4(0.0);
    for (uint ask = 0u; ask < 2u + MOST_TRIALS && !everybody(settled); ask++) {
        vec3 at[4];
        for (uint k = 0u; k < 4u; k++) {
            if (ask >= 2u)
                next_guess(searches[k], ask - 2u);
            vec3 place = point_along(edges[k], searches[k].guess);
            at[k] = ask == 0u ? starts[k] : ask == 1u ? ends[k] : place;
        }
        vec4 values = values_at(at);
        at_start = ask == 0u ? values : at_start;
        at_end = ask == 1u ? values : at_end;
        settled = ask >= 2u;
        for (uint k = 0u; k < 4u; k++) {
            if (ask >= 2u)
                take_value(searches[k], values[k]);
            else
                searches[k] = search_begin(edges[k].start[edges[k].axis], edges[k].end, at_start[k], at_end[k],
                                           k >= count);
            settled = settled && searches[k].settled;
        }
    }
}

void write_vertex(uint vertex, vec3 at, vec3 normal)
{
    for (uint i = 0u; i < 3u; i++) {
        push.positions.at[3u * vertex + i] = at[i];
        push.normals.at[3u * vertex + i] = normal[i];
    }
}

void write_solved(uint vertex, const Edge edge, vec3 at, vec4 gradient, float at_start, float at_end)
{
    bool capped = push.grid.open == 0u;
    bool cap_start = capped && edge.place.x == 0u && at_start < 0.0;
    bool cap_end = capped && edge.place.x + 1u == edge.place.y && at_end < 0.0;
    vec3 outward = vec3(0.0);
    outward[edge.axis] = cap_start || (!cap_end && at_end < 0.0) ? -1.0 : 1.0;
    if (cap_start || cap_end) {
        vec3 last = edge.start;
        last[edge.axis] = edge.end;
        write_vertex(vertex, cap_start ? edge.start : last, outward);
        atomicAdd(push.summary.at[HEWN_SUMMARY_CAPS], 1u);
        return;
    }
    float size = length(gradient.xyz);
    bool sloped = finite(size) && size > 0.0;
    float off = gradient.w / size;
    if (push.dual != 0u && sloped && abs(off) <= push.grid.cell * CORRECTED)
        at -= off * (gradient.xyz / size);
    write_vertex(vertex, at, plain_zeros(sloped ? gradient.xyz / size : outward));
    float residual = abs(gradient.w) / (size * push.grid.cell);
    if (sloped && finite(residual) && floatBitsToUint(residual) > push.summary.at[HEWN_SUMMARY_RESIDUAL])
        atomicMax(push.summary.at[HEWN_SUMMARY_RESIDUAL], floatBitsToUint(residual));
}

/* Leaves out of the list what is needed on none of these edges. */
void narrow(const vec3 starts[4], const vec3 ends[4], uint count)
{
    vec3 lo = min(starts[0], ends[0]), hi = max(starts[0], ends[0]);
    for (uint k = 1u; k < 4u; k++) {
        lo = k < count ? min(lo, min(starts[k], ends[k])) : lo;
        hi = k < count ? max(hi, max(starts[k], ends[k])) : hi;
    }
    field_narrow(vec2(lo.x, hi.x), vec2(lo.y, hi.y), vec2(lo.z, hi.z), count > 0u, 2u);
}

void solve_four(uint first, uint end, uvec3 base)
{
    vec3 starts[4], ends[4], found[4];
    for (uint k = 0u; k < 4u; k++) {
        load_edge(first + k, end, base, edges[k]);
        starts[k] = point_along(edges[k], 0.0);
        ends[k] = edges[k].start;
        ends[k][edges[k].axis] = edges[k].end;
    }
    narrow(starts, ends, first < end ? min(end - first, 4u) : 0u);
    vec4 at_start, at_end;
    solve(starts, ends, first < end ? end - first : 0u, at_start, at_end);
    float least = push.dual != 0u ? 0.0 : NEAREST;
    for (uint k = 0u; k < 4u; k++)
        found[k] = point_along(edges[k], clamp(searches[k].guess, least, 1.0 - least));
    vec4 gradients[4];
    field_gradients(vec4(found[0].x, found[1].x, found[2].x, found[3].x),
                    vec4(found[0].y, found[1].y, found[2].y, found[3].y),
                    vec4(found[0].z, found[1].z, found[2].z, found[3].z), gradients);
    for (uint k = 0u; k < 4u; k++)
        if (first + k < end)
            write_solved(first + k, edges[k], found[k], gradients[k], at_start[k], at_end[k]);
}

void main()
{
    uint own = spread_invocation(), slot = own / A_BRICK;
    if (slot >= push.count) /* all of a brick's invocations */
        return;
    uint begin = push.vertex_bases.at[slot], end = push.vertex_count;
    if (slot + 1u < push.count)
        end = push.vertex_bases.at[slot + 1u];
    uvec3 base = 8u * unpack_brick(push.bricks.at[slot]);
    field_select(slot);
    begin += push.first_turn * 4u * A_BRICK;
    end = min(end, begin + push.turns * 4u * A_BRICK);
    for (uint chunk = begin; chunk < end; chunk += 4u * A_BRICK)
        solve_four(chunk + 4u * (own % A_BRICK), end, base);
    if (loops_were_cut(push.count))
        atomicMax(push.summary.at[HEWN_SUMMARY_CUT], 1u);
}
