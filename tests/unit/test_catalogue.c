/* What the catalogue says of each function is so: bounds, slopes, exactness, boxes. */
#include "catalogue_support.h"

static hewn_node call(random_state *random, hewn_field *f, const hewn_function *function,
                      hewn_argument values[HEWN_ARGUMENTS_MOST])
{
    static argument_room room;
    hewn_node node = random_call(random, f, function, values, &room);
    hewn_error error = {0};
    if (hewn_field_status(f, &error) != HEWN_OK)
        fail_msg("%s: %s", function->name, error.message);
    return node;
}

static void names_are_unique(void **state)
{
    (void)state;
    assert_true(hewn_function_count > 80);
    for (size_t i = 0; i < hewn_function_count; i++) {
        int needed, count = hewn_function_arguments(&hewn_functions[i], &needed);
        assert_true(needed <= count && (count > 0 || hewn_functions[i].call));
        assert_true(hewn_functions[i].build || hewn_functions[i].call);
        for (size_t k = 0; k < i; k++)
            assert_string_not_equal(hewn_functions[i].name, hewn_functions[k].name);
        /* what cannot differ by more than the distance is never more than the distance */
        if (hewn_functions[i].exactness != HEWN_LOOSE)
            assert_true(hewn_functions[i].slope == 1);
    }
}

/* --- bounds --------------------------------------------------------------------------------------------------------
 */

enum { BOXES = 25, IN_A_BOX = 200, ROUNDS = 4 };

static void check_bounds(random_state *random, const hewn_field *f, hewn_node node, const char *name)
{
    static double points[3 * IN_A_BOX], values[IN_A_BOX];
    for (int b = 0; b < effort(BOXES) && b < 500; b++) {
        hewn_box box;
        hewn_interval bounds;
        double size = ldexp(1, -(int)random_below(random, 8));
        for (int i = 0; i < 3; i++) {
            box.lo[i] = random_between(random, -2, 2);
            box.hi[i] = box.lo[i] + size * random_unit(random);
        }
        for (int i = 0; i < IN_A_BOX * 3; i++)
            points[i] = i < 24 ? ((i / 3) >> (i % 3) & 1 ? box.hi[i % 3] : box.lo[i % 3])
                               : random_between(random, box.lo[i % 3], box.hi[i % 3]);
        assert_int_equal(hewn_field_bound(f, node, &box, &bounds, NULL), HEWN_OK);
        assert_int_equal(hewn_field_eval(f, node, points, IN_A_BOX, values, NULL), HEWN_OK);
        for (int i = 0; i < IN_A_BOX; i++)
            if (!interval_has(bounds, values[i]))
                fail_msg("%s: %a is not in [%a, %a]", name, values[i], bounds.lo, bounds.hi);
    }
}

/* 100,000 samples each in long runs, 20,000 else. */
static void bounds_hold(void **state)
{
    (void)state;
    random_state random = {31};
    for (size_t i = 0; i < hewn_function_count; i++)
        for (int round = 0; round < ROUNDS && hewn_functions[i].build; round++) {
            hewn_argument values[HEWN_ARGUMENTS_MOST];
            hewn_field *f = new_field();
            check_bounds(&random, f, call(&random, f, &hewn_functions[i], values), hewn_functions[i].name);
            hewn_field_destroy(&f);
        }
}

/* --- slopes --------------------------------------------------------------------------------------------------------
 */

enum { PAIRS = 500 };

static void check_slope(random_state *random, const hewn_field *f, hewn_node node, double slope, const char *name)
{
    static double points[6 * PAIRS], values[2 * PAIRS];
    for (int i = 0; i < PAIRS; i++) {
        double length = ldexp(1, 1 - (int)random_below(random, 14)), *at = points + 6 * i;
        for (int k = 0; k < 3; k++) {
            at[k] = random_between(random, -2, 2);
            at[3 + k] = at[k] + length * random_between(random, -1, 1);
        }
    }
    assert_int_equal(hewn_field_eval(f, node, points, (size_t)2 * PAIRS, values, NULL), HEWN_OK);
    for (int i = 0; i < PAIRS; i++) {
        const double *a = points + 6 * i, *b = a + 3;
        double apart =
            sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
        double difference = fabs(values[2 * i] - values[2 * i + 1]);
        if (!(difference <= slope * apart + 1e-9))
            fail_msg("%s changes by %g within %g, %g times as much (%g, %g, %g)", name, difference, apart,
                     difference / apart, a[0], a[1], a[2]);
    }
}

