/* The search behind hewn/check.h, over either kind of positions. */
#ifndef HEWN_SRC_MESH_SELF_INTERSECTIONS_H
#define HEWN_SRC_MESH_SELF_INTERSECTIONS_H

#include "geom/triangle_view.h"
#include "hewn/check.h"

/* As hewn_count_self_intersections(). */
hewn_result hewn_view_count_self_intersections(const hewn_triangle_view *mesh, uint64_t max_pairs, uint32_t (*pairs)[2],
                                               const hewn_progress *progress, uint64_t *count, hewn_error *error);

#endif
