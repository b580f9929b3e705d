/* Filters of volumes: against direct sums and sorted balls, in any lattice, with values that are not finite. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "hewn/volume.h"

enum { I = 17, J = 11, K = 9, COUNT = I * J * K };

static double unit(uint64_t *random)
{
    *random = *random * 6364136223846793005u + 1442695040888963407u;
    return (double)(*random >> 11) * 0x1p-53;
}

static hewn_volume volume_of(const void *samples, hewn_voxel type)
{
    return (hewn_volume){.dims = {I, J, K},
                         .frame_count = 1,
                         .type = type,
                         .samples = samples,
                         .slope = -2,
                         .intercept = 3,
                         .to_world = {0, 0.5, 0, 4, -0.8, 0, 0, 1, 0, 0, 1.25, 2, 0, 0, 0, 1}};
}

static hewn_result smooth(const hewn_volume *volume, hewn_volume_filter filter, double length, hewn_volume *out,
                          hewn_error *error)
{
    hewn_volume_smooth_desc desc = {.filter = filter, .length = length};
    return hewn_volume_smooth(volume, &desc, out, error);
}

/* --- Gaussians ---------------------------------------------------------------------------------------------------- */

/* exp(-t) I_n(t) by its series. */
static double bessel(int n, double t)
{
    double term = 1, sum = 0;
    for (int m = 1; m <= n; m++)
        term *= t / 2 / m;
    for (int m = 0; m < 400; m++) {
        sum += term;
        term *= t * t / 4 / (m + 1) / (m + 1 + n);
    }
    return exp(-t) * sum;
}

/* What a voxel `d` away has of the weights that are within the volume. */
static double share(int at, int d, int count, double t)
{
    double sum = 0;
    for (int other = 0; other < count; other++)
        sum += bessel(abs(other - at), t);
    return bessel(abs(d), t) / sum;
}

/* One voxel becomes the product of three kernels. */
static void test_gaussian_of_a_voxel(void **state)
{
    (void)state;
    static float samples[COUNT];
    const double spacing[3] = {0.8, 0.5, 1.25}, length = 0.6;
    const int middle[3] = {8, 5, 4}, counts[3] = {I, J, K};
    memset(samples, 0, sizeof samples);
    samples[8 + I * (5 + J * 4)] = 1;
    hewn_volume volume = volume_of(samples, HEWN_VOXEL_FLOAT), out;
    assert_int_equal(smooth(&volume, HEWN_VOLUME_GAUSSIAN, length, &out, NULL), HEWN_OK);
    assert_int_equal(out.type, HEWN_VOXEL_FLOAT);
    assert_true(out.slope == -2 && out.intercept == 3 && out.frame_count == 1);
    assert_memory_equal(out.to_world, volume.to_world, sizeof out.to_world);
    double variance[3] = {0, 0, 0}, sum = 0;
    for (int n = 0; n < COUNT; n++) {
        int at[3] = {n % I - 8, n / I % J - 5, n / (I * J) - 4};
        double here = hewn_volume_sample(&out, (uint64_t)n), wanted = 1;
        for (int axis = 0; axis < 3; axis++)
            wanted *=
                share(at[axis] + middle[axis], at[axis], counts[axis], length * length / spacing[axis] / spacing[axis]);
        assert_true(fabs(here - wanted) < 2e-6);
        sum += here;
        for (int axis = 0; axis < 3; axis++)
            variance[axis] += here * at[axis] * at[axis] * spacing[axis] * spacing[axis];
    }
    assert_true(fabs(variance[0] / sum - length * length) < 1e-3); /* the same along an axis that is long enough */
    assert_true(fabs(variance[2] / sum - length * length) < 1e-3);
    hewn_volume_destroy(&out);
}

