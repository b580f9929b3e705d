#include "volume/voxel.h"

static const struct {
    const char *name;
    uint8_t size;
    bool integer;
} known[HEWN_VOXEL_COUNT] = {[HEWN_VOXEL_INT8] = {"int8", 1, true},     [HEWN_VOXEL_UINT8] = {"uint8", 1, true},
                             [HEWN_VOXEL_INT16] = {"int16", 2, true},   [HEWN_VOXEL_UINT16] = {"uint16", 2, true},
                             [HEWN_VOXEL_INT32] = {"int32", 4, true},   [HEWN_VOXEL_UINT32] = {"uint32", 4, true},
                             [HEWN_VOXEL_INT64] = {"int64", 8, true},   [HEWN_VOXEL_UINT64] = {"uint64", 8, true},
                             [HEWN_VOXEL_HALF] = {"half", 2, false},    [HEWN_VOXEL_FLOAT] = {"float", 4, false},
                             [HEWN_VOXEL_DOUBLE] = {"double", 8, false}};

size_t hewn_voxel_size(hewn_voxel type)
{
    return known[type].size;
}

const char *hewn_voxel_name(hewn_voxel type)
{
    return known[type].name;
}

bool hewn_voxel_is_integer(hewn_voxel type)
{
    return known[type].integer;
}

bool hewn_voxel_find(const char *name, hewn_voxel *out)
{
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++) {
        if (strcmp(known[type].name, name) == 0) {
            *out = (hewn_voxel)type;
            return true;
        }
    }
    return false;
}

void hewn_voxels_convert(hewn_voxel type, const void *samples, uint64_t at, size_t count, double *out)
{
    switch (type) {
#define CASE(enumerator, type)                                                                                         \
    case enumerator:                                                                                                   \
        for (size_t i = 0; i < count; i++)                                                                             \
            out[i] = (double)((const type *)samples)[at + i];                                                          \
        return;
        HEWN_VOXEL_TYPES(CASE)
#undef CASE
    case HEWN_VOXEL_HALF:
        for (size_t i = 0; i < count; i++)
            out[i] = (double)hewn_float_of_half(((const uint16_t *)samples)[at + i]);
        return;
    }
}

/* Sample by sample: for what looks at few. */
static void find_in_blocks(const hewn_volume *volume, uint64_t at, size_t count, double *out)
{
    for (size_t n = 0; n < count; n++, at++) {
        const uint64_t row = at / volume->dims[0];
        const uint32_t ijk[3] = {(uint32_t)(at % volume->dims[0]), (uint32_t)(row % volume->dims[1]),
                                 (uint32_t)(row / volume->dims[1])};
        uint64_t number;
        const void *samples = hewn_blocks_sample(volume->blocks, ijk, &number);
        hewn_voxels_convert(volume->type, samples, number, 1, out + n);
    }
}

void hewn_voxels_to_double(const hewn_volume *volume, uint64_t at, size_t count, double *out)
{
    if (volume->blocks)
        find_in_blocks(volume, at, count, out);
    else
        hewn_voxels_convert(volume->type, volume->samples, at, count, out);
}

static size_t stretch_of_blocks(const hewn_volume *volume, uint64_t index, double *out, uint64_t *weight)
{
    const hewn_blocks *blocks = volume->blocks;
    const uint64_t stretches = (blocks->block_count + HEWN_VOXEL_BLOCKS - 1) / HEWN_VOXEL_BLOCKS;
    const void *samples = HEWN_BLOCKS_ARRAY(blocks, char, samples);
    size_t count = 0;
    *weight = 1;
    if (index >= stretches) {
        const void *constants = HEWN_BLOCKS_ARRAY(blocks, char, constants);
        *weight = HEWN_BLOCKS_ARRAY(blocks, uint64_t, weights)[index - stretches];
        hewn_voxels_convert(volume->type, constants, index - stretches, 1, out);
        return *weight > 0;
    }
    uint64_t end = (index + 1) * HEWN_VOXEL_BLOCKS;
    end = end < blocks->block_count ? end : blocks->block_count;
    for (uint64_t block = index * HEWN_VOXEL_BLOCKS; block < end; block++) {
        uint32_t lo[3], hi[3];
        hewn_block_within(volume, block, lo, hi);
        for (uint32_t z = lo[2]; z < hi[2]; z++)
            for (uint32_t y = lo[1]; y < hi[1]; y++, count += hi[0] - lo[0])
                hewn_voxels_convert(volume->type, samples,
                                    block * HEWN_BLOCK_SAMPLES + lo[0] + HEWN_BLOCK * (y + (uint64_t)HEWN_BLOCK * z),
                                    hi[0] - lo[0], out + count);
    }
    return count;
}

size_t hewn_volume_stretch(const hewn_volume *volume, uint64_t frame, uint64_t index, double out[HEWN_VOXEL_STRETCH],
                           uint64_t *weight)
{
    enum { KEPT = 1024 }; /* stretches */
    if (volume->blocks)
        return stretch_of_blocks(volume, index, out, weight);
    uint64_t size = hewn_volume_frame_size(volume), begin = index * HEWN_VOXEL_STRETCH;
    size_t count = size - begin < HEWN_VOXEL_STRETCH ? (size_t)(size - begin) : HEWN_VOXEL_STRETCH;
    *weight = 1;
    hewn_voxels_to_double(volume, frame * size + begin, count, out);
    if (index % KEPT == KEPT - 1)
        hewn_volume_forget_samples(volume, frame * size + begin + count - (uint64_t)KEPT * HEWN_VOXEL_STRETCH,
                                   (uint64_t)KEPT * HEWN_VOXEL_STRETCH);
    return count;
}

double hewn_volume_sample(const hewn_volume *volume, uint64_t index)
{
    double value = 0;
    hewn_voxels_to_double(volume, index, 1, &value);
    return value;
}

double hewn_volume_value(const hewn_volume *volume, uint64_t index)
{
    return volume->slope * hewn_volume_sample(volume, index) + volume->intercept;
}
