/* Polygons between labels cut into triangles. */
#ifndef HEWN_SRC_LABELS_CUT_H
#define HEWN_SRC_LABELS_CUT_H

#include "labels/nets.h"

/* Fills in vertices (in the lattice still), triangles and sides of `out`. Quads are cut along the diagonal that is
 * shorter by the 3 x 3 part of `to_world`, of those that stay in the quad's envelope (docs/extraction.md); where
 * neither does, and where there are more corners, triangles fan out from a vertex on the grid edge. HEWN_LIMIT,
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_label_nets_cut(const hewn_label_nets *nets, const double to_world[16], hewn_label_mesh *out,
                                hewn_error *error);

#endif
