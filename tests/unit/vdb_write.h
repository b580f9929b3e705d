/* Writing .vdb files for tests, by OpenVDB itself. */
#ifndef HEWN_TEST_VDB_WRITE_H
#define HEWN_TEST_VDB_WRITE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A file with these grids, in this order: "velocity" of vectors, "fog" of floats, "half" of the same kept as halves,
 * "wide" of doubles, "count" of 32-bit whole numbers, "mask" of bools, "frustum" of floats in no lattice, "empty".
 * Voxel (x, y, z) is values[x + dims[0] (y + dims[1] z)] (0: not set), at (x, y, z) + first in the lattice; `to_world`
 * is row-major. */
void vdb_write(const char *path, const int32_t dims[3], const double *values, const int32_t first[3],
               const double to_world[16]);

/* A file with the level set "spheres" (or, with `half`, kept as halves) of spheres of a radius about these centres, in
 * voxels of 1. */
void vdb_write_spheres(const char *path, int count, const double centres[][3], double radius, bool half);

/* A file with the grid "tree" of floats (`doubles`: of doubles), whose leaves, tiles of all sizes, active and not, and
 * background are random, with steps wherever they meet. Active samples lie within 300 of the origin. */
void vdb_write_tree(const char *path, uint64_t seed, bool doubles);

/* A file with the grid "mask" of bools: a leaf at a multiple of 8 whose samples are active and true from 2 on along x,
 * one that is the same but not active, and a tile of 4096 that is true and not active. */
void vdb_write_mask(const char *path, const int32_t active[3], const int32_t passive[3], const int32_t tile[3]);

/* Starts and stops a thread that gives TBB, which OpenVDB uses, small pieces of work all the time. */
void vdb_write_busy(bool on);

#ifdef __cplusplus
}
#endif
#endif
