/* Building: hash-consing, folding, what is refused and how that is told, graphs of great depth. */
#include "test_field_support.h"

#include "base/alloc.h"

static void same(hewn_node a, hewn_node b)
{
    assert_false(hewn_node_is_none(a));
    assert_int_equal(a.id, b.id);
}

static double constant_value(const hewn_field *field, hewn_node node)
{
    assert_false(hewn_node_is_none(node));
    const hewn_node_data *data = hewn_field_node(field, node.id);
    assert_int_equal(data->op, HEWN_OP_CONSTANT);
    return data->parameter[0];
}

static void equal_expressions_are_one_node(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node x = hewn_x(f), y = hewn_y(f);
    same(hewn_x(f), x);
    same(hewn_sin(f, hewn_add(f, x, y)), hewn_sin(f, hewn_add(f, x, y)));
    same(hewn_add(f, x, y), hewn_add(f, y, x));
    same(hewn_mul(f, x, y), hewn_mul(f, y, x));
    same(hewn_sphere(f, 2), hewn_sphere(f, 2));
    same(hewn_constant(f, 3), hewn_constant(f, 3));
    assert_int_not_equal(hewn_sub(f, x, y).id, hewn_sub(f, y, x).id);
    assert_int_not_equal(hewn_min(f, x, y).id, hewn_min(f, y, x).id); /* ties differ in their gradients */
    assert_int_not_equal(hewn_constant(f, 0.0).id, hewn_constant(f, -0.0).id);
    same(hewn_constant(f, NAN), hewn_constant(f, -(double)NAN));
    assert_int_not_equal(hewn_sphere(f, 2).id, hewn_sphere(f, 3).id);
    assert_field_ok(f);
    hewn_field_destroy(&f);
    assert_null(f);
    hewn_field_destroy(&f);
}

static void identities_leave_the_operand(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node x = hewn_x(f), y = hewn_y(f), zero = hewn_constant(f, 0), one = hewn_constant(f, 1);
    hewn_node minus = hewn_constant(f, -1);
    same(hewn_add(f, x, zero), x);
    same(hewn_add(f, zero, x), x);
    same(hewn_sub(f, x, zero), x);
    same(hewn_mul(f, x, one), x);
    same(hewn_mul(f, one, x), x);
    same(hewn_div(f, x, one), x);
    same(hewn_mul(f, x, minus), hewn_neg(f, x));
    same(hewn_div(f, x, minus), hewn_neg(f, x));
    same(hewn_neg(f, hewn_neg(f, x)), x);
    same(hewn_min(f, y, y), y);
    same(hewn_max(f, y, y), y);
    same(hewn_abs(f, hewn_abs(f, x)), hewn_abs(f, x));
    same(hewn_abs(f, hewn_neg(f, x)), hewn_abs(f, x));
    same(hewn_mul(f, x, x), hewn_square(f, x));
    same(hewn_square(f, hewn_abs(f, hewn_neg(f, x))), hewn_square(f, x));
    same(hewn_add(f, x, hewn_neg(f, y)), hewn_sub(f, x, y));
    same(hewn_sub(f, x, hewn_neg(f, y)), hewn_add(f, x, y));
    same(hewn_floor(f, hewn_round(f, x)), hewn_round(f, x));
    same(hewn_difference(f, x, hewn_complement(f, y)), hewn_intersection(f, x, y));
    same(hewn_logic_and(f, one, x), x);
    same(hewn_logic_or(f, zero, x), x);
    /* x 0 may be NaN or a zero of either sign, so it stays. */
    assert_int_equal(hewn_field_node(f, hewn_mul(f, x, zero).id)->op, HEWN_OP_MUL);
    assert_field_ok(f);
    hewn_field_destroy(&f);
}

static void constants_fold(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node two = hewn_constant(f, 2), three = hewn_constant(f, 3), zero = hewn_constant(f, 0);
    assert_true(constant_value(f, hewn_add(f, two, three)) == 5);
    assert_true(constant_value(f, hewn_sin(f, two)) == sin(2.0));
    assert_true(constant_value(f, hewn_mod(f, hewn_constant(f, -1), three)) == 2);
    assert_true(constant_value(f, hewn_div(f, two, zero)) == INFINITY);
    assert_true(isnan(constant_value(f, hewn_div(f, zero, zero))));
    assert_true(constant_value(f, hewn_remap(f, hewn_sphere(f, 1), two, zero, zero)) == 1);
    assert_int_equal(hewn_field_size(f, hewn_add(f, two, three)), 1);
    assert_field_ok(f);
    hewn_field_destroy(&f);
}

