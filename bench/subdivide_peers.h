/* Subdivision by OpenMesh, CGAL and OpenSubdiv behind C faces. Each returns the seconds of refining alone, its own mesh
 * being built before; `*faces` is what came out. OpenSubdiv tells topology and interpolation apart. */
#ifndef HEWN_BENCH_SUBDIVIDE_PEERS_H
#define HEWN_BENCH_SUBDIVIDE_PEERS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cage {
    uint64_t vertex_count, face_count;
    uint32_t sides; /* 3: Loop, 4: Catmull-Clark */
    const double *positions;
    const uint32_t *corners;
} cage;

double openmesh_subdivide(const cage *input, int levels, uint64_t *faces);
double cgal_subdivide(const cage *input, int levels, uint64_t *faces);
double osd_subdivide(const cage *input, int levels, double *topology, double *interpolation, uint64_t *faces);

#ifdef __cplusplus
}
#endif
#endif
