#include "iso/host_search.h"

#include "iso/grid.h"

/* Lengths are in cells; shaders/iso/dual_search.h says what these are for. */
static const float KEPT_OFF = 1.0f / 32768;
static const float ON_SURFACE = 5.0e-5f, MEETS = 0.1f, SAME = 0.98f, ASIDE = 0.02f;
static const float UNSEEN = 3.0e38f;

/* --- cells -------------------------------------------------------------------------------------------------------- */

hewn_host_cell hewn_host_cell_of(const struct hewn_grid *grid, uint32_t packed_brick, const uint32_t at[3])
{
    hewn_host_cell cell = {0};
    bool closed = grid->open == 0; /* else the rim's cells follow beyond the bounds */
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t first = 8 * (packed_brick >> 10 * i & 1023u) + at[i];
        float low = hewn_grid_sample(grid, i, first), high = hewn_grid_sample(grid, i, first + 1);
        float side = (high - low) / grid->cell;
        float off = most(KEPT_OFF, 2.4e-7f * most(fabsf(low), fabsf(high)) / grid->cell);
        bool flat = side < 2.5f * off;
        cell.corner[i] = low;
        cell.lo[i] = flat || (closed && low == grid->origin[i]) ? 0 : off;
        cell.hi[i] = flat ? 0 : closed && high == grid->far[i] ? side : side - off;
    }
    return cell;
}

vec hewn_host_into_cell(const struct hewn_grid *grid, const hewn_host_cell *cell, vec place)
{
    return (place - cell->corner) / grid->cell;
}

vec hewn_host_out_of_cell(const struct hewn_grid *grid, const hewn_host_cell *cell, vec at)
{
    return clamp3(cell->corner + grid->cell * at, vec_load(grid->origin), vec_load(grid->far));
}

/* --- questions ---------------------------------------------------------------------------------------------------- */

/* Where the line through `at` leaves the cell, as distances along it: backward, forward. */
static void line_ends(const hewn_host_cell *cell, vec at, vec along, float ends[2])
{
    ends[0] = -4;
    ends[1] = 4;
    for (int i = 0; i < 3; i++) {
        if (!(fabsf(along[i]) > 1.0e-6f))
            continue;
        float one = (cell->lo[i] - at[i]) / along[i], other = (cell->hi[i] - at[i]) / along[i];
        ends[0] = most(ends[0], least(one, other));
        ends[1] = least(ends[1], most(one, other));
    }
    ends[0] = least(ends[0], 0);
    ends[1] = most(ends[1], 0);
}

static uint32_t lowest(uint32_t mask)
{
    return (uint32_t)__builtin_ctz(mask);
}

/* Planes sorted by surface: bits of those of the first three. */
static void sort_planes(const hewn_qef *qef, uint32_t sets[3])
{
    sets[0] = sets[1] = sets[2] = 0;
    for (uint32_t i = 0; i < qef->count; i++)
        for (int k = 0; k < 3; k++)
            if (sets[k] == 0 || dot3(qef->planes[lowest(sets[k])], qef->planes[i]) > SAME) {
                sets[k] |= 1u << i;
                break;
            }
}

/* The axis along which the corner lies beyond the cell, in the next one, with all three edges that end there leading
 * back through the face between: so no other cell sees it. 3 where that is not so. */
static uint32_t beyond_face(const hewn_search *search)
{
    const hewn_host_cell *cell = &search->cell;
    const uint32_t *sets = search->sets;
    uint32_t axis = 3, sides = 0;
    bool below = false;
    for (uint32_t i = 0; i < 3; i++) {
        bool low = cell->lo[i] - search->corner[i] >= 1.0e-7f, high = search->corner[i] - cell->hi[i] >= 1.0e-7f;
        if ((low || high) && sides == 0) {
            axis = i;
            below = low;
        }
        sides += low + high;
    }
    if (sides != 1 || sets[0] == 0 || sets[1] == 0 || sets[2] == 0)
        return 3;
    float face = below ? cell->lo[axis] : cell->hi[axis];
    if (!(fabsf(search->corner[axis] - face) < 0.99f) || face == 0 || !(cell->lo[axis] > 0) ||
        !(cell->hi[axis] < 1 - 0.5f * KEPT_OFF))
        return 3;
    for (int k = 0; k < 3; k++) {
        vec along = cross3(search->qef.planes[lowest(sets[k])], search->qef.planes[lowest(sets[(k + 1) % 3])]);
        vec through = search->corner + along * ((face - search->corner[axis]) / along[axis]);
        for (uint32_t i = 0; i < 3; i++)
            if (i != axis && !(through[i] > cell->lo[i] && through[i] < cell->hi[i]))
                return 3;
    }
    return axis;
}

