#include <math.h>
#include <string.h>

#include "base/error.h"
#include "smooth/desc.h"

static const char *const names[HEWN_SMOOTH_COUNT] = {
    [HEWN_SMOOTH_TAUBIN] = "taubin",     [HEWN_SMOOTH_LAPLACIAN] = "laplacian", [HEWN_SMOOTH_COTAN] = "cotan",
    [HEWN_SMOOTH_IMPLICIT] = "implicit", [HEWN_SMOOTH_BILATERAL] = "bilateral", [HEWN_SMOOTH_HC] = "hc"};

const char *hewn_smooth_method_name(hewn_smooth_method method)
{
    return (unsigned)method < HEWN_SMOOTH_COUNT ? names[method] : NULL;
}

bool hewn_smooth_method_find(const char *name, hewn_smooth_method *out)
{
    for (int i = 0; name && i < HEWN_SMOOTH_COUNT; i++)
        if (strcmp(name, names[i]) == 0) {
            *out = (hewn_smooth_method)i;
            return true;
        }
    return false;
}

hewn_smooth_desc hewn_smooth_desc_default(void)
{
    hewn_smooth_desc desc = {0};
    (void)hewn_smooth_settle(&desc, NULL);
    return desc;
}

/* Zero becomes the default; else the number must be in the range, `least` left out. */
static hewn_result settle_number(double *value, const char *name, double standard, double least, double most,
                                 hewn_error *error)
{
    if (*value == 0)
        *value = standard;
    if (isfinite(*value) && *value > least && *value <= most)
        return HEWN_OK;
    if (most < INFINITY)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the %s must be above %g and at most %g, not %g", name, least,
                         most, *value);
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the %s must be a number above %g, not %g", name, least, *value);
}

static hewn_result settle_taubin(hewn_smooth_desc *desc, hewn_error *error)
{
    HEWN_TRY(settle_number(&desc->passband, "passband", 0.02, 0, 2, error));
    if (desc->passband * desc->strength < 1)
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the passband must be below %g (one over the strength), not %g",
                     1 / desc->strength, desc->passband);
}

static hewn_result settle_hc(hewn_smooth_desc *desc, hewn_error *error)
{
    if (desc->original == 0 && desc->push == 0)
        desc->push = 0.5;
    if (!(desc->original >= 0 && desc->original <= 1) || !(desc->push >= 0 && desc->push <= 1))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the parameters of hc must be from 0 to 1, not %g and %g",
                         desc->original, desc->push);
    return HEWN_OK;
}

static uint32_t default_iterations(hewn_smooth_method method)
{
    return method == HEWN_SMOOTH_IMPLICIT ? 1 : method == HEWN_SMOOTH_BILATERAL ? 8 : 10;
}

hewn_result hewn_smooth_settle(hewn_smooth_desc *desc, hewn_error *error)
{
    if ((unsigned)desc->method >= HEWN_SMOOTH_COUNT)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no smoothing method %d", (int)desc->method);
    if (desc->iterations == 0)
        desc->iterations = default_iterations(desc->method);
    if ((unsigned)desc->volume > HEWN_SMOOTH_VOLUME_FREE)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no way %d to treat volumes", (int)desc->volume);
    if (desc->volume == HEWN_SMOOTH_VOLUME_DEFAULT)
        desc->volume = desc->method == HEWN_SMOOTH_TAUBIN ? HEWN_SMOOTH_VOLUME_KEPT : HEWN_SMOOTH_VOLUME_FREE;
    if (!(desc->lock_angle >= 0 && desc->lock_angle <= 180))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the angle of features must be from 0 to 180 degrees, not %g",
                         desc->lock_angle);
    switch (desc->method) {
    case HEWN_SMOOTH_LAPLACIAN:
    case HEWN_SMOOTH_TAUBIN: HEWN_TRY(settle_number(&desc->strength, "strength", 0.5, 0, 1, error)); break;
    case HEWN_SMOOTH_BILATERAL:
        HEWN_TRY(settle_number(&desc->angle, "angle", 20, 0, 180, error));
        if (desc->radius != 0)
            HEWN_TRY(settle_number(&desc->radius, "radius", 0, 0, INFINITY, error));
        break;
    case HEWN_SMOOTH_COTAN:
    case HEWN_SMOOTH_IMPLICIT:
        if (desc->step != 0)
            HEWN_TRY(settle_number(&desc->step, "step", 0, 0, INFINITY, error));
        break;
    default: break;
    }
    if (desc->method == HEWN_SMOOTH_TAUBIN)
        HEWN_TRY(settle_taubin(desc, error));
    return desc->method == HEWN_SMOOTH_HC ? settle_hc(desc, error) : HEWN_OK;
}
