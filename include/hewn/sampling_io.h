/* Samplings into volume files, as level sets: signed distances, negative inside. */
#ifndef HEWN_SAMPLING_IO_H
#define HEWN_SAMPLING_IO_H

#include "hewn/sampling.h"
#include "hewn/units.h"
#include "hewn/volume_io.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero is the default.
 *
 * band: distances past this many cells are written as that many; 0: 3. In a .vdb file only samples within it are
 * active, and what is inside and farther away are tiles.
 * dense: all samples, with their own values. */
typedef struct hewn_sampling_write_desc {
    hewn_volume_format
        format; /* HEWN_VOLUME_UNKNOWN: from the name; HEWN_VOLUME_VDB and HEWN_VOLUME_NRRD are written */
    double band;
    bool dense;
    const hewn_unit *unit;         /* told where the format can; NULL: nobody knows */
    const hewn_progress *progress; /* or NULL; the stage is "write" */
} hewn_sampling_write_desc;

typedef struct hewn_sampling_written {
    hewn_volume_format format;
    uint32_t dims[3]; /* samples along each axis */
    uint64_t active;  /* of a .vdb, else all */
    uint64_t leaves;  /* of a .vdb */
    uint64_t length;  /* of the file, bytes */
} hewn_sampling_written;

/* The format that a sampling would be written in. HEWN_INVALID_ARGUMENT where the name tells none that can be. */
HEWN_API hewn_result hewn_sampling_format(const char *path, hewn_volume_format format, hewn_volume_format *out,
                                          hewn_error *error);

/* Writes a sampling that is not flat. A .vdb file gets one grid of floats, "surface", of the class "level set" in world
 * space (Museth 2013, 'VDB: high-resolution sparse volumes with dynamic topology'); a .nrrd file (gzip) all samples as
 * floats with the directions of its axes. "-" is standard output. HEWN_INVALID_ARGUMENT, HEWN_IO, HEWN_LIMIT,
 * HEWN_MISSING_FEATURE where OpenVDB cannot be loaded, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
HEWN_API hewn_result hewn_sampling_write(const hewn_sampling *sampling, const hewn_sampling_place *place,
                                         const hewn_sampling_write_desc *desc, const char *path,
                                         hewn_sampling_written *out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
