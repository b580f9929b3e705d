/* Values and gradients: every operation against C, shapes against brute force, blends against their definition, moved
 * shapes against moved points. */
#include "test_field_support.h"

static double reference(hewn_op op, const double *p, double a, double b, double c)
{
    switch (op) {
    case HEWN_OP_NEG: return -a;
    case HEWN_OP_ABS: return fabs(a);
    case HEWN_OP_SQRT: return sqrt(a);
    case HEWN_OP_SQUARE: return a * a;
    case HEWN_OP_SIN: return sin(a);
    case HEWN_OP_COS: return cos(a);
    case HEWN_OP_TAN: return tan(a);
    case HEWN_OP_ASIN: return asin(a);
    case HEWN_OP_ACOS: return acos(a);
    case HEWN_OP_ATAN: return atan(a);
    case HEWN_OP_EXP: return exp(a);
    case HEWN_OP_LN: return log(a);
    case HEWN_OP_FLOOR: return floor(a);
    case HEWN_OP_CEIL: return ceil(a);
    case HEWN_OP_ROUND: return a < 0 ? -floor(-a + 0.5) : floor(a + 0.5);
    case HEWN_OP_NOT: return a == 0;
    case HEWN_OP_ADD: return a + b;
    case HEWN_OP_SUB: return a - b;
    case HEWN_OP_MUL: return a * b;
    case HEWN_OP_DIV: return a / b;
    case HEWN_OP_MIN: return isnan(a) || isnan(b) ? NAN : fmin(a, b);
    case HEWN_OP_MAX: return isnan(a) || isnan(b) ? NAN : fmax(a, b);
    case HEWN_OP_MOD: return a - fabs(b) * floor(a / fabs(b));
    case HEWN_OP_ATAN2: return atan2(a, b);
    case HEWN_OP_COMPARE: return isnan(a) || isnan(b) ? NAN : a < b ? -1 : a > b ? 1 : 0;
    case HEWN_OP_AND: return a == 0 ? a : b;
    case HEWN_OP_OR: return a != 0 ? a : b;
    case HEWN_OP_AFFINE: return ((p[0] * a + p[1] * b) + p[2] * c) + p[3];
    default: return NAN;
    }
}

static bool same_value(double a, double b)
{
    return a == b || (isnan(a) && isnan(b));
}

/* Operations straight on the variables, so that any argument can be given. */
static hewn_node bare(hewn_field *field, hewn_op op, const double *parameter)
{
    hewn_node_data data = {.op = op, .operand = {0, 1, 2}};
    memcpy(data.parameter, parameter, sizeof data.parameter);
    return hewn_field_add_node(field, &data);
}

static void operations_are_those_of_c(void **state)
{
    (void)state;
    random_state random = {1};
    static const double tame[] = {0.0, -0.0, 1, -1, 0.5, -0.5, 1.5, -1.5, 2.5, -2.5, 3, -3, 7.25};
    enum { TAME = sizeof tame / sizeof *tame };
    for (hewn_op op = HEWN_OP_NEG; op <= HEWN_OP_AFFINE; op++) {
        hewn_field *f = new_field();
        double p[4] = {1.5, -2, 0.25, 3};
        hewn_node node = bare(f, op, p);
        assert_field_ok(f);
        for (int i = 0; i < 4000; i++) {
            double a = tame[i % TAME], b = tame[i / TAME % TAME], c = random_between(&random, -3, 3);
            if (i > TAME * TAME) {
                a = random_awkward(&random);
                b = random_awkward(&random);
                if (op == HEWN_OP_MOD || op == HEWN_OP_ROUND)
                    continue; /* the plain formulas above lose digits out there */
            }
            double got = value_at(f, node, a, b, c), wanted = reference(op, p, a, b, c);
            if (!same_value(got, wanted) && !(op == HEWN_OP_MOD && fabs(got - wanted) < 1e-12))
                fail_msg("%s(%a, %a, %a) is %a, not %a", hewn_op_infos[op].name, a, b, c, got, wanted);
        }
        hewn_field_destroy(&f);
    }
}

