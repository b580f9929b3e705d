/* A serial twin of the extraction with the trilinear interpolant's topology: from samples to welded triangles. It reads
 * the same derived patches as the device, but takes every decision in exact arithmetic. */
#ifndef HEWN_TESTS_ORACLE_MC33_H
#define HEWN_TESTS_ORACLE_MC33_H

#include <stdint.h>

#include "hewn/triangles.h"
#include "iso/mc33.h"

/* The decisions of a cell with these corner values: faces joined inside (only those that are ambiguous), and the join
 * within. */
uint32_t oracle_mc33_joined(const double values[8]);
hewn_mc33_join oracle_mc33_join(const double values[8]);

/* The surface of samples[0] * samples[1] * samples[2] values (x fastest) a unit apart, crossings interpolated linearly.
 * Vertices on edges come first, in order of their edges (sample of the start, then axis), then those in cells. Free it
 * with hewn_triangles_destroy(). */
hewn_triangles oracle_mc33(const uint32_t samples[3], const double *values, const hewn_mc33_table *table);

#endif
