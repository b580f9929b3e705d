/* A model's triangles while vertices are folded into their neighbours. */
#ifndef HEWN_SRC_PROGRESSIVE_FOLD_H
#define HEWN_SRC_PROGRESSIVE_FOLD_H

#include <stdint.h>

#include "base/error.h"
#include "hewn/model.h"
#include "hewn/progressive.h"
#include "progressive/stream.h"

/* Vertices with more triangles stay: what is looked at around a vertex is kept on the stack. */
enum { FOLD_MOST = 64 };

/* What a vertex may do. */
typedef enum fold_state {
    FOLD_FREE,
    FOLD_BORDER, /* shared with what is not seen here: others may join it, but no two of them get a new edge */
    FOLD_STAYS,  /* not manifold here, or too many triangles: takes no part */
    FOLD_GONE
} fold_state;

/* Sum of weighted squared distances to planes: value at x is x' A x + 2 b' x + c, A as xx xy xz yy yz zz. */
typedef struct fold_quadric {
    double a[6], b[3], c;
} fold_quadric;

/* One vertex folded into another, in the order in which that was done. */
typedef struct fold_record {
    uint32_t vertex, into;
    uint32_t first_change, first_removed;
    float error;
} fold_record;

typedef struct fold {
    const hewn_model *model;
    double origin[3], scale; /* model position = origin + scale × position */
    double *positions;       /* 3 a vertex */
    uint32_t vertex_count, wedge_count, triangle_count, live_triangles;
    uint32_t *wedge_vertices;
    uint32_t *wedge_places;  /* a corner of the model that has its values; HEWN_NONE: the vertex has no corner */
    uint32_t *corner_wedges; /* of each of the model's corners */
    uint32_t *triangles;     /* 3 wedges; those of removed ones stay */
    uint32_t *faces;         /* the model's face of each */
    uint8_t *removed;
    int32_t *labels; /* of triangles; NULL: all are alike */
    float *deviations;

    uint8_t *states;
    fold_quadric *quadrics;
    uint32_t *list_first, *list_count; /* triangles around each vertex, in `pool` */
    uint32_t *pool;
    size_t pool_count, pool_room;
    uint32_t *stamps, stamp; /* of vertices; for sets */

    fold_record *records;
    size_t record_count, record_room;
    progressive_change *changes; /* corner, wedge after folding (`before` of the split), wedge before it (`after`) */
    size_t change_count, change_room;
    uint32_t *gone; /* triangles */
    size_t gone_count, gone_room;
} fold;

/* Triangles around a vertex, counter-clockwise. Neighbour i is next[i]'s vertex; in an open fan there is one more. */
typedef struct fold_star {
    uint32_t count;
    bool open;
    uint32_t triangle[FOLD_MOST];
    uint32_t own[FOLD_MOST], next[FOLD_MOST], previous[FOLD_MOST]; /* wedges at the corners */
} fold_star;

static inline const double *fold_at(const fold *of, uint32_t vertex)
{
    return of->positions + 3 * (size_t)vertex;
}

/* Wedges, triangles and all arrays of a model; HEWN_LIMIT, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. Release it also after an
 * error. */
hewn_result hewn_fold_begin(const hewn_model *model, const hewn_progress *progress, fold *out, hewn_error *error);
void hewn_fold_release(fold *of);

/* The star of a free vertex; false where it is no fan or too large. */
bool hewn_fold_star_find(const fold *of, uint32_t vertex, fold_star *out);

/* Vertices between triangles: `i` from 0 to the count (in an open fan to the count itself). */
uint32_t hewn_fold_neighbour(const fold *of, const fold_star *star, uint32_t i);

/* Whether surface or values end or break at the edge to neighbour `i`. */
bool hewn_fold_feature(const fold *of, const fold_star *star, uint32_t i);

/* Quadrics of all vertices, and states. */
void hewn_fold_weigh(fold *of);

/* The cheapest neighbour (its number in the star) that a vertex may be folded into, and at what cost; HEWN_NONE where
 * there is none. */
uint32_t hewn_fold_choose(fold *of, uint32_t vertex, fold_star *star, double *cost);

/* How far the surface moves where the vertex of a star is folded into neighbour `i`, a length of `positions`: the
 * greatest distance that is found at the vertex and at the middles of new edges. */
double hewn_fold_distance(const fold *of, uint32_t vertex, const fold_star *star, uint32_t i);

/* Folds it. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_fold_do(fold *of, uint32_t vertex, const fold_star *star, uint32_t i, hewn_error *error);

/* Folds vertices until at most so many triangles are left, or none may be folded. */
hewn_result hewn_fold_run(fold *of, uint64_t triangles, const hewn_progress *progress, hewn_error *error);

/* The stream of what was folded. */
hewn_result hewn_fold_unwind(const fold *of, hewn_progressive *out, hewn_error *error);

#endif
