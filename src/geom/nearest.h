/* The triangle of a mesh that is nearest to a point. */
#ifndef HEWN_SRC_GEOM_NEAREST_H
#define HEWN_SRC_GEOM_NEAREST_H

#include "geom/bvh.h"

/* The distance from a point to a point of the closed triangle, its nearest one but for rounding: what is returned is
 * never less than the true distance, but for the rounding of a single subtraction and length. The triangle may have no
 * area. After Ericson 2005, 'Real-time collision detection', 5.1.5. */
double hewn_triangle_reach(const double at[3], const double a[3], const double b[3], const double c[3]);

/* The same to a triangle of a mesh. */
double hewn_view_reach(const hewn_triangle_view *mesh, uint32_t triangle, const double at[3]);

/* The nearest triangle, `*distance` from the point. `guess` is any triangle of the mesh; a near one saves time. Of
 * triangles as near as the guess it is the guess. */
uint32_t hewn_bvh_nearest(const hewn_bvh *bvh, const hewn_triangle_view *mesh, const double at[3], uint32_t guess,
                          double *distance);

/* The same, but any triangle within `enough` ends the search. */
uint32_t hewn_bvh_nearest_within(const hewn_bvh *bvh, const hewn_triangle_view *mesh, const double at[3],
                                 uint32_t guess, double enough, double *distance);

#endif