/* The corners of the next cell along an axis. */
static void ask_beyond(vec at, uint32_t axis, vec corners[8])
{
    uint32_t u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    for (uint32_t i = 0; i < 8; i++) {
        corners[i] = (vec){0};
        corners[i][axis] = at[axis] < 0.5f ? -(float)(i & 1) : 1 + (float)(i & 1);
        corners[i][u] = (float)(i >> 1 & 1);
        corners[i][v] = (float)(i >> 2);
    }
}

static bool asks_ends(const hewn_search *search)
{
    return search->phase == HEWN_SEARCH_SOLVE && search->solved.rank == 2 && search->alone;
}

static uint32_t count_questions(const hewn_search *search)
{
    switch (search->phase) {
    case HEWN_SEARCH_SOLVE: return asks_ends(search) ? 3 : 1;
    case HEWN_SEARCH_LEAVE: return 9;
    case HEWN_SEARCH_PAIR:
    case HEWN_SEARCH_LOOK: return 1;
    case HEWN_SEARCH_SHARP: return 2;
    case HEWN_SEARCH_DONE: break;
    }
    return 0;
}

uint32_t hewn_search_next(hewn_search *search)
{
    if (search->trials == HEWN_SEARCH_TRIALS)
        search->phase = HEWN_SEARCH_DONE;
    bool pairs = search->phase == HEWN_SEARCH_PAIR;
    search->qef.taken = pairs ? search->sets[search->pair] | search->sets[(search->pair + 1) % 3] : ~0u;
    if (pairs || search->phase == HEWN_SEARCH_SOLVE)
        search->solved = hewn_qef_solve(&search->qef, search->cell.lo, search->cell.hi);
    return count_questions(search);
}

uint32_t hewn_search_ask(const hewn_search *search, vec asked[HEWN_SEARCH_QUESTIONS])
{
    asked[0] = search->phase == HEWN_SEARCH_LOOK ? search->at : search->solved.at;
    if (asks_ends(search)) {
        float ends[2];
        line_ends(&search->cell, search->solved.at, search->solved.free, ends);
        for (int i = 0; i < 2; i++)
            asked[1 + i] = search->solved.at + ends[i] * search->solved.free;
    } else if (search->phase == HEWN_SEARCH_LEAVE) {
        asked[0] = search->corner;
        ask_beyond(search->corner, beyond_face(search), asked + 1);
    } else if (search->phase == HEWN_SEARCH_SHARP) {
        asked[0] = search->at + ASIDE * search->aside;
        asked[1] = search->at - ASIDE * search->aside;
    }
    return count_questions(search);
}

/* --- answers ------------------------------------------------------------------------------------------------------ */

void hewn_search_begin(hewn_search *search, bool alone, vec usual)
{
    search->usual = usual;
    search->phase = HEWN_SEARCH_SOLVE;
    search->known = search->qef.count;
    search->rounds = search->pair = search->trials = 0;
    search->alone = search->free = alone;
    search->at = (vec){0};
    search->seen = (vec){0, 0, 0, UNSEEN};
    search->rank = search->found = 0;
    search->missed = search->sharp = false;
}

void hewn_search_begin_at_mean(hewn_search *search)
{
    hewn_search_begin(search, true, (vec){0});
    search->phase = HEWN_SEARCH_LOOK;
    search->at = hewn_qef_mass_point(&search->qef, search->cell.lo, search->cell.hi);
}

static void keep_place(hewn_search *search, vec at, vec seen, uint32_t rank)
{
    search->at = at;
    search->seen = seen;
    search->rank = rank;
    search->found = search->qef.count - search->known;
}

