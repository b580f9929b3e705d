/* Cutting the faces of a soup into triangles, no vertices added: what export and checks of polygons stand on. */
#ifndef HEWN_SRC_MESH_CUT_H
#define HEWN_SRC_MESH_CUT_H

#include "hewn/mesh.h"

/* Cuts every face into triangles that run as the face does. A face of n corners gives n - 2, one of fewer than three
 * none; the triangles of a face follow those of the faces before it. `*triangle_corners` gets three positions in
 * `polygons->corners` a triangle, from the heap, for the caller to hewn_free().
 *
 * Triangles stay as they are, quadrilaterals take the diagonal that lies inside (of two the one with the better
 * triangles), larger faces are cut as hewn_ears_cut() does, all exactly and in the coordinate plane nearest to the
 * plane of best fit. A diagonal that is an edge or a diagonal elsewhere in the soup is avoided, so that a manifold soup
 * stays manifold; where every way needs such a one it is taken all the same. A face with a position that is not finite
 * becomes a fan. A face that names a vertex twice may give triangles that do.
 *
 * Linear time in practice. Deterministic. HEWN_BAD_INPUT for an index out of range or faces that do not follow each
 * other, HEWN_LIMIT for 2^32 corners or vertices and more, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. `progress` may be NULL,
 * its stage is "triangulate". Safe from any thread while nobody changes the soup. */
hewn_result hewn_cut_polygons(const hewn_polygons *polygons, uint32_t **triangle_corners, uint64_t *triangle_count,
                              const hewn_progress *progress, hewn_error *error);

#endif
