/* Least, greatest and percentiles of a frame. */
#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "volume/voxel.h"

hewn_volume_range hewn_volume_find_range(const hewn_volume *volume, uint64_t frame)
{
    double lo = INFINITY, hi = -INFINITY;
    uint64_t finite = 0, nan = 0, infinite = 0, stretches = hewn_volume_stretches(volume);
#pragma omp parallel for schedule(static) reduction(min : lo) reduction(max : hi) reduction(+ : finite, nan, infinite) if (stretches >= HEWN_VOXEL_ALONE)
    for (uint64_t index = 0; index < stretches; index++) {
        double samples[HEWN_VOXEL_STRETCH];
        uint64_t weight, finite_here = 0, nan_here = 0;
        size_t count = hewn_volume_stretch(volume, frame, index, samples, &weight);
        for (size_t i = 0; i < count; i++) {
            double sample = samples[i];
            bool good = sample - sample == 0; /* finite */
            finite_here += good;
            nan_here += sample != sample;
            lo = good && sample < lo ? sample : lo;
            hi = good && sample > hi ? sample : hi;
        }
        finite += weight * finite_here;
        nan += weight * nan_here;
        infinite += weight * (count - finite_here - nan_here);
    }
    hewn_volume_range range = {.finite_count = finite, .nan_count = nan, .infinite_count = infinite};
    range.sample_lo = finite > 0 ? lo : NAN;
    range.sample_hi = finite > 0 ? hi : NAN;
    double a = volume->slope * range.sample_lo + volume->intercept;
    double b = volume->slope * range.sample_hi + volume->intercept;
    range.lo = volume->slope < 0 ? b : a;
    range.hi = volume->slope < 0 ? a : b;
    return range;
}

/* --- percentiles -------------------------------------------------------------------------------------------------- */

enum { DIGIT_BITS = 16, DIGITS = 1 << DIGIT_BITS };

/* Whole numbers in the order of the doubles that they are made of. */
static uint64_t key_of(double value)
{
    uint64_t bits;
    value += 0.0; /* one zero */
    memcpy(&bits, &value, sizeof bits);
    return bits >> 63 ? ~bits : bits | (uint64_t)1 << 63;
}

static double value_of(uint64_t key)
{
    uint64_t bits = key >> 63 ? key & ~((uint64_t)1 << 63) : ~key;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Counts the finite samples whose key begins with `prefix` (its `done` highest bits) by the next digit. */
static void count_digits(const hewn_volume *volume, uint64_t frame, uint64_t prefix, int done, uint64_t *counts,
                         uint64_t *scratch, int threads)
{
    uint64_t stretches = hewn_volume_stretches(volume);
    int shift = 64 - done - DIGIT_BITS;
#pragma omp parallel for schedule(static) num_threads(threads) if (stretches >= HEWN_VOXEL_ALONE)
    for (int thread = 0; thread < threads; thread++) {
        uint64_t *own = scratch + (size_t)thread * DIGITS;
        memset(own, 0, DIGITS * sizeof *own);
        uint64_t begin = stretches * (uint64_t)thread / (uint64_t)threads;
        uint64_t end = stretches * (uint64_t)(thread + 1) / (uint64_t)threads;
        for (uint64_t index = begin; index < end; index++) {
            double samples[HEWN_VOXEL_STRETCH];
            uint64_t weight;
            size_t count = hewn_volume_stretch(volume, frame, index, samples, &weight);
            for (size_t i = 0; i < count; i++) {
                uint64_t key = key_of(samples[i]);
                if (samples[i] - samples[i] == 0 && (done == 0 || key >> (64 - done) == prefix))
                    own[key >> shift & (DIGITS - 1)] += weight;
            }
        }
    }
    for (int digit = 0; digit < DIGITS; digit++) {
        counts[digit] = 0;
        for (int thread = 0; thread < threads; thread++)
            counts[digit] += scratch[(size_t)thread * DIGITS + (size_t)digit];
    }
}

/* Radix selection: sample number `rank`, from 1, of those that are finite, in rising order. */
static double select_sample(const hewn_volume *volume, uint64_t frame, uint64_t rank, uint64_t *scratch, int threads)
{
    uint64_t *counts = scratch + (size_t)threads * DIGITS, prefix = 0;
    for (int done = 0; done < 64; done += DIGIT_BITS) {
        uint64_t digit = 0;
        count_digits(volume, frame, prefix, done, counts, scratch, threads);
        while (digit < DIGITS - 1 && rank > counts[digit])
            rank -= counts[digit++];
        prefix = prefix << DIGIT_BITS | digit;
    }
    return value_of(prefix);
}

hewn_result hewn_volume_find_percentile(const hewn_volume *volume, uint64_t frame, double percent, double *out,
                                        hewn_error *error)
{
    enum { THREADS = 4 }; /* a table each */
    *out = 0;
    if (!(percent >= 0 && percent <= 100))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a percentile is from 0 to 100, not %g", percent);
    hewn_volume_range range = hewn_volume_find_range(volume, frame);
    if (range.finite_count == 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "no value of the volume is finite");
    uint64_t rank = (uint64_t)ceil(percent / 100 * (double)range.finite_count);
    rank = rank < 1 ? 1 : rank > range.finite_count ? range.finite_count : rank;
    if (volume->slope < 0)
        rank = range.finite_count - rank + 1;
    uint64_t *scratch = hewn_alloc((size_t)(THREADS + 1) * DIGITS, sizeof *scratch);
    if (!scratch)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a percentile");
    *out = volume->slope * select_sample(volume, frame, rank, scratch, THREADS) + volume->intercept;
    hewn_free(scratch);
    return HEWN_OK;
}
