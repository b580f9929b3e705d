/* A dual surface with no more triangles than a tolerance asks for.
 *
 * The vertices of a uniform dual surface are gathered level by level in the nodes of an octree, each connected group of
 * a node to one vertex at the minimum of its quadric (Ju, Losasso, Schaefer, Warren 2002); then neighbours pair by
 * pair, wherever nodes have parted them. A merge is taken only where the surface stays a manifold of the same topology
 * (after Schaefer, Ju, Warren 2007; see cluster.h), turns no polygon over, and stays within the tolerance. */
#ifndef HEWN_SRC_ISO_ADAPTIVE_H
#define HEWN_SRC_ISO_ADAPTIVE_H

#include "hewn/triangles.h"
#include "iso/dual.h"

typedef struct hewn_adaptive_stats {
    uint32_t levels;        /* of the octree that were merged */
    uint64_t octree_merges; /* in nodes */
    uint64_t pair_merges;   /* of neighbours */
    uint64_t refused[4];    /* for: topology, no point near all planes, a polygon turned over, a surface too far off */
    uint64_t octree_vertices; /* after the octree */
    uint64_t centres;         /* vertices put into quads that no diagonal can cut */
} hewn_adaptive_stats;

/* Collapses a surface. `error_length`, in scene units and at least 0, is how far it may move: every crossing of the
 * uniform surface, and every vertex of it that lies on the field's surface, is within it of the polygons (a tenth of a
 * thousandth of a cell is added, for rounding), and these stray from the uniform surface by no more than that and half
 * a cell where they were looked at. Vertices on the bounds of an open grid stay on them. A vertex that is merged with
 * no other keeps its position and normal to the bit.
 *
 * The triangles come from the heap, the same bytes for any number of threads. About 400 bytes a vertex of the uniform
 * surface while it runs. `progress` may be NULL, its stage is "collapse"; so may `stats`. HEWN_INVALID_ARGUMENT for an
 * error that is negative or not finite, HEWN_LIMIT from 2^29 quads on, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
hewn_result hewn_adaptive_collapse(const hewn_dual_surface *surface, double error_length, const hewn_progress *progress,
                                   hewn_triangles *out, hewn_adaptive_stats *stats, hewn_error *error);

#endif
