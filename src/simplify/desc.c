#include <math.h>

#include "base/error.h"
#include "simplify/desc.h"

static hewn_result check_targets(const hewn_simplify_desc *desc, hewn_error *error)
{
    if (!(desc->ratio >= 0 && desc->ratio <= 1))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a ratio is above 0 and at most 1, not %g", desc->ratio);
    if (!(desc->error >= 0 && isfinite(desc->error)))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an error is a length above 0, not %g", desc->error);
    if (!(desc->relative_error >= 0 && isfinite(desc->relative_error)))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a relative error is above 0, not %g", desc->relative_error);
    if (desc->faces == 0 && !(desc->ratio > 0) && !(desc->error > 0) && !(desc->relative_error > 0))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "simplification needs a number of faces above 0, a ratio or an error to stop at");
    return HEWN_OK;
}

hewn_result hewn_simplify_check(const hewn_simplify_desc *desc, hewn_error *error)
{
    if (!desc)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "simplification needs a description");
    HEWN_TRY(check_targets(desc, error));
    if (!(desc->lock_angle >= 0 && desc->lock_angle <= 180))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the angle to lock is from 0 to 180 degrees, not %g",
                         desc->lock_angle);
    if (desc->lock_labels && !desc->labels)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "to lock labels there must be labels");
    return HEWN_OK;
}

uint64_t hewn_simplify_target(const hewn_simplify_desc *desc, uint64_t triangles)
{
    uint64_t target = desc->faces;
    if (desc->ratio > 0) {
        uint64_t share = (uint64_t)(desc->ratio * (double)triangles);
        share = share > 0 ? share : 1;
        target = target == 0 || share > target ? share : target;
    }
    return target;
}
