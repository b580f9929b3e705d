/* What earlier runs have shown: triangles are known again by their points alone, and what could have been shown by
 * triangles that are gone is not known any more. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../oracle/random_grid.h"
#include "geom/near_triangle.h"
#include "simplify/recall.h"

enum { COUNT = 300, OTHERS = 200 };

/* Small triangles in a cube of side 10. */
static void make_triangles(uint64_t seed, uint32_t count, double *points, uint32_t *corners)
{
    uint64_t random = seed;
    for (uint32_t t = 0; t < count; t++) {
        double at[3];
        for (int axis = 0; axis < 3; axis++)
            at[axis] = random_below(&random, 10000) * 1e-3;
        for (uint32_t k = 0; k < 3; k++) {
            corners[3 * t + k] = 3 * t + k;
            for (int axis = 0; axis < 3; axis++)
                points[3 * (3 * t + k) + (uint32_t)axis] = at[axis] + random_below(&random, 1000) * 5e-4;
        }
    }
}

/* No more than how far a triangle is from a point, from points of the other one. */
static double least_distance(const double *a, const double *b)
{
    double least = INFINITY;
    for (int i = 0; i <= 6; i++)
        for (int j = 0; i + j <= 6; j++) {
            double at[3];
            for (int axis = 0; axis < 3; axis++)
                at[axis] = (i * a[axis] + j * a[3 + axis] + (6 - i - j) * a[6 + axis]) / 6;
            least = fmin(least, hewn_triangle_distance_squared(at, b, b + 3, b + 6));
        }
    return sqrt(least);
}

static void test_known_again(void **state)
{
    (void)state;
    static double points[9 * COUNT], others[9 * OTHERS];
    static uint32_t corners[3 * COUNT], ends[3 * OTHERS], later[3 * COUNT];
    uint8_t far[COUNT], known[COUNT], near[OTHERS];
    for (uint64_t seed = 1; seed < 5; seed++) {
        simplify_recall recall = {0};
        uint64_t random = seed;
        uint32_t left = 0, gone = 0, lost = 0;
        make_triangles(seed, COUNT, points, corners);
        make_triangles(seed + 100, OTHERS, others, ends);
        const hewn_triangle_view all = {
            .vertex_count = 3 * COUNT, .triangle_count = COUNT, .doubles = points, .corners = corners};
        const hewn_triangle_view from = {
            .vertex_count = 3 * OTHERS, .triangle_count = OTHERS, .doubles = others, .corners = ends};
        for (int t = 0; t < COUNT; t++)
            far[t] = t % 3 == 0;
        hewn_simplify_recall(&recall, &all, known);
        for (int t = 0; t < COUNT; t++)
            assert_int_equal(known[t], 0); /* nothing is remembered yet */
        assert_int_equal(hewn_simplify_remember(&recall, &all, far, NULL), HEWN_OK);
        hewn_simplify_recall(&recall, &all, known);
        for (int t = 0; t < COUNT; t++)
            assert_int_equal(known[t], t % 3 != 0);
        /* Most are there still, backwards; a few have gone. */
        bool stays[COUNT];
        for (uint32_t t = COUNT; t-- > 0;) {
            stays[t] = random_below(&random, 30) > 0;
            if (stays[t])
                memcpy(later + 3 * left++, corners + 3 * (size_t)t, 3 * sizeof *later);
            gone += !stays[t];
        }
        hewn_triangle_view now = all;
        now.triangle_count = left;
        now.corners = later;
        hewn_simplify_recall(&recall, &now, known);
        for (uint32_t t = 0; t < left; t++)
            assert_int_equal(known[t], later[3 * t] / 3 % 3 != 0);
        memset(near, 1, sizeof near);
        assert_int_equal(hewn_simplify_recall_near(&recall, &now, &from, 0.7, near, NULL), HEWN_OK);
        for (uint32_t t = 0; t < OTHERS; t++) {
            for (uint32_t g = 0; g < COUNT && near[t]; g++)
                assert_true(stays[g] || least_distance(others + 9 * (size_t)t, points + 9 * (size_t)g) > 0.7);
            lost += !near[t];
        }
        assert_true(gone > 0 && lost > 0 && lost < OTHERS);
        /* Nothing is lost where nothing has gone. */
        memset(near, 1, sizeof near);
        assert_int_equal(hewn_simplify_recall_near(&recall, &all, &from, 0.7, near, NULL), HEWN_OK);
        for (uint32_t t = 0; t < OTHERS; t++)
            assert_int_equal(near[t], 1);
        hewn_simplify_forget(&recall);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_known_again)};
    return cmocka_run_group_tests_name("simplify_recall", tests, NULL, NULL);
}