static void mod_is_euclidean_and_halves_round_away(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    random_state random = {2};
    hewn_node mod = hewn_mod(f, hewn_x(f), hewn_y(f)), round_x = hewn_round(f, hewn_x(f));
    for (int i = 0; i < 20000; i++) {
        double a = random_between(&random, -50, 50), b = random_between(&random, -5, 5);
        double rest = value_at(f, mod, a, b, 0);
        assert_true(rest >= 0 && rest <= fabs(b));
        double turns = (a - rest) / b;
        assert_true(fabs(turns - round(turns)) < 1e-9 * (1 + fabs(turns)));
    }
    assert_true(isnan(value_at(f, mod, 1, 0, 0)));
    assert_true(value_at(f, round_x, 0.5, 0, 0) == 1 && value_at(f, round_x, -0.5, 0, 0) == -1);
    assert_true(value_at(f, round_x, 2.5, 0, 0) == 3 && value_at(f, round_x, 0x1.fffffffffffffp-2, 0, 0) == 0);
    hewn_field_destroy(&f);
}

static void names_and_infos_match(void **state)
{
    (void)state;
    assert_string_equal(hewn_op_infos[HEWN_OP_X].name, "x");
    assert_string_equal(hewn_op_infos[HEWN_OP_BLEND_EXPONENTIAL].name, "blend_exponential");
    assert_int_equal(hewn_op_infos[HEWN_OP_AFFINE].operands, 3);
    assert_int_equal(hewn_op_infos[HEWN_OP_ROUNDED_BOX].parameters, 4);
}

/* --- shapes --------------------------------------------------------------------------------------------------------
 */

/* Whether a point is in a shape, by its plain description (half sizes as in the node). */
static bool inside(hewn_op op, const double *p, const double *at)
{
    double x = at[0], y = at[1], z = at[2], r = hypot(x, z);
    switch (op) {
    case HEWN_OP_SPHERE: return x * x + y * y + z * z <= p[0] * p[0];
    case HEWN_OP_BOX: return fabs(x) <= p[0] && fabs(y) <= p[1] && fabs(z) <= p[2];
    case HEWN_OP_ROUNDED_BOX: {
        double dx = fmax(fabs(x) - p[0], 0), dy = fmax(fabs(y) - p[1], 0), dz = fmax(fabs(z) - p[2], 0);
        return dx * dx + dy * dy + dz * dz <= p[3] * p[3];
    }
    case HEWN_OP_TORUS: return hypot(r - p[0], y) <= p[1];
    case HEWN_OP_CYLINDER: return r <= p[0] && fabs(y) <= p[1];
    case HEWN_OP_CAPSULE: return hypot(r, fmax(fabs(y) - p[1], 0)) <= p[0];
    case HEWN_OP_CONE: return fabs(y) <= p[2] && r <= p[0] + (p[1] - p[0]) * (y + p[2]) / (2 * p[2]);
    default: return p[0] * x + p[1] * y + p[2] * z <= p[3];
    }
}

/* The distance to the surface along a direction, or infinity: steps, then bisection. */
static double ray_to_surface(hewn_op op, const double *p, const double *from, const double *direction, double reach)
{
    bool start = inside(op, p, from);
    double before = 0, step = reach / 400;
    for (double t = step; t <= reach; t += step) {
        double at[3] = {from[0] + t * direction[0], from[1] + t * direction[1], from[2] + t * direction[2]};
        if (inside(op, p, at) != start) {
            double lo = before, hi = t;
            for (int i = 0; i < 50; i++) {
                double mid = 0.5 * (lo + hi);
                double point[3] = {from[0] + mid * direction[0], from[1] + mid * direction[1],
                                   from[2] + mid * direction[2]};
                *(inside(op, p, point) == start ? &lo : &hi) = mid;
            }
            return hi;
        }
        before = t;
    }
    return INFINITY;
}

