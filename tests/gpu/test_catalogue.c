/* Each function of the catalogue on the GPU: its values are the oracle's, its intervals contain its values; and noise
 * has the very bits that a serial twin in floats has. */
#include "../oracle/noise.h"
#include "../unit/catalogue_support.h"
#include "gpu_test.h"

#include "base/alloc.h"
#include "eval/code.h"

enum { POINTS = 4000, BOXES = 1000, IN_A_BOX = 12 };

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
    random_state random;
} fixture;

static float between(random_state *random, double lo, double hi)
{
    return (float)random_between(random, lo, hi);
}

/* How far the two may be apart: rounding of coordinates times how steep noise and octaves of it are. */
static double allowed(const hewn_function *function, double value)
{
    double units = function->section == HEWN_SECTION_NOISE ? 4000 : 400;
    return units * 0x1p-23 * (1 + fabs(value));
}

static void check_values(fixture *state, const hewn_code *code, const hewn_field *field, hewn_node root,
                         const hewn_function *function)
{
    static float points[3 * POINTS], values[POINTS];
    static double exact[3 * POINTS], expected[POINTS];
    for (int i = 0; i < 3 * POINTS; i++) {
        points[i] = between(&state->random, -2, 2);
        exact[i] = (double)points[i];
    }
    GPU_TEST_TRY(hewn_code_eval_points(state->device, code, points, POINTS, values, &error));
    GPU_TEST_TRY(hewn_field_eval(field, root, exact, POINTS, expected, &error));
    for (int i = 0; i < POINTS; i++)
        if (!(fabs((double)values[i] - expected[i]) <= allowed(function, expected[i])))
            fail_msg("%s at (%.9g, %.9g, %.9g): %.9g instead of %.9g", function->name, exact[3 * i], exact[3 * i + 1],
                     exact[3 * i + 2], (double)values[i], expected[i]);
}

static void check_intervals(fixture *state, const hewn_code *code, const char *name)
{
    static float boxes[6 * BOXES], points[3 * BOXES * IN_A_BOX], bounds[2 * BOXES], values[BOXES * IN_A_BOX];
    for (size_t b = 0; b < BOXES; b++) {
        float size = ldexpf(1, -(int)random_below(&state->random, 9)), *box = boxes + 6 * b;
        for (size_t k = 0; k < 3; k++) {
            box[k] = between(&state->random, -2, 2);
            box[3 + k] = box[k] + size * between(&state->random, 0, 1);
        }
        for (size_t i = 0; i < IN_A_BOX; i++)
            for (size_t k = 0; k < 3; k++) {
                float inner = between(&state->random, (double)box[k], (double)box[3 + k]);
                points[3 * (b * IN_A_BOX + i) + k] =
                    i < 8 ? box[(i >> k & 1) * 3 + k] : fminf(fmaxf(inner, box[k]), box[3 + k]);
            }
    }
    GPU_TEST_TRY(hewn_code_eval_boxes(state->device, code, boxes, BOXES, bounds, &error));
    GPU_TEST_TRY(hewn_code_eval_points(state->device, code, points, (size_t)BOXES * IN_A_BOX, values, &error));
    size_t useful = 0;
    for (size_t i = 0; i < (size_t)BOXES * IN_A_BOX; i++) {
        const float *bound = bounds + 2 * (i / IN_A_BOX);
        if (!(bound[0] <= values[i] && values[i] <= bound[1]))
            fail_msg("%s: [%.9g, %.9g] does not hold %.9g", name, (double)bound[0], (double)bound[1],
                     (double)values[i]);
        useful += isfinite(bound[0]) && isfinite(bound[1]);
    }
    if (useful < (size_t)BOXES * IN_A_BOX / 2)
        fail_msg("%s: most of its intervals say nothing", name);
}

