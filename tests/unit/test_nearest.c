/* Nearest triangles: of fans, four at a time, and by hierarchies over any order, against looking at all of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/alloc.h"
#include "geom/nearest.h"
#include "simplify/fan.h"

static double number(void)
{
    return 2 * drand48() - 1;
}

static void place(double out[3], double size)
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = size * number();
}

/* Every eighth triangle has no area. */
static void corners(uint32_t i, double p[3], double q[3])
{
    place(p, 1);
    place(q, 1);
    for (int axis = 0; axis < 3 && i % 8 == 7; axis++)
        q[axis] = i % 16 == 7 ? -2 * p[axis] : 0;
}

static void test_fan(void **state)
{
    (void)state;
    srand48(3);
    simplify_fan fan = {0};
    for (uint32_t round = 0; round < 400; round++) {
        const double origin[3] = {0};
        double p[32][3], q[32][3];
        simplify_fan_point points[9];
        fan.count = 0;
        const uint32_t count = 1 + round % 32;
        for (uint32_t i = 0; i < count; i++) {
            corners(i + round, p[i], q[i]);
            assert_int_equal(hewn_simplify_fan_add(&fan, 100 + i, p[i], q[i]), HEWN_OK);
        }
        assert_int_equal(hewn_simplify_fan_settle(&fan), HEWN_OK);
        for (int i = 0; i < 9; i++) {
            place(points[i].at, i < 6 ? 1.5 : 0.1);
            points[i].near = SIMPLIFY_NOWHERE;
        }
        hewn_simplify_fan_nearest(&fan, points, 9);
        for (int i = 0; i < 9; i++) {
            double least = INFINITY;
            for (uint32_t f = 0; f < count; f++)
                least = fmin(least, hewn_triangle_reach(points[i].at, origin, p[f], q[f]));
            assert_true(points[i].near < count);
            const uint32_t near = points[i].near;
            assert_int_equal(fan.blocks[near / SIMPLIFY_FOUR].face[near % SIMPLIFY_FOUR], 100 + near);
            assert_true(fabs(sqrt(points[i].square) - least) < 1e-7 * (1 + least));
            assert_true(fabs(hewn_triangle_reach(points[i].at, origin, p[near], q[near]) - least) < 1e-7 * (1 + least));
        }
    }
    hewn_simplify_fan_release(&fan);
}

static void test_marks(void **state)
{
    (void)state;
    srand48(4);
    simplify_fan_point points[50];
    simplify_mark_block marks[3];
    for (int i = 0; i < 50; i++)
        place(points[i].at, 1);
    for (int m = 0; m < 12; m++)
        for (int axis = 0; axis < 3; axis++)
            marks[m / 4].at[axis][m % 4] = number();
    hewn_simplify_find_marks(points, 50, marks, 3);
    for (int m = 0; m < 12; m++) {
        double least = INFINITY;
        for (int i = 0; i < 50; i++) {
            double square = 0;
            for (int axis = 0; axis < 3; axis++)
                square += pow(marks[m / 4].at[axis][m % 4] - points[i].at[axis], 2);
            if (square < least) {
                least = square;
                assert_true(marks[m / 4].nearest[m % 4] >= i);
            }
        }
        assert_true(fabs(marks[m / 4].square[m % 4] - least) < 1e-14);
    }
}

/* A soup of small triangles: the same distances whatever the order is that boxes are made of. */
static void test_hierarchies(void **state)
{
    (void)state;
    srand48(5);
    enum { COUNT = 1001 };
    static double positions[9 * COUNT];
    static uint32_t soup[3 * COUNT];
    uint32_t *order = hewn_alloc(COUNT + 3, sizeof *order);
    assert_non_null(order);
    for (uint32_t t = 0; t < COUNT; t++) {
        double at[3];
        place(at, 1);
        for (uint32_t i = 0; i < 9; i++)
            positions[9 * t + i] = at[i % 3] + 0.05 * number();
        for (uint32_t k = 0; k < 3; k++)
            soup[3 * t + k] = 3 * t + k;
        order[t] = t * 389 % COUNT;
    }
    const hewn_triangle_view mesh = {3 * COUNT, COUNT, positions, NULL, soup};
    hewn_bvh one, two;
    hewn_error error;
    assert_int_equal(hewn_bvh_build(&mesh, &one, &error), HEWN_OK);
    assert_int_equal(hewn_bvh_build_along(&mesh, order, &two, &error), HEWN_OK);
    for (int i = 0; i < 300; i++) {
        double at[3], least = INFINITY, a, b;
        place(at, 1.2);
        for (uint32_t t = 0; t < COUNT; t++)
            least = fmin(least, hewn_view_reach(&mesh, t, at));
        const uint32_t guess = (uint32_t)i * 7 % COUNT;
        const uint32_t first = hewn_bvh_nearest(&one, &mesh, at, guess, &a);
        const uint32_t second = hewn_bvh_nearest(&two, &mesh, at, guess, &b);
        assert_true(a <= least && a >= least && b <= least && b >= least);
        assert_true(hewn_view_reach(&mesh, first, at) <= least && hewn_view_reach(&mesh, second, at) <= least);
    }
    hewn_bvh_free(&one);
    hewn_bvh_free(&two);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fan), cmocka_unit_test(test_marks),
                                       cmocka_unit_test(test_hierarchies)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
