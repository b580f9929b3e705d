#include "remote.h"

#include <stddef.h>

static bool cut(const uint32_t cells[3], const bool *inside, const uint32_t cell[3])
{
    size_t row = cells[0] + 1, layer = row * (cells[1] + 1);
    size_t first = cell[0] + row * cell[1] + layer * cell[2];
    unsigned count = 0;
    for (size_t corner = 0; corner < 8; corner++)
        count += inside[first + corner % 2 + row * (corner / 2 % 2) + layer * (corner / 4)];
    return count != 0 && count != 8;
}

/* The cells from one block below to one above, cut off at the grid's ends. */
static void span(uint32_t cell, uint32_t cells, uint32_t *from, uint32_t *to)
{
    uint32_t block = cell / 2;
    *from = block == 0 ? 0 : 2 * (block - 1);
    *to = 2 * (block + 2) < cells ? 2 * (block + 2) : cells;
}

static bool alone(const uint32_t cells[3], const bool *inside, const uint32_t cell[3])
{
    uint32_t from[3], to[3], at[3];
    for (int axis = 0; axis < 3; axis++)
        span(cell[axis], cells[axis], &from[axis], &to[axis]);
    for (at[2] = from[2]; at[2] < to[2]; at[2]++)
        for (at[1] = from[1]; at[1] < to[1]; at[1]++)
            for (at[0] = from[0]; at[0] < to[0]; at[0]++)
                if (cut(cells, inside, at))
                    return false;
    return true;
}

void oracle_remote(const uint32_t cells[3], const bool *inside, bool *remote)
{
    uint32_t at[3];
    for (at[2] = 0; at[2] < cells[2]; at[2]++)
        for (at[1] = 0; at[1] < cells[1]; at[1]++)
            for (at[0] = 0; at[0] < cells[0]; at[0]++)
                remote[at[0] + (size_t)cells[0] * (at[1] + (size_t)cells[1] * at[2])] = alone(cells, inside, at);
}