static void functions_are_the_oracles(void **test_state)
{
    fixture *state = *test_state;
    static argument_room room;
    for (size_t i = 0; i < hewn_function_count; i++)
        for (int round = 0; round < (gpu_test_long() ? 10 : 1) && hewn_functions[i].build; round++) {
            hewn_argument values[HEWN_ARGUMENTS_MOST];
            hewn_field *field;
            GPU_TEST_TRY(hewn_field_create(&field, &error));
            hewn_node root = random_call(&state->random, field, &hewn_functions[i], values, &room);
            GPU_TEST_TRY(hewn_field_status(field, &error));
            hewn_code *code;
            GPU_TEST_TRY(hewn_code_create(state->device, field, root, &code, &error));
            check_values(state, code, field, root, &hewn_functions[i]);
            check_intervals(state, code, hewn_functions[i].name);
            hewn_code_destroy(state->device, &code);
            hewn_field_destroy(&field);
        }
}

static void noise_has_the_same_bits(void **test_state)
{
    enum { COUNT = 50000 };
    static float points[3 * COUNT], values[COUNT];
    fixture *state = *test_state;
    for (int kind = 0; kind < 4; kind++) {
        hewn_field *field;
        GPU_TEST_TRY(hewn_field_create(&field, &error));
        uint32_t seed = random_below(&state->random, 1u << 24);
        hewn_node_data data = {
            .op = (hewn_op)(HEWN_OP_NOISE_VALUE + kind), .operand = {0, 1, 2}, .parameter = {(double)seed}};
        hewn_node root = hewn_field_add_node(field, &data);
        GPU_TEST_TRY(hewn_field_status(field, &error));
        hewn_code *code;
        GPU_TEST_TRY(hewn_code_create(state->device, field, root, &code, &error));
        for (int i = 0; i < 3 * COUNT; i++) {
            double reach = ldexp(1, (int)random_below(&state->random, 26));
            points[i] = between(&state->random, -reach, reach);
            if (i % 17 == 0)
                points[i] = floorf(points[i]);
        }
        GPU_TEST_TRY(hewn_code_eval_points(state->device, code, points, COUNT, values, &error));
        for (int i = 0; i < COUNT; i++) {
            const float *p = points + 3 * i;
            float twin = oracle_noise(kind, p[0], p[1], p[2], seed);
            bool tiny = fabsf(twin) < FLT_MIN && fabsf(values[i]) < FLT_MIN; /* devices may take denormals for 0 */
            if (memcmp(&twin, &values[i], sizeof twin) != 0 && !tiny)
                fail_msg("noise %d of (%a, %a, %a) is %a, and %a in the twin", kind, (double)p[0], (double)p[1],
                         (double)p[2], (double)values[i], (double)twin);
        }
        hewn_code_destroy(state->device, &code);
        hewn_field_destroy(&field);
    }
}

/* Over many cells noise has about the mean 0 that it should, reaches far to both sides and no farther than 1. */
static void noise_is_balanced(void **test_state)
{
    enum { COUNT = 40000 };
    static double points[3 * COUNT], values[COUNT];
    fixture *state = *test_state;
    static const double reaches[] = {0.8, 0.6, 0.6, 0.3};
    for (int kind = 0; kind < 4; kind++) {
        hewn_field *field;
        GPU_TEST_TRY(hewn_field_create(&field, &error));
        hewn_node root = hewn_noise(field, (hewn_noise_kind)kind, 1, 7);
        for (int i = 0; i < 3 * COUNT; i++)
            points[i] = random_between(&state->random, -500, 500);
        GPU_TEST_TRY(hewn_field_eval(field, root, points, COUNT, values, &error));
        double sum = 0, least = 1, most = -1;
        for (int i = 0; i < COUNT; i++) {
            sum += values[i];
            least = fmin(least, values[i]);
            most = fmax(most, values[i]);
        }
        assert_true(least >= -1 && most <= 1 && least < -reaches[kind] && most > reaches[kind]);
        assert_true(fabs(sum / COUNT) < (kind == HEWN_NOISE_CELLULAR ? 0.2 : 0.01));
        hewn_field_destroy(&field);
    }
}

static int open_device(void **test_state)
{
    static fixture state;
    state.random = (random_state){41};
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
        cmocka_unit_test(noise_has_the_same_bits),
        cmocka_unit_test(noise_is_balanced),
        cmocka_unit_test(functions_are_the_oracles),
    };
    return cmocka_run_group_tests_name("catalogue", tests, open_device, close_device);
}
