/* The predicates against determinants in rational numbers, where it is hard to tell and where it is impossible to. */
#include <float.h>

#include "geom/predicates.h"
#include "test_exact_support.h"

static int oracle2d(const double p[3][3])
{
    rational_point r[3], u, v;
    mpq_t area;
    mpq_init(area);
    open_point(&u);
    open_point(&v);
    for (int k = 0; k < 3; k++) {
        open_point(&r[k]);
        set_point(&r[k], p[k]);
    }
    subtract_points(&u, &r[1], &r[0]);
    subtract_points(&v, &r[2], &r[0]);
    cross_term(area, u.at[0], v.at[1], u.at[1], v.at[0]);
    int sign = mpq_sgn(area);
    for (int k = 0; k < 3; k++)
        close_point(&r[k]);
    close_point(&u);
    close_point(&v);
    mpq_clear(area);
    return sign;
}

static int oracle3d(const double p[4][3])
{
    rational_point r[4], edge[3], normal;
    mpq_t volume;
    mpq_init(volume);
    open_point(&normal);
    for (int k = 0; k < 4; k++) {
        open_point(&r[k]);
        set_point(&r[k], p[k]);
    }
    for (int k = 0; k < 3; k++) {
        open_point(&edge[k]);
        subtract_points(&edge[k], &r[k + 1], &r[0]);
    }
    cross_points(&normal, &edge[0], &edge[1]);
    dot_points(volume, &normal, &edge[2]);
    int sign = mpq_sgn(volume);
    for (int k = 0; k < 4; k++)
        close_point(&r[k]);
    for (int k = 0; k < 3; k++)
        close_point(&edge[k]);
    close_point(&normal);
    mpq_clear(volume);
    return sign;
}

typedef void generator(random_state *random, double p[4][3]);

/* Runs a generator and compares every answer. Returns how many of them were 0 in three dimensions. */
static int compare_with_oracle(generator *generate, int rounds)
{
    random_state random = {7};
    int zeros = 0;
    for (int round = 0; round < rounds; round++) {
        double p[4][3];
        generate(&random, p);
        int flat = hewn_orient2d(p[0], p[1], p[2]), solid = hewn_orient3d(p[0], p[1], p[2], p[3]);
        if (flat != oracle2d((const double(*)[3])p) || solid != oracle3d((const double(*)[3])p))
            fail_msg("round %d: (%a %a %a) (%a %a %a) (%a %a %a) (%a %a %a): %d, %d", round, p[0][0], p[0][1], p[0][2],
                     p[1][0], p[1][1], p[1][2], p[2][0], p[2][1], p[2][2], p[3][0], p[3][1], p[3][2], flat, solid);
        assert_int_equal(hewn_orient2d(p[1], p[2], p[0]), flat);
        assert_int_equal(hewn_orient2d(p[1], p[0], p[2]), -flat);
        assert_int_equal(hewn_orient3d(p[1], p[0], p[2], p[3]), -solid);
        assert_int_equal(hewn_orient3d(p[3], p[2], p[1], p[0]), solid);
        /* The exact way alone must agree too, also where the filter would have answered. */
        assert_int_equal(hewn_orient2d_exact(p[0], p[1], p[2]), flat);
        assert_int_equal(hewn_orient3d_exact(p[0], p[1], p[2], p[3]), solid);
        zeros += solid == 0;
    }
    return zeros;
}

static void spread_points(random_state *random, double p[4][3])
{
    for (int k = 0; k < 12; k++)
        p[k / 3][k % 3] = random_unit(random) - 0.5;
}

static void grid_points(random_state *random, double p[4][3])
{
    double step = ldexp(1, (int)random_below(random, 40) - 20), origin = random_below(random, 3) * 1e3;
    for (int k = 0; k < 12; k++)
        p[k / 3][k % 3] = origin + step * random_below(random, 4);
}

/* Four points of a lattice plane: coplanar without rounding, and often three of them collinear. */
static void coplanar_points(random_state *random, double p[4][3])
{
    double u[3], v[3], origin[3], scale = ldexp(1, (int)random_below(random, 100) - 50);
    for (int i = 0; i < 3; i++) {
        u[i] = (double)(random_bits(random) >> 44) - 0x1p19;
        v[i] = (double)(random_bits(random) >> 44) - 0x1p19;
        origin[i] = (double)(random_bits(random) >> 24) - 0x1p39;
    }
    for (int k = 0; k < 4; k++) {
        double s = random_below(random, 1000), t = random_below(random, 3) * 100.0;
        for (int i = 0; i < 3; i++)
            p[k][i] = scale * (origin[i] + s * u[i] + t * v[i]);
    }
}

/* The fourth point on the plane of three as well as doubles can, then off by last places; often small beside the
 * distance from the origin, and sometimes the same as another. */
