/* Smoothing by VTK and CGAL behind C faces: seconds of the filter alone, results in `positions`. */
#ifndef HEWN_BENCH_SMOOTH_PEERS_H
#define HEWN_BENCH_SMOOTH_PEERS_H

#include "mesh_peers.h"

#ifdef __cplusplus
extern "C" {
#endif

/* `angle` above 0: edges that bend by more are features, and smoothed along themselves. */
double vtk_windowed_sinc(const peer_input *input, int iterations, double passband, double angle, double *positions);
double vtk_laplace(const peer_input *input, int iterations, double *positions);

/* Mean curvature flow, implicit; `time` in square lengths. */
double cgal_smooth_shape(const peer_input *input, double time, int iterations, double *positions);

#ifdef __cplusplus
}
#endif
#endif
