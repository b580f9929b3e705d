/* Bounds of many boxes at once. Sums, products and roots are rounded to nearest, which is monotone, so the ends of the
 * operands give bounds of what values are with the very bits that values have; only operations in double are rounded
 * outward. A box in which something overflows or is no number gets no bounds. */
#include <math.h>
#include <string.h>

#include "base/clones.h"
#include "field/operate.h"
#include "lanes/internal.h"
#include "lanes/loops.h"
#include "lanes/outline.h"

/* What one step reads and writes; `unsure` gathers NaN where a bound is not finite. */
typedef struct rows {
    const float *alo, *ahi, *blo, *bhi, *clo, *chi;
    float *lo, *hi, *unsure;
    int32_t *choice;
    float *places; /* of outlines */
} rows;

static inline float least(float a, float b)
{
    return b < a ? b : a;
}

static inline float greatest(float a, float b)
{
    return b > a ? b : a;
}

static float down(double value)
{
    float near = (float)value;
    return (double)near > value ? nextafterf(near, -INFINITY) : near;
}

/* The links of an outline are rounded to float, one of them decides, and its root is rounded again. */
static hewn_interval widened(const hewn_node_data *node, hewn_interval bound, const hewn_interval *place)
{
    double far = fmax(fabs(place[0].lo), fabs(place[0].hi)) + fmax(fabs(place[1].lo), fabs(place[1].hi));
    double error = 0x1p-20 * (far + node->parameter[0]);
    return (hewn_interval){bound.lo - error, bound.hi + error, false};
}

static void other(const hewn_lane_tape *tape, const hewn_lane_step *step, const float *values, rows *r, uint32_t count)
{
    const hewn_node_data *node = &tape->others[step->node];
    for (uint32_t i = 0; i < count; i++) {
        hewn_interval in[HEWN_LANE_INPUTS] = {{0}};
        bool sure = r->unsure[i] == 0;
        for (uint32_t k = 0; k < step->input_count && sure; k++) {
            const float *row = values + (size_t)step->from[k] * 2 * HEWN_LANES + i;
            in[k] = (hewn_interval){(double)row[0], (double)row[HEWN_LANES], false};
            sure = row[0] <= row[HEWN_LANES];
        }
        hewn_interval bound = {0};
        if (sure)
            bound = hewn_op_bound(node, in);
        sure = sure && !bound.maybe_nan;
        if (sure && node->op == HEWN_OP_OUTLINE)
            bound = widened(node, bound, &in[1]);
        r->lo[i] = sure ? down(bound.lo) : -INFINITY;
        r->hi[i] = sure ? -down(-bound.hi) : INFINITY;
        if (sure && node->op == HEWN_OP_EDGE) /* no bound: the value in the middle, on both sides */
            r->lo[i] = r->hi[i] = (float)bound.lo;
    }
}

/* Keeps the places that the outline is asked at, for what it is cut down to. */
static void outline(const hewn_lane_outline *sides, rows *r, uint32_t count)
{
    const float *const x[2] = {r->alo, r->ahi}, *const y[2] = {r->blo, r->bhi};
    for (int i = 0; i < 2; i++) {
        memcpy(r->places + (size_t)i * HEWN_LANES, x[i], count * sizeof(float));
        memcpy(r->places + (size_t)(2 + i) * HEWN_LANES, y[i], count * sizeof(float));
    }
    hewn_lane_outline_bound(sides, x, y, r->lo, r->hi, count);
    for (uint32_t i = 0; i < count; i++)
        r->unsure[i] += (r->hi[i] - r->lo[i]) * 0.0F;
}

/* A blend that is not known here: of compact support it is the lesser operand where the two are `size` apart, as
 * f_overlap of the shaders rounds that; the exponential one is kept. */
static void choose_blend(const hewn_lane_tape *tape, const hewn_lane_step *step, rows *r, uint32_t count)
{
    bool compact = step->kind == HEWN_LANE_BLEND || tape->others[step->node].op != HEWN_OP_BLEND_EXPONENTIAL;
    for (uint32_t i = 0; i < count; i++) {
        bool first = compact && r->blo[i] - r->ahi[i] >= step->number;
        bool second = compact && r->alo[i] - r->bhi[i] >= step->number;
        r->choice[i] = first ? HEWN_KEEP_FIRST : second ? HEWN_KEEP_SECOND : HEWN_KEEP_BOTH;
    }
}

/* The value grows with both operands, in exact arithmetic; rounding may take it down by a unit or so of its size. */
static inline float blend(float a, float b, float size, float inverse, float outward)
{
    float apart = a == b ? 0.0F : fabsf(a - b);
    float h = size - apart;
    h = h < 0 ? 0.0F : h;
    float value = least(a, b) - 0.25F * (h * (h * inverse));
    float error = 0x1p-20F * (fabsf(a) + fabsf(b) + size);
    return h == 0.0F ? value : value + outward * error;
}

