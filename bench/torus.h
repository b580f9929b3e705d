/* A torus of triangles: closed, all valences 6. */
#ifndef HEWN_BENCH_TORUS_H
#define HEWN_BENCH_TORUS_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_peers.h"

/* About that many triangles, 18 or more; positions and indices are from malloc(), and the program ends without memory.
 */
static inline peer_input bench_torus(uint64_t triangles)
{
    uint32_t m = (uint32_t)sqrt((double)triangles / 2), n = (uint32_t)(triangles / 2 / m);
    uint64_t verts = (uint64_t)n * m;
    double *positions = malloc(verts * 3 * sizeof *positions);
    uint32_t *indices = malloc(verts * 6 * sizeof *indices);
    if (!positions || !indices) {
        fprintf(stderr, "bench: out of memory\n");
        exit(1);
    }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++) {
            double u = 2 * M_PI * i / n, v = 2 * M_PI * j / m, radius = 1 + 0.3 * cos(v);
            uint32_t a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m, d = i * m + (j + 1) % m;
            const double position[3] = {radius * cos(u), radius * sin(u), 0.3 * sin(v)};
            const uint32_t corners[6] = {a, b, c, a, c, d};
            memcpy(positions + 3 * (size_t)a, position, sizeof position);
            memcpy(indices + 6 * (size_t)a, corners, sizeof corners);
        }
    return (peer_input){verts, 2 * verts, positions, indices};
}

#endif
