/* Samplings on the device: values and gradients are the oracle's, intervals contain values, and lists give the bits of
 * straight code. */
#include "../unit/sampling_support.h"
#include "gpu_test.h"

#include "eval/lists.h"
#include "hewn/hewn.h"
#include "iso/extractor.h"

enum { POINTS = 20000, BOXES = 3000, IN_A_BOX = 12 };

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
    random_state random;
} fixture;

static float between(random_state *random, double lo, double hi)
{
    return (float)random_between(random, lo, hi);
}

/* A sampling in a turned frame, or land. */
static hewn_node make(random_state *random, hewn_field *field, int round, double *size)
{
    hewn_sampling *s;
    hewn_node made;
    if (round % 2) {
        s = random_heights(random, 2 + random_below(random, 60), 2 + random_below(random, 60));
        *size = 1;
        made = hewn_heights(field, s, 4, 4, 0.4);
    } else {
        s = random_sampling(random, 5);
        double cell = 4.0 / s->cells[0];
        *size = 2 * cell * fmax(s->cells[1], s->cells[2]);
        const hewn_sampling_place at = {{-2, -0.5 * cell * s->cells[1], -0.5 * cell * s->cells[2]}, cell};
        made = hewn_rotate(field, hewn_sampled(field, s, &at), 1, 0.5, 0.2, 0.6);
    }
    hewn_sampling_destroy(&s); /* the field holds it */
    GPU_TEST_TRY(hewn_field_status(field, &error));
    return made;
}

static void check_values(fixture *state, const hewn_code *code, const hewn_field *field, hewn_node root, double size)
{
    static float points[3 * POINTS], values[POINTS], gradients[4 * POINTS];
    static double exact[3 * POINTS], expected[POINTS], slopes[4 * POINTS];
    for (int i = 0; i < 3 * POINTS; i++) {
        points[i] = between(&state->random, -4, 4);
        exact[i] = (double)points[i];
    }
    GPU_TEST_TRY(hewn_code_eval_points(state->device, code, points, POINTS, values, &error));
    GPU_TEST_TRY(hewn_code_eval_gradients(state->device, code, points, POINTS, gradients, &error));
    GPU_TEST_TRY(hewn_field_eval(field, root, exact, POINTS, expected, &error));
    GPU_TEST_TRY(hewn_field_gradient(field, root, exact, POINTS, slopes, &error));
    int apart = 0;
    for (int i = 0; i < POINTS; i++) {
        if (!(fabs((double)values[i] - expected[i]) <= 400 * 0x1p-23 * (size + fabs(expected[i]))))
            fail_msg("at (%.9g, %.9g, %.9g): %.9g instead of %.9g", exact[3 * i], exact[3 * i + 1], exact[3 * i + 2],
                     (double)values[i], expected[i]);
        assert_memory_equal(&gradients[4 * i], &values[i], sizeof *values);
        for (int k = 0; k < 3; k++) /* in another cell only within rounding of a border */
            apart += fabs((double)gradients[4 * i + 1 + k] - slopes[4 * i + 1 + k]) > 1e-2;
    }
    assert_true(apart < POINTS / 500);
}

