/* Values with derivatives, carried forward together as src/field/gradient.c does it, many samples at once. A register
 * is four rows: the value, then d/dx, d/dy and d/dz. */
#include <math.h>

#include "field/operate.h"
#include "lanes/internal.h"
#include "lanes/outline.h"

enum { ROW = 4 * HEWN_LANES };

typedef struct dual {
    float v, d[3];
} dual;

static dual load(const float *values, uint32_t at, uint32_t i)
{
    const float *row = values + (size_t)at * ROW + i;
    return (dual){row[0], {row[HEWN_LANES], row[2 * HEWN_LANES], row[3 * HEWN_LANES]}};
}

static dual flat(float v)
{
    return (dual){v, {0, 0, 0}};
}

/* A zero derivative stays zero, however steep the slope. */
static dual chain(float v, float slope_a, dual a, float slope_b, dual b)
{
    dual out = {v, {0, 0, 0}};
    for (int k = 0; k < 3; k++)
        out.d[k] = (a.d[k] == 0 ? 0 : slope_a * a.d[k]) + (b.d[k] == 0 ? 0 : slope_b * b.d[k]);
    return out;
}

static dual least(dual a, dual b)
{
    return b.v < a.v || b.v != b.v ? b : a;
}

static dual greatest(dual a, dual b)
{
    return b.v > a.v || b.v != b.v ? b : a;
}

static dual blend(const hewn_lane_step *step, dual a, dual b)
{
    float apart = a.v == b.v ? 0.0F : fabsf(a.v - b.v), h = fmaxf(step->number - apart, 0.0F);
    dual lesser = least(a, b), more = b.v < a.v ? a : b;
    float w = 0.5F * (h * step->inverse);
    return chain(lesser.v - 0.25F * (h * (h * step->inverse)), 1 - w, lesser, w, more);
}

/* The slope of an operation after each operand, as a difference quotient. */
static dual other(const hewn_node_data *node, const dual *in, uint32_t count)
{
    double at[HEWN_LANE_INPUTS] = {0, 0, 0};
    for (uint32_t k = 0; k < count; k++)
        at[k] = (double)in[k].v;
    dual out = flat((float)hewn_op_point(node, at));
    for (uint32_t k = 0; k < count; k++) {
        double middle = at[k], reach = 0x1p-20 * fmax(fabs(middle), 0x1p-10);
        at[k] = middle + reach;
        double after = hewn_op_point(node, at);
        at[k] = middle - reach;
        double slope = (after - hewn_op_point(node, at)) / (2 * reach);
        at[k] = middle;
        out = chain(out.v, 1, out, (float)slope, in[k]);
    }
    return out;
}

static dual outline(const hewn_lane_outline *sides, dual x, dual y)
{
    float away[2], v = hewn_lane_outline_gradient(sides, x.v, y.v, away);
    return chain(v, away[0], x, away[1], y);
}

static dual length(const hewn_lane_step *step, const dual *in)
{
    dual sum = chain(in[0].v * in[0].v, 2 * in[0].v, in[0], 0, flat(0));
    for (uint32_t k = 1; k < step->input_count; k++)
        sum = chain(sum.v + in[k].v * in[k].v, 1, sum, 2 * in[k].v, in[k]);
    float root = sqrtf(sum.v);
    return chain(root + step->number, 0.5F / root, sum, 0, flat(0));
}

static dual affine(const float *factors, const hewn_lane_step *step, const dual *in)
{
    dual sum = chain(factors[0] * in[0].v, factors[0], in[0], 0, flat(0));
    for (uint32_t k = 1; k < step->input_count; k++)
        sum = chain(sum.v + factors[k] * in[k].v, 1, sum, factors[k], in[k]);
    sum.v += step->number;
    return sum;
}

static dual run_step(const hewn_lane_tape *tape, const hewn_lane_step *step, const dual *in)
{
    dual a = in[0], b = in[1], none = flat(0);
    float n = step->number;
    switch ((hewn_lane_kind)step->kind) {
    case HEWN_LANE_NUMBER: return flat(n);
    case HEWN_LANE_NEG: return chain(-a.v, -1, a, 0, none);
    case HEWN_LANE_ABS: return chain(fabsf(a.v), a.v < 0 ? -1 : 1, a, 0, none);
    case HEWN_LANE_SQRT: return chain(sqrtf(a.v), 0.5F / sqrtf(a.v), a, 0, none);
    case HEWN_LANE_SQUARE: return chain(a.v * a.v, 2 * a.v, a, 0, none);
    case HEWN_LANE_PLUS: return chain(a.v + n, 1, a, 0, none);
    case HEWN_LANE_TIMES: return chain(a.v * n, n, a, 0, none);
    case HEWN_LANE_LESS: return chain(n - a.v, -1, a, 0, none);
    case HEWN_LANE_ADD: return chain(a.v + b.v, 1, a, 1, b);
    case HEWN_LANE_SUB: return chain(a.v - b.v, 1, a, -1, b);
    case HEWN_LANE_MUL: return chain(a.v * b.v, b.v, a, a.v, b);
    case HEWN_LANE_OVER: return chain(fabsf(a.v) + n, a.v < 0 ? -1 : 1, a, 0, none);
    case HEWN_LANE_LENGTH: return length(step, in);
    case HEWN_LANE_AFFINE: return affine(tape->factors[step->node], step, in);
    case HEWN_LANE_FLOOR_AT: return greatest(a, flat(n));
    case HEWN_LANE_CEIL_AT: return least(a, flat(n));
    case HEWN_LANE_MIN: return least(a, b);
    case HEWN_LANE_MAX: return greatest(a, b);
    case HEWN_LANE_BLEND: return blend(step, a, b);
    case HEWN_LANE_OUTLINE: return outline(&tape->outlines[step->node], a, b);
    default: return other(&tape->others[step->node], in, step->input_count);
    }
}

void hewn_lanes_gradient(const hewn_lane_tape *tape, hewn_lane_work *work, const hewn_lane_points *points,
                         uint32_t count, float *values, float gradients[3][HEWN_LANES])
{
    for (uint32_t at = 0; at < tape->count; at++) {
        const hewn_lane_step *step = &tape->steps[at];
        for (uint32_t i = 0; i < count; i++) {
            dual in[HEWN_LANE_INPUTS] = {flat(0), flat(0), flat(0)}, out;
            for (uint32_t k = 0; k < step->input_count; k++)
                in[k] = load(work->values, step->from[k], i);
            if (step->kind <= HEWN_LANE_Z) {
                out = flat(points->at[step->kind][i]);
                out.d[step->kind] = 1;
            } else {
                out = run_step(tape, step, in);
            }
            float *row = work->values + (size_t)step->out * ROW + i;
            row[0] = out.v;
            for (int k = 0; k < 3; k++)
                row[(k + 1) * HEWN_LANES] = out.d[k];
        }
    }
    const hewn_lane_step *last = &tape->steps[tape->count - 1];
    for (uint32_t i = 0; i < count; i++) {
        dual out = load(work->values, last->out, i);
        values[i] = out.v;
        for (int k = 0; k < 3; k++)
            gradients[k][i] = out.d[k];
    }
}
