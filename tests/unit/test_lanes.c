/* Tapes on the host: cut ones give the whole one's bits, bounds contain values, values and gradients are the oracle's.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lanes/image.h"

static double uniform(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 33) / (double)(1u << 30) - 1;
}

/* A shape of some kind, moved and turned. */
static hewn_node random_shape(hewn_field *field, uint64_t *state)
{
    double a = 0.1 + 0.2 * fabs(uniform(state)), b = 0.1 + 0.2 * fabs(uniform(state));
    hewn_node shapes[] = {hewn_sphere(field, a),
                          hewn_box_shape(field, a, b, 2 * a),
                          hewn_rounded_box(field, 2 * a, 2 * b, a, 0.04),
                          hewn_torus(field, a, 0.3 * b),
                          hewn_cylinder(field, a, b),
                          hewn_capsule(field, 0.5 * a, b),
                          hewn_cone(field, a, 0.3 * b, b),
                          hewn_sub(field, hewn_sin(field, hewn_mul(field, hewn_x(field), hewn_constant(field, 5 * a))),
                                   hewn_square(field, hewn_y(field)))};
    hewn_node node = shapes[(size_t)(4 * (uniform(state) + 1)) % 8];
    node = hewn_rotate(field, node, 1, uniform(state), 0.3, 3 * uniform(state));
    double x = 0.7 * uniform(state), y = 0.7 * uniform(state);
    return hewn_translate(field, node, x, y, 0.7 * uniform(state));
}

static hewn_field *random_field(uint64_t seed, int count)
{
    hewn_field *field;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    hewn_node all = random_shape(field, &seed);
    for (int i = 1; i < count; i++) {
        hewn_node next = random_shape(field, &seed);
        int how = (int)(3 * (uniform(&seed) + 1));
        if (how < 2)
            all = hewn_union(field, all, next);
        else if (how == 2)
            all = hewn_difference(field, all, next);
        else
            all = hewn_smooth_union(field, all, next, (hewn_blend)(how - 3), how == 6 ? 20 : 0.1);
    }
    assert_int_equal(hewn_field_set_root(field, all, NULL), HEWN_OK);
    return field;
}

static hewn_lane_tape *whole_of(const hewn_field *field, hewn_lane_work *work)
{
    hewn_lane_tape *tape;
    assert_int_equal(hewn_lane_tape_create(field, hewn_field_root(field), &tape, NULL), HEWN_OK);
    assert_int_equal(hewn_lane_work_create(tape, work, NULL), HEWN_OK);
    return tape;
}

static void random_points(const hewn_lane_boxes *boxes, uint32_t lane, uint64_t *state, hewn_lane_points *out)
{
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < HEWN_LANES; i++) {
            float share = (float)(0.5 + 0.5 * uniform(state)), lo = boxes->lo[axis][lane], hi = boxes->hi[axis][lane];
            out->at[axis][i] = fminf(lo + share * (hi - lo), hi);
        }
}

static void test_values(void **state)
{
    (void)state;
    uint64_t random = 7;
    for (uint64_t seed = 1; seed <= 40; seed++) {
        hewn_field *field = random_field(seed, 12);
        hewn_lane_work work;
        hewn_lane_tape *tape = whole_of(field, &work);
        const hewn_lane_boxes box = {.lo = {{-1}, {-1}, {-1}}, .hi = {{1}, {1}, {1}}};
        hewn_lane_points points;
        random_points(&box, 0, &random, &points);
        float values[HEWN_LANES], again[HEWN_LANES], gradients[3][HEWN_LANES];
        hewn_lanes_value(tape, &work, &points, HEWN_LANES, values);
        hewn_lanes_gradient(tape, &work, &points, HEWN_LANES, again, gradients);
        for (int i = 0; i < HEWN_LANES; i++) {
            double p[3] = {(double)points.at[0][i], (double)points.at[1][i], (double)points.at[2][i]}, expected[4];
            assert_int_equal(hewn_field_gradient(field, hewn_field_root(field), p, 1, expected, NULL), HEWN_OK);
            assert_true(fabs((double)values[i] - expected[0]) < 2e-5);
            assert_true(fabs((double)again[i] - expected[0]) < 2e-5);
            for (int axis = 0; axis < 3; axis++)
                assert_true(fabs((double)gradients[axis][i] - expected[axis + 1]) < 0.02);
        }
        hewn_lane_work_destroy(&work);
        hewn_lane_tape_destroy(&tape);
        hewn_field_destroy(&field);
    }
}

