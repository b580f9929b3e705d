#include "iso/patch.h"

#include <assert.h>
#include <string.h>

#include "iso/cube.h"

#define IMPOSSIBLE 1000000u

/* Squared distance between the middles of two edges, in half cells; IMPOSSIBLE in a common face. */
static uint32_t chord(uint32_t edge, uint32_t other)
{
    if (hewn_cube_edges_share_face(edge, other))
        return IMPOSSIBLE;
    uint32_t from = hewn_cube_edge_start(edge), to = hewn_cube_edge_start(other), sum = 0;
    for (uint32_t axis = 0; axis < 3; axis++) {
        int32_t a = (int32_t)(2 * (from >> axis & 1)) + (edge / 4 == axis),
                b = (int32_t)(2 * (to >> axis & 1)) + (other / 4 == axis);
        sum += (uint32_t)((a - b) * (a - b));
    }
    return sum;
}

static void add_triangle(hewn_patch *patch, uint32_t a, uint32_t b, uint32_t c)
{
    assert(patch->triangle_count < HEWN_PATCH_MOST_TRIANGLES);
    uint8_t *corners = patch->corners[patch->triangle_count++];
    corners[0] = (uint8_t)a;
    corners[1] = (uint8_t)b;
    corners[2] = (uint8_t)c;
}

/* --- discs -------------------------------------------------------------------------------------------------------- */

/* cost[i][j]: least sum of the chords within corners i to j, that from i to j itself included; split[i][j]: the third
 * corner of the triangle on that chord. */
typedef struct disc_plan {
    uint32_t cost[12][12];
    uint32_t split[12][12];
} disc_plan;

static void plan_disc(disc_plan *plan, const hewn_loop *loop)
{
    memset(plan, 0, sizeof *plan);
    for (uint32_t span = 2; span < loop->length; span++) {
        for (uint32_t i = 0; i + span < loop->length; i++) {
            uint32_t j = i + span, least = IMPOSSIBLE;
            for (uint32_t k = i + 1; k < j; k++) {
                uint32_t sum = plan->cost[i][k] + plan->cost[k][j];
                if (sum < least) {
                    least = sum;
                    plan->split[i][j] = k;
                }
            }
            bool whole = span == loop->length - 1;
            plan->cost[i][j] = least + (whole ? 0 : chord(loop->edges[i], loop->edges[j]));
            if (plan->cost[i][j] > IMPOSSIBLE)
                plan->cost[i][j] = IMPOSSIBLE;
        }
    }
}

static void cut_disc(hewn_patch *patch, const hewn_loop *loop, const disc_plan *plan, uint32_t i, uint32_t j)
{
    if (j - i < 2)
        return;
    uint32_t k = plan->split[i][j];
    add_triangle(patch, loop->edges[i], loop->edges[k], loop->edges[j]);
    cut_disc(patch, loop, plan, i, k);
    cut_disc(patch, loop, plan, k, j);
}

void hewn_patch_add_disc(hewn_patch *patch, const hewn_loop *loop)
{
    disc_plan plan;
    plan_disc(&plan, loop);
    if (plan.cost[0][loop->length - 1] < IMPOSSIBLE) {
        cut_disc(patch, loop, &plan, 0, loop->length - 1);
        return;
    }
    assert(patch->centre_count < HEWN_PATCH_MOST_CENTRES);
    uint32_t centre = HEWN_PATCH_FIRST_CENTRE + patch->centre_count, edges = 0;
    for (uint32_t i = 0; i < loop->length; i++) {
        edges |= 1u << loop->edges[i];
        add_triangle(patch, loop->edges[i], loop->edges[(i + 1) % loop->length], centre);
    }
    patch->centres[patch->centre_count++] = edges;
}

/* --- annuli ------------------------------------------------------------------------------------------------------- */

/* A walk along the band. A step moves on along `one` or, since both loops run along the border of the band, back along
 * `other`. Between steps it crosses the band from corner i of `one` to corner j of `other`. Where a cross edge would
 * lie in a face, the walk leaps over it, and a vertex in the cell with a fan of triangles fills the gap. All walks are
 * tried: there are few. */
typedef struct crossing {
    uint32_t i, j;
} crossing;

typedef struct band {
    uint32_t start; /* the corner of `other` from which the walk began */
    uint32_t count;
    crossing at[24];
    uint32_t cost;
} band;