#define EACH(LOW, HIGH)                                                                                                \
    HEWN_LANE_LOOP(count)                                                                                              \
    {                                                                                                                  \
        float low = (LOW), high = (HIGH);                                                                              \
        lo[i] = low;                                                                                                   \
        hi[i] = high;                                                                                                  \
        unsure[i] += (high - low) * 0.0F;                                                                              \
    }                                                                                                                  \
    break

#define EACH_CHOICE(LOW, HIGH, FIRST, SECOND)                                                                          \
    HEWN_LANE_LOOP(count)                                                                                              \
    {                                                                                                                  \
        int32_t first = (FIRST) ? HEWN_KEEP_FIRST : 0, second = (SECOND) ? HEWN_KEEP_SECOND : 0;                       \
        float low = (LOW), high = (HIGH);                                                                              \
        choice[i] = first | second;                                                                                    \
        lo[i] = low;                                                                                                   \
        hi[i] = high;                                                                                                  \
    }                                                                                                                  \
    break

static inline float product_low(float a, float b, float c, float d)
{
    return least(least(a * c, a * d), least(b * c, b * d));
}

static inline float product_high(float a, float b, float c, float d)
{
    return greatest(greatest(a * c, a * d), greatest(b * c, b * d));
}

static inline float square_low(float a, float b)
{
    float nearest = greatest(greatest(a, -b), 0.0F);
    return nearest * nearest;
}

static inline float square_high(float a, float b)
{
    float farthest = greatest(-a, b);
    return farthest * farthest;
}

static HEWN_INTO_CLONES void length(const hewn_lane_step *step, rows *r, uint32_t count)
{
    float *restrict lo = r->lo, *restrict hi = r->hi, *restrict unsure = r->unsure, n = step->number;
    bool three = step->input_count > 2;
    for (int end = 0; end < 2; end++) {
        float *restrict out = end == 0 ? lo : hi;
        HEWN_LANE_LOOP(count)
        {
            float sum = end == 0 ? square_low(r->alo[i], r->ahi[i]) + square_low(r->blo[i], r->bhi[i])
                                 : square_high(r->alo[i], r->ahi[i]) + square_high(r->blo[i], r->bhi[i]);
            float third = end == 0 ? square_low(r->clo[i], r->chi[i]) : square_high(r->clo[i], r->chi[i]);
            out[i] = sqrtf(three ? sum + third : sum) + n;
        }
    }
    HEWN_LANE_LOOP(count)
    unsure[i] += (hi[i] - lo[i]) * 0.0F;
}

static HEWN_INTO_CLONES void affine(const float *factors, const hewn_lane_step *step, rows *r, uint32_t count)
{
    const float *const los[] = {r->alo, r->blo, r->clo}, *const his[] = {r->ahi, r->bhi, r->chi};
    float *restrict lo = r->lo, *restrict hi = r->hi, *restrict unsure = r->unsure, n = step->number;
    for (uint32_t k = 0; k < step->input_count; k++) {
        const float f = factors[k], *below = f < 0 ? his[k] : los[k], *above = f < 0 ? los[k] : his[k];
        if (k == 0)
            HEWN_LANE_LOOP(count)
            {
                lo[i] = f * below[i];
                hi[i] = f * above[i];
            }
        else
            HEWN_LANE_LOOP(count)
            {
                lo[i] += f * below[i];
                hi[i] += f * above[i];
            }
    }
    HEWN_LANE_LOOP(count)
    {
        lo[i] += n;
        hi[i] += n;
        unsure[i] += (hi[i] - lo[i]) * 0.0F;
    }
}

static void run_other(const hewn_lane_tape *tape, const hewn_lane_step *step, const float *values, rows *r,
                      uint32_t count)
{
    other(tape, step, values, r, count);
    if (step->kind == HEWN_LANE_OTHER_BLEND)
        choose_blend(tape, step, r, count);
    for (uint32_t i = 0; i < count; i++)
        r->unsure[i] += (r->hi[i] - r->lo[i]) * 0.0F;
}

