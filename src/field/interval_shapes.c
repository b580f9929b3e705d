/* Intervals of shapes and blends. Boxes, lengths and roots are monotone in each of their parts, so the interval forms
 * of the formulas in point.c lose nothing but what the coordinates have in common. */
#include <float.h>
#include <math.h>

#include "field/internal.h"
#include "field/interval.h"
#include "field/sampling.h"

static hewn_interval less(hewn_interval a, double b)
{
    return hewn_interval_sub(a, hewn_interval_of(b));
}

static hewn_interval positive(hewn_interval a)
{
    return hewn_interval_max(a, hewn_interval_of(0));
}

static hewn_interval negative(hewn_interval a)
{
    return hewn_interval_min(a, hewn_interval_of(0));
}

static hewn_interval length2(hewn_interval a, hewn_interval b)
{
    return hewn_interval_sqrt(hewn_interval_add(hewn_interval_square(a), hewn_interval_square(b)));
}

static hewn_interval length3(hewn_interval a, hewn_interval b, hewn_interval c)
{
    return hewn_interval_sqrt(hewn_interval_add(hewn_interval_add(hewn_interval_square(a), hewn_interval_square(b)),
                                                hewn_interval_square(c)));
}

static hewn_interval box(const double *half, const hewn_interval *in)
{
    hewn_interval x = less(hewn_interval_abs(in[0]), half[0]);
    hewn_interval y = less(hewn_interval_abs(in[1]), half[1]);
    hewn_interval z = less(hewn_interval_abs(in[2]), half[2]);
    hewn_interval outside = length3(positive(x), positive(y), positive(z));
    return hewn_interval_add(outside, negative(hewn_interval_max(hewn_interval_max(x, y), z)));
}

static hewn_interval cylinder(const double *p, const hewn_interval *in)
{
    hewn_interval r = less(length2(in[0], in[2]), p[0]), y = less(hewn_interval_abs(in[1]), p[1]);
    return hewn_interval_add(length2(positive(r), positive(y)), negative(hewn_interval_max(r, y)));
}

/* The height at which a frustum wider at its bottom is nearest to a vertical line at distance r: where the bottom's and
 * the side's distances meet, or the bottom's edge, or the middle where the caps are nearer than the side. */
static double nearest_height(double r, double bottom, double top, double half)
{
    double slant = sqrt(4 * half * half + (bottom - top) * (bottom - top));
    double normal_r = 2 * half / slant, normal_y = (bottom - top) / slant;
    double meet = (-half - normal_r * (r - 0.5 * (bottom + top))) / (1 + normal_y);
    return fmax(-half, fmin(0, meet));
}

/* The distance is convex in (r, y) and even in r: it grows with r, and along y it is greatest at an end and least as
 * near to its minimum as the interval comes. It is 1-Lipschitz, so the rounding of that place costs no more than
 * itself. */
static hewn_interval cone(const hewn_node_data *node, const hewn_interval *in)
{
    const double *p = node->parameter;
    hewn_interval r = length2(in[0], in[2]), y = in[1];
    bool nan = r.maybe_nan || y.maybe_nan;
    double wide = fmax(p[0], p[1]);
    if (isinf(r.hi) || isinf(y.lo) || isinf(y.hi)) {
        hewn_interval sure = hewn_interval_max(less(r, wide), less(hewn_interval_abs(y), p[2]));
        return (hewn_interval){hewn_lower(sure.lo, 0x1p-46 * (fabs(sure.lo) + wide + p[2])), INFINITY, true};
    }
    double least = p[0] >= p[1] ? nearest_height(r.lo, p[0], p[1], p[2]) : -nearest_height(r.lo, p[1], p[0], p[2]);
    least = fmin(fmax(least, y.lo), y.hi);
    double error = 0x1p-46 * (r.hi + fabs(y.lo) + fabs(y.hi) + wide + p[2]);
    double lo = hewn_op_point(node, (const double[3]){r.lo, least, 0});
    double hi = fmax(hewn_op_point(node, (const double[3]){r.hi, y.lo, 0}),
                     hewn_op_point(node, (const double[3]){r.hi, y.hi, 0}));
    if (!(fabs(lo) < DBL_MAX) || !(hi < DBL_MAX)) /* squares beyond the range of double */
        return hewn_interval_all();
    return (hewn_interval){hewn_lower(lo, error), hewn_upper(hi, error), nan};
}

/* A coordinate whose factor is 0 adds nothing, but for the NaN that an infinite one makes of it. */
static hewn_interval affine(const double *p, const hewn_interval *in, double last)
{
    hewn_interval sum = hewn_interval_of(0);
    for (int i = 0; i < 3; i++) {
        hewn_interval term = hewn_interval_mul(hewn_interval_of(p[i]), in[i]);
        sum = hewn_interval_add(sum, term);
    }
    return hewn_interval_add(sum, hewn_interval_of(last));
}

