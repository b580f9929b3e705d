/* The point of a box that fits planes best, in double and by other means than the shader: the spectrum by rotations of
 * the planes' own columns, the minimum in the box by projected descent, and the nearest one to the mass point among
 * equally good ones by alternating projections. */
#ifndef HEWN_TESTS_ORACLE_QEF_H
#define HEWN_TESTS_ORACLE_QEF_H

#include <stdbool.h>
#include <stddef.h>

typedef struct oracle_qef {
    double mass[3];       /* the point that is preferred where planes say nothing */
    double values[3];     /* singular values, the greatest first */
    double vectors[3][3]; /* their directions */
    int rank;             /* how many of them count */
    double best[3];       /* the best point anywhere, nearest to the mass point */
} oracle_qef;

/* Plane i has the points x with normals[i] . x = normals[i] . points[i]; normals have length 1. Values below `cut` of
 * the greatest are taken for 0. */
oracle_qef oracle_qef_of(const double (*points)[3], const double (*normals)[3], size_t count, const double mass[3],
                         double cut);

/* The distance that the planes which count still have at a point, in the sense of least squares. */
double oracle_qef_error(const oracle_qef *qef, const double at[3]);

/* The best point of a box, and nearest to the mass point among those. */
void oracle_qef_in_box(const oracle_qef *qef, const double lo[3], const double hi[3], double out[3]);

#endif