static void nearly_flat_points(random_state *random, double p[4][3])
{
    double far = random_below(random, 2) * ldexp(1, (int)random_below(random, 30));
    double s = 3 * random_unit(random) - 1, t = 3 * random_unit(random) - 1;
    spread_points(random, p);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            p[k][i] += far;
        if (random_below(random, 4) == 0)
            p[2][i] = p[0][i] + t * (p[1][i] - p[0][i]);
        p[3][i] = p[0][i] + s * (p[1][i] - p[0][i]) + t * (p[2][i] - p[0][i]);
        p[3][i] = nudge(random, p[3][i]);
    }
    if (random_below(random, 20) == 0)
        memcpy(p[3], p[random_below(random, 3)], sizeof p[3]);
}

/* Numbers of very different sizes inside the range of expansions: their differences do not fit in one double. */
static void mixed_points(random_state *random, double p[4][3])
{
    int spread = 10 + (int)random_below(random, 290);
    for (int k = 0; k < 12; k++)
        p[k / 3][k % 3] = ldexp(random_unit(random) - 0.5, (int)random_below(random, 2 * spread) - spread);
    if (random_below(random, 2))
        for (int i = 0; i < 3; i++)
            p[3][i] = nudge(random, p[random_below(random, 3)][i]);
}

/* Any finite doubles: products overflow and underflow. */
static void wild_points(random_state *random, double p[4][3])
{
    static const double extremes[] = {0, -0.0, DBL_MAX, -DBL_MAX, DBL_MIN, -DBL_MIN, 0x1p-1074, -0x1p-1074, 1};
    for (int k = 0; k < 12; k++) {
        double value;
        do {
            uint64_t bits = random_bits(random);
            memcpy(&value, &bits, sizeof value);
        } while (!isfinite(value));
        uint32_t choice = random_below(random, 18);
        p[k / 3][k % 3] = choice < 9 ? extremes[choice] : value;
    }
    if (random_below(random, 3) == 0)
        memcpy(p[3], p[random_below(random, 3)], sizeof p[3]);
}

/* The coplanar and nearly flat ones, scaled to either end of the doubles. */
static void scaled_points(random_state *random, double p[4][3])
{
    if (random_below(random, 2))
        coplanar_points(random, p);
    else
        nearly_flat_points(random, p);
    int scale = random_below(random, 2) ? 320 + (int)random_below(random, 600) : -280 - (int)random_below(random, 740);
    for (int k = 0; k < 12; k++)
        p[k / 3][k % 3] = ldexp(p[k / 3][k % 3], scale);
}

static void test_spread(void **state)
{
    (void)state;
    assert_int_equal(compare_with_oracle(spread_points, effort(5000, 40)), 0);
}

static void test_grid(void **state)
{
    (void)state;
    assert_true(compare_with_oracle(grid_points, effort(10000, 40)) > 1000);
}

static void test_coplanar(void **state)
{
    (void)state;
    int rounds = effort(10000, 40);
    assert_int_equal(compare_with_oracle(coplanar_points, rounds), rounds);
}

static void test_nearly_flat(void **state)
{
    (void)state;
    assert_true(compare_with_oracle(nearly_flat_points, effort(20000, 40)) > 100);
}

static void test_mixed(void **state)
{
    (void)state;
    compare_with_oracle(mixed_points, effort(5000, 40));
}

static void test_any_finite(void **state)
{
    (void)state;
    assert_true(compare_with_oracle(wild_points, effort(1500, 40)) > 20);
}

static void test_ends_of_the_range(void **state)
{
    (void)state;
    assert_true(compare_with_oracle(scaled_points, effort(3000, 40)) > 1000);
}

/* The arithmetic of a naive determinant must be wrong on some of this input, or the tests above prove nothing. */
static void test_the_input_is_hard(void **state)
{
    (void)state;
    random_state random = {7};
    int wrong = 0;
    for (int round = 0; round < 2000; round++) {
        double p[4][3], e[3][3];
        nearly_flat_points(&random, p);
        for (int k = 0; k < 9; k++)
            e[k / 3][k % 3] = p[k / 3 + 1][k % 3] - p[0][k % 3];
        double volume = e[2][0] * (e[0][1] * e[1][2] - e[0][2] * e[1][1]) +
                        e[2][1] * (e[0][2] * e[1][0] - e[0][0] * e[1][2]) +
                        e[2][2] * (e[0][0] * e[1][1] - e[0][1] * e[1][0]);
        wrong += (volume > 0) - (volume < 0) != hewn_orient3d(p[0], p[1], p[2], p[3]);
    }
    assert_true(wrong > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spread),
        cmocka_unit_test(test_grid),
        cmocka_unit_test(test_coplanar),
        cmocka_unit_test(test_nearly_flat),
        cmocka_unit_test(test_mixed),
        cmocka_unit_test(test_any_finite),
        cmocka_unit_test(test_ends_of_the_range),
        cmocka_unit_test(test_the_input_is_hard),
    };
    return cmocka_run_group_tests_name("predicates", tests, NULL, NULL);
}
