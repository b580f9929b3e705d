/* Choosing where to cut a polygon into triangles; nothing is cut here. */
#ifndef HEWN_SRC_MESH_EARS_H
#define HEWN_SRC_MESH_EARS_H

#include "base/error.h"

/* Whether the corners `a` and `b` of the polygon may be joined by a new edge. Where none is given, any two may. */
typedef bool (*hewn_may_join)(const void *user, uint32_t a, uint32_t b);

/* Where to cut a quadrilateral: 0 from corner 0 to corner 2, 1 from corner 1 to corner 3, 2 where nothing that is as
 * right as can be is allowed. A diagonal inside goes before one along the border, that before one outside; of two alike
 * the one whose worse triangle has the better shape. */
uint32_t hewn_quad_cut(const double plane[8], hewn_may_join may_join, const void *user);

/* Cuts ears off a polygon of `count` corners, `plane` two numbers each (hewn_plane_project()), the best shaped first.
 * `order` gets the count - 3 corners in the order in which they are cut off; each stands between its neighbours among
 * the corners that are left. `*found` is false where every way that was tried needs a forbidden edge, which cannot be
 * where none is. n log n time for polygons whose neighbours are near each other, and a constant times that for any:
 * where a tangled polygon of thousands of corners takes too long, the rest is cut with less care. HEWN_OUT_OF_MEMORY.
 */
hewn_result hewn_ears_cut(const double *plane, uint32_t count, hewn_may_join may_join, const void *user,
                          uint32_t *order, bool *found, hewn_error *error);

#endif
