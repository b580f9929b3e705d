#include "iso/decide.h"

#include <math.h>

#include "geom/expansion.h"

/* --- faces -------------------------------------------------------------------------------------------------------- */

/* The sign of a d - b c. Rounding keeps order, so only products that are equal once rounded need their low parts. */
static int sign_of_minor(double a, double d, double b, double c)
{
    double low, other_low;
    double one = hewn_two_product(a, d, &low), other = hewn_two_product(b, c, &other_low);
    if (one == other) {
        one = low;
        other = other_low;
    }
    return (one > other) - (one < other);
}

/* A power of two that brings the largest of the values near 1. */
static double scale_of(const double values[8])
{
    double most = 0;
    int exponent;
    for (int i = 0; i < 8; i++)
        most = fmax(most, fabs(values[i]));
    (void)frexp(most, &exponent);
    return ldexp(1, most > 0 ? -exponent : 0);
}

uint32_t hewn_decide_faces(const double values[8], uint32_t ambiguous)
{
    uint32_t joined = 0, bit = 0;
    double scale = scale_of(values);
    for (uint32_t face = 0; face < 6; face++) {
        if (!(ambiguous >> face & 1))
            continue;
        uint32_t axis = face >> 1, corner = (face & 1) << axis;
        uint32_t u = axis == 0 ? 2 : 1, v = axis == 2 ? 2 : 4;
        int more = sign_of_minor(values[corner] * scale, values[corner + u + v] * scale, values[corner + u] * scale,
                                 values[corner + v] * scale);
        joined |= (values[corner] < 0 ? more > 0 : more < 0) ? 1u << bit : 0;
        bit++;
    }
    return joined;
}

/* --- joins -------------------------------------------------------------------------------------------------------- */

/* Upright edges a, b, c, d around the cell: their value at the bottom and its change to the top. Corners a and c of a
 * level slice are joined across it where q = a c - b d = q2 z^2 + q1 z + q0 is above 0. */
enum { RISE = 2, MINOR = 4, LINE = 16, TEST = 640 };

typedef struct upright {
    double low[4];
    int rise_count[4];
    double rise[4][RISE];
    int count[3];
    double q[3][LINE];
} upright;

static int multiply(int m, const double *a, int n, const double *b, double *out)
{
    double part[TEST], sum[TEST];
    int count = 0;
    for (int i = 0; i < n; i++) {
        int parts = hewn_expansion_scale(m, a, b[i], part);
        int added = hewn_expansion_add(count, out, parts, part, sum);
        for (int k = 0; k < added; k++)
            out[k] = sum[k];
        count = added;
    }
    return count;
}

/* out = a b - c d. */
static int minor(int m, const double *a, int n, const double *b, int o, const double *c, int p, const double *d,
                 double *out)
{
    double one[TEST], other[TEST];
    int first = multiply(m, a, n, b, one), second = multiply(o, c, p, d, other);
    for (int i = 0; i < second; i++)
        other[i] = -other[i];
    return hewn_expansion_add(first, one, second, other, out);
}

static void expand(upright *up, const double values[8], double scale)
{
    double one[LINE], other[LINE];
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t column = i ^ i >> 1;
        double low, top = values[column + 4] * scale;
        up->low[i] = values[column] * scale;
        double high = hewn_two_difference(top, up->low[i], &low);
        up->rise_count[i] = 0;
        if (low != 0)
            up->rise[i][up->rise_count[i]++] = low;
        if (high != 0)
            up->rise[i][up->rise_count[i]++] = high;
    }
    const double *l = up->low;
    const int *n = up->rise_count;
    up->count[0] = minor(l[0] != 0, &l[0], l[2] != 0, &l[2], l[1] != 0, &l[1], l[3] != 0, &l[3], up->q[0]);
    up->count[2] = minor(n[0], up->rise[0], n[2], up->rise[2], n[1], up->rise[1], n[3], up->rise[3], up->q[2]);
    int first = minor(n[2], up->rise[2], l[0] != 0, &l[0], n[3], up->rise[3], l[1] != 0, &l[1], one);
    int second = minor(n[0], up->rise[0], l[2] != 0, &l[2], n[1], up->rise[1], l[3] != 0, &l[3], other);
    up->count[1] = hewn_expansion_add(first, one, second, other, up->q[1]);
}

