/* What the writers of samplings share. */
#ifndef HEWN_SRC_IO_VOLUME_SAMPLING_WRITE_H
#define HEWN_SRC_IO_VOLUME_SAMPLING_WRITE_H

#include "base/file.h"
#include "field/sampling.h"
#include "hewn/sampling_io.h"

typedef struct hewn_sampling_writing {
    const hewn_sampling *sampling;
    const hewn_sampling_place *place;
    double band; /* in cells */
    bool dense;
    const hewn_unit *unit;
    const hewn_progress *progress;
    hewn_output *output;
    uint64_t written; /* bytes */
} hewn_sampling_writing;

hewn_result hewn_vdb_write(hewn_sampling_writing *job, hewn_sampling_written *out, hewn_error *error);
hewn_result hewn_nrrd_write(hewn_sampling_writing *job, hewn_sampling_written *out, hewn_error *error);

#endif
