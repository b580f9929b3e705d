/* A hole on its way to being filled: its rim, what the mesh around it says, and the patch that grows in it. Internal to
 * filling. Positions here are relative to the hole's centre and size, so that they cannot overflow. */
#ifndef HEWN_SRC_MESH_HOLE_H
#define HEWN_SRC_MESH_HOLE_H

#include "mesh/soup.h"

/* A triangle of the patch: edge k runs from vertices[k] to vertices[(k + 1) % 3] and has triangle near[k] on its other
 * side, HEWN_NONE along the rim. */
typedef struct hewn_patch_face {
    uint32_t vertices[3];
    uint32_t near[3];
} hewn_patch_face;

/* Vertices 0 to rim_count - 1 are the rim, in the order in which the patch's faces run along it; the rest are new. */
typedef struct hewn_hole {
    uint32_t rim_count;
    uint32_t *rim;      /* the soup's vertices */
    double *normals;    /* × 3, unit: of the face across rim edge i, i + 1 */
    double *outer;      /* × 3: what the faces of the mesh give to the Laplacian at rim vertex i */
    double *outer_area; /* and to the area it stands for */
    uint8_t *joined;    /* rim_count²: whether an edge of the mesh joins the two */
    bool pillow;        /* a triangle already spans the rim's three vertices */
    double centre[3], size;
    uint32_t vertex_count, face_count;
    double *positions; /* × 3 */
    double *spacing;   /* the length that edges at a vertex should have */
    hewn_patch_face *faces;
    size_t position_capacity, spacing_capacity, face_capacity;
} hewn_hole;

/* The best triangulation of the rim (Barequet and Sharir 1995, weighed as in Liepa 2003). `*found` is false where every
 * one needs an edge or face that exists. */
hewn_result hewn_hole_triangulate(hewn_hole *hole, bool *found, hewn_error *error);

/* Adds vertices until triangles are about as large as the rim's spacing asks, flipping edges to stay near Delaunay
 * (Liepa 2003, after Pfeifle and Seidel 1996). At most rim_count² / 4 + 16 vertices. */
hewn_result hewn_hole_refine(hewn_hole *hole, hewn_error *error);

/* Moves the new vertices to where the squared Laplacian (rim included, so that the patch leaves it smoothly) is least:
 * a thin plate, its Laplacian by cotangents as in Meyer et al. 2003, solved by conjugate gradients. */
hewn_result hewn_hole_fair(hewn_hole *hole, hewn_error *error);

/* Whether an edge of the mesh or the patch joins vertices a and b; `face` is one at a. */
bool hewn_hole_has_edge(const hewn_hole *hole, uint32_t face, uint32_t a, uint32_t b);

/* Adds to `out` what a triangle at `corner` gives to the Laplacian there, as if it had the other two vertices only:
 * half the cotangent at each end times the edge to the other. Returns a third of its area. All are positions of a hole.
 */
double hewn_hole_corner(const double *corner, const double *a, const double *b, double out[3]);

/* Half the cotangent of the angle at `tip` over the edge a, b; kept between -50 and 50. */
double hewn_hole_cotangent(const double *tip, const double *a, const double *b);

/* Twice the area vector of three vertices of the hole; and its length. */
double hewn_hole_normal(const hewn_hole *hole, uint32_t a, uint32_t b, uint32_t c, double out[3]);

#endif
