/* Questions on the host: analytic answers, clearance, and what is refused. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "hewn/query.h"

static const hewn_box box = {{-2, -2, -2}, {2, 2, 2}};

static double uniform(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 33) / (double)(1u << 30) - 1;
}

static double length(const double *v)
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static hewn_query *query_of(hewn_node (*make)(hewn_field *field), const hewn_box *where)
{
    hewn_field *field;
    hewn_query *query;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    hewn_node root = make(field);
    assert_int_equal(hewn_query_create(NULL, field, root, where, &query, NULL), HEWN_OK);
    assert_true(hewn_query_is_on_host(query));
    hewn_field_destroy(&field);
    return query;
}

/* Shapes of which the true distance is known, and how fields that are no distances have the same surface. */
static hewn_node ball(hewn_field *field)
{
    return hewn_sphere(field, 1);
}

/* Steep near the middle, flat outside, nowhere a distance. */
static hewn_node squared_ball(hewn_field *field)
{
    hewn_node sum = hewn_add(field, hewn_square(field, hewn_x(field)), hewn_square(field, hewn_y(field)));
    sum = hewn_add(field, sum, hewn_square(field, hewn_z(field)));
    return hewn_ln(field, hewn_add(field, hewn_constant(field, 1e-6), sum));
}

static hewn_node cube(hewn_field *field)
{
    return hewn_box_shape(field, 2, 2, 2);
}

/* The same cube as a greatest coordinate: no distance past edges, and its cube makes slopes vary. */
static hewn_node greatest(hewn_field *field)
{
    hewn_node x = hewn_abs(field, hewn_x(field)), y = hewn_abs(field, hewn_y(field)),
              z = hewn_abs(field, hewn_z(field));
    hewn_node most = hewn_max(field, hewn_max(field, x, y), z);
    return hewn_sub(field, hewn_mul(field, most, hewn_square(field, most)), hewn_constant(field, 1));
}

static hewn_node ring(hewn_field *field)
{
    return hewn_torus(field, 1, 0.3);
}

static double ball_distance(const double *p)
{
    return length(p) - 1;
}

static double cube_distance(const double *p)
{
    double most = -INFINITY, out[3];
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = fmax(fabs(p[axis]) - 1, 0);
        most = fmax(most, fabs(p[axis]) - 1);
    }
    return length(out) + fmin(most, 0);
}

static double ring_distance(const double *p)
{
    double aside = sqrt(p[0] * p[0] + p[2] * p[2]) - 1;
    return sqrt(aside * aside + p[1] * p[1]) - 0.3;
}

static const struct {
    const char *name;
    hewn_node (*make)(hewn_field *field);
    double (*distance)(const double *p);
} shapes[] = {{"ball", ball, ball_distance},
              {"squared ball", squared_ball, ball_distance},
              {"cube", cube, cube_distance},
              {"greatest", greatest, cube_distance},
              {"ring", ring, ring_distance}};

enum { SHAPES = sizeof shapes / sizeof *shapes, POINTS = 200 };

/* In the box and around it. */
static void test_nearest(void **state)
{
    (void)state;
    static double points[POINTS][3];
    static hewn_answer answers[POINTS];
    uint64_t random = 5;
    const hewn_query_desc desc = {.tolerance = 1e-3};
    for (int k = 0; k < SHAPES; k++) {
        hewn_query *query = query_of(shapes[k].make, &box);
        for (int i = 0; i < POINTS; i++)
            for (int axis = 0; axis < 3; axis++)
                points[i][axis] = (i % 4 == 0 ? 6 : 2) * uniform(&random);
        assert_int_equal(hewn_query_nearest(query, points[0], POINTS, &desc, answers, NULL), HEWN_OK);
        for (int i = 0; i < POINTS; i++) {
            double expected = shapes[k].distance(points[i]), away[3];
            const hewn_answer *at = &answers[i];
            for (int axis = 0; axis < 3; axis++)
                away[axis] = at->point[axis] - points[i][axis];
            bool good = at->found && at->complete && at->low <= fabs(expected) + 1e-5 &&
                        at->high >= fabs(expected) - 1e-5 && at->high - at->low < 1.1e-3 &&
                        fabs(length(away) - at->high) < 2e-5 && fabs(shapes[k].distance(at->point)) < 2e-5;
            if (!good)
                fail_msg("%s, point %d (%g, %g, %g): %g to %g instead of %g", shapes[k].name, i, points[i][0],
                         points[i][1], points[i][2], at->low, at->high, expected);
            bool in_box = fmax(fmax(fabs(points[i][0]), fabs(points[i][1])), fabs(points[i][2])) < 2;
            assert_int_equal(at->inside, in_box && expected <= 0);
        }
        hewn_query_destroy(&query);
        assert_null(query);
    }
}

