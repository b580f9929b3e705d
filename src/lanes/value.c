/* Values of many samples at once: a pass over the tape, and in each step a loop that becomes vector code. */
#include <math.h>

#include "base/clones.h"
#include "field/operate.h"
#include "lanes/internal.h"
#include "lanes/loops.h"
#include "lanes/outline.h"

/* What no loop here does, one sample after the other. */
static void other(const hewn_lane_tape *tape, const hewn_lane_step *step, float *rows, uint32_t count)
{
    const hewn_node_data *node = &tape->others[step->node];
    for (uint32_t i = 0; i < count; i++) {
        double in[HEWN_LANE_INPUTS] = {0, 0, 0};
        for (uint32_t k = 0; k < step->input_count; k++)
            in[k] = (double)rows[(size_t)step->from[k] * HEWN_LANES + i];
        rows[(size_t)step->out * HEWN_LANES + i] = (float)hewn_op_point(node, in);
    }
}

static inline float least(float a, float b)
{
    return ((b < a) | (b != b)) ? b : a;
}

static inline float greatest(float a, float b)
{
    return ((b > a) | (b != b)) ? b : a;
}

/* As f_blend_quadratic of the shaders. */
static inline float blend(float a, float b, float size, float inverse)
{
    float apart = a == b ? 0.0F : fabsf(a - b);
    float h = size - apart;
    h = h < 0 ? 0.0F : h;
    return least(a, b) - 0.25F * (h * (h * inverse));
}

#define EACH(EXPRESSION)                                                                                               \
    HEWN_LANE_LOOP(count)                                                                                              \
    r[i] = (EXPRESSION);                                                                                               \
    break

static HEWN_INTO_CLONES void length(const hewn_lane_step *step, const float *rows, float *restrict r, uint32_t count)
{
    const float *a = rows + (size_t)step->from[0] * HEWN_LANES, *b = rows + (size_t)step->from[1] * HEWN_LANES;
    const float *c = rows + (size_t)step->from[2] * HEWN_LANES, n = step->number;
    if (step->input_count == 2)
        HEWN_LANE_LOOP(count)
    r[i] = sqrtf(a[i] * a[i] + b[i] * b[i]) + n;
    else HEWN_LANE_LOOP(count) r[i] = sqrtf(a[i] * a[i] + b[i] * b[i] + c[i] * c[i]) + n;
}

static HEWN_INTO_CLONES void affine(const hewn_lane_tape *tape, const hewn_lane_step *step, const float *rows,
                                    float *restrict r, uint32_t count)
{
    const float *f = tape->factors[step->node], *a = rows + (size_t)step->from[0] * HEWN_LANES;
    const float *b = rows + (size_t)step->from[1] * HEWN_LANES, *c = rows + (size_t)step->from[2] * HEWN_LANES;
    const float f0 = f[0], f1 = f[1], f2 = f[2], n = step->number;
    if (step->input_count == 1)
        HEWN_LANE_LOOP(count)
    r[i] = f0 * a[i] + n;
    else if (step->input_count == 2) HEWN_LANE_LOOP(count) r[i] = f0 * a[i] + f1 * b[i] + n;
    else HEWN_LANE_LOOP(count) r[i] = f0 * a[i] + f1 * b[i] + f2 * c[i] + n;
}

HEWN_CLONES static void run(const hewn_lane_tape *tape, float *rows, const hewn_lane_points *points, uint32_t count)
{
    count &= ~(HEWN_LANE_BLOCK - 1U);
    for (uint32_t at = 0; at < tape->count; at++) {
        const hewn_lane_step *step = &tape->steps[at];
        float *restrict r = rows + (size_t)step->out * HEWN_LANES;
        const float *a = rows + (size_t)step->from[0] * HEWN_LANES, *b = rows + (size_t)step->from[1] * HEWN_LANES;
        float n = step->number;
        switch ((hewn_lane_kind)step->kind) {
        case HEWN_LANE_X: EACH(points->at[0][i]);
        case HEWN_LANE_Y: EACH(points->at[1][i]);
        case HEWN_LANE_Z: EACH(points->at[2][i]);
        case HEWN_LANE_NUMBER: EACH(n);
        case HEWN_LANE_NEG: EACH(-a[i]);
        case HEWN_LANE_ABS: EACH(fabsf(a[i]));
        case HEWN_LANE_SQRT: EACH(sqrtf(a[i]));
        case HEWN_LANE_SQUARE: EACH(a[i] * a[i]);
        case HEWN_LANE_PLUS: EACH(a[i] + n);
        case HEWN_LANE_TIMES: EACH(a[i] * n);
        case HEWN_LANE_LESS: EACH(n - a[i]);
        case HEWN_LANE_ADD: EACH(a[i] + b[i]);
        case HEWN_LANE_SUB: EACH(a[i] - b[i]);
        case HEWN_LANE_MUL: EACH(a[i] * b[i]);
        case HEWN_LANE_OVER: EACH(fabsf(a[i]) + n);
        case HEWN_LANE_LENGTH: length(step, rows, r, count); break;
        case HEWN_LANE_AFFINE: affine(tape, step, rows, r, count); break;
        case HEWN_LANE_FLOOR_AT: EACH(greatest(a[i], n));
        case HEWN_LANE_CEIL_AT: EACH(least(a[i], n));
        case HEWN_LANE_MIN: EACH(least(a[i], b[i]));
        case HEWN_LANE_MAX: EACH(greatest(a[i], b[i]));
        case HEWN_LANE_BLEND: EACH(blend(a[i], b[i], n, step->inverse));
        case HEWN_LANE_OUTLINE: hewn_lane_outline_value(&tape->outlines[step->node], a, b, r, count); break;
        default: other(tape, step, rows, count);
        }
    }
}

void hewn_lanes_value(const hewn_lane_tape *tape, hewn_lane_work *work, const hewn_lane_points *points, uint32_t count,
                      float *values)
{
    run(tape, work->values, points, count);
    const float *last = work->values + (size_t)tape->steps[tape->count - 1].out * HEWN_LANES;
    for (uint32_t i = 0; i < count; i++)
        values[i] = last[i];
}