static void slopes_hold(void **state)
{
    (void)state;
    random_state random = {32};
    for (size_t i = 0; i < hewn_function_count; i++) {
        const hewn_function *function = &hewn_functions[i];
        for (int round = 0; round < effort(40) && function->build && function->slope > 0; round++) {
            hewn_argument values[HEWN_ARGUMENTS_MOST];
            hewn_field *f = new_field();
            hewn_node node = call(&random, f, function, values);
            double over = function->slope_over ? values[function->slope_over - 1].number : 1;
            check_slope(&random, f, node, function->slope / over, function->name);
            hewn_field_destroy(&f);
        }
    }
}

/* --- exactness ------------------------------------------------------------------------------------------------------
 */

enum { SURFACE = 8000, TRIALS = 60 };

/* Points of the surface: random ones, brought there along the gradient. What does not arrive does not count. */
static size_t sample_surface(random_state *random, const hewn_field *f, hewn_node node, double *surface, size_t wanted)
{
    enum { BATCH = 2000, STEPS = 8, DRAWS = 8 };
    static double points[3 * BATCH], out[4 * BATCH];
    size_t count = 0;
    for (int attempt = 0; attempt < 10 && count < wanted; attempt++) {
        for (size_t i = 0; i < (size_t)3 * BATCH; i++)
            points[i] = random_between(random, -2.5, 2.5);
        for (int draw = 0; draw < DRAWS; draw++) { /* near ones, or edges would have most of them */
            assert_int_equal(hewn_field_eval(f, node, points, BATCH, out, NULL), HEWN_OK);
            for (size_t i = 0; i < (size_t)3 * BATCH; i++)
                points[i] = fabs(out[i / 3]) > 0.2 ? random_between(random, -2.5, 2.5) : points[i];
        }
        for (int step = 0; step <= STEPS; step++) {
            assert_int_equal(hewn_field_gradient(f, node, points, BATCH, out, NULL), HEWN_OK);
            for (size_t i = 0; step < STEPS && i < BATCH; i++) {
                const double *g = out + 4 * i;
                double square = g[1] * g[1] + g[2] * g[2] + g[3] * g[3];
                for (size_t k = 0; k < 3 && square > 1e-3; k++)
                    points[3 * i + k] -= g[0] * g[1 + k] / square;
            }
        }
        for (size_t i = 0; i < BATCH && count < wanted; i++)
            if (fabs(out[4 * i]) < 1e-9)
                memcpy(surface + 3 * count++, points + 3 * i, 3 * sizeof(double));
    }
    return count;
}

static double nearest(const double *surface, size_t count, const double *at)
{
    double best = INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double *p = surface + 3 * i;
        double x = p[0] - at[0], y = p[1] - at[1], z = p[2] - at[2];
        best = fmin(best, x * x + y * y + z * z);
    }
    return sqrt(best);
}

/* Nothing of the surface is nearer than the value says; and where values are distances something is as near, but for
 * the gaps between samples. */
static void check_distances(random_state *random, const hewn_field *f, hewn_node node, const hewn_function *function)
{
    static double surface[3 * SURFACE];
    size_t count = sample_surface(random, f, node, surface, function->exactness == HEWN_BOUND ? SURFACE / 4 : SURFACE);
    if (count < 1000) {
        if (function->section != HEWN_SECTION_COMBINING &&
            function->section != HEWN_SECTION_CHANGING) /* may be empty */
            fail_msg("%s: hardly any surface (%zu points)", function->name, count);
        return;
    }
    int exact = 0, wrong = 0;
    for (int i = 0; i < TRIALS; i++) {
        double at[3], value;
        for (int k = 0; k < 3; k++)
            at[k] = random_between(random, -1.2, 1.2);
        assert_int_equal(hewn_field_eval(f, node, at, 1, &value, NULL), HEWN_OK);
        double distance = nearest(surface, count, at);
        if (fabs(value) > distance + 1e-6)
            fail_msg("%s says %g at (%g, %g, %g), but the surface is %g away", function->name, value, at[0], at[1],
                     at[2], distance);
        bool claimed = function->exactness == HEWN_EXACT || (function->exactness == HEWN_EXACT_OUTSIDE && value > 0);
        if (!claimed || fabs(value) > 0.8)
            continue;
        exact++;
        wrong += distance > fabs(value) + 0.04 + 0.05 * fabs(value);
        if (distance > fabs(value) + 0.12 + 0.1 * fabs(value))
            fail_msg("%s says %g at (%g, %g, %g), but no surface is nearer than %g", function->name, value, at[0],
                     at[1], at[2], distance);
    }
    if (wrong > exact / 8)
        fail_msg("%s: %d of %d values are less than the distance", function->name, wrong, exact);
}

