/* Exact sums: any order gives the same bits, and nothing is lost however far terms lie apart. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "geom/exact_sum.h"

static uint64_t next(uint64_t *state)
{
    uint64_t x = *state;
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    *state = x;
    return x * 0x2545f4914f6cdd1du;
}

/* Of any magnitude within 2^-spread to 2^spread. */
static double random_term(uint64_t *state, int spread)
{
    double share = (double)(int64_t)next(state) / 0x1p63;
    return ldexp(share, (int)(next(state) % (2 * (uint64_t)spread + 1)) - spread);
}

static double sum_of(const double *terms, size_t count)
{
    hewn_exact_sum sum = {{0}, 0};
    for (size_t i = 0; i < count; i++)
        hewn_exact_sum_add(&sum, terms[i]);
    return hewn_exact_sum_value(&sum);
}

static void assert_bits(double a, double b)
{
    if (memcmp(&a, &b, sizeof a) != 0)
        fail_msg("%.17g is not %.17g", a, b);
}

static void test_single_terms(void **state)
{
    (void)state;
    static const double terms[] = {0,       1,       -1,      0.1,          -3.7e200,    DBL_MAX,
                                   DBL_MIN, 5e-324,  -5e-324, 0x1.8p-1060,  -DBL_MAX,    0x1.fffffffffffffp31,
                                   1e300,   -1e-300, 0x1p-32, 0x1.00001p32, 0x1.8p-1074, 12345.678};
    uint64_t random = 1;
    for (size_t i = 0; i < sizeof terms / sizeof *terms; i++)
        assert_bits(sum_of(&terms[i], 1), terms[i]);
    for (int i = 0; i < 100000; i++) {
        double term = random_term(&random, 1020);
        assert_bits(sum_of(&term, 1), term);
    }
}

/* Whole numbers, whose sum a 128-bit integer knows. */
static void test_against_integers(void **state)
{
    (void)state;
    uint64_t random = 2;
    for (int round = 0; round < 300; round++) {
        hewn_exact_sum sum = {{0}, 0};
        __extension__ __int128 exact = 0;
        int scale = (int)(next(&random) % 1500) - 900;
        for (int i = 0; i < 1000; i++) {
            int shift = (int)(next(&random) % 50);
            int64_t term = ((int64_t)next(&random) >> 12) * ((int64_t)1 << shift % 11);
            exact += term;
            hewn_exact_sum_add(&sum, ldexp((double)term, scale));
            if (i % 97 == 0)
                hewn_exact_sum_settle(&sum);
        }
        double expected = ldexp((double)exact, scale), value = hewn_exact_sum_value(&sum);
        assert_true(fabs(value - expected) <= 0x1p-52 * fabs(expected));
    }
}

static void test_any_order_and_split(void **state)
{
    (void)state;
    enum { COUNT = 2000 };
    double terms[COUNT];
    uint64_t random = 3;
    for (int round = 0; round < 100; round++) {
        for (int i = 0; i < COUNT; i++)
            terms[i] = random_term(&random, round * 10);
        double expected = sum_of(terms, COUNT);
        for (int i = COUNT - 1; i > 0; i--) {
            int other = (int)(next(&random) % (uint64_t)(i + 1));
            double kept = terms[i];
            terms[i] = terms[other];
            terms[other] = kept;
        }
        assert_bits(sum_of(terms, COUNT), expected);
        hewn_exact_sum parts[3] = {{{0}, 0}};
        for (int i = 0; i < COUNT; i++)
            hewn_exact_sum_add(&parts[next(&random) % 3], terms[i]);
        hewn_exact_sum_join(&parts[2], &parts[0]);
        hewn_exact_sum_join(&parts[1], &parts[2]);
        assert_bits(hewn_exact_sum_value(&parts[1]), expected);
    }
}

static void test_what_cancels_is_gone(void **state)
{
    (void)state;
    static const double terms[] = {DBL_MAX, 1e-300, 1, -DBL_MAX, 5e-324, 1e300, -1, -1e300, -1e-300};
    assert_bits(sum_of(terms, sizeof terms / sizeof *terms), 5e-324);
    assert_bits(sum_of((double[]){0.1, 0.2, -0.1, -0.2}, 4), 0);
    uint64_t random = 4;
    hewn_exact_sum sum = {{0}, 0};
    double kept[1000];
    for (int i = 0; i < 1000; i++)
        hewn_exact_sum_add(&sum, kept[i] = random_term(&random, 900));
    hewn_exact_sum_add(&sum, -0.375);
    for (int i = 0; i < 1000; i++)
        hewn_exact_sum_add(&sum, -kept[i]);
    assert_bits(hewn_exact_sum_value(&sum), -0.375);
}

static void test_endless(void **state)
{
    (void)state;
    assert_true(sum_of((double[]){1, INFINITY, 2}, 3) == INFINITY);
    assert_true(sum_of((double[]){-INFINITY, 7}, 2) == -INFINITY);
    assert_true(isnan(sum_of((double[]){INFINITY, -INFINITY}, 2)));
    assert_true(isnan(sum_of((double[]){NAN, 1}, 2)));
    assert_true(sum_of((double[]){DBL_MAX, DBL_MAX}, 2) == INFINITY);
    assert_bits(sum_of((double[]){DBL_MAX, DBL_MAX, -DBL_MAX}, 3), DBL_MAX);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_single_terms),
        cmocka_unit_test(test_against_integers),
        cmocka_unit_test(test_any_order_and_split),
        cmocka_unit_test(test_what_cancels_is_gone),
        cmocka_unit_test(test_endless),
    };
    return cmocka_run_group_tests_name("exact_sum", tests, NULL, NULL);
}
