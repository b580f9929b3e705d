/* Sums of squared distances to planes, and where they are least in a box.
 *
 * Kept about a point of its own, near its planes, so that nothing cancels far from the origin. A plane counts with
 * weight one. Garland and Heckbert 1997, 'Surface simplification using quadric error metrics'; as the measure of a cell
 * Ju, Losasso, Schaefer, Warren 2002, 'Dual contouring of Hermite data'. Lengths are the caller's. */
#ifndef HEWN_SRC_ISO_QUADRIC_H
#define HEWN_SRC_ISO_QUADRIC_H

#include "hewn/field.h"

/* Zero is the empty sum. */
typedef struct hewn_quadric {
    double origin[3];
    double square[6]; /* xx, xy, xz, yy, yz, zz */
    double linear[3];
    double constant;
    double points[3]; /* sum of the points, seen from the origin */
    double weight;
} hewn_quadric;

/* The normal has unit length, or whatever length makes its products with steps what distances are to be. */
void hewn_quadric_add_plane(hewn_quadric *quadric, const double point[3], const double normal[3]);
void hewn_quadric_add(hewn_quadric *quadric, const hewn_quadric *other);

/* The mean of the points that planes were given by. */
void hewn_quadric_centre(const hewn_quadric *quadric, double out[3]);

/* Root of the mean squared distance of a point to the planes. */
double hewn_quadric_distance(const hewn_quadric *quadric, const double at[3]);

/* The point of the box where the mean square is least. `at` enters as the point to stay near to in the directions that
 * planes leave open: a squared step away from it counts `hold` times (above 0), so there is one minimum, and it is
 * found exactly, not by clamping. */
void hewn_quadric_minimise(const hewn_quadric *quadric, double hold, const hewn_box *box, double at[3]);

#endif
