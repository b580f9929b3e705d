/* Vertices that differ. */
#ifndef HEWN_SRC_GEOM_DISTINCT_H
#define HEWN_SRC_GEOM_DISTINCT_H

#include "hewn/triangles.h"

/* Moves vertices that are exactly where one before them is to the next float along x that is free, so that readers
 * which weld equal positions find the same mesh. `moved` (or NULL) is how many; most meshes need none. Takes up to 16
 * bytes a vertex. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_triangles_make_distinct(hewn_triangles *triangles, uint64_t *moved, hewn_error *error);

#endif
