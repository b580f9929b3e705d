#include "geom/predicates.h"

#include <stdbool.h>

#include "geom/expansion.h"
#include "geom/wide.h"

/* --- expansions --------------------------------------------------------------------------------------------------- */

/* Whether expansions of products of three differences of these are exact: a coordinate of at least 2^-305 is a multiple
 * of 2^-357, and three such multiply to a multiple of 2^-1071. */
static bool in_range(const double *point, int axes)
{
    for (int i = 0; i < axes; i++) {
        double size = fabs(point[i]);
        if (size != 0 && !(size >= 0x1p-305 && size <= 0x1p330))
            return false;
    }
    return true;
}

/* a - b in one or two parts; 0 parts where they are equal. */
static int difference(double a, double b, double parts[2])
{
    parts[1] = hewn_two_difference(a, b, &parts[0]);
    return hewn_expansion_drop_zeros(parts, 2);
}

/* An exact coordinate of a difference of two points. */
typedef struct term {
    int count;
    double part[2];
} term;

/* a × b, at most 8 parts, none adjacent to another. */
static int multiply(const term *a, const term *b, double product[8])
{
    if (a->count == 0)
        return 0;
    if (a->count == 1)
        return hewn_expansion_scale(b->count, b->part, a->part[0], product);
    double low[4], high[4];
    int lows = hewn_expansion_scale(b->count, b->part, a->part[0], low);
    int highs = hewn_expansion_scale(b->count, b->part, a->part[1], high);
    return hewn_expansion_add(lows, low, highs, high, product);
}

/* a × d - b × c, at most 16 parts, none adjacent to another. */
static int minor(const term *a, const term *b, const term *c, const term *d, double out[16])
{
    double left[8], right[8];
    int lefts = multiply(a, d, left), rights = multiply(b, c, right);
    for (int i = 0; i < rights; i++)
        right[i] = -right[i];
    return hewn_expansion_add(lefts, left, rights, right, out);
}

/* --- wide integers ------------------------------------------------------------------------------------------------ */

static void wide_difference(double a, double b, hewn_wide *out)
{
    hewn_wide wide_a, wide_b;
    hewn_wide_set(&wide_a, a);
    hewn_wide_set(&wide_b, b);
    hewn_wide_subtract(&wide_a, &wide_b, out);
}

static void wide_minor(const hewn_wide *a, const hewn_wide *b, const hewn_wide *c, const hewn_wide *d, hewn_wide *out)
{
    hewn_wide left, right;
    hewn_wide_multiply(a, d, &left);
    hewn_wide_multiply(b, c, &right);
    hewn_wide_subtract(&left, &right, out);
}

static int wide_orient2d(const double a[2], const double b[2], const double c[2])
{
    hewn_wide u[2], v[2], determinant;
    for (int i = 0; i < 2; i++) {
        wide_difference(a[i], c[i], &u[i]);
        wide_difference(b[i], c[i], &v[i]);
    }
    wide_minor(&u[0], &u[1], &v[0], &v[1], &determinant);
    return determinant.sign;
}

static int wide_orient3d(const double a[3], const double b[3], const double c[3], const double d[3])
{
    hewn_wide u[3], v[3], w[3], sum = {0};
    for (int i = 0; i < 3; i++) {
        wide_difference(b[i], a[i], &u[i]);
        wide_difference(c[i], a[i], &v[i]);
        wide_difference(d[i], a[i], &w[i]);
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        hewn_wide negated, product, before = sum;
        wide_minor(&u[k], &u[j], &v[k], &v[j], &negated);
        hewn_wide_multiply(&negated, &w[i], &product);
        hewn_wide_subtract(&before, &product, &sum);
    }
    return sum.sign;
}

/* --- predicates --------------------------------------------------------------------------------------------------- */

int hewn_orient2d_exact(const double a[2], const double b[2], const double c[2])
{
    if (!in_range(a, 2) || !in_range(b, 2) || !in_range(c, 2))
        return wide_orient2d(a, b, c);
    term u[2], v[2];
    for (int i = 0; i < 2; i++) {
        u[i].count = difference(a[i], c[i], u[i].part);
        v[i].count = difference(b[i], c[i], v[i].part);
    }
    double determinant[16];
    return hewn_expansion_sign(minor(&u[0], &u[1], &v[0], &v[1], determinant), determinant);
}

int hewn_orient3d_exact(const double a[3], const double b[3], const double c[3], const double d[3])
{
    if (!in_range(a, 3) || !in_range(b, 3) || !in_range(c, 3) || !in_range(d, 3))
        return wide_orient3d(a, b, c, d);
    term u[3], v[3], w[3];
    for (int i = 0; i < 3; i++) {
        u[i].count = difference(b[i], a[i], u[i].part);
        v[i].count = difference(c[i], a[i], v[i].part);
        w[i].count = difference(d[i], a[i], w[i].part);
    }
    double sums[2][192];
    int count = 0, at = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        if (w[i].count == 0)
            continue;
        double area[16], product[32];
        int areas = minor(&u[j], &u[k], &v[j], &v[k], area);
        for (int part = 0; part < w[i].count; part++) {
            int products = hewn_expansion_scale(areas, area, w[i].part[part], product);
            count = hewn_expansion_merge(count, sums[at], products, product, sums[1 - at]);
            at = 1 - at;
        }
    }
    return hewn_expansion_sign(count, sums[at]);
}
