/* Paint: values and bounds do not know of it, colours are mixed as values are, and what is cut keeps its own. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <omp.h>

#include "field/graph.h"
#include "field/internal.h"

static const float grey[3] = {0.62F, 0.64F, 0.67F}, red[3] = {1, 0, 0}, blue[3] = {0, 0, 1};

static hewn_field *new_field(void)
{
    hewn_field *field;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    return field;
}

static void color_at(const hewn_field *f, hewn_node node, double x, double y, double z, float out[3])
{
    hewn_error error = {0};
    if (hewn_field_status(f, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    assert_int_equal(hewn_field_paint(f, node, (const double[3]){x, y, z}, 1, out, NULL, NULL), HEWN_OK);
}

static void expect(const hewn_field *f, hewn_node node, double x, double y, double z, const float wanted[3])
{
    float got[3];
    color_at(f, node, x, y, z, got);
    for (int i = 0; i < 3; i++)
        if (fabsf(got[i] - wanted[i]) > 1e-6F)
            fail_msg("at %g %g %g: %g %g %g, not %g %g %g", x, y, z, (double)got[0], (double)got[1], (double)got[2],
                     (double)wanted[0], (double)wanted[1], (double)wanted[2]);
}

static int32_t label_at(const hewn_field *f, hewn_node node, double x, double y, double z)
{
    int32_t label = -7;
    assert_int_equal(hewn_field_paint(f, node, (const double[3]){x, y, z}, 1, NULL, &label, NULL), HEWN_OK);
    return label;
}

static void sharp_operators(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node plain = hewn_sphere(f, 1);
    hewn_node a = hewn_color(f, plain, 1, 0, 0), b = hewn_translate(f, hewn_color(f, plain, 0, 0, 1), 1, 0, 0);
    hewn_node c = hewn_translate(f, plain, 1, 0, 0);
    expect(f, hewn_union(f, a, b), -1, 0, 0, red);
    expect(f, hewn_union(f, a, b), 2, 0, 0, blue);
    expect(f, hewn_union(f, a, c), 2, 0, 0, grey);
    expect(f, hewn_union(f, c, a), -1, 0, 0, red);
    expect(f, hewn_intersection(f, a, b), 1, 0, 0, red);
    expect(f, hewn_intersection(f, a, b), 0, 0, 0, blue);
    expect(f, hewn_intersection(f, a, c), 0, 0, 0, red); /* cut by what has no colour */
    expect(f, hewn_difference(f, a, b), 0, 0, 0, blue);  /* the cut has that of the tool */
    expect(f, hewn_difference(f, a, c), 0, 0, 0, red);
    expect(f, hewn_difference(f, c, a), 2, 0, 0, grey);
    expect(f, hewn_difference(f, c, a), 1, 0, 0, red);
    expect(f, hewn_complement(f, hewn_union(f, hewn_complement(f, a), hewn_complement(f, c))), 0, 0, 0, red);
    expect(f, hewn_color(f, hewn_union(f, a, b), 0, 1, 0), -1, 0, 0, (const float[3]){0, 1, 0}); /* the outer one */
    expect(f, c, 2, 0, 0, grey);
    hewn_field_destroy(&f);
}

/* Halfway, a blend mixes equally; past its size not at all; and in between it goes evenly from one to the other. */
static void blends(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node slab = hewn_plane(f, 0, 1, 0, 0), wall = hewn_plane(f, 1, 0, 0, 0);
    hewn_node a = hewn_color(f, slab, 1, 0, 0), b = hewn_color(f, wall, 0, 0, 1);
    for (int blend = HEWN_BLEND_QUADRATIC; blend <= HEWN_BLEND_EXPONENTIAL; blend++) {
        bool endless = blend == HEWN_BLEND_EXPONENTIAL;
        hewn_node both = hewn_smooth_union(f, a, b, (hewn_blend)blend, endless ? 20 : 0.5);
        hewn_node cut = hewn_smooth_intersection(f, a, b, (hewn_blend)blend, endless ? 20 : 0.5);
        expect(f, both, 0.1, 0.1, 0, (const float[3]){0.5F, 0, 0.5F});
        expect(f, cut, -0.1, -0.1, 0, (const float[3]){0.5F, 0, 0.5F});
        expect(f, both, 2, 0, 0, red);
        expect(f, both, 0, 2, 0, blue);
        expect(f, cut, 0, -2, 0, blue);
        expect(f, hewn_smooth_difference(f, a, hewn_plane(f, 1, 0, 0, 0), (hewn_blend)blend, endless ? 20 : 0.5), 0.1,
               -0.1, 0, red);
        float last = 0;
        for (int i = -60; i <= 60; i++) { /* derivatives by the operands add up to 1, and so do colours */
            float color[3];
            double x = 0.01 * i, gradient[4];
            color_at(f, both, x, 0, 0, color);
            assert_int_equal(hewn_field_gradient(f, both, (const double[3]){x, 0, 0}, 1, gradient, NULL), HEWN_OK);
            assert_true(color[0] >= last - 1e-6F && color[1] == 0);
            if (i != 0) {
                assert_true(fabs((double)color[0] - gradient[2]) < 1e-5);
                assert_true(fabs((double)color[2] - gradient[1]) < 1e-5);
            }
            last = color[0];
        }
    }
    hewn_field_destroy(&f);
}

