#include "iso/threshold.h"

#include <math.h>
#include <string.h>

#include "volume/voxel.h"

/* --- keys --------------------------------------------------------------------------------------------------------- */

static int64_t least_key(hewn_voxel type)
{
    switch (type) {
    case HEWN_VOXEL_INT8: return INT8_MIN;
    case HEWN_VOXEL_INT16: return INT16_MIN;
    case HEWN_VOXEL_INT32: return INT32_MIN;
    case HEWN_VOXEL_UINT8:
    case HEWN_VOXEL_UINT16:
    case HEWN_VOXEL_UINT32: return 0;
    case HEWN_VOXEL_INT64:
    case HEWN_VOXEL_UINT64: return INT64_MIN;
    case HEWN_VOXEL_HALF: return -0x7c01; /* of -infinity */
    case HEWN_VOXEL_FLOAT: return -0x7f800001;
    case HEWN_VOXEL_DOUBLE: return -0x7ff0000000000001;
    }
    return 0;
}

static int64_t most_key(hewn_voxel type)
{
    switch (type) {
    case HEWN_VOXEL_INT8: return INT8_MAX;
    case HEWN_VOXEL_UINT8: return UINT8_MAX;
    case HEWN_VOXEL_INT16: return INT16_MAX;
    case HEWN_VOXEL_UINT16: return UINT16_MAX;
    case HEWN_VOXEL_INT32: return INT32_MAX;
    case HEWN_VOXEL_UINT32: return UINT32_MAX;
    case HEWN_VOXEL_INT64:
    case HEWN_VOXEL_UINT64: return INT64_MAX;
    case HEWN_VOXEL_HALF: return 0x7c00;
    case HEWN_VOXEL_FLOAT: return 0x7f800000;
    case HEWN_VOXEL_DOUBLE: return 0x7ff0000000000000;
    }
    return 0;
}

/* The bits of a float whose key this is: negative ones count down from -1, which is -0. */
static uint64_t bits_of(int64_t key, uint64_t sign)
{
    return key < 0 ? sign | (uint64_t)~key : (uint64_t)key;
}

static float float_of(int64_t key)
{
    uint32_t bits = (uint32_t)bits_of(key, 0x80000000u);
    float sample;
    memcpy(&sample, &bits, sizeof sample);
    return sample;
}

static double double_of(int64_t key)
{
    uint64_t bits = bits_of(key, (uint64_t)1 << 63);
    double sample;
    memcpy(&sample, &bits, sizeof sample);
    return sample;
}

static double sample_of(hewn_voxel type, int64_t key)
{
    switch (type) {
    case HEWN_VOXEL_UINT64: return (double)((uint64_t)key ^ (uint64_t)1 << 63);
    case HEWN_VOXEL_HALF: return (double)hewn_float_of_half((uint16_t)bits_of(key, 0x8000));
    case HEWN_VOXEL_FLOAT: return (double)float_of(key);
    case HEWN_VOXEL_DOUBLE: return double_of(key);
    default: return (double)key;
    }
}

/* Rounding keeps order, so values rise or fall with keys and a search by halves finds where they pass the iso value. */
hewn_threshold hewn_threshold_find(const hewn_volume *volume, double iso, bool below)
{
    int64_t lo = least_key(volume->type), hi = most_key(volume->type);
    /* With a positive slope the values from some key on are at least the iso value. */
    hewn_threshold out = {.least = (volume->slope > 0) != below};
    uint64_t begin = 0, end = (uint64_t)hi - (uint64_t)lo + 1; /* 0 where there are 2^64 */
    bool whole = end == 0;
    end -= whole;
    while (begin < end) {
        uint64_t middle = begin + (end - begin) / 2;
        double value = volume->slope * sample_of(volume->type, (int64_t)((uint64_t)lo + middle)) + volume->intercept;
        bool inside = below ? value < iso : value >= iso;
        if (inside == out.least)
            end = middle;
        else
            begin = middle + 1;
    }
    if (whole && begin == UINT64_MAX) { /* the last key of 64 bits is left over */
        double value = volume->slope * sample_of(volume->type, hi) + volume->intercept;
        bool inside = below ? value < iso : value >= iso;
        out.none = out.least && !inside;
        out.key = out.least || inside ? hi : hi - 1;
        return out;
    }
    /* `begin` is the first key that is inside, or the first that is not. */
    uint64_t count = (uint64_t)hi - (uint64_t)lo + 1;
    out.none = out.least ? !whole && begin == count : begin == 0;
    out.key = (int64_t)((uint64_t)lo + begin - (out.least ? 0 : 1));
    return out;
}

