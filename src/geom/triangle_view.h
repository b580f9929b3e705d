/* A view of indexed triangles whose positions are floats or doubles: what geometric searches read. Owns nothing. */
#ifndef HEWN_SRC_GEOM_TRIANGLE_VIEW_H
#define HEWN_SRC_GEOM_TRIANGLE_VIEW_H

#include <stdint.h>

typedef struct hewn_triangle_view {
    uint64_t vertex_count;
    uint64_t triangle_count;
    const double *doubles;   /* vertex_count × 3 */
    const float *floats;     /* the same, where doubles is NULL */
    const uint32_t *corners; /* triangle_count × 3 */
} hewn_triangle_view;

static inline void hewn_triangle_point(const hewn_triangle_view *mesh, uint32_t vertex, double out[3])
{
    uint64_t at = 3 * (uint64_t)vertex;
    for (int axis = 0; axis < 3; axis++)
        out[axis] = mesh->doubles ? mesh->doubles[at + axis] : (double)mesh->floats[at + axis];
}

#endif
