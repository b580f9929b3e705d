#include "render/cells.h"

/* The largest of three distances along axes, least over all full cells: two sweeps over each cell's neighbours before
 * it and behind it (a chamfer with weight 1 for all 26) give it exactly. */
static void sweep(uint8_t *cells, uint32_t n, bool back)
{
    size_t all = (size_t)n * n * n;
    for (size_t k = 0; k < all; k++) {
        size_t at = back ? all - 1 - k : k;
        int x = (int)(at % n), y = (int)(at / n % n), z = (int)(at / n / n), sign = back ? 1 : -1;
        unsigned least = cells[at];
        for (int j = 0; j < 13; j++) { /* the half of the neighbours that come first */
            int dx = j % 3 - 1, dy = j / 3 % 3 - 1, dz = j < 9 ? 1 : 0;
            if (j >= 9) {
                dx = j < 12 ? j - 10 : 1;
                dy = j < 12 ? 1 : 0;
            }
            int u = x + sign * dx, v = y + sign * dy, w = z + sign * dz;
            if (u < 0 || v < 0 || w < 0 || u >= (int)n || v >= (int)n || w >= (int)n)
                continue;
            unsigned there = cells[(size_t)u + (size_t)n * ((size_t)v + (size_t)n * (size_t)w)] + 1U;
            least = there < least ? there : least;
        }
        cells[at] = (uint8_t)least;
    }
}

void hewn_cells_measure(uint8_t *cells, uint32_t across)
{
    sweep(cells, across, false);
    sweep(cells, across, true);
}