static void distances_are_distances(void **state)
{
    (void)state;
    random_state random = {33};
    for (size_t i = 0; i < hewn_function_count; i++) {
        const hewn_function *function = &hewn_functions[i];
        for (int round = 0; round < (effort(1) > 1 ? 10 : 1) && function->build && function->slope == 1; round++) {
            hewn_argument values[HEWN_ARGUMENTS_MOST];
            hewn_field *f = new_field();
            check_distances(&random, f, call(&random, f, function, values), function);
            hewn_field_destroy(&f);
        }
    }
}

/* --- boxes ----------------------------------------------------------------------------------------------------------
 */

enum { SIDE = 40 };

/* Every inside point of a grid is in the box, which is not much larger than those points. */
static void check_box(const hewn_field *f, hewn_node node, const char *name)
{
    static double points[3 * SIDE * SIDE * SIDE], values[SIDE * SIDE * SIDE];
    const double reach = 6;
    hewn_box box;
    hewn_error error = {0};
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    double from[3] = {INFINITY, INFINITY, INFINITY}, to[3] = {-INFINITY, -INFINITY, -INFINITY}; /* about, if thin */
    hewn_result result = hewn_field_find_box(f, node, &box, &error);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        for (int k = 0; k < 3; k++) {
            int at = k == 0 ? i % SIDE : k == 1 ? i / SIDE % SIDE : i / (SIDE * SIDE);
            points[3 * i + k] = reach * (2 * (at + 0.5) / SIDE - 1);
        }
    assert_int_equal(hewn_field_eval(f, node, points, SIDE * SIDE * SIDE, values, NULL), HEWN_OK);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        for (int k = 0; k < 3 && values[i] <= 0.2; k++) {
            double at = points[3 * i + k];
            from[k] = fmin(from[k], at);
            to[k] = fmax(to[k], at);
            if (values[i] <= 0) {
                lo[k] = fmin(lo[k], at);
                hi[k] = fmax(hi[k], at);
            }
        }
    if (result != HEWN_OK) {
        if (lo[0] <= hi[0] || !strstr(error.message, "empty"))
            fail_msg("%s: %s", name, error.message);
        return;
    }
    for (int k = 0; k < 3; k++) {
        if (lo[k] < box.lo[k] || hi[k] > box.hi[k])
            fail_msg("%s reaches from %g to %g along %c, its box from %g to %g", name, lo[k], hi[k], "xyz"[k],
                     box.lo[k], box.hi[k]);
        double length = from[k] <= to[k] ? to[k] - from[k] : 0;
        if (box.hi[k] - box.lo[k] > 1.5 * length + 1)
            fail_msg("%s is about %g long along %c, its box %g", name, length, "xyz"[k], box.hi[k] - box.lo[k]);
    }
}

static void boxes_are_found(void **state)
{
    (void)state;
    random_state random = {34};
    for (size_t i = 0; i < hewn_function_count; i++)
        for (int round = 0; round < (effort(1) > 1 ? 20 : 2) && hewn_functions[i].build; round++) {
            hewn_argument values[HEWN_ARGUMENTS_MOST];
            if (!is_bounded_function(&hewn_functions[i]))
                break;
            hewn_field *f = new_field();
            hewn_node node = call(&random, f, &hewn_functions[i], values);
            check_box(f, node, hewn_functions[i].name);
            /* and turned, so that no side is along an axis */
            node = hewn_translate(f, hewn_rotate(f, node, 1, 0.4, -0.3, 0.8), 0.3, -0.2, 0.1);
            check_box(f, node, hewn_functions[i].name);
            hewn_field_destroy(&f);
        }
}

/* --- outlines -------------------------------------------------------------------------------------------------------
 */

