/* Interval arithmetic in double (Moore, Kearfott and Cloud, Introduction to Interval Analysis). Each function's result
 * contains the real result, and the one that double arithmetic rounds to, for all operands in the given intervals,
 * zeros of both signs and infinite ends included; `maybe_nan` is set where one of them could be NaN. */
#ifndef HEWN_SRC_FIELD_INTERVAL_H
#define HEWN_SRC_FIELD_INTERVAL_H

#include "field/graph.h"

hewn_interval hewn_interval_of(double value);
hewn_interval hewn_interval_all(void); /* [-inf, inf], maybe NaN */

/* A bound moved outward by an absolute error, infinities kept on the safe side. */
double hewn_lower(double value, double error);
double hewn_upper(double value, double error);

hewn_interval hewn_interval_neg(hewn_interval a);
hewn_interval hewn_interval_abs(hewn_interval a);
hewn_interval hewn_interval_sqrt(hewn_interval a);
hewn_interval hewn_interval_square(hewn_interval a);
hewn_interval hewn_interval_sin(hewn_interval a);
hewn_interval hewn_interval_cos(hewn_interval a);
hewn_interval hewn_interval_tan(hewn_interval a);
hewn_interval hewn_interval_asin(hewn_interval a);
hewn_interval hewn_interval_acos(hewn_interval a);
hewn_interval hewn_interval_atan(hewn_interval a);
hewn_interval hewn_interval_exp(hewn_interval a);
hewn_interval hewn_interval_ln(hewn_interval a);
hewn_interval hewn_interval_floor(hewn_interval a);
hewn_interval hewn_interval_ceil(hewn_interval a);
hewn_interval hewn_interval_round(hewn_interval a);
hewn_interval hewn_interval_not(hewn_interval a);
hewn_interval hewn_interval_zigzag(hewn_interval a, double period);

hewn_interval hewn_interval_add(hewn_interval a, hewn_interval b);
hewn_interval hewn_interval_sub(hewn_interval a, hewn_interval b);
hewn_interval hewn_interval_mul(hewn_interval a, hewn_interval b);
hewn_interval hewn_interval_div(hewn_interval a, hewn_interval b);
hewn_interval hewn_interval_min(hewn_interval a, hewn_interval b);
hewn_interval hewn_interval_max(hewn_interval a, hewn_interval b);
hewn_interval hewn_interval_mod(hewn_interval a, hewn_interval b);
hewn_interval hewn_interval_atan2(hewn_interval y, hewn_interval x);
hewn_interval hewn_interval_compare(hewn_interval a, hewn_interval b);
hewn_interval hewn_interval_and(hewn_interval a, hewn_interval b);
hewn_interval hewn_interval_or(hewn_interval a, hewn_interval b);

/* Shapes (AFFINE among them) from the intervals of their local coordinates. */
hewn_interval hewn_interval_shape(const hewn_node_data *node, const hewn_interval in[3]);

/* The smooth blends. */
hewn_interval hewn_interval_blend(const hewn_node_data *node, hewn_interval a, hewn_interval b);

#endif
