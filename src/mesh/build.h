/* How indexed faces become half-edges: shared by the files that build.
 *
 * Each corner of a face stands for the half-edge that leaves it for the next corner. Half-edges go into buckets by the
 * lesser of their two vertices (a counting sort), those that run up before those that run down, both in order of their
 * corners; inside a bucket partners are those with the same other vertex. Vertices are dealt out to `parts` threads in
 * ranges; a thread reads all faces and keeps what falls into its range, so nothing is shared and the order is always
 * the same. */
#ifndef HEWN_SRC_MESH_BUILD_H
#define HEWN_SRC_MESH_BUILD_H

#include "mesh/mesh_data.h"

/* Elements below which one thread does a loop alone: waking others costs more. */
#define HEWN_MESH_ALONE 50000u

enum { MESH_MOST_PARTS = 8 };

typedef struct mesh_source {
    uint32_t vert_count, face_count, corner_count;
    const double *doubles; /* positions: one of the two */
    const float *floats;
    const uint64_t *first; /* NULL: triangles */
    const uint32_t *corners;
} mesh_source;

static inline uint32_t mesh_source_begin(const mesh_source *source, uint32_t face)
{
    return source->first ? (uint32_t)source->first[face] : 3 * face;
}

/* A half-edge in a bucket: the greater vertex, and the corner that it leaves. */
typedef struct mesh_entry {
    uint32_t other, corner;
} mesh_entry;

typedef struct mesh_matching {
    uint32_t parts;
    uint32_t range[MESH_MOST_PARTS + 1]; /* part p has the vertices range[p] to range[p + 1] - 1 */
    uint32_t edges[MESH_MOST_PARTS + 1]; /* number of the first edge of part p; the last is the number of all */
    uint32_t open_edges;                 /* edges with one face */
    uint32_t fault;                      /* least vertex whose bucket has an edge that cannot be, or HEWN_NONE */
    uint32_t *ends;      /* two a vertex: where its upward and its downward half-edges end in `entries` */
    mesh_entry *entries; /* one a corner */
    uint32_t *halves;    /* of each corner, counted from the part's first edge */
} mesh_matching;

/* HEWN_OUT_OF_MEMORY. Whether there is a fault is for the caller to see. `any_corner` (one a vertex) gets the last
 * corner at each vertex, HEWN_NONE where there is none. */
hewn_result hewn_mesh_match(const mesh_source *source, uint32_t *any_corner, mesh_matching *out, hewn_error *error);
void hewn_mesh_matching_free(mesh_matching *matching);

/* Says what is wrong in the bucket `matching->fault`. HEWN_BAD_INPUT. */
hewn_result hewn_mesh_explain_fault(const mesh_source *source, const mesh_matching *matching, hewn_error *error);

/* HEWN_BAD_INPUT for the first face that is none or names a vertex that is not there. */
hewn_result hewn_mesh_check_faces(const mesh_source *source, hewn_error *error);

#endif
