/* Levels of detail: a model and coarser ones of it, each with a proven distance from the first. */
#ifndef HEWN_LOD_H
#define HEWN_LOD_H

#include "hewn/simplify.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What levels there shall be, from fine to coarse; one of `ratios` and `errors` is there, with `count` numbers.
 *
 * ratios: shares of the input's triangles, falling, above 0 to 1; 1 is the input itself. errors: lengths in the model's
 * unit, rising, 0 (the input itself) or more; no point of either surface is further from the other.
 *
 * simplify: how (locks, what is preserved, self-intersections, progress); its targets and `measure` are not looked at.
 */
typedef struct hewn_lod_desc {
    const double *ratios;
    const double *errors;
    uint32_t count;
    hewn_simplify_desc simplify;
} hewn_lod_desc;

/* HEWN_INVALID_ARGUMENT where levels are missing, out of range or out of order. */
HEWN_API hewn_result hewn_lod_desc_check(const hewn_lod_desc *desc, hewn_error *error);

/* One level. Between it and the input the two-sided Hausdorff distance is at most `error`, and at least `error_low`. */
typedef struct hewn_lod_level {
    hewn_model model;
    double error, error_low;
    bool simplified; /* false: the input itself, and `report` is empty */
    hewn_simplify_report report;
} hewn_lod_level;

/* Makes the levels of a model, each simplified from the input itself as hewn_model_simplify() does, which gives better
 * ones than going from level to level, and makes each distance one to the input. `*out` has desc->count levels and is
 * the caller's; leave it with hewn_lod_levels_destroy(). HEWN_INVALID_ARGUMENT for a bad `desc`; else the errors of
 * hewn_model_simplify(). The same bytes for any number of threads. */
HEWN_API hewn_result hewn_lod_levels_make(const hewn_model *model, const hewn_lod_desc *desc, hewn_lod_level **out,
                                          hewn_error *error);
HEWN_API void hewn_lod_levels_destroy(hewn_lod_level **levels, uint32_t count);

/* The share of a picture's height that an object's diagonal may take for an error to show as no more than so many of
 * the picture's lines; above 1 where the object may be larger than the picture. Infinite for an error of 0. */
HEWN_API double hewn_lod_coverage(double error, double diagonal, double pixels, double lines);

#ifdef __cplusplus
}
#endif
#endif
