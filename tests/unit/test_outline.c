/* Outlines of curves: what overlaps is resolved, what is nearest is found, whatever the curves. */
#include "atlas/colours.h"
#include "test_atlas_support.h"

enum { GRID = 64, UNITS = 1000, PARTS = 400 };

static hewn_bezier random_curve(uint64_t *random, const double *from)
{
    hewn_bezier curve = {.degree = 1 + (unsigned)(atlas_random(random) % 3)};
    for (unsigned k = 0; k <= curve.degree; k++)
        for (int axis = 0; axis < 2; axis++)
            curve.p[k][axis] = floor(atlas_share(random) * UNITS);
    if (from)
        memcpy(curve.p[0], from, sizeof curve.p[0]);
    return curve;
}

/* --- curves --------------------------------------------------------------------------------------------------------
 */

static void sign_changes(void **state)
{
    (void)state;
    uint64_t random = 1;
    for (int round = 0; round < 2000; round++) {
        unsigned degree = 1 + (unsigned)(round % 5);
        double c[6] = {1}, roots[5], found[5];
        for (unsigned k = 0; k < degree; k++) { /* a product of (t - root) */
            roots[k] = 2 * atlas_share(&random) - 0.5;
            for (unsigned i = k + 1; i > 0; i--)
                c[i] = c[i - 1] - roots[k] * c[i];
            c[0] *= -roots[k];
        }
        unsigned inside = 0, count = hewn_sign_changes(c, degree, found);
        double apart = 1;
        for (unsigned k = 0; k < degree; k++) {
            inside += roots[k] > 0 && roots[k] < 1;
            apart = fmin(apart, fmin(fabs(roots[k]), fabs(roots[k] - 1)));
            for (unsigned i = 0; i < k; i++)
                apart = fmin(apart, fabs(roots[k] - roots[i]));
        }
        if (apart < 1e-3) /* two that are nearly one may come or not */
            continue;
        assert_int_equal(count, inside);
        for (unsigned k = 0; k < count; k++) {
            double nearest = 1;
            for (unsigned i = 0; i < degree; i++)
                nearest = fmin(nearest, fabs(roots[i] - found[k]));
            assert_true(nearest < 1e-8);
            assert_true(k == 0 || found[k] > found[k - 1]);
        }
    }
}

static void parts_and_bounds(void **state)
{
    (void)state;
    uint64_t random = 2;
    for (int round = 0; round < 500; round++) {
        hewn_bezier curve = random_curve(&random, NULL);
        double from = atlas_share(&random), to = atlas_share(&random), lo[2] = {1e9, 1e9}, hi[2] = {-1e9, -1e9};
        hewn_bezier part = hewn_bezier_part(&curve, from, to);
        double seen[2][2] = {{1e9, 1e9}, {-1e9, -1e9}};
        hewn_bezier_bound(&curve, lo, hi);
        for (int i = 0; i <= PARTS; i++) {
            double t = (double)i / PARTS, p[2], q[2];
            hewn_bezier_point(&part, t, p);
            hewn_bezier_point(&curve, from + t * (to - from), q);
            assert_true(hypot(p[0] - q[0], p[1] - q[1]) < 1e-9 * UNITS);
            hewn_bezier_point(&curve, t, p);
            for (int axis = 0; axis < 2; axis++) {
                assert_true(p[axis] > lo[axis] - 1e-9 && p[axis] < hi[axis] + 1e-9);
                seen[0][axis] = fmin(seen[0][axis], p[axis]);
                seen[1][axis] = fmax(seen[1][axis], p[axis]);
            }
        }
        for (int axis = 0; axis < 2; axis++)
            assert_true(seen[0][axis] - lo[axis] < 0.1 && hi[axis] - seen[1][axis] < 0.1);
    }
}

/* The distance to one curve against many of its points: these cannot be nearer. */
static void nearest_places(void **state)
{
    (void)state;
    uint64_t random = 3;
    for (int round = 0; round < 1500; round++) {
        hewn_edge edge = {.curve = random_curve(&random, NULL), .colour = HEWN_WHITE};
        hewn_edge_prepare(&edge);
        const hewn_shape shape = {.edges = &edge, .count = 1};
        const double p[2] = {(2 * atlas_share(&random) - 0.5) * UNITS, (2 * atlas_share(&random) - 0.5) * UNITS};
        double least = INFINITY, found = fabs(hewn_shape_distance(&shape, p, 1e9)), reach;
        for (int i = 0; i <= PARTS; i++) {
            double at[2];
            hewn_bezier_point(&edge.curve, (double)i / PARTS, at);
            least = fmin(least, hypot(p[0] - at[0], p[1] - at[1]));
        }
        reach = 3 * hewn_bezier_reach(&edge.curve) / PARTS;
        if (!(found <= least + 1e-9) || !(found >= least - reach))
            fail_msg("degree %u: %.9g, but a point is %.9g away", edge.curve.degree, found, least);
    }
}

