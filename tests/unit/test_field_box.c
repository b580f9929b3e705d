/* Finding a box: it holds every point below 0, it is not much larger than the shape, and what has none is refused. */
#include "test_field_support.h"

typedef struct extent {
    double lo[3], hi[3];
    int count;
} extent;

/* The extent of samples at or below 0 on a grid over a cube, none of which may lie outside the box. */
static extent sampled(const hewn_field *f, hewn_node node, const hewn_box *box, double reach, int side)
{
    extent out = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0};
    size_t row = (size_t)side + 1;
    double *points = malloc(3 * row * sizeof *points), *values = malloc(row * sizeof *values);
    for (size_t i = 0; i < row * row; i++) {
        for (size_t k = 0; k < row; k++) {
            points[3 * k] = reach * (2.0 * (double)k / side - 1);
            points[3 * k + 1] = reach * (2.0 * (double)(i % row) / side - 1);
            points[3 * k + 2] = reach * (2.0 * (double)(i / row) / side - 1);
        }
        assert_int_equal(hewn_field_eval(f, node, points, row, values, NULL), HEWN_OK);
        for (size_t k = 0; k < row; k++) {
            if (!(values[k] <= 0))
                continue;
            out.count++;
            for (int j = 0; j < 3; j++) {
                double at = points[3 * k + (size_t)j];
                out.lo[j] = fmin(out.lo[j], at);
                out.hi[j] = fmax(out.hi[j], at);
                if (at < box->lo[j] || at > box->hi[j])
                    fail_msg("(%g, %g, %g) is inside the shape (%g) but outside the box", points[3 * k],
                             points[3 * k + 1], points[3 * k + 2], values[k]);
            }
        }
    }
    free(points);
    free(values);
    return out;
}

/* The box of `node`: contains the samples, and is at most `slack` times as long as they are (and a cell or two). */
static hewn_box check_box(const hewn_field *f, hewn_node node, double reach, double slack)
{
    hewn_box box, again;
    hewn_error error = {0};
    assert_field_ok(f);
    if (hewn_field_find_box(f, node, &box, &error) != HEWN_OK)
        fail_msg("no box: %s", error.message);
    extent seen = sampled(f, node, &box, reach, 48);
    assert_true(seen.count > 0);
    for (int i = 0; i < 3; i++) {
        double cell = reach / 24;
        if (box.hi[i] - box.lo[i] > slack * (seen.hi[i] - seen.lo[i] + 2 * cell))
            fail_msg("along %c the box is [%g, %g], the shape [%g, %g]", "xyz"[i], box.lo[i], box.hi[i], seen.lo[i],
                     seen.hi[i]);
    }
    assert_int_equal(hewn_field_find_box(f, node, &again, NULL), HEWN_OK);
    assert_memory_equal(&box, &again, sizeof box);
    return box;
}

static void exact_box(hewn_box box, const double *lo, const double *hi)
{
    for (int i = 0; i < 3; i++)
        if (!(box.lo[i] <= lo[i] && box.lo[i] > lo[i] - 1e-4) || !(box.hi[i] >= hi[i] && box.hi[i] < hi[i] + 1e-4))
            fail_msg("along %c [%.9g, %.9g], not [%g, %g]", "xyz"[i], box.lo[i], box.hi[i], lo[i], hi[i]);
}

