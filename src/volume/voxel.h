/* Samples of any type, a stretch at a time. */
#ifndef HEWN_SRC_VOLUME_VOXEL_H
#define HEWN_SRC_VOLUME_VOXEL_H

#include <string.h>

#include "hewn/volume.h"
#include "volume/blocks.h"

/* Does `X(enumerator, C type)` for each type whose samples C's arithmetic takes; halves are apart. */
#define HEWN_VOXEL_TYPES(X)                                                                                            \
    X(HEWN_VOXEL_INT8, int8_t)                                                                                         \
    X(HEWN_VOXEL_UINT8, uint8_t)                                                                                       \
    X(HEWN_VOXEL_INT16, int16_t)                                                                                       \
    X(HEWN_VOXEL_UINT16, uint16_t)                                                                                     \
    X(HEWN_VOXEL_INT32, int32_t)                                                                                       \
    X(HEWN_VOXEL_UINT32, uint32_t)                                                                                     \
    X(HEWN_VOXEL_INT64, int64_t)                                                                                       \
    X(HEWN_VOXEL_UINT64, uint64_t)                                                                                     \
    X(HEWN_VOXEL_FLOAT, float)                                                                                         \
    X(HEWN_VOXEL_DOUBLE, double)

/* The float that an IEEE 754 half is, bit for bit; NaN stays NaN. */
static inline float hewn_float_of_half(uint16_t half)
{
    uint32_t sign = (uint32_t)(half & 0x8000) << 16, exponent = half >> 10 & 0x1f, fraction = half & 0x3ff, bits;
    if (exponent == 0x1f) {
        bits = sign | 0x7f800000u | fraction << 13;
    } else if (exponent > 0) {
        bits = sign | (exponent + 112) << 23 | fraction << 13;
    } else {
        float tiny = (float)fraction * 0x1p-24f; /* exact, 0 too */
        memcpy(&bits, &tiny, sizeof bits);
        bits |= sign;
    }
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* `count` samples from number `at` on, of an array of this type. */
void hewn_voxels_convert(hewn_voxel type, const void *samples, uint64_t at, size_t count, double *out);

/* Samples `at` to `at + count - 1` of a volume as doubles; of one in blocks too. */
void hewn_voxels_to_double(const hewn_volume *volume, uint64_t at, size_t count, double *out);

/* Calls that go through a frame do so in stretches of at most this many samples, whatever the number of threads. Of a
 * volume in blocks a stretch is so many of these, and after them each constant alone. */
enum { HEWN_VOXEL_STRETCH = 4096, HEWN_VOXEL_BLOCKS = HEWN_VOXEL_STRETCH / HEWN_BLOCK_SAMPLES };

/* With fewer stretches than this one thread is faster than several. */
enum { HEWN_VOXEL_ALONE = 16 };

static inline uint64_t hewn_volume_stretches(const hewn_volume *volume)
{
    if (volume->blocks)
        return (volume->blocks->block_count + HEWN_VOXEL_BLOCKS - 1) / HEWN_VOXEL_BLOCKS +
               volume->blocks->constant_count;
    return (hewn_volume_frame_size(volume) + HEWN_VOXEL_STRETCH - 1) / HEWN_VOXEL_STRETCH;
}

/* As hewn_volume_forget(), for samples `at` to `at + count - 1` of all. */
void hewn_volume_forget_samples(const hewn_volume *volume, uint64_t at, uint64_t count);

/* Stretch `index` of a frame as doubles; how many it has, each of which is `*weight` samples. What lies well before it
 * in a file is let go, so that whoever goes through a frame in order takes little memory. */
size_t hewn_volume_stretch(const hewn_volume *volume, uint64_t frame, uint64_t index, double out[HEWN_VOXEL_STRETCH],
                           uint64_t *weight);

#endif
