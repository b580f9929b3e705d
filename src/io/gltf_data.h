/* The bytes behind a glTF document's buffers, and checked ways into them. */
#ifndef HEWN_SRC_IO_GLTF_DATA_H
#define HEWN_SRC_IO_GLTF_DATA_H

#include "io/shim/gltf.h"

typedef struct hewn_gltf_bytes {
    const char *bytes;
    uint64_t length;
    char *owned; /* `bytes` where it is ours, else NULL */
} hewn_gltf_bytes;

typedef struct hewn_gltf_data {
    const char *name; /* of the file, for messages */
    const char *path; /* where buffers in files of their own are looked for; NULL: nowhere */
    const char *chunk;
    uint64_t chunk_length; /* of the binary chunk */
    hewn_gltf gltf;
    hewn_gltf_bytes *buffers; /* gltf.buffer_count; read when first asked for */
    uint64_t loaded;          /* bytes of buffers in files of their own */
} hewn_gltf_data;

/* An accessor's items in memory, all of them inside their buffer. */
typedef struct hewn_gltf_items {
    const char *first;
    uint64_t stride, count;
    int component_type, components;
} hewn_gltf_items;

enum { HEWN_GLTF_UBYTE = 5121, HEWN_GLTF_USHORT = 5123, HEWN_GLTF_UINT = 5125, HEWN_GLTF_FLOAT = 5126 };

/* Follows accessor `index`. HEWN_BAD_INPUT for anything out of range; reads the buffer if that has not happened yet. */
hewn_result hewn_gltf_items_of(hewn_gltf_data *data, int index, hewn_gltf_items *out, hewn_error *error);

/* Frees the buffers that were read. */
void hewn_gltf_data_free(hewn_gltf_data *data);

#endif
