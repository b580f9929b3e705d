/* Hausdorff distances: known ones, bounds against samples, and what is refused. */
#include "hewn/distance.h"
#include "test_smooth_support.h"

static hewn_distance measure(const hewn_model *a, const hewn_model *b)
{
    hewn_error error = {0};
    hewn_distance out;
    const hewn_polygons one = hewn_model_polygons(a), two = hewn_model_polygons(b);
    if (hewn_polygons_distance(&one, &two, NULL, &out, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return out;
}

static void assert_bounds(double low, double high, double truth)
{
    assert_true(low <= truth * (1 + 1e-12));
    assert_true(high >= truth * (1 - 1e-12));
    assert_true(high - low <= 0.0101 * high + 1e-5);
}

/* The distance to the nearest triangle by looking at all, each by its own plane and edges. */
static double nearest(const hewn_model *model, const double at[3])
{
    double least = INFINITY;
    for (uint64_t f = 0; f < model->face_count; f++) {
        const double *p[3];
        double u[3], v[3], w[3];
        for (size_t k = 0; k < 3; k++)
            p[k] = model->positions + 3 * (size_t)model->corners[3 * f + k];
        for (int k = 0; k < 3; k++) {
            u[k] = p[1][k] - p[0][k];
            v[k] = p[2][k] - p[0][k];
            w[k] = at[k] - p[0][k];
        }
        double uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2], vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        double uv = u[0] * v[0] + u[1] * v[1] + u[2] * v[2], uw = u[0] * w[0] + u[1] * w[1] + u[2] * w[2];
        double vw = v[0] * w[0] + v[1] * w[1] + v[2] * w[2], whole = uu * vv - uv * uv;
        double s = (vv * uw - uv * vw) / whole, t = (uu * vw - uv * uw) / whole;
        if (whole > 0 && s >= 0 && t >= 0 && s + t <= 1) {
            double on[3] = {p[0][0] + s * u[0] + t * v[0], p[0][1] + s * u[1] + t * v[1],
                            p[0][2] + s * u[2] + t * v[2]};
            least = fmin(least, distance(at, on));
        }
        for (int side = 0; side < 3; side++) {
            const double *a = p[side], *b = p[(side + 1) % 3];
            double along = 0, square = 0, on[3];
            for (int k = 0; k < 3; k++) {
                along += (at[k] - a[k]) * (b[k] - a[k]);
                square += (b[k] - a[k]) * (b[k] - a[k]);
            }
            double share = square > 0 ? fmax(0, fmin(1, along / square)) : 0;
            for (int k = 0; k < 3; k++)
                on[k] = a[k] + share * (b[k] - a[k]);
            least = fmin(least, distance(at, on));
        }
    }
    return least;
}

/* The greatest of many points: never above the truth. */
static double sample(const hewn_model *from, const hewn_model *to, random_state *random, int count)
{
    double most = 0;
    for (uint64_t f = 0; f < from->face_count; f++)
        for (int i = 0; i < count; i++) {
            double s = i < 3 ? i == 1 : random_unit(random), t = i < 3 ? i == 2 : random_unit(random), at[3];
            if (s + t > 1) {
                s = 1 - s;
                t = 1 - t;
            }
            for (size_t k = 0; k < 3; k++) {
                const double *p = from->positions;
                const uint32_t *c = from->corners + 3 * f;
                at[k] =
                    (1 - s - t) * p[3 * (size_t)c[0] + k] + s * p[3 * (size_t)c[1] + k] + t * p[3 * (size_t)c[2] + k];
            }
            most = fmax(most, nearest(to, at));
        }
    return most;
}

static void test_samples_are_within_bounds(void **state)
{
    (void)state;
    random_state random = {1};
    for (int i = 0; i < 60; i++) {
        hewn_model a = make_soup(&random), b = make_soup(&random);
        if (a.face_count > 0 && b.face_count > 0) {
            if (i % 2) { /* near each other */
                hewn_model_destroy(&b);
                b = make_sphere(3, 1);
                hewn_model_destroy(&a);
                a = make_sphere(2 + i % 5u, 1);
                add_noise(&a, 0.05, &random);
            }
            const hewn_distance out = measure(&a, &b);
            const double there = sample(&a, &b, &random, 40), back = sample(&b, &a, &random, 40);
            assert_true(there <= out.there * (1 + 1e-12));
            assert_true(back <= out.back * (1 + 1e-12));
            assert_true(out.there_low <= out.there && out.back_low <= out.back);
            assert_true(out.high == fmax(out.there, out.back));
            assert_true(out.low == fmax(out.there_low, out.back_low));
            assert_true(out.high - out.low <= 0.0101 * out.high + 1e-5 * out.high);
            assert_true(there >= 0.5 * out.there_low); /* samples see most of it */
        }
        hewn_model_destroy(&a);
        hewn_model_destroy(&b);
    }
}

static hewn_model make_square(double side, double height, uint32_t n)
{
    hewn_model model = make_model((n + 1ull) * (n + 1), 2ull * n * n, 6ull * n * n, false);
    for (uint32_t j = 0; j <= n; j++)
        for (uint32_t i = 0; i <= n; i++) {
            double *at = model.positions + 3 * (size_t)(j * (n + 1) + i);
            at[0] = side * i / n;
            at[1] = side * j / n;
            at[2] = height;
        }
    for (uint32_t j = 0, c = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++, c += 6) {
            uint32_t a = j * (n + 1) + i, b = a + 1, d = a + n + 1, e = d + 1, corners[] = {a, b, e, a, e, d};
            memcpy(model.corners + c, corners, sizeof corners);
        }
    return model;
}

static void test_squares(void **state)
{
    (void)state;
    for (uint32_t n = 1; n < 40; n = 3 * n + 1) {
        hewn_model a = make_square(1, 0, 1), b = make_square(1, 0.25, n), c = make_square(0.5, 0, n);
        hewn_distance out = measure(&a, &b);
        assert_bounds(out.there_low, out.there, 0.25);
        assert_bounds(out.back_low, out.back, 0.25);
        out = measure(&a, &c); /* the far corner is half a diagonal away, and nothing of the small one is outside */
        assert_bounds(out.there_low, out.there, sqrt(0.5));
        assert_true(out.back < 2e-6 && out.back_low == 0);
        assert_bounds(out.low, out.high, sqrt(0.5));
        hewn_model_destroy(&a);
        hewn_model_destroy(&b);
        hewn_model_destroy(&c);
    }
}

/* Between parallel edges the furthest point is in the middle of a triangle, where no vertex is. */
static void test_the_furthest_point_is_inside(void **state)
{
    (void)state;
    hewn_model roof = make_square(1, 0, 1), edges = make_model(6, 2, 6, false);
    const double at[] = {0, 0, 0, 1, 0, 0, 0.5, -1, 0, 0, 1, 0, 1, 1, 0, 0.5, 2, 0};
    const uint32_t corners[] = {0, 2, 1, 3, 4, 5};
    memcpy(edges.positions, at, sizeof at);
    memcpy(edges.corners, corners, sizeof corners);
    const hewn_distance out = measure(&roof, &edges);
    assert_bounds(out.there_low, out.there, 0.5);
    hewn_model_destroy(&roof);
    hewn_model_destroy(&edges);
}

static void test_equal_and_cut_differently(void **state)
{
    (void)state;
    random_state random = {2};
    hewn_model a = make_sphere(30, 1), flat = make_square(1, 0.3, 37), other = make_square(1, 0.3, 11);
    add_noise(&a, 0.01, &random);
    hewn_distance out = measure(&a, &a);
    assert_true(out.low == 0 && out.high < 1e-5);
    out = measure(&flat, &other);
    assert_true(out.low < 1e-12 && out.high < 2e-6);
    hewn_model_destroy(&a);
    hewn_model_destroy(&flat);
    hewn_model_destroy(&other);
}

/* Polygons are measured as the triangles that they are cut into. */
static void test_polygons(void **state)
{
    (void)state;
    hewn_model ring = make_ring_model(20, 12, 0), cut = make_ring_model(20, 12, 1);
    const hewn_distance out = measure(&ring, &cut);
    assert_true(out.high < 0.02);
    hewn_model_destroy(&ring);
    hewn_model_destroy(&cut);
}

static void test_bad_input(void **state)
{
    (void)state;
    hewn_model square = make_square(1, 0, 1), none = {0};
    const hewn_polygons one = hewn_model_polygons(&square), two = hewn_model_polygons(&none);
    hewn_error error = {0};
    hewn_distance out;
    assert_int_equal(hewn_polygons_distance(&one, &two, NULL, &out, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "second surface has no faces"));
    assert_int_equal(hewn_polygons_distance(&two, &one, NULL, &out, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "first surface has no faces"));
    square.positions[3] = INFINITY;
    assert_int_equal(hewn_polygons_distance(&one, &one, NULL, &out, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "vertex 1 is not finite"));
    hewn_model_destroy(&square);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples_are_within_bounds),
        cmocka_unit_test(test_squares),
        cmocka_unit_test(test_the_furthest_point_is_inside),
        cmocka_unit_test(test_equal_and_cut_differently),
        cmocka_unit_test(test_polygons),
        cmocka_unit_test(test_bad_input),
    };
    return cmocka_run_group_tests_name("distance", tests, NULL, NULL);
}
