/* Three doubles. */
#ifndef HEWN_SRC_SIMPLIFY_VECTOR_H
#define HEWN_SRC_SIMPLIFY_VECTOR_H

#include <math.h>
#include <stdbool.h>

static inline double simplify_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void simplify_cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* From `from` to `to`. */
static inline void simplify_between(const double from[3], const double to[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = to[axis] - from[axis];
}

/* Twice the area of a triangle, along its normal. */
static inline void simplify_area_vector(const double a[3], const double b[3], const double c[3], double out[3])
{
    double u[3], v[3];
    simplify_between(a, b, u);
    simplify_between(a, c, v);
    simplify_cross(u, v, out);
}

/* Whether faces of two area vectors bend by more than the angle of a cosine; those without area do not. */
static inline bool simplify_bends(const double a[3], const double b[3], double cosine)
{
    const double lengths = simplify_dot(a, a) * simplify_dot(b, b);
    return lengths > 0 && simplify_dot(a, b) < cosine * sqrt(lengths);
}

#endif