/* Where a ray with a ball meets the unit ball, or -1. */
static double meet(const hewn_ray_desc *ray)
{
    double size = length(ray->along), along = 0, square = 0, radius = 1 + ray->radius;
    for (int axis = 0; axis < 3; axis++) {
        along -= ray->from[axis] * ray->along[axis] / size;
        square += ray->from[axis] * ray->from[axis];
    }
    double half = radius * radius - (square - along * along);
    if (half < 0 || along + sqrt(half) < 0)
        return -1;
    return fmax(along - sqrt(half), 0);
}

static void test_rays(void **state)
{
    (void)state;
    static hewn_ray_desc rays[POINTS];
    static hewn_answer answers[POINTS];
    uint64_t random = 9;
    for (int k = 0; k < 2; k++) {
        hewn_query *query = query_of(shapes[k].make, &box);
        int hits = 0;
        for (int i = 0; i < POINTS; i++) {
            rays[i] = (hewn_ray_desc){.radius = i % 2 ? 0.02 + 0.3 * fabs(uniform(&random)) : 0};
            for (int axis = 0; axis < 3; axis++) {
                rays[i].from[axis] = 3 * uniform(&random);
                rays[i].along[axis] = uniform(&random) - 0.5 * rays[i].from[axis];
            }
        }
        const hewn_query_desc desc = {.tolerance = 1e-3};
        assert_int_equal(hewn_query_rays(query, rays, POINTS, &desc, answers, NULL), HEWN_OK);
        for (int i = 0; i < POINTS; i++) {
            double expected = meet(&rays[i]);
            const hewn_answer *at = &answers[i];
            hits += at->found;
            bool inside = length(rays[i].from) < 1;
            assert_int_equal(at->inside, inside);
            if (inside)
                assert_true(at->found && at->high == 0);
            else if (expected < 0)
                assert_true(!at->found || at->high > at->low); /* grazing: not decided */
            else if (!at->found || at->low > expected + 1e-5 || at->high < expected - 1e-5)
                fail_msg("%s, ray %d: %g to %g instead of %g", shapes[k].name, i, at->low, at->high, expected);
            if (at->found && at->complete)
                assert_true(at->high - at->low < 1.1e-3 || inside);
        }
        assert_true(hits > POINTS / 4);
        hewn_query_destroy(&query);
    }
}

/* Begin and end bound the way. */
static void test_parts_of_rays(void **state)
{
    (void)state;
    hewn_query *query = query_of(ball, &box);
    const hewn_ray_desc rays[] = {{.from = {-3, 0, 0}, .along = {2, 0, 0}, .end = 1.9},
                                  {.from = {-3, 0, 0}, .along = {2, 0, 0}, .end = 2.1},
                                  {.from = {-3, 0, 0}, .along = {1, 0, 0}, .begin = 2.5},
                                  {.from = {-3, 0, 0}, .along = {1, 0, 0}, .begin = 4.5},
                                  {.from = {-3, 0, 0}, .along = {1, 0, 0}, .begin = 1.5, .radius = 0.75}};
    hewn_answer answers[5];
    assert_int_equal(hewn_query_rays(query, rays, 5, NULL, answers, NULL), HEWN_OK);
    assert_false(answers[0].found);
    assert_true(isinf(answers[0].low) && isinf(answers[0].high));
    assert_true(answers[1].found && fabs(answers[1].high - 2) < 1e-4 && answers[1].normal[0] < -0.999);
    assert_true(answers[2].found && answers[2].inside && answers[2].high == 2.5);
    assert_false(answers[3].found);
    assert_true(answers[4].found && fabs(answers[4].high - 1.5) < 1e-6);
    hewn_query_destroy(&query);
}