/* What decides about a join, as signs: of q2, q1, q2 + q1 / 2; of each edge's value at the extremum, times that of q2,
 * and of q there, likewise. */
typedef struct join_signs {
    int turn, bottom, top, edge[4], extremum;
} join_signs;

static join_signs find_exactly(const double values[8], double scale)
{
    upright up;
    join_signs out = {0};
    double test[TEST] = {0}, twice[LINE], four[LINE];
    expand(&up, values, scale);
    for (int i = 0; i < up.count[2]; i++) {
        twice[i] = 2 * up.q[2][i];
        four[i] = 4 * up.q[2][i];
    }
    out.turn = hewn_expansion_sign(up.count[2], up.q[2]);
    out.bottom = hewn_expansion_sign(up.count[1], up.q[1]);
    out.top = hewn_expansion_sign(hewn_expansion_add(up.count[2], twice, up.count[1], up.q[1], test), test);
    for (int i = 0; i < 4; i++) {
        int count = minor(up.count[2], twice, up.low[i] != 0, &up.low[i], up.count[1], up.q[1], up.rise_count[i],
                          up.rise[i], test);
        out.edge[i] = hewn_expansion_sign(count, test) * out.turn;
    }
    int count = minor(up.count[2], four, up.count[0], up.q[0], up.count[1], up.q[1], up.count[1], up.q[1], test);
    out.extremum = hewn_expansion_sign(count, test) * out.turn;
    return out;
}

/* The sign of a number that is off by at most `error`; false where that leaves it open. */
static bool sign_within(double value, double error, int *sign)
{
    *sign = (value > 0) - (value < 0);
    return fabs(value) > error;
}

/* The same in doubles, where their rounding leaves no doubt: the values are at most 1, so q0 is at most 2, q1 and q2 at
 * most 8, and each is off by less than 2^-46; what is made of these is off by less than 2^-42 and 2^-38. */
static bool find_roughly(const double values[8], double scale, join_signs *out)
{
    double l[4], r[4];
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t column = i ^ i >> 1;
        l[i] = values[column] * scale;
        r[i] = values[column + 4] * scale - l[i];
    }
    double q0 = l[0] * l[2] - l[1] * l[3], q2 = r[0] * r[2] - r[1] * r[3];
    double q1 = l[0] * r[2] - l[1] * r[3] + (r[0] * l[2] - r[1] * l[3]);
    bool sure = sign_within(q2, 0x1p-46, &out->turn);
    sure &= sign_within(q1, 0x1p-46, &out->bottom);
    sure &= sign_within(2 * q2 + q1, 0x1p-44, &out->top);
    for (int i = 0; i < 4; i++) {
        sure &= sign_within(2 * q2 * l[i] - q1 * r[i], 0x1p-42, &out->edge[i]);
        out->edge[i] *= out->turn;
    }
    sure &= sign_within(4 * q2 * q0 - q1 * q1, 0x1p-38, &out->extremum);
    out->extremum *= out->turn;
    return sure;
}

hewn_mc33_join hewn_decide_join(const double values[8])
{
    join_signs signs;
    double scale = scale_of(values);
    if (!find_roughly(values, scale, &signs))
        signs = find_exactly(values, scale);
    /* The extremum is in the cell where q falls at one end and rises at the other. */
    if (signs.turn == 0 || signs.bottom * signs.turn >= 0 || signs.top * signs.turn <= 0)
        return HEWN_MC33_NO_JOIN;
    bool inside[4];
    for (int i = 0; i < 4; i++)
        inside[i] = signs.edge[i] < 0;
    if (inside[0] == inside[1] || inside[0] != inside[2] || inside[1] != inside[3])
        return HEWN_MC33_NO_JOIN;
    bool joined = inside[0] ? signs.extremum > 0 : signs.extremum < 0; /* the inside is, else the outside */
    bool first = inside[0] == joined;                                  /* it is a and c that are joined */
    if (signs.turn < 0 ? !first : first)
        return HEWN_MC33_NO_JOIN;
    return (hewn_mc33_join)((first ? HEWN_MC33_OUTSIDE_0 : HEWN_MC33_OUTSIDE_1) + (joined ? 1 : 0));
}
