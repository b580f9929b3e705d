/* Bounds: whatever the box, they contain what the operation gives for every point in it, and they are not idle. */
#include "test_field_support.h"

#include "field/interval.h"

static hewn_interval bound_of(const hewn_field *f, hewn_node node, const hewn_interval *in)
{
    hewn_box box = {{in[0].lo, in[1].lo, in[2].lo}, {in[0].hi, in[1].hi, in[2].hi}};
    hewn_interval out;
    assert_int_equal(hewn_field_bound(f, node, &box, &out, NULL), HEWN_OK);
    assert_true(out.lo <= out.hi);
    return out;
}

static void check_members(random_state *random, const hewn_field *f, hewn_node node, const hewn_interval *in, int count)
{
    hewn_interval out = bound_of(f, node, in);
    for (int i = 0; i < count; i++) {
        double at[3] = {random_member(random, in[0]), random_member(random, in[1]), random_member(random, in[2])};
        double value = value_at(f, node, at[0], at[1], at[2]);
        if (!interval_has(out, value))
            fail_msg("%s of [%a, %a] [%a, %a] [%a, %a] is said to lie in [%a, %a]%s, but at (%a, %a, %a) is %a",
                     hewn_op_infos[hewn_field_node(f, node.id)->op].name, in[0].lo, in[0].hi, in[1].lo, in[1].hi,
                     in[2].lo, in[2].hi, out.lo, out.hi, out.maybe_nan ? " or NaN" : "", at[0], at[1], at[2], value);
    }
}

/* Every operation straight on the variables, awkward boxes: signed zeros, infinities, huge, denormal, single points. */
static void bounds_contain_every_operation(void **state)
{
    (void)state;
    random_state random = {21};
    for (hewn_op op = HEWN_OP_X; op < HEWN_OP_COUNT; op++)
        for (int round = 0; round < effort(1000) && !hewn_op_is_link(op); round++) {
            hewn_field *f = new_field();
            hewn_node_data data = {.op = op, .operand = {0, 1, 2}};
            random_parameters(&random, op, data.parameter);
            bool noise = op >= HEWN_OP_NOISE_VALUE && op <= HEWN_OP_NOISE_CELLULAR;
            if (round % 7 == 0 && op >= HEWN_OP_SPHERE && op != HEWN_OP_PLANE && !noise)
                for (int i = 0; i < 4; i++)
                    data.parameter[i] = ldexp(1 + random_unit(&random), (int)random_below(&random, 60) - 30);
            hewn_node node = hewn_field_add_node(f, &data);
            assert_field_ok(f);
            hewn_interval in[3];
            for (int i = 0; i < 3; i++)
                in[i] = random_interval(&random);
            check_members(&random, f, node, in, 12);
            hewn_field_destroy(&f);
        }
}

/* Remainders by a constant, where wrapping must be noticed. */
static void bounds_contain_remainders(void **state)
{
    (void)state;
    random_state random = {22};
    for (int round = 0; round < effort(5000); round++) {
        hewn_field *f = new_field();
        double period = random_below(&random, 3) ? random_between(&random, -3, 3) : random_awkward(&random);
        hewn_node node = hewn_mod(f, hewn_x(f), hewn_constant(f, period));
        hewn_interval in[3] = {random_interval(&random), {0, 0, false}, {0, 0, false}};
        check_members(&random, f, node, in, 10);
        hewn_field_destroy(&f);
    }
}

static void bounds_contain_random_graphs(void **state)
{
    (void)state;
    random_state random = {23};
    int useful = 0, rounds = effort(1000);
    for (int round = 0; round < rounds; round++) {
        hewn_field *f = new_field();
        hewn_node root = random_graph(&random, f, 4 + (int)random_below(&random, 196), round % 2 == 0);
        assert_field_ok(f);
        hewn_interval in[3];
        for (int i = 0; i < 3; i++) {
            double at = random_between(&random, -2, 2);
            in[i] = round % 3 == 0 ? random_interval(&random)
                                   : (hewn_interval){at, at + random_unit(&random) * random_unit(&random), false};
        }
        check_members(&random, f, root, in, 12);
        hewn_interval out = bound_of(f, root, in);
        useful += isfinite(out.lo) && isfinite(out.hi) && !out.maybe_nan;
        hewn_field_destroy(&f);
    }
    assert_true(useful > rounds / 5); /* or the test above would say little */
}