/* A link holds its value in the middle of the box. */
static hewn_interval edge(const hewn_node_data *node, const hewn_interval *in)
{
    double x = 0.5 * in[1].lo + 0.5 * in[1].hi, y = 0.5 * in[2].lo + 0.5 * in[2].hi;
    double value = hewn_op_point(node, (const double[3]){in[0].lo, x, y});
    if (in[0].maybe_nan || in[1].maybe_nan || in[2].maybe_nan || !(fabs(value) < DBL_MAX))
        return hewn_interval_all();
    return hewn_interval_of(value);
}

/* The distance to an outline is 1-Lipschitz: it lies about that in the middle. */
static hewn_interval outline(const hewn_node_data *node, const hewn_interval *in)
{
    if (in[0].maybe_nan || in[1].maybe_nan || in[2].maybe_nan || in[0].lo != in[0].hi)
        return hewn_interval_all();
    double value = hewn_op_point(node, (const double[3]){in[0].lo, 0, 0});
    double x = 0.5 * in[1].hi - 0.5 * in[1].lo, y = 0.5 * in[2].hi - 0.5 * in[2].lo;
    double far = fmax(fabs(in[1].lo), fabs(in[1].hi)) + fmax(fabs(in[2].lo), fabs(in[2].hi));
    double reach = sqrt(x * x + y * y), error = 0x1p-44 * (far + node->parameter[0]);
    if (!(reach < DBL_MAX))
        return hewn_interval_all();
    return (hewn_interval){hewn_lower(value - reach, error), hewn_upper(value + reach, error), false};
}

/* Whole and half turns between the ends are the least and the greatest there is. */
hewn_interval hewn_interval_zigzag(hewn_interval a, double period)
{
    if (isinf(a.lo) || isinf(a.hi) || !(a.hi - a.lo < period))
        return (hewn_interval){0, 0.5 * period, a.maybe_nan || isinf(a.lo) || isinf(a.hi)};
    double from = remainder(a.lo, period), to = remainder(a.hi, period);
    bool rises = from >= 0, ends = to >= 0;
    hewn_interval out = {fmin(fabs(from), fabs(to)), fmax(fabs(from), fabs(to)), a.maybe_nan};
    bool wraps = from > to; /* the remainder falls where it passes half a period */
    if ((from <= 0 && to >= 0 && !wraps) || (wraps && (rises == ends)))
        out.lo = 0;
    if (wraps)
        out.hi = 0.5 * period;
    return out;
}

hewn_interval hewn_interval_shape(const hewn_node_data *node, const hewn_interval in[3])
{
    const double *p = node->parameter;
    switch (node->op) {
    case HEWN_OP_AFFINE: return affine(p, in, p[3]);
    case HEWN_OP_SPHERE: return less(length3(in[0], in[1], in[2]), p[0]);
    case HEWN_OP_BOX: return box(p, in);
    case HEWN_OP_ROUNDED_BOX: return less(box(p, in), p[3]);
    case HEWN_OP_TORUS: return less(length2(less(length2(in[0], in[2]), p[0]), in[1]), p[1]);
    case HEWN_OP_CYLINDER: return cylinder(p, in);
    case HEWN_OP_CAPSULE: return less(length3(in[0], positive(less(hewn_interval_abs(in[1]), p[1])), in[2]), p[0]);
    case HEWN_OP_CONE: return cone(node, in);
    case HEWN_OP_PLANE: return affine(p, in, -p[3]);
    case HEWN_OP_NOISE_VALUE:
    case HEWN_OP_NOISE_GRADIENT:
    case HEWN_OP_NOISE_SIMPLEX:
    case HEWN_OP_NOISE_CELLULAR: return hewn_noise_interval(node, in);
    case HEWN_OP_EDGE: return edge(node, in);
    case HEWN_OP_OUTLINE: return outline(node, in);
    case HEWN_OP_SAMPLED: return hewn_sampling_bound(node->samples, in);
    default: return hewn_interval_all();
    }
}

/* Blends do not fall in either operand, so their ends are those of the operands' ends. What rounding does to the
 * formula is at most a few units in the last place of the largest number in it. */
hewn_interval hewn_interval_blend(const hewn_node_data *node, hewn_interval a, hewn_interval b)
{
    double lo = hewn_op_point(node, (const double[3]){a.lo, b.lo, 0});
    double hi = hewn_op_point(node, (const double[3]){a.hi, b.hi, 0});
    double size = node->op == HEWN_OP_BLEND_EXPONENTIAL ? 1 / node->parameter[0] : node->parameter[0];
    bool nan = a.maybe_nan || b.maybe_nan;
    return (hewn_interval){hewn_lower(lo, 0x1p-48 * (fabs(lo) + size)), hewn_upper(hi, 0x1p-48 * (fabs(hi) + size)),
                           nan};
}