static void nested_transforms_leave_one_row(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node ball = hewn_sphere(f, 1), moved = ball;
    for (int i = 0; i < 20; i++)
        moved = hewn_rotate(f, hewn_translate(f, moved, 0.1, 0.2, 0.3), 1, 2, 3, 0.1);
    assert_int_equal(hewn_field_size(f, moved), 7); /* x, y, z, three rows, the sphere */
    same(hewn_translate(f, hewn_translate(f, ball, 1, 2, 3), -1, -2, -3), ball);
    same(hewn_translate(f, ball, 0, 0, 0), ball);
    same(hewn_rotate(f, hewn_rotate(f, ball, 0, 0, 1, M_PI_2), 0, 0, 1, -M_PI_2), ball);
    same(hewn_scale(f, ball, 1), ball);
    hewn_node quarter = hewn_rotate(f, hewn_x(f), 0, 0, 1, M_PI_2);
    same(quarter, hewn_y(f)); /* the plane that faced +x faces +y */
    assert_field_ok(f);
    hewn_field_destroy(&f);
}

typedef hewn_node (*builder)(hewn_field *field);

static hewn_node bad_sphere(hewn_field *f)
{
    return hewn_sphere(f, -1);
}
static hewn_node nan_sphere(hewn_field *f)
{
    return hewn_sphere(f, NAN);
}
static hewn_node flat_box(hewn_field *f)
{
    return hewn_box_shape(f, 1, 0, 1);
}
static hewn_node huge_box(hewn_field *f)
{
    return hewn_box_shape(f, 1, INFINITY, 1);
}
static hewn_node over_rounded(hewn_field *f)
{
    return hewn_rounded_box(f, 1, 2, 3, 0.6);
}
static hewn_node bad_torus(hewn_field *f)
{
    return hewn_torus(f, 1, 0);
}
static hewn_node bad_cylinder(hewn_field *f)
{
    return hewn_cylinder(f, 1, -1);
}
static hewn_node bad_capsule(hewn_field *f)
{
    return hewn_capsule(f, 0, 1);
}
static hewn_node bad_cone(hewn_field *f)
{
    return hewn_cone(f, 0, 0, 1);
}
static hewn_node bad_plane(hewn_field *f)
{
    return hewn_plane(f, 0, 0, 0, 1);
}
static hewn_node bad_scale(hewn_field *f)
{
    return hewn_scale(f, hewn_x(f), 0);
}
static hewn_node bad_stretch(hewn_field *f)
{
    return hewn_stretch(f, hewn_x(f), 1, 1, -1);
}
static hewn_node bad_axis(hewn_field *f)
{
    return hewn_rotate(f, hewn_x(f), 0, 0, 0, 1);
}
static hewn_node bad_angle(hewn_field *f)
{
    return hewn_rotate(f, hewn_x(f), 0, 0, 1, NAN);
}
static hewn_node bad_move(hewn_field *f)
{
    return hewn_translate(f, hewn_x(f), INFINITY, 0, 0);
}
static hewn_node bad_size(hewn_field *f)
{
    return hewn_smooth_union(f, hewn_x(f), hewn_y(f), HEWN_BLEND_CUBIC, -1);
}
static hewn_node bad_k(hewn_field *f)
{
    return hewn_smooth_union(f, hewn_x(f), hewn_y(f), HEWN_BLEND_EXPONENTIAL, 0);
}
static hewn_node bad_blend(hewn_field *f)
{
    return hewn_smooth_union(f, hewn_x(f), hewn_y(f), (hewn_blend)77, 1);
}
static hewn_node no_operand(hewn_field *f)
{
    return hewn_add(f, hewn_x(f), HEWN_NODE_NONE);
}
static hewn_node foreign_operand(hewn_field *f)
{
    return hewn_neg(f, (hewn_node){12345});
}
static hewn_node no_coordinate(hewn_field *f)
{
    return hewn_remap(f, hewn_x(f), HEWN_NODE_NONE, hewn_y(f), hewn_z(f));
}
static hewn_node no_operation(hewn_field *f)
{
    return hewn_field_add_node(f, &(hewn_node_data){.op = HEWN_OP_COUNT});
}

