/* From a volume to a mesh with VTK, behind a C face. */
#ifndef HEWN_BENCH_VOLUME_VTK_H
#define HEWN_BENCH_VOLUME_VTK_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Extracts the surface at `iso` of side^3 floats, or with `shorts` 16-bit integers, with normals on `threads` threads
 * by flying edges. Returns the seconds taken. */
double volume_vtk_extract(const void *samples, int side, int shorts, double iso, int threads, uint64_t *triangles);

/* The same from a raw file to a binary STL file: reader, flying edges, writer. */
double volume_vtk_convert(const char *raw, int side, int shorts, double iso, int threads, const char *stl);

#ifdef __cplusplus
}
#endif
#endif
