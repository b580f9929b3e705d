/* What levels will hold, told before any of them is made. */
#ifndef HEWN_SRC_SUBDIVIDE_PLAN_H
#define HEWN_SRC_SUBDIVIDE_PLAN_H

#include "subdivide/subdivision.h"

/* Refuses levels after levels[0] whose corners or edges are more than there are numbers (HEWN_LIMIT), or that take more
 * than `most` bytes (HEWN_OUT_OF_MEMORY; 0: more than the machine has), saying how many levels would do. What is
 * counted is the least: connections of all levels, and three doubles a vertex. */
hewn_result hewn_sub_plan(const hewn_subdivision *sub, uint64_t most, hewn_error *error);

#endif
