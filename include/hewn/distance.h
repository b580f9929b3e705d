/* How far two surfaces are apart: the Hausdorff distance, bounded from both sides. */
#ifndef HEWN_DISTANCE_H
#define HEWN_DISTANCE_H

#include "hewn/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What to do; zero means the default.
 *
 * tolerance: how far the upper bound may be above the lower one, as a share of it; 0: 0.01. Distances below 1e-6 of the
 * diagonal of both boxes together are told to that length. */
typedef struct hewn_distance_desc {
    double tolerance;
    const hewn_progress *progress; /* may be NULL; the stage is "measure" */
} hewn_distance_desc;

/* Lengths. `there` is the greatest distance from a point of the first surface to the nearest point of the second,
 * `back` the same the other way; the Hausdorff distance is the greater of the two. The true numbers lie between those
 * with `low` and those without. These are proven for all points, not for samples; rounding is accounted for. Where
 * triangles lie so that proofs do not end, the upper bound may be further away than the tolerance. */
typedef struct hewn_distance {
    double there_low, there;
    double back_low, back;
    double low, high;
} hewn_distance;

/* Measures the surfaces of polygons, cut into triangles. Isolated vertices do not count. `desc` may be NULL. The same
 * for any number of threads.
 *
 * HEWN_BAD_INPUT for a position, index or order of faces that cannot be used, naming the first, and for a surface
 * without faces; HEWN_LIMIT for 2^32 or more corners; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. Safe from any thread while
 * nobody changes the arrays. About 120 bytes a triangle of memory. */
HEWN_API hewn_result hewn_polygons_distance(const hewn_polygons *one, const hewn_polygons *two,
                                            const hewn_distance_desc *desc, hewn_distance *out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