/* --- overlaps ------------------------------------------------------------------------------------------------------
 */

/* Closed contours of random curves, which cross one another and themselves. */
static void random_outline(uint64_t *random, hewn_glyph_outline *out)
{
    size_t contours = 1 + atlas_random(random) % 3;
    *out = (hewn_glyph_outline){.curves = malloc(64 * sizeof *out->curves), .room = 64};
    for (size_t c = 0; c < contours; c++) {
        size_t first = out->count, count = 2 + atlas_random(random) % 5;
        for (size_t i = 0; i < count; i++) {
            const double *from = i > 0 ? out->curves[out->count - 1].p[out->curves[out->count - 1].degree] : NULL;
            out->curves[out->count++] = random_curve(random, from);
        }
        hewn_bezier *last = &out->curves[out->count - 1];
        memcpy(last->p[last->degree], out->curves[first].p[0], sizeof last->p[0]);
    }
}

static double to_chord(const double a[2], const double b[2], const double p[2])
{
    double ex = b[0] - a[0], ey = b[1] - a[1], length = ex * ex + ey * ey;
    double t = length > 0 ? fmin(fmax(((p[0] - a[0]) * ex + (p[1] - a[1]) * ey) / length, 0), 1) : 0;
    return hypot(a[0] + t * ex - p[0], a[1] + t * ey - p[1]);
}

/* Winding number and distance by pieces of the curves as they are. */
static bool is_inside(const hewn_glyph_outline *outline, const double p[2], double *distance)
{
    int turns = 0;
    *distance = INFINITY;
    for (size_t i = 0; i < outline->count; i++) {
        const hewn_bezier *curve = &outline->curves[i];
        double a[2], b[2];
        memcpy(a, curve->p[0], sizeof a);
        for (int k = 1; k <= PARTS; k++) {
            if (k == PARTS)
                memcpy(b, curve->p[curve->degree], sizeof b);
            else
                hewn_bezier_point(curve, (double)k / PARTS, b);
            *distance = fmin(*distance, to_chord(a, b, p));
            double cross = (a[0] - p[0]) * (b[1] - p[1]) - (a[1] - p[1]) * (b[0] - p[0]);
            if ((a[1] <= p[1]) != (b[1] <= p[1]))
                turns += a[1] <= p[1] ? cross > 0 : -(cross < 0);
            memcpy(a, b, sizeof a);
        }
    }
    return turns != 0;
}

static void check_contours(const hewn_glyph_outline *outline)
{
    size_t begin = 0;
    for (size_t c = 0; c < outline->contours; begin = outline->ends[c++])
        for (size_t i = begin; i < outline->ends[c]; i++) {
            const hewn_bezier *one = &outline->curves[i];
            const hewn_bezier *next = &outline->curves[i + 1 < outline->ends[c] ? i + 1 : begin];
            assert_memory_equal(one->p[one->degree], next->p[0], sizeof one->p[0]);
        }
    assert_int_equal(begin, outline->count);
}

/* Every curve that is left is a border: inside on its left, outside on its right. */
static void check_borders(const hewn_glyph_outline *raw, const hewn_glyph_outline *resolved)
{
    for (size_t i = 0; i < resolved->count; i++) {
        const hewn_bezier *curve = &resolved->curves[i];
        double at[2], along[2], distance;
        if (hewn_bezier_reach(curve) < 3)
            continue;
        hewn_bezier_point(curve, 0.5, at);
        hewn_bezier_direction(curve, 0.5, along);
        for (int side = -1; side <= 1; side += 2) {
            const double p[2] = {at[0] - side * along[1], at[1] + side * along[0]};
            bool inside = is_inside(raw, p, &distance);
            if (distance > 0.999 && inside != (side > 0)) /* nothing else is near */
                fail_msg("a curve at %g, %g is no border", at[0], at[1]);
        }
    }
}

