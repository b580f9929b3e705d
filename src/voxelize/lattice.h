/* The lattice of a sampling around a box, and its bricks by what they are near to. Private to this room. */
#ifndef HEWN_SRC_VOXELIZE_LATTICE_H
#define HEWN_SRC_VOXELIZE_LATTICE_H

#include "field/sampling.h"

typedef struct hewn_voxel_lattice {
    hewn_sampling_place place;
    uint32_t cells[3]; /* multiples of 8 */
    uint32_t bricks[3];
    uint64_t brick_count;
} hewn_voxel_lattice;

#define HEWN_VOXEL_BAND 3.0
#define HEWN_VOXEL_MEMORY ((uint64_t)2 << 30)

/* Around the box, with `margin` cells on every side at least. HEWN_LIMIT for too many cells; HEWN_INVALID_ARGUMENT for
 * a cell that is not above 0 or too small for where the box is. */
hewn_result hewn_voxel_lattice_lay(const hewn_box *box, double cell, double margin, hewn_voxel_lattice *out,
                                   hewn_error *error);

/* Where a brick begins, in cells, and where a place in cells is. */
void hewn_voxel_brick(const hewn_voxel_lattice *lattice, uint64_t brick, uint32_t out[3]);
void hewn_voxel_point(const hewn_voxel_lattice *lattice, const double cells[3], double out[3]);

/* HEWN_LIMIT where so many fine bricks take more than `limit` bytes (0: the default), with about what cell would fit.
 */
hewn_result hewn_voxel_check_size(const hewn_voxel_lattice *lattice, uint64_t fine, uint64_t limit, hewn_error *error);

#endif
