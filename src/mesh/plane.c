#include "mesh/plane.h"

#include <math.h>

#include "geom/predicates.h"

/* --- projecting --------------------------------------------------------------------------------------------------- */

/* The power of two that brings all coordinates to at most 1 in size; tiny ones as near to it as one double can. */
static double common_scale(const double *const *corners, uint32_t count)
{
    double most = 0;
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            most = fmax(most, fabs(corners[i][k]));
    int exponent = 0;
    frexp(most, &exponent);
    return most > 0 ? ldexp(1, exponent < -1022 ? 1022 : -exponent) : 1;
}

/* Newell's normal of the scaled polygon, coordinates taken from its first corner. */
static void newell(const double *const *corners, uint32_t count, double scale, double normal[3])
{
    double origin[3], at[3], next[3];
    normal[0] = normal[1] = normal[2] = 0;
    for (int k = 0; k < 3; k++) {
        origin[k] = corners[0][k] * scale;
        at[k] = 0;
    }
    for (uint32_t i = 1; i <= count; i++) {
        for (int k = 0; k < 3; k++)
            next[k] = corners[i < count ? i : 0][k] * scale - origin[k];
        for (int k = 0; k < 3; k++) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            normal[k] += (at[u] - next[u]) * (at[v] + next[v]);
        }
        for (int k = 0; k < 3; k++)
            at[k] = next[k];
    }
}

void hewn_plane_project(const double *const *points, uint32_t count, uint32_t point_count, double *out)
{
    double normal[3], scale = common_scale(points, point_count);
    newell(points, count, scale, normal);
    int axis = 0;
    for (int k = 1; k < 3; k++)
        axis = fabs(normal[k]) > fabs(normal[axis]) ? k : axis;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0) {
        int swap = u;
        u = v;
        v = swap;
    }
    for (uint32_t i = 0; i < point_count; i++) {
        out[2 * (size_t)i] = points[i][u] * scale;
        out[2 * (size_t)i + 1] = points[i][v] * scale;
    }
}

/* --- weights ------------------------------------------------------------------------------------------------------ */

/* Weights beyond this say that the polygon crosses itself or the point is far outside: they would blow values up. */
static const double MOST_WEIGHT = 64;

static void share_side(double *weights, uint32_t count, uint32_t i, uint32_t j, double length_i, double length_j)
{
    for (uint32_t k = 0; k < count; k++)
        weights[k] = 0;
    double whole = length_i + length_j;
    weights[i] = whole > 0 ? length_j / whole : 1;
    weights[j] = whole > 0 ? length_i / whole : 0;
}

static double distance(const double *polygon, uint32_t i, const double point[2])
{
    return hypot(polygon[2 * (size_t)i] - point[0], polygon[2 * (size_t)i + 1] - point[1]);
}

void hewn_plane_weights(const double *polygon, uint32_t count, const double point[2], double *weights)
{
    for (uint32_t i = 0; i < count; i++)
        weights[i] = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t j = (i + 1) % count;
        const double *a = polygon + 2 * (size_t)i, *b = polygon + 2 * (size_t)j;
        double ax = a[0] - point[0], ay = a[1] - point[1], bx = b[0] - point[0], by = b[1] - point[1];
        double length_a = distance(polygon, i, point), length_b = distance(polygon, j, point);
        double dot = ax * bx + ay * by, cross = ax * by - ay * bx;
        if (length_a == 0 || length_b == 0 || (hewn_orient2d(a, b, point) == 0 && dot < 0)) {
            share_side(weights, count, i, j, length_a, length_b);
            return;
        }
        /* The tangent of half the angle between them, in the form that is stable on either side of a right angle. */
        double product = length_a * length_b;
        double tangent = dot > 0 ? cross / (product + dot) : cross == 0 ? 0 : (product - dot) / cross;
        weights[i] += tangent / length_a;
        weights[j] += tangent / length_b;
    }
    double sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += weights[i];
    bool usable = isfinite(sum) && sum != 0;
    for (uint32_t i = 0; i < count; i++)
        usable = usable && fabs(weights[i] / sum) <= MOST_WEIGHT;
    for (uint32_t i = 0; i < count; i++)
        weights[i] = usable ? weights[i] / sum : 1.0 / count;
}