/* In random boxes: the cut tape's bits are the whole one's, and lie within the bounds. */
static void test_cuts(void **state)
{
    (void)state;
    uint64_t random = 3;
    unsigned shorter = 0;
    for (uint64_t seed = 1; seed <= 40; seed++) {
        hewn_field *field = random_field(seed, 30);
        hewn_lane_work work;
        hewn_lane_tape *tape = whole_of(field, &work);
        hewn_lane_boxes boxes;
        for (int axis = 0; axis < 3; axis++)
            for (int i = 0; i < HEWN_LANE_BLOCK; i++) {
                double middle = uniform(&random), size = 0.01 + 0.2 * fabs(uniform(&random));
                boxes.lo[axis][i] = (float)(middle - size);
                boxes.hi[axis][i] = (float)(middle + size);
            }
        float lo[HEWN_LANES], hi[HEWN_LANES], values[HEWN_LANES], cut_values[HEWN_LANES];
        for (uint32_t lane = 0; lane < HEWN_LANE_BLOCK; lane++) {
            hewn_lanes_bound(tape, &work, &boxes, HEWN_LANE_BLOCK, lo, hi);
            hewn_lane_tape *cut = NULL;
            if (lo[lane] > -INFINITY)
                assert_int_equal(hewn_lane_tape_cut(tape, &work, lane, &cut, NULL), HEWN_OK);
            shorter += cut && cut->count < tape->count / 2;
            hewn_lane_points points;
            random_points(&boxes, lane, &random, &points);
            hewn_lanes_value(tape, &work, &points, HEWN_LANES, values);
            hewn_lanes_value(cut ? cut : tape, &work, &points, HEWN_LANES, cut_values);
            assert_memory_equal(values, cut_values, sizeof values);
            for (int i = 0; i < HEWN_LANES; i++)
                assert_true(lo[lane] <= values[i] && values[i] <= hi[lane]);
            hewn_lane_tape_destroy(&cut);
        }
        hewn_lane_work_destroy(&work);
        hewn_lane_tape_destroy(&tape);
        hewn_field_destroy(&field);
    }
    assert_true(shorter > 100);
}

/* An image by tiles is the image sample by sample. */
static void test_image(void **state)
{
    (void)state;
    enum { WIDTH = 203, HEIGHT = 77 };
    float x[WIDTH], y[HEIGHT], values[WIDTH * HEIGHT];
    uint8_t inside[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH; i++)
        x[i] = -1 + 2 * ((float)i + 0.5F) / WIDTH;
    for (int i = 0; i < HEIGHT; i++)
        y[i] = 1 - 2 * ((float)i + 0.5F) / HEIGHT;
    hewn_field *field = random_field(11, 60);
    hewn_lane_work work;
    hewn_lane_tape *tape = whole_of(field, &work);
    const hewn_lane_image_desc desc = {.x = x, .y = y, .z = 0.1F, .width = WIDTH, .height = HEIGHT};
    hewn_lane_image_stats stats;
    assert_int_equal(hewn_lanes_values(tape, &desc, values, &stats, NULL), HEWN_OK);
    assert_int_equal(hewn_lanes_inside(tape, &desc, inside, &stats, NULL), HEWN_OK);
    assert_true(stats.filled > 0 && stats.value_steps < (uint64_t)tape->count * WIDTH * HEIGHT / 4);
    unsigned within = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        hewn_lane_points points = {{{0}}};
        float expected[HEWN_LANES];
        points.at[0][0] = x[i % WIDTH];
        points.at[1][0] = y[i / WIDTH];
        points.at[2][0] = 0.1F;
        hewn_lanes_value(tape, &work, &points, HEWN_LANE_BLOCK, expected);
        assert_memory_equal(&values[i], &expected[0], sizeof(float));
        assert_int_equal(inside[i], expected[0] < 0);
        within += inside[i];
    }
    assert_true(within > 100 && within < WIDTH * HEIGHT - 100);
    hewn_lane_work_destroy(&work);
    hewn_lane_tape_destroy(&tape);
    hewn_field_destroy(&field);
}