HEWN_CLONES static void run_step(const hewn_lane_tape *tape, const hewn_lane_step *step, const float *values,
                                 const hewn_lane_boxes *boxes, rows *r, uint32_t count)
{
    const float *alo = r->alo, *ahi = r->ahi, *blo = r->blo, *bhi = r->bhi;
    float *restrict lo = r->lo, *restrict hi = r->hi, *restrict unsure = r->unsure;
    int32_t *restrict choice = r->choice;
    float n = step->number;
    count &= ~(HEWN_LANE_BLOCK - 1U);
    switch ((hewn_lane_kind)step->kind) {
    case HEWN_LANE_X: EACH(boxes->lo[0][i], boxes->hi[0][i]);
    case HEWN_LANE_Y: EACH(boxes->lo[1][i], boxes->hi[1][i]);
    case HEWN_LANE_Z: EACH(boxes->lo[2][i], boxes->hi[2][i]);
    case HEWN_LANE_NUMBER: EACH(n, n);
    case HEWN_LANE_NEG: EACH(-ahi[i], -alo[i]);
    case HEWN_LANE_ABS: EACH(greatest(greatest(alo[i], -ahi[i]), 0.0F), greatest(-alo[i], ahi[i]));
    case HEWN_LANE_SQRT: EACH(sqrtf(alo[i]), sqrtf(ahi[i]));
    case HEWN_LANE_SQUARE: EACH(square_low(alo[i], ahi[i]), square_high(alo[i], ahi[i]));
    case HEWN_LANE_PLUS: EACH(alo[i] + n, ahi[i] + n);
    case HEWN_LANE_TIMES: EACH(least(alo[i] * n, ahi[i] * n), greatest(alo[i] * n, ahi[i] * n));
    case HEWN_LANE_LESS: EACH(n - ahi[i], n - alo[i]);
    case HEWN_LANE_ADD: EACH(alo[i] + blo[i], ahi[i] + bhi[i]);
    case HEWN_LANE_SUB: EACH(alo[i] - bhi[i], ahi[i] - blo[i]);
    case HEWN_LANE_MUL: EACH(product_low(alo[i], ahi[i], blo[i], bhi[i]), product_high(alo[i], ahi[i], blo[i], bhi[i]));
    case HEWN_LANE_OVER: EACH(greatest(greatest(alo[i], -ahi[i]), 0.0F) + n, greatest(-alo[i], ahi[i]) + n);
    case HEWN_LANE_LENGTH: length(step, r, count); break;
    case HEWN_LANE_AFFINE: affine(tape->factors[step->node], step, r, count); break;
    case HEWN_LANE_FLOOR_AT: EACH_CHOICE(greatest(alo[i], n), greatest(ahi[i], n), alo[i] > n, ahi[i] < n);
    case HEWN_LANE_CEIL_AT: EACH_CHOICE(least(alo[i], n), least(ahi[i], n), ahi[i]<n, alo[i]> n);
    case HEWN_LANE_MIN: EACH_CHOICE(least(alo[i], blo[i]), least(ahi[i], bhi[i]), ahi[i] < blo[i], bhi[i] < alo[i]);
    case HEWN_LANE_MAX:
        EACH_CHOICE(greatest(alo[i], blo[i]), greatest(ahi[i], bhi[i]), alo[i] > bhi[i], blo[i] > ahi[i]);
    case HEWN_LANE_BLEND:
        choose_blend(tape, step, r, count);
        EACH(blend(alo[i], blo[i], n, step->inverse, -1), blend(ahi[i], bhi[i], n, step->inverse, 1));
    case HEWN_LANE_OUTLINE: outline(&tape->outlines[step->node], r, count); break;
    default: run_other(tape, step, values, r, count);
    }
}

void hewn_lanes_bound(const hewn_lane_tape *tape, hewn_lane_work *work, const hewn_lane_boxes *boxes, uint32_t count,
                      float *lo, float *hi)
{
    float unsure[HEWN_LANES] = {0};
    enum { ROW = 2 * HEWN_LANES };
    float *values = work->values;
    rows r = {.unsure = unsure, .choice = work->choices, .places = work->places};
    for (uint32_t at = 0; at < tape->count; at++) {
        const hewn_lane_step *step = &tape->steps[at];
        r.alo = values + (size_t)step->from[0] * ROW;
        r.ahi = r.alo + HEWN_LANES;
        r.blo = values + (size_t)step->from[1] * ROW;
        r.bhi = r.blo + HEWN_LANES;
        r.clo = values + (size_t)step->from[2] * ROW;
        r.chi = r.clo + HEWN_LANES;
        r.lo = values + (size_t)step->out * ROW;
        r.hi = r.lo + HEWN_LANES;
        run_step(tape, step, values, boxes, &r, count);
        if (hewn_lane_can_cut(step))
            r.choice += HEWN_LANES;
        if (step->kind == HEWN_LANE_OUTLINE)
            r.places += 4 * HEWN_LANES;
    }
    const float *last = values + (size_t)tape->steps[tape->count - 1].out * ROW;
    for (uint32_t i = 0; i < count; i++) {
        bool sure = unsure[i] == 0 && last[i] <= last[HEWN_LANES + i];
        lo[i] = sure ? last[i] : -INFINITY;
        hi[i] = sure ? last[HEWN_LANES + i] : INFINITY;
    }
}
