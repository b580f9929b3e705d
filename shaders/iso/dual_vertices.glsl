/* Dual contouring: places the vertex of each loop where the planes of its crossings meet, and asks the field whether they
 * do. One invocation a vertex. */
#include "iso/dual_record.h"
#include "iso/grid.h"
#include "iso/qef.h"
#include "iso/whole_loops.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_vertex_push push;
};

#include "iso/dual_place.h"
#include "iso/dual_search.h"
#include "iso/dual_ask.h"

/* What a vertex is at: each phase asks the field, and what it is told decides on the next one. */
const uint SOLVE = 0u; /* where all planes meet, and the ends of an edge there */
const uint LEAVE = 1u; /* a corner beyond a face of the cell */
const uint PAIR = 2u;  /* where two of three surfaces meet */
const uint SHARP = 3u; /* on both sides of the vertex */
const uint DONE = 4u;

struct Search {
    uint phase;
    uint known;  /* planes that crossings saw */
    uint rounds; /* of solving */
    uint pair;
    uvec3 sets; /* planes of each surface */
    vec3 corner;
    vec3 aside; /* from the vertex towards the plane that bends away most */
    bool alone; /* the cell has no other loop */
    /* The vertex so far: */
    vec3 at;
    vec4 seen; /* the surface from there */
    uint rank;
    uint found;  /* planes that no crossing saw */
    bool missed; /* a corner is where no vertex can be */
    bool sharp;
};

void keep_place(inout Search search, vec3 at, vec4 seen, uint rank)
{
    search.at = at;
    search.seen = seen;
    search.rank = rank;
    search.found = qef_count - search.known;
}

/* Writes the phase's questions, and says how many. */
uint ask(Search search, Cell cell, Qef solved)
{
    uint questions = 1u;
    if (search.phase == SOLVE && solved.rank == 2u && search.alone) {
        vec2 ends = line_ends(cell, solved.at, solved.free);
        asked[1] = solved.at + ends.x * solved.free;
        asked[2] = solved.at + ends.y * solved.free;
        questions = 3u;
    } else if (search.phase == LEAVE) {
        asked[0] = search.corner;
        ask_beyond(cell, search.corner, beyond_face(cell, search.corner, search.sets));
        questions = 9u;
    } else if (search.phase == SHARP) {
        asked[0] = search.at + ASIDE * search.aside;
        asked[1] = search.at - ASIDE * search.aside;
        questions = 2u;
    }
    return questions;
}

/* Adds the planes that were found; the next phase. */
uint after_solving(inout Search search, Cell cell, Qef solved, uint questions)
{
    uint before = qef_count;
    for (uint i = 0u; i < questions; i++) {
        if (abs(told[i].w) > ON_SURFACE && abs(dot(told[i].xyz, solved.free)) > MEETS)
            qef_add_plane(into_cell(cell, out_of_cell(cell, asked[i])) - told[i].w * told[i].xyz, told[i].xyz);
    }
    search.rounds++;
    if (qef_count > before && search.rounds < 4u)
        return SOLVE;
    uint next = search.rank >= 2u ? SHARP : DONE;
    if (solved.rank == 3u && solved.at != solved.best) {
        search.corner = solved.best;
        search.sets = surfaces_of_planes();
        bool leaves = search.alone && beyond_face(cell, search.corner, search.sets) < 3u;
        next = leaves ? LEAVE : search.sets.z != 0u ? PAIR : next;
    }
    return next;
}

/* A corner may be taken in a cell that holds no surface otherwise. */
uint after_leaving(inout Search search)
{
    bool same = true;
    for (uint i = 2u; i < 9u; i++)
        same = same && (told[i].w < 0.0) == (told[1].w < 0.0);
    bool there = same && abs(told[0].w) <= ON_SURFACE;
    search.missed = same && !there;
    if (there)
        keep_place(search, search.corner, told[0], 3u);
    return there ? SHARP : PAIR;
}

uint react(inout Search search, Cell cell, Qef solved, uint questions)
{
    bool solving = search.phase == SOLVE || search.phase == PAIR;
    if (solving && abs(told[0].w) <= max(search.phase == PAIR ? 0.0 : ON_SURFACE, abs(search.seen.w)))
        keep_place(search, solved.at, told[0], solved.at == solved.best ? solved.rank : min(solved.rank, 2u));
    uint next = DONE;
    if (search.phase == SOLVE) {
        next = after_solving(search, cell, solved, questions);
    } else if (search.phase == LEAVE) {
        next = after_leaving(search);
    } else if (search.phase == PAIR) {
        search.pair++;
        next = search.pair < 3u && abs(search.seen.w) > ON_SURFACE ? PAIR : SHARP;
    } else {
        vec3 turn = told[0].xyz - told[1].xyz;
        search.sharp = dot(turn, turn) > 0.25 * dot(search.aside, search.aside);
    }
    return next;
}

