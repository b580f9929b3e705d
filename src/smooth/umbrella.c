/* Methods of uniform weights: the umbrella operator is the mean of a vertex' neighbours less the vertex. */
#include <string.h>

#include "base/alloc.h"
#include "smooth/work.h"

/* Two neighbouring numbers, at any place where a double may be. */
typedef double pair __attribute__((vector_size(2 * sizeof(double)), aligned(sizeof(double)), may_alias));

/* The sum of three numbers each of those that a row names, in the row's order. */
static inline void sum_row(const double *from, const uint32_t *row, const uint32_t *end, double out[3])
{
    pair sum = {0, 0};
    double last = 0;
    for (; row < end; row++) {
        const double *item = from + 3 * (size_t)*row;
        sum += *(const pair *)item;
        last += item[2];
    }
    out[0] = sum[0];
    out[1] = sum[1];
    out[2] = last;
}

/* A vertex after a step of `factor` towards the mean of its neighbours; one without neighbours stays. */
static inline void step(const smooth_work *work, double factor, const double *from, uint32_t v, double out[3])
{
    const uint32_t begin = work->neighbours.first[v], end = work->neighbours.first[v + 1];
    const double *x = from + 3 * (size_t)v;
    const double share = end > begin ? 1.0 / (end - begin) : 0;
    const double free = end > begin ? factor * smooth_freedom(work, v) : 0;
    double sum[3];
    sum_row(from, work->neighbours.items + begin, work->neighbours.items + end, sum);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = x[axis] + free * (sum[axis] * share - x[axis]);
}

/* Each vertex is gathered by itself in the order of its row, so the result does not depend on threads. */
static void sweep(const smooth_work *work, double factor, const double *from, double *to)
{
    const smooth_work held = *work;
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < held.count; v++)
        step(&held, factor, from, v, to + 3 * (size_t)v);
}

static hewn_result report(const smooth_work *work, uint32_t done, hewn_error *error)
{
    return hewn_progress_report(work->desc->progress, "smooth", (double)done / work->desc->iterations, error);
}

hewn_result hewn_smooth_umbrella(smooth_work *work, hewn_error *error)
{
    const hewn_smooth_desc *desc = work->desc;
    double lambda = desc->strength, mu = 1 / (1 / lambda - desc->passband);
    for (uint32_t i = 0; i < desc->iterations; i++) {
        HEWN_TRY(report(work, i, error));
        sweep(work, lambda, work->at, work->next);
        smooth_swap(work);
        if (desc->method == HEWN_SMOOTH_TAUBIN) {
            sweep(work, -mu, work->at, work->next);
            smooth_swap(work);
        }
    }
    return HEWN_OK;
}

/* --- HC ----------------------------------------------------------------------------------------------------------- */

/* What a step takes too far: pull = q - (original * o + (1 - original) * p), for p that the step would make q and that
 * was o at the start. Then p becomes q - (push * pull + (1 - push) * mean of the neighbours' pulls). */
typedef struct hc_state {
    smooth_work work;
    const double *start; /* NULL where `original` is 0 */
    double original, push, *pull;
} hc_state;

/* Where the pull of a vertex is counted from. */
static inline double hc_origin(const hc_state *state, size_t i)
{
    return state->start ? state->original * state->start[i] + (1 - state->original) * state->work.at[i]
                        : state->work.at[i];
}

static void measure_pull(const hc_state *all)
{
    const hc_state state = *all;
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < state.work.count; v++) {
        double to[3];
        step(&state.work, 1, state.work.at, v, to);
        for (size_t axis = 0; axis < 3; axis++)
            state.pull[3 * (size_t)v + axis] = to[axis] - hc_origin(&state, 3 * (size_t)v + axis);
    }
}

static void push_back(const hc_state *all)
{
    const hc_state state = *all;
    const smooth_rows *rows = &state.work.neighbours;
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < state.work.count; v++) {
        const uint32_t begin = rows->first[v], end = rows->first[v + 1];
        const double share = end > begin ? (1 - state.push) / (end - begin) : 0;
        const double free = end > begin ? smooth_freedom(&state.work, v) : 0;
        double sum[3];
        sum_row(state.pull, rows->items + begin, rows->items + end, sum);
        for (size_t axis = 0; axis < 3; axis++) {
            const size_t i = 3 * (size_t)v + axis;
            const double pull = state.pull[i];
            state.work.at[i] = pull + hc_origin(&state, i) - free * (state.push * pull + sum[axis] * share);
        }
    }
}

hewn_result hewn_smooth_hc(smooth_work *work, hewn_error *error)
{
    const size_t numbers = 3 * (size_t)work->count;
    const hewn_smooth_desc *desc = work->desc;
    double *start = desc->original > 0 ? hewn_alloc(numbers, sizeof *start) : NULL;
    if (desc->original > 0 && !start)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    if (start)
        memcpy(start, work->at, numbers * sizeof *start);
    const hc_state state = {*work, start, desc->original, desc->push, work->next};
    hewn_result result = HEWN_OK;
    for (uint32_t i = 0; i < desc->iterations && result == HEWN_OK; i++) {
        result = report(work, i, error);
        if (result != HEWN_OK)
            break;
        measure_pull(&state);
        push_back(&state);
    }
    hewn_free(start);
    return result;
}