/* The sign by winding, the distance by the sides one by one; corners at each other's heights, level sides, loops that
 * cross. */
static void polygons_are_exact(void **state)
{
    (void)state;
    random_state random = {35};
    for (int round = 0; round < effort(200); round++) {
        enum { MOST = 12 };
        double points[2 * MOST];
        size_t count = 3 + random_below(&random, MOST - 2);
        for (size_t i = 0; i < 2 * count; i++)
            points[i] = round % 2 ? (double)random_below(&random, 5) - 2 : random_between(&random, -2, 2);
        hewn_field *f = new_field();
        hewn_node node = hewn_polygon(f, points, count);
        if (hewn_node_is_none(node)) { /* fewer than three different sides */
            hewn_field_destroy(&f);
            continue;
        }
        for (int trial = 0; trial < 50; trial++) {
            double x = random_between(&random, -3, 3), y = random_between(&random, -3, 3), least = INFINITY;
            if (trial % 5 == 0)
                y = points[2 * random_below(&random, (uint32_t)count) + 1];
            bool inside = false;
            for (size_t i = 0; i < count; i++) {
                const double *a = points + 2 * i, *b = points + 2 * ((i + 1) % count);
                double ex = b[0] - a[0], ey = b[1] - a[1], square = ex * ex + ey * ey;
                double t = square > 0 ? fmin(fmax(((x - a[0]) * ex + (y - a[1]) * ey) / square, 0), 1) : 0;
                least = fmin(least, hypot(x - a[0] - t * ex, y - a[1] - t * ey));
                if ((a[1] > y) != (b[1] > y) && x < a[0] + ex * (y - a[1]) / ey)
                    inside = !inside;
            }
            double value = value_at(f, node, x, y, 0.3);
            if (least > 1e-9 && fabs(value - (inside ? -least : least)) > 1e-9)
                fail_msg("%g at (%g, %g), not %g", value, x, y, inside ? -least : least);
        }
        hewn_field_destroy(&f);
    }
}

/* A profile that is closed along the axis makes a solid without a surface on it. */
static void revolved_outlines_have_no_axis(void **state)
{
    (void)state;
    random_state random = {36};
    hewn_field *f = new_field();
    hewn_node profile = hewn_polygon(f, (const double[8]){0, -1, 0.8, -1, 0.8, 1, 0, 1}, 4);
    hewn_node turned = hewn_revolve(f, profile), cylinder = hewn_cylinder(f, 0.8, 2);
    assert_true(fabs(value_at(f, turned, 0, 0.1, 0) + 0.8) < 1e-12);
    for (int i = 0; i < 1000; i++) {
        double x = random_between(&random, -2, 2), y = random_between(&random, -2, 2),
               z = random_between(&random, -2, 2);
        assert_true(fabs(value_at(f, turned, x, y, z) - value_at(f, cylinder, x, y, z)) < 1e-12);
    }
    hewn_field_destroy(&f);
}

/* On each side of a convex polygon the gradient points outwards, also where the value is 0 to the last bit. */
static void outlines_face_outwards(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    for (unsigned sides = 3; sides < 12; sides++)
        for (int turned = 0; turned < 2; turned++) {
            double points[2 * 12];
            for (unsigned i = 0; i < sides; i++) {
                double angle = 2 * M_PI * (turned ? sides - i : i) / sides;
                points[2 * i] = cos(angle);
                points[2 * i + 1] = sin(angle);
            }
            hewn_node node = hewn_polygon(f, points, sides);
            for (unsigned i = 0; i < sides; i++)
                for (int part = 1; part < 8; part++) {
                    const double *a = points + 2 * i, *b = points + 2 * ((i + 1) % sides), t = part / 8.0;
                    double at[3] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), 0}, out[4];
                    assert_int_equal(hewn_field_gradient(f, node, at, 1, out, NULL), HEWN_OK);
                    assert_true(fabs(out[0]) < 1e-12);
                    assert_true(out[1] * at[0] + out[2] * at[1] > 0.3);
                }
        }
    hewn_node square = hewn_polygon(f, (const double[8]){0, 0, 1, 0, 1, 1, 0, 1}, 4);
    const double middles[4][3] = {{0.5, 0, 0}, {1, 0.5, 0}, {0.5, 1, 0}, {0, 0.5, 0}};
    for (int i = 0; i < 4; i++) {
        double out[4];
        assert_int_equal(hewn_field_gradient(f, square, middles[i], 1, out, NULL), HEWN_OK);
        assert_true(out[0] == 0 && out[1] * (middles[i][0] - 0.5) + out[2] * (middles[i][1] - 0.5) == 0.5);
    }
    hewn_field_destroy(&f);
}

