/* Least and greatest sample of bricks. A whole row of bricks is reduced at once, sample by sample along i, which is
 * what the compiler makes vectors of; only its end result is taken apart by brick. */
#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "volume/voxel.h"

void hewn_volume_bricks_destroy(hewn_volume_bricks *bricks)
{
    hewn_free(bricks->lo);
    hewn_free(bricks->hi);
    hewn_free(bricks->nan);
    *bricks = (hewn_volume_bricks){0};
}

/* The row of bricks that is being made: b and c, and arrays as long as a row of samples. */
typedef struct brick_row {
    const hewn_volume *volume;
    uint64_t frame;
    uint32_t b, c;
    double *lo, *hi; /* as doubles, of each column of samples */
    uint8_t *nan;
} brick_row;

/* One past the last sample of brick `at` along an axis. */
static uint32_t brick_end(const hewn_volume *volume, int axis, uint32_t at)
{
    uint32_t end = (at + 1) * HEWN_BRICK_CELLS + 1;
    return end < volume->dims[axis] ? end : volume->dims[axis];
}

/* Into blocks that are small enough for the stack and the first cache. A comparison with NaN is false, so NaN changes
 * nothing. `LEAST` and `MOST` are what a minimum and a maximum may start from, given a sample. */
enum { COLUMNS = 256 };

#define REDUCE(name, stored, type, LOAD, LEAST, MOST, IS_NAN)                                                          \
    static void name(const brick_row *row, uint32_t begin, uint32_t count)                                             \
    {                                                                                                                  \
        const hewn_volume *volume = row->volume;                                                                       \
        type lo[COLUMNS], hi[COLUMNS];                                                                                 \
        uint8_t nan[COLUMNS] = {0};                                                                                    \
        uint32_t j_begin = row->b * HEWN_BRICK_CELLS, j_end = brick_end(volume, 1, row->b);                            \
        uint32_t k_begin = row->c * HEWN_BRICK_CELLS, k_end = brick_end(volume, 2, row->c);                            \
        const stored *frame = hewn_volume_frame(volume, row->frame);                                                   \
        for (uint32_t i = 0; i < count; i++) {                                                                         \
            const stored first = frame[((uint64_t)k_begin * volume->dims[1] + j_begin) * volume->dims[0] + begin + i]; \
            lo[i] = MOST(first);                                                                                       \
            hi[i] = LEAST(first);                                                                                      \
        }                                                                                                              \
        for (uint32_t k = k_begin; k < k_end; k++) {                                                                   \
            for (uint32_t j = j_begin; j < j_end; j++) {                                                               \
                const stored *from = frame + ((uint64_t)k * volume->dims[1] + j) * volume->dims[0] + begin;            \
                for (uint32_t i = 0; i < count; i++) {                                                                 \
                    type sample = LOAD(from[i]);                                                                       \
                    lo[i] = sample < lo[i] ? sample : lo[i];                                                           \
                    hi[i] = sample > hi[i] ? sample : hi[i];                                                           \
                    nan[i] |= IS_NAN(sample);                                                                          \
                }                                                                                                      \
            }                                                                                                          \
        }                                                                                                              \
        for (uint32_t i = 0; i < count; i++) {                                                                         \
            row->lo[begin + i] = (double)lo[i];                                                                        \
            row->hi[begin + i] = (double)hi[i];                                                                        \
            row->nan[begin + i] = nan[i];                                                                              \
        }                                                                                                              \
    }

#define ITSELF(sample) (sample)
#define NEVER(sample) 0
#define BELOW_ALL(sample) ((void)(sample), -INFINITY)
#define ABOVE_ALL(sample) ((void)(sample), INFINITY)
#define DIFFERS(sample) (sample != sample)
#define REDUCE_INTEGER(type) REDUCE(reduce_##type, type, type, ITSELF, ITSELF, ITSELF, NEVER)
REDUCE_INTEGER(int8_t)
REDUCE_INTEGER(uint8_t)
REDUCE_INTEGER(int16_t)
REDUCE_INTEGER(uint16_t)
REDUCE_INTEGER(int32_t)
REDUCE_INTEGER(uint32_t)
REDUCE_INTEGER(int64_t)
REDUCE_INTEGER(uint64_t)
REDUCE(reduce_half, uint16_t, float, hewn_float_of_half, BELOW_ALL, ABOVE_ALL, DIFFERS)
REDUCE(reduce_float, float, float, ITSELF, BELOW_ALL, ABOVE_ALL, DIFFERS)
REDUCE(reduce_double, double, double, ITSELF, BELOW_ALL, ABOVE_ALL, DIFFERS)