static void shapes_have_their_own_box(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    exact_box(check_box(f, hewn_sphere(f, 1), 1.5, 1.1), (double[]){-1, -1, -1}, (double[]){1, 1, 1});
    exact_box(check_box(f, hewn_box_shape(f, 1, 2, 3), 2, 1.1), (double[]){-.5, -1, -1.5}, (double[]){.5, 1, 1.5});
    exact_box(check_box(f, hewn_rounded_box(f, 1, 2, 3, 0.2), 2, 1.1), (double[]){-.5, -1, -1.5},
              (double[]){.5, 1, 1.5});
    exact_box(check_box(f, hewn_torus(f, 1, 0.25), 2, 1.1), (double[]){-1.25, -.25, -1.25},
              (double[]){1.25, .25, 1.25});
    exact_box(check_box(f, hewn_cylinder(f, 0.5, 3), 2, 1.1), (double[]){-.5, -1.5, -.5}, (double[]){.5, 1.5, .5});
    exact_box(check_box(f, hewn_capsule(f, 0.5, 2), 2, 1.1), (double[]){-.5, -1.5, -.5}, (double[]){.5, 1.5, .5});
    exact_box(check_box(f, hewn_cone(f, 0.5, 0.25, 2), 2, 1.1), (double[]){-.5, -1, -.5}, (double[]){.5, 1, .5});
    hewn_node moved = hewn_scale(f, hewn_translate(f, hewn_sphere(f, 1), 10, 20, -30), 1e-3);
    hewn_box box;
    assert_int_equal(hewn_field_find_box(f, moved, &box, NULL), HEWN_OK);
    exact_box(box, (double[]){0.009, 0.019, -0.031}, (double[]){0.011, 0.021, -0.029});
    moved = hewn_translate(f, hewn_rotate(f, hewn_box_shape(f, 2, 4, 6), 1, 0, 0, M_PI_2), 1e6, 0, 0);
    assert_int_equal(hewn_field_find_box(f, moved, &box, NULL), HEWN_OK);
    exact_box(box, (double[]){1e6 - 1, -3, -2}, (double[]){1e6 + 1, 3, 2});
    moved = hewn_stretch(f, hewn_sphere(f, 1), 1, 2, 3);
    exact_box(check_box(f, moved, 4, 1.1), (double[]){-1, -2, -3}, (double[]){1, 2, 3});
    check_box(f, hewn_rotate(f, hewn_cylinder(f, 0.2, 2), 1, 2, 3, 0.7), 2, 1.4);
    hewn_field_destroy(&f);
}

static void sets_of_shapes(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node ball = hewn_sphere(f, 1), far = hewn_translate(f, hewn_sphere(f, 0.5), 2, 0, 0);
    exact_box(check_box(f, hewn_union(f, ball, far), 3, 1.1), (double[]){-1, -1, -1}, (double[]){2.5, 1, 1});
    hewn_node half = hewn_plane(f, 1, 0, 0, 0.25);
    exact_box(check_box(f, hewn_intersection(f, ball, half), 1.5, 1.1), (double[]){-1, -1, -1}, (double[]){0.25, 1, 1});
    /* Six planes make a box, although each is infinite. */
    hewn_node cube = hewn_plane(f, 1, 0, 0, 1);
    const double normals[5][3] = {{-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 2}, {0, 0, -3}};
    for (int i = 0; i < 5; i++)
        cube = hewn_intersection(f, cube, hewn_plane(f, normals[i][0], normals[i][1], normals[i][2], 1));
    exact_box(check_box(f, cube, 2, 1.1), (double[]){-1, -1, -1}, (double[]){1, 1, 1});
    /* By De Morgan, through complements. */
    assert_int_equal(hewn_field_find_box(f, hewn_complement(f, ball), &(hewn_box){{0}, {0}}, NULL), HEWN_BAD_INPUT);
    hewn_node near_ball = hewn_translate(f, ball, 0.5, 0, 0);
    hewn_node both = hewn_complement(f, hewn_union(f, hewn_complement(f, ball), hewn_complement(f, near_ball)));
    check_box(f, both, 1.5, 1.4);
    /* A shell, an offset, a scaled value. */
    exact_box(check_box(f, hewn_sub(f, hewn_abs(f, ball), hewn_constant(f, 0.1)), 1.5, 1.1),
              (double[]){-1.1, -1.1, -1.1}, (double[]){1.1, 1.1, 1.1});
    exact_box(check_box(f, hewn_sub(f, hewn_mul(f, ball, hewn_constant(f, 4)), hewn_constant(f, 1)), 1.5, 1.1),
              (double[]){-1.25, -1.25, -1.25}, (double[]){1.25, 1.25, 1.25});
    exact_box(check_box(f, hewn_neg(f, hewn_div(f, ball, hewn_constant(f, -2))), 1.5, 1.1), (double[]){-1, -1, -1},
              (double[]){1, 1, 1});
    /* A cut that takes one side away: the proof by intervals sees it. */
    hewn_node cut =
        hewn_difference(f, hewn_box_shape(f, 2, 2, 2), hewn_translate(f, hewn_box_shape(f, 2, 4, 4), 1, 0, 0));
    assert_true(check_box(f, cut, 1.5, 1.2).hi[0] < 0.1);
    hewn_field_destroy(&f);
}