static void what_makes_no_sense_is_refused_and_remembered(void **state)
{
    (void)state;
    static const builder bad[] = {bad_sphere,   nan_sphere,      flat_box,      huge_box,    over_rounded, bad_torus,
                                  bad_cylinder, bad_capsule,     bad_cone,      bad_plane,   bad_scale,    bad_stretch,
                                  bad_axis,     bad_angle,       bad_move,      bad_size,    bad_k,        bad_blend,
                                  no_operand,   foreign_operand, no_coordinate, no_operation};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        hewn_field *f = new_field();
        hewn_node node = bad[i](f);
        if (!hewn_node_is_none(node))
            fail_msg("case %zu was built", i);
        hewn_error first = {0}, later = {0};
        assert_int_equal(hewn_field_status(f, &first), HEWN_INVALID_ARGUMENT);
        assert_true(strlen(first.message) > 5);
        /* What is built from it is none, and the first reason stays. */
        assert_true(hewn_node_is_none(hewn_union(f, node, hewn_sphere(f, 1))));
        assert_true(hewn_node_is_none(hewn_translate(f, node, 1, 2, 3)));
        (void)hewn_torus(f, -1, -1);
        assert_int_equal(hewn_field_status(f, &later), HEWN_INVALID_ARGUMENT);
        assert_string_equal(first.message, later.message);
        assert_int_equal(hewn_field_set_root(f, hewn_x(f), NULL), HEWN_INVALID_ARGUMENT);
        hewn_field_destroy(&f);
    }
}

static void zero_is_fine_where_it_has_a_meaning(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node a = hewn_sphere(f, 1), b = hewn_translate(f, a, 1, 0, 0);
    same(hewn_smooth_union(f, a, b, HEWN_BLEND_QUADRATIC, 0), hewn_union(f, a, b));
    same(hewn_smooth_difference(f, a, b, HEWN_BLEND_CIRCULAR, 0), hewn_difference(f, a, b));
    assert_false(hewn_node_is_none(hewn_rounded_box(f, 1, 2, 3, 0)));
    assert_false(hewn_node_is_none(hewn_rounded_box(f, 1, 2, 3, 0.5)));
    assert_false(hewn_node_is_none(hewn_capsule(f, 1, 0)));
    assert_false(hewn_node_is_none(hewn_cone(f, 1, 0, 2)));
    assert_false(hewn_node_is_none(hewn_plane(f, 1e-200, 0, 0, 2)));
    assert_false(hewn_node_is_none(hewn_plane(f, 1e200, 1e200, 0, 2)));
    assert_field_ok(f);
    hewn_field_destroy(&f);
}

