/* Samplings as leaves of fields: values continue over the borders of bricks, bounds contain them, slopes are their
 * derivatives, and past the lattice the distance is never overstated. */
#include "sampling_support.h"

#include "field/interval.h"

static const double space = 40;

static void place(random_state *random, const hewn_sampling *s, double out[3])
{
    for (int i = 0; i < 3; i++) {
        double half = 0.5 * s->cells[i];
        out[i] =
            random_below(random, 8) == 0 ? random_between(random, -space, space) : random_between(random, -half, half);
        if (random_below(random, 6) == 0)
            out[i] = round(out[i] / 8) * 8; /* where bricks meet */
    }
}

static hewn_sampling *any(random_state *random, int round)
{
    return round % 3 == 2 ? random_heights(random, 2 + random_below(random, 40), 2 + random_below(random, 40))
                          : random_sampling(random, 5);
}

static void values_are_continuous_and_as_steep_as_told(void **state)
{
    (void)state;
    random_state random = {61};
    for (int round = 0; round < 12; round++) {
        hewn_sampling *s = any(&random, round);
        double steepest = s->endless ? (double)s->steepest : fmax(1, (double)s->steepest);
        double most = 0;
        for (int i = 0; i < 20000; i++) {
            double a[3], b[3], size = ldexp(1, -(int)random_below(&random, 20)), square = 0;
            hewn_interval in[3];
            place(&random, s, a);
            for (int k = 0; k < 3; k++) {
                b[k] = a[k] + random_between(&random, -size, size);
                square += (b[k] - a[k]) * (b[k] - a[k]);
                in[k] = (hewn_interval){fmin(a[k], b[k]), fmax(a[k], b[k]), false};
            }
            double here = hewn_sampling_steepest(s, in);
            double apart = fabs(hewn_sampling_value(s, a, NULL) - hewn_sampling_value(s, b, NULL));
            most = fmax(most, apart / sqrt(square));
            assert_true(here <= steepest && apart <= here * sqrt(square) * (1 + 1e-6) + 1e-9);
        }
        assert_true(most > 0.5 * steepest || s->endless); /* the bound is one that is reached */
        hewn_sampling_destroy(&s);
    }
}

static void bounds_contain_values(void **state)
{
    (void)state;
    random_state random = {62};
    for (int round = 0; round < 12; round++) {
        hewn_sampling *s = any(&random, round);
        double width = 0, range = 0;
        for (int i = 0; i < 3000; i++) {
            hewn_interval in[3];
            double at[3], size = ldexp(30, -(int)random_below(&random, 12)), lo = INFINITY, hi = -INFINITY;
            place(&random, s, at);
            for (int k = 0; k < 3; k++)
                in[k] = (hewn_interval){at[k], at[k] + random_between(&random, 0, size), false};
            hewn_interval bound = hewn_sampling_bound(s, in);
            for (int j = 0; j < 30; j++) {
                for (int k = 0; k < 3; k++)
                    at[k] = j < 8 ? (j >> k & 1 ? in[k].hi : in[k].lo) : random_between(&random, in[k].lo, in[k].hi);
                double value = hewn_sampling_value(s, at, NULL);
                lo = fmin(lo, value);
                hi = fmax(hi, value);
                if (!(bound.lo <= value && value <= bound.hi))
                    fail_msg("[%.17g, %.17g] does not hold %.17g", bound.lo, bound.hi, value);
            }
            width += bound.hi - bound.lo;
            range += hi - lo;
        }
        assert_true(width < 6 * range);
        hewn_sampling_destroy(&s);
    }
}

static void slopes_are_derivatives(void **state)
{
    (void)state;
    random_state random = {63};
    for (int round = 0; round < 6; round++) {
        hewn_sampling *s = any(&random, round);
        for (int i = 0; i < 5000; i++) {
            double at[3], slopes[3];
            for (int k = 0; k < 3; k++) /* off the borders of cells, where there is no derivative */
                at[k] = floor(random_between(&random, -space, space)) + random_between(&random, 0.1, 0.4);
            hewn_sampling_value(s, at, slopes);
            for (int k = 0; k < 3; k++) {
                const double step = 1e-5;
                double ends[2];
                for (int e = 0; e < 2; e++) {
                    double moved[3] = {at[0], at[1], at[2]};
                    moved[k] += e ? step : -step;
                    ends[e] = hewn_sampling_value(s, moved, NULL);
                }
                double quotient = (ends[1] - ends[0]) / (2 * step);
                if (!(fabs(quotient - slopes[k]) < 1e-4))
                    fail_msg("slope %d at (%g, %g, %g) is %.9g, not %.9g", k, at[0], at[1], at[2], slopes[k], quotient);
            }
        }
        hewn_sampling_destroy(&s);
    }
}

