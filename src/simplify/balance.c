#include "simplify/balance.h"

#include "base/error.h"
#include "base/progress.h"
#include "simplify/exchange.h"
#include "simplify/fit.h"
#include "simplify/least.h"
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
    double aim_factor, turned_factor;
    bool strict;
} ways[] = {{1.35, 1000, false}, {1.35, 30, true}, {1, 1000, true}, {1.8, 30, true}};
enum { WAYS = sizeof ways / sizeof *ways, MOST_TRIED = 240, TWICE = 400 };

/* The most triangles for which another way is tried where some face away, and for which they are exchanged. */
enum { MOST_AGAIN = 20000, MOST_EXCHANGED = 2500 };

static uint32_t count_ways(uint32_t target)
{
    const uint32_t count = MOST_TRIED / target;
    if (target > TWICE)
        return 1;
    return count < 2 ? 2 : count < WAYS ? count : WAYS;
}

typedef struct balance_attempt {
    simplify_work work;
    simplify_samples samples;
    hewn_simplify_desc desc;
    double score;
    uint32_t turned; /* triangles that face away */
    hewn_result result;
} balance_attempt;

static hewn_result finish(simplify_work *work, uint32_t target, uint32_t way, uint32_t *turned, hewn_error *error)
{
    work->samples->aim_factor = ways[way].aim_factor;
    work->samples->turned_factor = ways[way].turned_factor;
    work->samples->strict = ways[way].strict;
    HEWN_TRY(run(work, target, false, looking, fitting, error));
    HEWN_TRY(begin_step(work, fitting, error));
    HEWN_TRY(hewn_simplify_fit(work, false, error));
    HEWN_TRY(begin_step(work, righting, error));
    return hewn_simplify_right(work, turned, error);
}

static void begin_attempt(const simplify_work *work, balance_attempt *attempt)
{
    attempt->result = hewn_simplify_copy(work, &attempt->work, NULL);
    if (attempt->result == HEWN_OK)
        attempt->result = hewn_simplify_samples_copy(work, &attempt->samples, NULL);
    attempt->desc = *work->desc;
    attempt->work.desc = &attempt->desc;
    attempt->work.samples = &attempt->samples;
}

static void end_attempt(balance_attempt *attempt)
{
    hewn_simplify_release(&attempt->work);
    hewn_simplify_samples_drop(&attempt->samples);
}

/* All that follows the first collapses, on a copy. */
static void try_way(const simplify_work *work, uint32_t target, uint32_t way, balance_attempt *attempt)
{
    begin_attempt(work, attempt);
    attempt->desc.progress = NULL;
    if (attempt->result == HEWN_OK)
        attempt->result = finish(&attempt->work, target, way, &attempt->turned, NULL);
}

/* What came of an attempt goes on, on a copy of its own: triangles go to where they are needed more. */
static void try_exchange(const balance_attempt *from, uint32_t target, balance_attempt *attempt)
{
    begin_attempt(&from->work, attempt);
    attempt->samples.strict = true;
    if (attempt->result == HEWN_OK)
        attempt->result = hewn_simplify_exchange(&attempt->work, target, NULL);
    if (attempt->result == HEWN_OK)
        attempt->result = hewn_simplify_right(&attempt->work, &attempt->turned, NULL);
}

/* The work becomes that of an attempt, which takes the old one to be released. */
static void take(simplify_work *work, balance_attempt *attempt)
{
    const simplify_work before = *work;
    *work = attempt->work;
    work->desc = before.desc;
    work->samples = before.samples;
    attempt->work = before;
}

/* The best of `count` attempts, or what has become of it since. */
static hewn_result choose(balance_attempt *attempts, uint32_t count, uint32_t target, uint32_t *best)
{
    *best = 0;
    for (uint32_t i = 0; i < count; i++) {
        HEWN_TRY(attempts[i].result);
        HEWN_TRY(hewn_simplify_score(&attempts[i].work, &attempts[i].score));
        *best = attempts[i].score < attempts[*best].score ? i : *best;
    }
    if (target > MOST_EXCHANGED)
        return HEWN_OK;
    try_exchange(&attempts[*best], target, &attempts[count]);
    HEWN_TRY(attempts[count].result);
    HEWN_TRY(hewn_simplify_score(&attempts[count].work, &attempts[count].score));
    *best = attempts[count].score < attempts[*best].score ? count : *best;
    return HEWN_OK;
}

/* One way will do where triangles are many, unless some face away. */
static hewn_result try_first(const simplify_work *work, uint32_t target, balance_attempt *attempts, uint32_t *count,
                             hewn_error *error)
{
    begin_attempt(work, &attempts[0]);
    HEWN_TRY(attempts[0].result);
    HEWN_TRY(finish(&attempts[0].work, target, 0, &attempts[0].turned, error));
    *count = attempts[0].turned > 0 ? 2 : 1;
    if (*count == 2)
        try_way(work, target, 1, &attempts[1]);
    return HEWN_OK;
}

static hewn_result attempt_all(simplify_work *work, uint32_t target, hewn_error *error)
{
    balance_attempt attempts[WAYS + 1] = {0};
    uint32_t count = count_ways(target), best = 0;
    hewn_result result = HEWN_OK;
    if (count == 1) {
        result = try_first(work, target, attempts, &count, error);
    } else {
#pragma omp parallel for schedule(dynamic, 1)
        for (uint32_t i = 0; i < count; i++)
            try_way(work, target, i, &attempts[i]);
    }
    if (result == HEWN_OK && count > 1)
        result = choose(attempts, count, target, &best);
    if (result == HEWN_OK)
        take(work, &attempts[best]);
    for (uint32_t i = 0; i < WAYS + 1; i++)
        end_attempt(&attempts[i]);
    return result != HEWN_OUT_OF_MEMORY ? result : hewn_fail(error, result, "out of memory simplifying");
}

hewn_result hewn_simplify_balanced(simplify_work *work, const hewn_polygons *input, uint32_t target, hewn_error *error)
{
    simplify_samples samples = {0};
    const uint32_t most = work->live_faces;
    const bool counted = work->wedges && work->wedges->counted > 0; /* attributes have a say in where vertices are */
    if (target == 0 || target > most / 2 || counted)
        return run(work, target, false, 0, 1, error);
    uint32_t least = 0;
    if (target <= TWICE) /* a number that topology does not allow is no measure of what comes before it */
        HEWN_TRY(hewn_simplify_least(work, &least, error));
    HEWN_TRY(run(work, begin_at(most, least > target ? target + least : target), true, 0, sampling, error));
    HEWN_TRY(begin_step(work, sampling, error));
    hewn_result result = hewn_simplify_samples_make(work, input, target, &samples, error);
    uint32_t turned;
    work->samples = &samples;
    if (result == HEWN_OK)
        result = target <= MOST_AGAIN && !work->wedges ? attempt_all(work, target, error)
                                                       : finish(work, target, 0, &turned, error);
    work->samples = NULL;
    hewn_simplify_samples_release(&samples);
    return result;
}
