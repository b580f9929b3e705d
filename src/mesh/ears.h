/* Choosing where to cut a polygon into triangles; nothing is cut here. */
#ifndef HEWN_SRC_MESH_EARS_H
#define HEWN_SRC_MESH_EARS_H

#include "base/error.h"

/* Whether the corners `a` and `b` of the polygon may be joined by a new edge. */
typedef bool (*hewn_may_join)(const void *user, uint32_t a, uint32_t b);

/* Cuts ears off a polygon of `count` corners, `plane` two numbers each (hewn_plane_project()). `order` gets the count -
 * 3 corners in the order in which they are cut off; each stands between its neighbours among the corners that are left.
 * `*found` is false where every way that was tried needs a forbidden edge. The time is that of count squared.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_ears_cut(const double *plane, uint32_t count, hewn_may_join may_join, const void *user,
                          uint32_t *order, bool *found, hewn_error *error);

#endif
