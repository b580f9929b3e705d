/* Values on the GPU against the oracle in double, operation by operation, within the bounds of docs/evaluation.md. */
#include "test_code_support.h"

#define UNIT 1.1920928955078125e-07 /* 2^-23 */

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
    uint64_t random;
} fixture;

/* --- bounds ------------------------------------------------------------------------------------------------------ */

typedef struct tolerance {
    double ulps;     /* of the result */
    double absolute; /* units of the sizes of all operands and parameters together */
} tolerance;

static tolerance bound_of(hewn_op op)
{
    switch (op) {
    case HEWN_OP_ADD:
    case HEWN_OP_SUB:
    case HEWN_OP_MUL:
    case HEWN_OP_SQUARE: return (tolerance){1, 0};
    case HEWN_OP_DIV: return (tolerance){2.5, 0};
    case HEWN_OP_SQRT: return (tolerance){4.5, 0};
    case HEWN_OP_SIN:
    case HEWN_OP_COS:
    case HEWN_OP_ASIN:
    case HEWN_OP_ACOS:
    case HEWN_OP_ATAN:
    case HEWN_OP_ATAN2:
    case HEWN_OP_EXP:
    case HEWN_OP_LN: return (tolerance){4, 0};
    case HEWN_OP_TAN: return (tolerance){6, 0};
    case HEWN_OP_AFFINE:
    case HEWN_OP_PLANE: return (tolerance){1, 4};
    case HEWN_OP_SPHERE:
    case HEWN_OP_BOX:
    case HEWN_OP_ROUNDED_BOX:
    case HEWN_OP_CAPSULE: return (tolerance){1, 8};
    case HEWN_OP_TORUS:
    case HEWN_OP_CYLINDER: return (tolerance){1, 12};
    case HEWN_OP_CONE: return (tolerance){1, 20};
    case HEWN_OP_NOISE_VALUE:
    case HEWN_OP_NOISE_GRADIENT:
    case HEWN_OP_NOISE_CELLULAR: return (tolerance){0, 24};
    case HEWN_OP_NOISE_SIMPLEX: return (tolerance){0, 100};
    case HEWN_OP_ZIGZAG:
    case HEWN_OP_BLEND_QUADRATIC:
    case HEWN_OP_BLEND_CUBIC: return (tolerance){1, 4};
    case HEWN_OP_BLEND_CIRCULAR: return (tolerance){1, 10};
    case HEWN_OP_BLEND_EXPONENTIAL: return (tolerance){1, 12};
    default: return (tolerance){0, 0};
    }
}

/* Whether the operation squares its operands, which overflows from 2^63 on and loses what is below 2^-62. */
static bool has_lengths(hewn_op op)
{
    return op >= HEWN_OP_SPHERE && op <= HEWN_OP_CONE;
}

static double size_of_all(const hewn_node_data *node, const float *in)
{
    double sum = 0, factor = 1;
    if (node->op == HEWN_OP_NOISE_SIMPLEX)
        return 1 + fabs((double)in[0]) + fabs((double)in[1]) + fabs((double)in[2]);
    if (node->op >= HEWN_OP_NOISE_VALUE && node->op <= HEWN_OP_NOISE_CELLULAR)
        return 1;
    for (int i = 0; i < hewn_op_infos[node->op].parameters; i++)
        sum += fabs(node->parameter[i]);
    if (node->op == HEWN_OP_BLEND_EXPONENTIAL)
        return 1 / node->parameter[0];
    if (node->op >= HEWN_OP_BLEND_QUADRATIC)
        return sum;
    if (node->op == HEWN_OP_AFFINE)
        for (int i = 0; i < 3; i++)
            factor = fmax(factor, fabs(node->parameter[i]));
    for (int i = 0; i < hewn_op_infos[node->op].operands; i++)
        sum += fabs((double)in[i]) * factor;
    return sum;
}

/* Where a promise ends early: past the reduction of waves, and past the exact quotients of mod. */
static bool is_beyond(hewn_op op, const float *in, float value, bool *good)
{
    if ((op == HEWN_OP_SIN || op == HEWN_OP_COS || op == HEWN_OP_TAN) && isfinite(in[0]) && fabsf(in[0]) > 12867.0f) {
        *good = op == HEWN_OP_TAN ? !isnan(value) : fabsf(value) <= 1;
        return true;
    }
    if (op == HEWN_OP_MOD && isfinite(in[0]) && isfinite(in[1]) && in[1] != 0 &&
        fabs((double)in[0] / (double)in[1]) > 4194304.0) {
        *good = (value >= 0 && value <= fabsf(in[1])) || (code_is_denormal(in[1]) && isnan(value));
        return true;
    }
    return false;
}