/* --- comparisons -------------------------------------------------------------------------------------------------- */

#define COMPARE(type)                                                                                                  \
    static void compare_##type(const type *samples, size_t count, type limit, bool least, uint8_t *out)                \
    {                                                                                                                  \
        if (least)                                                                                                     \
            for (size_t i = 0; i < count; i++)                                                                         \
                out[i] = samples[i] >= limit;                                                                          \
        else                                                                                                           \
            for (size_t i = 0; i < count; i++)                                                                         \
                out[i] = samples[i] <= limit;                                                                          \
    }
COMPARE(int8_t)
COMPARE(uint8_t)
COMPARE(int16_t)
COMPARE(uint16_t)
COMPARE(int32_t)
COMPARE(uint32_t)
COMPARE(int64_t)
COMPARE(uint64_t)
COMPARE(float)
COMPARE(double)

/* NaN's keys are beyond those of the infinities. */
static void compare_half(const uint16_t *samples, size_t count, int16_t limit, bool least, uint8_t *out)
{
    int16_t lo = least ? limit : -0x7c01, hi = least ? 0x7c00 : limit;
    for (size_t i = 0; i < count; i++) {
        int16_t sample = (int16_t)samples[i];
        int16_t key = (int16_t)(sample ^ (sample >> 15 & 0x7fff));
        out[i] = (uint8_t)((key >= lo) & (key <= hi));
    }
}

/* Both zeros are equal to C, so a limit of one zero must be one where the other is on the same side: values of both are
 * equal, so they always are. */
void hewn_threshold_apply(const hewn_threshold *threshold, const hewn_volume *volume, uint64_t at, size_t count,
                          uint8_t *out)
{
    const char *from = (const char *)volume->samples + at * hewn_voxel_size(volume->type);
    bool least = threshold->least;
    int64_t key = threshold->key;
    if (threshold->none) {
        memset(out, 0, count);
        return;
    }
    switch (volume->type) {
    case HEWN_VOXEL_INT8: compare_int8_t((const int8_t *)from, count, (int8_t)key, least, out); return;
    case HEWN_VOXEL_UINT8: compare_uint8_t((const uint8_t *)from, count, (uint8_t)key, least, out); return;
    case HEWN_VOXEL_INT16:
        compare_int16_t((const int16_t *)(const void *)from, count, (int16_t)key, least, out);
        return;
    case HEWN_VOXEL_UINT16:
        compare_uint16_t((const uint16_t *)(const void *)from, count, (uint16_t)key, least, out);
        return;
    case HEWN_VOXEL_INT32:
        compare_int32_t((const int32_t *)(const void *)from, count, (int32_t)key, least, out);
        return;
    case HEWN_VOXEL_UINT32:
        compare_uint32_t((const uint32_t *)(const void *)from, count, (uint32_t)key, least, out);
        return;
    case HEWN_VOXEL_INT64: compare_int64_t((const int64_t *)(const void *)from, count, key, least, out); return;
    case HEWN_VOXEL_UINT64:
        compare_uint64_t((const uint64_t *)(const void *)from, count, (uint64_t)key ^ (uint64_t)1 << 63, least, out);
        return;
    case HEWN_VOXEL_HALF: compare_half((const uint16_t *)(const void *)from, count, (int16_t)key, least, out); return;
    case HEWN_VOXEL_FLOAT: compare_float((const float *)(const void *)from, count, float_of(key), least, out); return;
    case HEWN_VOXEL_DOUBLE:
        compare_double((const double *)(const void *)from, count, double_of(key), least, out);
        return;
    }
}
