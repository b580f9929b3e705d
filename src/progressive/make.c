#include <math.h>

#include "base/alloc.h"
#include "hewn/distance.h"
#include "progressive/fold.h"

/* --- marks -------------------------------------------------------------------------------------------------------- */

/* Splits at which there are a half, a quarter, … of the triangles, from coarse to fine; the last has all. */
static uint32_t choose_marks(const hewn_progressive *of, uint64_t out[64])
{
    uint32_t count = 0;
    for (uint64_t triangles = of->base_triangles; count < 62 && triangles < of->full_triangles / 2; triangles *= 2) {
        const uint64_t splits = hewn_progressive_splits_for(of, triangles);
        if (count == 0 || splits > out[count - 1])
            out[count++] = splits;
        if (triangles == 0)
            break;
    }
    if (count == 0 || out[count - 1] < of->full_splits)
        out[count++] = of->full_splits;
    return count;
}

static hewn_result measure_mark(const hewn_progressive *of, const hewn_model *input, const hewn_progress *progress,
                                hewn_progressive_mark *mark, hewn_error *error)
{
    hewn_model model;
    hewn_distance distance;
    if (mark->splits == of->full_splits)
        return HEWN_OK;
    HEWN_TRY(hewn_progressive_model(of, mark->splits, &model, error));
    const hewn_polygons one = hewn_model_polygons(&model), two = hewn_model_polygons(input);
    const hewn_distance_desc desc = {.tolerance = 0.05, .progress = progress};
    hewn_result result = hewn_polygons_distance(&one, &two, &desc, &distance, error);
    hewn_model_destroy(&model);
    mark->error = result == HEWN_OK ? distance.high : 0;
    mark->error_low = result == HEWN_OK ? distance.low : 0;
    return result;
}

static hewn_result measure(hewn_progressive *of, const hewn_model *input, const hewn_progress *progress,
                           hewn_error *error)
{
    uint64_t splits[64];
    if (of->full_triangles == 0)
        return HEWN_OK;
    const uint32_t count = choose_marks(of, splits);
    of->marks = hewn_alloc_zero(count, sizeof *of->marks);
    if (!of->marks)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
    of->mark_count = count;
    for (uint32_t i = 0; i < count; i++) {
        of->marks[i].splits = splits[i];
        of->marks[i].triangles = progressive_triangles_at(of, splits[i]);
        HEWN_TRY(measure_mark(of, input, progress, &of->marks[i], error));
    }
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result make(const hewn_model *model, const hewn_progressive_desc *desc, fold *work, hewn_progressive *out,
                        hewn_error *error)
{
    HEWN_TRY(hewn_fold_begin(model, desc->progress, work, error));
    hewn_fold_weigh(work);
    HEWN_TRY(hewn_fold_run(work, desc->faces, desc->progress, error));
    HEWN_TRY(hewn_fold_unwind(work, out, error));
    return desc->measure ? measure(out, model, desc->progress, error) : HEWN_OK;
}

hewn_result hewn_progressive_make(const hewn_model *model, const hewn_progressive_desc *desc, hewn_progressive **out,
                                  hewn_error *error)
{
    static const hewn_progressive_desc defaults;
    fold work = {0};
    *out = NULL;
    HEWN_TRY(hewn_model_check(model, error));
    hewn_progressive *made = hewn_alloc_zero(1, sizeof *made);
    if (!made)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
    hewn_result result = make(model, desc ? desc : &defaults, &work, made, error);
    hewn_fold_release(&work);
    if (result == HEWN_OK)
        *out = made;
    else
        hewn_progressive_destroy(&made);
    return result;
}
