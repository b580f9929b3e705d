/* Methods of uniform weights: the umbrella operator is the mean of a vertex' neighbours less the vertex. */
#include <string.h>

#include "base/alloc.h"
#include "smooth/work.h"

/* to = from + factor * freedom * umbrella(from). Each vertex is gathered by itself in the order of its row, so the
 * result does not depend on threads. */
static void sweep(const smooth_work *work, double factor, const double *from, double *to)
{
    const uint32_t *first = work->neighbours.first, *items = work->neighbours.items;
    const double *freedom = work->freedom;
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < work->count; v++) {
        const double *x = from + 3 * (size_t)v;
        uint32_t begin = first[v], end = first[v + 1];
        double a = 0, b = 0, c = 0, share = end > begin ? 1.0 / (end - begin) : 0;
        for (uint32_t i = begin; i < end; i++) {
            const double *y = from + 3 * (size_t)items[i];
            a += y[0];
            b += y[1];
            c += y[2];
        }
        double free = end > begin ? (freedom ? factor * freedom[v] : factor) : 0;
        double *out = to + 3 * (size_t)v;
        out[0] = x[0] + free * (a * share - x[0]);
        out[1] = x[1] + free * (b * share - x[1]);
        out[2] = x[2] + free * (c * share - x[2]);
    }
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

/* What the step took too far: pull = p - (original * o + (1 - original) * q). */
static void measure_pull(const smooth_work *work, const double *start, double *pull)
{
    double original = work->desc->original;
    const double *before = work->at, *now = work->next;
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < work->count; v++)
        for (size_t i = 3 * (size_t)v; i < 3 * (size_t)v + 3; i++)
            pull[i] = now[i] - (original * start[i] + (1 - original) * before[i]);
}

/* p -= push * pull + (1 - push) * mean of the neighbours' pulls. */
static void push_back(const smooth_work *work, const double *pull)
{
    const uint32_t *first = work->neighbours.first, *items = work->neighbours.items;
    double push = work->desc->push;
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < work->count; v++) {
        uint32_t begin = first[v], end = first[v + 1];
        double sum[3] = {0, 0, 0}, free = smooth_freedom(work, v);
        for (uint32_t i = begin; i < end; i++)
            for (size_t axis = 0; axis < 3; axis++)
                sum[axis] += pull[3 * (size_t)items[i] + axis];
        for (size_t axis = 0; axis < 3 && end > begin; axis++) {
            double mean = sum[axis] / (end - begin);
            work->next[3 * (size_t)v + axis] -= free * (push * pull[3 * (size_t)v + axis] + (1 - push) * mean);
        }
    }
}

hewn_result hewn_smooth_hc(smooth_work *work, hewn_error *error)
{
    size_t numbers = 3 * (size_t)work->count;
    double *start = hewn_alloc(numbers, 2 * sizeof *start);
    if (!start)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    memcpy(start, work->at, numbers * sizeof *start);
    hewn_result result = HEWN_OK;
    for (uint32_t i = 0; i < work->desc->iterations && result == HEWN_OK; i++) {
        result = report(work, i, error);
        if (result != HEWN_OK)
            break;
        sweep(work, 1, work->at, work->next);
        measure_pull(work, start, start + numbers);
        push_back(work, start + numbers);
        smooth_swap(work);
    }
    hewn_free(start);
    return result;
}
