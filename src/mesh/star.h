/* Vertex stars: the triangles around each vertex, and what they say of its edges and of itself. Internal to the
 * certificate. */
#ifndef HEWN_SRC_MESH_STAR_H
#define HEWN_SRC_MESH_STAR_H

#include "hewn/triangles.h"

/* Below this many vertices or triangles, waking other threads costs more than it saves. */
enum { HEWN_CERTIFY_ALONE = 1 << 14 };

/* The triangles at each vertex in compressed rows: those of vertex v are triangles[first[v]] to triangles[first[v + 1]
 * - 1], ascending. Triangles with two equal corners are in no row. */
typedef struct hewn_stars {
    uint32_t *first; /* vertex_count + 1 */
    uint32_t *triangles;
    uint32_t longest; /* row */
} hewn_stars;

/* What a set of stars adds up to. Sums of integers, so any order gives the same. */
typedef struct hewn_star_counts {
    uint64_t used_vertices; /* with at least one triangle */
    uint64_t edges;         /* each counted at its lesser end, as the next three are */
    uint64_t boundary_edges;
    uint64_t non_manifold_edges;
    uint64_t unoriented_edges; /* two faces or more, and not as many of them one way as the other */
    uint64_t non_manifold_vertices;
} hewn_star_counts;

/* Sorts triangles into rows. All indices must be in range, and 3 × triangle_count below 2^32. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_stars_build(const hewn_triangles *mesh, hewn_stars *out, hewn_error *error);
void hewn_stars_free(hewn_stars *stars);

/* Adds what the stars of the vertices begin to end - 1 say to `counts`. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_stars_examine(const hewn_triangles *mesh, const hewn_stars *stars, uint64_t begin, uint64_t end,
                               hewn_star_counts *counts, hewn_error *error);

static inline bool hewn_triangle_collapsed(const uint32_t *corner)
{
    return corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
}

#endif
