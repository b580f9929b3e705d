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

/* Half of one over that area. Without a branch, for loops over many. */
static inline double smooth_half_inverse(double twice, double least)
{
    const double area = twice > least ? twice : least, inverse = 0.5 / (area > 0 ? area : 1);
    return area > 0 ? inverse : 0;
}

/* Of the triangle whose edges from its first corner are u and v. */
static inline smooth_triangle smooth_triangle_between(const double u[3], const double v[3])
{
    double w[3], normal[3];
    smooth_between(u, v, w);
    smooth_cross(u, v, normal);
    const double twice = sqrt(smooth_dot(normal, normal));
    const double least = smooth_least_area * (smooth_dot(u, u) + smooth_dot(v, v) + smooth_dot(w, w));
    const double by = smooth_half_inverse(twice, least);
    return (smooth_triangle){{by * smooth_dot(u, v), by * -smooth_dot(u, w), by * smooth_dot(v, w)}, twice};
}

static inline smooth_triangle smooth_triangle_of(const double *a, const double *b, const double *c)
{
    double u[3], v[3];
    smooth_between(a, b, u);
    smooth_between(a, c, v);
    return smooth_triangle_between(u, v);
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

/* By half the cotangents at a, b and c, and the products of u and v. */
static inline smooth_corner smooth_corner_by(const double half[3], double twice, double uu, double vv, double uv)
{
    double area = (uu * half[2] + vv * half[1]) / 4;
    area = twice <= 2 * smooth_least_area * (uu + vv - uv) ? twice / 6 : area;
    area = ((half[1] < 0) | (half[2] < 0)) ? twice / 8 : area;
    area = half[0] < 0 ? twice / 4 : area;
    return (smooth_corner){half[2], half[1], area};
}

static inline smooth_corner smooth_corner_of(const smooth_triangle *triangle, uint32_t at, const double u[3],
                                             const double v[3])
{
    const double half[3] = {triangle->half[at], triangle->half[(at + 1) % 3], triangle->half[(at + 2) % 3]};
    return smooth_corner_by(half, triangle->twice, smooth_dot(u, u), smooth_dot(v, v), smooth_dot(u, v));
}

/* By the products of u and v alone, which lose of the area of a sliver what a float would not show. */
static inline smooth_corner smooth_corner_between(double uu, double vv, double uv)
{
    const double square = uu * vv - uv * uv, twice = sqrt(square > 0 ? square : 0);
    const double by = smooth_half_inverse(twice, 2 * smooth_least_area * (uu + vv - uv));
    const double half[3] = {by * uv, by * (uu - uv), by * (vv - uv)};
    return smooth_corner_by(half, twice, uu, vv, uv);
}

/* The other two corners of the triangle of a corner, in order. */
static inline void smooth_others(const uint32_t *corners, uint32_t corner, uint32_t *b, uint32_t *c)
{
    uint32_t begin = corner - corner % 3, k = corner % 3;
    *b = corners[begin + (k + 1) % 3];
    *c = corners[begin + (k + 2) % 3];
}

/* At one vertex: the sum of weight * (neighbour - vertex), and of areas. */
typedef struct smooth_star {
    double pull[3], area;
} smooth_star;

static inline smooth_star smooth_star_of(const double *at, const smooth_sides *sides, uint32_t v)
{
    smooth_star star = {{0, 0, 0}, 0};
    for (uint32_t i = sides->first[v]; i < sides->first[v + 1]; i++) {
        double b[3], c[3];
        smooth_between(at + 3 * (size_t)v, at + 3 * (size_t)sides->items[i].next, b);
        smooth_between(at + 3 * (size_t)v, at + 3 * (size_t)sides->items[i].before, c);
        const smooth_triangle triangle = smooth_triangle_between(b, c);
        const smooth_corner corner = smooth_corner_of(&triangle, 0, b, c);
        for (int axis = 0; axis < 3; axis++)
            star.pull[axis] += corner.ab * b[axis] + corner.ac * c[axis];
        star.area += corner.area;
    }
    return star;
}

#endif
