/* What is found in a volume: range, bricks, histogram, percentiles and iso values, each against a plain count; its
 * place in the world and its orientation. */
#include <math.h>

#include "hewn/volume.h"
#include "test_model_support.h"

typedef struct made {
    hewn_volume volume;
    double *samples; /* the same as doubles */
    size_t count;
} made;

/* Random samples of a type in two heaps, some NaN and infinite where there are such. Exact in float and half. */
static made make_volume(random_state *random, hewn_voxel type, uint32_t x, uint32_t y, uint32_t z)
{
    made out = {.volume = {.dims = {x, y, z}, .frame_count = 2, .type = type, .slope = 1}};
    for (int i = 0; i < 4; i++)
        out.volume.to_world[5 * i] = 1;
    out.count = (size_t)x * y * z;
    size_t all = 2 * out.count, size = hewn_voxel_size(type);
    char *bytes = hewn_alloc(all, size);
    out.samples = hewn_alloc(all, sizeof(double));
    assert_non_null(bytes);
    assert_non_null(out.samples);
    for (size_t i = 0; i < all; i++) {
        int64_t value = random_below(random, 30) + (random_below(random, 3) == 0 ? 60 : 0);
        float single = (float)value - 8;
        double wide = single;
        uint16_t half =
            (uint16_t)(value << 10 & 0x7fff) ^ (value & 1 ? 0x8000 : 0); /* any exponent, NaN and infinities too */
        uint32_t odd = random_below(random, 20);
        single = odd == 0 ? NAN : odd == 1 ? INFINITY : odd == 2 ? -INFINITY : single;
        wide = odd == 0 ? NAN : odd == 1 ? INFINITY : odd == 2 ? -INFINITY : wide;
        const void *from = type == HEWN_VOXEL_FLOAT    ? (const void *)&single
                           : type == HEWN_VOXEL_DOUBLE ? (const void *)&wide
                           : type == HEWN_VOXEL_HALF   ? (const void *)&half
                                                       : (const void *)&value;
        memcpy(bytes + i * size, from, size);
    }
    out.volume.samples = out.volume.memory = bytes;
    for (size_t i = 0; i < all; i++)
        out.samples[i] = hewn_volume_sample(&out.volume, i);
    return out;
}

static void destroy_made(made *one)
{
    hewn_free(one->samples);
    hewn_volume_destroy(&one->volume);
}

static void test_range_and_bricks(void **state)
{
    (void)state;
    random_state random = {3};
    for (int round = 0; round < 60; round++) {
        hewn_voxel type = (hewn_voxel)(round % HEWN_VOXEL_COUNT);
        made one = make_volume(&random, type, 1 + random_below(&random, 40), 1 + random_below(&random, 20),
                               1 + random_below(&random, 20));
        const double *frame = one.samples + one.count;
        hewn_volume_range range = hewn_volume_find_range(&one.volume, 1);
        double lo = INFINITY, hi = -INFINITY;
        uint64_t finite = 0, nan = 0;
        for (size_t i = 0; i < one.count; i++) {
            finite += isfinite(frame[i]);
            nan += isnan(frame[i]);
            lo = isfinite(frame[i]) ? fmin(lo, frame[i]) : lo;
            hi = isfinite(frame[i]) ? fmax(hi, frame[i]) : hi;
        }
        assert_int_equal(range.finite_count, finite);
        assert_int_equal(range.nan_count, nan);
        assert_int_equal(range.infinite_count, one.count - finite - nan);
        assert_true(finite == 0 ? isnan(range.lo) && isnan(range.hi) : range.lo == lo && range.hi == hi);
        hewn_volume_bricks bricks;
        assert_int_equal(hewn_volume_find_bricks(&one.volume, 1, &bricks, NULL), HEWN_OK);
        const uint32_t *dims = one.volume.dims;
        for (int axis = 0; axis < 3; axis++)
            assert_int_equal(bricks.dims[axis], dims[axis] == 1 ? 1 : (dims[axis] - 1 + 7) / 8);
        uint64_t marked = 0;
        for (uint32_t at = 0; at < bricks.dims[0] * bricks.dims[1] * bricks.dims[2]; at++) {
            uint32_t a = at % bricks.dims[0], b = at / bricks.dims[0] % bricks.dims[1],
                     c = at / (bricks.dims[0] * bricks.dims[1]);
            bool has_nan = false;
            lo = INFINITY;
            hi = -INFINITY;
            for (uint32_t k = 8 * c; k <= 8 * c + 8 && k < dims[2]; k++)
                for (uint32_t j = 8 * b; j <= 8 * b + 8 && j < dims[1]; j++)
                    for (uint32_t i = 8 * a; i <= 8 * a + 8 && i < dims[0]; i++) {
                        double sample = frame[i + dims[0] * (j + (size_t)dims[1] * k)];
                        has_nan = has_nan || isnan(sample);
                        lo = sample < lo ? sample : lo;
                        hi = sample > hi ? sample : hi;
                    }
            assert_true((double)bricks.lo[at] == lo && (double)bricks.hi[at] == hi);
            assert_int_equal(bricks.nan[at], has_nan);
            marked += has_nan;
        }
        assert_int_equal(bricks.nan_count, marked);
        hewn_volume_bricks_destroy(&bricks);
        destroy_made(&one);
    }
}