static bool is_close(const hewn_node_data *node, const float *in, float value, double expected)
{
    hewn_op op = node->op;
    if (op == HEWN_OP_CONE && (isinf(in[0]) || isinf(in[1]) || isinf(in[2])))
        return true; /* infinities of the two lines it is between may cancel */
    if (isnan(expected))
        return isnan(value);
    bool is_sum = op == HEWN_OP_AFFINE || op == HEWN_OP_PLANE;
    if (is_sum && !isfinite(value) && !(size_of_all(node, in) < (double)FLT_MAX))
        return true; /* a term overflows before the sum does */
    if (has_lengths(op) && fmax(fabs((double)in[0]), fmax(fabs((double)in[1]), fabs((double)in[2]))) > 9e18)
        return !isnan(value);
    if ((op != HEWN_OP_MOD || isinf(expected)) && fabs(expected) > (double)FLT_MAX * (1 - 16 * UNIT)) {
        float end = expected > 0 ? FLT_MAX : -FLT_MAX;
        return isinf(expected) ? (double)value == expected
                               : value == 2 * end || fabs((double)value - (double)end) <= 32 * UNIT * (double)FLT_MAX;
    }
    if (!isfinite(value))
        return false;
    tolerance bound = bound_of(op);
    int exponent;
    frexp(expected, &exponent);
    double allowed = bound.ulps * ldexp(1, exponent - 24) + (double)FLT_MIN;
    if (bound.absolute > 0)
        allowed += bound.absolute * UNIT * size_of_all(node, in);
    if (has_lengths(op))
        allowed += 0x1p-62;
    double off = fabs((double)value - expected);
    if (op == HEWN_OP_MOD) {
        double b = fabs((double)in[1]);
        allowed += 2 * UNIT * b;
        off = fmin(off, fabs(b - off));
    }
    return off <= allowed;
}

/* Denormal operands may count as zero, so either value will do. */
static bool is_right(const hewn_field *field, hewn_node root, const float *in, float value, double *expected)
{
    const hewn_node_data *node = hewn_field_node(field, root.id);
    bool good = false;
    if (is_beyond(node->op, in, value, &good))
        return good;
    for (int flushed = 0; flushed < 8; flushed++) {
        double point[3];
        bool differs = true;
        for (int i = 0; i < 3; i++) {
            bool flush = flushed >> i & 1;
            differs = differs && (!flush || code_is_denormal(in[i]));
            point[i] = flush ? copysign(0.0, (double)in[i]) : (double)in[i];
        }
        double other;
        if (!differs)
            continue;
        GPU_TEST_TRY(hewn_field_eval(field, root, point, 1, &other, &error));
        if (flushed == 0)
            *expected = other;
        if (is_close(node, in, value, other))
            return true;
    }
    return false;
}

/* --- samples ----------------------------------------------------------------------------------------------------- */

enum { RANDOM = 10000 };

static size_t awkward_count(int operands)
{
    size_t count = 1;
    for (int i = 0; i < operands; i++)
        count *= CODE_AWKWARD;
    return count;
}

/* All combinations of awkward numbers, then random ones of all sizes and of everyday sizes. */
static float *make_samples(hewn_op op, uint64_t *random, size_t *count)
{
    int operands = hewn_op_infos[op].operands;
    size_t awkward = awkward_count(operands), stride = 1;
    if (operands == 3 && !gpu_test_long())
        stride = 7; /* coprime to the number of values: all pairs of neighbours still occur */
    *count = awkward / stride + RANDOM;
    float *samples = hewn_alloc(*count * 3, sizeof *samples);
    assert_non_null(samples);
    for (size_t i = 0; i < *count; i++) {
        size_t code = i * stride;
        for (int k = 0; k < 3; k++) {
            float *at = &samples[3 * i + (size_t)k];
            if (i < awkward / stride) {
                *at = k < operands ? code_awkward_at(code % CODE_AWKWARD) : 0.0f;
                code /= CODE_AWKWARD;
            } else if (i % 4 == 0) {
                *at = code_any_size(random, 1e-30, 1e30);
            } else {
                *at = (float)code_between(random, i % 4 == 1 ? -1 : -30, i % 4 == 1 ? 1 : 30);
            }
        }
    }
    return samples;
}

