/* Other ways to write a mesh's connections down: the corner table and the winged edge. Both hold neither positions nor
 * attributes, and convert both ways to the same topology and ids. */
#ifndef HEWN_MESH_VIEWS_H
#define HEWN_MESH_VIEWS_H

#include "hewn/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Triangles as two tables over their corners (Rossignac, Safonova and Szymczak 2001, '3D compression made simple:
 * Edgebreaker on a corner-table'): triangle t has the corners 3 t to 3 t + 2, counter-clockwise. Zero is the empty one.
 */
typedef struct hewn_corner_table {
    uint32_t vertex_count, triangle_count;
    uint32_t *vertices;  /* V: the vertex at each corner */
    uint32_t *opposites; /* O: the corner across the side that faces each corner, or HEWN_NONE at a boundary */
} hewn_corner_table;

/* Vertices and triangles keep their ids, and triangles their first corner. HEWN_INVALID_ARGUMENT for a mesh with holes
 * (hewn_mesh_compact() first) or a face that is no triangle; HEWN_LIMIT past 2^32 - 2 corners; HEWN_OUT_OF_MEMORY. The
 * table is the caller's. */
HEWN_API hewn_result hewn_corner_table_from_mesh(const hewn_mesh *mesh, hewn_corner_table *out, hewn_error *error);

/* The mesh of a table and of positions (vertex_count × 3). Its half-edges are numbered as hewn_mesh_from_polygons()
 * does. HEWN_BAD_INPUT where that would refuse the triangles, or where the opposites are not what the vertices say. */
HEWN_API hewn_result hewn_corner_table_to_mesh(const hewn_corner_table *table, const double *positions, hewn_mesh **out,
                                               hewn_error *error);
HEWN_API void hewn_corner_table_destroy(hewn_corner_table *table);

/* One edge and its four wings (Baumgart 1975, 'A polyhedron representation for computer vision'). It runs from `start`
 * to `end` between its faces; the wings are the edges before and after it along each face, counter-clockwise. Where a
 * face is HEWN_NONE its wings are those of the boundary loop. */
typedef struct hewn_winged_edge {
    uint32_t start, end;
    uint32_t left, right;
    uint32_t left_prev, left_next;
    uint32_t right_prev, right_next;
} hewn_winged_edge;

typedef struct hewn_winged_edges {
    uint32_t vertex_count, edge_count, face_count;
    hewn_winged_edge *edges;
    uint32_t *vertex_edges; /* one edge of each vertex, a boundary one if there is one; HEWN_NONE where isolated */
    uint32_t *face_edges;   /* of each face the edge that ends, along the face, at its first corner */
} hewn_winged_edges;

/* Edge e is that of the half-edges 2 e, which runs from start to end, and 2 e + 1. HEWN_INVALID_ARGUMENT for a mesh
 * with holes; HEWN_OUT_OF_MEMORY. The records are the caller's. */
HEWN_API hewn_result hewn_winged_edges_from_mesh(const hewn_mesh *mesh, hewn_winged_edges *out, hewn_error *error);

/* The mesh of records and of positions (vertex_count × 3), all ids of half-edges included. HEWN_BAD_INPUT, naming the
 * first offender, where the records contradict each other or are not 2-manifold. */
HEWN_API hewn_result hewn_winged_edges_to_mesh(const hewn_winged_edges *edges, const double *positions, hewn_mesh **out,
                                               hewn_error *error);
HEWN_API void hewn_winged_edges_destroy(hewn_winged_edges *edges);

#ifdef __cplusplus
}
#endif
#endif
