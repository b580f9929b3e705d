/* Values with their gradients, carried forward together (dual numbers; Griewank and Walther, Evaluating Derivatives).
 * Values have the bits of hewn_field_eval. Where a function has no derivative one of its one-sided ones is taken: of
 * min, max and abs (as max(a, -a)) the first operand's, of lengths and roots at 0 the zero that symmetry suggests. */
#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "field/internal.h"
#include "field/sampling.h"

typedef struct dual {
    double v;
    double d[3];
} dual;

static dual constant(double v)
{
    return (dual){v, {0, 0, 0}};
}

/* A value `v` whose derivative after `a` is `slope`; a zero derivative stays zero, however steep the slope. */
static dual chain(double v, double slope, dual a)
{
    dual out = {v, {0, 0, 0}};
    for (int i = 0; i < 3; i++)
        out.d[i] = a.d[i] == 0 ? 0 : slope * a.d[i];
    return out;
}

static dual chain2(double v, double slope_a, dual a, double slope_b, dual b)
{
    dual left = chain(v, slope_a, a), right = chain(v, slope_b, b);
    for (int i = 0; i < 3; i++)
        left.d[i] += right.d[i];
    return left;
}

static dual add(dual a, dual b)
{
    return chain2(a.v + b.v, 1, a, 1, b);
}

static dual sub(dual a, dual b)
{
    return chain2(a.v - b.v, 1, a, -1, b);
}

static dual scaled(double factor, dual a)
{
    return chain(factor * a.v, factor, a);
}

static dual square(dual a)
{
    return chain(a.v * a.v, 2 * a.v, a);
}

static dual root(dual a)
{
    double v = sqrt(a.v);
    return chain(v, 0.5 / v, a);
}

static dual absolute(dual a)
{
    return chain(fabs(a.v), a.v < 0 ? -1 : 1, a);
}

static dual least(dual a, dual b)
{
    if (isnan(a.v) || isnan(b.v))
        return chain2((double)NAN, (double)NAN, a, (double)NAN, b);
    return b.v < a.v ? b : a;
}

static dual greatest(dual a, dual b)
{
    if (isnan(a.v) || isnan(b.v))
        return chain2((double)NAN, (double)NAN, a, (double)NAN, b);
    return b.v > a.v ? b : a;
}

static dual over(dual a, double offset)
{
    return greatest(sub(a, constant(offset)), constant(0));
}

static dual length2(dual a, dual b)
{
    return root(add(square(a), square(b)));
}

static dual length3(dual a, dual b, dual c)
{
    return root(add(add(square(a), square(b)), square(c)));
}

/* --- shapes, step by step as in point.c ----------------------------------------------------------------------------
 */

static dual box(const double *half, const dual *in)
{
    dual x = sub(absolute(in[0]), constant(half[0]));
    dual y = sub(absolute(in[1]), constant(half[1]));
    dual z = sub(absolute(in[2]), constant(half[2]));
    dual outside = length3(over(x, 0), over(y, 0), over(z, 0));
    dual inside = least(greatest(greatest(x, y), z), constant(0));
    /* On a face the outside part is a zero of no direction and the inside part the face's; off it one of them is 0. */
    return outside.v > 0 ? chain(outside.v + inside.v, 1, outside) : inside;
}

static dual cylinder(const double *p, const dual *in)
{
    dual r = sub(length2(in[0], in[2]), constant(p[0])), y = sub(absolute(in[1]), constant(p[1]));
    dual outside = length2(over(r, 0), over(y, 0));
    dual inside = least(greatest(r, y), constant(0));
    return outside.v > 0 ? chain(outside.v + inside.v, 1, outside) : inside;
}

static dual cone(const double *p, const dual *in)
{
    double bottom = p[0], top = p[1], half = p[2];
    dual r = length2(in[0], in[2]), y = in[1];
    double slant = sqrt(2 * half * (2 * half) + (bottom - top) * (bottom - top));
    double normal_r = 2 * half / slant, normal_y = (bottom - top) / slant;
    dual off = sub(r, constant(0.5 * (bottom + top)));
    dual cap = sub(absolute(y), constant(half));
    dual side = add(scaled(normal_r, off), scaled(normal_y, y));
    if (cap.v <= 0 && side.v <= 0)
        return greatest(cap, side);
    dual to_cap = length2(over(r, y.v < 0 ? bottom : top), cap);
    dual along = over(absolute(sub(scaled(normal_r, y), scaled(normal_y, off))), 0.5 * slant);
    return least(to_cap, length2(side, along));
}