/* Nothing there, a thread thinner than the tolerance, and the middle of a ball of which no slope is known. */
static hewn_node nothing(hewn_field *field)
{
    return hewn_add(field, hewn_square(field, hewn_x(field)), hewn_constant(field, 1));
}

static hewn_node touching(hewn_field *field)
{
    return hewn_square(field, hewn_x(field)); /* 0 on a plane, nowhere below */
}

static void test_hard_cases(void **state)
{
    (void)state;
    const double middle[3] = {0, 0, 0}, aside[3] = {1, 0.1, 0.2};
    hewn_answer answer;
    hewn_query *query = query_of(nothing, &box);
    assert_int_equal(hewn_query_nearest(query, middle, 1, NULL, &answer, NULL), HEWN_OK);
    assert_true(!answer.found && answer.complete && isinf(answer.low) && isinf(answer.high));
    hewn_query_destroy(&query);

    query = query_of(touching, &box);
    const hewn_query_desc coarse = {.tolerance = 0.05, .most_boxes = 3000};
    assert_int_equal(hewn_query_nearest(query, aside, 1, &coarse, &answer, NULL), HEWN_OK);
    assert_true(!answer.found && !answer.complete && answer.low <= 1 && answer.low > 0.8);
    hewn_query_destroy(&query);

    query = query_of(squared_ball, &box);
    const hewn_query_desc few = {.tolerance = 1e-5, .most_boxes = 2000};
    assert_int_equal(hewn_query_nearest(query, middle, 1, &few, &answer, NULL), HEWN_OK);
    assert_true(answer.found && !answer.complete && answer.inside && answer.low <= 1 && answer.low > 0.9);
    assert_true(fabs(answer.high - 1) < 1e-4);
    hewn_query_destroy(&query);
}

/* --- clearance ------------------------------------------------------------------------------------------------------
 */

static hewn_node moved_ball(hewn_field *field)
{
    return hewn_translate(field, hewn_sphere(field, 0.5), 1.4, 1.1, 0.3);
}

static hewn_node moved_log(hewn_field *field)
{
    return hewn_translate(field, hewn_scale(field, squared_ball(field), 0.5), 1.4, 1.1, 0.3);
}

static hewn_node tiny(hewn_field *field)
{
    return hewn_sphere(field, 0.01);
}

static hewn_node turned_cube(hewn_field *field)
{
    hewn_node one = hewn_rotate(field, hewn_box_shape(field, 1, 1, 1), 0, 0, 1, M_PI / 4);
    return hewn_translate(field, one, 1 + sqrt(0.5) + 0.25, 0.2, 0.1);
}

static hewn_clearance clearance_of(hewn_node (*one)(hewn_field *field), hewn_node (*other)(hewn_field *field),
                                   double tolerance)
{
    const hewn_query_desc desc = {.tolerance = tolerance};
    const hewn_box wide = {{-3, -3, -3}, {3, 3, 3}};
    hewn_query *a = query_of(one, &box), *b = query_of(other, &wide);
    hewn_clearance out, back;
    assert_int_equal(hewn_query_clearance(a, b, &desc, &out, NULL), HEWN_OK);
    assert_int_equal(hewn_query_clearance(b, a, &desc, &back, NULL), HEWN_OK);
    assert_true(out.found == back.found && out.overlap == back.overlap);
    assert_true(!out.found || fabs(out.high - back.high) < fmax(0.02, tolerance));
    if (out.overlap)
        assert_memory_equal(out.points[0], out.points[1], sizeof out.points[0]);
    double apart[3];
    for (int axis = 0; axis < 3; axis++)
        apart[axis] = out.points[0][axis] - out.points[1][axis];
    assert_true(!out.found || fabs(length(apart) - out.high) < 1e-5);
    hewn_query_destroy(&a);
    hewn_query_destroy(&b);
    return out;
}