typedef struct band_search {
    const hewn_loop *one, *other;
    band walk, best;
    uint16_t used[12]; /* of each corner of `one`, the corners of `other` that it is joined to */
} band_search;

/* A vertex in the cell costs more than any edges. */
#define GAP_COST 1000u

static uint32_t turn(const hewn_loop *loop, uint32_t by)
{
    return by % loop->length;
}

static uint32_t turn_back(const hewn_loop *loop, uint32_t from, uint32_t by)
{
    return (from + loop->length - turn(loop, by)) % loop->length;
}

static void walk_from(band_search *search, crossing at);

/* Goes to a crossing and on from there; `gap` if it is not one step away. */
static void walk_to(band_search *search, crossing to, bool gap)
{
    const hewn_loop *one = search->one, *other = search->other;
    uint32_t i = turn(one, to.i), j = turn_back(other, search->walk.start, to.j);
    bool closes = to.i == one->length && to.j == other->length;
    uint32_t length = chord(one->edges[i], other->edges[j]) + (gap ? GAP_COST : 0);
    if (length >= IMPOSSIBLE || search->walk.cost + length >= search->best.cost)
        return;
    if (!closes && search->used[i] >> j & 1)
        return;
    search->used[i] |= (uint16_t)(1u << j);
    search->walk.cost += length;
    search->walk.at[search->walk.count++] = to;
    if (closes)
        search->best = search->walk;
    else
        walk_from(search, to);
    search->walk.count--;
    search->walk.cost -= length;
    if (!closes)
        search->used[i] &= (uint16_t) ~(1u << j);
}

static void walk_from(band_search *search, crossing at)
{
    uint32_t most_i = search->one->length, most_j = search->other->length;
    if (at.i < most_i)
        walk_to(search, (crossing){at.i + 1, at.j}, false);
    if (at.j < most_j)
        walk_to(search, (crossing){at.i, at.j + 1}, false);
    /* The fan that fills a gap must not come to a vertex twice. */
    for (uint32_t i = at.i; i <= most_i && i - at.i < most_i; i++)
        for (uint32_t j = at.j; j <= most_j && j - at.j < most_j; j++)
            if (i - at.i + j - at.j > 1)
                walk_to(search, (crossing){i, j}, true);
}

static void add_gap(hewn_patch *patch, const band_search *search, crossing from, crossing to)
{
    assert(patch->centre_count < HEWN_PATCH_MOST_CENTRES);
    const hewn_loop *one = search->one, *other = search->other;
    uint32_t start = search->best.start, centre = HEWN_PATCH_FIRST_CENTRE + patch->centre_count, edges = 0;
    uint32_t ring[24], length = 0;
    for (uint32_t i = from.i; i <= to.i; i++)
        ring[length++] = one->edges[turn(one, i)];
    for (uint32_t j = to.j + 1; j-- > from.j;)
        ring[length++] = other->edges[turn_back(other, start, j)];
    for (uint32_t k = 0; k < length; k++) {
        edges |= 1u << ring[k];
        add_triangle(patch, ring[k], ring[(k + 1) % length], centre);
    }
    patch->centres[patch->centre_count++] = edges;
}

bool hewn_patch_add_annulus(hewn_patch *patch, const hewn_loop *one, const hewn_loop *other)
{
    band_search search = {.one = one, .other = other, .best = {.cost = IMPOSSIBLE}};
    for (uint32_t start = 0; start < other->length; start++) {
        if (chord(one->edges[0], other->edges[start]) == IMPOSSIBLE)
            continue;
        search.walk = (band){.start = start, .count = 1};
        search.used[0] = (uint16_t)(1u << start);
        walk_from(&search, search.walk.at[0]);
        search.used[0] = 0;
    }
    for (uint32_t step = 1; step < search.best.count; step++) {
        crossing from = search.best.at[step - 1], to = search.best.at[step];
        uint32_t u = one->edges[turn(one, from.i)], w = other->edges[turn_back(other, search.best.start, from.j)];
        if (to.i - from.i + to.j - from.j > 1)
            add_gap(patch, &search, from, to);
        else if (to.i > from.i)
            add_triangle(patch, u, one->edges[turn(one, to.i)], w);
        else
            add_triangle(patch, other->edges[turn_back(other, search.best.start, to.j)], w, u);
    }
    return search.best.count > 0;
}