static void roots_and_questions_about_no_node(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_error error = {0};
    assert_true(hewn_node_is_none(hewn_field_root(f)));
    assert_int_equal(hewn_field_set_root(f, HEWN_NODE_NONE, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_field_set_root(f, (hewn_node){hewn_field_node_count(f)}, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_field_set_root(f, hewn_y(f), &error), HEWN_OK);
    same(hewn_field_root(f), hewn_y(f));
    double point[3] = {0}, value[4];
    hewn_interval bounds = {1, 2, false};
    hewn_box box = {{-1, -1, -1}, {1, 1, 1}};
    assert_int_equal(hewn_field_eval(f, HEWN_NODE_NONE, point, 1, value, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_field_gradient(f, HEWN_NODE_NONE, point, 1, value, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_field_bound(f, HEWN_NODE_NONE, &box, &bounds, &error), HEWN_INVALID_ARGUMENT);
    assert_true(bounds.lo == 0 && bounds.hi == 0);
    assert_int_equal(hewn_field_find_box(f, HEWN_NODE_NONE, &box, &error), HEWN_INVALID_ARGUMENT);
    assert_true(box.lo[0] == 0 && box.hi[2] == 0);
    assert_int_equal(hewn_field_size(f, HEWN_NODE_NONE), 0);
    hewn_box turned = {{1, -1, -1}, {-1, 1, 1}};
    assert_int_equal(hewn_field_bound(f, hewn_y(f), &turned, &bounds, &error), HEWN_INVALID_ARGUMENT);
    turned.lo[0] = NAN;
    assert_int_equal(hewn_field_bound(f, hewn_y(f), &turned, &bounds, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_field_eval(f, hewn_y(f), NULL, 0, NULL, &error), HEWN_OK);
    assert_int_equal(hewn_field_status(NULL, &error), HEWN_INVALID_ARGUMENT);
    assert_true(hewn_node_is_none(hewn_x(NULL)));
    hewn_field_destroy(&f);
}

static void live_nodes_are_those_that_matter_in_order(void **state)
{
    (void)state;
    random_state random = {11};
    for (int round = 0; round < effort(200); round++) {
        hewn_field *f = new_field();
        hewn_node root = random_graph(&random, f, 3 + (int)random_below(&random, 197), false);
        uint32_t *ids = NULL;
        size_t count = 0;
        assert_int_equal(hewn_field_live_nodes(f, root, &ids, &count, NULL), HEWN_OK);
        assert_int_equal(count, hewn_field_size(f, root));
        assert_int_equal(ids[count - 1], root.id);
        bool *seen = calloc(hewn_field_node_count(f), sizeof *seen), *used = calloc(hewn_field_node_count(f), 1);
        used[root.id] = true;
        for (size_t i = 0; i < count; i++) {
            const hewn_node_data *node = hewn_field_node(f, ids[i]);
            assert_false(seen[ids[i]]);
            for (int k = 0; k < HEWN_MAX_OPERANDS; k++) {
                if (k < hewn_op_infos[node->op].operands) {
                    assert_true(node->operand[k] < ids[i]);
                    assert_true(seen[node->operand[k]]);
                    used[node->operand[k]] = true;
                } else {
                    assert_int_equal(node->operand[k], 0xFFFFFFFFu);
                }
            }
            seen[ids[i]] = true;
        }
        for (size_t i = 0; i < count; i++)
            assert_true(used[ids[i]]);
        free(seen);
        free(used);
        hewn_free(ids);
        hewn_field_destroy(&f);
    }
}

/* A million nodes in one chain: built, moved, evaluated, bounded and boxed without recursion. */
static void depth_costs_no_stack(void **state)
{
    (void)state;
    const int depth = 1000000;
    hewn_field *f = new_field();
    hewn_node x = hewn_x(f), chain = hewn_sphere(f, 1);
    for (int i = 0; i < depth; i++)
        chain = i % 2 ? hewn_smooth_union(f, chain, hewn_constant(f, 2.0 + i), HEWN_BLEND_QUADRATIC, 0.5)
                      : hewn_max(f, chain, hewn_sub(f, x, hewn_constant(f, 9.0 + i)));
    assert_field_ok(f);
    assert_true(hewn_field_size(f, chain) > (size_t)depth);
    assert_true(fabs(value_at(f, chain, 0.5, 0, 0) + 0.5) < 1e-12);
    hewn_node moved = hewn_translate(f, chain, 3, 0, 0);
    assert_field_ok(f);
    assert_true(fabs(value_at(f, moved, 3.5, 0, 0) + 0.5) < 1e-12);
    double out[4];
    assert_int_equal(hewn_field_gradient(f, moved, (const double[3]){3.5, 0, 0}, 1, out, NULL), HEWN_OK);
    assert_true(out[1] == 1 && out[2] == 0 && out[3] == 0);
    hewn_box box = {{3, -1, -1}, {4, 1, 1}};
    hewn_interval bounds;
    assert_int_equal(hewn_field_bound(f, moved, &box, &bounds, NULL), HEWN_OK);
    assert_true(bounds.lo <= -1 && bounds.lo > -1.1 && bounds.hi >= sqrt(3) - 1);
    hewn_field_destroy(&f);
}

static void long_union_finds_its_box(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    hewn_node all = hewn_sphere(f, 1);
    for (int i = 1; i <= 20000; i++)
        all = hewn_union(f, all, hewn_translate(f, hewn_sphere(f, 1), 0.001 * i, 0, 0));
    hewn_box box;
    assert_int_equal(hewn_field_find_box(f, all, &box, NULL), HEWN_OK);
    assert_true(box.lo[0] <= -1 && box.lo[0] > -1.01 && box.hi[0] >= 21 && box.hi[0] < 21.01);
    hewn_field_destroy(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_expressions_are_one_node),
        cmocka_unit_test(identities_leave_the_operand),
        cmocka_unit_test(constants_fold),
        cmocka_unit_test(nested_transforms_leave_one_row),
        cmocka_unit_test(what_makes_no_sense_is_refused_and_remembered),
        cmocka_unit_test(zero_is_fine_where_it_has_a_meaning),
        cmocka_unit_test(roots_and_questions_about_no_node),
        cmocka_unit_test(live_nodes_are_those_that_matter_in_order),
        cmocka_unit_test(depth_costs_no_stack),
        cmocka_unit_test(long_union_finds_its_box),
    };
    return cmocka_run_group_tests_name("field_graph", tests, NULL, NULL);
}
