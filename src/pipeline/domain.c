#include "pipeline/domain.h"

#include <math.h>

#include "base/error.h"

enum { MARGIN_CELLS = 2 };

hewn_result hewn_domain_check(const hewn_box *bounds, hewn_error *error)
{
    for (int axis = 0; axis < 3; ++axis) {
        double lo = bounds->lo[axis], hi = bounds->hi[axis];
        if (!isfinite(lo) || !isfinite(hi))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the bounds along %c are not finite (%g to %g)", "xyz"[axis],
                             lo, hi);
        if (!(lo < hi))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                             "the bounds along %c are empty: %g is not less than %g (the order is x0,y0,z0,x1,y1,z1)",
                             "xyz"[axis], lo, hi);
    }
    return HEWN_OK;
}

/* The cells of the final grid depend on the margin, and the margin on them: a longest side of N cells holds the box and
 * two margins of m cells, so a cell is length / (N - 2m). Coarse grids get an eighth of the length: they need their
 * cells for the shape. */
static double margin_for(const hewn_mesh_job_desc *desc, double length)
{
    if (desc->cell > 0)
        return MARGIN_CELLS * desc->cell;
    double cells = desc->resolution ? desc->resolution : HEWN_DEFAULT_RESOLUTION;
    double most = length / 8;
    return cells > 2 * MARGIN_CELLS ? fmin(MARGIN_CELLS * length / (cells - 2 * MARGIN_CELLS), most) : most;
}

/* Whether the field is NaN wherever one looks: at 5 x 5 x 5 points around the origin. */
static bool is_nan_everywhere(const hewn_field *field)
{
    double points[125][3], values[125];
    for (int i = 0; i < 125; ++i)
        for (int axis = 0, rest = i; axis < 3; ++axis, rest /= 5)
            points[i][axis] = 0.71 * (rest % 5) - 1.39; /* no coordinate is 0, where much is undefined */
    if (hewn_field_eval(field, hewn_field_root(field), points[0], 125, values, NULL) != HEWN_OK)
        return false;
    for (int i = 0; i < 125; ++i)
        if (!isnan(values[i]))
            return false;
    return true;
}

/* Bounds would be of no use to some fields, so the advice to give them is not for those. */
static hewn_result explain_no_box(const hewn_field *field, hewn_error *error)
{
    /* Not infinite, because infinity times 0 is NaN. */
    const hewn_box everywhere = {{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}};
    hewn_interval values;
    if (is_nan_everywhere(field))
        return hewn_fail(error, HEWN_BAD_INPUT, "the field is not a number (NaN) everywhere");
    if (hewn_field_bound(field, hewn_field_root(field), &everywhere, &values, NULL) == HEWN_OK && !values.maybe_nan) {
        if (values.lo >= 0)
            return hewn_fail(error, HEWN_BAD_INPUT, "the shape is empty: its field is nowhere negative");
        if (values.hi < 0)
            return hewn_fail(error, HEWN_BAD_INPUT,
                             "the field is negative everywhere: all of space is inside, and there is no surface");
    }
    return hewn_fail(
        error, HEWN_BAD_INPUT,
        "no box around the shape could be proven: it is infinite or too involved; set bounds in the scene, "
        "or use --bounds x0,y0,z0,x1,y1,z1");
}

static hewn_result find_in_field(const hewn_mesh_job_desc *desc, const hewn_field *field, hewn_box *out,
                                 hewn_error *error)
{
    hewn_box box;
    hewn_error reason = {0};
    hewn_result result = hewn_field_find_box(field, hewn_field_root(field), &box, &reason);
    if (result == HEWN_BAD_INPUT)
        return explain_no_box(field, error);
    if (result != HEWN_OK) {
        if (error)
            *error = reason;
        return result;
    }
    double length = 0;
    for (int axis = 0; axis < 3; ++axis)
        length = fmax(length, box.hi[axis] - box.lo[axis]);
    double margin = margin_for(desc, length);
    for (int axis = 0; axis < 3; ++axis) {
        out->lo[axis] = box.lo[axis] - margin;
        out->hi[axis] = box.hi[axis] + margin;
    }
    if (hewn_domain_check(out, NULL) != HEWN_OK)
        return hewn_fail(error, HEWN_BAD_INPUT, "the field's shape has no extent");
    return HEWN_OK;
}

hewn_result hewn_domain_choose(const hewn_mesh_job_desc *desc, const hewn_scene *scene, hewn_box *out,
                               hewn_bounds_source *source, hewn_error *error)
{
    if (desc->bounds) {
        *source = HEWN_BOUNDS_GIVEN;
        *out = *desc->bounds;
        return hewn_domain_check(out, error);
    }
    if (hewn_scene_bounds(scene, out)) {
        *source = HEWN_BOUNDS_SCENE;
        return HEWN_OK;
    }
    *source = HEWN_BOUNDS_FIELD;
    return find_in_field(desc, hewn_scene_field(scene), out, error);
}
