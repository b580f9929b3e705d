#include "io/volume/sampling_write.h"

#include <string.h>

#include "base/error.h"

hewn_result hewn_sampling_format(const char *path, hewn_volume_format format, hewn_volume_format *out,
                                 hewn_error *error)
{
    bool named = path && strcmp(path, "-") != 0;
    *out = format != HEWN_VOLUME_UNKNOWN || !named ? format : hewn_volume_format_of(path);
    size_t length = path ? strlen(path) : 0;
    bool packed = named && length > 3 && strcmp(path + length - 3, ".gz") == 0;
    bool header = named && length > 5 && strcmp(path + length - 5, ".nhdr") == 0;
    if ((*out == HEWN_VOLUME_VDB || *out == HEWN_VOLUME_NRRD) && !packed && !header)
        return HEWN_OK;
    if (!named)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "say in which format standard output shall be: vdb or nrrd");
    return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                     "a volume is written as .vdb or .nrrd, and '%s' is neither by its name", path);
}

hewn_result hewn_sampling_write(const hewn_sampling *sampling, const hewn_sampling_place *place,
                                const hewn_sampling_write_desc *desc, const char *path, hewn_sampling_written *out,
                                hewn_error *error)
{
    static const hewn_sampling_write_desc defaults;
    hewn_sampling_written unused;
    desc = desc ? desc : &defaults;
    out = out ? out : &unused;
    *out = (hewn_sampling_written){0};
    if (!sampling || !place || !path || sampling->cells[2] == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_sampling_write: there are no samples of a solid to write");
    if (desc->band < 0 || !(desc->band < 1000))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a band of %g cells makes no sense", desc->band);
    HEWN_TRY(hewn_sampling_format(path, desc->format, &out->format, error));
    hewn_sampling_writing job = {.sampling = sampling,
                                 .place = place,
                                 .band = desc->band > 0 ? desc->band : 3,
                                 .dense = desc->dense,
                                 .unit = desc->unit,
                                 .progress = desc->progress};
    for (int i = 0; i < 3; i++)
        out->dims[i] = sampling->cells[i] + 1;
    HEWN_TRY(hewn_output_create(path, &job.output, error));
    hewn_result result =
        out->format == HEWN_VOLUME_VDB ? hewn_vdb_write(&job, out, error) : hewn_nrrd_write(&job, out, error);
    if (result == HEWN_OK)
        result = hewn_output_finish(&job.output, error);
    hewn_output_destroy(&job.output);
    out->length = job.written;
    if (result != HEWN_OK)
        *out = (hewn_sampling_written){0};
    return result;
}