/* No point of the other side is nearer than the value says, and one is as near: the gradient leads to it. */
static void shapes_are_exact_distances(void **state)
{
    (void)state;
    random_state random = {3};
    for (hewn_op op = HEWN_OP_SPHERE; op <= HEWN_OP_PLANE; op++)
        for (int round = 0; round < effort(60); round++) {
            hewn_field *f = new_field();
            double p[4];
            random_parameters(&random, op, p);
            if (op == HEWN_OP_TORUS && p[1] > p[0])
                p[1] = 0.5 * p[0]; /* one that meets itself is exact outside only */
            hewn_node node = bare(f, op, p);
            double at[3], out[4];
            for (int i = 0; i < 3; i++)
                at[i] = random_between(&random, -3, 3);
            if (round % 5 == 0)
                at[random_below(&random, 3)] = 0.3;
            assert_int_equal(hewn_field_gradient(f, node, at, 1, out, NULL), HEWN_OK);
            double distance = fabs(out[0]);
            if (inside(op, p, at) != (out[0] <= 0) && distance > 1e-9)
                fail_msg("%s has the wrong sign at (%g, %g, %g)", hewn_op_infos[op].name, at[0], at[1], at[2]);
            double nearest = INFINITY;
            for (int ray = 0; ray < 40; ray++) {
                double d[3] = {random_between(&random, -1, 1), random_between(&random, -1, 1),
                               random_between(&random, -1, 1)};
                double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                for (int i = 0; i < 3; i++)
                    d[i] /= length;
                nearest = fmin(nearest, ray_to_surface(op, p, at, d, distance + 0.05));
            }
            double sign = out[0] > 0 ? -1 : 1;
            double down[3] = {sign * out[1], sign * out[2], sign * out[3]};
            assert_true(fabs(sqrt(down[0] * down[0] + down[1] * down[1] + down[2] * down[2]) - 1) < 1e-9);
            double straight = ray_to_surface(op, p, at, down, distance * 1.01 + 1e-6);
            /* Past a rim of less than a right angle the line may miss the inside that lies just behind it. */
            double behind[3];
            for (int i = 0; i < 3; i++)
                behind[i] = (at[i] + distance * down[i]) * (1 - 1e-7);
            if (op == HEWN_OP_CONE && out[0] > 0 && inside(op, p, behind))
                straight = distance;
            if (nearest < distance - 1e-9 || fabs(straight - distance) > 1e-6 * (1 + distance))
                fail_msg("%s says %.9g, the surface is %.9g away, %.9g along the gradient", hewn_op_infos[op].name,
                         out[0], nearest, straight);
            hewn_field_destroy(&f);
        }
}

static void builders_take_full_sizes(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    assert_true(value_at(f, hewn_sphere(f, 2), 3, 0, 0) == 1);
    assert_true(value_at(f, hewn_box_shape(f, 2, 4, 6), 0, 0, 5) == 2);
    assert_true(value_at(f, hewn_box_shape(f, 2, 4, 6), 0, 3, 0) == 1);
    assert_true(fabs(value_at(f, hewn_rounded_box(f, 2, 4, 6, 0.25), 2, 0, 0) - 1) < 1e-15);
    assert_true(value_at(f, hewn_torus(f, 2, 0.5), 0, 0, 2) == -0.5);
    assert_true(value_at(f, hewn_cylinder(f, 1, 4), 0, 5, 0) == 3);
    assert_true(value_at(f, hewn_capsule(f, 1, 4), 0, 5, 0) == 2);
    assert_true(fabs(value_at(f, hewn_cone(f, 1, 0, 2), 0, 2, 0) - 1) < 1e-15);
    assert_true(value_at(f, hewn_cone(f, 2, 1, 2), 1, -2, 0) == 1);
    assert_true(value_at(f, hewn_plane(f, 0, 5, 0, 2), 7, 3, 7) == 1);
    assert_field_ok(f);
    hewn_field_destroy(&f);
}

/* --- blends --------------------------------------------------------------------------------------------------------
 */

static double blend_reference(hewn_blend blend, double k, double a, double b)
{
    double h = fmax(k - fabs(a - b), 0);
    switch (blend) {
    case HEWN_BLEND_QUADRATIC: return fmin(a, b) - h * h / (4 * k);
    case HEWN_BLEND_CUBIC: return fmin(a, b) - h * h * h / (6 * k * k);
    case HEWN_BLEND_EXPONENTIAL: return -log(exp(-k * a) + exp(-k * b)) / k;
    default: /* the arc around (k, k) that touches a = 0 and b = 0, moved along the diagonal (see the fillet's test) */
        return h == 0 ? fmin(a, b) : 0.5 * (a + b) - k + sqrt(0.5 * k * k - 0.25 * (a - b) * (a - b));
    }
}

static void blends_are_their_formulas(void **state)
{
    (void)state;
    random_state random = {4};
    for (int blend = HEWN_BLEND_QUADRATIC; blend <= HEWN_BLEND_EXPONENTIAL; blend++) {
        for (int i = 0; i < 3000; i++) {
            hewn_field *f = new_field();
            double k = random_between(&random, 0.05, 2);
            double a = random_between(&random, -2, 2), b = random_between(&random, -2, 2);
            hewn_node x = hewn_x(f), y = hewn_y(f);
            double sum = value_at(f, hewn_smooth_union(f, x, y, (hewn_blend)blend, k), a, b, 0);
            assert_true(fabs(sum - blend_reference((hewn_blend)blend, k, a, b)) < 1e-12);
            double meet = value_at(f, hewn_smooth_intersection(f, x, y, (hewn_blend)blend, k), a, b, 0);
            double cut = value_at(f, hewn_smooth_difference(f, x, y, (hewn_blend)blend, k), a, b, 0);
            double mirrored = value_at(f, hewn_smooth_union(f, x, y, (hewn_blend)blend, k), -a, -b, 0);
            double mixed = value_at(f, hewn_smooth_union(f, x, y, (hewn_blend)blend, k), -a, b, 0);
            assert_true(meet == -mirrored && cut == -mixed);
            assert_true(sum <= fmin(a, b) && meet >= fmax(a, b));
            hewn_field_destroy(&f);
        }
    }
}