/* Weights sum up to 1 everywhere; voxels that are not finite stay and have no weight. */
static void test_what_is_constant_stays(void **state)
{
    (void)state;
    static double samples[COUNT];
    uint64_t random = 1;
    for (int kind = 0; kind < 2; kind++)
        for (int trial = 0; trial < 6; trial++) {
            for (int n = 0; n < COUNT; n++)
                samples[n] = 7;
            for (int n = 0; kind == 1 && n < 300; n++)
                samples[(int)(unit(&random) * COUNT)] = n % 3 == 0 ? INFINITY : NAN;
            hewn_volume volume = volume_of(samples, HEWN_VOXEL_DOUBLE), out;
            assert_int_equal(smooth(&volume, HEWN_VOLUME_GAUSSIAN, 0.1 * pow(2, trial), &out, NULL), HEWN_OK);
            assert_int_equal(out.type, HEWN_VOXEL_DOUBLE);
            for (int n = 0; n < COUNT; n++) {
                double here = hewn_volume_sample(&out, (uint64_t)n);
                assert_true(samples[n] == 7 ? fabs(here - 7) < 1e-5 : memcmp(&here, &samples[n], 8) == 0);
            }
            hewn_volume_destroy(&out);
        }
}

/* A weighted mean of what is finite, by a direct sum over the kernel, next to the border and to holes. */
static void test_gaussian_beside_holes(void **state)
{
    (void)state;
    static double samples[COUNT];
    const double spacing[3] = {0.8, 0.5, 1.25}, length = 0.9;
    uint64_t random = 5;
    for (int n = 0; n < COUNT; n++)
        samples[n] = unit(&random) < 0.2 ? NAN : unit(&random);
    hewn_volume volume = volume_of(samples, HEWN_VOXEL_DOUBLE), out;
    assert_int_equal(smooth(&volume, HEWN_VOLUME_GAUSSIAN, length, &out, NULL), HEWN_OK);
    for (int n = 0; n < COUNT; n += 29) {
        double sum = 0, weights = 0;
        for (int m = 0; m < COUNT && samples[n] == samples[n]; m++) {
            int d[3] = {m % I - n % I, m / I % J - n / I % J, m / (I * J) - n / (I * J)};
            double weight = samples[m] == samples[m];
            for (int axis = 0; axis < 3 && weight > 0; axis++)
                weight *= bessel(abs(d[axis]), length * length / spacing[axis] / spacing[axis]);
            sum += weight > 0 ? weight * samples[m] : 0;
            weights += weight;
        }
        double here = hewn_volume_sample(&out, (uint64_t)n);
        assert_true(samples[n] == samples[n] ? fabs(here - sum / weights) < 1e-5 : here != here);
    }
    hewn_volume_destroy(&out);
}

/* --- medians ------------------------------------------------------------------------------------------------------ */

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void check_median(const hewn_volume *volume, double radius, hewn_voxel type)
{
    hewn_volume out;
    hewn_error error = {0};
    assert_int_equal(smooth(volume, HEWN_VOLUME_MEDIAN, radius, &out, &error), HEWN_OK);
    assert_int_equal(out.type, type);
    for (int n = 0; n < COUNT; n += 11) {
        static double values[COUNT];
        double here[3], there[3], got = hewn_volume_sample(&out, (uint64_t)n);
        size_t count = 0;
        hewn_volume_to_world(volume, (double[3]){n % I, n / I % J, n / (I * J)}, here);
        for (int m = 0; m < COUNT; m++) {
            double sum = 0, value = hewn_volume_sample(volume, (uint64_t)m);
            hewn_volume_to_world(volume, (double[3]){m % I, m / I % J, m / (I * J)}, there);
            for (int axis = 0; axis < 3; axis++)
                sum += (there[axis] - here[axis]) * (there[axis] - here[axis]);
            if (sum <= radius * radius * (1 + 1e-8) && value == value)
                values[count++] = value;
        }
        qsort(values, count, sizeof *values, by_value);
        double own = hewn_volume_sample(volume, (uint64_t)n);
        if (own != own)
            assert_true(got != got);
        else
            assert_true(got == values[(count - 1) / 2]);
    }
    hewn_volume_destroy(&out);
}

