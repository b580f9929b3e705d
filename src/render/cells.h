/* The box that is rendered, in cells, and how far each is from the nearest that may hold surface. */
#ifndef HEWN_SRC_RENDER_CELLS_H
#define HEWN_SRC_RENDER_CELLS_H

#include "hewn/base.h"

/* From bytes that are 0 where a cell may hold surface to the distances that HEWN_TRACE's kernels read: how many cells
 * away the nearest such is along the axis where that is most, at most 255. `across` cells along each axis. */
void hewn_cells_measure(uint8_t *cells, uint32_t across);

#endif