/* Outlines have bounds, which hold what values are, links rounded to float and all. */
static void test_outlines(void **state)
{
    (void)state;
    uint64_t random = 11;
    hewn_field *field;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    hewn_node star = hewn_extrude(field, hewn_star(field, 7, 0.9, 0.35), 0.5);
    assert_int_equal(hewn_field_set_root(field, hewn_rotate(field, star, 1, 2, 3, 0.7), NULL), HEWN_OK);
    hewn_lane_work work;
    hewn_lane_tape *tape = whole_of(field, &work);
    for (int round = 0; round < 200; round++) {
        hewn_lane_boxes boxes;
        hewn_lane_points points;
        float lo[HEWN_LANES], hi[HEWN_LANES], values[HEWN_LANES];
        for (int i = 0; i < HEWN_LANE_BLOCK; i++)
            for (int axis = 0; axis < 3; axis++) {
                double middle = uniform(&random), size = 0.2 * pow(2, -0.1 * round);
                boxes.lo[axis][i] = (float)(middle - size);
                boxes.hi[axis][i] = (float)(middle + size);
            }
        hewn_lanes_bound(tape, &work, &boxes, HEWN_LANE_BLOCK, lo, hi);
        random_points(&boxes, 3, &random, &points);
        hewn_lanes_value(tape, &work, &points, HEWN_LANES, values);
        assert_true(isfinite(lo[3]) && isfinite(hi[3]));
        for (int i = 0; i < HEWN_LANES; i++) {
            double p[3] = {(double)points.at[0][i], (double)points.at[1][i], (double)points.at[2][i]}, expected;
            assert_int_equal(hewn_field_eval(field, hewn_field_root(field), p, 1, &expected, NULL), HEWN_OK);
            assert_true(lo[3] <= values[i] && values[i] <= hi[3]);
            assert_true(fabs((double)values[i] - expected) < 1e-5);
        }
    }
    hewn_lane_work_destroy(&work);
    hewn_lane_tape_destroy(&tape);
    hewn_field_destroy(&field);
}

/* --- outlines cut down ----------------------------------------------------------------------------------------------
 */

/* Corners on a coarse lattice, so that many are at one height, many sides are level, and lines cross. */
static hewn_node random_outline(hewn_field *field, uint64_t *state)
{
    enum { MOST = 90 };
    double points[2 * MOST];
    size_t count[2] = {3 + (size_t)(0.5 * (uniform(state) + 1) * (MOST / 2 - 4)),
                       3 + (size_t)(0.5 * (uniform(state) + 1) * (MOST / 2 - 4))};
    double steps = uniform(state) < 0 ? 6 : 1e6;
    for (size_t i = 0; i < count[0] + count[1]; i++) {
        double angle = 6.2832 * (double)i / (double)count[0], radius = 0.3 + 0.6 * fabs(uniform(state));
        bool star = steps > 6;
        points[2 * i] = round(steps * (star ? radius * cos(angle) : uniform(state))) / steps;
        points[2 * i + 1] = round(steps * (star ? radius * sin(angle) : uniform(state))) / steps;
    }
    return hewn_contours(field, points, count, uniform(state) < 0 ? 1 : 2);
}

/* Boxes whose ends are now and then exactly at corners' heights. */
static void random_box(uint64_t *state, double size, hewn_lane_boxes *boxes, uint32_t lane)
{
    for (int axis = 0; axis < 3; axis++) {
        double middle = 1.3 * uniform(state), half = size * fabs(uniform(state));
        float lo = (float)(middle - half), hi = (float)(middle + half);
        if (uniform(state) < -0.5)
            lo = (float)(round(6 * (double)lo) / 6);
        if (uniform(state) < -0.5)
            hi = (float)(round(6 * (double)hi) / 6);
        boxes->lo[axis][lane] = fminf(lo, hi);
        boxes->hi[axis][lane] = fmaxf(lo, hi);
    }
}

/* Points in a box, some at corners' heights and on its ends. */
static void snapped_points(const hewn_lane_boxes *boxes, uint32_t lane, uint64_t *state, hewn_lane_points *out)
{
    random_points(boxes, lane, state, out);
    for (int i = 0; i < HEWN_LANES; i += 2)
        for (int axis = 0; axis < 2; axis++) {
            float lo = boxes->lo[axis][lane], hi = boxes->hi[axis][lane], *at = &out->at[axis][i];
            *at = fminf(fmaxf(roundf(6 * *at) / 6, lo), hi);
        }
}

