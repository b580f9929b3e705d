/* Which cells of a grid lie beyond the neighbourhood of the surface, from dense samples. */
#ifndef HEWN_TESTS_ORACLE_REMOTE_H
#define HEWN_TESTS_ORACLE_REMOTE_H

#include <stdbool.h>
#include <stdint.h>

/* `inside` has (cells + 1) samples an axis, x fastest. `remote`, a flag a cell, x fastest: no cell has corners of both
 * signs in the cell's block of 2 x 2 x 2, counted from the grid's first cell, and in the 26 blocks around it. */
void oracle_remote(const uint32_t cells[3], const bool *inside, bool *remote);

#endif