/* Numbers that a float cannot hold: the brick's range contains them. */
static void test_outward(void **state)
{
    (void)state;
    int64_t whole[] = {INT64_MAX, INT64_MIN + 1, ((int64_t)1 << 53) + 1, -((int64_t)1 << 60) - 1};
    double real[] = {0.1, 1e300, -1e300, 16777217};
    for (int type = 0; type < 2; type++) {
        for (size_t i = 0; i < 4; i++) {
            hewn_volume volume = {
                .dims = {1, 1, 1}, .frame_count = 1, .type = type ? HEWN_VOXEL_DOUBLE : HEWN_VOXEL_INT64};
            volume.samples = type ? (const void *)&real[i] : (const void *)&whole[i];
            hewn_volume_bricks bricks;
            assert_int_equal(hewn_volume_find_bricks(&volume, 0, &bricks, NULL), HEWN_OK);
            long double exact = type ? (long double)real[i] : (long double)whole[i];
            assert_true((long double)bricks.lo[0] <= exact && exact <= (long double)bricks.hi[0]);
            hewn_volume_bricks_destroy(&bricks);
        }
    }
}

static int compare_doubles(const void *a, const void *b)
{
    double one = *(const double *)a, other = *(const double *)b;
    return (one > other) - (one < other);
}

static void test_percentiles(void **state)
{
    (void)state;
    static const double percents[] = {0, 0.1, 25, 50, 66.6, 99, 100};
    random_state random = {4};
    for (int round = 0; round < 3 * HEWN_VOXEL_COUNT; round++) {
        made one = make_volume(&random, (hewn_voxel)(round % HEWN_VOXEL_COUNT), 17, 9, 5);
        one.volume.slope = round % 2 ? -2 : 3;
        one.volume.intercept = 7;
        size_t finite = 0;
        for (size_t i = 0; i < one.count; i++)
            if (isfinite(one.samples[i]))
                one.samples[finite++] = one.volume.slope * one.samples[i] + 7;
        qsort(one.samples, finite, sizeof(double), compare_doubles);
        for (size_t i = 0; i < sizeof percents / sizeof *percents; i++) {
            size_t rank = (size_t)ceil(percents[i] / 100 * (double)finite);
            double found;
            assert_int_equal(hewn_volume_find_percentile(&one.volume, 0, percents[i], &found, NULL), HEWN_OK);
            assert_true(found == one.samples[rank > 0 ? rank - 1 : 0]);
        }
        double found;
        assert_int_equal(hewn_volume_find_percentile(&one.volume, 0, 101, &found, NULL), HEWN_INVALID_ARGUMENT);
        destroy_made(&one);
    }
}

static void test_histogram(void **state)
{
    (void)state;
    random_state random = {5};
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++) {
        made one = make_volume(&random, (hewn_voxel)type, 30, 20, 10);
        hewn_volume_histogram histogram;
        uint64_t bins[10] = {0}, total = 0;
        for (size_t i = 0; i < one.count; i++) {
            if (!(one.samples[i] >= 0 && one.samples[i] <= 50))
                continue;
            int bin = (int)(one.samples[i] / 5);
            bins[bin < 10 ? bin : 9]++;
            total++;
        }
        assert_int_equal(hewn_volume_find_histogram(&one.volume, 0, 0, 50, 10, &histogram, NULL), HEWN_OK);
        assert_memory_equal(histogram.bins, bins, sizeof bins);
        assert_int_equal(histogram.total, total);
        hewn_volume_histogram_destroy(&histogram);
        assert_int_equal(hewn_volume_find_histogram(&one.volume, 0, 3, 3, 10, &histogram, NULL), HEWN_INVALID_ARGUMENT);
        assert_null(histogram.bins);
        destroy_made(&one);
    }
}

