/* Robust predicates: the exact sign of small determinants of doubles.
 *
 * The answer is right for every finite input. A floating-point filter with a bound on its own error answers most calls;
 * then expansions (Shewchuk 1997), while every coordinate is 0 or between 2^-305 and 2^330 in size; beyond that, wide
 * integers. No state: safe from any thread. Needs rounding to nearest, and neither contraction nor fast-math. */
#ifndef HEWN_SRC_GEOM_PREDICATES_H
#define HEWN_SRC_GEOM_PREDICATES_H

#include <math.h>

/* What the filters call where they cannot tell. */
int hewn_orient2d_exact(const double a[2], const double b[2], const double c[2]);
int hewn_orient3d_exact(const double a[3], const double b[3], const double c[3], const double d[3]);

/* About the bounds: with e = 2^-53 the rounding error of the determinant is below 3e (2D) and 7e (3D) times the same
 * expression in absolute values. The small addends make up for products that vanish below the smallest double, and an
 * overflow makes the bound infinite or not a number, which no determinant exceeds. */
#define HEWN_PREDICATE_TINY 0x1p-1000

/* 1 where a, b, c turn left (counter-clockwise), -1 where they turn right, 0 where they are collinear. */
static inline int hewn_orient2d(const double a[2], const double b[2], const double c[2])
{
    double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]);
    double determinant = left - right;
    double bound = 0x1p-51 * (fabs(left) + fabs(right) + HEWN_PREDICATE_TINY);
    if (determinant > bound)
        return 1;
    if (-determinant > bound)
        return -1;
    return hewn_orient2d_exact(a, b, c);
}

/* 1 where d lies on the side of the plane abc from which a, b, c are seen counter-clockwise, -1 on the other side, 0 in
 * the plane (or where a, b, c are collinear): the sign of (b - a) × (c - a) · (d - a). */
static inline int hewn_orient3d(const double a[3], const double b[3], const double c[3], const double d[3])
{
    double u[3], v[3], w[3];
    for (int i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        v[i] = c[i] - a[i];
        w[i] = d[i] - a[i];
    }
    double p0 = u[1] * v[2], q0 = u[2] * v[1], p1 = u[2] * v[0], q1 = u[0] * v[2], p2 = u[0] * v[1], q2 = u[1] * v[0];
    double determinant = w[0] * (p0 - q0) + w[1] * (p1 - q1) + w[2] * (p2 - q2);
    double size = fabs(w[0]) * (fabs(p0) + fabs(q0) + HEWN_PREDICATE_TINY) +
                  fabs(w[1]) * (fabs(p1) + fabs(q1) + HEWN_PREDICATE_TINY) +
                  fabs(w[2]) * (fabs(p2) + fabs(q2) + HEWN_PREDICATE_TINY);
    double bound = 0x1p-50 * (size + HEWN_PREDICATE_TINY);
    if (determinant > bound)
        return 1;
    if (-determinant > bound)
        return -1;
    return hewn_orient3d_exact(a, b, c, d);
}

#endif
