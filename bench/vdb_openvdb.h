/* From a .vdb file to a mesh with OpenVDB itself, behind a C face. */
#ifndef HEWN_BENCH_VDB_OPENVDB_H
#define HEWN_BENCH_VDB_OPENVDB_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Writes the level set of a sphere that is so many voxels across. */
void vdb_openvdb_write_sphere(const char *path, int voxels);

/* Reads the first grid of floats of a file and meshes it at 0 by volumeToMesh, without adaptivity, on `threads`
 * threads. Seconds of both; quads (a triangle that it makes counts as one). Returns 0 where there is no such grid. */
int vdb_openvdb_mesh(const char *path, int threads, double *read_seconds, double *mesh_seconds, uint64_t *quads);

#ifdef __cplusplus
}
#endif
#endif