/* Each function with operands that may be NaN already. */
static void nan_is_passed_on(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node nan = hewn_sqrt(f, hewn_x(f)), y = hewn_y(f);
    hewn_interval in[3] = {{-1, 1, false}, {-1, 1, false}, {-1, 1, false}};
    assert_true(bound_of(f, nan, in).maybe_nan);
    for (hewn_op op = HEWN_OP_NEG; op < HEWN_OP_COUNT; op++) {
        for (int place = 0; place < hewn_op_infos[op].operands && !hewn_op_is_link(op); place++) {
            hewn_node_data data = {.op = op, .operand = {y.id, y.id, y.id}};
            data.operand[place] = nan.id;
            random_state random = {24};
            random_parameters(&random, op, data.parameter);
            hewn_node node = hewn_field_add_node(f, &data);
            double value = value_at(f, node, -1, 0, 0);
            if (isnan(value))
                assert_true(bound_of(f, node, in).maybe_nan);
            else
                assert_true(op == HEWN_OP_NOT || op == HEWN_OP_AND || op == HEWN_OP_OR);
            check_members(&random, f, node, in, 100);
        }
    }
    hewn_field_destroy(&f);
}

static void near(hewn_interval got, double lo, double hi)
{
    if (got.maybe_nan || !(got.lo <= lo && got.lo >= lo - 1e-12) || !(got.hi >= hi && got.hi <= hi + 1e-12))
        fail_msg("[%.17g, %.17g]%s, not [%.17g, %.17g]", got.lo, got.hi, got.maybe_nan ? " or NaN" : "", lo, hi);
}

static hewn_interval of(double lo, double hi)
{
    return (hewn_interval){lo, hi, false};
}

static void bounds_are_tight(void **state)
{
    (void)state;
    near(hewn_interval_sin(of(0, 1)), 0, sin(1));
    near(hewn_interval_sin(of(1, 2)), sin(1), 1);
    near(hewn_interval_sin(of(2, 4)), sin(4), sin(2));
    near(hewn_interval_sin(of(4, 5)), -1, sin(4));
    near(hewn_interval_sin(of(-2, 2)), -1, 1);
    near(hewn_interval_cos(of(-1, 0.5)), cos(1), 1);
    near(hewn_interval_cos(of(3, 3.5)), -1, cos(3.5));
    near(hewn_interval_cos(of(100, 100.5)), cos(100), cos(100.5));
    near(hewn_interval_tan(of(-1, 1)), tan(-1), tan(1));
    near(hewn_interval_tan(of(2, 4)), tan(2), tan(4));
    near(hewn_interval_square(of(-2, 1)), 0, 4);
    near(hewn_interval_abs(of(-2, 1)), 0, 2);
    near(hewn_interval_mul(of(-2, 3), of(-5, 7)), -15, 21);
    near(hewn_interval_div(of(1, 2), of(-4, -2)), -1, -0.25);
    near(hewn_interval_sqrt(of(4, 9)), 2, 3);
    near(hewn_interval_exp(of(0, 1)), 1, exp(1));
    near(hewn_interval_ln(of(1, 2)), 0, log(2));
    near(hewn_interval_mod(of(5, 6), of(4, 4)), 1, 2);
    near(hewn_interval_mod(of(-3, -2), of(4, 4)), 1, 2);
    near(hewn_interval_mod(of(3, 5), of(4, 4)), 0, 4);
    near(hewn_interval_mod(of(3, 5), of(8, 9)), 3, 5);
    near(hewn_interval_atan2(of(1, 2), of(-1, 1)), atan2(1, 1), atan2(1, -1));
    near(hewn_interval_atan2(of(-1, 1), of(1, 2)), atan2(-1, 1), atan2(1, 1));
    near(hewn_interval_atan2(of(-1, 1), of(-2, -1)), -M_PI, M_PI);
    near(hewn_interval_compare(of(0, 1), of(2, 3)), -1, -1);
    near(hewn_interval_compare(of(0, 2), of(2, 3)), -1, 0);
    near(hewn_interval_compare(of(0, 2), of(1, 3)), -1, 1);
    near(hewn_interval_and(of(0, 0), of(2, 3)), 0, 0);
    near(hewn_interval_and(of(1, 2), of(2, 3)), 2, 3);
    near(hewn_interval_and(of(0, 2), of(2, 3)), 0, 3);
    near(hewn_interval_or(of(0, 0), of(2, 3)), 2, 3);
    near(hewn_interval_or(of(1, 2), of(5, 6)), 1, 2);
    near(hewn_interval_not(of(-1, 1)), 0, 1);
    near(hewn_interval_not(of(1, 2)), 0, 0);
    near(hewn_interval_not(of(0, 0)), 1, 1);
    near(hewn_interval_round(of(-0.5, 0.4)), -1, 0);
    /* Exact arithmetic is not widened, and real ends are not lost to infinity. */
    hewn_interval exact = hewn_interval_add(of(1, 2), of(0.5, 0.25 + 0.5));
    assert_true(exact.lo == 1.5 && exact.hi == 2.75);
    hewn_interval huge = hewn_interval_square(of(1e200, 1e201));
    assert_true(huge.lo == DBL_MAX && huge.hi == INFINITY && !huge.maybe_nan);
    hewn_interval divided = hewn_interval_div(of(1, 1), of(-1, 1));
    assert_true(divided.lo == -INFINITY && divided.hi == INFINITY && !divided.maybe_nan);
    assert_true(hewn_interval_div(of(0, 1), of(-1, 1)).maybe_nan);
    assert_true(hewn_interval_sin(of(0, INFINITY)).maybe_nan);
    assert_true(hewn_interval_sqrt(of(-2, -1)).maybe_nan);
}