static dual affine(const double *p, const dual *in, double last)
{
    dual sum = add(add(scaled(p[0], in[0]), scaled(p[1], in[1])), scaled(p[2], in[2]));
    return chain(sum.v + last, 1, sum);
}

static dual chain3(double v, const double slopes[3], const dual *in)
{
    dual sum = chain2(v, slopes[0], in[0], slopes[1], in[1]), last = chain(0, slopes[2], in[2]);
    for (int i = 0; i < 3; i++)
        sum.d[i] += last.d[i];
    return sum;
}

static dual noise(const hewn_node_data *node, const dual *in)
{
    double out[4];
    hewn_noise_slopes(node, (const double[3]){in[0].v, in[1].v, in[2].v}, out);
    return chain3(out[0], out + 1, in);
}

static dual sampled(const hewn_node_data *node, const dual *in)
{
    double slopes[3], value = hewn_sampling_value(node->samples, (const double[3]){in[0].v, in[1].v, in[2].v}, slopes);
    return chain3(value, slopes, in);
}

/* A link carries the unit direction away from the nearest edge in place of a derivative. */
static dual edge(const hewn_node_data *node, const dual *in)
{
    hewn_side side = hewn_side_of(node->parameter, in[1].v, in[2].v);
    double v = hewn_op_point(node, (const double[3]){in[0].v, in[1].v, in[2].v});
    double length = sqrt(side.away[0] * side.away[0] + side.away[1] * side.away[1]);
    double inverse = length > 0 ? 1 / length : 0;
    if (side.square < fabs(in[0].v))
        return chain2(v, side.away[0] * inverse, in[1], side.away[1] * inverse, in[2]);
    dual kept = in[0];
    kept.v = v;
    return kept;
}

static dual outline(const hewn_node_data *node, const dual *in)
{
    dual out = in[0];
    out.v = hewn_op_point(node, (const double[3]){in[0].v, in[1].v, in[2].v});
    for (int i = 0; i < 3 && signbit(in[0].v); i++)
        out.d[i] = -out.d[i];
    return out;
}

static dual shape(const hewn_node_data *node, const dual *in)
{
    const double *p = node->parameter;
    switch (node->op) {
    case HEWN_OP_AFFINE: return affine(p, in, p[3]);
    case HEWN_OP_SPHERE: return sub(length3(in[0], in[1], in[2]), constant(p[0]));
    case HEWN_OP_BOX: return box(p, in);
    case HEWN_OP_ROUNDED_BOX: return sub(box(p, in), constant(p[3]));
    case HEWN_OP_TORUS: return sub(length2(sub(length2(in[0], in[2]), constant(p[0])), in[1]), constant(p[1]));
    case HEWN_OP_CYLINDER: return cylinder(p, in);
    case HEWN_OP_CAPSULE: return sub(length3(in[0], over(absolute(in[1]), p[1]), in[2]), constant(p[0]));
    case HEWN_OP_CONE: return cone(p, in);
    case HEWN_OP_PLANE: return affine(p, in, -p[3]);
    case HEWN_OP_NOISE_VALUE:
    case HEWN_OP_NOISE_GRADIENT:
    case HEWN_OP_NOISE_SIMPLEX:
    case HEWN_OP_NOISE_CELLULAR: return noise(node, in);
    case HEWN_OP_EDGE: return edge(node, in);
    case HEWN_OP_OUTLINE: return outline(node, in);
    case HEWN_OP_SAMPLED: return sampled(node, in);
    default: return constant((double)NAN);
    }
}

/* --- blends: (1 - w) of the lesser operand's gradient and w of the other's ------------------------------------------
 */

static dual blend(const hewn_node_data *node, dual a, dual b)
{
    double k = node->parameter[0];
    double v = hewn_op_point(node, (const double[3]){a.v, b.v, 0});
    dual lesser = least(a, b), other = b.v < a.v ? a : b;
    double apart = a.v == b.v ? 0 : fabs(a.v - b.v);
    double t = (k - apart) / k, w = 0;
    if (node->op == HEWN_OP_BLEND_EXPONENTIAL) {
        double e = exp(-k * apart);
        w = e / (1 + e);
    } else if (!(apart < k)) {
        return lesser;
    } else if (node->op == HEWN_OP_BLEND_QUADRATIC) {
        w = 0.5 * t;
    } else if (node->op == HEWN_OP_BLEND_CUBIC) {
        w = 0.5 * t * t;
    } else {
        w = 0.5 * (1 - (1 - t) / sqrt(1 + t * (2 - t)));
    }
    return w == 0 ? chain(v, 1, lesser) : chain2(v, 1 - w, lesser, w, other);
}