static void blends_reach_further(void **state)
{
    (void)state;
    for (int blend = HEWN_BLEND_QUADRATIC; blend <= HEWN_BLEND_EXPONENTIAL; blend++) {
        hewn_field *f = new_field();
        double size = blend == HEWN_BLEND_EXPONENTIAL ? 4 : 0.6;
        hewn_node a = hewn_sphere(f, 0.6), b = hewn_translate(f, hewn_box_shape(f, 1, 1, 1), 0.4, 0.3, 0);
        check_box(f, hewn_smooth_union(f, a, b, (hewn_blend)blend, size), 2, 1.3);
        double small = blend == HEWN_BLEND_EXPONENTIAL ? 16 : 0.15;
        check_box(f, hewn_smooth_intersection(f, a, b, (hewn_blend)blend, small), 2, 1.6);
        check_box(f, hewn_smooth_difference(f, a, b, (hewn_blend)blend, small), 2, 1.6);
        /* Two equal spheres swell by the blend's full depth. */
        hewn_node twin = hewn_stretch(f, a, 1, 1, 1.0000001);
        check_box(f, hewn_smooth_union(f, a, twin, (hewn_blend)blend, size), 2, 1.3);
        hewn_field_destroy(&f);
    }
}

/* --- plain arithmetic ----------------------------------------------------------------------------------------------
 */

static hewn_node number(hewn_field *f, double value)
{
    return hewn_constant(f, value);
}

static hewn_node length(hewn_field *f, hewn_node a, hewn_node b, hewn_node c)
{
    hewn_node sum = hewn_add(f, hewn_square(f, a), hewn_square(f, b));
    return hewn_sqrt(f, hewn_node_is_none(c) ? sum : hewn_add(f, sum, hewn_square(f, c)));
}

static hewn_node csg(hewn_field *f)
{
    hewn_node x = hewn_x(f), y = hewn_y(f), z = hewn_z(f);
    hewn_node s = hewn_sub(f, length(f, x, y, z), number(f, 0.8));
    hewn_node ax = hewn_abs(f, hewn_sub(f, x, number(f, 0.5)));
    hewn_node ay = hewn_abs(f, hewn_sub(f, y, number(f, 0.5)));
    hewn_node az = hewn_abs(f, hewn_sub(f, z, number(f, 0.5)));
    hewn_node b = hewn_sub(f, hewn_max(f, hewn_max(f, ax, ay), az), number(f, 0.45));
    hewn_node d = hewn_max(f, s, hewn_neg(f, b));
    hewn_node ring = hewn_sub(f, length(f, x, y, HEWN_NODE_NONE), number(f, 0.7));
    hewn_node t = hewn_sub(f, length(f, ring, hewn_add(f, z, number(f, 0.35)), HEWN_NODE_NONE), number(f, 0.15));
    hewn_node h = hewn_max(f, hewn_sub(f, number(f, 0.2), hewn_abs(f, hewn_sub(f, d, t))), number(f, 0));
    return hewn_sub(f, hewn_min(f, d, t), hewn_div(f, hewn_square(f, h), number(f, 0.8)));
}

static hewn_node rods(hewn_field *f, hewn_node t, int n)
{
    hewn_node least = HEWN_NODE_NONE;
    for (int i = 0; i < n; i++) {
        hewn_node one = hewn_abs(f, hewn_sub(f, t, number(f, -1 + (2.0 * i + 1) / n)));
        least = i == 0 ? one : hewn_min(f, least, one);
    }
    return least;
}

static hewn_node menger(hewn_field *f, int levels)
{
    hewn_node axis[3] = {hewn_x(f), hewn_y(f), hewn_z(f)}, holes = HEWN_NODE_NONE;
    for (int l = 1, n = 1; l <= levels; l++, n *= 3)
        for (int i = 0; i < 3; i++) {
            hewn_node pair = hewn_max(f, rods(f, axis[i], n), rods(f, axis[(i + 1) % 3], n));
            hewn_node hole = hewn_sub(f, pair, number(f, 1.0 / (3 * n)));
            holes = l == 1 && i == 0 ? hole : hewn_min(f, holes, hole);
        }
    hewn_node cube = hewn_max(f, hewn_max(f, hewn_abs(f, axis[0]), hewn_abs(f, axis[1])), hewn_abs(f, axis[2]));
    return hewn_max(f, hewn_sub(f, cube, number(f, 1)), hewn_neg(f, holes));
}

