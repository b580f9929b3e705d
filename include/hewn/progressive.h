/* Progressive meshes (Hoppe 1996, 'Progressive meshes'): a coarse mesh and the vertex splits that lead from it, one
 * after the other, to the mesh that it was made of, bit for bit. Files of them (.hpm) are described in docs/hpm.md. */
#ifndef HEWN_PROGRESSIVE_H
#define HEWN_PROGRESSIVE_H

#include "hewn/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Vertices and triangles are numbered in the order in which they come: first those of the coarsest mesh (the base),
 * then split i adds vertex base_vertices + i, and two triangles (one along a boundary). A split moves nothing: the new
 * vertex opens out of its parent, which stays where it is, and takes some of the parent's triangles with it. So every
 * mesh on the way has a part of the input's vertices, with all their attributes.
 *
 * Any number of threads may ask one progressive mesh at the same time. */
typedef struct hewn_progressive hewn_progressive;

/* What to do; zero means the default.
 *
 * faces: no coarser than so many triangles; 0: as coarse as may be. measure: find out how far meshes on the way are
 * from the input, proven, at each halving of the triangles (hewn_progressive_mark). */
typedef struct hewn_progressive_desc {
    uint64_t faces;
    bool measure;
    const hewn_progress *progress; /* or NULL; stages "simplify" and "measure" */
} hewn_progressive_desc;

/* A number of splits at which the two-sided Hausdorff distance to the input is between `error_low` and `error`. */
typedef struct hewn_progressive_mark {
    uint64_t splits, triangles;
    double error, error_low;
} hewn_progressive_mark;

typedef struct hewn_progressive_info {
    uint64_t base_vertices, base_triangles;
    uint64_t vertices, triangles; /* after all splits */
    uint64_t faces;               /* of the input, which may have been polygons */
    uint64_t splits;              /* there are in all, */
    uint64_t splits_there;        /* and so many of these are here: fewer where a file was cut off */
    bool complete;                /* all that is needed for the input is here */
    uint32_t mark_count;
    const hewn_progressive_mark *marks; /* from coarse to fine; they live as long as the mesh */
} hewn_progressive_info;

/* Collapses a model, vertex by vertex, each into one of its neighbours, those first that change the shape least
 * (quadrics of Garland and Heckbert 1997). Vertices where the model is not manifold stay; topology stays; so do
 * boundaries, seams of corner attributes and borders between labels, materials, groups and objects, along which
 * vertices only go along. No triangle turns by more than 78 degrees at once. Polygons are cut into triangles on the
 * way, and are polygons again in the end. The model is only read. The same for any number of threads.
 *
 * HEWN_LIMIT for 2^32 - 2 corners and more; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED; the errors of hewn_model_check(). About
 * 400 bytes a triangle of memory. `desc` may be NULL. */
HEWN_API hewn_result hewn_progressive_make(const hewn_model *model, const hewn_progressive_desc *desc,
                                           hewn_progressive **out, hewn_error *error);
HEWN_API void hewn_progressive_destroy(hewn_progressive **progressive);

HEWN_API hewn_progressive_info hewn_progressive_about(const hewn_progressive *progressive);

/* The most splits that leave at most so many triangles; 0 where even the base has more. */
HEWN_API uint64_t hewn_progressive_splits_for(const hewn_progressive *progressive, uint64_t triangles);

/* The triangles after so many splits, which must be there. */
HEWN_API uint64_t hewn_progressive_triangles_at(const hewn_progressive *progressive, uint64_t splits);

/* The fewest splits of a mark whose proven error is at most so much; all splits there are where no mark's is. */
HEWN_API uint64_t hewn_progressive_splits_within(const hewn_progressive *progressive, double error);

/* The mesh after so many splits: triangles, in the order of the stream. With all splits of a complete one it is the
 * input: order, polygons and all bits. HEWN_INVALID_ARGUMENT for more splits than there are; HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_progressive_model(const hewn_progressive *progressive, uint64_t splits, hewn_model *out,
                                            hewn_error *error);

/* A geomorph: the mesh after `fine` splits, always in the order of the stream, and for each of its vertices the one
 * that it comes out of in the mesh after `coarse` splits, which has the same number in both (`ancestors`, vertex_count
 * of `out`, hewn_free'd by hewn_progressive_ancestors_free()). With every vertex moved to its ancestor the fine mesh
 * lies where the coarse one does; a vertex on its straight way from there to its own place is in between. */
HEWN_API hewn_result hewn_progressive_geomorph(const hewn_progressive *progressive, uint64_t coarse, uint64_t fine,
                                               hewn_model *out, uint32_t **ancestors, hewn_error *error);
HEWN_API void hewn_progressive_ancestors_free(uint32_t *ancestors);

/* A file's bytes, which hewn_progressive_bytes_free() frees. HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_progressive_encode(const hewn_progressive *progressive, char **bytes, size_t *length,
                                             hewn_error *error);
HEWN_API void hewn_progressive_bytes_free(char *bytes);

/* The way back. Every number is checked: whatever the bytes, each mesh on the way is a valid model. `partial` takes
 * bytes that end early, with as many splits as are whole; the base must be. `name` is for messages. HEWN_BAD_INPUT says
 * what is wrong where; HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_progressive_decode(const char *bytes, size_t length, const char *name, bool partial,
                                             hewn_progressive **out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
