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

void hewn_voxels_to_double(const hewn_volume *volume, uint64_t at, size_t count, double *out)
{
    switch (volume->type) {
#define CASE(enumerator, type)                                                                                         \
    case enumerator:                                                                                                   \
        for (size_t i = 0; i < count; i++)                                                                             \
            out[i] = (double)((const type *)volume->samples)[at + i];                                                  \
        return;
        HEWN_VOXEL_TYPES(CASE)
#undef CASE
    case HEWN_VOXEL_HALF:
        for (size_t i = 0; i < count; i++)
            out[i] = (double)hewn_float_of_half(((const uint16_t *)volume->samples)[at + i]);
        return;
    }
}

size_t hewn_volume_stretch(const hewn_volume *volume, uint64_t frame, uint64_t index, double out[HEWN_VOXEL_STRETCH])
{
    uint64_t size = hewn_volume_frame_size(volume), begin = index * HEWN_VOXEL_STRETCH;
    size_t count = size - begin < HEWN_VOXEL_STRETCH ? (size_t)(size - begin) : HEWN_VOXEL_STRETCH;
    enum { KEPT = 1024 }; /* stretches */
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
