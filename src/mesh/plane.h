/* Polygons seen in the plane. */
#ifndef HEWN_SRC_MESH_PLANE_H
#define HEWN_SRC_MESH_PLANE_H

#include "base/error.h"

/* Points dropped onto the coordinate plane nearest to the plane of best fit of the first `count`, the corners of a
 * polygon, seen from the side that Newell's normal points to, and scaled by one power of two to at most 1 in size.
 * `points` are positions, `out` two numbers each. */
void hewn_plane_project(const double *const *points, uint32_t count, uint32_t point_count, double *out);

/* Mean value coordinates of a point in a polygon of the plane (Hormann and Floater 2006): `weights` sum to 1 and
 * reproduce linear functions. On a side or corner they are those of the side; where the polygon has no area
 * or a weight would exceed 64 in size, all equal.
 */
void hewn_plane_weights(const double *polygon, uint32_t count, const double point[2], double *weights);

#endif
