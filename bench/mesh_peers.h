/* The meshes of OpenMesh and CGAL behind C faces: built from the same indexed triangles, held, and thrown away. */
#ifndef HEWN_BENCH_MESH_PEERS_H
#define HEWN_BENCH_MESH_PEERS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct peer_input {
    uint64_t vertex_count, triangle_count;
    const double *positions;
    const uint32_t *indices;
} peer_input;

/* Each makes a mesh, with room reserved, and returns it; NULL where a face was refused. */
void *openmesh_build(const peer_input *input);
void openmesh_free(void *mesh);
void *surface_mesh_build(const peer_input *input);
void surface_mesh_free(void *mesh);

#ifdef __cplusplus
}
#endif
#endif