/* Two planes at right angles: the circular blend's zero set is the arc of the asked radius that touches both. */
static void circular_blend_is_a_fillet_of_its_radius(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    const double radius = 0.7;
    hewn_node node = hewn_smooth_union(f, hewn_x(f), hewn_y(f), HEWN_BLEND_CIRCULAR, radius);
    for (int i = 0; i <= 100; i++) {
        double angle = M_PI + M_PI_2 * i / 100;
        double x = radius + radius * cos(angle), y = radius + radius * sin(angle);
        assert_true(fabs(value_at(f, node, x, y, 0)) < 1e-12);
    }
    assert_true(value_at(f, node, 0, radius * 1.01, 0) == 0); /* beyond the arc, the plane */
    hewn_field_destroy(&f);
}

static void blends_survive_far_operands(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    for (int blend = HEWN_BLEND_QUADRATIC; blend <= HEWN_BLEND_EXPONENTIAL; blend++) {
        hewn_node node = hewn_smooth_union(f, hewn_x(f), hewn_y(f), (hewn_blend)blend, 2);
        assert_true(value_at(f, node, 1e300, -1e300, 0) == -1e300);
        assert_true(value_at(f, node, INFINITY, INFINITY, 0) == INFINITY);
        assert_true(value_at(f, node, INFINITY, 3, 0) == 3);
        assert_true(value_at(f, node, -INFINITY, INFINITY, 0) == -INFINITY);
        assert_true(isnan(value_at(f, node, NAN, 3, 0)) && isnan(value_at(f, node, 3, NAN, 0)));
        assert_true(fabs(value_at(f, node, 1e6, 1e6, 0) - 1e6) < 2);
    }
    hewn_field_destroy(&f);
}

/* --- gradients -----------------------------------------------------------------------------------------------------
 */

/* Where two step sizes agree on the slope, it is the gradient's. */
static void check_gradient(const hewn_field *f, hewn_node node, const double *at, int *checked)
{
    double out[4];
    assert_int_equal(hewn_field_gradient(f, node, at, 1, out, NULL), HEWN_OK);
    assert_true(same_value(out[0], value_at(f, node, at[0], at[1], at[2])));
    for (int axis = 0; axis < 3; axis++) {
        double slope[3];
        for (int k = 0; k < 3; k++) {
            double h = 1e-5 / (1 << 2 * k), lo[3], hi[3];
            memcpy(lo, at, sizeof lo);
            memcpy(hi, at, sizeof hi);
            lo[axis] -= h;
            hi[axis] += h;
            slope[k] = (value_at(f, node, hi[0], hi[1], hi[2]) - value_at(f, node, lo[0], lo[1], lo[2])) / (2 * h);
        }
        double scale = 1 + fabs(slope[2]) + 1e-3 * fabs(out[0]);
        bool settled = fabs(slope[0] - slope[1]) < 1e-5 * scale && fabs(slope[1] - slope[2]) < 1e-5 * scale;
        if (!settled || !isfinite(slope[2]) || scale > 1e4)
            continue;
        ++*checked;
        if (!(fabs(out[1 + axis] - slope[2]) < 1e-3 * scale))
            fail_msg("%s at (%.17g, %.17g, %.17g) along %c: %.9g, differences say %.9g",
                     hewn_op_infos[hewn_field_node(f, node.id)->op].name, at[0], at[1], at[2], "xyz"[axis],
                     out[1 + axis], slope[2]);
    }
}