/* --- iso values --------------------------------------------------------------------------------------------------- */

static double find_iso(const char *text, const hewn_volume *volume)
{
    hewn_iso iso;
    double value = 0;
    hewn_error error = {0};
    if (hewn_iso_parse(text, &iso, &error) != HEWN_OK || hewn_iso_find(&iso, volume, 0, &value, &error) != HEWN_OK)
        fail_msg("%s: %s", text, error.message);
    return value;
}

static void assert_no_iso(const char *text, const hewn_volume *volume, const char *part)
{
    hewn_iso iso;
    double value;
    hewn_error error = {0};
    assert_int_equal(hewn_iso_parse(text, &iso, &error), HEWN_OK);
    assert_int_equal(hewn_iso_find(&iso, volume, 0, &value, &error), HEWN_BAD_INPUT);
    if (!strstr(error.message, part))
        fail_msg("\"%s\" (not \"%s\")", error.message, part);
}

static void test_iso_parse(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "",         "x",       "nan",       "inf",      " 3", "3 ", "otsu:", "otsu:0/2", "otsu:2/2", "otsu:1/1",
        "otsu:1/7", "otsu1/2", "otsu:1/2x", "hu:liver", "hu", "p",  "p-1",   "p101",     "pp3",      "3,5"};
    hewn_iso iso;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        hewn_error error = {0};
        if (hewn_iso_parse(bad[i], &iso, &error) != HEWN_INVALID_ARGUMENT)
            fail_msg("'%s' was taken", bad[i]);
        assert_true(error.message[0] != '\0');
    }
    assert_int_equal(hewn_iso_parse("-1.5e2", &iso, NULL), HEWN_OK);
    assert_true(iso.kind == HEWN_ISO_NUMBER && iso.number == -150);
    assert_int_equal(hewn_iso_parse("otsu:2/3", &iso, NULL), HEWN_OK);
    assert_true(iso.kind == HEWN_ISO_OTSU && iso.threshold == 2 && iso.classes == 3);
    assert_int_equal(hewn_iso_parse("hu:bone", &iso, NULL), HEWN_OK);
    assert_true(iso.kind == HEWN_ISO_HOUNSFIELD && iso.number == 300);
    assert_int_equal(hewn_iso_parse("p99.5", &iso, NULL), HEWN_OK);
    assert_true(iso.kind == HEWN_ISO_PERCENTILE && iso.number == 99.5);
}

/* The greatest variance between two classes, by trying every border between values. */
static void assert_otsu_is_best(const made *one, double threshold)
{
    double best = -1, got = -1;
    for (int border = -1; border <= 256; border++) {
        bool ours = border < 0;
        double at = ours ? threshold : border + 0.5, low = 0, high = 0, low_sum = 0, high_sum = 0;
        for (size_t i = 0; i < one->count; i++) {
            bool below = one->samples[i] < at;
            low += below;
            high += !below;
            low_sum += below ? one->samples[i] : 0;
            high_sum += below ? 0 : one->samples[i];
        }
        if (low == 0 || high == 0)
            continue;
        double variance = low * high * (low_sum / low - high_sum / high) * (low_sum / low - high_sum / high);
        best = fmax(best, variance);
        got = ours ? variance : got;
    }
    assert_true(got >= best * (1 - 1e-12));
}

static void test_otsu(void **state)
{
    (void)state;
    random_state random = {6};
    for (int round = 0; round < 10; round++) {
        made one = make_volume(&random, HEWN_VOXEL_UINT8, 20, 10, 5);
        double threshold = find_iso("otsu", &one.volume);
        assert_otsu_is_best(&one, threshold);
        assert_true(threshold != floor(threshold) || threshold > 29); /* no voxel is equal to it */
        /* Turned around and moved, the surface stays where it is. */
        one.volume.slope = -3;
        one.volume.intercept = 11;
        assert_true(fabs(find_iso("otsu", &one.volume) - (11 - 3 * threshold)) < 1e-9);
        destroy_made(&one);
    }
    uint8_t levels[] = {0, 0, 0, 100, 100, 100, 200, 200, 200, 250};
    hewn_volume volume = {
        .dims = {10, 1, 1}, .frame_count = 1, .type = HEWN_VOXEL_UINT8, .samples = levels, .slope = 1};
    assert_true(find_iso("otsu:1/3", &volume) == 50);
    assert_true(find_iso("otsu:2/3", &volume) == 150);
    assert_true(find_iso("otsu:3/4", &volume) == 225);
    assert_no_iso("otsu:1/5", &volume, "4 different values cannot be parted into 5 classes");
    volume.slope = -1;
    assert_true(find_iso("otsu:1/3", &volume) == -150);
    float real[] = {0, 0, 0.5f, 0.5f, NAN, 8, 8, 8.5f, INFINITY, 9};
    volume = (hewn_volume){.dims = {10, 1, 1}, .frame_count = 1, .type = HEWN_VOXEL_FLOAT, .samples = real, .slope = 1};
    assert_true(fabs(find_iso("otsu", &volume) - 4.25) < 0.01);
}

