/* Nearest triangles, and which way they face: of fans, four points at a time, and by hierarchies over any order,
 * against looking at all of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/alloc.h"
#include "geom/facing.h"
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

/* What is said to be within a distance of one triangle is found within it of all. */
static void test_within(void **state)
{
    (void)state;
    srand48(6);
    simplify_fan fan = {0};
    uint32_t said = 0;
    for (uint32_t round = 0; round < 2000; round++) {
        double p[3], q[3];
        const double origin[3] = {0};
        simplify_fan_point point = {.near = SIMPLIFY_NOWHERE};
        fan.count = 0;
        for (uint32_t i = 0; i < 6; i++) {
            corners(i + round, p, q);
            assert_int_equal(hewn_simplify_fan_add(&fan, i, p, q), HEWN_OK);
        }
        assert_int_equal(hewn_simplify_fan_settle(&fan), HEWN_OK);
        place(point.at, round % 2 == 0 ? 1 : 0.2);
        const double reach = hewn_triangle_reach(point.at, origin, p, q),
                     most = reach * reach * (0.9 + 0.2 * drand48());
        const bool within = hewn_simplify_fan_is_within(&fan, 5, point.at, most);
        if (within != (reach * reach <= most))
            assert_true((5 + round) % 8 == 7 && !within); /* of no area */
        hewn_simplify_fan_nearest(&fan, &point, 1);
        assert_true(!within || point.square <= most);
        said += within;
    }
    assert_true(said > 600);
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

static void normal(const double *a, double out[3])
{
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = a[3 + axis] - a[axis];
        v[axis] = a[6 + axis] - a[axis];
    }
    for (int axis = 0; axis < 3; axis++)
        out[axis] = u[(axis + 1) % 3] * v[(axis + 2) % 3] - u[(axis + 2) % 3] * v[(axis + 1) % 3];
}

/* Two bumpy sheets that face each other: what is told of a side is so, and mostly something is told. */
static void test_sides(void **state)
{
    (void)state;
    srand48(7);
    enum { ROW = 24, COUNT = 4 * ROW * ROW };
    static double positions[9 * COUNT];
    static uint32_t soup[3 * COUNT];
    for (uint32_t t = 0; t < COUNT; t++) {
        const uint32_t sheet = t / (2 * ROW * ROW), cell = t / 2 % (ROW * ROW), half = t % 2;
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t corner = sheet ? 2 - k : k;
            const uint32_t right = (corner == 1) != half, up = (corner == 2) != half;
            const double x = (cell % ROW + right) / (double)ROW, y = (cell / ROW + up) / (double)ROW;
            const double at[3] = {x, y, 0.1 * sheet + 0.02 * sin(17 * x) * cos(13 * y)};
            memcpy(positions + 9 * t + 3 * k, at, sizeof at);
            soup[3 * t + k] = 3 * t + k;
        }
    }
    const hewn_triangle_view mesh = {3 * COUNT, COUNT, positions, NULL, soup};
    hewn_bvh bvh;
    hewn_facing facing;
    hewn_error error;
    uint32_t told[2] = {0};
    assert_int_equal(hewn_bvh_build(&mesh, &bvh, &error), HEWN_OK);
    assert_int_equal(hewn_facing_build(&bvh, &mesh, &facing, &error), HEWN_OK);
    for (int i = 0; i < 2000; i++) {
        const double at[3] = {drand48(), drand48(), 0.3 * drand48() - 0.1}, up[3] = {0.2 * number(), 0.2 * number(), 1};
        uint32_t guess = (uint32_t)(lrand48() % COUNT);
        double n[3], distance, found;
        const uint32_t nearest = hewn_bvh_nearest(&bvh, &mesh, at, guess, &distance);
        guess = i % 2 == 0 ? guess : nearest;
        const hewn_side side = hewn_bvh_nearest_side(&bvh, &facing, &mesh, at, guess, up);
        normal(positions + 9 * nearest, n);
        const bool away = n[0] * up[0] + n[1] * up[1] + n[2] * up[2] < 0;
        assert_true(side == HEWN_SIDE_UNSURE || away == (side == HEWN_SIDE_AWAY));
        if (i % 2 == 1 && side != HEWN_SIDE_UNSURE)
            told[away]++;
        (void)hewn_bvh_nearest_within(&bvh, &mesh, at, guess, 2 * distance, &found);
        assert_true(found >= distance && found <= fmax(2 * distance, distance));
    }
    assert_true(told[0] > 200 && told[1] > 200 && told[0] + told[1] > 900);
    hewn_facing_free(&facing);
    hewn_bvh_free(&bvh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fan), cmocka_unit_test(test_within),
                                       cmocka_unit_test(test_marks), cmocka_unit_test(test_hierarchies),
                                       cmocka_unit_test(test_sides)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