/* How many ends of curves lie on the raw curves to the last digits, and not only on the grid. */
static size_t count_exact(const hewn_glyph_outline *raw, const hewn_glyph_outline *resolved)
{
    hewn_edge edges[64];
    const hewn_shape shape = {.edges = edges, .count = raw->count};
    size_t exact = 0;
    for (size_t i = 0; i < raw->count; i++) {
        edges[i] = (hewn_edge){.curve = raw->curves[i], .colour = HEWN_WHITE};
        hewn_edge_prepare(&edges[i]);
    }
    for (size_t i = 0; i < resolved->count; i++)
        exact += fabs(hewn_shape_distance(&shape, resolved->curves[i].p[0], 1e9)) < 1e-9 * UNITS;
    return exact;
}

static void overlaps(void **state)
{
    (void)state;
    uint64_t random = 4;
    int rounds = getenv("HEWN_LONG") ? 1000 : 40, near = 0;
    size_t exact = 0, ends = 0;
    for (int round = 0; round < rounds; round++) {
        hewn_glyph_outline raw, resolved = {0};
        hewn_shape shape;
        hewn_error error = {0};
        random_outline(&random, &raw);
        random_outline(&random, &resolved);
        memcpy(resolved.curves, raw.curves, raw.count * sizeof *raw.curves);
        resolved.count = raw.count;
        if (hewn_glyph_outline_resolve(&resolved, GRID, UNITS, &error) != HEWN_OK)
            fail_msg("%s", error.message);
        check_contours(&resolved);
        check_borders(&raw, &resolved);
        exact += count_exact(&raw, &resolved);
        ends += resolved.count;
        assert_int_equal(hewn_shape_create(&resolved, 1, (const double[2]){0, 0}, 0.14, &shape, NULL), HEWN_OK);
        for (int i = 0; i < 200; i++) {
            const double p[2] = {(1.4 * atlas_share(&random) - 0.2) * UNITS,
                                 (1.4 * atlas_share(&random) - 0.2) * UNITS};
            double to_raw, own = hewn_shape_distance(&shape, p, 1e9);
            bool inside = is_inside(&raw, p, &to_raw);
            near += to_raw <= 1;
            if (to_raw > 1 && inside != (own > 0))
                fail_msg("round %d: %g, %g is %s, but %g is told", round, p[0], p[1], inside ? "inside" : "outside",
                         own);
            assert_true(fabs(own) > to_raw - 5); /* no border where there is no curve */
        }
        hewn_shape_clear(&shape);
        hewn_glyph_outline_clear(&raw);
        hewn_glyph_outline_clear(&resolved);
    }
    assert_true(near < 20 * rounds);
    if (10 * exact < 9 * ends) /* the others are where curves hardly cross */
        fail_msg("only %zu of %zu ends are where curves meet", exact, ends);
}

/* Neighbours at a corner share exactly one colour, and each colour is on each contour. */
static void colours(void **state)
{
    (void)state;
    uint64_t random = 5;
    int checked = 0;
    for (int round = 0; round < 150; round++) {
        hewn_glyph_outline raw;
        hewn_shape shape;
        random_outline(&random, &raw);
        assert_int_equal(hewn_glyph_outline_resolve(&raw, GRID, UNITS, NULL), HEWN_OK);
        assert_int_equal(hewn_shape_create(&raw, 1, (const double[2]){0, 0}, 0.14, &shape, NULL), HEWN_OK);
        assert_true(shape.count == raw.count || raw.contours > 0);
        checked += shape.count == raw.count; /* else a contour of one corner was divided */
        size_t begin = 0;
        for (size_t c = 0; c < raw.contours && shape.count == raw.count; begin = raw.ends[c++]) {
            unsigned all = 0;
            for (size_t i = begin; i < raw.ends[c]; i++) {
                const hewn_edge *one = &shape.edges[i], *next = &shape.edges[i + 1 < raw.ends[c] ? i + 1 : begin];
                const double *in = one->ends[1], *out = next->ends[0];
                double turn = atan2(fabs(in[0] * out[1] - in[1] * out[0]), in[0] * out[0] + in[1] * out[1]);
                unsigned shared = one->colour & next->colour;
                assert_true(turn < 0.14 || shared == HEWN_RED || shared == HEWN_GREEN || shared == HEWN_BLUE);
                all |= one->colour;
            }
            assert_int_equal(all, HEWN_WHITE);
        }
        hewn_shape_clear(&shape);
        hewn_glyph_outline_clear(&raw);
    }
    assert_true(checked > 50);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sign_changes), cmocka_unit_test(parts_and_bounds), cmocka_unit_test(nearest_places),
        cmocka_unit_test(overlaps),     cmocka_unit_test(colours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
