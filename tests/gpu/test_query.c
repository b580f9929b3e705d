/* Answers of the device and of the host: nothing of the surface is nearer than `low`, by random points that the oracle
 * evaluates, and there is some at `high`; and both bound the same number. */
#include <math.h>

#include "gpu_test_device.h"
#include "hewn/query.h"
#include "random_fields.h"

enum { COUNT = 24, SAMPLES = 300 };
#define TOLERANCE 0.004

static uint64_t state_of_random = 77;

static const hewn_box box = {{-1.3, -1.3, -1.3}, {1.3, 1.3, 1.3}};

static double uniform(void)
{
    return (double)gpu_test_random(&state_of_random) / 2147483648.0 - 1;
}

/* Twisted bars: no slope is known. */
static hewn_node make_twist(hewn_field *field, uint32_t seed)
{
    return hewn_twist(field, hewn_box_shape(field, 1.1, 1.5, 0.3), 1.5 + seed);
}

static hewn_node make_waves_in_ball(hewn_field *field, uint32_t seed)
{
    hewn_node wave = scaled(field, hewn_sin(field, scaled(field, hewn_x(field), 8 + seed)), 0.1);
    return hewn_max(field, hewn_sphere(field, 0.9), hewn_add(field, hewn_y(field), wave));
}

static double value_at(const hewn_field *field, const double p[3])
{
    double value;
    assert_int_equal(hewn_field_eval(field, hewn_field_root(field), p, 1, &value, NULL), HEWN_OK);
    return value;
}

static void random_direction(double out[3])
{
    double length = 0;
    while (!(length > 0.1 && length < 1)) {
        length = 0;
        for (int axis = 0; axis < 3; axis++) {
            out[axis] = uniform();
            length += out[axis] * out[axis];
        }
    }
    for (int axis = 0; axis < 3; axis++)
        out[axis] /= sqrt(length);
}

static bool holds(const double p[3])
{
    return fabs(p[0]) < box.hi[0] && fabs(p[1]) < box.hi[1] && fabs(p[2]) < box.hi[2];
}

/* The field's signs are the same all over a ball, as far as the box goes. */
static void check_free(const hewn_field *field, const double middle[3], double radius, bool inside)
{
    for (int i = 0; i < SAMPLES && radius > 0; i++) {
        double p[3], share = radius * cbrt(0.5 + 0.5 * uniform());
        random_direction(p);
        for (int axis = 0; axis < 3; axis++)
            p[axis] = middle[axis] + share * p[axis];
        if (holds(p) && (value_at(field, p) <= -1e-5) != inside && fabs(value_at(field, p)) > 1e-5)
            fail_msg("%g from %g, %g, %g the field is %g", share, middle[0], middle[1], middle[2], value_at(field, p));
    }
}

/* Within a few thousandths of the tolerance of a point the field changes its sign. */
static void check_surface(const hewn_field *field, const double p[3])
{
    bool inside = false, outside = false;
    for (int i = 0; i < 200 && !(inside && outside); i++) {
        double q[3];
        random_direction(q);
        for (int axis = 0; axis < 3; axis++)
            q[axis] = p[axis] + (i == 0 ? 0 : 2e-5) * q[axis];
        *(value_at(field, q) <= 0 ? &inside : &outside) = true;
    }
    assert_true(inside && outside);
}

