/* An edge that is cut in two, with the triangles beside it. */
#ifndef HEWN_SRC_SIMPLIFY_SPLIT_H
#define HEWN_SRC_SIMPLIFY_SPLIT_H

#include "simplify/samples.h"

/* The new vertex, which stands for one of the input's that joined another, and two new triangles: numbers that are
 * free in the work. */
typedef struct simplify_split {
    uint32_t half;   /* of an edge that may be split */
    uint32_t sample; /* the vertex begins there */
    uint32_t origin; /* the input's vertex of that sample */
    uint32_t vertex, faces[2];
} simplify_split;

/* Whether the edge of a half-edge may be split: it has two triangles, is no feature, and nothing is known of its
 * corners' attributes. Never in a complex. */
bool hewn_simplify_may_split(const simplify_work *work, uint32_t h);

/* The input's vertex that a sample is, if none of the mesh stands for it; else HEWN_NONE. */
uint32_t hewn_simplify_free_origin(const simplify_work *work, uint32_t sample);

/* Whether no triangle turns over or becomes a sliver. */
bool hewn_simplify_split_allowed(const simplify_work *work, const simplify_split *split);

/* As hewn_simplify_probe_collapse(). The new triangles must have no samples. */
hewn_result hewn_simplify_probe_split(const simplify_work *work, const simplify_split *split, simplify_probe *probe);

void hewn_simplify_split(simplify_work *work, const simplify_split *split);

#endif