static void test_medians(void **state)
{
    (void)state;
    static float floats[COUNT];
    static int16_t shorts[COUNT];
    static uint64_t longs[COUNT];
    static uint16_t halves[COUNT];
    uint64_t random = 9;
    for (int n = 0; n < COUNT; n++) {
        floats[n] = unit(&random) < 0.1 ? NAN : unit(&random) < 0.05 ? -INFINITY : (float)unit(&random);
        shorts[n] = (int16_t)(20 * unit(&random) - 10);
        longs[n] = (uint64_t)(1e6 * unit(&random));
        halves[n] = (uint16_t)(0x3400 + 0x800 * unit(&random));
    }
    hewn_volume volume = volume_of(floats, HEWN_VOXEL_FLOAT);
    check_median(&volume, 0.5, HEWN_VOXEL_FLOAT);
    check_median(&volume, 1.5, HEWN_VOXEL_FLOAT);
    volume.to_world[1] = 0.7; /* sheared: the ball stays one in the world */
    volume.to_world[2] = 0.4;
    volume.to_world[4] = -0.3;
    check_median(&volume, 1.2, HEWN_VOXEL_FLOAT);
    volume = volume_of(shorts, HEWN_VOXEL_INT16);
    check_median(&volume, 1.25, HEWN_VOXEL_INT16);
    volume = volume_of(longs, HEWN_VOXEL_UINT64);
    check_median(&volume, 1, HEWN_VOXEL_DOUBLE);
    volume = volume_of(halves, HEWN_VOXEL_HALF);
    check_median(&volume, 1, HEWN_VOXEL_FLOAT);
}

/* --- the rest ----------------------------------------------------------------------------------------------------- */

static void test_same_bytes_for_any_threads(void **state)
{
    (void)state;
    static float samples[2 * COUNT];
    uint64_t random = 3;
    for (int n = 0; n < 2 * COUNT; n++)
        samples[n] = unit(&random) < 0.1 ? NAN : (float)unit(&random);
    hewn_volume volume = volume_of(samples, HEWN_VOXEL_FLOAT), first, out;
    volume.frame_count = 2;
    int before = omp_get_max_threads();
    for (int filter = 0; filter < 2; filter++) {
        hewn_volume_smooth_desc desc = {.frame = 1, .filter = (hewn_volume_filter)filter, .length = 1};
        omp_set_num_threads(1);
        assert_int_equal(hewn_volume_smooth(&volume, &desc, &first, NULL), HEWN_OK);
        omp_set_num_threads(5);
        assert_int_equal(hewn_volume_smooth(&volume, &desc, &out, NULL), HEWN_OK);
        assert_memory_equal(first.samples, out.samples, COUNT * sizeof(float));
        hewn_volume_destroy(&out);
        hewn_volume alone = volume_of(samples + COUNT, HEWN_VOXEL_FLOAT); /* it is the frame that was asked for */
        desc.frame = 0;
        assert_int_equal(hewn_volume_smooth(&alone, &desc, &out, NULL), HEWN_OK);
        assert_memory_equal(first.samples, out.samples, COUNT * sizeof(float));
        hewn_volume_destroy(&out);
        hewn_volume_destroy(&first);
    }
    omp_set_num_threads(before);
}

static bool stop(void *user, const char *stage, double fraction)
{
    (void)user;
    (void)stage;
    return fraction < 0.4;
}

static void test_refused(void **state)
{
    (void)state;
    static float samples[COUNT];
    hewn_volume volume = volume_of(samples, HEWN_VOXEL_FLOAT), out;
    hewn_error error = {0};
    const double bad[] = {0, -1, NAN, INFINITY, 1000};
    for (size_t n = 0; n < 5; n++)
        for (int filter = 0; filter < 2; filter++)
            assert_int_equal(smooth(&volume, (hewn_volume_filter)filter, bad[n], &out, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(smooth(&volume, HEWN_VOLUME_MEDIAN, 0.4, &out, &error), HEWN_INVALID_ARGUMENT);
    assert_non_null(strstr(error.message, "no neighbour"));
    hewn_volume_smooth_desc desc = {.frame = 1, .length = 1};
    assert_int_equal(hewn_volume_smooth(&volume, &desc, &out, &error), HEWN_INVALID_ARGUMENT);
    hewn_progress progress = {.report = stop};
    desc = (hewn_volume_smooth_desc){.length = 1, .progress = &progress};
    for (int filter = 0; filter < 2; filter++) {
        desc.filter = (hewn_volume_filter)filter;
        assert_int_equal(hewn_volume_smooth(&volume, &desc, &out, &error), HEWN_CANCELLED);
        assert_null(out.memory);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gaussian_of_a_voxel),        cmocka_unit_test(test_what_is_constant_stays),
        cmocka_unit_test(test_gaussian_beside_holes),      cmocka_unit_test(test_medians),
        cmocka_unit_test(test_same_bytes_for_any_threads), cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
