/* Cotangent weights and mixed Voronoi areas (Meyer, Desbrun, Schroeder and Barr 2003), one triangle at a time. */
#ifndef HEWN_SRC_SMOOTH_COTANGENT_H
#define HEWN_SRC_SMOOTH_COTANGENT_H

#include <math.h>

#include "smooth/work.h"

/* Half the cotangent of the angle at each corner of a triangle, and twice its area.
 *
 * Cotangents are dot product over twice the area. That area is taken to be at least a small part of the squared sides:
 * all three cotangents of a sliver shrink by one factor, so the Laplacian made of them stays positive semi-definite and
 * finite. */
typedef struct smooth_triangle {
    double half[3], twice;
} smooth_triangle;

static const double smooth_least_area = 1e-5;

static inline smooth_triangle smooth_triangle_of(const double *a, const double *b, const double *c)
{
    double u[3], v[3], w[3], normal[3];
    smooth_between(a, b, u);
    smooth_between(a, c, v);
    smooth_between(b, c, w);
    smooth_cross(u, v, normal);
    double twice = sqrt(smooth_dot(normal, normal));
    double least = smooth_least_area * (smooth_dot(u, u) + smooth_dot(v, v) + smooth_dot(w, w));
    double by = twice > least ? 0.5 / twice : least > 0 ? 0.5 / least : 0;
    return (smooth_triangle){{by * smooth_dot(u, v), by * -smooth_dot(u, w), by * smooth_dot(v, w)}, twice};
}

static inline void smooth_measure_triangles(const smooth_work *work, smooth_triangle *out)
{
    const uint32_t *corners = work->cut.corners;
#pragma omp parallel for schedule(static)
    for (uint64_t t = 0; t < work->cut.face_count; t++)
        out[t] = smooth_triangle_of(work->at + 3 * (size_t)corners[3 * t], work->at + 3 * (size_t)corners[3 * t + 1],
                                    work->at + 3 * (size_t)corners[3 * t + 2]);
}

/* What a triangle gives to its corner a, which sees its edges to b and c as u and v: `ab` and `ac` are the weights of
 * these edges, `area` the part of the mixed area: that nearer to a than to b and c; where an angle is obtuse a half at
 * that angle and a quarter at the others, and a third of a sliver. */
typedef struct smooth_corner {
    double ab, ac, area;
} smooth_corner;

static inline smooth_corner smooth_corner_of(const smooth_triangle *triangle, uint32_t at, const double u[3],
                                             const double v[3])
{
    double half_a = triangle->half[at], half_b = triangle->half[(at + 1) % 3], half_c = triangle->half[(at + 2) % 3];
    double twice = triangle->twice, uu = smooth_dot(u, u), vv = smooth_dot(v, v), uv = smooth_dot(u, v);
    smooth_corner corner = {half_c, half_b, (uu * half_c + vv * half_b) / 4};
    if (half_a < 0)
        corner.area = twice / 4;
    else if (half_b < 0 || half_c < 0)
        corner.area = twice / 8;
    else if (twice <= 2 * smooth_least_area * (uu + vv - uv))
        corner.area = twice / 6;
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

static inline smooth_star smooth_star_of(const smooth_work *work, const smooth_triangle *triangles, uint32_t v)
{
    smooth_star star = {{0, 0, 0}, 0, 0};
    const double *a = work->at + 3 * (size_t)v;
    for (uint32_t i = work->fans.first[v]; i < work->fans.first[v + 1]; i++) {
        uint32_t at = work->fans.items[i], vb, vc;
        double b[3], c[3];
        smooth_others(work->cut.corners, at, &vb, &vc);
        smooth_between(a, work->at + 3 * (size_t)vb, b);
        smooth_between(a, work->at + 3 * (size_t)vc, c);
        smooth_corner corner = smooth_corner_of(triangles + at / 3, at % 3, b, c);
        for (int axis = 0; axis < 3; axis++)
            star.pull[axis] += corner.ab * b[axis] + corner.ac * c[axis];
        star.weight += fabs(corner.ab) + fabs(corner.ac);
        star.area += corner.area;
    }
    return star;
}

#endif
