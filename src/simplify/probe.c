#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "geom/nearest.h"
#include "simplify/probe_mark.h"
#include "simplify/split.h"

/* The cosine between triangles that meet in a ridge, and the square of one between what faces the same way. */
static const double ridge_cosine = 0.92, least_along = 0.25;

/* A squared distance that is more than this times what it was has grown. */
static const double grown = 1.002;

/* Samples that are placed at a time: what has most to lose first, and no more is looked at where that is too far. */
enum { AT_ONCE = 24 };

void hewn_simplify_probe_release(simplify_probe *probe)
{
    hewn_simplify_fan_release(&probe->fan);
    hewn_free(probe->points);
    hewn_free(probe->marks);
    hewn_free(probe->blocks);
    *probe = (simplify_probe){0};
}

/* --- faces -------------------------------------------------------------------------------------------------------- */

/* The triangles around `v` with `to` in its place, but for those with `other`. */
static hewn_result take_fan(const simplify_work *work, uint32_t v, uint32_t other, const double to[3],
                            simplify_probe *probe)
{
    const uint32_t first = work->half[v];
    uint32_t h = first;
    do {
        const uint32_t in = simplify_prev(h), p = simplify_head(work, h), q = work->tail[in];
        if (p == other || q == other) {
            probe->cleared[probe->cleared[0] != HEWN_NONE && probe->cleared[0] != h / 3] = h / 3;
        } else {
            double towards_p[3], towards_q[3];
            simplify_between(to, simplify_at(work, p), towards_p);
            simplify_between(to, simplify_at(work, q), towards_q);
            HEWN_TRY(hewn_simplify_fan_add(&probe->fan, h / 3, towards_p, towards_q));
        }
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    return HEWN_OK;
}

static uint32_t face_of(const simplify_probe *probe, uint32_t near)
{
    return probe->fan.blocks[near / SIMPLIFY_FOUR].face[near % SIMPLIFY_FOUR];
}

/* --- samples ------------------------------------------------------------------------------------------------------ */

/* A sample that waits to be placed: it makes no difference where. */
static const uint32_t deferred = SIMPLIFY_NOWHERE - 1;

/* Samples of one triangle, `own` in the fan or SIMPLIFY_NOWHERE. */
static hewn_result take_samples(const simplify_samples *samples, uint32_t face, uint32_t own, const double at[3],
                                simplify_probe *probe)
{
    for (uint32_t s = samples->first[face]; s != HEWN_NONE; s = samples->items[s].next) {
        if (probe->point_count == probe->point_capacity)
            HEWN_TRY(hewn_reserve((void **)&probe->points, &probe->point_capacity, probe->point_count + 1,
                                  sizeof *probe->points, NULL));
        simplify_fan_point *point = &probe->points[probe->point_count++];
        const double was = (double)samples->items[s].gap, most = fmax(was * was * grown, probe->most * probe->most);
        point->sample = s;
        point->near = SIMPLIFY_NOWHERE;
        simplify_between(at, samples->items[s].at, point->at);
        if (!probe->sums && own != SIMPLIFY_NOWHERE && hewn_simplify_fan_is_within(&probe->fan, own, point->at, most))
            point->near = deferred;
    }
    return HEWN_OK;
}

/* Those that have been taken since `from` go to the triangles nearest to them. */
static void place_samples(const simplify_samples *samples, size_t from, simplify_probe *probe)
{
    hewn_simplify_fan_nearest(&probe->fan, probe->points + from, probe->point_count - from);
    for (size_t i = from; i < probe->point_count; i++) {
        if (probe->points[i].near == deferred)
            continue;
        const simplify_sample *sample = &samples->items[probe->points[i].sample];
        const double was = (double)sample->gap, square = probe->points[i].square;
        probe->before += (double)sample->weight * was * was;
        probe->after += (double)sample->weight * square;
        if (square > was * was * grown && square > probe->most * probe->most)
            probe->most = sqrt(square);
    }
    probe->cut = probe->most > probe->plenty;
}

/* --- back to the input -------------------------------------------------------------------------------------------- */

/* Whether the side that a triangle shares with the one before may stand out: it does not where the two go on in much
 * the same way, for then samples of both tell. */
static bool is_ridge(const simplify_fan *fan, uint32_t face)
{
    const uint32_t before = (face > 0 ? face : fan->count) - 1, lane = face % SIMPLIFY_FOUR;
    const simplify_fan_block *block = &fan->blocks[face / SIMPLIFY_FOUR], *last = &fan->blocks[before / SIMPLIFY_FOUR];
    double n[3], m[3];
    for (int axis = 0; axis < 3; axis++)
        if (block->p[axis][lane] < last->q[axis][before % SIMPLIFY_FOUR] ||
            block->p[axis][lane] > last->q[axis][before % SIMPLIFY_FOUR])
            return true;
    simplify_fan_vector(block->across[3][0], lane, n);
    simplify_fan_vector(last->across[3][0], before % SIMPLIFY_FOUR, m);
    const double along = simplify_dot(n, m);
    return !(along > 0) || along * along * block->inverse[3][lane] * last->inverse[3][before % SIMPLIFY_FOUR] <
                               ridge_cosine * ridge_cosine;
}

static void add_mark(simplify_probe *probe, uint32_t face, mark_kind kind, const double at[3])
{
    simplify_mark_block *block = &probe->blocks[probe->mark_count / SIMPLIFY_FOUR];
    for (int axis = 0; axis < 3; axis++)
        for (uint32_t lane = probe->mark_count % SIMPLIFY_FOUR; lane < SIMPLIFY_FOUR; lane++)
            block->at[axis][lane] = at[axis];
    probe->marks[probe->mark_count++] = (probe_mark){face, kind};
}

/* The vertex, then of each triangle the middle of a side where it may stand out, and its own. */
static hewn_result list_marks(simplify_probe *probe)
{
    const simplify_fan *fan = &probe->fan;
    const size_t most = 1 + 2 * (size_t)fan->count;
    HEWN_TRY(hewn_reserve((void **)&probe->marks, &probe->mark_capacity, most, sizeof *probe->marks, NULL));
    HEWN_TRY(hewn_reserve((void **)&probe->blocks, &probe->block_capacity, most / SIMPLIFY_FOUR + 1,
                          sizeof *probe->blocks, NULL));
    probe->mark_count = 0;
    add_mark(probe, 0, MARK_VERTEX, (const double[3]){0});
    for (uint32_t f = 0; f < fan->count; f++) {
        double p[3], q[3], side[3], middle[3];
        simplify_fan_vector(fan->blocks[f / SIMPLIFY_FOUR].p[0], f % SIMPLIFY_FOUR, p);
        simplify_fan_vector(fan->blocks[f / SIMPLIFY_FOUR].q[0], f % SIMPLIFY_FOUR, q);
        for (int axis = 0; axis < 3; axis++) {
            side[axis] = p[axis] / 2;
            middle[axis] = (p[axis] + q[axis]) / 3;
        }
        if (is_ridge(fan, f))
            add_mark(probe, f, MARK_RIDGE, side);
        if (fan->blocks[f / SIMPLIFY_FOUR].inverse[3][f % SIMPLIFY_FOUR] > 0)
            add_mark(probe, f, MARK_MIDDLE, middle);
    }
    return HEWN_OK;
}

/* The nearest to a point of the input's triangles around a sample; the first within `enough` will do. */
static uint32_t look_around(const simplify_samples *samples, uint32_t sample, const double at[3], double enough,
                            double *least)
{
    uint32_t near = 0;
    *least = INFINITY;
    for (uint32_t i = samples->rings[sample]; i < samples->rings[sample + 1] && *least > enough; i++) {
        const uint32_t *corner = samples->input.corners + 3 * (size_t)samples->faces[i];
        const double distance =
            hewn_triangle_reach(at, samples->positions + 3 * (size_t)corner[0],
                                samples->positions + 3 * (size_t)corner[1], samples->positions + 3 * (size_t)corner[2]);
        near = distance < *least ? samples->faces[i] : near;
        *least = distance < *least ? distance : *least;
    }
    return near;
}

/* What makes no difference any more. */
static double enough_of(const simplify_probe *probe)
{
    return fmax(probe->enough, fmax(probe->most, probe->back));
}

/* How far a point is from the input, where that makes a difference; a sample, one of the input's vertices, is near it,
 * `square` the squared distance. */
static void reach_back(const simplify_samples *samples, uint32_t sample, double square, const double at[3],
                       simplify_probe *probe)
{
    const double enough = enough_of(probe);
    double least;
    if (square < enough * enough)
        return;
    const uint32_t near = look_around(samples, sample, at, enough, &least);
    if (!(least <= enough)) {
        (void)hewn_bvh_nearest_within(&samples->bvh, &samples->input, at, near, enough, &least);
        probe->back = fmax(least, probe->back);
    }
}

/* The triangle of the input near a point: of those around the nearest sample, or of all where that is not near enough
 * to make no difference. */
static uint32_t look_back(const simplify_samples *samples, uint32_t sample, const double at[3], simplify_probe *probe)
{
    const double enough = enough_of(probe);
    double least;
    uint32_t near = look_around(samples, sample, at, -1, &least);
    if (!(least <= enough)) {
        near = hewn_bvh_nearest(&samples->bvh, &samples->input, at, near, &least);
        probe->back = fmax(least, probe->back);
    }
    return near;
}

/* Whether a triangle of the input faces away from a normal. */
static bool faces_away(const simplify_samples *samples, uint32_t near, const double normal[3])
{
    double n[3];
    hewn_triangle_normal(&samples->input, near, n);
    return simplify_dot(normal, n) < 0;
}

/* Whether the surface around a sample faces so much as a triangle does that all of it will. */
static bool is_along(const simplify_sample *sample, const double normal[3])
{
    const double n[3] = {(double)sample->normal[0], (double)sample->normal[1], (double)sample->normal[2]};
    const double along = simplify_dot(normal, n);
    return along > 0 && along * along > least_along * simplify_dot(n, n) * simplify_dot(normal, normal);
}

static hewn_result look_at_marks(const simplify_samples *samples, const double at[3], simplify_probe *probe)
{
    HEWN_TRY(list_marks(probe));
    memcpy(probe->place, at, sizeof probe->place);
    hewn_simplify_find_marks(probe->points, probe->point_count, probe->blocks,
                             (probe->mark_count + SIMPLIFY_FOUR - 1) / SIMPLIFY_FOUR);
    for (size_t i = 0; i < probe->mark_count && !probe->cut; i++) {
        const simplify_mark_block *block = &probe->blocks[i / SIMPLIFY_FOUR];
        const uint32_t lane = i % SIMPLIFY_FOUR, f = probe->marks[i].face;
        const uint32_t sample = probe->points[block->nearest[lane]].sample;
        double place[3], normal[3];
        simplify_fan_vector(block->at[0], lane, place);
        for (int axis = 0; axis < 3; axis++)
            place[axis] += at[axis];
        if (probe->marks[i].kind != MARK_MIDDLE) {
            reach_back(samples, sample, block->square[lane], place, probe);
        } else {
            simplify_fan_vector(probe->fan.blocks[f / SIMPLIFY_FOUR].across[3][0], f % SIMPLIFY_FOUR, normal);
            if (!is_along(&samples->items[sample], normal))
                probe->turned |= faces_away(samples, look_back(samples, sample, place, probe), normal);
        }
        probe->cut = (probe->refuses && probe->back > probe->plenty) || (probe->gain > 0 && probe->turned);
    }
    return HEWN_OK;
}

static hewn_result place_all(const simplify_work *work, const double at[3], simplify_probe *probe)
{
    const simplify_samples *samples = work->samples;
    probe->cut = probe->fan.count == 0 && probe->gain > 0;
    if (probe->fan.count == 0)
        return HEWN_OK;
    HEWN_TRY(hewn_simplify_fan_settle(&probe->fan));
    for (int i = 0; i < 2; i++) /* what has most to lose first */
        if (probe->cleared[i] != HEWN_NONE)
            HEWN_TRY(take_samples(samples, probe->cleared[i], SIMPLIFY_NOWHERE, at, probe));
    place_samples(samples, 0, probe);
    size_t placed = probe->point_count;
    for (uint32_t f = 0; f < probe->fan.count && !probe->cut; f++) {
        HEWN_TRY(take_samples(samples, face_of(probe, f), f, at, probe));
        if (f + 1 < probe->fan.count && probe->point_count - placed < AT_ONCE)
            continue;
        place_samples(samples, placed, probe);
        placed = probe->point_count;
    }
    probe->cut |= probe->gain > 0 && !(probe->after < probe->gain * probe->before);
    if (probe->point_count == 0 || probe->cut)
        return HEWN_OK;
    return look_at_marks(samples, at, probe);
}

static void begin(simplify_probe *probe)
{
    probe->fan.count = 0;
    probe->point_count = probe->mark_count = 0;
    probe->cleared[0] = probe->cleared[1] = HEWN_NONE;
    probe->back = probe->most = probe->before = probe->after = 0;
    probe->turned = probe->cut = false;
}

hewn_result hewn_simplify_probe_collapse(const simplify_work *work, const simplify_plan *plan, simplify_probe *probe)
{
    begin(probe);
    HEWN_TRY(take_fan(work, plan->gone, plan->kept, plan->at, probe));
    HEWN_TRY(take_fan(work, plan->kept, plan->gone, plan->at, probe));
    return place_all(work, plan->at, probe);
}

hewn_result hewn_simplify_probe_move(const simplify_work *work, uint32_t v, const double to[3], simplify_probe *probe)
{
    begin(probe);
    HEWN_TRY(take_fan(work, v, HEWN_NONE, to, probe));
    return place_all(work, to, probe);
}

hewn_result hewn_simplify_probe_swap(const simplify_work *work, uint32_t h, simplify_probe *probe)
{
    const uint32_t t = work->twin[h], c = work->tail[simplify_prev(h)];
    const double *at = simplify_at(work, c);
    double to_a[3], to_b[3], to_d[3];
    simplify_between(at, simplify_at(work, work->tail[h]), to_a);
    simplify_between(at, simplify_at(work, work->tail[t]), to_b);
    simplify_between(at, simplify_at(work, work->tail[simplify_prev(t)]), to_d);
    begin(probe);
    HEWN_TRY(hewn_simplify_fan_add(&probe->fan, h / 3, to_a, to_d));
    HEWN_TRY(hewn_simplify_fan_add(&probe->fan, t / 3, to_d, to_b));
    return place_all(work, at, probe);
}

hewn_result hewn_simplify_probe_split(const simplify_work *work, const simplify_split *split, simplify_probe *probe)
{
    const uint32_t h = split->half, t = work->twin[h];
    const uint32_t corners[4] = {work->tail[h], work->tail[simplify_prev(t)], work->tail[t],
                                 work->tail[simplify_prev(h)]}; /* a, d, b, c */
    const uint32_t faces[4] = {t / 3, split->faces[1], split->faces[0], h / 3};
    const double *at = work->samples->items[split->sample].at;
    double towards[4][3];
    begin(probe);
    for (int k = 0; k < 4; k++)
        simplify_between(at, simplify_at(work, corners[k]), towards[k]);
    for (int k = 0; k < 4; k++)
        HEWN_TRY(hewn_simplify_fan_add(&probe->fan, faces[k], towards[k], towards[(k + 1) % 4]));
    return place_all(work, at, probe);
}

static void place_deferred(simplify_probe *probe)
{
    for (size_t i = 0; i < probe->point_count; i++)
        probe->points[i].near = probe->points[i].near == deferred ? SIMPLIFY_NOWHERE : probe->points[i].near;
    hewn_simplify_fan_nearest(&probe->fan, probe->points, probe->point_count);
}

void hewn_simplify_probe_settle(const simplify_work *work, simplify_probe *probe)
{
    simplify_samples *samples = work->samples;
    place_deferred(probe);
    for (uint32_t f = 0; f < probe->fan.count; f++)
        samples->first[face_of(probe, f)] = HEWN_NONE;
    for (int i = 0; i < 2; i++)
        if (probe->cleared[i] != HEWN_NONE)
            samples->first[probe->cleared[i]] = HEWN_NONE;
    for (size_t i = probe->point_count; i-- > 0;) {
        const simplify_fan_point *point = &probe->points[i];
        uint32_t *first = &samples->first[face_of(probe, point->near)];
        samples->items[point->sample].gap = (float)sqrt(point->square);
        samples->items[point->sample].next = *first;
        *first = point->sample;
    }
}
