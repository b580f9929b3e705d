/* What is done with clusters, one pass after the other. */
#ifndef HEWN_SRC_ISO_CLUSTER_PASSES_H
#define HEWN_SRC_ISO_CLUSTER_PASSES_H

#include "iso/adaptive.h"
#include "iso/cluster.h"

/* From nodes of two cells a side upward: the connected clusters of each node become one where they may. Nodes three
 * apart along every axis do not know of each other, so 27 turns a level suffice for any number of threads. */
hewn_result hewn_clusters_merge_octree(hewn_clusters *clusters, const hewn_progress *progress,
                                       hewn_adaptive_stats *stats, hewn_error *error);

/* Neighbours, those first that cost least, until no more may. */
hewn_result hewn_clusters_merge_pairs(hewn_clusters *clusters, const hewn_progress *progress,
                                      hewn_adaptive_stats *stats, hewn_error *error);

/* The polygons as triangles, the vertices in the order of the clusters. */
hewn_result hewn_clusters_triangulate(const hewn_clusters *clusters, hewn_triangles *out, hewn_adaptive_stats *stats,
                                      hewn_error *error);

#endif
