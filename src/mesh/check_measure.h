/* Bounds, volume and area, summed in an order that does not depend on threads. */
#ifndef HEWN_SRC_MESH_CHECK_MEASURE_H
#define HEWN_SRC_MESH_CHECK_MEASURE_H

#include "mesh/check_components.h"

typedef struct hewn_measure {
    hewn_box bounds; /* of the vertices that faces name; all 0 where there is none */
    double volume;   /* signed; infinite where it is beyond the doubles */
    double area;
    uint64_t flat_triangles; /* of an area of exactly 0 */
} hewn_measure;

/* Bounds of all vertices that faces name. */
void hewn_measure_bounds(const hewn_face_view *view, hewn_box *out);

/* Volume, area and flat triangles of triangles within out->bounds. Reports progress from 0.1 to 0.3 of `stage`.
 * HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
hewn_result hewn_measure_triangles(const hewn_triangle_view *mesh, const char *stage, const hewn_progress *progress,
                                   hewn_measure *out, hewn_error *error);

/* The same for each slot of the components but the last, bounds included; a triangle belongs to the slot of its first
 * corner. Flat triangles are not counted. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_measure_components(const hewn_face_view *view, const hewn_triangle_view *mesh,
                                    const hewn_components *components, hewn_measure *out, hewn_error *error);

#endif
