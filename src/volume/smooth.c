#include "volume/smooth.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"

static hewn_voxel type_after(hewn_voxel type, hewn_volume_filter filter)
{
    if (type == HEWN_VOXEL_HALF)
        return HEWN_VOXEL_FLOAT;
    if (type == HEWN_VOXEL_INT64 || type == HEWN_VOXEL_UINT64)
        return HEWN_VOXEL_DOUBLE;
    if (filter == HEWN_VOLUME_MEDIAN)
        return type;
    return hewn_voxel_size(type) >= 4 && type != HEWN_VOXEL_FLOAT ? HEWN_VOXEL_DOUBLE : HEWN_VOXEL_FLOAT;
}

static hewn_result check(const hewn_volume *volume, const hewn_volume_smooth_desc *desc, hewn_error *error)
{
    double spacing[3], longest = 0;
    if (desc->frame >= volume->frame_count)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no frame %llu; the volume has %llu, counted from 0",
                         (unsigned long long)desc->frame, (unsigned long long)volume->frame_count);
    if (!(desc->length > 0) || !isfinite(desc->length))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a volume is smoothed by a length above 0, not by %g",
                         desc->length);
    hewn_volume_spacing(volume, spacing);
    for (int axis = 0; axis < 3; axis++)
        longest = fmax(longest, spacing[axis] * volume->dims[axis]);
    return desc->length <= longest
               ? HEWN_OK
               : hewn_fail(error, HEWN_INVALID_ARGUMENT, "the volume is to be smoothed by %g, but is only %g long",
                           desc->length, longest);
}

hewn_result hewn_volume_smooth(const hewn_volume *volume, const hewn_volume_smooth_desc *desc, hewn_volume *out,
                               hewn_error *error)
{
    *out = (hewn_volume){0};
    HEWN_TRY(check(volume, desc, error));
    hewn_volume made = *volume;
    made.frame_count = 1;
    made.type = type_after(volume->type, desc->filter);
    made.mapped = false;
    made.blocks = NULL;
    made.memory_length = (size_t)hewn_volume_frame_size(volume) * hewn_voxel_size(made.type);
    made.memory = hewn_alloc(made.memory_length, 1);
    made.samples = made.memory;
    made.name = volume->name ? hewn_strdup(volume->name) : NULL;
    made.remark = volume->remark ? hewn_strdup(volume->remark) : NULL;
    bool short_of = !made.memory || (volume->name && !made.name) || (volume->remark && !made.remark);
    hewn_result result = short_of ? hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u x %u x %u voxels",
                                              volume->dims[0], volume->dims[1], volume->dims[2])
                         : desc->filter == HEWN_VOLUME_MEDIAN ? hewn_volume_median(volume, desc, &made, error)
                                                              : hewn_volume_gaussian(volume, desc, &made, error);
    if (result != HEWN_OK)
        hewn_volume_destroy(&made);
    else
        *out = made;
    return result;
}
