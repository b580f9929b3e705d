/* Checks of a mesh's shape beyond its connections: where it runs through itself. */
#ifndef HEWN_CHECK_H
#define HEWN_CHECK_H

#include "hewn/triangles.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Counts the pairs of faces that meet improperly, exactly (no tolerance; robust predicates, Shewchuk 1997).
 *
 * Two faces meet properly where what their closed triangles have in common is nothing, or exactly the vertex or the
 * edge that they share by index. Everything else is counted: faces that cross, that touch at a point or along a line
 * not shared by index (so also where vertices lie at one place under two indices), that overlap in a plane, that fold
 * back onto each other along a shared edge, and that have the same three vertices. A face without area is the segment
 * or point that its corners span; one that names a vertex twice is the segment of its other edge.
 *
 * `positions`: vertex_count × 3, scene units. `triangles`: triangle_count × 3 indices. `*count` becomes the number of
 * unordered pairs. `pairs`, of room for max_pairs, receives the first of them in lexicographic order, the lower face
 * first in each: min(*count, max_pairs) are written. It may be NULL where max_pairs is 0. The same for any number of
 * threads.
 *
 * About 56 bytes a triangle of memory while it runs, and n log n time plus that of the pairs whose boxes meet: a mesh
 * piled up in one place takes quadratic time. `progress` may be NULL, its stage is "self-intersections".
 *
 * HEWN_BAD_INPUT for an index out of range or a position that is not finite, naming the first; HEWN_INVALID_ARGUMENT
 * for a missing array; HEWN_LIMIT for 2^32 or more triangles or vertices; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. `*count`
 * is then 0, and what `pairs` holds is without meaning. Safe from any thread while nobody changes the arrays. */
HEWN_API hewn_result hewn_count_self_intersections(const double *positions, uint64_t vertex_count,
                                                   const uint32_t *triangles, uint64_t triangle_count,
                                                   uint64_t max_pairs, uint32_t (*pairs)[2],
                                                   const hewn_progress *progress, uint64_t *count, hewn_error *error);

/* The same of triangles with float positions, which are read where they are. */
HEWN_API hewn_result hewn_triangles_count_self_intersections(const hewn_triangles *triangles, uint64_t max_pairs,
                                                             uint32_t (*pairs)[2], const hewn_progress *progress,
                                                             uint64_t *count, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