/* --- refusals -------------------------------------------------------------------------------------------------------
 */

static void refused(hewn_field *f, hewn_node node, const char *word)
{
    hewn_error error = {0};
    assert_true(hewn_node_is_none(node));
    assert_int_equal(hewn_field_status(f, &error), HEWN_INVALID_ARGUMENT);
    if (!strstr(error.message, word))
        fail_msg("'%s' does not name %s", error.message, word);
    hewn_field_destroy(&f);
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    const double line[6] = {0, 0, 1, 0, 0, 0}, far[6] = {0, 0, 1, 0, NAN, 1};
    hewn_field *f;
#define REFUSED(call, word) f = new_field(), refused(f, call, word)
    REFUSED(hewn_box_frame(f, 1, 1, 1, 0.5), "box_frame");
    REFUSED(hewn_round_cone(f, 2, 0.5, 1), "round_cone");
    REFUSED(hewn_helix(f, 1, 0.1, 1, 0.1), "helix");
    REFUSED(hewn_prism(f, 2, 1, 1), "prism");
    REFUSED(hewn_link(f, -1, 1, 0.1), "link");
    REFUSED(hewn_tube(f, line, 1, 0.1), "tube");
    REFUSED(hewn_bezier_tube(f, line, 2, 0.1), "bezier_tube");
    REFUSED(hewn_polygon(f, line, 3), "polygon");
    REFUSED(hewn_polygon(f, far, 3), "polygon");
    REFUSED(hewn_outline(f, &(hewn_curve){.degree = 4}, 1), "outline");
    REFUSED(hewn_gyroid(f, 1, -1), "gyroid");
    REFUSED(hewn_gyroid(f, 0, 1), "gyroid");
    REFUSED(hewn_noise(f, HEWN_NOISE_VALUE, 1, 1u << 24), "noise");
    REFUSED(hewn_noise(f, (hewn_noise_kind)9, 1, 1), "noise");
    REFUSED(hewn_fbm(f, &(hewn_octaves){.size = 1}), "fbm");
    REFUSED(hewn_ridged(f, &(hewn_octaves){.size = 1, .octaves = 2, .gain = -1}), "ridged");
    REFUSED(hewn_shell(f, hewn_x(f), 0), "shell");
    REFUSED(hewn_stairs_union(f, hewn_x(f), hewn_y(f), 1, 0), "stairs");
    REFUSED(hewn_chamfer_union(f, hewn_x(f), hewn_y(f), -1), "chamfer");
    REFUSED(hewn_mirror(f, hewn_x(f), 3), "mirror");
    REFUSED(hewn_array(f, hewn_x(f), 100000, 100000, 100000, 1, 1, 1), "array");
    REFUSED(hewn_radial(f, hewn_x(f), 0, 1), "radial");
    REFUSED(hewn_tile(f, hewn_x(f), 0, 0, 0), "tile");
    REFUSED(hewn_twist(f, hewn_x(f), NAN), "twist");
    REFUSED(hewn_taper(f, hewn_x(f), 0, 1, 1), "taper");
    REFUSED(hewn_elongate(f, hewn_x(f), -1, 0, 0), "elongate");
    REFUSED(hewn_extrude(f, hewn_x(f), 0), "extrude");
    REFUSED(hewn_warp(f, hewn_x(f), 1, 0, 0), "warp");
#undef REFUSED
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_unique),
        cmocka_unit_test(bounds_hold),
        cmocka_unit_test(slopes_hold),
        cmocka_unit_test(distances_are_distances),
        cmocka_unit_test(boxes_are_found),
        cmocka_unit_test(polygons_are_exact),
        cmocka_unit_test(outlines_face_outwards),
        cmocka_unit_test(revolved_outlines_have_no_axis),
        cmocka_unit_test(bad_arguments_are_refused),
    };
    return cmocka_run_group_tests_name("catalogue", tests, NULL, NULL);
}
