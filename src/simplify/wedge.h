/* Attributes while a mesh is simplified. The corners at a vertex that have the same values are one wedge (Hoppe 1999,
 * 'New quadric metric for simplifying meshes with appearance attributes'); edges with different wedges on both sides
 * are seams, and features. */
#ifndef HEWN_SRC_SIMPLIFY_WEDGE_H
#define HEWN_SRC_SIMPLIFY_WEDGE_H

#include "hewn/base.h"
#include "simplify/quadric.h"

struct simplify_work;

enum { SIMPLIFY_MOST_COUNTED = 16 };

/* Scalars of all wedges, and how far they are from the input's by a quadric of each wedge: the sum over its triangles
 * of area × (g x + d - s)², where g x + d is the scalar over the triangle's plane and s the wedge's. Only the first
 * `counted` scalars count, in units of length: they are multiplied by `weights` before. */
typedef struct simplify_wedges {
    uint32_t count, scalars, counted;
    const uint32_t *corners; /* of the input: 3 a triangle; NULL: the wedge is the vertex */
    double *values;          /* count × scalars */
    uint8_t *fixed;          /* one a scalar: never blended, the nearer one stays */
    double weights[SIMPLIFY_MOST_COUNTED];
    double *sums; /* count × simplify_wedge_stride() */
} simplify_wedges;

/* One wedge's quadric: what does not depend on the scalars, then for each scalar the sums of area × g and area × d. */
typedef struct simplify_wedge_sum {
    simplify_quadric own; /* its weight is the area */
    double slope[SIMPLIFY_MOST_COUNTED][4];
} simplify_wedge_sum;

static inline size_t simplify_wedge_stride(const simplify_wedges *wedges)
{
    return sizeof(simplify_quadric) / sizeof(double) + 4 * (size_t)wedges->counted;
}

/* Wedges that become one where an edge collapses: one pair, or one for each side of a seam. */
typedef struct simplify_pairs {
    uint32_t count;
    uint32_t gone[2], kept[2];
} simplify_pairs;

simplify_pairs hewn_simplify_pair(const struct simplify_work *work, uint32_t half, uint32_t gone);

/* Sums over the triangles of each wedge. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_weigh_wedges(struct simplify_work *work, hewn_error *error);

/* Adds to `q` what the wedges of a collapse cost at each place if scalars are the best ones for that place. */
void hewn_simplify_add_pairs(const struct simplify_work *work, const simplify_pairs *pairs, simplify_quadric *q);

/* What they cost at one place if those that stay keep their scalars. */
double hewn_simplify_pairs_cost(const struct simplify_work *work, const simplify_pairs *pairs, const double at[3]);

/* Joins the wedges of a collapse and those corners at `gone`. `share` tells how far `at` is on the way from `kept` to
 * `gone`; `fixed`: scalars of `kept` stay. */
void hewn_simplify_join_wedges(struct simplify_work *work, const simplify_pairs *pairs, uint32_t gone,
                               const double at[3], double share, bool fixed);

#endif
