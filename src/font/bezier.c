#include "font/bezier.h"

#include <math.h>
#include <string.h>

void hewn_bezier_point(const hewn_bezier *curve, double t, double out[2])
{
    double level[4][2]; /* de Casteljau */
    memcpy(level, curve->p, sizeof level);
    for (unsigned round = curve->degree; round > 0; round--)
        for (unsigned k = 0; k < round; k++)
            for (int axis = 0; axis < 2; axis++)
                level[k][axis] += t * (level[k + 1][axis] - level[k][axis]);
    memcpy(out, level[0], sizeof level[0]);
}

void hewn_bezier_powers(const hewn_bezier *curve, double c[4][2])
{
    const double(*p)[2] = curve->p;
    memset(c, 0, 4 * sizeof *c);
    for (int axis = 0; axis < 2; axis++) {
        double a = p[0][axis], b = p[1][axis] - a;
        c[0][axis] = a;
        c[1][axis] = curve->degree * b;
        if (curve->degree == 2) {
            c[2][axis] = p[2][axis] - p[1][axis] - b;
        } else if (curve->degree == 3) {
            double bend = p[2][axis] - p[1][axis] - b;
            c[2][axis] = 3 * bend;
            c[3][axis] = p[3][axis] - p[2][axis] - (p[2][axis] - p[1][axis]) - bend;
        }
    }
}

static bool normalise(double v[2])
{
    double length = hypot(v[0], v[1]);
    if (!(length > 0))
        return false;
    v[0] /= length;
    v[1] /= length;
    return true;
}

/* The derivative at t, by the differences of the control points. */
static void derivative(const hewn_bezier *curve, double t, double out[2])
{
    hewn_bezier slope = {.degree = curve->degree - 1};
    for (unsigned k = 0; k < curve->degree; k++)
        for (int axis = 0; axis < 2; axis++)
            slope.p[k][axis] = curve->degree * (curve->p[k + 1][axis] - curve->p[k][axis]);
    hewn_bezier_point(&slope, t, out);
}

void hewn_bezier_direction(const hewn_bezier *curve, double t, double out[2])
{
    derivative(curve, t, out);
    double reach = hewn_bezier_reach(curve);
    if (hypot(out[0], out[1]) > 1e-9 * reach && normalise(out))
        return;
    bool last = t > 0.5;
    const double *end = curve->p[last ? curve->degree : 0];
    double from[2] = {end[0], end[1]};
    if (t > 0 && t < 1) { /* a cusp: the way on from it */
        double to[2];
        hewn_bezier_point(curve, t, from);
        hewn_bezier_point(curve, last ? t - 1e-3 : t + 1e-3, to);
        for (int axis = 0; axis < 2; axis++)
            out[axis] = last ? from[axis] - to[axis] : to[axis] - from[axis];
        if (normalise(out))
            return;
    }
    for (unsigned k = 1; k <= curve->degree; k++) {
        const double *next = curve->p[last ? curve->degree - k : k];
        for (int axis = 0; axis < 2; axis++)
            out[axis] = last ? from[axis] - next[axis] : next[axis] - from[axis];
        if (hypot(out[0], out[1]) > 1e-9 * reach && normalise(out))
            return;
    }
    out[0] = out[1] = 0;
}

/* Replaces the curve by its part from t to its end. */
static void cut_begin(hewn_bezier *curve, double t)
{
    for (unsigned round = curve->degree; round > 0; round--)
        for (unsigned k = 0; k < round; k++)
            for (int axis = 0; axis < 2; axis++)
                curve->p[k][axis] += t * (curve->p[k + 1][axis] - curve->p[k][axis]);
}

static void reverse(hewn_bezier *curve)
{
    for (unsigned k = 0; 2 * k < curve->degree; k++)
        for (int axis = 0; axis < 2; axis++) {
            double swapped = curve->p[k][axis];
            curve->p[k][axis] = curve->p[curve->degree - k][axis];
            curve->p[curve->degree - k][axis] = swapped;
        }
}

hewn_bezier hewn_bezier_part(const hewn_bezier *curve, double from, double to)
{
    hewn_bezier part = *curve;
    double first = fmin(from, to), last = fmax(from, to);
    if (first > 0)
        cut_begin(&part, first);
    reverse(&part);
    if (last < 1)
        cut_begin(&part, (1 - last) / (1 - first));
    if (from <= to)
        reverse(&part);
    return part;
}

void hewn_bezier_bound(const hewn_bezier *curve, double lo[2], double hi[2])
{
    double c[4][2];
    hewn_bezier_powers(curve, c);
    for (int axis = 0; axis < 2; axis++) {
        const double slope[6] = {c[1][axis], 2 * c[2][axis], 3 * c[3][axis]};
        double places[2], at[2];
        unsigned count = curve->degree > 1 ? hewn_sign_changes(slope, curve->degree - 1, places) : 0;
        for (unsigned end = 0; end <= curve->degree; end += curve->degree) { /* to the bit */
            lo[axis] = fmin(lo[axis], curve->p[end][axis]);
            hi[axis] = fmax(hi[axis], curve->p[end][axis]);
        }
        for (unsigned i = 0; i < count; i++) {
            hewn_bezier_point(curve, places[i], at);
            lo[axis] = fmin(lo[axis], at[axis]);
            hi[axis] = fmax(hi[axis], at[axis]);
        }
    }
}

double hewn_bezier_reach(const hewn_bezier *curve)
{
    double sum = 0;
    for (unsigned k = 0; k < curve->degree; k++)
        sum += hypot(curve->p[k + 1][0] - curve->p[k][0], curve->p[k + 1][1] - curve->p[k][1]);
    return sum;
}

/* --- roots ---------------------------------------------------------------------------------------------------------
 */

static double value(const double *c, unsigned degree, double t)
{
    double sum = c[degree];
    for (unsigned k = degree; k-- > 0;)
        sum = sum * t + c[k];
    return sum;
}

/* Newton's steps, halves where they lead out. */
double hewn_root_between(const double *c, unsigned degree, double a, double b, bool rises)
{
    double t = 0.5 * (a + b), slope[5];
    for (unsigned k = 0; k < degree; k++)
        slope[k] = (k + 1) * c[k + 1];
    for (int i = 0; i < 60; i++) {
        double f = value(c, degree, t);
        if ((f > 0) == rises)
            b = t;
        else
            a = t;
        double next = t - f / value(slope, degree - 1, t);
        if (!(next > a && next < b))
            next = 0.5 * (a + b);
        if (fabs(next - t) <= 1e-15 || b - a <= 1e-15)
            return next;
        t = next;
    }
    return t;
}

unsigned hewn_sign_changes(const double *c, unsigned degree, double *out)
{
    double slope[5], places[7] = {0};
    for (unsigned k = 0; k < degree; k++)
        slope[k] = (k + 1) * c[k + 1];
    unsigned turns = degree > 1 ? hewn_sign_changes(slope, degree - 1, places + 1) : 0, count = 0;
    places[turns + 1] = 1;
    bool before = value(c, degree, 0) > 0;
    for (unsigned i = 0; i <= turns; i++) {
        bool after = value(c, degree, places[i + 1]) > 0;
        if (before != after)
            out[count++] = hewn_root_between(c, degree, places[i], places[i + 1], after);
        before = after;
    }
    return count;
}
