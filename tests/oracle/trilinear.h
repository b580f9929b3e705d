/* What the surface of a grid of samples is where the values between them are the trilinear interpolant's, decided
 * exactly. Shares nothing with the extraction: no loops, no table, no closed form of a test.
 *
 * Inside is {F < 0}, so that 0 counts as outside, and the surface meant is the boundary of {F <= -e} for the last e
 * above 0: a level that no saddle lies on, and therefore a closed 2-manifold whatever the values are.
 *
 * A cell is swept by its level slices. In a slice the interpolant is bilinear, and its inside is a disc for each
 * connected set of inside columns; two columns across a diagonal are connected where the slice's saddle says so. Which
 * columns are inside and how they are connected changes at few heights only, all in Q(sqrt D) for one D. So the Euler
 * number with compact support is the number of discs summed over those heights, less the number summed over the
 * intervals between them, and components are found by following discs from slice to slice. */
#ifndef HEWN_TESTS_ORACLE_TRILINEAR_H
#define HEWN_TESTS_ORACLE_TRILINEAR_H

#include <stdint.h>

/* Of one cell with corner c at (c & 1, c >> 1 & 1, c >> 2 & 1). */
typedef struct oracle_cell {
    int euler;        /* of the inside within the open cell, with compact support */
    uint8_t label[8]; /* equal for two corners that are connected within the closed cell, on their own side */
} oracle_cell;

oracle_cell oracle_trilinear_cell(const double values[8]);

typedef struct oracle_topology {
    int64_t euler;       /* of the surface */
    uint64_t components; /* of the surface */
} oracle_topology;

/* `values` has samples[0] * samples[1] * samples[2] finite entries, x fastest; those on the border must be >= 0. */
oracle_topology oracle_trilinear(const uint32_t samples[3], const double *values);

#endif
