/* Operations in double: what the oracle and constant folding compute. */
#include <math.h>

#include "field/internal.h"
#include "field/sampling.h"

static double least(double a, double b)
{
    if (isnan(a) || isnan(b))
        return (double)NAN;
    return b < a ? b : a;
}

static double greatest(double a, double b)
{
    if (isnan(a) || isnan(b))
        return (double)NAN;
    return b > a ? b : a;
}

static double euclidean_mod(double a, double b)
{
    double rest = fmod(a, b);
    return rest < 0 ? rest + fabs(b) : rest;
}

static double compare(double a, double b)
{
    if (isnan(a) || isnan(b))
        return (double)NAN;
    return (double)((a > b) - (a < b));
}

static double length2(double a, double b)
{
    return sqrt(a * a + b * b);
}

static double length3(double a, double b, double c)
{
    return sqrt(a * a + b * b + c * c);
}

/* --- shapes --------------------------------------------------------------------------------------------------------
 */

static double box(const double *half, const double *in)
{
    double x = fabs(in[0]) - half[0], y = fabs(in[1]) - half[1], z = fabs(in[2]) - half[2];
    double outside = length3(greatest(x, 0), greatest(y, 0), greatest(z, 0));
    return outside + least(greatest(greatest(x, y), z), 0);
}

static double cylinder(const double *p, const double *in)
{
    double r = length2(in[0], in[2]) - p[0], y = fabs(in[1]) - p[1];
    return length2(greatest(r, 0), greatest(y, 0)) + least(greatest(r, y), 0);
}

/* The frustum's profile is a convex polygon, so inside it the distance is that to the nearest of its lines, and outside
 * that to the nearest of its edges. */
static double cone(const double *p, const double *in)
{
    double bottom = p[0], top = p[1], half = p[2];
    double r = length2(in[0], in[2]), y = in[1];
    double slant = length2(2 * half, bottom - top);
    double normal_r = 2 * half / slant, normal_y = (bottom - top) / slant;
    double off = r - 0.5 * (bottom + top);
    double cap = fabs(y) - half;
    double side = normal_r * off + normal_y * y;
    if (cap <= 0 && side <= 0)
        return greatest(cap, side);
    double to_cap = length2(greatest(r - (y < 0 ? bottom : top), 0), cap);
    double along = fabs(normal_r * y - normal_y * off) - 0.5 * slant;
    return least(to_cap, length2(side, greatest(along, 0)));
}

/* --- outlines ----------------------------------------------------------------------------------------------------- */

hewn_side hewn_side_of(const double p[4], double x, double y)
{
    double dx = x - p[0], dy = y - p[1], ex = p[2] - p[0], ey = p[3] - p[1];
    double t = (dx * ex + dy * ey) / (ex * ex + ey * ey);
    double cross = ex * dy - ey * dx;
    bool up = p[1] <= y, next = p[3] <= y;
    hewn_side out = {.crossed = up != next && (cross > 0) == up};
    if (t > 0 && t < 1) { /* the side's own normal, which is right on the side too: a point there counts as right of a
                             side that rises or falls, and as above a level one */
        double turn = cross > 0 || (cross == 0 && ey == 0 && ex > 0) ? 1 : -1;
        out.away[0] = -ey * turn;
        out.away[1] = ex * turn;
        out.square = cross * cross / (ex * ex + ey * ey);
    } else {
        out.away[0] = t >= 1 ? x - p[2] : dx;
        out.away[1] = t >= 1 ? y - p[3] : dy;
        out.square = out.away[0] * out.away[0] + out.away[1] * out.away[1];
    }
    return out;
}

static double edge(const double *p, const double *in)
{
    hewn_side side = hewn_side_of(p, in[1], in[2]);
    double least = side.square < fabs(in[0]) || isnan(side.square) ? side.square : fabs(in[0]);
    return copysign(least, side.crossed ? -in[0] : in[0]);
}

static double outline(const double *in)
{
    return isnan(in[1]) || isnan(in[2]) ? (double)NAN : copysign(sqrt(fabs(in[0])), in[0]);
}

/* --- all shapes --------------------------------------------------------------------------------------------------- */

