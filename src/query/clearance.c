/* How far two solids are apart: pairs of boxes, one of each, the nearest pair first. */
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/progress.h"
#include "query/heap.h"
#include "query/internal.h"

/* A box of each, and what the other field's slope says of how far they are from the other solid. */
typedef struct pair {
    float lower;
    hewn_search_box box[2];
    float apart[2];
} pair;

_Static_assert(sizeof(pair) <= HEWN_HEAP_MOST, "a pair fits into a heap");

typedef struct search {
    hewn_asker asker[2];
    double slope[2]; /* bounds, in both boxes and between; infinite where unknown */
    hewn_heap heap;  /* of pairs */
    float high, point[2][3];
    float unseen, tolerance, fine;
    uint32_t most_boxes;
} search;

/* --- places ---------------------------------------------------------------------------------------------------------
 */

static bool holds(search *s, int which, const float p[3])
{
    return hewn_query_holds(s->asker[which].query, p) && hewn_ask_value(&s->asker[which], p) <= 0;
}

/* A point of a solid in or near a box; false where none is found. */
static bool find_point(search *s, int which, const hewn_search_box *box, float p[3])
{
    float normal[3];
    for (int axis = 0; axis < 3; axis++)
        p[axis] = 0.5F * (box->lo[axis] + box->hi[axis]);
    if (holds(s, which, p))
        return true;
    if (!hewn_ask_project(&s->asker[which], p, 2 * hewn_apart(box->lo, box->hi), normal))
        return false;
    for (int axis = 0; axis < 3; axis++)
        p[axis] -= 0.5F * s->fine * normal[axis];
    return holds(s, which, p);
}

static void take(search *s, float points[2][3])
{
    float apart = hewn_apart(points[0], points[1]);
    if (!(apart < s->high))
        return;
    s->high = apart;
    memcpy(s->point, points, sizeof s->point);
}

/* The part of the way between two points that is in neither solid: ends of it are the surfaces. */
static void shorten(search *s, float points[2][3])
{
    for (int which = 0; which < 2; which++) {
        float outside, inside;
        if (holds(s, which, points[1 - which])) { /* one solid has both */
            memcpy(points[which], points[1 - which], sizeof points[which]);
            return;
        }
        if (!hewn_ask_entry(&s->asker[which], points[1 - which], points[which], &outside, &inside))
            continue;
        float end[3];
        for (int axis = 0; axis < 3; axis++)
            end[axis] = points[1 - which][axis] + inside * (points[which][axis] - points[1 - which][axis]);
        if (holds(s, which, end))
            memcpy(points[which], end, sizeof end);
    }
}

/* Along the surfaces to where they are nearest, one and the other in turn. */
static void approach(search *s, float points[2][3])
{
    enum { ROUNDS = 16 };
    float before = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        shorten(s, points);
        float apart = hewn_apart(points[0], points[1]);
        take(s, points);
        if (!(apart < before - 0.5F * s->fine) || apart == 0)
            return;
        before = apart;
        for (int which = 0; which < 2; which++) {
            float p[3], normal[3];
            memcpy(p, points[which], sizeof p);
            if (!hewn_ask_project(&s->asker[which], p, 4 * s->fine, normal))
                continue;
            hewn_ask_approach(&s->asker[which], points[1 - which], p, normal);
            for (int axis = 0; axis < 3; axis++)
                p[axis] -= 0.5F * s->fine * normal[axis];
            if (holds(s, which, p))
                memcpy(points[which], p, sizeof p);
        }
    }
}

static void try_pair(search *s, const pair *at)
{
    float points[2][3];
    if (find_point(s, 0, &at->box[0], points[0]) && find_point(s, 1, &at->box[1], points[1]))
        approach(s, points);
}

/* --- searching ------------------------------------------------------------------------------------------------------
 */

/* No point of these boxes of one solid is nearer to the other than this, from the bounds of the other's field there. */
static void bound_apart(search *s, int which, const hewn_search_box *boxes, uint32_t count, float apart[8])
{
    hewn_asker *other = &s->asker[1 - which];
    const hewn_cell *root = other->query->octree.cells;
    hewn_lane_boxes lanes;
    float lo[HEWN_LANES], hi[HEWN_LANES], far = 0;
    memset(apart, 0, 8 * sizeof *apart);
    if (!isfinite(s->slope[1 - which]) || count == 0)
        return;
    for (uint32_t i = 0; i < HEWN_LANE_BLOCK; i++)
        for (int axis = 0; axis < 3; axis++) {
            const hewn_search_box *box = &boxes[i < count ? i : count - 1];
            lanes.lo[axis][i] = box->lo[axis];
            lanes.hi[axis][i] = box->hi[axis];
            far = fmaxf(far, fmaxf(fabsf(box->lo[axis]), fabsf(box->hi[axis])));
            far = fmaxf(far, fmaxf(fabsf(root->lo[axis]), fabsf(root->hi[axis])));
        }
    hewn_lanes_bound(other->query->octree.whole, &other->work, &lanes, HEWN_LANE_BLOCK, lo, hi);
    for (uint32_t i = 0; i < count; i++) {
        double free = ((double)lo[i] - 0x1p-18 * (double)far) / s->slope[1 - which];
        apart[i] = free > 0 ? (float)(free * (1 - 0x1p-20)) : 0;
    }
}

/* Which box to divide: one of which the other field's slope says much, as long as its size explains how far that is
 * from the best place, else the larger. */