static void test_iso_refused(void **state)
{
    (void)state;
    int16_t samples[] = {10, 20, 30, 40, 50, 60, 70, 80};
    hewn_volume volume = {
        .dims = {2, 2, 2}, .frame_count = 1, .type = HEWN_VOXEL_INT16, .samples = samples, .slope = 1};
    assert_true(find_iso("45", &volume) == 45);
    assert_true(find_iso("p50", &volume) == 40);
    assert_no_iso("10", &volume, "the values are from 10 to 80");
    assert_no_iso("80", &volume, "the values are from 10 to 80");
    assert_no_iso("p100", &volume, "the values are from 10 to 80");
    assert_no_iso("hu:bone", &volume, "not in Hounsfield units");
    volume.hounsfield = true;
    assert_no_iso("hu:bone", &volume, "the iso value 300 gives no surface");
    volume.slope = 20;
    volume.intercept = -1200;
    volume.hounsfield = false;
    assert_true(find_iso("hu:skin", &volume) == -300);
    volume.dims[0] = volume.dims[1] = volume.dims[2] = 1;
    assert_no_iso("otsu", &volume, "all values of the volume are -1000");
    float nothing[] = {NAN, INFINITY};
    volume =
        (hewn_volume){.dims = {2, 1, 1}, .frame_count = 1, .type = HEWN_VOXEL_FLOAT, .samples = nothing, .slope = 1};
    assert_no_iso("0", &volume, "no value of the volume is finite");
}

/* --- place -------------------------------------------------------------------------------------------------------- */

/* Signed permutations have the letters that they should; the way to the world and back is none. */
static void test_place(void **state)
{
    (void)state;
    random_state random = {7};
    static const char letters[] = "LRPAIS";
    for (int round = 0; round < 200; round++) {
        hewn_volume volume = {
            .dims = {4, 5, 6}, .frame_count = 1, .slope = 1, .anatomical = true, .to_world = {[15] = 1}};
        int axes[3] = {0, 1, 2}, swap = (int)random_below(&random, 3), other = (int)random_below(&random, 3);
        int kept = axes[swap];
        char wanted[4] = {0}, found[4];
        axes[swap] = axes[other];
        axes[other] = kept;
        for (int column = 0; column < 3; column++) {
            bool positive = random_below(&random, 2);
            double spacing = 0.5 + 0.1 * random_below(&random, 40);
            for (int row = 0; row < 3; row++) /* and up to some 10 degrees aside */
                volume.to_world[4 * row + column] =
                    spacing *
                    (row == axes[column] ? (positive ? 1 : -1) : 0.001 * (random_below(&random, 240) - 120.0));
            wanted[column] = letters[2 * axes[column] + positive];
            volume.to_world[4 * column + 3] = random_below(&random, 100);
        }
        assert_int_equal(hewn_volume_check(&volume, NULL), HEWN_OK);
        hewn_volume_orientation(&volume, found);
        assert_string_equal(found, wanted);
        double back[12], at[3] = {1.5, 2.25, 4}, world[3];
        hewn_volume_from_world(&volume, back);
        hewn_volume_to_world(&volume, at, world);
        for (int row = 0; row < 3; row++)
            assert_true(fabs(back[4 * row] * world[0] + back[4 * row + 1] * world[1] + back[4 * row + 2] * world[2] +
                             back[4 * row + 3] - at[row]) < 1e-9);
        hewn_box box = hewn_volume_bounds(&volume);
        for (int axis = 0; axis < 3; axis++)
            assert_true(box.lo[axis] <= world[axis] && world[axis] <= box.hi[axis]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_range_and_bricks), cmocka_unit_test(test_outward),   cmocka_unit_test(test_percentiles),
        cmocka_unit_test(test_histogram),        cmocka_unit_test(test_iso_parse), cmocka_unit_test(test_otsu),
        cmocka_unit_test(test_iso_refused),      cmocka_unit_test(test_place),
    };
    return cmocka_run_group_tests_name("volume", tests, NULL, NULL);
}
