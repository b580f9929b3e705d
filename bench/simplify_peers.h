/* Simplification by peers behind C faces. */
#ifndef HEWN_BENCH_SIMPLIFY_PEERS_H
#define HEWN_BENCH_SIMPLIFY_PEERS_H

#include "mesh_peers.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Triangles that came out, from malloc(), and what the filter alone took: by the clock, and of all processors. */
typedef struct simplified {
    uint64_t vertex_count, triangle_count;
    double *positions;
    uint32_t *indices;
    double seconds, processor_seconds;
} simplified;

simplified vtk_quadric(const peer_input *input, uint64_t target);
simplified cgal_garland_heckbert(const peer_input *input, uint64_t target);
simplified cgal_lindstrom_turk(const peer_input *input, uint64_t target);
simplified meshoptimizer(const peer_input *input, uint64_t target);

#ifdef __cplusplus
}
#endif
#endif
