/* How far a point is from a triangle. */
#ifndef HEWN_SRC_GEOM_NEAR_TRIANGLE_H
#define HEWN_SRC_GEOM_NEAR_TRIANGLE_H

/* The squared distance from a point to the nearest point of the closed triangle, which may have no area: then it is
 * that to the segment or point which it spans. Rounded like any arithmetic in double. */
double hewn_triangle_distance_squared(const double at[3], const double a[3], const double b[3], const double c[3]);

#endif
