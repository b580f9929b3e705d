/* Clusters while they are made. */
#ifndef HEWN_SRC_CLUSTERS_WORK_H
#define HEWN_SRC_CLUSTERS_WORK_H

#include "base/error.h"
#include "hewn/clusters.h"
#include "progressive/fold.h"

/* Triangles of wedges (numbers of the whole model's `fold`) and the faces they come from. */
typedef struct clusters_soup {
    uint32_t *wedges; /* 3 a triangle */
    uint32_t *faces;
    size_t count, room;
} clusters_soup;

typedef struct clusters_work {
    const hewn_model *model;
    hewn_clusters_desc desc;
    fold whole; /* wedges, triangles and labels of the model; nothing is folded in it */
    hewn_clusters *out;
    size_t cluster_room, vertex_room, triangle_room;
    uint32_t *active; /* clusters that nothing was made of yet, in order */
    size_t active_count;
    uint32_t *stamps; /* of wedges: where each stands in the list of a cluster */
    int32_t *labels;  /* of the model's faces; NULL: all are alike */
} clusters_work;

/* Cuts triangles into clusters of at most so many vertices and triangles, which grow from triangle to neighbour; adds
 * them to the result with `self` and `level`. HEWN_OUT_OF_MEMORY, HEWN_LIMIT. */
hewn_result hewn_clusters_cut(clusters_work *work, const clusters_soup *soup, uint32_t level,
                              const hewn_cluster_bound *self, hewn_error *error);

/* Sorts the active clusters into groups: `*groups` gets one number an active cluster, from 0 to the count returned in
 * `*count`; the caller's. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_clusters_group(const clusters_work *work, uint32_t **groups, uint32_t *count, hewn_error *error);

/* What became of a group: coarser triangles, or none where it could not be made much coarser. */
typedef struct clusters_coarse {
    clusters_soup soup;
    hewn_cluster_bound bound;
} clusters_coarse;

/* Simplifies the triangles of a group's clusters to a half, vertices marked in `border` (by the model's vertex) being
 * used elsewhere. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_clusters_coarsen(const clusters_work *work, const uint32_t *members, size_t count,
                                  const uint8_t *border, clusters_coarse *out, hewn_error *error);

hewn_result hewn_clusters_soup_add(clusters_soup *soup, const uint32_t wedges[3], uint32_t face, hewn_error *error);
void hewn_clusters_soup_release(clusters_soup *soup);

/* The least float that is not below. */
float hewn_clusters_round_up(double value);

/* Corner k of triangle t of a cluster, as a wedge. */
static inline uint32_t clusters_wedge(const hewn_clusters *of, const hewn_cluster *cluster, uint32_t t, uint32_t k)
{
    return of->vertices[cluster->first_vertex + of->corners[3 * (size_t)(cluster->first_triangle + t) + k]];
}

#endif
