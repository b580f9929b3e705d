#include "simplify/balance.h"

#include "base/error.h"
#include "base/progress.h"
#include "simplify/fit.h"
#include "simplify/samples.h"
#include "simplify/turned.h"

/* The last collapses look at samples: those from so many times the triangles on that are wanted. The more, the better
 * and the slower; it is the most where few triangles are wanted, for then all of this takes little time. */
static const double least_more = 3, most_more = 4, share = 0.25;

static uint32_t begin_at(uint32_t most, uint32_t target)
{
    const double more = fmin(fmax(share * most / target, least_more), most_more) * target;
    return more < most ? (uint32_t)more : most;
}

/* Where the stage is when each step begins, about as time goes. */
static const double sampling = 0.5, looking = 0.55, fitting = 0.9, righting = 0.97;

static hewn_result begin_step(const simplify_work *work, double done, hewn_error *error)
{
    return hewn_progress_report(work->desc->progress, "simplify", done, error);
}

static hewn_result run(simplify_work *work, uint32_t target, bool early, double begin, double end, hewn_error *error)
{
    work->progress_begin = begin;
    work->progress_end = end;
    return hewn_simplify_run(work, target, early, error);
}

/* --- attempts ----------------------------------------------------------------------------------------------------- */

/* Where few triangles are wanted, much depends on chance: the last collapses are tried in several ways, and the best
 * result stays. The first is the usual one. There are as many ways as make MOST_TRIED triangles together, but two, one
 * for each of two cores, up to TWICE. */
static const struct {
    double aim_factor;
    bool strict;
} ways[] = {{1.35, false}, {1.35, true}, {1, true}, {1.8, true}};
enum { WAYS = sizeof ways / sizeof *ways, MOST_TRIED = 240, TWICE = 400 };

static uint32_t count_ways(const simplify_work *work, uint32_t target)
{
    const uint32_t count = MOST_TRIED / target;
    if (work->wedges || target > TWICE)
        return 1;
    return count < 2 ? 2 : count < WAYS ? count : WAYS;
}

typedef struct balance_attempt {
    simplify_work work;
    simplify_samples samples;
    hewn_simplify_desc desc;
    double score;
    hewn_result result;
} balance_attempt;

static hewn_result finish(simplify_work *work, uint32_t target, uint32_t way, hewn_error *error)
{
    work->samples->aim_factor = ways[way].aim_factor;
    work->samples->strict = ways[way].strict;
    HEWN_TRY(run(work, target, false, looking, fitting, error));
    HEWN_TRY(begin_step(work, fitting, error));
    HEWN_TRY(hewn_simplify_fit(work, error));
    HEWN_TRY(begin_step(work, righting, error));
    return hewn_simplify_right(work, error);
}

static void begin_attempt(const simplify_work *work, balance_attempt *attempt)
{
    attempt->result = hewn_simplify_copy(work, &attempt->work, NULL);
    if (attempt->result == HEWN_OK)
        attempt->result = hewn_simplify_samples_copy(work, &attempt->samples, NULL);
    attempt->desc = *work->desc;
    attempt->desc.progress = NULL;
    attempt->work.desc = &attempt->desc;
    attempt->work.samples = &attempt->samples;
}

static hewn_result attempt_all(simplify_work *work, uint32_t target, uint32_t count, hewn_error *error)
{
    balance_attempt attempts[WAYS] = {0};
    uint32_t best = 0;
    hewn_result result = HEWN_OK;
#pragma omp parallel for schedule(dynamic, 1)
    for (uint32_t i = 0; i < count; i++) {
        balance_attempt *attempt = &attempts[i];
        begin_attempt(work, attempt);
        if (attempt->result == HEWN_OK)
            attempt->result = finish(&attempt->work, target, i, NULL);
        if (attempt->result == HEWN_OK)
            attempt->score = hewn_simplify_score(&attempt->work);
    }
    for (uint32_t i = 0; i < count; i++) {
        result = result == HEWN_OK ? attempts[i].result : result;
        best = attempts[i].score < attempts[best].score ? i : best;
    }
    if (result == HEWN_OK) {
        const simplify_work before = *work;
        *work = attempts[best].work;
        work->desc = before.desc;
        work->samples = before.samples;
        attempts[best].work = before;
    }
    for (uint32_t i = 0; i < count; i++) {
        hewn_simplify_release(&attempts[i].work);
        hewn_simplify_samples_drop(&attempts[i].samples);
    }
    return result == HEWN_OK ? HEWN_OK : hewn_fail(error, result, "out of memory simplifying");
}

hewn_result hewn_simplify_balanced(simplify_work *work, const hewn_polygons *input, uint32_t target, hewn_error *error)
{
    simplify_samples samples = {0};
    const uint32_t most = work->live_faces;
    const bool counted = work->wedges && work->wedges->counted > 0; /* attributes have a say in where vertices are */
    if (target == 0 || target > most / 2 || counted)
        return run(work, target, false, 0, 1, error);
    HEWN_TRY(run(work, begin_at(most, target), true, 0, sampling, error));
    HEWN_TRY(begin_step(work, sampling, error));
    hewn_result result = hewn_simplify_samples_make(work, input, target, &samples, error);
    const uint32_t count = count_ways(work, target);
    work->samples = &samples;
    if (result == HEWN_OK)
        result = count > 1 ? attempt_all(work, target, count, error) : finish(work, target, 0, error);
    work->samples = NULL;
    hewn_simplify_samples_release(&samples);
    return result;
}
