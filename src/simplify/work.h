/* The mesh while it is simplified: triangles as half-edges in 32-bit tables that are only this room's, 3 a triangle.
 *
 * Half-edge h belongs to triangle h / 3, leaves vertex tail[h] and runs to the tail of the next one. Its twin is the
 * other half-edge of a manifold edge, HEWN_NONE along a boundary. A vertex knows one half-edge that leaves it: on a
 * boundary the one without twin, which is the clockwise end of its fan. A removed triangle has HEWN_NONE as its first
 * tail, a removed vertex SIMPLIFY_GONE as its half-edge.
 *
 * An edge's own values stand at the lesser of its half-edges, its name. */
#ifndef HEWN_SRC_SIMPLIFY_WORK_H
#define HEWN_SRC_SIMPLIFY_WORK_H

#include <stdint.h>

#include "hewn/simplify.h"
#include "simplify/quadric.h"
#include "simplify/wedge.h"

#define SIMPLIFY_GONE 0xFFFFFFFEu

/* Meshes of fewer vertices are done by one thread: waking others takes longer. */
enum { SIMPLIFY_FEW = 4000 };

/* The most fans of a vertex of a complex that may move; others stay. */
enum { SIMPLIFY_MOST_TIED = 16 };

/* What a vertex may do. A higher rank stays where a lower one joins it; vertices from CORNER on never move and never
 * join another, and those that are APART take no part in any collapse. */
typedef enum simplify_rank {
    SIMPLIFY_SMOOTH,
    SIMPLIFY_CREASE, /* two feature edges meet: it may move along them */
    SIMPLIFY_CORNER, /* one or three and more */
    SIMPLIFY_LOCKED, /* by the caller */
    SIMPLIFY_APART,  /* not manifold here: neighbours cannot be walked around */
} simplify_rank;

/* Of edges, at their names. Boundary edges are features too. */
enum {
    SIMPLIFY_FEATURE = 1,
    SIMPLIFY_FRESH = 2,   /* its key is that of its ends as they are; else it is a lower bound */
    SIMPLIFY_QUEUED = 4,  /* waits in a queue */
    SIMPLIFY_SLIM = 8,    /* its collapse makes a sliver, which its key was raised for */
    SIMPLIFY_PROBED = 16, /* its key was raised to what the collapse does to samples, if that is more */
    SIMPLIFY_STRICT = 32, /* its key was raised if the collapse turns a triangle away from the input */
    SIMPLIFY_RAISED = SIMPLIFY_SLIM | SIMPLIFY_PROBED | SIMPLIFY_STRICT
};

typedef struct simplify_work {
    const hewn_simplify_desc *desc;
    const uint8_t *frozen;               /* besides those of `desc`; or NULL */
    const float *limits;                 /* of the input's vertices, lengths; NULL: none */
    double origin[3], scale;             /* input position = origin + scale × position */
    double progress_begin, progress_end; /* of the stage, for the run under way */

    uint32_t vertex_count, live_vertices;
    double *positions; /* 3 a vertex */
    simplify_quadric *quadrics;
    float *facing; /* 3 a vertex: area vectors of the input's triangles around all that joined it */
    uint32_t *half;
    uint8_t *rank;
    uint32_t *origins; /* the input's vertex */
    uint32_t *tie;     /* the next of the vertices that are one in a complex, in a ring; NULL: none are */
    float *limit;      /* the root of value / weight that a collapse here may come to; NULL: any */

    const uint32_t *groups; /* of the input's vertices: equal for those that are one; NULL: none are */

    uint32_t face_count, live_faces;
    uint32_t *tail, *twin;
    float *key;                       /* cost at the name of each edge */
    uint8_t *flags;                   /* likewise */
    uint32_t *face_origins;           /* the input's triangle */
    simplify_wedges *wedges;          /* NULL: no attributes; the caller's */
    uint32_t *wedge;                  /* of the corner at each half-edge's tail */
    struct simplify_samples *samples; /* NULL: none; not owned */

    uint32_t input_count;
    uint32_t *into; /* of each of the input's vertices: itself, or the one that it was joined to */

} simplify_work;

static inline uint32_t simplify_next(uint32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}

static inline uint32_t simplify_prev(uint32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}

static inline uint32_t simplify_head(const simplify_work *work, uint32_t h)
{
    return work->tail[simplify_next(h)];
}

static inline uint32_t simplify_name(const simplify_work *work, uint32_t h)
{
    return h < work->twin[h] ? h : work->twin[h];
}

/* A number for what a vertex is in the complex. */
static inline uint32_t simplify_group(const simplify_work *work, uint32_t v)
{
    return work->groups ? work->groups[work->origins[v]] : v;
}

static inline bool simplify_is_tied(const simplify_work *work, uint32_t v)
{
    return work->tie && work->tie[v] != v;
}

static inline const double *simplify_at(const simplify_work *work, uint32_t v)
{
    return work->positions + 3 * (size_t)v;
}

/* A coordinate of the input in those of the work. */
static inline double simplify_inward(const simplify_work *work, double coordinate, size_t axis)
{
    return (coordinate - work->origin[axis]) / work->scale;
}

/* The next half-edge that leaves the same vertex, counter-clockwise; HEWN_NONE at the end of a fan. */
static inline uint32_t simplify_turn(const simplify_work *work, uint32_t h)
{
    return work->twin[simplify_prev(h)];
}

/* Arrays of `work` for triangles of which nothing is known but that indices are in range: twins, half-edges, ranks of
 * what is not manifold. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_build(simplify_work *work, const hewn_polygons *triangles, hewn_error *error);
void hewn_simplify_release(simplify_work *work);

/* The same again, but for attributes and samples, which are not owned. HEWN_OUT_OF_MEMORY; what is there then is to be
 * released as well. */
hewn_result hewn_simplify_copy(const simplify_work *work, simplify_work *out, hewn_error *error);

/* Makes room for more, free as if removed. Not with attributes, not of a complex. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_grow(simplify_work *work, uint32_t vertices, uint32_t faces, hewn_error *error);

/* Marks features and ranks vertices. */
hewn_result hewn_simplify_mark(simplify_work *work, hewn_error *error);

/* Quadrics of all vertices and wedges, then keys of all edges. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_weigh(simplify_work *work, hewn_error *error);

/* Puts vertices and triangles that are left into an order in which neighbours are near each other, along Hilbert's
 * curve through cubes that lie elsewhere for each `round`; removed ones are dropped. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_order(simplify_work *work, uint32_t round, hewn_error *error);

/* Collapses edges until `target` triangles are left, or none may be collapsed any more. `work` is in the order of round
 * 0, and is so afterwards. `early`: another run follows. */
hewn_result hewn_simplify_run(simplify_work *work, uint32_t target, bool early, hewn_error *error);

#endif
