/* VTK, as bench_labels meets it. */
#ifndef HEWN_BENCH_LABELS_PEERS_H
#define HEWN_BENCH_LABELS_PEERS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* vtkDiscreteFlyingEdges3D for one label after the other, on 16-bit voxels in memory. Seconds of all. */
double vtk_labels(const uint16_t *voxels, const int dims[3], const int64_t *labels, uint32_t count, int threads,
                  uint64_t *triangles);

#ifdef __cplusplus
}
#endif
#endif