static void through_everything_else(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node a = hewn_color(f, hewn_box_shape(f, 2, 2, 2), 1, 0, 0), b = hewn_color(f, hewn_sphere(f, 1), 0, 0, 1);
    const float half[3] = {0.75F, 0, 0.25F};
    expect(f, hewn_morph(f, a, b, hewn_constant(f, 0.25)), 1, 0, 0, half);
    expect(f, hewn_loft(f, a, b, 2), 0.9, 0, -0.5, half);
    expect(f, hewn_shell(f, hewn_offset(f, a, 0.1), 0.2), 1.2, 0, 0, red);
    expect(f, hewn_displace(f, a, hewn_noise(f, HEWN_NOISE_GRADIENT, 1, 1)), 1, 0, 0, red);
    expect(f, hewn_twist(f, hewn_stretch(f, a, 2, 1, 1), 0.3), 1, 0, 0, red);
    expect(f, hewn_extrude(f, hewn_color(f, hewn_circle(f, 1), 1, 0, 0), 1), 0, 0, 0.5, red);
    expect(f, hewn_revolve(f, hewn_color(f, hewn_circle(f, 1), 1, 0, 0)), 0, 0, 1, red);
    expect(f, hewn_array(f, a, 2, 1, 1, 3, 0, 0), 4, 0, 0, red);
    expect(f, hewn_scale(f, a, 3), 3, 0, 0, red);
    /* a fillet goes from one to the other: red far along one side, blue along the other, both in the middle */
    hewn_node floor = hewn_color(f, hewn_plane(f, 0, 1, 0, 0), 1, 0, 0);
    hewn_node wall = hewn_color(f, hewn_plane(f, 1, 0, 0, 0), 0, 0, 1), round = hewn_round_union(f, floor, wall, 1);
    double middle = 1 - sqrt(0.5);
    expect(f, round, 2, 0, 0, red);
    expect(f, round, 0, 2, 0, blue);
    expect(f, round, middle, middle, 0, (const float[3]){0.5F, 0, 0.5F});
    hewn_field_destroy(&f);
}

static void labels(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node a = hewn_label(f, hewn_sphere(f, 1), 3);
    hewn_node b = hewn_translate(f, hewn_label(f, hewn_color(f, hewn_sphere(f, 1), 1, 0, 0), 5), 1.5, 0, 0);
    hewn_node both = hewn_smooth_union(f, a, b, HEWN_BLEND_QUADRATIC, 0.5);
    assert_int_equal(label_at(f, both, -1, 0, 0), 3);
    assert_int_equal(label_at(f, both, 0.7, 0, 0), 3);
    assert_int_equal(label_at(f, both, 0.8, 0, 0), 5);
    assert_int_equal(label_at(f, hewn_union(f, both, hewn_translate(f, hewn_sphere(f, 1), 9, 0, 0)), 10, 0, 0), 0);
    expect(f, both, 2.5, 0, 0, red); /* a colour and a label do not mind each other */
    expect(f, both, -1, 0, 0, grey);
    assert_true(hewn_field_has_labels(f, both) && hewn_field_has_colors(f, both));
    assert_true(hewn_field_has_labels(f, a) && !hewn_field_has_colors(f, a));
    hewn_node repainted = hewn_label(f, b, 6);
    assert_int_equal(label_at(f, repainted, 2.5, 0, 0), 6);
    expect(f, repainted, 2.5, 0, 0, red);
    hewn_field_destroy(&f);
}

