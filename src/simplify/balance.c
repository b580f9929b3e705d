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

static hewn_result finish(simplify_work *work, uint32_t target, hewn_error *error)
{
    HEWN_TRY(run(work, target, false, looking, fitting, error));
    HEWN_TRY(begin_step(work, fitting, error));
    HEWN_TRY(hewn_simplify_fit(work, error));
    HEWN_TRY(begin_step(work, righting, error));
    return hewn_simplify_right(work, error);
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
    work->samples = &samples;
    if (result == HEWN_OK)
        result = finish(work, target, error);
    work->samples = NULL;
    hewn_simplify_samples_release(&samples);
    return result;
}
