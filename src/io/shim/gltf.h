/* glTF's JSON, made and read by tinygltf behind a C face. Buffers are not touched here: only what is said of them. */
#ifndef HEWN_SRC_IO_SHIM_GLTF_H
#define HEWN_SRC_IO_SHIM_GLTF_H

#include "hewn/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "base/text.h"

enum { HEWN_GLTF_NONE = -1 };

/* Component types. */
enum {
    HEWN_GLTF_BYTE = 5120,
    HEWN_GLTF_UBYTE = 5121,
    HEWN_GLTF_SHORT = 5122,
    HEWN_GLTF_USHORT = 5123,
    HEWN_GLTF_UINT = 5125,
    HEWN_GLTF_FLOAT = 5126
};

/* --- making ------------------------------------------------------------------------------------------------------- */

typedef struct hewn_gltf_stream {
    const char *semantic; /* "NORMAL", "_AGE" */
    int component_type, components;
    bool normalised;
    uint32_t item; /* bytes from one to the next: a multiple of 4 */
} hewn_gltf_stream;

/* Triangles of one material, one after the other. */
typedef struct hewn_gltf_run {
    const char *material; /* its name; NULL: none */
    uint64_t first_index, index_count;
} hewn_gltf_run;

/* How to get back the vertices from which those of the buffer were split: where a place in the indices is named, the
 * vertex there counts as the one that is given for it. */
typedef enum hewn_gltf_topology {
    HEWN_GLTF_NO_TOPOLOGY, /* none were */
    HEWN_GLTF_MANIFOLD,    /* EXT_mesh_manifold: that makes a closed, oriented manifold */
    HEWN_GLTF_OWN_TOPOLOGY /* the same in the mesh's extras, where it makes none */
} hewn_gltf_topology;

/* One mesh. The buffer holds positions, the streams, indices, and, from the next multiple of 4, the places of merges (4
 * bytes each) and their vertices (as large as indices), in that order and without gaps. */
typedef struct hewn_gltf_desc {
    const char *name, *generator;
    uint64_t vertex_count, index_count; /* where `index_count` is 0 the scene is empty */
    bool short_indices;
    float lo[3], hi[3]; /* of the positions */
    const hewn_gltf_stream *streams;
    size_t stream_count;
    const hewn_gltf_run *runs; /* they make up the indices */
    size_t run_count;
    hewn_gltf_topology topology;
    uint64_t merge_count;
    const char *conversion; /* JSON that goes to the asset's extras; NULL: none */
    const char *space;      /* likewise, as a string */
} hewn_gltf_desc;

hewn_result hewn_gltf_compose(const hewn_gltf_desc *desc, hewn_text *out, hewn_error *error);

/* --- reading ------------------------------------------------------------------------------------------------------ */

typedef struct hewn_gltf_buffer {
    const char *uri; /* NULL: the binary chunk of the file itself */
    uint64_t length;
} hewn_gltf_buffer;

typedef struct hewn_gltf_view {
    int buffer;
    uint64_t offset, length;
    uint64_t stride; /* 0: tight */
} hewn_gltf_view;

/* Items that differ from those in the accessor's view. */
typedef struct hewn_gltf_sparse {
    uint64_t count; /* 0: the accessor is not sparse */
    int place_view, place_type;
    uint64_t place_offset;
    int value_view;
    uint64_t value_offset;
} hewn_gltf_sparse;

typedef struct hewn_gltf_accessor {
    int view; /* HEWN_GLTF_NONE: zeros */
    uint64_t offset, count;
    int component_type;
    int components; /* 1 to 16 */
    bool matrix;    /* whose columns are padded where components are small */
    bool normalised;
    hewn_gltf_sparse sparse;
} hewn_gltf_accessor;

typedef struct hewn_gltf_attribute {
    const char *semantic;
    int accessor;
} hewn_gltf_attribute;

typedef struct hewn_gltf_primitive {
    int mode; /* 4 triangles, 5 strip, 6 fan; below are points and lines */
    int positions, indices, material;
    size_t first_attribute, attribute_count; /* others than POSITION, in the order of their names */
} hewn_gltf_primitive;

typedef struct hewn_gltf_mesh {
    const char *name; /* may be empty */
    size_t first_primitive, primitive_count;
    bool has_topology; /* accessors of what hewn_gltf_topology says: merges are the sparse items of the indices */
    int topology_positions, topology_indices;
} hewn_gltf_mesh;

typedef struct hewn_gltf_node {
    const char *name; /* may be empty */
    int mesh;
    double matrix[16]; /* column-major, to the parent's coordinates */
    size_t first_child, child_count;
} hewn_gltf_node;

/* A document. Numbers that name other things are as the file has them: whoever follows one checks it. */
typedef struct hewn_gltf {
    const hewn_gltf_buffer *buffers;
    const hewn_gltf_view *views;
    const hewn_gltf_accessor *accessors;
    const hewn_gltf_attribute *attributes;
    const hewn_gltf_primitive *primitives;
    const hewn_gltf_mesh *meshes;
    const hewn_gltf_node *nodes;
    const int *children;
    const int *roots;             /* of the scene to show; all parentless nodes where there is no scene */
    const char *const *materials; /* their names, which may be empty */
    const float (*colors)[4];     /* their base colours, linear, 0 to 1; white where the file says none */
    size_t buffer_count, view_count, accessor_count, attribute_count, primitive_count, mesh_count, node_count,
        child_count, root_count, material_count;
    void *owner;
} hewn_gltf;

/* From JSON text. HEWN_BAD_INPUT for what is not glTF 2 or needs extensions that change geometry and are not known;
 * HEWN_LIMIT for more than 2^20 nodes, meshes or the like; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_gltf_parse(const char *text, size_t length, const char *name, hewn_gltf *out, hewn_error *error);
void hewn_gltf_free(hewn_gltf *gltf);

#ifdef __cplusplus
}
#endif
#endif
