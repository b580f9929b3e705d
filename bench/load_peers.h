/* Mesh files read by other libraries, behind C faces. */
#ifndef HEWN_BENCH_LOAD_PEERS_H
#define HEWN_BENCH_LOAD_PEERS_H

#ifdef __cplusplus
extern "C" {
#endif

/* What was made of a file; `mesh` is NULL where the library refuses it. */
typedef struct peer_loaded {
    void *mesh;
    unsigned long long vertices, faces;
} peer_loaded;

/* Half-edge meshes with double positions. */
peer_loaded openmesh_load(const char *path);
void openmesh_release(void *mesh);
peer_loaded surface_mesh_load(const char *path);
void surface_mesh_release(void *mesh);

/* Indexed faces of floats, equal vertices joined; assimp has no half-edges. */
peer_loaded assimp_load(const char *path);
void assimp_release(void *scene);

#ifdef __cplusplus
}
#endif
#endif