static int choose(const search *s, const pair *at, const float size[2])
{
    int bounded = at->apart[0] >= at->apart[1] ? 0 : 1;
    if (at->apart[bounded] > 0.25F * s->high && s->high - at->apart[bounded] <= 3 * size[bounded] &&
        size[bounded] > fmaxf(0.25F * s->tolerance, s->fine))
        return bounded;
    return size[0] >= size[1] ? 0 : 1;
}

/* Divides a box of a pair. */
static hewn_result expand(search *s, const pair *at, hewn_error *error)
{
    hewn_search_box parts[8];
    float size[2], apart[8];
    for (int which = 0; which < 2; which++)
        size[which] = hewn_apart(at->box[which].lo, at->box[which].hi);
    if (fmaxf(size[0], size[1]) <= fmaxf(0.25F * s->tolerance, s->fine)) {
        try_pair(s, at);
        s->unseen = fminf(s->unseen, at->lower); /* a place that was found in it need not be its nearest */
        return HEWN_OK;
    }
    int which = choose(s, at, size);
    pair next = *at, best = {.lower = INFINITY};
    uint32_t count = hewn_search_divide(&s->asker[which], &at->box[which], true, parts);
    bound_apart(s, which, parts, count, apart);
    for (uint32_t i = 0; i < count; i++) {
        const hewn_search_box *other = &at->box[1 - which];
        next.box[which] = parts[i];
        next.apart[which] = fmaxf(at->apart[which], apart[i]);
        next.lower = hewn_length_between(parts[i].lo, parts[i].hi, other->lo, other->hi);
        next.lower = fmaxf(fmaxf(next.lower, at->lower), fmaxf(next.apart[0], next.apart[1]));
        if (!(next.lower < s->high))
            continue;
        best = next.lower < best.lower ? next : best;
        HEWN_TRY(hewn_heap_push(&s->heap, &next, error));
    }
    /* Only where the boxes leave room for a better place than the best so far. */
    float room = 0.5F * (hewn_apart(best.box[0].lo, best.box[0].hi) + hewn_apart(best.box[1].lo, best.box[1].hi));
    if (best.lower < INFINITY && best.lower + room < s->high)
        try_pair(s, &best);
    return HEWN_OK;
}

static hewn_result run(search *s, const hewn_progress *progress, bool *ran_out, hewn_error *error)
{
    pair root = {.box = {hewn_search_root(s->asker[0].query), hewn_search_root(s->asker[1].query)}};
    root.lower = hewn_length_between(root.box[0].lo, root.box[0].hi, root.box[1].lo, root.box[1].hi);
    HEWN_TRY(hewn_heap_push(&s->heap, &root, error));
    for (uint32_t divided = 0; s->heap.count > 0; divided++) {
        if (hewn_heap_least(&s->heap) >= s->high - s->tolerance || s->high == 0)
            return HEWN_OK;
        *ran_out = divided >= s->most_boxes;
        if (*ran_out)
            return HEWN_OK;
        if (divided % 256 == 0)
            HEWN_TRY(hewn_progress_report(progress, "query", (double)divided / s->most_boxes, error));
        pair at;
        hewn_heap_pop(&s->heap, &at);
        HEWN_TRY(expand(s, &at, error));
    }
    return HEWN_OK;
}

static void finish(const search *s, bool ran_out, hewn_clearance *out)
{
    float low = fminf(fminf(s->unseen, s->high), hewn_heap_least(&s->heap));
    out->found = s->high < INFINITY;
    out->overlap = s->high == 0;
    out->high = (double)s->high;
    out->low = fmax(0, (double)low - (low < INFINITY ? 2 * (double)s->fine : 0));
    out->complete = !ran_out && !(out->high - out->low > (double)(s->tolerance + 4 * s->fine));
    out->complete = out->complete || (!out->found && !(low < INFINITY));
    for (int which = 0; which < 2; which++)
        for (int axis = 0; axis < 3; axis++)
            out->points[which][axis] = out->found ? (double)s->point[which][axis] : 0;
}

hewn_result hewn_query_clearance(hewn_query *a, hewn_query *b, const hewn_query_desc *desc, hewn_clearance *out,
                                 hewn_error *error)
{
    *out = (hewn_clearance){0};
    hewn_box all;
    hewn_query_limits limits;
    double diagonal = fmax(a->diagonal, b->diagonal);
    search s = {.heap.size = sizeof(pair), .high = INFINITY, .unseen = INFINITY, .fine = fmaxf(a->fine, b->fine)};
    HEWN_TRY(hewn_query_find_limits(desc, 1e-3 * diagonal, s.fine, INFINITY, &limits, error));
    s.tolerance = limits.tolerance;
    s.most_boxes = limits.most_boxes;
    for (int axis = 0; axis < 3; axis++) {
        all.lo[axis] = fmin(a->box.lo[axis], b->box.lo[axis]);
        all.hi[axis] = fmax(a->box.hi[axis], b->box.hi[axis]);
    }
    s.slope[0] = hewn_query_slope(a, &all);
    s.slope[1] = hewn_query_slope(b, &all);
    bool ran_out = false;
    hewn_result result = hewn_asker_create(a, &s.asker[0], error);
    if (result == HEWN_OK)
        result = hewn_asker_create(b, &s.asker[1], error);
    if (result == HEWN_OK)
        result = run(&s, desc ? desc->progress : NULL, &ran_out, error);
    if (result == HEWN_OK)
        finish(&s, ran_out, out);
    hewn_asker_destroy(&s.asker[0]);
    hewn_asker_destroy(&s.asker[1]);
    hewn_heap_free(&s.heap);
    return result;
}