/* Loops that share a cell are not asked for planes that no crossing saw, or two would come to one corner; and where they are
 * not on the surface they stay at the mean of their crossings, or they would get in each other's way. */
Search place_vertex(uint slot, Cell cell, bool alone, bool there, vec3 usual)
{
    bool shared_cell = !alone;
    Search search = Search(there ? SOLVE : DONE, qef_count, 0u, 0u, uvec3(0u), vec3(0.0), vec3(0.0), alone, vec3(0.0),
                           vec4(0.0, 0.0, 0.0, 3.0e38), 0u, 0u, false, false);
    for (uint trial = 0u; trial < 16u && somebody(search.phase != DONE); trial++) {
        Qef solved;
        bool pairs = search.phase == PAIR;
        qef_taken = pairs ? search.sets[search.pair] | search.sets[(search.pair + 1u) % 3u] : 0xFFFFFFFFu;
        /* A loop, since a CPU device jumps over that, but takes all arms of a branch. */
        for (bool more = pairs || search.phase == SOLVE; more; more = false) {
            solved = qef_solve(cell.lo, cell.hi);
            asked[0] = solved.at;
        }
        uint questions = search.phase == DONE ? 0u : ask(search, cell, solved);
        for (uint i = 0u; somebody(i < questions); i++)
            told[i] = surface_asked(slot, out_of_cell(cell, asked[i]), i < questions);
        if (search.phase == DONE)
            continue; /* others of its subgroup are still at it */
        bool settled = search.phase == SHARP;
        uint next = react(search, cell, solved, questions);
        if (next == SHARP)
            search.aside = plane_aside(usual);
        if (shared_cell && !settled && next > PAIR && abs(search.seen.w) > ON_SURFACE) {
            shared_cell = false;
            cell.lo = cell.hi = qef_mass_point(cell.lo, cell.hi);
            qef_count = search.known;
            search.rounds = search.pair = 0u;
            search.seen.w = 3.0e38;
            next = SOLVE;
        }
        search.phase = next;
    }
    return search;
}

void main()
{
    /* Nobody leaves, see iso/dual_ask.h: those past the end are at an empty loop. */
    uint vertex = invocation();
    bool there = vertex < push.count;
    DualRecord record = DualRecord(0u, uvec3(0u), 0u, 1u);
    if (there)
        record = dual_record(push.positions, vertex);
    Cell cell = cell_of(record);
    vec3 along = vec3(0.0);
    float count = 0.0;
    bool capped = false;
    qef_begin();
    for (uint rest = record.edges; rest != 0u; rest &= rest - 1u) {
        uint edge = uint(findLSB(rest));
        uint crossing = edge_vertex(push.links, push.edges, record.slot, record.at, edge);
        vec3 point = load_vector(push.points, crossing), normal = load_vector(push.point_normals, crossing);
        qef_add_crossing(into_cell(cell, point), normal);
        capped = capped || is_cap(point, edge >> 2);
        along += normal;
        count += 1.0;
    }
    Search placed = place_vertex(record.slot, cell, record.loops == 1u, there, along / max(length(along), 1.0e-6));
    if (!there)
        return;
    vec3 place = out_of_cell(cell, placed.at);
    write_vertex(vertex, place, vertex_normal(placed.seen, along, count));
    count_vertex(placed.seen.w, capped);
    float off = abs(placed.seen.w);
    if (placed.rank >= 2u && placed.sharp && off <= LOST)
        atomicAdd(push.summary.at[placed.rank == 2u ? HEWN_SUMMARY_EDGES : HEWN_SUMMARY_CORNERS], 1u);
    if (placed.found > 0u)
        atomicAdd(push.summary.at[HEWN_SUMMARY_PLANES], placed.found);
    if (placed.missed || (off > LOST && off <= 3.0e38 && length(along) <= 0.8 * count))
        atomicAdd(push.summary.at[HEWN_SUMMARY_LOST], 1u);
    if (loops_were_cut(push.count))
        atomicMax(push.summary.at[HEWN_SUMMARY_CUT], 1u);
}