static void assert_same_bits(const hewn_lane_tape *whole, const hewn_lane_tape *cut, hewn_lane_work *work,
                             const hewn_lane_points *points)
{
    float a[HEWN_LANES], b[HEWN_LANES], slope[3][HEWN_LANES], other[3][HEWN_LANES];
    hewn_lanes_value(whole, work, points, HEWN_LANES, a);
    hewn_lanes_value(cut, work, points, HEWN_LANES, b);
    assert_memory_equal(a, b, sizeof a);
    hewn_lanes_gradient(whole, work, points, HEWN_LANES, a, slope);
    assert_memory_equal(a, b, sizeof a);
    hewn_lanes_gradient(cut, work, points, HEWN_LANES, b, other);
    assert_memory_equal(a, b, sizeof a);
    assert_memory_equal(slope, other, sizeof slope);
}

/* The box and then ever smaller parts of it, each cut from the last; returns how many sides the last one has. */
static uint32_t cut_and_compare(const hewn_lane_tape *tape, hewn_lane_work *work, uint64_t *random)
{
    enum { ROUNDS = 4 };
    hewn_lane_tape *made[ROUNDS] = {NULL};
    const hewn_lane_tape *from = tape;
    hewn_lane_boxes boxes;
    for (uint32_t lane = 0; lane < HEWN_LANE_BLOCK; lane++)
        random_box(random, 0.4, &boxes, lane);
    for (int round = 0; round < ROUNDS; round++) {
        hewn_lane_points points;
        float lo[HEWN_LANES], hi[HEWN_LANES], values[HEWN_LANES];
        hewn_lanes_bound(from, work, &boxes, HEWN_LANE_BLOCK, lo, hi);
        assert_int_equal(hewn_lane_tape_cut(from, work, 5, &made[round], NULL), HEWN_OK);
        from = made[round] ? made[round] : from;
        snapped_points(&boxes, 5, random, &points);
        assert_same_bits(tape, from, work, &points);
        hewn_lanes_value(from, work, &points, HEWN_LANES, values);
        for (int i = 0; i < HEWN_LANES; i++)
            assert_true(lo[5] <= values[i] && values[i] <= hi[5]);
        for (int axis = 0; axis < 3; axis++) {
            float middle = 0.5F * (boxes.lo[axis][5] + boxes.hi[axis][5]);
            *(uniform(random) < 0 ? &boxes.lo[axis][5] : &boxes.hi[axis][5]) = middle;
        }
    }
    uint32_t sides = from->side_count;
    for (int round = 0; round < ROUNDS; round++)
        hewn_lane_tape_destroy(&made[round]);
    return sides;
}

/* Whatever sides a box leaves, the bits there are those of all of them; and sign and distance are the oracle's. */
static void test_outline_cuts(void **state)
{
    (void)state;
    uint64_t random = 5, all = 0, left = 0;
    for (int round = 0; round < 150; round++) {
        hewn_field *field;
        assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
        hewn_node shape = random_outline(field, &random);
        if (round % 3 == 1)
            shape = hewn_union(field, random_outline(field, &random),
                               hewn_extrude(field, hewn_difference(field, random_outline(field, &random), shape), 0.5));
        if (round % 3 == 2)
            shape = hewn_rotate(field, hewn_extrude(field, shape, 1), 1, uniform(&random), 2, 3 * uniform(&random));
        assert_int_equal(hewn_field_set_root(field, shape, NULL), HEWN_OK);
        hewn_lane_work work;
        hewn_lane_tape *tape = whole_of(field, &work);
        for (int k = 0; k < 20; k++) {
            all += tape->side_count;
            left += cut_and_compare(tape, &work, &random);
        }
        const hewn_lane_boxes box = {.lo = {{-1}, {-1}, {-1}}, .hi = {{1}, {1}, {1}}};
        hewn_lane_points points;
        float values[HEWN_LANES];
        random_points(&box, 0, &random, &points);
        hewn_lanes_value(tape, &work, &points, HEWN_LANES, values);
        for (int i = 0; i < HEWN_LANES; i++) {
            double p[3] = {(double)points.at[0][i], (double)points.at[1][i], (double)points.at[2][i]}, expected;
            assert_int_equal(hewn_field_eval(field, hewn_field_root(field), p, 1, &expected, NULL), HEWN_OK);
            assert_true(fabs((double)values[i] - expected) < 1e-5);
        }
        hewn_lane_work_destroy(&work);
        hewn_lane_tape_destroy(&tape);
        hewn_field_destroy(&field);
    }
    assert_true(left * 5 < all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_outlines), cmocka_unit_test(test_values),
                                       cmocka_unit_test(test_cuts), cmocka_unit_test(test_image),
                                       cmocka_unit_test(test_outline_cuts)};
    return cmocka_run_group_tests_name("lanes", tests, NULL, NULL);
}