static void check_clearance(hewn_clearance out, double expected)
{
    if (!out.found || !out.complete || out.low > expected + 1e-5 || out.high < expected - 1e-5)
        fail_msg("%g to %g instead of %g (%scomplete)", out.low, out.high, expected, out.complete ? "" : "not ");
}

static void test_clearance(void **state)
{
    (void)state;
    const double middles = sqrt(1.4 * 1.4 + 1.1 * 1.1 + 0.3 * 0.3);
    check_clearance(clearance_of(ball, moved_ball, 0), middles - 1.5);
    check_clearance(clearance_of(squared_ball, moved_ball, 0), middles - 1.5);
    check_clearance(clearance_of(squared_ball, moved_log, 0.05), middles - 1.5); /* no slope is known of either */
    check_clearance(clearance_of(cube, turned_cube, 0), 0.25);
    check_clearance(clearance_of(ring, tiny, 0.05), 0.7 - 0.01); /* all of the ring is as near */
}

/* A direction's length says nothing, however large or small it is. */
static void test_lengths_of_directions(void **state)
{
    (void)state;
    hewn_query *query = query_of(cube, &box);
    const double lengths[] = {1e-320, 1e-200, 1e-30, 1e30, 1e160, 1e308};
    hewn_answer expected, answer;
    hewn_ray_desc ray = {.from = {-1.7, 0.2, 0.1}, .along = {1, -0.25, 0.5}};
    assert_int_equal(hewn_query_rays(query, &ray, 1, NULL, &expected, NULL), HEWN_OK);
    assert_true(expected.found && fabs(expected.high - 0.7 * sqrt(1.3125)) < 1e-3);
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        ray = (hewn_ray_desc){.from = {-1.7, 0.2, 0.1}, .along = {lengths[i], -0.25 * lengths[i], 0.5 * lengths[i]}};
        assert_int_equal(hewn_query_rays(query, &ray, 1, NULL, &answer, NULL), HEWN_OK);
        assert_true(answer.found && fabs(answer.high - expected.high) < 1e-3);
    }
    hewn_query_destroy(&query);
}

static hewn_node two_balls(hewn_field *field)
{
    hewn_node large = hewn_translate(field, hewn_sphere(field, 0.4), 1.2, 0.1, 0);
    return hewn_union(field, large, hewn_translate(field, hewn_sphere(field, 0.1), -0.3, 1.2, 0.2));
}

static hewn_node left_ball(hewn_field *field)
{
    return hewn_translate(field, hewn_sphere(field, 0.3), -1.3, 0.5, 0.2);
}

/* With a tolerance larger than the boxes the first place that is found is an answer, but `low` stays proven. */
static void test_coarse_clearance(void **state)
{
    (void)state;
    const double expected = sqrt(1 + 0.7 * 0.7) - 0.4, tolerances[] = {0.01, 0.5, 2, 20, 100};
    for (int i = 0; i < 5; i++)
        check_clearance(clearance_of(two_balls, left_ball, tolerances[i]), expected);
}

static hewn_node inner_ball(hewn_field *field)
{
    return hewn_translate(field, hewn_sphere(field, 0.1), 0.2, 0.3, 0.1);
}

/* One that is all inside of the other shares no surface with it, but overlaps. */
static void test_overlap(void **state)
{
    (void)state;
    hewn_clearance out = clearance_of(ball, inner_ball, 0);
    assert_true(out.overlap && out.low == 0 && out.high == 0 && out.complete);
    assert_true(length(out.points[0]) < 0.6);
    out = clearance_of(cube, ball, 0);
    assert_true(out.overlap && out.complete);
    out = clearance_of(ball, nothing, 0);
    assert_true(!out.found && !out.overlap && isinf(out.high) && out.complete);
}

