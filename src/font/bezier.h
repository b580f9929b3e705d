/* Bezier curves in the plane, and roots of polynomials. */
#ifndef HEWN_SRC_FONT_BEZIER_H
#define HEWN_SRC_FONT_BEZIER_H

#include <stdbool.h>

typedef struct hewn_bezier {
    unsigned degree; /* 1 to 3 */
    double p[4][2];  /* degree + 1 control points */
} hewn_bezier;

void hewn_bezier_point(const hewn_bezier *curve, double t, double out[2]);

/* The curve as a polynomial: sum of c[k] t^k, k up to the degree. */
void hewn_bezier_powers(const hewn_bezier *curve, double c[4][2]);

/* The unit direction in which it runs at `t` from 0 to 1; where its derivative is 0 there, that towards the nearest
 * part that goes anywhere. (0, 0) for a curve that is a point. */
void hewn_bezier_direction(const hewn_bezier *curve, double t, double out[2]);

/* The part from `from` to `to`, which runs the other way where `from` is more. */
hewn_bezier hewn_bezier_part(const hewn_bezier *curve, double from, double to);

/* Makes lo and hi contain it, exactly but for rounding. */
void hewn_bezier_bound(const hewn_bezier *curve, double lo[2], double hi[2]);

/* The length of the way along its control points, which is at least its own. */
double hewn_bezier_reach(const hewn_bezier *curve);

/* The places in [0, 1], ascending, where sum of c[k] t^k (degree 1 to 5) changes its sign: found between those of its
 * derivative, where it is monotone. `out` has room for `degree`. */
unsigned hewn_sign_changes(const double *c, unsigned degree, double *out);

/* The place between a and b where such a sum is 0; it is monotone there, and rises or falls from one sign to the other.
 */
double hewn_root_between(const double *c, unsigned degree, double a, double b, bool rises);

#endif