/* Painted trees have the values, gradients, bounds and boxes of bare ones, bit for bit. */
static void values_do_not_change(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node made[2];
    for (int painted = 0; painted < 2; painted++) {
        hewn_node a = hewn_box_shape(f, 1, 2, 1), b = hewn_translate(f, hewn_sphere(f, 0.8), 0.5, 0.3, 0);
        if (painted) {
            a = hewn_color(f, a, 0.2, 0.4, 0.6);
            b = hewn_label(f, hewn_color(f, b, 1, 1, 0), 2);
        }
        made[painted] = hewn_smooth_union(f, hewn_rotate(f, a, 0, 0, 1, 0.4), b, HEWN_BLEND_CUBIC, 0.3);
        made[painted] = hewn_difference(f, made[painted], hewn_twist(f, hewn_array(f, b, 2, 1, 1, 1, 0, 0), 1));
        if (painted)
            made[painted] = hewn_color(f, made[painted], 1, 0, 0);
    }
    assert_int_not_equal(made[0].id, made[1].id);
    hewn_box boxes[2];
    hewn_interval bounds[2];
    double gradients[2][4 * 100], points[300];
    srand(1);
    for (int i = 0; i < 300; i++)
        points[i] = rand() / (double)RAND_MAX * 4 - 2;
    for (int i = 0; i < 2; i++) {
        assert_int_equal(hewn_field_gradient(f, made[i], points, 100, gradients[i], NULL), HEWN_OK);
        assert_int_equal(hewn_field_find_box(f, made[i], &boxes[i], NULL), HEWN_OK);
        assert_int_equal(hewn_field_bound(f, made[i], &(hewn_box){{0, 0, 0}, {1, 1, 1}}, &bounds[i], NULL), HEWN_OK);
    }
    assert_memory_equal(gradients[0], gradients[1], sizeof gradients[0]);
    assert_memory_equal(&boxes[0], &boxes[1], sizeof boxes[0]);
    assert_memory_equal(&bounds[0].lo, &bounds[1].lo, 2 * sizeof(double));
    hewn_field_destroy(&f);
}

/* A point alone and among many that lie close or far: what blocks leave out changes nothing, nor does the number of
 * threads. */
static void blocks_and_threads(void **state)
{
    (void)state;
    enum { COUNT = 3000 };
    static double points[3 * COUNT];
    static float together[3 * COUNT], threads[3 * COUNT], alone[3];
    static int32_t labels_together[COUNT], label;
    hewn_field *f = new_field();
    hewn_node all = HEWN_NODE_NONE;
    srand(7);
#define ANY (rand() / (double)RAND_MAX)
    for (uint32_t i = 0; i < 60; i++) {
        hewn_node ball = hewn_translate(f, hewn_sphere(f, 0.1 + 0.3 * ANY), 4 * ANY - 2, 4 * ANY - 2, 4 * ANY - 2);
        if (i % 5 != 0)
            ball = hewn_color(f, ball, ANY, ANY, ANY);
        if (i % 3 != 0)
            ball = hewn_label(f, ball, i);
        all = i == 0       ? ball
              : i % 7 == 3 ? hewn_difference(f, all, ball)
              : i % 2      ? hewn_smooth_union(f, all, ball, (hewn_blend)(i % 4), i % 4 == 3 ? 9 : 0.2)
                           : hewn_union(f, all, ball);
    }
    for (int i = 0; i < 3 * COUNT; i++) /* some blocks small, some large */
        points[i] = i / 3 / 128 % 2 ? 4 * ANY - 2 : 0.1 * ANY + 0.5 * (i / 384 % 5) - 1;
    assert_int_equal(hewn_field_paint(f, all, points, COUNT, together, labels_together, NULL), HEWN_OK);
    omp_set_num_threads(5);
    assert_int_equal(hewn_field_paint(f, all, points, COUNT, threads, NULL, NULL), HEWN_OK);
    assert_memory_equal(together, threads, sizeof together);
    for (int i = 0; i < COUNT; i++) {
        assert_int_equal(hewn_field_paint(f, all, points + 3 * i, 1, alone, &label, NULL), HEWN_OK);
        assert_memory_equal(alone, together + 3 * i, sizeof alone);
        assert_int_equal(label, labels_together[i]);
    }
    hewn_field_destroy(&f);
}

static void what_is_refused(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    assert_true(hewn_node_is_none(hewn_color(f, hewn_sphere(f, 1), 1, 1.1, 0)));
    assert_int_equal(hewn_field_status(f, NULL), HEWN_INVALID_ARGUMENT);
    hewn_field_destroy(&f);
    f = new_field();
    assert_true(hewn_node_is_none(hewn_color(f, hewn_sphere(f, 1), NAN, 1, 0)));
    hewn_field_destroy(&f);
    f = new_field();
    assert_true(hewn_node_is_none(hewn_label(f, hewn_sphere(f, 1), HEWN_LABEL_MOST + 1u)));
    assert_int_equal(hewn_field_paint(f, HEWN_NODE_NONE, NULL, 0, NULL, NULL, NULL), HEWN_INVALID_ARGUMENT);
    hewn_field_destroy(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sharp_operators),         cmocka_unit_test(blends),
        cmocka_unit_test(through_everything_else), cmocka_unit_test(labels),
        cmocka_unit_test(values_do_not_change),    cmocka_unit_test(blocks_and_threads),
        cmocka_unit_test(what_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
