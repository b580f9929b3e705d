/* Dual contouring: places the vertex of each loop where the planes of its crossings meet, and asks the field whether they
 * do. One invocation a vertex. */
#include "iso/dual_record.h"
#include "iso/grid.h"
#include "iso/qef.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_vertex_push push;
};

#include "iso/dual_place.h"

/* Up to here a place is on the surface, in cells. */
const float ON_SURFACE = 5.0e-5;
/* Along a sharp edge the field is asked where the edge leaves the cell: a surface that is off it there, and meets it at no
 * less than 6 degrees, is a plane that no crossing saw. */
const float MEETS = 0.1;
/* Planes whose normals are nearer than about 11 degrees are one surface. */
const float SAME = 0.98;
/* A vertex where a surface is not smooth, and that is farther off it than this, has lost something. */
const float LOST = 0.05;
/* So far on both sides of an edge the normals are still those of its two surfaces. */
const float ASIDE = 0.02;

/* Questions to the field are asked in one place, since its code is long: up to five at once. */
vec3 asked[5];
vec4 told[5];

const uint SOLVE = 0u, LEAVE = 1u, PAIR = 2u, SHARP = 3u, DONE = 4u;

struct Placed {
    vec3 at;
    vec4 seen; /* the surface from there */
    uint rank;
    uint found; /* planes that no crossing saw */
    bool missed; /* a corner is where no vertex can be */
    bool sharp;
};

/* Where the line through `at` leaves the cell, as distances along it: backward, forward. */
vec2 line_ends(Cell cell, vec3 at, vec3 along)
{
    vec2 ends = vec2(-4.0, 4.0);
    for (uint i = 0u; i < 3u; i++) {
        if (abs(along[i]) > 1.0e-6) {
            vec2 sides = (vec2(cell.lo[i], cell.hi[i]) - at[i]) / along[i];
            ends = vec2(max(ends.x, min(sides.x, sides.y)), min(ends.y, max(sides.x, sides.y)));
        }
    }
    return vec2(min(ends.x, 0.0), max(ends.y, 0.0));
}

/* Planes sorted by surface: bits of those of the first three. */
uvec3 surfaces_of_planes()
{
    uvec3 sets = uvec3(0u);
    for (uint i = 0u; i < qef_count; i++) {
        for (uint k = 0u; k < 3u; k++) {
            bool same = sets[k] == 0u || dot(qef_planes[findLSB(sets[k])].xyz, qef_planes[i].xyz) > SAME;
            if (same) {
                sets[k] |= 1u << i;
                break;
            }
        }
    }
    return sets;
}

/* The axis along which a corner lies beyond the cell, in the next one, with all three edges that end there leading back
 * through the face between: so no other cell sees it. 3 where that is not so. */
uint beyond_face(Cell cell, vec3 at, uvec3 sets)
{
    vec3 low = step(at, cell.lo) * step(vec3(1.0e-7), cell.lo - at), high = step(cell.hi, at) * step(vec3(1.0e-7), at - cell.hi);
    vec3 out_of = low + high;
    uint axis = out_of.x > 0.0 ? 0u : out_of.y > 0.0 ? 1u : 2u;
    float face = low[axis] > 0.0 ? cell.lo[axis] : cell.hi[axis];
    bool so = dot(out_of, vec3(1.0)) == 1.0 && abs(at[axis] - face) < 0.99 && all(notEqual(sets, uvec3(0u)));
    so = so && face != 0.0 && cell.lo[axis] > 0.0 && cell.hi[axis] < 1.0 - 0.5 * KEPT_OFF;
    for (uint k = 0u; k < 3u; k++) {
        vec3 one = qef_planes[findLSB(sets[k]) & 15].xyz, other = qef_planes[findLSB(sets[(k + 1u) % 3u]) & 15].xyz;
        vec3 along = cross(one, other);
        vec3 through = at + along * ((face - at[axis]) / along[axis]);
        through[axis] = 0.5 * (cell.lo[axis] + cell.hi[axis]);
        so = so && all(greaterThan(through, cell.lo)) && all(lessThan(through, cell.hi));
    }
    return so ? axis : 3u;
}

/* The corners of the cell that lie on a face's far side in the next cell. */
void ask_beyond(Cell cell, vec3 at, uint axis)
{
    for (uint i = 0u; i < 4u; i++) {
        uint u = axis == 0u ? 1u : 0u, v = axis == 2u ? 1u : 2u;
        vec3 corner;
        corner[axis] = at[axis] < 0.5 ? -1.0 : 2.0;
        corner[u] = float(i & 1u);
        corner[v] = float(i >> 1);
        asked[1u + i] = corner;
    }
}

/* Several loops of one cell get in each other's way where they are not on the surface: then they keep to `narrow`, the
 * box of their crossings. */
