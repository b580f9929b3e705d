/* The searches behind hewn/check.h, over either kind of positions. */
#ifndef HEWN_SRC_MESH_SELF_INTERSECTIONS_H
#define HEWN_SRC_MESH_SELF_INTERSECTIONS_H

#include "geom/triangle_meet.h"
#include "geom/triangle_view.h"
#include "hewn/check.h"

/* As hewn_count_self_intersections(). */
hewn_result hewn_view_count_self_intersections(const hewn_triangle_view *mesh, uint64_t max_pairs, uint32_t (*pairs)[2],
                                               const hewn_progress *progress, uint64_t *count, hewn_error *error);

/* Faces that were cut into triangles: those of face f are triangles begins[f] to begins[f + 1] - 1. A face of which
 * `simple` is not 0 is not compared with itself. */
typedef struct hewn_cut_faces {
    uint64_t count;
    const uint32_t *begins;
    const uint32_t *faces; /* of each triangle */
    const uint8_t *simple; /* one a face */
} hewn_cut_faces;

/* The same of faces: a pair is counted once where any triangle of the one and any of the other meet improperly. A face
 * whose own triangles do is a pair with itself. `mesh` must be sound. Another 4 bytes a triangle, and a bit for each
 * face and thread. */
hewn_result hewn_count_face_intersections(const hewn_triangle_view *mesh, const hewn_cut_faces *cut, uint64_t max_pairs,
                                          uint32_t (*pairs)[2], const hewn_progress *progress, uint64_t *count,
                                          hewn_error *error);

static inline void hewn_view_facet(const hewn_triangle_view *mesh, uint32_t triangle, hewn_facet *facet)
{
    for (int k = 0; k < 3; k++) {
        facet->index[k] = mesh->corners[3 * (uint64_t)triangle + k];
        hewn_triangle_point(mesh, facet->index[k], facet->point[k]);
    }
}

#endif
