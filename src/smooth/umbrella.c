/* Methods of uniform weights: the umbrella operator is the mean of a vertex' neighbours less the vertex. */
#include <string.h>

#include "base/alloc.h"
#include "base/clones.h"
#include "smooth/blocks.h"
#include "smooth/work.h"

/* The sum of four numbers each of the vertices that a row names, in the row's order: a position, and whatever follows.
 */
static HEWN_INTO_CLONES void sum_row(const double *from, const uint32_t *row, const uint32_t *end, double out[4])
{
    double sum[4] = {0, 0, 0, 0};
    for (; row < end; row++) {
        const double *item = from + 3 * (size_t)*row;
        for (int lane = 0; lane < 4; lane++)
            sum[lane] += item[lane];
    }
    memcpy(out, sum, sizeof sum);
}

/* From a vertex to the mean of its neighbours, times `factor` and its freedom; nowhere for one without neighbours. */
static HEWN_INTO_CLONES void find_step(const smooth_work *work, double factor, const double *from, uint32_t v,
                                       double out[3])
{
    const uint32_t begin = work->neighbours.first[v], end = work->neighbours.first[v + 1];
    const double *x = from + 3 * (size_t)v;
    const double share = end > begin ? 1.0 / (end - begin) : 0;
    const double free = end > begin ? factor * smooth_freedom(work, v) : 0;
    double sum[4];
    sum_row(from, work->neighbours.items + begin, work->neighbours.items + end, sum);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = free * (sum[axis] * share - x[axis]);
}

/* Each vertex is gathered by itself in the order of its row, so the result does not depend on threads. */
HEWN_CLONES static void sweep_block(const smooth_work *work, double factor, const double *restrict from,
                                    double *restrict to, uint32_t begin, uint32_t end)
{
    const smooth_work held = *work;
    for (uint32_t v = begin; v < end; v++) {
        double step[3];
        find_step(&held, factor, from, v, step);
        for (size_t axis = 0; axis < 3; axis++)
            to[3 * (size_t)v + axis] = from[3 * (size_t)v + axis] + step[axis];
    }
}

static void sweep(smooth_work *work, double factor)
{
#pragma omp parallel for schedule(static)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
        sweep_block(work, factor, work->at, work->next, (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block),
                    (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block + 1));
    smooth_swap(work);
}

static hewn_result report(const smooth_work *work, uint32_t done, hewn_error *error)
{
    return hewn_progress_report(work->desc->progress, "smooth", (double)done / work->desc->iterations, error);
}

hewn_result hewn_smooth_umbrella(smooth_work *work, hewn_error *error)
{
    const hewn_smooth_desc *desc = work->desc;
    double lambda = desc->strength, mu = 1 / (1 / lambda - desc->passband);
    HEWN_TRY(hewn_smooth_take_room(work, error));
    for (uint32_t i = 0; i < desc->iterations; i++) {
        HEWN_TRY(report(work, i, error));
        sweep(work, lambda);
        if (desc->method == HEWN_SMOOTH_TAUBIN)
            sweep(work, -mu);
    }
    return HEWN_OK;
}

/* --- HC ----------------------------------------------------------------------------------------------------------- */

/* What a step takes too far: pull = q - (original * o + (1 - original) * p), for p that the step would make q and that
 * was o at the start. Then p becomes q - (push * pull + (1 - push) * mean of the neighbours' pulls). */
typedef struct hc_state {
    const smooth_work *work;
    const double *start; /* positions at the start; those now where `original` is 0 */
    double original, push, *pull;
} hc_state;

/* Where the pull of a vertex is counted from. */
static inline double hc_origin(const hc_state *state, const double *at, size_t i)
{
    return state->original * state->start[i] + (1 - state->original) * at[i];
}

HEWN_CLONES static void measure_pull(const hc_state *all, uint32_t begin, uint32_t end)
{
    const hc_state state = *all;
    const smooth_work work = *state.work;
    for (uint32_t v = begin; v < end; v++) {
        double step[3];
        find_step(&work, 1, work.at, v, step);
        for (size_t axis = 0; axis < 3; axis++) {
            const size_t i = 3 * (size_t)v + axis;
            state.pull[i] = work.at[i] + step[axis] - hc_origin(&state, work.at, i);
        }
    }
}

HEWN_CLONES static void push_back(const hc_state *all, uint32_t begin, uint32_t end)
{
    const hc_state state = *all;
    const smooth_work work = *state.work;
    for (uint32_t v = begin; v < end; v++) {
        const uint32_t row = work.neighbours.first[v], row_end = work.neighbours.first[v + 1];
        const double share = row_end > row ? (1 - state.push) / (row_end - row) : 0;
        const double free = row_end > row ? smooth_freedom(&work, v) : 0;
        double sum[4];
        sum_row(state.pull, work.neighbours.items + row, work.neighbours.items + row_end, sum);
        for (size_t axis = 0; axis < 3; axis++) {
            const size_t i = 3 * (size_t)v + axis;
            const double pull = state.pull[i];
            work.at[i] = pull + hc_origin(&state, work.at, i) - free * (state.push * pull + sum[axis] * share);
        }
    }
}

static void hc_step(const hc_state *state)
{
    const uint64_t count = state->work->count;
#pragma omp parallel
    {
#pragma omp for schedule(static)
        for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
            measure_pull(state, (uint32_t)smooth_block_begin(count, SMOOTH_BLOCKS, block),
                         (uint32_t)smooth_block_begin(count, SMOOTH_BLOCKS, block + 1));
#pragma omp for schedule(static)
        for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
            push_back(state, (uint32_t)smooth_block_begin(count, SMOOTH_BLOCKS, block),
                      (uint32_t)smooth_block_begin(count, SMOOTH_BLOCKS, block + 1));
    }
}

hewn_result hewn_smooth_hc(smooth_work *work, hewn_error *error)
{
    const size_t numbers = 3 * (size_t)work->count;
    const hewn_smooth_desc *desc = work->desc;
    HEWN_TRY(hewn_smooth_take_room(work, error));
    double *start = desc->original > 0 ? hewn_alloc(numbers, sizeof *start) : NULL;
    if (desc->original > 0 && !start)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    if (start)
        memcpy(start, work->at, numbers * sizeof *start);
    const hc_state state = {work, start ? start : work->at, desc->original, desc->push, work->next};
    hewn_result result = HEWN_OK;
    for (uint32_t i = 0; i < desc->iterations && result == HEWN_OK; i++) {
        result = report(work, i, error);
        if (result != HEWN_OK)
            break;
        hc_step(&state);
    }
    hewn_free(start);
    return result;
}
