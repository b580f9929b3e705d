/* Mean curvature flow in explicit steps, by weights that are measured at the start and kept, as those of backward Euler
 * are; or measured anew now and then. */
#include "base/alloc.h"
#include "base/clones.h"
#include "smooth/blocks.h"
#include "smooth/cotangent.h"
#include "smooth/four.h"

/* The share of the way to each neighbour that a vertex goes in a step; floats, whose rounding moves no vertex by more
 * than some 1e-7 of an edge. */
typedef struct flow_weights {
    const smooth_rows *rows; /* of neighbours in triangles */
    smooth_rows owned;       /* those, where faces have been cut */
    float *items;            /* as `rows` has */
} flow_weights;

static hewn_result find_rows(const smooth_work *work, flow_weights *out, hewn_error *error)
{
    out->rows = &work->neighbours;
    if (work->polygons->first) {
        uint8_t *flags = hewn_alloc_zero(work->count, sizeof *flags);
        if (!flags)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
        hewn_result result = hewn_smooth_neighbours(&work->sides, &out->owned, flags, error);
        hewn_free(flags);
        HEWN_TRY(result);
        out->rows = &out->owned;
    }
    out->items = hewn_alloc(out->rows->first[work->count], sizeof *out->items);
    return out->items ? HEWN_OK
                      : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
}

/* What a vertex of area A and weights w goes of its pull: t / A. Gershgorin's circles keep the eigenvalues of the step
 * within 2 where t / A is at most 1 / sum |w|, so no vertex goes further; `*far` where it would have. */
static HEWN_INTO_CLONES double find_factor(const smooth_work *work, uint32_t v, double sum, double area, bool *far)
{
    const double time = work->desc->step * work->desc->step / 2;
    const double free = work->flags[v] & SMOOTH_RIM ? 0 : smooth_freedom(work, v);
    *far = free > 0 && time * sum > area;
    return free > 0 && sum > 0 ? free * (*far ? 1 / sum : time / area) : 0;
}

/* Any vertex, a corner at a time. Returns whether it would have gone too far. */
static bool weigh_long(const smooth_work *work, const flow_weights *weights, uint32_t v)
{
    const uint32_t begin = weights->rows->first[v], end = weights->rows->first[v + 1];
    const double *x = work->at + 3 * (size_t)v;
    double sum = 0, area = 0;
    bool far;
    for (uint32_t k = begin; k < end; k++)
        weights->items[k] = 0;
    for (uint32_t i = work->sides.first[v]; i < work->sides.first[v + 1]; i++) {
        const smooth_side side = work->sides.items[i];
        double next[3], before[3];
        smooth_between(x, work->at + 3 * (size_t)side.next, next);
        smooth_between(x, work->at + 3 * (size_t)side.before, before);
        const smooth_corner corner =
            smooth_corner_between(smooth_dot(next, next), smooth_dot(before, before), smooth_dot(next, before));
        for (uint32_t k = begin; k < end; k++)
            weights->items[k] += (float)((weights->rows->items[k] == side.next ? corner.ab : 0) +
                                         (weights->rows->items[k] == side.before ? corner.ac : 0));
        sum += fabs(corner.ab) + fabs(corner.ac);
        area += corner.area;
    }
    const double factor = find_factor(work, v, sum, area, &far);
    for (uint32_t k = begin; k < end; k++)
        weights->items[k] = (float)((double)weights->items[k] * factor);
    return far;
}

/* --- a batch of vertices ------------------------------------------------------------------------------------------ */

/* The corners of some vertices: the products of the edges u and v from each to the vertices after and before it in its
 * triangle, and what comes of them. Three sweeps, of which the middle one has a lane a corner. */
enum { BATCH = 384 };
typedef struct corner_batch {
    const smooth_side *sides;
    double uu[BATCH], vv[BATCH], uv[BATCH], area[BATCH];
    float to_next[BATCH], to_before[BATCH]; /* weights of the edges */
} corner_batch;

static HEWN_INTO_CLONES void gather(corner_batch *batch, const double *at, uint32_t v, uint32_t begin, uint32_t end)
{
    for (uint32_t i = begin; i < end; i++) {
        double next[3], before[3];
        smooth_between(at + 3 * (size_t)v, at + 3 * (size_t)batch->sides[i].next, next);
        smooth_between(at + 3 * (size_t)v, at + 3 * (size_t)batch->sides[i].before, before);
        batch->uu[i] = smooth_dot(next, next);
        batch->vv[i] = smooth_dot(before, before);
        batch->uv[i] = smooth_dot(next, before);
    }
}

static HEWN_INTO_CLONES void measure_corners(corner_batch *batch, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const smooth_corner corner = smooth_corner_between(batch->uu[i], batch->vv[i], batch->uv[i]);
        batch->to_next[i] = (float)corner.ab;
        batch->to_before[i] = (float)corner.ac;
        batch->area[i] = corner.area;
    }
}

/* What a corner gives to a neighbour among four. */
static HEWN_INTO_CLONES smooth_four_floats given(smooth_four names, const smooth_side *side, float to_next,
                                                 float to_before)
{
    const smooth_four_floats next = {to_next, to_next, to_next, to_next};
    const smooth_four_floats before = {to_before, to_before, to_before, to_before};
    return (smooth_four_floats)((smooth_four)next & (names == (int32_t)side->next)) +
           (smooth_four_floats)((smooth_four)before & (names == (int32_t)side->before));
}