static double apart(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void check_nearest(const hewn_field *field, const double *p, const hewn_answer *answer)
{
    assert_true(answer->found && answer->complete && answer->high - answer->low < 1.1 * TOLERANCE);
    assert_true(fabs(apart(p, answer->point) - answer->high) < 2e-5);
    check_surface(field, answer->point);
    if (holds(p)) {
        assert_int_equal(answer->inside, value_at(field, p) <= 0);
        check_free(field, p, answer->low - 1e-5, answer->inside);
    }
}

static void check_ray(const hewn_field *field, const hewn_ray_desc *ray, const hewn_answer *answer)
{
    double length = apart(ray->along, (const double[3]){0, 0, 0}), p[3];
    double free = fmin(answer->low, 8) - 1e-5;
    for (int i = 0; i < SAMPLES; i++) {
        for (int axis = 0; axis < 3; axis++)
            p[axis] = ray->from[axis] + free * i / SAMPLES * ray->along[axis] / length;
        if (answer->inside)
            assert_true(answer->high == 0);
        else if (ray->radius == 0 && holds(p))
            assert_true(value_at(field, p) > -1e-5);
        else if (i % 20 == 0)
            check_free(field, p, ray->radius - 1e-5, false);
    }
    if (!answer->found || answer->inside)
        return;
    check_surface(field, answer->point);
    for (int axis = 0; axis < 3; axis++)
        p[axis] = ray->from[axis] + answer->high * ray->along[axis] / length;
    assert_true(apart(p, answer->point) < ray->radius + 2e-5);
}

static void check_field(maker *make, uint32_t seed)
{
    static double points[COUNT][3];
    static hewn_ray_desc rays[COUNT];
    static hewn_answer nearest[2][COUNT], met[2][COUNT];
    hewn_field *field;
    const hewn_query_desc desc = {.tolerance = TOLERANCE};
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    GPU_TEST_TRY(hewn_field_set_root(field, make(field, seed), &error));
    for (int i = 0; i < COUNT; i++) {
        rays[i] = (hewn_ray_desc){.radius = i % 3 ? 0.02 * (i % 5) : 0};
        for (int axis = 0; axis < 3; axis++) {
            points[i][axis] = (i % 4 ? 1.2 : 2.5) * uniform();
            rays[i].from[axis] = 2 * uniform();
            rays[i].along[axis] = 0.6 * uniform() - rays[i].from[axis];
        }
    }
    int hits = 0;
    for (int host = 0; host < 2; host++) {
        hewn_query *query;
        GPU_TEST_TRY(hewn_query_create(host ? NULL : device, field, hewn_field_root(field), &box, &query, &error));
        assert_int_equal(hewn_query_is_on_host(query), host);
        GPU_TEST_TRY(hewn_query_nearest(query, points[0], COUNT, &desc, nearest[host], &error));
        GPU_TEST_TRY(hewn_query_rays(query, rays, COUNT, &desc, met[host], &error));
        print_message("# field %u, %s\n", seed, host ? "host" : "device");
        for (int i = 0; i < COUNT; i++) {
            check_nearest(field, points[i], &nearest[host][i]);
            check_ray(field, &rays[i], &met[host][i]);
            hits += met[host][i].found;
        }
        hewn_query_destroy(&query);
    }
    assert_true(hits > COUNT / 2);
    for (int i = 0; i < COUNT; i++) {
        assert_true(fmax(nearest[0][i].low, nearest[1][i].low) < fmin(nearest[0][i].high, nearest[1][i].high) + 2e-5);
        assert_true(fmax(met[0][i].low, met[1][i].low) <= fmin(met[0][i].high, met[1][i].high) + 2e-5);
        assert_int_equal(nearest[0][i].inside, nearest[1][i].inside);
    }
    hewn_field_destroy(&field);
}

static void test_trees(void **state)
{
    (void)state;
    check_field(make_tree, 1);
    check_field(make_tree, 2);
}

static void test_without_slopes(void **state)
{
    (void)state;
    check_field(make_twist, 1);
    check_field(make_waves_in_ball, 1);
}

static hewn_node squares(hewn_field *field)
{
    hewn_node sum = hewn_add(field, hewn_square(field, hewn_x(field)), hewn_square(field, hewn_y(field)));
    return hewn_sub(field, hewn_add(field, sum, hewn_square(field, hewn_z(field))), hewn_constant(field, 0.81));
}

/* Far from the box slopes are not bounded, and what is known of them near it proves nothing. */
static void test_far_points(void **state)
{
    (void)state;
    enum { FAR = 32 };
    hewn_field *field;
    hewn_query *query;
    hewn_answer answers[FAR], met[FAR];
    hewn_ray_desc rays[FAR];
    double points[FAR][3], expected[FAR];
    const double diagonal = apart(box.lo, box.hi), away[4] = {20, 60, 1000, 25000};
    const hewn_query_desc desc = {.tolerance = TOLERANCE, .most_boxes = 2000};
    for (int i = 0; i < FAR; i++) {
        random_direction(points[i]);
        for (int axis = 0; axis < 3; axis++) {
            points[i][axis] *= away[i % 4] * diagonal;
            rays[i].along[axis] = -points[i][axis];
            rays[i].from[axis] = points[i][axis];
        }
        rays[i].begin = rays[i].end = rays[i].radius = 0;
        expected[i] = away[i % 4] * diagonal - 0.9;
    }
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    hewn_node root = squares(field);
    for (int host = 0; host < 2; host++) {
        GPU_TEST_TRY(hewn_query_create(host ? NULL : device, field, root, &box, &query, &error));
        GPU_TEST_TRY(hewn_query_nearest(query, points[0], FAR, &desc, answers, &error));
        GPU_TEST_TRY(hewn_query_rays(query, rays, FAR, &desc, met, &error));
        for (int i = 0; i < FAR; i++) {
            const hewn_answer *both[2] = {&answers[i], &met[i]};
            double doubt = 1e-6 * expected[i]; /* single precision, so far out */
            for (int k = 0; k < 2; k++)
                if (!both[k]->found || both[k]->low > expected[i] + doubt || both[k]->high < expected[i] - doubt ||
                    both[k]->high > expected[i] + 10 * doubt + TOLERANCE)
                    fail_msg("%s, %s %d: %.9g to %.9g instead of %.9g", host ? "host" : "device", k ? "ray" : "point",
                             i, both[k]->low, both[k]->high, expected[i]);
        }
        hewn_query_destroy(&query);
    }
    hewn_field_destroy(&field);
}

/* What the device cannot finish in the steps that it has is finished by the host: the middle of a ball without slope.
 */
static void test_many_alike(void **state)
{
    (void)state;
    hewn_field *field;
    hewn_query *query;
    const hewn_query_desc desc = {.tolerance = 0.02};
    const double middle[6] = {0, 0, 0, 0.3, 0, 0};
    hewn_answer answers[2];
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    hewn_node root = squares(field);
    GPU_TEST_TRY(hewn_query_create(device, field, root, &box, &query, &error));
    GPU_TEST_TRY(hewn_query_nearest(query, middle, 2, &desc, answers, &error));
    assert_true(answers[0].complete && answers[0].low <= 0.9 && fabs(answers[0].high - 0.9) < 0.02);
    assert_true(answers[1].complete && answers[1].low <= 0.6 && fabs(answers[1].high - 0.6) < 0.02);
    hewn_query_destroy(&query);
    hewn_field_destroy(&field);
}

typedef struct watch {
    int calls, most;
    double fraction;
} watch;

static bool watch_progress(void *user, const char *stage, double fraction)
{
    watch *own = user;
    assert_string_equal(stage, "query");
    assert_true(fraction >= own->fraction && fraction < 1);
    own->fraction = fraction;
    return ++own->calls <= own->most;
}

/* That takes long: the caller hears of it, may stop it, and gets what the host would have answered. */
static void test_many_left_to_the_host(void **state)
{
    (void)state;
    enum { QUESTIONS = 60 };
    double points[QUESTIONS][3] = {{0}};
    hewn_answer answers[2][QUESTIONS];
    hewn_field *field;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    hewn_node root = squares(field);
    for (int i = 0; i < QUESTIONS; i++)
        points[i][0] = 1e-4 * uniform();
    for (int host = 0; host < 2; host++) {
        watch seen = {.most = 1000};
        const hewn_progress progress = {watch_progress, &seen};
        const hewn_query_desc desc = {.tolerance = 1e-4, .most_boxes = 1000, .progress = &progress};
        hewn_query *query;
        GPU_TEST_TRY(hewn_query_create(host ? NULL : device, field, root, &box, &query, &error));
        GPU_TEST_TRY(hewn_query_nearest(query, points[0], QUESTIONS, &desc, answers[host], &error));
        assert_true(host || seen.calls >= 3);
        if (!host) {
            seen = (watch){.most = 2};
            assert_int_equal(hewn_query_nearest(query, points[0], QUESTIONS, &desc, answers[host], NULL),
                             HEWN_CANCELLED);
            assert_int_equal(seen.calls, 3);
            assert_false(answers[host][0].found);
            seen = (watch){.most = 1000};
            GPU_TEST_TRY(hewn_query_nearest(query, points[0], QUESTIONS, &desc, answers[host], &error));
        }
        hewn_query_destroy(&query);
    }
    for (int i = 0; i < QUESTIONS; i++) {
        const hewn_answer *a = &answers[0][i], *b = &answers[1][i];
        assert_true(a->found && a->inside && !a->complete);
        assert_true(a->low == b->low && a->high == b->high);
        assert_memory_equal(a->point, b->point, sizeof a->point);
        assert_memory_equal(a->normal, b->normal, sizeof a->normal);
    }
    hewn_field_destroy(&field);
}

/* Two specks, the nearer one too small to be met by chance: values around them are flat, so that places are found only
 * from near by, and prove little. */
static hewn_node specks(hewn_field *field, double at[2][3], const double size[2])
{
    hewn_node all = hewn_constant(field, 0.5), axes[3] = {hewn_x(field), hewn_y(field), hewn_z(field)};
    for (int i = 0; i < 2; i++) {
        hewn_node sum = hewn_constant(field, 0);
        for (int axis = 0; axis < 3; axis++)
            sum = hewn_add(field, sum,
                           hewn_square(field, hewn_sub(field, axes[axis], hewn_constant(field, at[i][axis]))));
        all = hewn_sub(field, all, hewn_exp(field, scaled(field, sum, -1 / (size[i] * size[i]))));
    }
    return all;
}

static void check_specks(double at[2][3], const double size[2], bool nearest, double radius)
{
    const double from[3] = {1.2, 1.1, 1.25};
    const hewn_query_desc desc = {.tolerance = 0.6};
    hewn_ray_desc ray = {.radius = radius};
    hewn_field *field;
    hewn_query *query;
    hewn_answer answer;
    for (int axis = 0; axis < 3; axis++) {
        ray.from[axis] = from[axis];
        ray.along[axis] = at[0][axis] - from[axis];
    }
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    hewn_node root = specks(field, at, size);
    GPU_TEST_TRY(hewn_query_create(device, field, root, &box, &query, &error));
    if (nearest)
        GPU_TEST_TRY(hewn_query_nearest(query, from, 1, &desc, &answer, &error));
    else
        GPU_TEST_TRY(hewn_query_rays(query, &ray, 1, &desc, &answer, &error));
    double inside = apart(from, at[0]) - radius;
    if (!(answer.low < inside) || (answer.found && answer.high - answer.low > 0.61))
        fail_msg("%s from %g to %g, but %g is inside",
                 nearest      ? "point"
                 : radius > 0 ? "ball"
                              : "ray",
                 answer.low, answer.high, inside);
    hewn_query_destroy(&query);
    hewn_field_destroy(&field);
}

/* What is found in a box as small as the tolerance allows does not deny what is nearer there. Such a box in the corner
 * that is looked at last. */
static void test_low_is_proven_in_the_smallest_boxes(void **state)
{
    (void)state;
    const double cell = 2.6 / 32, wide[2] = {0.002, 0.022}, narrow[2] = {0.001, 0.007};
    for (int i = 0; i < 8; i++) {
        double at[2][3];
        for (int axis = 0; axis < 3; axis++) {
            at[1][axis] = -1.3 + 0.5 * cell + 0.012 * uniform();
            at[0][axis] = at[1][axis] + 0.019;
        }
        check_specks(at, narrow, false, 0);
        check_specks(at, wide, false, 0.05);
        check_specks(at, wide, true, 0);
    }
}

/* Large fields are for the host, also where there is a device. */
static void test_large_fields(void **state)
{
    (void)state;
    hewn_field *field;
    hewn_query *query;
    hewn_answer answer;
    const double p[3] = {1.2, 1.2, 1.2};
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    hewn_node all = hewn_sphere(field, 0.1);
    for (int i = 0; i < 400; i++) {
        double x = uniform(), y = uniform(), z = uniform();
        all = hewn_union(field, all, hewn_translate(field, hewn_sphere(field, 0.05), x, y, z));
    }
    GPU_TEST_TRY(hewn_query_create(device, field, all, &box, &query, &error));
    assert_true(hewn_query_is_on_host(query));
    GPU_TEST_TRY(hewn_query_nearest(query, p, 1, NULL, &answer, &error));
    double expected;
    assert_int_equal(hewn_field_eval(field, all, p, 1, &expected, NULL), HEWN_OK);
    assert_true(answer.low < expected + 1e-5 && answer.high > expected - 1e-5 && answer.complete);
    hewn_query_destroy(&query);
    hewn_field_destroy(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_trees),        cmocka_unit_test(test_without_slopes),
        cmocka_unit_test(test_far_points),   cmocka_unit_test(test_low_is_proven_in_the_smallest_boxes),
        cmocka_unit_test(test_many_alike),   cmocka_unit_test(test_many_left_to_the_host),
        cmocka_unit_test(test_large_fields),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