static void gradients_are_slopes(void **state)
{
    (void)state;
    random_state random = {5};
    for (hewn_op op = HEWN_OP_X; op < HEWN_OP_COUNT; op++) {
        int checked = 0;
        if (hewn_op_is_link(op))
            continue;
        for (int round = 0; round < effort(300); round++) {
            hewn_field *f = new_field();
            double p[4];
            random_parameters(&random, op, p);
            /* Operands that are no bare variables, so that the chain rule has something to do. */
            hewn_node data[3];
            for (int i = 0; i < 3; i++) {
                hewn_node axis[3] = {hewn_x(f), hewn_y(f), hewn_z(f)};
                data[i] = hewn_add(f, hewn_mul(f, axis[i], hewn_constant(f, 0.7)), hewn_square(f, axis[(i + 1) % 3]));
            }
            hewn_node_data node = {.op = op, .operand = {data[0].id, data[1].id, data[2].id}};
            memcpy(node.parameter, p, sizeof p);
            hewn_node built = hewn_field_add_node(f, &node);
            assert_field_ok(f);
            double at[3];
            for (int i = 0; i < 3; i++)
                at[i] = random_between(&random, -1.5, 1.5);
            check_gradient(f, built, at, &checked);
            hewn_field_destroy(&f);
        }
        if (checked < effort(300))
            fail_msg("%s was hardly checked (%d)", hewn_op_infos[op].name, checked);
    }
}

static void gradients_of_graphs_are_slopes(void **state)
{
    (void)state;
    random_state random = {6};
    int checked = 0;
    for (int round = 0; round < effort(300); round++) {
        hewn_field *f = new_field();
        hewn_node root = random_graph(&random, f, 5 + (int)random_below(&random, 30), true);
        double at[3] = {random_between(&random, -2, 2), random_between(&random, -2, 2), random_between(&random, -2, 2)};
        check_gradient(f, root, at, &checked);
        hewn_field_destroy(&f);
    }
    assert_true(checked > effort(300));
}

static void ties_take_the_first_operand(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    double out[4];
    const double at[3] = {0.5, 0.5, 0};
    hewn_field_gradient(f, hewn_min(f, hewn_x(f), hewn_y(f)), at, 1, out, NULL);
    assert_true(out[1] == 1 && out[2] == 0);
    hewn_field_gradient(f, hewn_max(f, hewn_y(f), hewn_x(f)), at, 1, out, NULL);
    assert_true(out[1] == 0 && out[2] == 1);
    /* A centre and an axis have no gradient, but no NaN either; a face has its own. */
    const double centre[3] = {0, 0, 0}, face[3] = {0.5, 0.1, 0.1};
    hewn_node shapes[] = {
        hewn_sphere(f, 1),       hewn_torus(f, 1, 0.2),      hewn_cylinder(f, 1, 1),           hewn_capsule(f, 1, 1),
        hewn_cone(f, 1, 0.5, 1), hewn_box_shape(f, 1, 1, 1), hewn_rounded_box(f, 1, 1, 1, 0.1)};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        hewn_field_gradient(f, shapes[i], centre, 1, out, NULL);
        assert_true(isfinite(out[1]) && isfinite(out[2]) && isfinite(out[3]));
    }
    hewn_field_gradient(f, hewn_box_shape(f, 1, 1, 1), face, 1, out, NULL);
    assert_true(out[0] == 0 && out[1] == 1 && out[2] == 0 && out[3] == 0);
    hewn_field_destroy(&f);
}

/* --- moving --------------------------------------------------------------------------------------------------------
 */

static void moved_shapes_are_shapes_at_moved_points(void **state)
{
    (void)state;
    random_state random = {7};
    for (int round = 0; round < effort(200); round++) {
        hewn_field *f = new_field();
        hewn_node shape = random_graph(&random, f, 4 + (int)random_below(&random, 40), true);
        double q[3] = {random_between(&random, -1, 1), random_between(&random, -1, 1), random_between(&random, -1, 1)};
        double t[3] = {random_between(&random, -1, 1), random_between(&random, -1, 1), random_between(&random, -1, 1)};
        double s = random_between(&random, 0.3, 3);
        double plain = value_at(f, shape, q[0], q[1], q[2]);
        double moved = value_at(f, hewn_translate(f, shape, t[0], t[1], t[2]), q[0] + t[0], q[1] + t[1], q[2] + t[2]);
        double scaled = value_at(f, hewn_scale(f, shape, s), s * q[0], s * q[1], s * q[2]);
        double least = fmin(s, fmin(2 * s, 3 * s));
        double stretched = value_at(f, hewn_stretch(f, shape, 2 * s, s, 3 * s), 2 * s * q[0], s * q[1], 3 * s * q[2]);
        /* A turn about z by the right-hand rule takes x towards y. */
        double angle = random_between(&random, -4, 4), c = cos(angle), n = sin(angle);
        double turned =
            value_at(f, hewn_rotate(f, shape, 0, 0, 2, angle), c * q[0] - n * q[1], n * q[0] + c * q[1], q[2]);
        assert_field_ok(f);
        double out[4];
        hewn_field_gradient(f, shape, q, 1, out, NULL);
        double slope = fabs(out[1]) + fabs(out[2]) + fabs(out[3]);
        double allowed = 1e-7 * (1 + fabs(plain) + (isfinite(slope) ? slope : 0));
        if (!(fabs(plain) < 1e6) || !(slope < 1e4))
            goto next; /* steep graphs make differences of rounding visible */
        if (fabs(moved - plain) > allowed || fabs(scaled - s * plain) > s * allowed ||
            fabs(stretched - least * plain) > s * allowed || fabs(turned - plain) > allowed)
            fail_msg("round %d: %.12g moved %.12g scaled %.12g stretched %.12g turned %.12g", round, plain, moved,
                     scaled / s, stretched / least, turned);
    next:
        hewn_field_destroy(&f);
    }
}