static void check_intervals(fixture *state, const hewn_code *code)
{
    static float boxes[6 * BOXES], points[3 * BOXES * IN_A_BOX], bounds[2 * BOXES], values[BOXES * IN_A_BOX];
    double widths = 0, ranges = 0;
    for (size_t b = 0; b < BOXES; b++) {
        float size = ldexpf(4, -(int)random_below(&state->random, 12)), *box = boxes + 6 * b;
        for (size_t k = 0; k < 3; k++) {
            box[k] = between(&state->random, -3, 3);
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
    for (size_t b = 0; b < BOXES; b++) {
        const float *bound = bounds + 2 * b;
        float lo = INFINITY, hi = -INFINITY;
        for (size_t i = b * IN_A_BOX; i < (b + 1) * IN_A_BOX; i++) {
            if (!(bound[0] <= values[i] && values[i] <= bound[1]))
                fail_msg("[%.9g, %.9g] does not hold %.9g", (double)bound[0], (double)bound[1], (double)values[i]);
            lo = fminf(lo, values[i]);
            hi = fmaxf(hi, values[i]);
        }
        widths += (double)(bound[1] - bound[0]);
        ranges += (double)(hi - lo);
    }
    assert_true(widths < 6 * ranges);
}

static void samples_are_the_oracles(void **test_state)
{
    fixture *state = *test_state;
    for (int round = 0; round < 6; round++) {
        hewn_field *field;
        double size;
        GPU_TEST_TRY(hewn_field_create(&field, &error));
        hewn_node root = make(&state->random, field, round, &size);
        hewn_code *code;
        GPU_TEST_TRY(hewn_code_create(state->device, field, root, &code, &error));
        check_values(state, code, field, root, size);
        check_intervals(state, code);
        hewn_code_destroy(state->device, &code);
        hewn_field_destroy(&field);
    }
}

static hewn_triangles mesh_of(fixture *state, const hewn_field *field, hewn_node root, const hewn_code_desc *how)
{
    hewn_extractor *extractor;
    GPU_TEST_TRY(hewn_extractor_create_as(state->device, field, root, how, &extractor, &error));
    const hewn_extract_desc desc = {.bounds = {{-2.5, -2.5, -2.5}, {2.5, 2.5, 2.5}}, .resolution = 72};
    hewn_triangles triangles;
    GPU_TEST_TRY(hewn_extract(extractor, &desc, &triangles, NULL, &error));
    hewn_extractor_destroy(&extractor);
    return triangles;
}

/* With other shapes around them, in lists pruned or whole and straight: the same bytes. */
static void lists_give_the_same_mesh(void **test_state)
{
    fixture *state = *test_state;
    for (int round = 0; round < 2; round++) {
        hewn_field *field;
        double size;
        GPU_TEST_TRY(hewn_field_create(&field, &error));
        hewn_node root = make(&state->random, field, round, &size);
        for (int i = 0; i < 12; i++) {
            hewn_node ball =
                hewn_translate(field, hewn_sphere(field, random_between(&state->random, 0.1, 0.4)),
                               random_between(&state->random, -2, 2), random_between(&state->random, -2, 2),
                               random_between(&state->random, -2, 2));
            root = i % 3 ? hewn_union(field, root, ball)
                         : hewn_smooth_difference(field, root, ball, HEWN_BLEND_QUADRATIC, 0.1);
        }
        GPU_TEST_TRY(hewn_field_status(field, &error));
        hewn_triangles straight =
            mesh_of(state, field, root, &(hewn_code_desc){.evaluation = HEWN_EVALUATION_STRAIGHT});
        for (int whole = 0; whole < 2; whole++) {
            hewn_triangles listed = mesh_of(
                state, field, root, &(hewn_code_desc){.evaluation = HEWN_EVALUATION_LISTED, .whole = whole != 0});
            assert_true(straight.triangle_count > 1000);
            assert_int_equal(straight.vertex_count, listed.vertex_count);
            assert_int_equal(straight.triangle_count, listed.triangle_count);
            assert_memory_equal(straight.positions, listed.positions, 12 * straight.vertex_count);
            assert_memory_equal(straight.indices, listed.indices, 12 * straight.triangle_count);
            hewn_triangles_destroy(&listed);
        }
        hewn_certificate certificate;
        GPU_TEST_TRY(hewn_certify(&straight, NULL, &certificate, &error));
        assert_true(certificate.closed && certificate.manifold && certificate.oriented);
        hewn_triangles_destroy(&straight);
        hewn_field_destroy(&field);
    }
}

/* Another sampling needs other code, the same one moved does not; and the field may go. */
static void renumbering_keeps_samples(void **test_state)
{
    fixture *state = *test_state;
    hewn_sampling *one = random_sampling(&state->random, 3), *two = random_sampling(&state->random, 3);
    const hewn_sampling_place here = {{-1, -1.5, -1.25}, 0.125}, there = {{-1.25, -1.75, -1.5}, 0.15625};
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    hewn_node a = hewn_sampled(field, one, &here), b = hewn_sampled(field, one, &there),
              c = hewn_sampled(field, two, &here);
    hewn_code *code;
    bool taken;
    GPU_TEST_TRY(hewn_code_create(state->device, field, a, &code, &error));
    GPU_TEST_TRY(hewn_code_renumber(code, field, c, &taken, &error));
    assert_false(taken);
    GPU_TEST_TRY(hewn_code_renumber(code, field, b, &taken, &error));
    assert_true(taken);
    float point[3] = {0.2f, 0.1f, 0.3f}, value;
    const double exact[3] = {(double)point[0], (double)point[1], (double)point[2]};
    double expected;
    GPU_TEST_TRY(hewn_field_eval(field, b, exact, 1, &expected, &error));
    hewn_field_destroy(&field);
    hewn_sampling_destroy(&one);
    hewn_sampling_destroy(&two);
    GPU_TEST_TRY(hewn_code_eval_points(state->device, code, point, 1, &value, &error));
    assert_true(fabs((double)value - expected) < 1e-4);
    hewn_code_destroy(state->device, &code);
}

static int open_device(void **test_state)
{
    static fixture state;
    state.random = (random_state){51};
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
        cmocka_unit_test(samples_are_the_oracles),
        cmocka_unit_test(lists_give_the_same_mesh),
        cmocka_unit_test(renumbering_keeps_samples),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
