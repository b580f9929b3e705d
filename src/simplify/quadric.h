/* Quadrics of weighted squared distances to planes (Garland and Heckbert 1997, 'Surface simplification using quadric
 * error metrics'), in double and in coordinates of at most 1. */
#ifndef HEWN_SRC_SIMPLIFY_QUADRIC_H
#define HEWN_SRC_SIMPLIFY_QUADRIC_H

#include <math.h>
#include <stdbool.h>

#include "simplify/vector.h"

/* The value at x is x' A x + 2 b' x + c; A row by row from the diagonal: xx xy xz yy yz zz. `weight` is the sum of the
 * weights of surface planes, so that the root of value / weight is a distance. */
typedef struct simplify_quadric {
    double a[6], b[3], c, weight;
} simplify_quadric;

/* Adds the plane through a point with a unit normal. */
static inline void simplify_quadric_add_plane(simplify_quadric *q, const double normal[3], const double point[3],
                                              double weight)
{
    double away = -simplify_dot(normal, point), x = weight * normal[0], y = weight * normal[1], z = weight * normal[2];
    q->a[0] += x * normal[0];
    q->a[1] += x * normal[1];
    q->a[2] += x * normal[2];
    q->a[3] += y * normal[1];
    q->a[4] += y * normal[2];
    q->a[5] += z * normal[2];
    q->b[0] += x * away;
    q->b[1] += y * away;
    q->b[2] += z * away;
    q->c += weight * away * away;
}

/* Adds the squared distance to a point. */
static inline void simplify_quadric_add_point(simplify_quadric *q, const double point[3], double weight)
{
    q->a[0] += weight;
    q->a[3] += weight;
    q->a[5] += weight;
    for (int axis = 0; axis < 3; axis++)
        q->b[axis] -= weight * point[axis];
    q->c += weight * simplify_dot(point, point);
}

static inline void simplify_quadric_add(simplify_quadric *q, const simplify_quadric *other)
{
    for (int i = 0; i < 6; i++)
        q->a[i] += other->a[i];
    for (int i = 0; i < 3; i++)
        q->b[i] += other->b[i];
    q->c += other->c;
    q->weight += other->weight;
}

static inline void simplify_quadric_sum(const simplify_quadric *p, const simplify_quadric *q, simplify_quadric *sum)
{
    for (int i = 0; i < 6; i++)
        sum->a[i] = p->a[i] + q->a[i];
    for (int i = 0; i < 3; i++)
        sum->b[i] = p->b[i] + q->b[i];
    sum->c = p->c + q->c;
    sum->weight = p->weight + q->weight;
}

/* Half the gradient. */
static inline void simplify_quadric_slope(const simplify_quadric *q, const double x[3], double out[3])
{
    out[0] = q->a[0] * x[0] + q->a[1] * x[1] + q->a[2] * x[2] + q->b[0];
    out[1] = q->a[1] * x[0] + q->a[3] * x[1] + q->a[4] * x[2] + q->b[1];
    out[2] = q->a[2] * x[0] + q->a[4] * x[1] + q->a[5] * x[2] + q->b[2];
}

/* Rounding can make what is 0 a little less. */
static inline double simplify_quadric_value(const simplify_quadric *q, const double x[3])
{
    double slope[3];
    simplify_quadric_slope(q, x, slope);
    double value = simplify_dot(slope, x) + simplify_dot(q->b, x) + q->c;
    return value > 0 ? value : 0;
}

/* A x = r; false where the matrix is singular in double precision. */
static inline bool simplify_quadric_solve(const simplify_quadric *q, const double r[3], double out[3])
{
    const double *a = q->a, tiny = 1e-12 * (a[0] + a[3] + a[5]);
    double d0 = a[0];
    if (!(d0 > tiny))
        return false;
    double l1 = a[1] / d0, l2 = a[2] / d0, d1 = a[3] - l1 * a[1];
    if (!(d1 > tiny))
        return false;
    double m = a[4] - l1 * a[2], l3 = m / d1, d2 = a[5] - l2 * a[2] - l3 * m;
    if (!(d2 > tiny))
        return false;
    double y1 = r[1] - l1 * r[0], y2 = r[2] - l2 * r[0] - l3 * y1;
    out[2] = y2 / d2;
    out[1] = y1 / d1 - l3 * out[2];
    out[0] = r[0] / d0 - l1 * out[1] - l2 * out[2];
    return isfinite(out[0]) && isfinite(out[1]) && isfinite(out[2]);
}

/* Where the value is least, found as a step from `from`. */
static inline bool simplify_quadric_least(const simplify_quadric *q, const double from[3], double out[3])
{
    double slope[3];
    simplify_quadric_slope(q, from, slope);
    if (!simplify_quadric_solve(q, slope, out))
        return false;
    for (int axis = 0; axis < 3; axis++)
        out[axis] = from[axis] - out[axis];
    return true;
}

#endif