Placed place_vertex(Cell cell, Cell narrow, bool alone, vec3 usual)
{
    Placed placed = Placed(vec3(0.0), vec4(0.0, 0.0, 0.0, 3.0e38), 0u, 0u, false, false);
    uint phase = SOLVE, known = qef_count, rounds = 0u, pair = 0u;
    uvec3 sets = uvec3(0u);
    bool kept_narrow = false;
    vec3 corner = vec3(0.0), aside = vec3(0.0);
    for (uint step_of = 0u; step_of < 16u && phase != DONE; step_of++) {
        Qef solved;
        uint questions = 1u;
        bool solving = phase == SOLVE || phase == PAIR;
        qef_taken = phase == PAIR ? sets[pair] | sets[(pair + 1u) % 3u] : 0xFFFFFFFFu;
        for (bool more = solving; more; more = false) {
            solved = qef_solve(cell.lo, cell.hi);
            asked[0] = solved.at;
        }
        if (phase == SOLVE && solved.rank == 2u) {
            vec2 ends = line_ends(cell, solved.at, solved.free);
            asked[1] = solved.at + ends.x * solved.free;
            asked[2] = solved.at + ends.y * solved.free;
            questions = 3u;
        }
        if (phase == LEAVE) {
            asked[0] = corner;
            ask_beyond(cell, corner, beyond_face(cell, corner, sets));
            questions = 5u;
        }
        if (phase == SHARP) {
            asked[0] = placed.at + ASIDE * aside;
            asked[1] = placed.at - ASIDE * aside;
            questions = 2u;
        }
        for (uint i = 0u; i < questions; i++)
            told[i] = surface_from(out_of_cell(cell, asked[i]));
        bool nearer = abs(told[0].w) <= max(phase == PAIR ? 0.0 : ON_SURFACE, abs(placed.seen.w));
        uint next = DONE;
        if (solving && nearer)
            placed = Placed(solved.at, told[0], solved.rank, qef_count - known, false, false);
        if (phase == SOLVE) {
            uint before = qef_count;
            for (uint i = 0u; i < questions; i++) {
                if (abs(told[i].w) > ON_SURFACE && abs(dot(told[i].xyz, solved.free)) > MEETS)
                    qef_add_plane(into_cell(cell, out_of_cell(cell, asked[i])) - told[i].w * told[i].xyz, told[i].xyz);
            }
            rounds++;
            next = qef_count > before && rounds < 4u ? SOLVE : placed.rank >= 2u ? SHARP : DONE;
            if (next != SOLVE && solved.rank == 3u && solved.at != solved.best) {
                corner = solved.best;
                sets = surfaces_of_planes();
                next = alone && !kept_narrow && beyond_face(cell, corner, sets) < 3u ? LEAVE : sets.z != 0u ? PAIR : next;
            }
        } else if (phase == LEAVE) {
            bool same = true;
            for (uint i = 2u; i < 5u; i++)
                same = same && (told[i].w < 0.0) == (told[1].w < 0.0);
            bool there = same && abs(told[0].w) <= ON_SURFACE;
            if (there)
                placed = Placed(corner, told[0], 3u, qef_count - known, false, false);
            next = there ? SHARP : PAIR;
            placed.missed = same && !there;
        } else if (phase == PAIR) {
            pair++;
            next = pair < 3u && abs(placed.seen.w) > ON_SURFACE ? PAIR : SHARP;
        } else {
            vec3 one = told[0].xyz - told[1].xyz;
            placed.sharp = dot(one, one) > 0.25 * dot(aside, aside);
        }
        if (next == SHARP) {
            /* Towards the plane that bends away most. */
            float most = 0.0;
            for (uint i = 0u; i < qef_count; i++) {
                vec3 away = qef_planes[i].xyz - usual;
                aside = dot(away, away) > most ? away : aside;
                most = max(most, dot(away, away));
            }
        }
        if (!alone && next > PAIR && phase != SHARP && abs(placed.seen.w) > ON_SURFACE) {
            kept_narrow = alone = true;
            cell = narrow;
            qef_count = known;
            rounds = pair = 0u;
            placed.seen.w = 3.0e38;
            next = SOLVE;
        }
        phase = next;
    }
    return placed;
}

void main()
{
    uint vertex = invocation();
    if (vertex >= push.count)
        return;
    DualRecord record = dual_record(push.positions, vertex);
    Cell cell = cell_of(record);
    vec3 along = vec3(0.0), least = vec3(1.0), most = vec3(0.0);
    float count = 0.0;
    bool capped = false;
    qef_begin();
    for (uint rest = record.edges; rest != 0u; rest &= rest - 1u) {
        uint edge = uint(findLSB(rest));
        uint crossing = edge_vertex(push.links, push.edges, record.slot, record.at, edge);
        vec3 point = load_vector(push.points, crossing), normal = load_vector(push.point_normals, crossing);
        vec3 at = into_cell(cell, point);
        qef_add_crossing(at, normal);
        least = min(least, at);
        most = max(most, at);
        capped = capped || is_cap(point, edge >> 2);
        along += normal;
        count += 1.0;
    }
    Cell narrow = Cell(cell.corner, clamp(least, cell.lo, cell.hi), clamp(most, cell.lo, cell.hi));
    Placed placed = place_vertex(cell, narrow, record.loops == 1u, along / max(length(along), 1.0e-6));
    vec3 place = out_of_cell(cell, placed.at);
    write_vertex(vertex, place, vertex_normal(placed.seen, along, count));
    count_vertex(placed.seen.w, capped);
    float off = abs(placed.seen.w);
    if (placed.rank >= 2u && placed.sharp)
        atomicAdd(push.summary.at[placed.rank == 2u ? HEWN_SUMMARY_EDGES : HEWN_SUMMARY_CORNERS], 1u);
    if (placed.found > 0u)
        atomicAdd(push.summary.at[HEWN_SUMMARY_PLANES], placed.found);
    if (placed.missed || (off > LOST && off <= 3.0e38 && length(along) <= 0.8 * count))
        atomicAdd(push.summary.at[HEWN_SUMMARY_LOST], 1u);
}
