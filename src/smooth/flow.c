/* Mean curvature flow in explicit steps, by weights that are measured at the start and kept, as those of backward Euler
 * are; or measured anew now and then. */
#include <string.h>

#include "base/alloc.h"
#include "base/clones.h"
#include "smooth/blocks.h"
#include "smooth/cotangent.h"

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

/* Corners that are weighed at a time: the products of the edges u and v from each to the vertices after and before it in
 * its triangle, and what comes of them. */
enum { BATCH = 384, LANES = 8 };
typedef struct corner_batch {
    double uu[BATCH], vv[BATCH], uv[BATCH], area[BATCH];
    float to_next[BATCH], to_before[BATCH]; /* weights of the edges */
} corner_batch;

static HEWN_INTO_CLONES void gather(const double *at, uint32_t v, const smooth_side *sides, uint32_t begin,
                                    uint32_t end, corner_batch *out)
{
    for (uint32_t i = begin; i < end; i++) {
        double next[3], before[3];
        smooth_between(at + 3 * (size_t)v, at + 3 * (size_t)sides[i].next, next);
        smooth_between(at + 3 * (size_t)v, at + 3 * (size_t)sides[i].before, before);
        out->uu[i] = smooth_dot(next, next);
        out->vv[i] = smooth_dot(before, before);
        out->uv[i] = smooth_dot(next, before);
    }
}

static HEWN_INTO_CLONES void measure_batch(corner_batch *batch, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const smooth_corner corner = smooth_corner_between(batch->uu[i], batch->vv[i], batch->uv[i]);
        batch->to_next[i] = (float)corner.ab;
        batch->to_before[i] = (float)corner.ac;
        batch->area[i] = corner.area;
    }
}

/* Adds what a corner gives to the edges of a row. */
static HEWN_INTO_CLONES void add_corner(const smooth_side *side, float to_next, float to_before, const uint32_t *row,
                                        uint32_t length, float *weights)
{
    for (uint32_t k = 0; k < length; k++)
        weights[k] += (row[k] == side->next ? to_next : 0) + (row[k] == side->before ? to_before : 0);
}

/* The vertex whose corners are being weighed. */
typedef struct flow_vertex {
    uint32_t v;
    double sum, area; /* of the weights' sizes, and the mixed area */
    uint64_t clamped; /* of those before */
} flow_vertex;

static HEWN_INTO_CLONES void add_corners(const flow_weights *weights, const smooth_side *sides,
                                         const corner_batch *batch, uint32_t begin, uint32_t end, flow_vertex *at)
{
    const uint32_t place = weights->rows->first[at->v], length = weights->rows->first[at->v + 1] - place;
    const uint32_t *row = weights->rows->items + place;
    for (uint32_t i = begin; i < end; i++) {
        add_corner(sides + i, batch->to_next[i], batch->to_before[i], row, length, weights->items + place);
        at->sum += (double)(fabsf(batch->to_next[i]) + fabsf(batch->to_before[i]));
        at->area += batch->area[i];
    }
}

/* A vertex of area A and weights w moves by t / A of its pull. Gershgorin's circles keep the eigenvalues of the step
 * within 2 where t / A is at most 1 / sum |w|, so no vertex goes further. */
static HEWN_INTO_CLONES void finish_vertex(const smooth_work *work, const flow_weights *weights, double time,
                                           flow_vertex *at)
{
    const double free = work->flags[at->v] & SMOOTH_RIM ? 0 : smooth_freedom(work, at->v);
    const bool far = free > 0 && time * at->sum > at->area;
    const double factor = !(at->sum > 0) ? 0 : free * (far ? 1 / at->sum : time / at->area);
    for (uint32_t i = weights->rows->first[at->v]; i < weights->rows->first[at->v + 1]; i++)
        weights->items[i] = (float)((double)weights->items[i] * factor);
    *at = (flow_vertex){at->v + 1, 0, 0, at->clamped + far};
}

/* Returns how many vertices could not go as far as they should. */
HEWN_CLONES static uint64_t weigh_block(const smooth_work *work, const flow_weights *weights, double time,
                                        uint32_t begin, uint32_t end)
{
    const uint32_t *first = work->sides.first;
    flow_vertex at = {begin, 0, 0, 0};
    corner_batch batch;
    memset(weights->items + weights->rows->first[begin], 0,
           (weights->rows->first[end] - weights->rows->first[begin]) * sizeof *weights->items);
    for (uint32_t place = first[begin]; at.v < end; place += BATCH) {
        const smooth_side *sides = work->sides.items + place;
        const uint32_t count = first[end] - place < BATCH ? first[end] - place : BATCH;
        for (uint32_t v = at.v, i = 0; i < count; v++) {
            const uint32_t stop = first[v + 1] - place < count ? first[v + 1] - place : count;
            gather(work->at, v, sides, i, stop, &batch);
            i = stop;
        }
        measure_batch(&batch, count);
        for (uint32_t i = 0; at.v < end;) {
            const uint32_t stop = first[at.v + 1] - place < count ? first[at.v + 1] - place : count;
            add_corners(weights, sides, &batch, i, stop, &at);
            if (place + stop < first[at.v + 1])
                break;
            finish_vertex(work, weights, time, &at);
            i = stop;
        }
    }
    return at.clamped;
}

static void weigh(const smooth_work *work, const flow_weights *weights)
{
    const double time = work->desc->step * work->desc->step / 2;
    uint64_t clamped = 0;
#pragma omp parallel for schedule(static) reduction(+ : clamped)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
        clamped +=
            weigh_block(work, weights, time, (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block),
                        (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block + 1));
    work->report->clamped_vertices = clamped;
}

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
