#include <math.h>

#include "field/internal.h"

const hewn_op_info hewn_op_infos[HEWN_OP_COUNT] = {
#define HEWN_OP_INFO(NAME, name, operands, parameters) {#name, operands, parameters},
    HEWN_OPS(HEWN_OP_INFO)
#undef HEWN_OP_INFO
};

static bool all_at_least(const double *values, int count, double least)
{
    for (int i = 0; i < count; i++)
        if (!(values[i] >= least))
            return false;
    return true;
}

static bool all_positive(const double *values, int count)
{
    for (int i = 0; i < count; i++)
        if (!(values[i] > 0))
            return false;
    return true;
}

static const char *plane_complaint(const double *p)
{
    double length = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    return fabs(length - 1) < 1e-9 ? NULL : "its normal must have length 1";
}

const char *hewn_op_complaint(hewn_op op, const double *p)
{
    if (op == HEWN_OP_CONSTANT)
        return NULL;
    for (int i = 0; i < hewn_op_infos[op].parameters; i++)
        if (!isfinite(p[i]))
            return "a parameter is not a finite number";
    switch (op) {
    case HEWN_OP_SPHERE: return all_positive(p, 1) ? NULL : "its radius must be above 0";
    case HEWN_OP_BOX: return all_positive(p, 3) ? NULL : "its sizes must be above 0";
    case HEWN_OP_ROUNDED_BOX:
        return all_at_least(p, 4, 0) && p[0] + p[3] > 0 && p[1] + p[3] > 0 && p[2] + p[3] > 0
                   ? NULL
                   : "its sizes must be above 0 and its radius between 0 and half the least size";
    case HEWN_OP_TORUS: return all_positive(p, 2) ? NULL : "its radii must be above 0";
    case HEWN_OP_CYLINDER: return all_positive(p, 2) ? NULL : "its radius and height must be above 0";
    case HEWN_OP_CAPSULE: return p[0] > 0 && p[1] >= 0 ? NULL : "its radius must be above 0 and its height not below 0";
    case HEWN_OP_CONE:
        return all_at_least(p, 2, 0) && p[0] + p[1] > 0 && p[2] > 0
                   ? NULL
                   : "its radii must not be below 0, not both 0, and its height must be above 0";
    case HEWN_OP_PLANE: return plane_complaint(p);
    case HEWN_OP_NOISE_VALUE:
    case HEWN_OP_NOISE_GRADIENT:
    case HEWN_OP_NOISE_SIMPLEX:
    case HEWN_OP_NOISE_CELLULAR:
        return p[0] >= 0 && p[0] < 0x1p24 && p[0] == floor(p[0]) ? NULL
                                                                 : "its seed must be a whole number from 0 to 16777215";
    case HEWN_OP_EDGE: return p[0] != p[2] || p[1] != p[3] ? NULL : "its ends must not be one point";
    case HEWN_OP_PAINT:
        return (p[0] >= 0 && p[1] >= 0 && p[2] >= 0) || (p[0] == -1 && p[3] >= 0) ? NULL
                                                                                  : "it has neither colour nor label";
    case HEWN_OP_OUTLINE:
    case HEWN_OP_ZIGZAG:
    case HEWN_OP_BLEND_QUADRATIC:
    case HEWN_OP_BLEND_CUBIC:
    case HEWN_OP_BLEND_CIRCULAR:
    case HEWN_OP_BLEND_EXPONENTIAL: return all_positive(p, 1) ? NULL : "its size must be above 0";
    default: return NULL;
    }
}
