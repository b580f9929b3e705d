/* Bounds, volume and area; sums that do not depend on threads or on the order of faces. */
#ifndef HEWN_SRC_MESH_CHECK_MEASURE_H
#define HEWN_SRC_MESH_CHECK_MEASURE_H

#include <math.h>

#include "geom/exact_sum.h"
#include "mesh/check_components.h"

/* --- one triangle ------------------------------------------------------------------------------------------------- */

typedef struct hewn_measured {
    double volume; /* × 6, of the tetrahedron that it spans with an origin */
    double area;   /* × 2 */
    bool flat;     /* the normal is tiny beside the sides: only exact arithmetic tells whether it is 0 */
} hewn_measured;

/* A squared normal above `doubt` is no rounding error; infinity where that is not known of a whole mesh. */
static inline hewn_measured hewn_measure_corners(const double a[3], const double b[3], const double c[3],
                                                 const double origin[3], double doubt)
{
    double u[3], v[3], w[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = b[axis] - a[axis];
        v[axis] = c[axis] - a[axis];
        w[axis] = a[axis] - origin[axis];
    }
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    hewn_measured one = {.volume = w[0] * n[0] + w[1] * n[1] + w[2] * n[2], .area = sqrt(square)};
    if (!(square > doubt)) {
        double factors = (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        one.flat = !(square > 1e-24 * factors && square > 1e-200);
    }
    return one;
}

typedef struct hewn_measure_sums {
    hewn_exact_sum volume, area;
    uint64_t flat;
} hewn_measure_sums;

/* At most 1.5 * 2^30 times before the sums are joined to others. */
static inline void hewn_measure_sums_add(hewn_measure_sums *sums, hewn_measured one)
{
    hewn_exact_sum_add(&sums->volume, one.volume);
    hewn_exact_sum_add(&sums->area, one.area);
    sums->flat += one.flat;
}

void hewn_measure_sums_join(hewn_measure_sums *sums, hewn_measure_sums *part);

/* --- a mesh ------------------------------------------------------------------------------------------------------- */

typedef struct hewn_measure {
    hewn_box bounds; /* of the vertices that faces name; all 0 where there is none */
    double volume;   /* signed; infinite where it is beyond the doubles */
    double area;
    uint64_t flat_triangles; /* of an area of exactly 0 */
} hewn_measure;

/* Bounds of all vertices that faces name. */
void hewn_measure_bounds(const hewn_face_view *view, hewn_box *out);

/* Volume, area and flat triangles of triangles within out->bounds. Reports progress from 0.1 to 0.3 of `stage`.
 * HEWN_CANCELLED. */
hewn_result hewn_measure_triangles(const hewn_triangle_view *mesh, const char *stage, const hewn_progress *progress,
                                   hewn_measure *out, hewn_error *error);

/* The same for each slot of the components but the last, bounds included; a triangle belongs to the slot of its first
 * corner. Flat triangles are not counted. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_measure_components(const hewn_face_view *view, const hewn_triangle_view *mesh,
                                    const hewn_components *components, hewn_measure *out, hewn_error *error);

#endif
