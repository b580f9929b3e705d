/* Bounds of slopes: no two points tell of a steeper one, for every function of the catalogue and what is made of them;
 * and they are as small as they should be where it is known. */
#include "catalogue_support.h"
#include "render/tracer.h"

static const hewn_box box = {{-1.2, -1.1, -1.3}, {1.3, 1.2, 1.1}};

static double bound_of(const hewn_field *field, hewn_node node)
{
    double out;
    assert_int_equal(hewn_steepness_bound(field, node, &box, &out, NULL), HEWN_OK);
    return out;
}

/* Pairs of points ever nearer to each other. */
static void check_pairs(random_state *random, const hewn_field *field, hewn_node node, const char *name)
{
    enum { PAIRS = 400 };
    static double points[PAIRS][2][3], values[PAIRS][2];
    double bound = bound_of(field, node);
    assert_false(isnan(bound) || bound < 0);
    if (bound == INFINITY)
        return;
    for (int i = 0; i < PAIRS; i++)
        for (int axis = 0; axis < 3; axis++) {
            double at = random_between(random, box.lo[axis], box.hi[axis]), apart = pow(0.1, i % 5);
            points[i][0][axis] = at;
            at += apart * random_between(random, -1, 1);
            points[i][1][axis] = fmin(fmax(at, box.lo[axis]), box.hi[axis]);
        }
    assert_int_equal(hewn_field_eval(field, node, points[0][0], (size_t)2 * PAIRS, values[0], NULL), HEWN_OK);
    for (int i = 0; i < PAIRS; i++) {
        double square = 0, rise = fabs(values[i][1] - values[i][0]);
        for (int axis = 0; axis < 3; axis++)
            square += (points[i][1][axis] - points[i][0][axis]) * (points[i][1][axis] - points[i][0][axis]);
        if (!(rise <= bound * sqrt(square) * (1 + 1e-9) + 1e-12))
            fail_msg("%s: a slope of %.9g, past %.9g", name, rise / sqrt(square), bound);
    }
}

static hewn_node random_of_catalogue(random_state *random, hewn_field *f, size_t i)
{
    argument_room room;
    hewn_argument values[HEWN_ARGUMENTS_MOST];
    hewn_node node = random_call(random, f, &hewn_functions[i], values, &room);
    return hewn_node_is_none(node) ? hewn_sphere(f, 0.5) : node;
}

static void test_functions(void **state)
{
    (void)state;
    random_state random = {1};
    for (size_t i = 0; i < hewn_function_count; i++)
        for (int round = 0; round < 6 && hewn_functions[i].build; round++) {
            hewn_field *f;
            assert_int_equal(hewn_field_create(&f, NULL), HEWN_OK);
            check_pairs(&random, f, random_of_catalogue(&random, f, i), hewn_functions[i].name);
            hewn_field_destroy(&f);
        }
}

/* Two of the catalogue turned and combined, so that forms of all kinds meet. */
static void test_combinations(void **state)
{
    (void)state;
    random_state random = {2};
    for (int round = 0; round < 400; round++) {
        hewn_field *f;
        assert_int_equal(hewn_field_create(&f, NULL), HEWN_OK);
        hewn_node parts[2];
        for (int k = 0; k < 2; k++) {
            size_t i = (size_t)random_below(&random, (uint32_t)hewn_function_count);
            parts[k] = hewn_functions[i].build ? random_of_catalogue(&random, f, i) : random_operand(&random, f, true);
            if (random_below(&random, 2))
                parts[k] = hewn_extrude(f, parts[k], 0.8);
            if (random_below(&random, 2))
                parts[k] = hewn_rotate(f, parts[k], 1, 2, random_between(&random, -1, 1), 2);
        }
        hewn_node all[] = {hewn_round_union(f, parts[0], parts[1], 0.3),
                           hewn_round_intersection(f, parts[0], parts[1], 0.3),
                           hewn_smooth_union(f, parts[0], parts[1], HEWN_BLEND_CIRCULAR, 0.3),
                           hewn_difference(f, parts[0], parts[1]),
                           hewn_add(f, parts[0], parts[1]),
                           hewn_sub(f, hewn_max(f, hewn_min(f, parts[0], parts[1]), hewn_constant(f, 0.2)), parts[1])};
        check_pairs(&random, f, all[random_below(&random, 6)], "a combination");
        hewn_field_destroy(&f);
    }
}

static void test_known(void **state)
{
    (void)state;
    hewn_field *f;
    assert_int_equal(hewn_field_create(&f, NULL), HEWN_OK);
    hewn_node star = hewn_extrude(f, hewn_star(f, 5, 0.8, 0.4), 0.5), ball = hewn_sphere(f, 0.5);
    hewn_node turned = hewn_rotate(f, star, 1, 2, 3, 0.7);
    assert_true(bound_of(f, ball) < 1 + 1e-6);
    assert_true(bound_of(f, star) < 1 + 1e-6);
    assert_true(bound_of(f, turned) < 1 + 1e-6);
    assert_true(bound_of(f, hewn_extrude(f, hewn_rectangle(f, 1, 0.5), 0.5)) < 1 + 1e-6);
    assert_true(bound_of(f, hewn_difference(f, turned, ball)) < 1 + 1e-6);
    double fillet = bound_of(f, hewn_round_union(f, turned, ball, 0.2));
    assert_true(fillet > 1 && fillet < sqrt(2) + 1e-6);
    assert_true(fabs(bound_of(f, hewn_mul(f, ball, hewn_constant(f, 3))) - 3) < 1e-6);
    assert_true(bound_of(f, hewn_floor(f, ball)) == INFINITY);
    hewn_field_destroy(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_functions), cmocka_unit_test(test_combinations),
                                       cmocka_unit_test(test_known)};
    return cmocka_run_group_tests_name("steepness", tests, NULL, NULL);
}
