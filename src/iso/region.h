/* Parts of the grid that are extracted one at a time: bricks from one number to another in their order.
 *
 * Bricks are numbered as culling lists them: by blocks of the top level, x fastest, and within a block by its children.
 * So a brick comes after all those that lie no farther than it along each axis. By every method a brick's triangles
 * name vertices of that brick and of its upper neighbours: never of one before it. */
#ifndef HEWN_SRC_ISO_REGION_H
#define HEWN_SRC_ISO_REGION_H

#include "gpu/gpu.h"
#include "iso/grid.h"

typedef struct hewn_region {
    uint32_t levels;
    uint32_t top[3];     /* blocks of the coarsest level */
    uint32_t begin, end; /* the part's own bricks are those before `end` */
} hewn_region;

/* All of a grid. Grids of HEWN_MAX_RESOLUTION cells have at most 2^30 such numbers. */
hewn_region hewn_region_whole(const struct hewn_grid *grid);

/* The number of a brick, given by packed coordinates. */
uint32_t hewn_region_number(const hewn_region *region, uint32_t packed);

/* Where a part of about `length` numbers from `begin` on should end, in the order and within `most`: at the largest
 * blocks, rows or layers that fit. Always past `begin`. */
uint32_t hewn_region_end(const hewn_region *whole, uint32_t begin, uint32_t length);

/* What one level of culling tested. */
typedef struct hewn_region_level {
    uint32_t level; /* 0 is the coarsest */
    uint32_t tested;
    uint64_t parents; /* addresses, as in hewn_clip_push */
    uint64_t states, flags;
} hewn_region_level;

/* Takes the blocks back that a part does not need. */
void hewn_region_record(const hewn_region *region, hewn_program *clip, const hewn_region_level *level,
                        hewn_commands *commands);

#endif
