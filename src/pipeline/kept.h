/* What a job leaves for the next one. */
#ifndef HEWN_SRC_PIPELINE_KEPT_H
#define HEWN_SRC_PIPELINE_KEPT_H

#include "hewn/job.h"
#include "pipeline/opening.h"

/* Zero is the empty one. */
struct hewn_mesh_kept {
    hewn_opening opening;
    hewn_extractor *extractor;
};

/* Begins to open a device, unless one is open. `choice` must live until the opening was waited for. */
void hewn_mesh_kept_open(hewn_mesh_kept *kept, const char *choice, bool validation);

/* Makes the kept extractor one of this field: by new numbers where that is enough, else by compiling. */
hewn_result hewn_mesh_kept_compile(hewn_mesh_kept *kept, hewn_device *device, const hewn_field *field,
                                   hewn_error *error);

/* Gives back the extractor and the device; the opening's count of messages stays. */
void hewn_mesh_kept_close(hewn_mesh_kept *kept);

#endif