static void remap_is_substitution(void **state)
{
    (void)state;
    random_state random = {8};
    for (int round = 0; round < effort(200); round++) {
        hewn_field *f = new_field();
        hewn_node shape = random_graph(&random, f, 4 + (int)random_below(&random, 196), round % 2 == 0);
        hewn_node x = random_graph(&random, f, 8, true), y = random_graph(&random, f, 8, true);
        hewn_node z = hewn_add(f, hewn_z(f), hewn_constant(f, 0.25));
        hewn_node both = hewn_remap(f, shape, x, y, z);
        assert_field_ok(f);
        for (int i = 0; i < 10; i++) {
            double at[3] = {random_between(&random, -2, 2), random_between(&random, -2, 2),
                            random_between(&random, -2, 2)};
            double there[3] = {value_at(f, x, at[0], at[1], at[2]), value_at(f, y, at[0], at[1], at[2]),
                               value_at(f, z, at[0], at[1], at[2])};
            double wanted = value_at(f, shape, there[0], there[1], there[2]);
            double got = value_at(f, both, at[0], at[1], at[2]);
            double out[4];
            hewn_field_gradient(f, shape, there, 1, out, NULL);
            double slope = fabs(out[1]) + fabs(out[2]) + fabs(out[3]);
            bool tame = fabs(wanted) < 1e6 && slope < 1e3;
            /* Rows multiplied out round differently; where the graph is not steep that stays small. */
            if (round % 2 == 0 && tame && !(fabs(got - wanted) <= 1e-6 * (1 + fabs(wanted))))
                fail_msg("round %d: %.17g, not %.17g", round, got, wanted);
        }
        hewn_field_destroy(&f);
    }
}

static void batches_do_not_matter(void **state)
{
    (void)state;
    random_state random = {9};
    hewn_field *f = new_field();
    hewn_node root = random_graph(&random, f, 100, false);
    enum { COUNT = 333 };
    double points[3 * COUNT], all[COUNT];
    for (int i = 0; i < 3 * COUNT; i++)
        points[i] = random_between(&random, -2, 2);
    assert_int_equal(hewn_field_eval(f, root, points, COUNT, all, NULL), HEWN_OK);
    for (int i = 0; i < COUNT; i++)
        assert_true(same_value(all[i], value_at(f, root, points[3 * i], points[3 * i + 1], points[3 * i + 2])));
    hewn_field_destroy(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(operations_are_those_of_c),
        cmocka_unit_test(mod_is_euclidean_and_halves_round_away),
        cmocka_unit_test(names_and_infos_match),
        cmocka_unit_test(shapes_are_exact_distances),
        cmocka_unit_test(builders_take_full_sizes),
        cmocka_unit_test(blends_are_their_formulas),
        cmocka_unit_test(circular_blend_is_a_fillet_of_its_radius),
        cmocka_unit_test(blends_survive_far_operands),
        cmocka_unit_test(gradients_are_slopes),
        cmocka_unit_test(gradients_of_graphs_are_slopes),
        cmocka_unit_test(ties_take_the_first_operand),
        cmocka_unit_test(moved_shapes_are_shapes_at_moved_points),
        cmocka_unit_test(remap_is_substitution),
        cmocka_unit_test(batches_do_not_matter),
    };
    return cmocka_run_group_tests_name("field_eval", tests, NULL, NULL);
}
