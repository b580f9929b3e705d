#include "simplify/balance.h"

#include "base/alloc.h"
#include "base/error.h"
#include "simplify/fit.h"
#include "simplify/state.h"

/* The last collapses are done again from where there are MORE times the triangles, or else twice as many. What came out
 * further away than `near_share` of the furthest gets more weight, by how many times it is further to that power: costs
 * go with the squares of distances times areas, and areas with distances. What is flipped counts as `flip_factor` times
 * too far. */
static const double near_share = 0.75, power = 3, flip_factor = 2;
enum { MORE = 4, ROUNDS = 2, MOST_ROUNDS = 3 };

typedef struct balance {
    simplify_work *work;
    simplify_state start, best;
    simplify_gauge gauge;
    simplify_gaps now;
    double *weight; /* one a vertex of the start */
    double best_most;
    uint32_t best_flips;
} balance;

static void reweigh(const balance *job)
{
    const simplify_work *start = &job->start.work;
    const double aim = near_share * job->now.most;
#pragma omp parallel for schedule(static) if (start->vertex_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < start->vertex_count; v++) {
        const uint32_t root = hewn_simplify_place(&job->gauge, start->origins[v]);
        if (root == HEWN_NONE)
            continue;
        const double far = aim > 0 ? (double)job->now.away[root] / aim : 0;
        const double factor = job->now.turned[root] ? fmax(far, flip_factor) : far;
        if (factor > 1)
            job->weight[v] *= pow(factor, power);
    }
}

/* The start again, with quadrics as heavy as they have become. */
static hewn_result begin_again(const balance *job, hewn_error *error)
{
    simplify_work *work = job->work;
    HEWN_TRY(hewn_simplify_restore(&job->start, work, error));
    for (uint32_t v = 0; v < work->vertex_count; v++)
        if (job->weight[v] > 1)
            simplify_quadric_scale(&work->quadrics[v], job->weight[v]);
    hewn_simplify_key(work);
    return HEWN_OK;
}

static hewn_result prepare(balance *job, const hewn_polygons *input, hewn_error *error)
{
    const simplify_work *work = job->work;
    HEWN_TRY(hewn_simplify_save(work, &job->start, error));
    HEWN_TRY(hewn_simplify_gauge_make(work, input, &job->gauge, error));
    job->now.away = hewn_alloc(work->vertex_count, sizeof *job->now.away);
    job->now.turned = hewn_alloc(work->vertex_count, 1);
    job->weight = hewn_alloc(work->vertex_count, sizeof *job->weight);
    if (!job->now.away || !job->now.turned || !job->weight)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (uint32_t v = 0; v < work->vertex_count; v++)
        job->weight[v] = 1;
    return HEWN_OK;
}

/* Fewer flipped triangles are worth a little more distance. */
static bool is_better(const balance *job)
{
    if (job->now.flips != job->best_flips)
        return job->now.flips < job->best_flips && job->now.most < 1.1 * job->best_most;
    return job->now.most < job->best_most;
}

static hewn_result go_round(balance *job, uint32_t target, hewn_error *error)
{
    bool newest = false;
    for (int round = 0; round <= (job->best_flips > 0 ? MOST_ROUNDS : ROUNDS); round++) {
        if (round > 0) {
            reweigh(job);
            HEWN_TRY(begin_again(job, error));
        }
        HEWN_TRY(hewn_simplify_run(job->work, target, error));
        HEWN_TRY(hewn_simplify_measure(&job->gauge, &job->now, error));
        newest = round == 0 || is_better(job);
        if (!newest)
            continue;
        job->best_most = job->now.most;
        job->best_flips = job->now.flips;
        HEWN_TRY(hewn_simplify_save(job->work, &job->best, error));
    }
    if (!newest) {
        HEWN_TRY(hewn_simplify_restore(&job->best, job->work, error));
        HEWN_TRY(hewn_simplify_measure(&job->gauge, &job->now, error));
    }
    return hewn_simplify_fit(job->work, &job->gauge, &job->now, error);
}

hewn_result hewn_simplify_balanced(simplify_work *work, const hewn_polygons *input, uint32_t target, hewn_error *error)
{
    balance job = {.work = work};
    const uint32_t most = work->live_faces;
    const bool counted = work->wedges && work->wedges->counted > 0; /* attributes have a say in where vertices are */
    if (target == 0 || target > most / 2 || counted)
        return hewn_simplify_run(work, target, error);
    HEWN_TRY(hewn_simplify_run(work, target > most / MORE ? 2 * target : MORE * target, error));
    hewn_result result = prepare(&job, input, error);
    if (result == HEWN_OK)
        result = go_round(&job, target, error);
    hewn_simplify_forget(&job.start);
    hewn_simplify_forget(&job.best);
    hewn_simplify_gauge_release(&job.gauge);
    hewn_free(job.now.away);
    hewn_free(job.now.turned);
    hewn_free(job.weight);
    return result;
}
