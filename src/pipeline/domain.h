/* Where a job looks for the surface. */
#ifndef HEWN_SRC_PIPELINE_DOMAIN_H
#define HEWN_SRC_PIPELINE_DOMAIN_H

#include "hewn/job.h"

/* HEWN_INVALID_ARGUMENT unless all six sides are finite and lo < hi on each axis. */
hewn_result hewn_domain_check(const hewn_box *bounds, hewn_error *error);

/* The bounds that the job asks for, else the scene's own, else the field's proven box with a margin of about two cells,
 * so that the surface cannot touch it. HEWN_BAD_INPUT where there are none, saying how to give them. */
hewn_result hewn_domain_choose(const hewn_mesh_job_desc *desc, const hewn_scene *scene, hewn_box *out,
                               hewn_bounds_source *source, hewn_error *error);

#endif