static double shape(const hewn_node_data *node, const double *in)
{
    const double *p = node->parameter;
    switch (node->op) {
    case HEWN_OP_SPHERE: return length3(in[0], in[1], in[2]) - p[0];
    case HEWN_OP_BOX: return box(p, in);
    case HEWN_OP_ROUNDED_BOX: return box(p, in) - p[3];
    case HEWN_OP_TORUS: return length2(length2(in[0], in[2]) - p[0], in[1]) - p[1];
    case HEWN_OP_CYLINDER: return cylinder(p, in);
    case HEWN_OP_CAPSULE: return length3(in[0], greatest(fabs(in[1]) - p[1], 0), in[2]) - p[0];
    case HEWN_OP_CONE: return cone(p, in);
    case HEWN_OP_PLANE: return p[0] * in[0] + p[1] * in[1] + p[2] * in[2] - p[3];
    case HEWN_OP_NOISE_VALUE:
    case HEWN_OP_NOISE_GRADIENT:
    case HEWN_OP_NOISE_SIMPLEX:
    case HEWN_OP_NOISE_CELLULAR: return hewn_noise_point(node, in);
    case HEWN_OP_EDGE: return edge(p, in);
    case HEWN_OP_OUTLINE: return outline(in);
    case HEWN_OP_SAMPLED: return hewn_sampling_value(node->samples, in, NULL);
    default: return (double)NAN;
    }
}

/* --- blends --------------------------------------------------------------------------------------------------------
 */

static double blend(hewn_op op, double k, double a, double b)
{
    double under = least(a, b);
    double apart = a == b ? 0 : fabs(a - b);
    if (op == HEWN_OP_BLEND_EXPONENTIAL)
        return under - log1p(exp(-k * apart)) / k;
    if (!(apart < k))
        return under;
    double h = k - apart, t = h / k;
    switch (op) {
    case HEWN_OP_BLEND_QUADRATIC: return under - 0.25 * h * t;
    case HEWN_OP_BLEND_CUBIC: return under - h * t * t / 6;
    default: return under - 0.5 * k * (1 + t - sqrt(1 + t * (2 - t)));
    }
}

double hewn_blend_depth(const hewn_node_data *node)
{
    return -blend(node->op, node->parameter[0], 0, 0);
}

/* --- all -----------------------------------------------------------------------------------------------------------
 */

double hewn_op_point(const hewn_node_data *node, const double in[3])
{
    const double *p = node->parameter;
    double a = in[0], b = in[1];
    switch (node->op) {
    case HEWN_OP_CONSTANT: return p[0];
    case HEWN_OP_PAINT: return a;
    case HEWN_OP_NEG: return -a;
    case HEWN_OP_ABS: return fabs(a);
    case HEWN_OP_SQRT: return sqrt(a);
    case HEWN_OP_SQUARE: return a * a;
    case HEWN_OP_SIN: return sin(a);
    case HEWN_OP_COS: return cos(a);
    case HEWN_OP_TAN: return tan(a);
    case HEWN_OP_ASIN: return asin(a);
    case HEWN_OP_ACOS: return acos(a);
    case HEWN_OP_ATAN: return atan(a);
    case HEWN_OP_EXP: return exp(a);
    case HEWN_OP_LN: return log(a);
    case HEWN_OP_FLOOR: return floor(a);
    case HEWN_OP_CEIL: return ceil(a);
    case HEWN_OP_ROUND: return round(a);
    case HEWN_OP_NOT: return a == 0 ? 1 : 0;
    case HEWN_OP_ZIGZAG: return fabs(remainder(a, p[0]));
    case HEWN_OP_ADD: return a + b;
    case HEWN_OP_SUB: return a - b;
    case HEWN_OP_MUL: return a * b;
    case HEWN_OP_DIV: return a / b;
    case HEWN_OP_MIN: return least(a, b);
    case HEWN_OP_MAX: return greatest(a, b);
    case HEWN_OP_MOD: return euclidean_mod(a, b);
    case HEWN_OP_ATAN2: return atan2(a, b);
    case HEWN_OP_COMPARE: return compare(a, b);
    case HEWN_OP_AND: return a == 0 ? a : b;
    case HEWN_OP_OR: return a != 0 ? a : b;
    case HEWN_OP_AFFINE: return p[0] * a + p[1] * b + p[2] * in[2] + p[3];
    case HEWN_OP_BLEND_QUADRATIC:
    case HEWN_OP_BLEND_CUBIC:
    case HEWN_OP_BLEND_CIRCULAR:
    case HEWN_OP_BLEND_EXPONENTIAL: return blend(node->op, p[0], a, b);
    default: return shape(node, in);
    }
}
