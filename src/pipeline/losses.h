/* What a format cannot hold of a model. */
#ifndef HEWN_SRC_PIPELINE_LOSSES_H
#define HEWN_SRC_PIPELINE_LOSSES_H

#include "hewn/file_job.h"

/* Compares a model, in the unit in which it will be written, with what the format keeps. The names are the caller's;
 * leave them with hewn_losses_destroy(). HEWN_OUT_OF_MEMORY. */
hewn_result hewn_losses_find(const hewn_model *model, hewn_mesh_format format, hewn_file_losses *out,
                             hewn_error *error);
void hewn_losses_destroy(hewn_file_losses *losses);

#endif
