#include "geom/near_triangle.h"

#include <stdbool.h>

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(const double a[3], const double b[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = a[axis] - b[axis];
}

/* To the segment from `from` along `along`. */
static double segment_distance(const double at[3], const double from[3], const double along[3])
{
    double offset[3], length = dot(along, along);
    subtract(at, from, offset);
    double share = length > 0 ? dot(offset, along) / length : 0;
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    for (int axis = 0; axis < 3; axis++)
        offset[axis] -= share * along[axis];
    return dot(offset, offset);
}

double hewn_triangle_distance_squared(const double at[3], const double a[3], const double b[3], const double c[3])
{
    double ab[3], bc[3], ca[3], offset[3], offset_b[3], offset_c[3];
    subtract(b, a, ab);
    subtract(c, b, bc);
    subtract(a, c, ca);
    subtract(at, a, offset);
    subtract(at, b, offset_b);
    subtract(at, c, offset_c);
    double n[3] = {ca[1] * ab[2] - ca[2] * ab[1], ca[2] * ab[0] - ca[0] * ab[2], ca[0] * ab[1] - ca[1] * ab[0]};
    double square = dot(n, n);
    const double *sides[3] = {ab, bc, ca}, *offsets[3] = {offset, offset_b, offset_c};
    bool over = square > 0;
    for (int side = 0; side < 3 && over; side++) { /* the outward normal of a side, in the plane, is side x n */
        const double *s = sides[side];
        double out[3] = {s[1] * n[2] - s[2] * n[1], s[2] * n[0] - s[0] * n[2], s[0] * n[1] - s[1] * n[0]};
        over = dot(out, offsets[side]) <= 0;
    }
    if (over) {
        double height = dot(n, offset);
        return height * height / square;
    }
    double first = segment_distance(at, a, ab), second = segment_distance(at, b, bc);
    double third = segment_distance(at, c, ca), least = first < second ? first : second;
    return least < third ? least : third;
}