/* Adds the planes that were found; the next phase. */
static hewn_search_phase after_solving(hewn_search *search, const struct hewn_grid *grid, const vec *told)
{
    const hewn_qef_solution *solved = &search->solved;
    vec asked[HEWN_SEARCH_QUESTIONS];
    uint32_t before = search->qef.count, questions = hewn_search_ask(search, asked);
    for (uint32_t i = 0; i < questions; i++) {
        vec normal = vec3(told[i][0], told[i][1], told[i][2]);
        if (!(fabsf(told[i][3]) > ON_SURFACE && fabsf(dot3(normal, solved->free)) > MEETS))
            continue;
        vec place = hewn_host_out_of_cell(grid, &search->cell, asked[i]);
        hewn_qef_add_plane(&search->qef, hewn_host_into_cell(grid, &search->cell, place) - told[i][3] * normal, normal);
    }
    search->rounds++;
    if (search->qef.count > before && search->rounds < 4)
        return HEWN_SEARCH_SOLVE;
    hewn_search_phase next = search->rank >= 2 ? HEWN_SEARCH_SHARP : HEWN_SEARCH_DONE;
    bool moved = false;
    for (int i = 0; i < 3; i++)
        moved = moved || solved->at[i] != solved->best[i];
    if (solved->rank == 3 && moved) {
        search->corner = solved->best;
        sort_planes(&search->qef, search->sets);
        bool leaves = search->alone && beyond_face(search) < 3;
        next = leaves ? HEWN_SEARCH_LEAVE : search->sets[2] != 0 ? HEWN_SEARCH_PAIR : next;
    }
    return next;
}

/* A corner may be taken in a cell that holds no surface otherwise. */
static hewn_search_phase after_leaving(hewn_search *search, const vec *told)
{
    bool same = true;
    for (int i = 2; i < 9; i++)
        same = same && (told[i][3] < 0) == (told[1][3] < 0);
    bool there = same && fabsf(told[0][3]) <= ON_SURFACE;
    search->missed = same && !there;
    if (there)
        keep_place(search, search->corner, told[0], 3);
    return there ? HEWN_SEARCH_SHARP : HEWN_SEARCH_PAIR;
}

static hewn_search_phase react(hewn_search *search, const struct hewn_grid *grid, const vec *told)
{
    const hewn_qef_solution *solved = &search->solved;
    bool pairs = search->phase == HEWN_SEARCH_PAIR, solving = search->phase == HEWN_SEARCH_SOLVE || pairs;
    if (solving && fabsf(told[0][3]) <= most(pairs ? 0 : ON_SURFACE, fabsf(search->seen[3]))) {
        bool best =
            solved->at[0] == solved->best[0] && solved->at[1] == solved->best[1] && solved->at[2] == solved->best[2];
        keep_place(search, solved->at, told[0], best || solved->rank < 2 ? solved->rank : 2);
    }
    if (search->phase == HEWN_SEARCH_SOLVE)
        return after_solving(search, grid, told);
    if (search->phase == HEWN_SEARCH_LEAVE)
        return after_leaving(search, told);
    if (pairs) {
        search->pair++;
        return search->pair < 3 && fabsf(search->seen[3]) > ON_SURFACE ? HEWN_SEARCH_PAIR : HEWN_SEARCH_SHARP;
    }
    if (search->phase == HEWN_SEARCH_LOOK) {
        search->seen = told[0];
        return HEWN_SEARCH_DONE;
    }
    vec turn = told[0] - told[1];
    search->sharp = dot3(turn, turn) > 0.25f * dot3(search->aside, search->aside);
    return HEWN_SEARCH_DONE;
}

/* Where the plane that bends away most from the usual normal leans to. */
static vec plane_aside(const hewn_search *search)
{
    vec aside = {0};
    for (uint32_t i = 0; i < search->qef.count; i++) {
        vec away = search->qef.planes[i] - search->usual;
        away[3] = 0;
        aside = dot3(away, away) > dot3(aside, aside) ? away : aside;
    }
    return aside;
}

/* Loops that share a cell are not asked for planes that no crossing saw, or two would come to one corner; and where
 * they are not on the surface they stay at the mean of their crossings, or they would get in each other's way. */
void hewn_search_take(hewn_search *search, const struct hewn_grid *grid, const vec *told)
{
    bool settled = search->phase == HEWN_SEARCH_SHARP;
    hewn_search_phase next = react(search, grid, told);
    if (next == HEWN_SEARCH_SHARP)
        search->aside = plane_aside(search);
    if (!search->free && !settled && next > HEWN_SEARCH_PAIR && fabsf(search->seen[3]) > ON_SURFACE) {
        search->free = true;
        search->cell.lo = search->cell.hi = hewn_qef_mass_point(&search->qef, search->cell.lo, search->cell.hi);
        search->qef.count = search->known;
        search->rounds = search->pair = 0;
        search->seen[3] = UNSEEN;
        next = HEWN_SEARCH_SOLVE;
    }
    search->phase = next;
    search->trials++;
}
