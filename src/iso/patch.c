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

/* Where both loops pass one face, no cross edge can lie between them there: a vertex in the cell bridges the gap. */
typedef struct gap {
    uint32_t face;
    uint32_t cut[2]; /* on each loop, the corner from which its cut at the gap leads */
    uint32_t centre; /* what the gap's vertex is called, once it is there */
} gap;

typedef struct annulus {
    const hewn_loop *one, *other;
    uint32_t gap_count;
    gap gaps[6];
    uint32_t edges; /* of both loops, as bits */
} annulus;

/* The corner from which the loop's cut in a face leads; the loop's length where it has none there. */
static uint32_t cut_in_face(const hewn_loop *loop, uint32_t face)
{
    for (uint32_t i = 0; i < loop->length; i++)
        if (hewn_cube_edge_in_face(loop->edges[i], face) &&
            hewn_cube_edge_in_face(loop->edges[(i + 1) % loop->length], face))
            return i;
    return loop->length;
}

/* Two gaps beside each other on a triangle leave no good place for cross edges: a third gap, at the triangle's last cut
 * and in the middle of the cuts across from it, makes them a ring. The loops run along the band in opposite ways, so
 * these come in the opposite order. */
static void add_third_gap(annulus *band)
{
    bool swapped = band->one->length != 3;
    const hewn_loop *three = swapped ? band->other : band->one, *rest = swapped ? band->one : band->other;
    gap third = {0};
    uint32_t a = band->gaps[0].cut[swapped], b = band->gaps[1].cut[swapped], last = 3 - a - b;
    uint32_t from = band->gaps[(a + 1) % 3 == b ? 0 : 1].cut[!swapped];
    uint32_t to = band->gaps[(a + 1) % 3 == b ? 1 : 0].cut[!swapped];
    uint32_t between = (to + rest->length - from) % rest->length;
    third.cut[swapped] = last;
    third.cut[!swapped] = (from + between / 2) % rest->length;
    assert(between >= 2);
    for (uint32_t face = 0; face < 6; face++)
        if (cut_in_face(three, face) == last)
            third.face = face;
    band->gaps[band->gap_count++] = third;
}

static annulus describe_annulus(const hewn_loop *one, const hewn_loop *other)
{
    annulus band = {.one = one, .other = other};
    for (uint32_t face = 0; face < 6; face++) {
        gap found = {face, {cut_in_face(one, face), cut_in_face(other, face)}, 0};
        if (found.cut[0] < one->length && found.cut[1] < other->length)
            band.gaps[band.gap_count++] = found;
    }
    for (uint32_t i = 0; i < one->length; i++)
        band.edges |= 1u << one->edges[i];
    for (uint32_t i = 0; i < other->length; i++)
        band.edges |= 1u << other->edges[i];
    if (band.gap_count == 2 && (one->length == 3 || other->length == 3))
        add_third_gap(&band);
    return band;
}

static void add_centres(hewn_patch *patch, annulus *band)
{
    for (uint32_t i = 0; i < band->gap_count; i++) {
        assert(patch->centre_count < HEWN_PATCH_MOST_CENTRES);
        band->gaps[i].centre = HEWN_PATCH_FIRST_CENTRE + patch->centre_count;
        patch->centres[patch->centre_count++] = band->edges | (band->gaps[i].face + 1) << 12;
    }
}

/* A strip of triangles from the ring of the gaps' vertices to a loop: `which` of the two. */
static void add_strip(hewn_patch *patch, const annulus *band, uint32_t which)
{
    const hewn_loop *loop = which ? band->other : band->one;
    uint32_t centre_of[12], last = 0;
    for (uint32_t i = 0; i < loop->length; i++)
        centre_of[i] = 0;
    for (uint32_t i = 0; i < band->gap_count; i++) {
        last = band->gaps[i].cut[which];
        centre_of[last] = band->gaps[i].centre;
    }
    uint32_t before = centre_of[last];
    for (uint32_t step = 1; step <= loop->length; step++) {
        uint32_t i = (last + step) % loop->length;
        if (centre_of[i]) {
            add_triangle(patch, before, loop->edges[i], centre_of[i]);
            before = centre_of[i];
        }
        add_triangle(patch, loop->edges[i], loop->edges[(i + 1) % loop->length], before);
    }
}

/* --- walks along a band ------------------------------------------------------------------------------------------- */

/* With fewer than three gaps there is no ring, and the walk along the band goes from cross edge to cross edge. A step
 * moves on along `one` or, since both loops run along the border of the band, back along `other`. At a gap it leaps,
 * and a fan around the gap's vertex fills what it leapt over. All walks are tried: there are few. */
typedef struct crossing {
    uint32_t i, j;
} crossing;

typedef struct walk {
    uint32_t start; /* the corner of `other` from which it began */
    uint32_t count;
    crossing at[24];
    uint32_t over[24]; /* which gap was leapt over to get there, or NO_GAP */
    uint32_t gaps_passed;
    uint32_t cost;
} walk;

typedef struct walk_search {
    const annulus *band;
    walk now, best;
    uint16_t used[12]; /* of each corner of `one`, the corners of `other` that it is joined to */
} walk_search;

enum { NO_GAP = 6, LEAP_COST = 12 };

static uint32_t corner_of_other(const walk_search *search, const walk *way, uint32_t j)
{
    uint32_t length = search->band->other->length;
    return (way->start + length - j % length) % length;
}

