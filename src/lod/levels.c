#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/lod.h"

static hewn_result check_ratios(const hewn_lod_desc *desc, hewn_error *error)
{
    for (uint32_t i = 0; i < desc->count; i++) {
        if (!(desc->ratios[i] > 0 && desc->ratios[i] <= 1))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a level is a share above 0 and at most 1, not %g",
                             desc->ratios[i]);
        if (i > 0 && !(desc->ratios[i] < desc->ratios[i - 1]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "levels fall from fine to coarse: %g comes after %g",
                             desc->ratios[i], desc->ratios[i - 1]);
    }
    return HEWN_OK;
}

static hewn_result check_errors(const hewn_lod_desc *desc, hewn_error *error)
{
    for (uint32_t i = 0; i < desc->count; i++) {
        if (!(desc->errors[i] >= 0 && isfinite(desc->errors[i])))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an error of a level is a length, 0 or more, not %g",
                             desc->errors[i]);
        if (i > 0 && !(desc->errors[i] > desc->errors[i - 1]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "errors rise from fine to coarse: %g comes after %g",
                             desc->errors[i], desc->errors[i - 1]);
    }
    return HEWN_OK;
}

hewn_result hewn_lod_desc_check(const hewn_lod_desc *desc, hewn_error *error)
{
    if (desc->count == 0 || (desc->ratios != NULL) == (desc->errors != NULL))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "levels are given by shares of the triangles, or by errors");
    return desc->ratios ? check_ratios(desc, error) : check_errors(desc, error);
}

static bool is_input(const hewn_lod_desc *desc, uint32_t i)
{
    return desc->ratios ? desc->ratios[i] == 1 : desc->errors[i] == 0;
}

static hewn_result make_level(const hewn_model *model, const hewn_lod_desc *desc, uint32_t i, hewn_lod_level *out,
                              hewn_error *error)
{
    HEWN_TRY(hewn_model_copy(model, &out->model, error));
    if (is_input(desc, i))
        return HEWN_OK;
    hewn_simplify_desc simplify = desc->simplify;
    simplify.faces = 0;
    simplify.relative_error = 0;
    simplify.ratio = desc->ratios ? desc->ratios[i] : 0;
    simplify.error = desc->errors ? desc->errors[i] : 0;
    simplify.measure = true;
    HEWN_TRY(hewn_model_simplify(&out->model, &simplify, &out->report, error));
    out->simplified = true;
    out->error = out->report.distance;
    out->error_low = out->report.distance_low;
    return HEWN_OK;
}

hewn_result hewn_lod_levels_make(const hewn_model *model, const hewn_lod_desc *desc, hewn_lod_level **out,
                                 hewn_error *error)
{
    *out = NULL;
    HEWN_TRY(hewn_lod_desc_check(desc, error));
    HEWN_TRY(hewn_model_check(model, error));
    hewn_lod_level *levels = hewn_alloc_zero(desc->count, sizeof *levels);
    if (!levels)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u levels", desc->count);
    for (uint32_t i = 0; i < desc->count; i++) {
        hewn_result result = make_level(model, desc, i, &levels[i], error);
        if (result != HEWN_OK) {
            hewn_lod_levels_destroy(&levels, desc->count);
            return result;
        }
    }
    *out = levels;
    return HEWN_OK;
}

void hewn_lod_levels_destroy(hewn_lod_level **levels, uint32_t count)
{
    for (uint32_t i = 0; *levels && i < count; i++)
        hewn_model_destroy(&(*levels)[i].model);
    hewn_free(*levels);
    *levels = NULL;
}

double hewn_lod_coverage(double error, double diagonal, double pixels, double lines)
{
    return pixels / lines * diagonal / error;
}
