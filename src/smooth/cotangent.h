/* Cotangent weights and mixed Voronoi areas (Meyer, Desbrun, Schroeder and Barr 2003), one triangle at a time. */
#ifndef HEWN_SRC_SMOOTH_COTANGENT_H
#define HEWN_SRC_SMOOTH_COTANGENT_H

#include <math.h>

#include "smooth/work.h"

/* What a triangle gives to its corner a: `ab` and `ac` are half the cotangents of the angles that face these edges (at
 * c and b), `area` its part of the mixed area.
 *
 * Cotangents are dot product over twice the area. That area is taken to be at least a small part of the squared sides:
 * all three cotangents of a sliver shrink by one factor, so the Laplacian made of them stays positive semi-definite and
 * finite. The mixed area is that of the true triangle: the part nearer to a than to b and c; where an angle is obtuse a
 * half at that angle and a quarter at the others. */
typedef struct smooth_corner {
    double ab, ac, area;
} smooth_corner;

static const double smooth_least_area = 1e-5;

static inline smooth_corner smooth_corner_of(const double *a, const double *b, const double *c)
{
    double u[3], v[3], w[3], normal[3];
    smooth_between(a, b, u);
    smooth_between(a, c, v);
    smooth_between(b, c, w);
    smooth_cross(u, v, normal);
    double uu = smooth_dot(u, u), vv = smooth_dot(v, v), ww = smooth_dot(w, w);
    double twice = sqrt(smooth_dot(normal, normal)), least = smooth_least_area * (uu + vv + ww);
    double at_a = smooth_dot(u, v), at_b = -smooth_dot(u, w), at_c = smooth_dot(v, w);
    double by = twice > least ? 0.5 / twice : least > 0 ? 0.5 / least : 0;
    smooth_corner corner = {at_c * by, at_b * by, 0};
    if (at_a < 0)
        corner.area = twice / 4;
    else if (at_b < 0 || at_c < 0)
        corner.area = twice / 8;
    else if (twice > 0)
        corner.area = (uu * at_c + vv * at_b) / twice / 8;
    return corner;
}

/* The other two corners of the triangle of a corner, in order. */
static inline void smooth_others(const uint32_t *corners, uint32_t corner, uint32_t *b, uint32_t *c)
{
    uint32_t begin = corner - corner % 3, k = corner % 3;
    *b = corners[begin + (k + 1) % 3];
    *c = corners[begin + (k + 2) % 3];
}

/* At one vertex: the sum of weight * (neighbour - vertex), of the weights' sizes, and of areas. */
typedef struct smooth_star {
    double pull[3], weight, area;
} smooth_star;

static inline smooth_star smooth_star_of(const smooth_work *work, const double *positions, uint32_t v)
{
    smooth_star star = {{0, 0, 0}, 0, 0};
    const uint32_t *corners = work->cut.corners;
    const double *a = positions + 3 * (size_t)v;
    for (uint32_t i = work->fans.first[v]; i < work->fans.first[v + 1]; i++) {
        uint32_t vb, vc;
        smooth_others(corners, work->fans.items[i], &vb, &vc);
        const double *b = positions + 3 * (size_t)vb, *c = positions + 3 * (size_t)vc;
        smooth_corner corner = smooth_corner_of(a, b, c);
        for (int axis = 0; axis < 3; axis++)
            star.pull[axis] += corner.ab * (b[axis] - a[axis]) + corner.ac * (c[axis] - a[axis]);
        star.weight += fabs(corner.ab) + fabs(corner.ac);
        star.area += corner.area;
    }
    return star;
}

#endif