/* Past the lattice the value is at most the distance to any point with a value of 0 or less. */
static void outside_is_a_lower_bound(void **state)
{
    (void)state;
    random_state random = {64};
    hewn_sampling *s = random_sampling(&random, 4);
    enum { INSIDE = 3000 };
    static double inside[INSIDE][3];
    for (int n = 0; n < INSIDE;) {
        for (int k = 0; k < 3; k++)
            inside[n][k] = random_between(&random, -0.5, 0.5) * s->cells[k];
        n += hewn_sampling_value(s, inside[n], NULL) <= 0;
    }
    for (int i = 0; i < 2000; i++) {
        double at[3], least = INFINITY;
        for (int k = 0; k < 3; k++)
            at[k] = random_between(&random, -2 * space, 2 * space);
        double value = hewn_sampling_value(s, at, NULL);
        bool past =
            fabs(at[0]) > 0.5 * s->cells[0] || fabs(at[1]) > 0.5 * s->cells[1] || fabs(at[2]) > 0.5 * s->cells[2];
        for (int n = 0; n < INSIDE; n++)
            least = fmin(least, hypot(hypot(at[0] - inside[n][0], at[1] - inside[n][1]), at[2] - inside[n][2]));
        assert_true(!past || (value > 0 && value <= least * (double)fmaxf(1, s->steepest) * 1.0001));
    }
    hewn_sampling_destroy(&s);
}

/* One node for one sampling, moved or not; it lives as long as the field; its box is found. */
static void fields_hold_samplings(void **state)
{
    (void)state;
    random_state random = {65};
    hewn_sampling *s = random_sampling(&random, 3);
    const hewn_sampling_place at = {{-1, -2, -3}, 0.125};
    const double cells[3] = {s->cells[0], s->cells[1], s->cells[2]};
    hewn_field *f;
    hewn_error error = {0};
    assert_int_equal(hewn_field_create(&f, &error), HEWN_OK);
    hewn_node one = hewn_sampled(f, s, &at), two = hewn_sampled(f, s, &at);
    assert_int_equal(one.id, two.id);
    hewn_node turned = hewn_rotate(f, one, 1, 2, 3, 0.7);
    hewn_sampling_destroy(&s);
    assert_null(s);
    hewn_box box;
    assert_int_equal(hewn_field_status(f, &error), HEWN_OK);
    assert_int_equal(hewn_field_set_root(f, turned, &error), HEWN_OK);
    assert_int_equal(hewn_field_find_box(f, turned, &box, &error), HEWN_OK);
    double p[3] = {-1 + 0.5 * 0.125 * cells[0], -2 + 0.5 * 0.125 * cells[1], -3 + 0.5 * 0.125 * cells[2]}, value;
    assert_int_equal(hewn_field_eval(f, one, p, 1, &value, &error), HEWN_OK);
    assert_true(value < 0);
    hewn_field_destroy(&f);
}

static void bad_ones_are_refused(void **state)
{
    (void)state;
    hewn_error error = {0};
    hewn_sampling *s;
    const float bad[4] = {0, 1, NAN, 2};
    assert_int_equal(hewn_sampling_from_heights(bad, 2, 2, &s, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "column 0 of row 1"));
    assert_null(s);
    assert_int_equal(hewn_sampling_from_heights(bad, 1, 2, &s, &error), HEWN_INVALID_ARGUMENT);
    const float good[4] = {0, 1, 2, 3};
    assert_int_equal(hewn_sampling_from_heights(good, 2, 2, &s, &error), HEWN_OK);
    hewn_field *f;
    assert_int_equal(hewn_field_create(&f, &error), HEWN_OK);
    assert_true(hewn_node_is_none(hewn_sampled(f, s, &(hewn_sampling_place){{0}, 1})));
    hewn_field_destroy(&f);
    assert_int_equal(hewn_field_create(&f, &error), HEWN_OK);
    assert_true(hewn_node_is_none(hewn_heights(f, s, 1, 0, 1)));
    hewn_field_destroy(&f);
    assert_int_equal(hewn_field_create(&f, &error), HEWN_OK);
    assert_true(hewn_node_is_none(hewn_heights(f, NULL, 1, 1, 1)));
    hewn_field_destroy(&f);
    hewn_sampling_destroy(&s);
    hewn_sampling_destroy(&s);
}

/* Heights are those of the samples, between them bilinear, and carry on past the sides. */
static void heights_are_those_given(void **state)
{
    (void)state;
    const float values[6] = {0, 1, 2, 10, 11, 14};
    hewn_error error = {0};
    hewn_sampling *s;
    hewn_field *f;
    assert_int_equal(hewn_sampling_from_heights(values, 3, 2, &s, &error), HEWN_OK);
    assert_int_equal(hewn_field_create(&f, &error), HEWN_OK);
    hewn_node land = hewn_heights(f, s, 4, 6, 0.5);
    const double at[5][3] = {{-2, -3, 0}, {2, 3, 7}, {0, 0, 3}, {50, 50, 7}, {1, 3, 6.25}};
    double out[5];
    assert_int_equal(hewn_field_eval(f, land, at[0], 5, out, &error), HEWN_OK);
    for (int i = 0; i < 5; i++)
        assert_true(fabs(out[i]) < 1e-9);
    hewn_field_destroy(&f);
    hewn_sampling_destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_continuous_and_as_steep_as_told),
        cmocka_unit_test(bounds_contain_values),
        cmocka_unit_test(slopes_are_derivatives),
        cmocka_unit_test(outside_is_a_lower_bound),
        cmocka_unit_test(fields_hold_samplings),
        cmocka_unit_test(bad_ones_are_refused),
        cmocka_unit_test(heights_are_those_given),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
