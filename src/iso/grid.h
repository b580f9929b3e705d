/* The grid that an extraction runs on: whole cubic cells over the bounds. */
#ifndef HEWN_SRC_ISO_GRID_H
#define HEWN_SRC_ISO_GRID_H

#include "hewn/extract.h"

#include "shared/iso.h"

_Static_assert(HEWN_MAX_RESOLUTION <= 8 * 1023, "a brick's coordinate has ten bits");

/* Lays cells over the bounds of `desc`: the other sides grow symmetrically to whole cells. An open one gets a rim for
 * the dual methods, which counts as cells. HEWN_INVALID_ARGUMENT where that makes no sense or where floats at the
 * bounds are too coarse to keep the vertices of a cell apart. */
hewn_result hewn_grid_lay(const hewn_extract_desc *desc, struct hewn_grid *out, hewn_box *grown, hewn_error *error);

/* Where sample i of an axis is: the same floats as shaders/iso/grid.h has. */
static inline float hewn_grid_sample(const struct hewn_grid *grid, uint32_t axis, uint32_t i)
{
    uint32_t whole = i > grid->rim ? i - grid->rim : 0;
    float offset = grid->cell * (float)whole;
    return i + grid->rim >= grid->cells[axis] ? grid->far[axis] : grid->origin[axis] + offset;
}

/* Bricks along an axis. */
uint32_t hewn_grid_bricks(const struct hewn_grid *grid, int axis);

/* Blocks of `shrink` bricks a side along the axes, and their product. */
uint64_t hewn_grid_blocks(const struct hewn_grid *grid, uint32_t shrink, uint32_t blocks[3]);

/* Levels of culling, blocks of the coarsest, and the cells along their sides. Bricks come in the order of their blocks,
 * so that vertices do in every kind of culling. */
uint32_t hewn_grid_levels(const struct hewn_grid *grid, uint32_t *levels, uint32_t top[3]);

#endif