static void check_op(fixture *state, hewn_op op)
{
    double parameters[HEWN_MAX_PARAMETERS];
    hewn_node root;
    size_t count;
    code_parameters(op, &state->random, parameters);
    hewn_field *field = code_one_op(op, parameters, &root);
    hewn_code *code = code_of(state->device, field, root);
    float *samples = make_samples(op, &state->random, &count);
    float *values = hewn_alloc(count, sizeof *values);
    assert_non_null(values);
    GPU_TEST_TRY(hewn_code_eval_points(state->device, code, samples, count, values, &error));
    size_t wrong = 0;
    for (size_t i = 0; i < count; i++) {
        double expected = 0;
        const float *in = samples + 3 * i;
        if (!is_right(field, root, in, values[i], &expected) && wrong++ < 8)
            print_error("# %s(%.9g, %.9g, %.9g) = %.9g instead of %.9g\n", hewn_op_infos[op].name, (double)in[0],
                        (double)in[1], (double)in[2], (double)values[i], expected);
    }
    hewn_free(samples);
    hewn_free(values);
    hewn_code_destroy(state->device, &code);
    hewn_field_destroy(&field);
    if (wrong > 0)
        fail_msg("%s: %zu of %zu values are wrong", hewn_op_infos[op].name, wrong, count);
}

static void values_keep_their_bounds(void **test_state)
{
    for (int op = 0; op < HEWN_OP_COUNT; op++)
        if (!hewn_op_is_link((hewn_op)op))
            check_op(*test_state, (hewn_op)op);
}

/* Where results are known without rounding. */
static void exact_values_are_exact(void **test_state)
{
    fixture *state = *test_state;
    static const struct {
        hewn_op op;
        float in[2], out;
    } cases[] = {
        {HEWN_OP_SQRT, {4, 0}, 2},
        {HEWN_OP_SIN, {0, 0}, 0},
        {HEWN_OP_COS, {0, 0}, 1},
        {HEWN_OP_EXP, {0, 0}, 1},
        {HEWN_OP_EXP, {-1e4f, 0}, 0},
        {HEWN_OP_LN, {1, 0}, 0},
        {HEWN_OP_ROUND, {0.49999997f, 0}, 0},
        {HEWN_OP_ROUND, {-2.5f, 0}, -3},
        {HEWN_OP_ROUND, {8388609.0f, 0}, 8388609.0f},
        {HEWN_OP_MOD, {-1, 3}, 2},
        {HEWN_OP_MOD, {7.5f, -2}, 1.5f},
        {HEWN_OP_ATAN2, {0, 1}, 0},
        {HEWN_OP_COMPARE, {1, 2}, -1},
        {HEWN_OP_AND, {0, 5}, 0},
        {HEWN_OP_AND, {2, 5}, 5},
        {HEWN_OP_OR, {0, 5}, 5},
        {HEWN_OP_OR, {2, 5}, 2},
        {HEWN_OP_NOT, {0, 0}, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double parameters[HEWN_MAX_PARAMETERS] = {0};
        hewn_node root;
        hewn_field *field = code_one_op(cases[i].op, parameters, &root);
        hewn_code *code = code_of(state->device, field, root);
        const float point[3] = {cases[i].in[0], cases[i].in[1], 0};
        float value;
        GPU_TEST_TRY(hewn_code_eval_points(state->device, code, point, 1, &value, &error));
        if (value != cases[i].out)
            fail_msg("%s(%g, %g) = %.9g", hewn_op_infos[cases[i].op].name, (double)point[0], (double)point[1],
                     (double)value);
        hewn_code_destroy(state->device, &code);
        hewn_field_destroy(&field);
    }
}

static int open_device(void **test_state)
{
    static fixture state;
    state.random = 0x1234567890abcdefu;
    state.device = gpu_test_open(&state.messages);
    *test_state = &state;
    return 0;
}

static int close_device(void **test_state)
{
    fixture *state = *test_state;
    gpu_test_close(&state->device, &state->messages);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_keep_their_bounds),
        cmocka_unit_test(exact_values_are_exact),
    };
    return cmocka_run_group_tests_name("code_values", tests, open_device, close_device);
}
