/* A mesh on disk: vertices by their numbers, which they keep, and a list of triangles. What both carry besides is that
 * of a model's channels. */
#ifndef HEWN_SRC_OUTCORE_STORE_H
#define HEWN_SRC_OUTCORE_STORE_H

#include "hewn/model.h"
#include "outcore/chains.h"
#include "outcore/pages.h"

/* What becomes of a channel: it is there to the end, or only its name is, for values that are made anew in the end, or
 * nothing. */
typedef enum hewn_store_fate { HEWN_STORE_KEPT, HEWN_STORE_RENEWED, HEWN_STORE_DROPPED } hewn_store_fate;

/* Where the values of a channel lie in records. */
typedef struct hewn_store_place {
    hewn_store_fate fate;
    size_t offset, size; /* bytes, in what a record has of the channel's domain */
} hewn_store_place;

/* A record of a vertex: 3 doubles, the values of its channels, a byte. */
enum { HEWN_STORE_LOCKED = 1 };

typedef struct hewn_store {
    const char *output; /* beside which temporary files go; the caller's */
    uint32_t preserve;
    size_t memory;                    /* bytes for pages of vertices */
    hewn_model schema;                /* without vertices and faces: the channels, with unit and axes */
    hewn_store_place *places;         /* one a channel */
    bool vertices_known, faces_known; /* whether the channels of vertices are there, and the others */
    size_t value_bytes[3];            /* of a vertex, a corner, a face: by hewn_domain */
    hewn_pages *vertices;
    uint64_t vertex_count;
    hewn_chains chains;
    hewn_chain triangles; /* 3 numbers of vertices, values of 3 corners, values of the face */
    hewn_chains polygons; /* until they are cut: a record a corner, the corners that follow, the same */
    hewn_chain polygon_corners;
    uint64_t faces_before;     /* polygons count once */
    uint64_t triangles_before; /* that faces were cut into */
    uint64_t dropped_faces;    /* of those, for naming a vertex twice */
    char *record;              /* for one triangle or vertex at a time */
} hewn_store;

/* An empty one. `preserve` as in hewn_simplify_desc, not 0: it decides which channels are carried along. */
void hewn_store_begin(const char *output, uint32_t preserve, size_t memory, hewn_store *out);
void hewn_store_free(hewn_store *store);

/* Adds the vertices and faces of a part of a model, whose values may get other numbers on the way. Its faces name
 * vertices of the whole, from 0 on, which may be yet to come. All parts with vertices have the same channels of those,
 * and all with faces the same of corners and faces, HEWN_LIMIT where they have not. HEWN_BAD_INPUT for a position that
 * is not finite; HEWN_LIMIT for more vertices than indices can name; HEWN_IO; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_store_add(hewn_store *store, hewn_model *part, hewn_error *error);

/* All is there: polygons are cut, in runs of many. HEWN_BAD_INPUT for a polygon with a vertex that is not there, while
 * hewn_store_bounds() finds those of triangles; HEWN_IO; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_store_finish(hewn_store *store, hewn_error *error);

/* Bytes of a record of the list of triangles. */
size_t hewn_store_triangle_bytes(const hewn_store *store);

/* Bytes of a record of a vertex, and where it is now. HEWN_IO. */
size_t hewn_store_vertex_bytes(const hewn_store *store);
hewn_result hewn_store_vertex(hewn_store *store, uint32_t vertex, double position[3], hewn_error *error);

/* A model with room for so many vertices and faces, and with channels for them; `renewed`: also those that are made
 * anew, zero. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_store_make_model(const hewn_store *store, uint64_t vertices, uint64_t faces, bool renewed,
                                  hewn_model *out, hewn_error *error);

/* Values from a record to a model and back; `record` points to those of the channels of a domain. Models are those of
 * hewn_store_make_model(), or what simplification made of them. */
void hewn_store_get_values(const hewn_store *store, hewn_domain domain, const char *record, hewn_model *model,
                           uint64_t element);
void hewn_store_put_values(const hewn_store *store, hewn_domain domain, char *record, const hewn_model *model,
                           uint64_t element);

#endif