/* --- all -----------------------------------------------------------------------------------------------------------
 */

static dual unary(const hewn_node_data *node, dual a)
{
    double v = hewn_op_point(node, (const double[3]){a.v, 0, 0});
    switch (node->op) {
    case HEWN_OP_NEG: return chain(v, -1, a);
    case HEWN_OP_ABS: return absolute(a);
    case HEWN_OP_SQRT: return root(a);
    case HEWN_OP_SQUARE: return square(a);
    case HEWN_OP_SIN: return chain(v, cos(a.v), a);
    case HEWN_OP_COS: return chain(v, -sin(a.v), a);
    case HEWN_OP_TAN: return chain(v, 1 + v * v, a);
    case HEWN_OP_ASIN: return chain(v, 1 / sqrt((1 - a.v) * (1 + a.v)), a);
    case HEWN_OP_ACOS: return chain(v, -1 / sqrt((1 - a.v) * (1 + a.v)), a);
    case HEWN_OP_ATAN: return chain(v, 1 / (1 + a.v * a.v), a);
    case HEWN_OP_EXP: return chain(v, v, a);
    case HEWN_OP_ZIGZAG: return chain(v, remainder(a.v, node->parameter[0]) < 0 ? -1 : 1, a);
    case HEWN_OP_LN: return chain(v, a.v < 0 ? (double)NAN : 1 / a.v, a);
    default: return constant(v); /* steps: flat wherever they have a derivative */
    }
}

static dual binary(const hewn_node_data *node, dual a, dual b)
{
    double v = hewn_op_point(node, (const double[3]){a.v, b.v, 0});
    switch (node->op) {
    case HEWN_OP_ADD: return add(a, b);
    case HEWN_OP_SUB: return sub(a, b);
    case HEWN_OP_MUL: return chain2(v, b.v, a, a.v, b);
    case HEWN_OP_DIV: return chain2(v, 1 / b.v, a, -v / b.v, b);
    case HEWN_OP_MIN: return least(a, b);
    case HEWN_OP_MAX: return greatest(a, b);
    case HEWN_OP_MOD: return chain2(v, 1, a, -round((a.v - v) / b.v), b);
    case HEWN_OP_ATAN2: {
        double square_length = a.v * a.v + b.v * b.v;
        return chain2(v, b.v / square_length, a, -a.v / square_length, b);
    }
    case HEWN_OP_AND: return a.v == 0 ? a : b;
    case HEWN_OP_OR: return a.v != 0 ? a : b;
    case HEWN_OP_COMPARE: return constant(v);
    default: return blend(node, a, b);
    }
}

static dual run_step(const hewn_step *step, const double *point, const dual *values)
{
    const hewn_node_data *node = step->node;
    dual in[HEWN_MAX_OPERANDS] = {0};
    int operands = hewn_op_infos[node->op].operands;
    for (int k = 0; k < operands; k++)
        in[k] = values[step->in[k]];
    switch (operands) {
    case 0: {
        if (node->op == HEWN_OP_CONSTANT)
            return constant(node->parameter[0]);
        int axis = (int)(node->op - HEWN_OP_X);
        dual out = constant(point[axis]);
        out.d[axis] = 1;
        return out;
    }
    case 1: return unary(node, in[0]);
    case 2: return binary(node, in[0], in[1]);
    default: return shape(node, in);
    }
}

hewn_result hewn_field_gradient(const hewn_field *field, hewn_node node, const double *points, size_t count,
                                double *values_and_gradients, hewn_error *error)
{
    if (count > 0 && (!points || !values_and_gradients))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_field_gradient: no points or no place for their values");
    hewn_tape tape;
    HEWN_TRY(hewn_tape_create(&tape, field, node, error));
    dual *scratch = hewn_alloc(tape.count, sizeof *scratch);
    if (!scratch) {
        hewn_tape_destroy(&tape);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory evaluating a field");
    }
    for (size_t p = 0; p < count; p++) {
        for (size_t i = 0; i < tape.count; i++)
            scratch[i] = run_step(&tape.steps[i], points + 3 * p, scratch);
        const dual *last = &scratch[tape.count - 1];
        values_and_gradients[4 * p] = last->v;
        for (size_t i = 0; i < 3; i++)
            values_and_gradients[4 * p + 1 + i] = last->d[i];
    }
    hewn_free(scratch);
    hewn_tape_destroy(&tape);
    return HEWN_OK;
}