static hewn_node waves(hewn_field *f)
{
    hewn_node axis[3] = {hewn_x(f), hewn_y(f), hewn_z(f)}, sum = number(f, 0);
    for (int i = 0; i < 3; i++) {
        hewn_node s = hewn_sin(f, hewn_mul(f, axis[i], number(f, 12)));
        hewn_node c = hewn_cos(f, hewn_mul(f, axis[(i + 1) % 3], number(f, 12)));
        sum = hewn_add(f, sum, hewn_mul(f, s, c));
    }
    return hewn_sub(f, hewn_abs(f, sum), number(f, 0.4));
}

static hewn_node gyroid(hewn_field *f)
{
    hewn_node ball = hewn_sub(f, length(f, hewn_x(f), hewn_y(f), hewn_z(f)), number(f, 0.9));
    return hewn_max(f, waves(f), ball);
}

static void shipped_scenes_in_plain_arithmetic(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    check_box(f, csg(f), 1.2, 1.15);
    exact_box(check_box(f, menger(f, 3), 1.2, 1.1), (double[]){-1, -1, -1}, (double[]){1, 1, 1});
    check_box(f, gyroid(f), 1, 1.15);
    hewn_field_destroy(&f);
}

static void mixes_of_shapes_and_arithmetic(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    check_box(f, hewn_union(f, csg(f), hewn_translate(f, hewn_sphere(f, 0.3), 1, 1, 1)), 1.6, 1.2);
    check_box(f,
              hewn_smooth_union(f, gyroid(f), hewn_rotate(f, hewn_box_shape(f, 2, 0.4, 0.4), 1, 1, 1, 0.5),
                                HEWN_BLEND_CIRCULAR, 0.2),
              1.5, 1.3);
    check_box(f, hewn_translate(f, hewn_rotate(f, csg(f), 1, 2, 3, 1), 0.2, -0.1, 0.3), 1.6, 1.5);
    check_box(f, hewn_intersection(f, waves(f), hewn_cylinder(f, 0.7, 1)), 1, 1.2);
    check_box(f, hewn_scale(f, menger(f, 2), 0.5), 1, 1.1);
    /* x² + y²/4 + z²/9 < 1, and an octahedron: sums of signs, infinite in no direction. */
    hewn_node x = hewn_x(f), y = hewn_y(f), z = hewn_z(f);
    hewn_node ellipsoid = hewn_add(f, hewn_square(f, x), hewn_div(f, hewn_square(f, y), number(f, 4)));
    ellipsoid = hewn_sub(f, hewn_add(f, ellipsoid, hewn_div(f, hewn_square(f, z), number(f, 9))), number(f, 1));
    check_box(f, ellipsoid, 4, 1.2);
    hewn_node plus = hewn_add(f, x, y), minus = hewn_sub(f, x, y);
    hewn_node diamond = hewn_max(f, hewn_max(f, hewn_abs(f, plus), hewn_abs(f, minus)), hewn_abs(f, z));
    check_box(f, hewn_sub(f, diamond, number(f, 1)), 1.5, 1.2);
    /* Far from the origin, in arithmetic only. */
    hewn_node away = hewn_sub(f, length(f, hewn_sub(f, x, number(f, 1000)), y, z), number(f, 1));
    hewn_box box;
    assert_int_equal(hewn_field_find_box(f, away, &box, NULL), HEWN_OK);
    assert_true(box.lo[0] <= 999 && box.hi[0] >= 1001 && box.hi[0] - box.lo[0] < 2.5);
    /* And tiny. */
    hewn_node tiny = hewn_sub(f, length(f, x, y, z), number(f, 1e-5));
    assert_int_equal(hewn_field_find_box(f, tiny, &box, NULL), HEWN_OK);
    assert_true(box.lo[0] <= -1e-5 && box.hi[0] >= 1e-5 && box.hi[0] - box.lo[0] < 3e-5);
    hewn_field_destroy(&f);
}

