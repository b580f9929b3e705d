#include "base/error.h"
#include "io/volume/formats.h"

hewn_result hewn_raw_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    const hewn_raw_desc *raw = &source->desc->raw;
    hewn_volume volume = hewn_volume_blank();
    *out = (hewn_volume){0};
    if (raw->dims[0] == 0 || raw->dims[1] == 0 || raw->dims[2] == 0)
        return hewn_fail_at(error, HEWN_INVALID_ARGUMENT, source->name, 0,
                            "a raw file does not say how many voxels it has along each axis; that must be given");
    bool spaced = raw->spacing[0] != 0 || raw->spacing[1] != 0 || raw->spacing[2] != 0;
    for (int axis = 0; axis < 3; axis++) {
        volume.dims[axis] = raw->dims[axis];
        volume.to_world[5 * axis] = spaced ? raw->spacing[axis] : 1;
    }
    volume.frame_count = raw->frame_count ? raw->frame_count : 1;
    volume.type = raw->type;
    HEWN_TRY(hewn_volume_head_check(source, &volume, NULL, error));
    HEWN_TRY(hewn_volume_take_samples(source, raw->offset, raw->big_endian, &volume, error));
    *out = volume;
    return HEWN_OK;
}
