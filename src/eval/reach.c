/* How large values can get for coordinates up to HEWN_REACH, so that intervals need not be checked for overflow and NaN
 * where neither can be. Rounding may add a little to each size; MOST leaves room for far more than all of it. */
#include <math.h>

#include "eval/listing.h"

static const double most = 1e30;         /* of a sure step */
static const double most_squared = 1e15; /* of what is squared on the way */

typedef struct operands {
    const hewn_code_step *a, *b;
    double sum;     /* of sizes */
    double largest; /* of sizes */
    bool sure;      /* all of them */
    bool positive;  /* all of them */
} operands;

static const hewn_code_step no_step; /* stands where an operation has no such operand */

static operands look_at(const hewn_listing *listing, const hewn_code_step *step)
{
    operands in = {.sure = true, .positive = true};
    for (uint32_t i = 0; i < step->in_count; i++) {
        const hewn_code_step *one = &listing->steps[step->in[i]];
        in.sum += one->size;
        in.largest = fmax(in.largest, one->size);
        in.sure = in.sure && one->sure;
        in.positive = in.positive && one->positive;
    }
    in.a = step->in_count > 0 ? &listing->steps[step->in[0]] : &no_step;
    in.b = step->in_count > 1 ? &listing->steps[step->in[1]] : &no_step;
    return in;
}

static void set(hewn_code_step *step, double size, bool positive, bool sure)
{
    step->size = size;
    step->positive = positive;
    step->sure = sure && size < most;
}

static double parameter_of(const hewn_listing *listing, const hewn_code_step *step)
{
    return step->parameter_count > 0 ? fabs((double)listing->parameters[step->parameter]) : 0;
}

/* A divisor that is a number and far from 0 and from what devices divide by. */
static bool divides_well(const hewn_listing *listing, const hewn_code_step *divisor, double *size)
{
    *size = parameter_of(listing, divisor);
    return divisor->op == HEWN_OP_CONSTANT && *size > 1e-30 && *size < most;
}

static void reach_of_arithmetic(const hewn_listing *listing, hewn_code_step *step, const operands *in)
{
    double divisor;
    switch (step->op) {
    case HEWN_OP_ADD: set(step, in->sum, in->positive, in->sure); break;
    case HEWN_OP_SUB: set(step, in->sum, false, in->sure); break;
    case HEWN_OP_MUL: set(step, in->a->size * in->b->size, in->positive, in->sure); break;
    case HEWN_OP_DIV:
        step->sure = divides_well(listing, in->b, &divisor);
        set(step, in->a->size / divisor, in->positive, in->sure && step->sure);
        break;
    case HEWN_OP_MOD:
        step->sure = divides_well(listing, in->b, &divisor);
        set(step, divisor, true, in->sure && step->sure);
        break;
    case HEWN_OP_MIN: set(step, in->largest, in->positive, in->sure); break;
    case HEWN_OP_MAX: set(step, in->largest, in->a->positive || in->b->positive, in->sure); break;
    case HEWN_OP_ATAN2: set(step, 4, false, in->sure); break;
    case HEWN_OP_COMPARE: set(step, 1, false, in->sure); break;
    default: set(step, in->largest, in->positive, in->sure); /* and, or */
    }
}

static void reach_of_function(hewn_code_step *step, const operands *in)
{
    double size = in->largest;
    switch (step->op) {
    case HEWN_OP_NEG: set(step, size, false, in->sure); break;
    case HEWN_OP_ABS: set(step, size, true, in->sure); break;
    case HEWN_OP_SQRT: set(step, sqrt(size), true, in->sure && in->positive); break;
    case HEWN_OP_SQUARE: set(step, size * size, true, in->sure); break;
    case HEWN_OP_SIN:
    case HEWN_OP_COS: set(step, 1, false, in->sure); break;
    case HEWN_OP_ATAN: set(step, 2, false, in->sure); break;
    case HEWN_OP_EXP: set(step, size < 60 ? exp(size) : most, true, in->sure); break;
    case HEWN_OP_FLOOR:
    case HEWN_OP_CEIL:
    case HEWN_OP_ROUND: set(step, size + 1, in->positive, in->sure); break;
    case HEWN_OP_NOT: set(step, 1, true, in->sure); break;
    default: set(step, most, false, false); /* tan, asin, acos, ln */
    }
}

static void reach_of_shape(const hewn_listing *listing, hewn_code_step *step, const operands *in)
{
    double size = in->sum, factor = 1;
    if (step->function && step->function[0] == 'a') { /* affine: all but the last parameter are factors */
        for (uint32_t i = 0; i + 1 < step->parameter_count; i++)
            factor = fmax(factor, fabs((double)listing->parameters[step->parameter + i]));
        size *= factor;
    }
    for (uint32_t i = 0; i < step->parameter_count; i++)
        size += fabs((double)listing->parameters[step->parameter + i]);
    bool squares = step->op >= HEWN_OP_SPHERE && step->op <= HEWN_OP_CONE;
    set(step, size, false, in->sure && (!squares || size < most_squared));
}

/* An outline is as far as its coordinates, and a link's square distance as their squares; past the start of the chain
 * the links would say nothing. */
static void reach_of_others(const hewn_listing *listing, hewn_code_step *step, const operands *in)
{
    double sum = 0;
    uint32_t first = step->table ? 0 : 1, numbers = step->table ? 1 : step->parameter_count;
    for (uint32_t i = first; i < step->in_count; i++)
        sum += listing->steps[step->in[i]].size;
    for (uint32_t i = 0; i < numbers; i++) /* of a table the outline's size, which follows its address */
        sum += fabs((double)listing->parameters[step->parameter + (step->table ? HEWN_ADDRESS_NUMBERS : 0) + i]);
    switch (step->op) {
    case HEWN_OP_EDGE: set(step, HEWN_OUTLINE_START, false, in->sure && sum < 0.1 * most_squared); break;
    case HEWN_OP_OUTLINE: set(step, sqrt(HEWN_OUTLINE_START), false, in->sure && sum < 0.1 * most_squared); break;
    case HEWN_OP_SAMPLED: set(step, in->sum + sum, false, in->sure && in->sum + sum < most_squared); break;
    case HEWN_OP_ZIGZAG: set(step, parameter_of(listing, step), true, in->sure && in->largest < most_squared); break;
    default: set(step, 1, step->op == HEWN_OP_NOISE_CELLULAR, in->sure); /* noise */
    }
}

void hewn_code_step_reach(const hewn_listing *listing, hewn_code_step *step)
{
    operands in = look_at(listing, step);
    if (step->op <= HEWN_OP_Z) {
        set(step, HEWN_REACH, false, true);
    } else if (step->op == HEWN_OP_CONSTANT) {
        float value = listing->parameters[step->parameter];
        set(step, isfinite(value) ? fabs((double)value) : most, value >= 0, isfinite(value));
    } else if (step->op >= HEWN_OP_NOISE_VALUE && step->op <= HEWN_OP_ZIGZAG) {
        reach_of_others(listing, step, &in);
    } else if (step->op >= HEWN_OP_AFFINE) {
        reach_of_shape(listing, step, &in);
    } else if (step->in_count == 1) {
        reach_of_function(step, &in);
    } else {
        reach_of_arithmetic(listing, step, &in);
    }
}