/* Shapes on a grid of boxes: the bounds against the extremes of many samples. */
static void shape_bounds_are_tight(void **state)
{
    (void)state;
    random_state random = {25};
    for (hewn_op op = HEWN_OP_SPHERE; op < HEWN_OP_COUNT; op++)
        for (int round = 0; round < effort(40); round++) {
            if ((op >= HEWN_OP_NOISE_VALUE && op <= HEWN_OP_SAMPLED) || hewn_op_is_link(op))
                break; /* noise is bounded by how steep it can be: not tight */
            hewn_field *f = new_field();
            hewn_node_data data = {.op = op, .operand = {0, 1, 2}};
            random_parameters(&random, op, data.parameter);
            hewn_node node = hewn_field_add_node(f, &data);
            hewn_interval in[3];
            for (int i = 0; i < 3; i++) {
                double at = random_between(&random, -2, 2);
                in[i] = of(at, at + random_between(&random, 0.01, 1));
            }
            double lo = INFINITY, hi = -INFINITY, step = 0;
            enum { SIDE = 24 };
            for (int i = 0; i < (SIDE + 1) * (SIDE + 1) * (SIDE + 1); i++) {
                int k[3] = {i % (SIDE + 1), i / (SIDE + 1) % (SIDE + 1), i / ((SIDE + 1) * (SIDE + 1))};
                double at[3];
                for (int j = 0; j < 3; j++)
                    at[j] = fmin(in[j].lo + (in[j].hi - in[j].lo) * k[j] / SIDE, in[j].hi);
                double value = value_at(f, node, at[0], at[1], at[2]);
                lo = fmin(lo, value);
                hi = fmax(hi, value);
            }
            for (int j = 0; j < 3; j++)
                step += (in[j].hi - in[j].lo) / SIDE;
            hewn_interval out = bound_of(f, node, in);
            if (out.lo > lo || out.hi < hi || out.lo < lo - step || out.hi > hi + step)
                fail_msg("%s: [%g, %g] for samples in [%g, %g]", hewn_op_infos[op].name, out.lo, out.hi, lo, hi);
            hewn_field_destroy(&f);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_contain_every_operation),
        cmocka_unit_test(bounds_contain_remainders),
        cmocka_unit_test(bounds_contain_random_graphs),
        cmocka_unit_test(nan_is_passed_on),
        cmocka_unit_test(bounds_are_tight),
        cmocka_unit_test(shape_bounds_are_tight),
    };
    return cmocka_run_group_tests_name("field_interval", tests, NULL, NULL);
}
