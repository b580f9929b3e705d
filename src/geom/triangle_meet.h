/* Whether two faces of a mesh meet as faces of a mesh may. Exact: signs of predicates and comparisons of coordinates
 * only, no tolerance and no rounded point. */
#ifndef HEWN_SRC_GEOM_TRIANGLE_MEET_H
#define HEWN_SRC_GEOM_TRIANGLE_MEET_H

#include <stdbool.h>
#include <stdint.h>

/* A triangle of a mesh: its vertices and where they are (finite). */
typedef struct hewn_facet {
    uint32_t index[3];
    double point[3][3];
} hewn_facet;

/* Two faces meet properly where what their closed triangles have in common is nothing, or exactly the vertex or edge
 * that they share by index. All else is improper: to cross, to touch at a point or along a line that is not shared by
 * index, to overlap in a plane, to fold back onto each other along a shared edge, and to have the same three vertices.
 * A triangle without area is the segment or the point that its corners span; a face that names one vertex twice spans
 * its other edge only. Symmetric, and the same for any order of the corners. */
bool hewn_facets_meet_improperly(const hewn_facet *f, const hewn_facet *g);

#endif
