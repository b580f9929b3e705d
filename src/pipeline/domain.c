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
 * two margins of m cells, so a cell is length / (N - 2m). Very coarse grids get half the length on each side instead.
 */
static double margin_for(const hewn_mesh_job_desc *desc, double length)
{
    if (desc->cell > 0)
        return MARGIN_CELLS * desc->cell;
    double cells = desc->resolution ? desc->resolution : HEWN_DEFAULT_RESOLUTION;
    return MARGIN_CELLS * length / fmax(cells - 2 * MARGIN_CELLS, 2 * MARGIN_CELLS);
}

static hewn_result find_in_field(const hewn_mesh_job_desc *desc, const hewn_field *field, hewn_box *out,
                                 hewn_error *error)
{
    hewn_box box;
    hewn_error reason = {0};
    hewn_result result = hewn_field_find_box(field, hewn_field_root(field), &box, &reason);
    if (result == HEWN_BAD_INPUT)
        return hewn_fail(error, HEWN_BAD_INPUT, "%.600s; set bounds in the scene or give --bounds x0,y0,z0,x1,y1,z1",
                         reason.message);
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
