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
    char **dense;    /* gltf.accessor_count; the items of sparse accessors, put together when first asked for */
    uint64_t length; /* of the file */
    uint64_t loaded; /* bytes of buffers in files of their own */
    uint64_t spent;  /* bytes of memory, on what the document makes of them */
} hewn_gltf_data;

/* An accessor's items in memory, all of them there. */
typedef struct hewn_gltf_items {
    const char *first;
    uint64_t stride, count;
    int component_type, components;
    bool matrix, normalised;
} hewn_gltf_items;

/* Makes room for the above, once `gltf` and the other members are set. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_gltf_data_open(hewn_gltf_data *data, hewn_error *error);

/* Frees the buffers that were read. */
void hewn_gltf_data_free(hewn_gltf_data *data);

/* Counts bytes that are about to be allocated. A few words of JSON can ask for any amount: HEWN_LIMIT where all
 * together get out of proportion to the file. */
hewn_result hewn_gltf_spend(hewn_gltf_data *data, uint64_t count, uint64_t bytes, hewn_error *error);

/* Follows accessor `index`. HEWN_BAD_INPUT for anything out of range; reads the buffer if that has not happened yet. */
hewn_result hewn_gltf_items_of(hewn_gltf_data *data, int index, hewn_gltf_items *out, hewn_error *error);

/* The same for whole numbers that name something: BAD_INPUT for other items. */
hewn_result hewn_gltf_indices_of(hewn_gltf_data *data, int index, hewn_gltf_items *out, hewn_error *error);

/* The same without an accessor's sparse items. */
hewn_result hewn_gltf_base_of(hewn_gltf_data *data, int index, hewn_gltf_items *out, hewn_error *error);

/* Item `index` of indices. */
uint32_t hewn_gltf_index(const hewn_gltf_items *items, uint64_t index);

/* The components of an item as real numbers; those of normalised integers go from -1 or 0 to 1, each rounded once. */
void hewn_gltf_numbers(const hewn_gltf_items *items, uint64_t index, double *out);

#endif
