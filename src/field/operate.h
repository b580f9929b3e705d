/* Single operations of a field on the host, for rooms that evaluate on their own. */
#ifndef HEWN_SRC_FIELD_OPERATE_H
#define HEWN_SRC_FIELD_OPERATE_H

#include "field/graph.h"

/* The value of an operation (none of X, Y, Z) for operand values in double. */
double hewn_op_point(const hewn_node_data *node, const double in[3]);

/* Bounds of it over operands in intervals, rounded outward. */
hewn_interval hewn_op_bound(const hewn_node_data *node, const hewn_interval in[3]);

/* How steep a noise is at most as a function of its place; infinite for what is none. */
double hewn_op_noise_slope(hewn_op op);

#endif
