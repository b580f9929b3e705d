/* Whether readers that weld equal positions would lose what is one vertex and what is not. */
#ifndef HEWN_SRC_IO_GLB_TOPOLOGY_H
#define HEWN_SRC_IO_GLB_TOPOLOGY_H

#include "io/glb_plan.h"

/* None is needed where no vertex was split and no two have the same position in the file. HEWN_OUT_OF_MEMORY,
 * HEWN_CANCELLED. */
hewn_result hewn_glb_find_topology(const hewn_writing *job, const hewn_glb_plan *plan, hewn_gltf_topology *out,
                                   hewn_error *error);

#endif
