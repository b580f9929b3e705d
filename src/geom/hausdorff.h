/* How far the points of one surface are from another, bounded from both sides. */
#ifndef HEWN_SRC_GEOM_HAUSDORFF_H
#define HEWN_SRC_GEOM_HAUSDORFF_H

#include "geom/bvh.h"

/* The greatest distance from a point of one surface to the nearest point of the other: certainly not above `high` (also
 * in spite of rounding), and not below `low`, where a point was found. */
typedef struct hewn_reach {
    double low, high;
} hewn_reach;

/* From the triangles of `from` to those of `to`, of which `bvh` is the hierarchy. Each triangle is cut up until every
 * piece is proven: the distance to one triangle is convex, so over a piece it is greatest at a corner, and the least of
 * that over a few triangles bounds the piece (after Guthe, Borodin and Klein 2005, 'Fast and accurate Hausdorff
 * distance calculation between meshes'). Pieces are cut along
 * the planes through the edges of the nearest triangle and its normal, so that surfaces which lie in each other need no
 * endless pieces.
 *
 * `high` is above `low` by the share `tolerance` of it, or by `floor`, a length, if that is more; in degenerate places
 * where pieces do not end it may be more. `limit` and `far` (or NULL), one a triangle of `from`: 1 where the triangle
 * has points that were not proven to be within the limit, else 0. The same for any number of threads.
 * HEWN_OUT_OF_MEMORY. */
typedef struct hewn_reach_desc {
    double tolerance, floor, limit;
    uint8_t *far;
} hewn_reach_desc;

hewn_result hewn_surface_reach(const hewn_triangle_view *from, const hewn_triangle_view *to, const hewn_bvh *bvh,
                               const hewn_reach_desc *desc, hewn_reach *out, hewn_error *error);

/* Looks only at some points: corners, and `inner` rows of points within each triangle. Marks in `far`, one a triangle
 * of `from`, those with a point that is further away than the share `near` of `limit`; `*count` is how many have one
 * beyond the limit itself. Those are too far for certain; others may be too far still. The same for any number of
 * threads. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_surface_glance(const hewn_triangle_view *from, const hewn_triangle_view *to, const hewn_bvh *bvh,
                                uint32_t inner, double limit, double near, uint8_t *far, uint64_t *count,
                                hewn_error *error);

#endif