/* --- the rest -------------------------------------------------------------------------------------------------------
 */

static void test_refusals(void **state)
{
    (void)state;
    hewn_error error;
    hewn_query *query = query_of(ball, &box);
    hewn_answer answers[2];
    const double bad[6] = {0, 0, 0, NAN, 0, 0};
    memset(answers, 1, sizeof answers);
    assert_int_equal(hewn_query_nearest(query, bad, 2, NULL, answers, &error), HEWN_INVALID_ARGUMENT);
    assert_non_null(strstr(error.message, "point 1"));
    assert_false(answers[0].found);
    const hewn_query_desc nonsense = {.tolerance = -1};
    assert_int_equal(hewn_query_nearest(query, bad, 1, &nonsense, answers, &error), HEWN_INVALID_ARGUMENT);
    const hewn_ray_desc rays[] = {{.from = {0, 0, 0}, .along = {0, 0, 0}},
                                  {.from = {INFINITY, 0, 0}, .along = {1, 0, 0}},
                                  {.along = {1, 0, 0}, .radius = -1},
                                  {.along = {1, 0, 0}, .begin = 2, .end = 1},
                                  {.along = {1, 0, 0}, .begin = -1},
                                  {.along = {NAN, 0, 0}},
                                  {.along = {1, NAN, 2}},
                                  {.along = {1, INFINITY, 0}},
                                  {.along = {1, 0, 0}, .begin = 0x1p31},
                                  {.along = {1, 0, 0}, .radius = 0x1p31},
                                  {.from = {0, -0x1p31, 0}, .along = {1, 0, 0}}};
    for (size_t i = 0; i < sizeof rays / sizeof *rays; i++)
        assert_int_equal(hewn_query_rays(query, &rays[i], 1, NULL, answers, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_query_nearest(query, bad, 0, NULL, answers, &error), HEWN_OK);
    hewn_query_destroy(&query);
    hewn_query_destroy(&query);

    hewn_field *field;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    hewn_node root = ball(field);
    const hewn_box flat = {{0, 0, 0}, {1, 0, 1}}, endless = {{0, 0, 0}, {INFINITY, 1, 1}};
    assert_int_equal(hewn_query_create(NULL, field, root, &flat, &query, &error), HEWN_INVALID_ARGUMENT);
    assert_null(query);
    assert_int_equal(hewn_query_create(NULL, field, root, &endless, &query, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_query_create(NULL, field, HEWN_NODE_NONE, &box, &query, &error), HEWN_INVALID_ARGUMENT);
    assert_null(query);
    hewn_field_destroy(&field);
}

static bool stop(void *user, const char *stage, double fraction)
{
    (void)fraction;
    assert_string_equal(stage, "query");
    ++*(int *)user;
    return false;
}

static void test_cancel(void **state)
{
    (void)state;
    int calls = 0;
    const double middle[3] = {0, 0, 0.5};
    hewn_query *query = query_of(ball, &box);
    const hewn_progress progress = {stop, &calls};
    const hewn_query_desc desc = {.progress = &progress};
    hewn_answer answer;
    hewn_clearance clearance;
    assert_int_equal(hewn_query_nearest(query, middle, 1, &desc, &answer, NULL), HEWN_CANCELLED);
    assert_int_equal(hewn_query_clearance(query, query, &desc, &clearance, NULL), HEWN_CANCELLED);
    assert_int_equal(calls, 2);
    hewn_query_destroy(&query);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nearest),          cmocka_unit_test(test_rays),
        cmocka_unit_test(test_parts_of_rays),    cmocka_unit_test(test_hard_cases),
        cmocka_unit_test(test_clearance),        cmocka_unit_test(test_lengths_of_directions),
        cmocka_unit_test(test_coarse_clearance), cmocka_unit_test(test_overlap),
        cmocka_unit_test(test_refusals),         cmocka_unit_test(test_cancel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