static void walk_on(walk_search *search, crossing at);

static void walk_to(walk_search *search, crossing to, uint32_t over)
{
    const annulus *band = search->band;
    walk *now = &search->now;
    assert(band->one->length > 0 && band->other->length > 0);
    crossing from = now->at[now->count - 1];
    uint32_t i = to.i % band->one->length, j = corner_of_other(search, now, to.j), passed = now->gaps_passed;
    bool closes = to.i == band->one->length && to.j == band->other->length;
    uint32_t cost = chord(band->one->edges[i], band->other->edges[j]);
    if (over != NO_GAP)
        cost += LEAP_COST * (to.i - from.i + to.j - from.j);
    if (cost >= IMPOSSIBLE || now->cost + cost >= search->best.cost || (!closes && search->used[i] >> j & 1))
        return;
    if (over != NO_GAP)
        now->gaps_passed |= 1u << over;
    if (closes && now->gaps_passed != (1u << band->gap_count) - 1) {
        now->gaps_passed = passed;
        return;
    }
    now->cost += cost;
    now->over[now->count] = over;
    now->at[now->count++] = to;
    if (closes) {
        search->best = *now;
    } else {
        search->used[i] |= (uint16_t)(1u << j);
        walk_on(search, to);
        search->used[i] &= (uint16_t) ~(1u << j);
    }
    now->count--;
    now->cost -= cost;
    now->gaps_passed = passed;
}

/* Leaps over a gap from `at`: beyond both loops' cuts in that face, and to no vertex twice. */
static void leap(walk_search *search, crossing at, uint32_t over)
{
    const annulus *band = search->band;
    uint32_t most_i = band->one->length, most_j = band->other->length;
    uint32_t cut_i = cut_in_face(band->one, band->gaps[over].face), cut_j = band->gaps[over].cut[1];
    for (uint32_t i = at.i + 1; i <= most_i && i - at.i < most_i; i++)
        for (uint32_t j = at.j + 1; j <= most_j && j - at.j < most_j; j++) {
            bool over_i = cut_i >= at.i && cut_i < i, over_j = false;
            for (uint32_t k = at.j + 1; k <= j; k++)
                over_j |= corner_of_other(search, &search->now, k) == cut_j;
            if (over_i && over_j)
                walk_to(search, (crossing){i, j}, over);
        }
}

static void walk_on(walk_search *search, crossing at)
{
    if (at.i < search->band->one->length)
        walk_to(search, (crossing){at.i + 1, at.j}, NO_GAP);
    if (at.j < search->band->other->length)
        walk_to(search, (crossing){at.i, at.j + 1}, NO_GAP);
    for (uint32_t over = 0; over < search->band->gap_count; over++)
        if (!(search->now.gaps_passed >> over & 1))
            leap(search, at, over);
}

static void add_fan(hewn_patch *patch, const walk_search *search, crossing from, crossing to, uint32_t centre)
{
    const annulus *band = search->band;
    uint32_t ring[24], length = 0;
    for (uint32_t i = from.i; i <= to.i; i++)
        ring[length++] = band->one->edges[i % band->one->length];
    for (uint32_t j = to.j + 1; j-- > from.j;)
        ring[length++] = band->other->edges[corner_of_other(search, &search->best, j)];
    for (uint32_t k = 0; k < length; k++)
        add_triangle(patch, ring[k], ring[(k + 1) % length], centre);
}

static void add_walk(hewn_patch *patch, const walk_search *search)
{
    const annulus *band = search->band;
    const walk *best = &search->best;
    for (uint32_t step = 1; step < best->count; step++) {
        crossing from = best->at[step - 1], to = best->at[step];
        uint32_t u = band->one->edges[from.i % band->one->length],
                 w = band->other->edges[corner_of_other(search, best, from.j)];
        if (best->over[step] != NO_GAP)
            add_fan(patch, search, from, to, band->gaps[best->over[step]].centre);
        else if (to.i > from.i)
            add_triangle(patch, u, band->one->edges[to.i % band->one->length], w);
        else
            add_triangle(patch, band->other->edges[corner_of_other(search, best, to.j)], w, u);
    }
}

bool hewn_patch_add_annulus(hewn_patch *patch, const hewn_loop *one, const hewn_loop *other)
{
    annulus band = describe_annulus(one, other);
    if (band.gap_count >= 3) {
        add_centres(patch, &band);
        add_strip(patch, &band, 0);
        add_strip(patch, &band, 1);
        return true;
    }
    walk_search search = {.band = &band, .best = {.cost = IMPOSSIBLE}};
    /* A cross edge leaves each corner of `one` that no fan takes in: some corner is such a one. */
    hewn_loop turned = *one;
    for (uint32_t turn = 0; turn < one->length && search.best.count == 0; turn++) {
        for (uint32_t i = 0; i < one->length; i++)
            turned.edges[i] = one->edges[(i + turn) % one->length];
        band.one = &turned;
        for (uint32_t start = 0; start < other->length; start++) {
            if (chord(turned.edges[0], other->edges[start]) == IMPOSSIBLE)
                continue;
            search.now = (walk){.start = start, .count = 1};
            search.used[0] = (uint16_t)(1u << start);
            walk_on(&search, search.now.at[0]);
            search.used[0] = 0;
        }
    }
    if (search.best.count == 0)
        return false;
    add_centres(patch, &band);
    add_walk(patch, &search);
    return true;
}
