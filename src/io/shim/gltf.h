/* glTF's JSON, made and read by tinygltf behind a C face. Buffers are not touched here: only what is said of them. */
#ifndef HEWN_SRC_IO_SHIM_GLTF_H
#define HEWN_SRC_IO_SHIM_GLTF_H

#include "hewn/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "base/text.h"

/* --- making ----------------------------------------------------------------------------------------------------------
 */

/* One mesh of one primitive; the buffer holds positions, normals (where there are any) and indices, in that order and
 * without gaps. */
typedef struct hewn_gltf_desc {
    const char *name, *generator;
    uint64_t vertex_count, index_count; /* where `index_count` is 0 the scene is empty */
    bool has_normals, short_indices;
    float lo[3], hi[3]; /* of the positions */
} hewn_gltf_desc;

hewn_result hewn_gltf_compose(const hewn_gltf_desc *desc, hewn_text *out, hewn_error *error);

/* --- reading ---------------------------------------------------------------------------------------------------------
 */

enum { HEWN_GLTF_NONE = -1 };

typedef struct hewn_gltf_buffer {
    const char *uri; /* NULL: the binary chunk of the file itself */
    uint64_t length;
} hewn_gltf_buffer;

typedef struct hewn_gltf_view {
    int buffer;
    uint64_t offset, length;
    uint64_t stride; /* 0: tight */
} hewn_gltf_view;

typedef struct hewn_gltf_accessor {
    int view; /* HEWN_GLTF_NONE: zeros */
    uint64_t offset, count;
    int component_type; /* glTF's numbers, 5120 to 5126 */
    int components;     /* 1 to 16 */
    bool sparse, normalised;
} hewn_gltf_accessor;

typedef struct hewn_gltf_primitive {
    int mode; /* 4 triangles, 5 strip, 6 fan; below are points and lines */
    int positions, normals, indices;
} hewn_gltf_primitive;

typedef struct hewn_gltf_mesh {
    size_t first_primitive, primitive_count;
} hewn_gltf_mesh;

typedef struct hewn_gltf_node {
    int mesh;
    double matrix[16]; /* column-major, to the parent's coordinates */
    size_t first_child, child_count;
} hewn_gltf_node;

/* A document. Numbers that name other things are as the file has them: whoever follows one checks it. */
typedef struct hewn_gltf {
    const hewn_gltf_buffer *buffers;
    const hewn_gltf_view *views;
    const hewn_gltf_accessor *accessors;
    const hewn_gltf_primitive *primitives;
    const hewn_gltf_mesh *meshes;
    const hewn_gltf_node *nodes;
    const int *children;
    const int *roots; /* of the scene to show; all parentless nodes where there is no scene */
    size_t buffer_count, view_count, accessor_count, primitive_count, mesh_count, node_count, child_count, root_count;
    void *owner;
} hewn_gltf;

/* From JSON text. HEWN_BAD_INPUT for what is not glTF 2 or needs extensions that change geometry; HEWN_LIMIT for more
 * than 2^20 nodes, meshes or the like; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_gltf_parse(const char *text, size_t length, const char *name, hewn_gltf *out, hewn_error *error);
void hewn_gltf_free(hewn_gltf *gltf);

#ifdef __cplusplus
}
#endif
#endif
