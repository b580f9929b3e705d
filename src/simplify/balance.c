#include "simplify/balance.h"

#include "base/error.h"
#include "simplify/fit.h"
#include "simplify/samples.h"
#include "simplify/turned.h"

/* The last collapses look at samples: those from so many times the triangles on that are wanted. */
enum { MORE = 3 };

static hewn_result finish(simplify_work *work, uint32_t target, hewn_error *error)
{
    HEWN_TRY(hewn_simplify_run(work, target, error));
    HEWN_TRY(hewn_simplify_fit(work, error));
    return hewn_simplify_right(work, error);
}

hewn_result hewn_simplify_balanced(simplify_work *work, const hewn_polygons *input, uint32_t target, hewn_error *error)
{
    simplify_samples samples = {0};
    const uint32_t most = work->live_faces;
    const bool counted = work->wedges && work->wedges->counted > 0; /* attributes have a say in where vertices are */
    if (target == 0 || target > most / 2 || counted)
        return hewn_simplify_run(work, target, error);
    HEWN_TRY(hewn_simplify_run(work, target > most / MORE ? most : MORE * target, error));
    hewn_result result = hewn_simplify_samples_make(work, input, target, &samples, error);
    work->samples = &samples;
    if (result == HEWN_OK)
        result = finish(work, target, error);
    work->samples = NULL;
    hewn_simplify_samples_release(&samples);
    return result;
}