/* A vertex of at most eight neighbours, whose corners are a range of the batch. What is written past its row is written
 * over by the rows that follow, up to `row_end`. */
static HEWN_INTO_CLONES bool weigh_short(const smooth_work *work, const flow_weights *weights,
                                         const corner_batch *batch, uint32_t v, uint32_t begin, uint32_t end,
                                         uint32_t row_end)
{
    const uint32_t place = weights->rows->first[v], length = weights->rows->first[v + 1] - place;
    smooth_eight names = {{{0}, {0}}};
    smooth_four_floats sums[2] = {{0}, {0}};
    double sum = 0, area = 0;
    bool far;
    smooth_eight_copy(&names, weights->rows->items + place, length, row_end - place);
    for (uint32_t i = begin; i < end; i++) {
        for (int half = 0; half < 2; half++)
            sums[half] += given(names.half[half], batch->sides + i, batch->to_next[i], batch->to_before[i]);
        sum += (double)(fabsf(batch->to_next[i]) + fabsf(batch->to_before[i]));
        area += batch->area[i];
    }
    const float factor = (float)find_factor(work, v, sum, area, &far);
    sums[0] *= factor;
    sums[1] *= factor;
    smooth_eight_copy(weights->items + place, sums, length, row_end - place);
    return far;
}

/* Vertices whose corners fill at most a batch. */
static HEWN_INTO_CLONES uint64_t weigh_batch(const smooth_work *work, const flow_weights *weights, uint32_t begin,
                                             uint32_t end, uint32_t row_end)
{
    const uint32_t *first = work->sides.first, place = first[begin];
    uint64_t far = 0;
    corner_batch batch;
    batch.sides = work->sides.items + place;
    for (uint32_t v = begin; v < end; v++)
        gather(&batch, work->at, v, first[v] - place, first[v + 1] - place);
    measure_corners(&batch, first[end] - place);
    for (uint32_t v = begin; v < end; v++)
        far += weights->rows->first[v + 1] - weights->rows->first[v] > SMOOTH_EIGHT
                   ? weigh_long(work, weights, v)
                   : weigh_short(work, weights, &batch, v, first[v] - place, first[v + 1] - place, row_end);
    return far;
}

/* Returns how many vertices could not go as far as they should. */
HEWN_CLONES static uint64_t weigh_block(const smooth_work *work, const flow_weights *weights, uint32_t begin,
                                        uint32_t end)
{
    const uint32_t *first = work->sides.first, row_end = weights->rows->first[end];
    uint64_t far = 0;
    for (uint32_t v = begin, next = begin; v < end; v = next) {
        while (next < end && first[next + 1] - first[v] <= BATCH)
            next++;
        far += next > v ? weigh_batch(work, weights, v, next, row_end) : weigh_long(work, weights, next++);
    }
    return far;
}

static void weigh(const smooth_work *work, const flow_weights *weights)
{
    uint64_t far = 0;
#pragma omp parallel for schedule(static) reduction(+ : far)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
        far += weigh_block(work, weights, (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block),
                           (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block + 1));
    work->report->clamped_vertices = far;
}

/* --- steps -------------------------------------------------------------------------------------------------------- */

HEWN_CLONES static void sweep_block(const flow_weights *weights, const double *restrict from, double *restrict to,
                                    uint32_t begin, uint32_t end)
{
    const smooth_rows *rows = weights->rows;
    for (uint32_t v = begin; v < end; v++) {
        const double *x = from + 3 * (size_t)v;
        double sum[4] = {0, 0, 0, 0};
        for (uint32_t i = rows->first[v]; i < rows->first[v + 1]; i++) {
            const double *item = from + 3 * (size_t)rows->items[i];
            const double weight = (double)weights->items[i];
            for (int lane = 0; lane < 4; lane++)
                sum[lane] += weight * (item[lane] - x[lane]);
        }
        for (size_t axis = 0; axis < 3; axis++)
            to[3 * (size_t)v + axis] = x[axis] + sum[axis];
    }
}

static void sweep(smooth_work *work, const flow_weights *weights)
{
#pragma omp parallel for schedule(static)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
        sweep_block(weights, work->at, work->next, (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block),
                    (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block + 1));
    smooth_swap(work);
}

/* Where weights are kept, their sides make room. */
static hewn_result prepare(smooth_work *work, flow_weights *weights, hewn_error *error)
{
    HEWN_TRY(find_rows(work, weights, error));
    if (work->desc->remeasure == 0) {
        weigh(work, weights);
        return hewn_smooth_take_room(work, error);
    }
    work->next = hewn_alloc(3 * (size_t)work->count + 1, sizeof *work->next);
    if (!work->next)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    work->next[3 * (size_t)work->count] = 0;
    return HEWN_OK;
}

hewn_result hewn_smooth_flow(smooth_work *work, hewn_error *error)
{
    const hewn_smooth_desc *desc = work->desc;
    flow_weights weights = {0};
    hewn_result result = prepare(work, &weights, error);
    for (uint32_t i = 0; i < desc->iterations && result == HEWN_OK; i++) {
        result = hewn_progress_report(desc->progress, "smooth", (double)i / desc->iterations, error);
        if (result != HEWN_OK)
            break;
        if (desc->remeasure > 0 && i % desc->remeasure == 0)
            weigh(work, &weights);
        sweep(work, &weights);
    }
    hewn_smooth_rows_free(&weights.owned);
    hewn_free(weights.items);
    return result;
}