static void what_has_no_box_is_refused(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node ball = hewn_sphere(f, 1);
    hewn_node apart = hewn_intersection(f, ball, hewn_translate(f, ball, 3, 0, 0));
    /* Boxes overlap, spheres do not: only the intervals know. */
    hewn_node diagonal = hewn_intersection(f, ball, hewn_translate(f, ball, 1.3, 1.3, 1.3));
    hewn_node none[] = {waves(f),
                        hewn_x(f),
                        hewn_constant(f, -1),
                        hewn_constant(f, 1),
                        hewn_constant(f, NAN),
                        hewn_plane(f, 1, 2, 3, 4),
                        hewn_complement(f, ball),
                        apart,
                        diagonal,
                        hewn_sqrt(f, hewn_sub(f, hewn_constant(f, -1), hewn_square(f, hewn_x(f))))};
    const char *word[] = {"bounds", "bounds", "bounds", "empty", "bounds",
                          "bounds", "bounds", "empty",  "empty", "bounds"};
    assert_field_ok(f);
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        hewn_box box = {{1, 1, 1}, {2, 2, 2}};
        hewn_error error = {0};
        if (hewn_field_find_box(f, none[i], &box, &error) != HEWN_BAD_INPUT)
            fail_msg("case %zu has a box: [%g, %g]", i, box.lo[0], box.hi[0]);
        if (!strstr(error.message, word[i]))
            fail_msg("case %zu: %s", i, error.message);
        assert_true(box.lo[0] == 0 && box.hi[2] == 0);
    }
    hewn_field_destroy(&f);
}

/* Random sets of random shapes: no sample below 0 outside the box. */
static void random_sets_stay_in_their_box(void **state)
{
    (void)state;
    random_state random = {31};
    int found = 0, rounds = effort(60);
    for (int round = 0; round < rounds; round++) {
        hewn_field *f = new_field();
        hewn_node all = HEWN_NODE_NONE;
        for (int i = 0; i < 6; i++) {
            hewn_op op = (hewn_op)(HEWN_OP_SPHERE + (int)random_below(&random, 7));
            hewn_node_data data = {.op = op, .operand = {0, 1, 2}};
            random_parameters(&random, op, data.parameter);
            hewn_node one = hewn_field_add_node(f, &data);
            one = hewn_rotate(f, one, random_unit(&random) + 0.1, random_unit(&random), random_unit(&random),
                              random_between(&random, -3, 3));
            one = hewn_stretch(f, one, random_between(&random, 0.3, 1.5), random_between(&random, 0.3, 1.5),
                               random_between(&random, 0.3, 1.5));
            one = hewn_translate(f, one, random_between(&random, -2, 2), random_between(&random, -2, 2),
                                 random_between(&random, -2, 2));
            hewn_blend blend = (hewn_blend)random_below(&random, 4);
            double size = random_between(&random, 0.1, 1) * (blend == HEWN_BLEND_EXPONENTIAL ? 10 : 1);
            uint32_t how = i == 0 ? 99 : random_below(&random, 6);
            all = how == 99  ? one
                  : how == 0 ? hewn_union(f, all, one)
                  : how == 1 ? hewn_difference(f, all, one)
                  : how == 2 ? hewn_smooth_difference(f, all, one, blend, size)
                  : how == 3
                      ? hewn_sub(f, hewn_union(f, all, one), hewn_constant(f, random_between(&random, -0.2, 0.3)))
                      : hewn_smooth_union(f, all, one, blend, size);
        }
        assert_field_ok(f);
        hewn_box box;
        hewn_result result = hewn_field_find_box(f, all, &box, NULL);
        if (result == HEWN_OK) {
            found++;
            (void)sampled(f, all, &box, 6, 40);
        } else {
            hewn_box nothing = {{1, 1, 1}, {-1, -1, -1}}; /* refused: it must be empty, these are all finite */
            assert_int_equal(sampled(f, all, &nothing, 6, 40).count, 0);
        }
        hewn_field_destroy(&f);
    }
    assert_true(found > rounds * 3 / 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_have_their_own_box),      cmocka_unit_test(sets_of_shapes),
        cmocka_unit_test(blends_reach_further),           cmocka_unit_test(shipped_scenes_in_plain_arithmetic),
        cmocka_unit_test(mixes_of_shapes_and_arithmetic), cmocka_unit_test(what_has_no_box_is_refused),
        cmocka_unit_test(random_sets_stay_in_their_box),
    };
    return cmocka_run_group_tests_name("field_box", tests, NULL, NULL);
}