static void reduce(const brick_row *row, uint32_t begin, uint32_t count)
{
    switch (row->volume->type) {
#define CASE(enumerator, type)                                                                                         \
    case enumerator: reduce_##type(row, begin, count); return;
        HEWN_VOXEL_TYPES(CASE)
#undef CASE
    case HEWN_VOXEL_HALF: reduce_half(row, begin, count); return;
    }
}

/* The float next to `value` on its outer side, or itself; one further where a 64-bit number was rounded on its way. */
static float outward(double value, float side)
{
    float nearest = (float)value;
    bool inside = side > 0 ? (double)nearest < value : (double)nearest > value;
    bool rounded = fabs(value) >= 0x1p53 && !isinf(value);
    return inside || rounded ? nextafterf(nearest, side) : nearest;
}

static void take_apart(const brick_row *row, hewn_volume_bricks *out)
{
    for (uint32_t a = 0; a < out->dims[0]; a++) {
        double lo = INFINITY, hi = -INFINITY;
        uint8_t nan = 0;
        uint32_t end = brick_end(row->volume, 0, a);
        for (uint32_t i = a * HEWN_BRICK_CELLS; i < end; i++) {
            lo = row->lo[i] < lo ? row->lo[i] : lo;
            hi = row->hi[i] > hi ? row->hi[i] : hi;
            nan |= row->nan[i];
        }
        uint64_t at = a + (uint64_t)out->dims[0] * (row->b + (uint64_t)out->dims[1] * row->c);
        out->lo[at] = outward(lo, -INFINITY);
        out->hi[at] = outward(hi, INFINITY);
        out->nan[at] = nan;
    }
}

/* False where memory is short. */
static bool fill_rows(const hewn_volume *volume, uint64_t frame, hewn_volume_bricks *out)
{
    bool good = true;
    uint64_t rows = (uint64_t)out->dims[1] * out->dims[2];
#pragma omp parallel reduction(&& : good) if (hewn_volume_stretches(volume) >= HEWN_VOXEL_ALONE)
    {
        uint32_t width = volume->dims[0];
        brick_row row = {.volume = volume, .frame = frame};
        row.lo = hewn_alloc((size_t)2 * width, sizeof *row.lo);
        row.hi = row.lo ? row.lo + width : NULL;
        row.nan = hewn_alloc(width, 1);
        good = row.lo && row.nan;
#pragma omp for schedule(static)
        for (uint64_t index = 0; index < rows; index++) {
            row.b = (uint32_t)(index % out->dims[1]);
            row.c = (uint32_t)(index / out->dims[1]);
            for (uint32_t begin = 0; good && begin < width; begin += COLUMNS)
                reduce(&row, begin, width - begin < COLUMNS ? width - begin : COLUMNS);
            if (good)
                take_apart(&row, out);
        }
        hewn_free(row.lo);
        hewn_free(row.nan);
    }
    return good;
}

hewn_result hewn_volume_find_bricks(const hewn_volume *volume, uint64_t frame, hewn_volume_bricks *out,
                                    hewn_error *error)
{
    *out = (hewn_volume_bricks){0};
    if (volume->blocks)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "bricks are found in samples that lie in a row, not in blocks");
    for (int axis = 0; axis < 3; axis++) {
        uint32_t cells = volume->dims[axis] - 1;
        out->dims[axis] = cells == 0 ? 1 : (cells - 1) / HEWN_BRICK_CELLS + 1;
    }
    uint64_t count = (uint64_t)out->dims[0] * out->dims[1] * out->dims[2];
    out->lo = hewn_alloc(count, sizeof *out->lo);
    out->hi = hewn_alloc(count, sizeof *out->hi);
    out->nan = hewn_alloc(count, 1);
    if (!out->lo || !out->hi || !out->nan || !fill_rows(volume, frame, out)) {
        hewn_volume_bricks_destroy(out);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the ranges of %llu bricks",
                         (unsigned long long)count);
    }
    for (uint64_t i = 0; i < count; i++)
        out->nan_count += out->nan[i];
    return HEWN_OK;
}
