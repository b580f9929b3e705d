/* VTK's flying edges behind a C face. */
#ifndef HEWN_BENCH_FLYING_EDGES_H
#define HEWN_BENCH_FLYING_EDGES_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Extracts the zero surface of samples^3 values with normals on `threads` threads. Returns the seconds taken, counts
 * through the pointers. */
double flying_edges_run(const float *values, size_t samples, double origin, double step, int threads,
                        uint64_t *vertices, uint64_t *triangles);

/* The threading back end that VTK runs on. */
const char *flying_edges_backend(void);

#ifdef __cplusplus
}
#endif
#endif
