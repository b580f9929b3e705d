/* Clusters of triangles in levels of detail, for renderers that choose level and visibility by the cluster: groups of
 * clusters are simplified together with their outer borders kept, so that cuts through the hierarchy have no cracks
 * (Cignoni, Ganovelli, Gobbetti, Marton, Ponchio and Scopigno 2005, 'Batched multi triangulation'; Karis, Stubbe and
 * Wihlidal 2021, 'Nanite: a deep dive'). */
#ifndef HEWN_CLUSTERS_H
#define HEWN_CLUSTERS_H

#include "hewn/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What to do; zero means the default.
 *
 * vertices, triangles: the most that a cluster has; 64 and 124 by default, at most 255 and 512, at least 3 and 1.
 * group: clusters that are simplified together, 2 to 32, 8 by default. */
typedef struct hewn_clusters_desc {
    uint32_t vertices, triangles;
    uint32_t group;
    const hewn_progress *progress; /* or NULL; the stage is "simplify" */
} hewn_clusters_desc;

/* How far a surface is from the input's, certainly not more, and where. Numbers are floats; the errors along the
 * hierarchy rise, and each sphere holds those of what it was made of, so that seen from anywhere the projected error
 * rises too. */
typedef struct hewn_cluster_bound {
    float error; /* a length; infinite for what nothing was made of */
    float center[3], radius;
} hewn_cluster_bound;

/* One cluster: triangles `first_triangle` on, each of three corners, which name entries of the cluster's own list of
 * vertices, `first_vertex` on.
 *
 * It is drawn where `self` is good enough and `parent` is not. All clusters that were made together have the same
 * `self`, and all that were simplified together the same `parent`, so that they are chosen together. */
typedef struct hewn_cluster {
    uint32_t first_vertex, vertex_count;
    uint32_t first_triangle, triangle_count;
    uint32_t level; /* 0: of the input's triangles */
    hewn_cluster_bound self, parent;
    float center[3], radius; /* of its own triangles */
} hewn_cluster;

/* All clusters, level by level. A vertex is one of the input's with one set of values of its corners' attributes: it is
 * `vertex_origins` and the values are those of corner `corner_origins` (HEWN_NONE: it has none). Leave it with
 * hewn_clusters_destroy(). */
typedef struct hewn_clusters {
    hewn_cluster *clusters;
    uint32_t count, level_count;
    uint32_t *vertices;    /* of all clusters, one after the other */
    uint64_t vertex_count; /* entries of that */
    uint8_t *corners;      /* 3 a triangle */
    uint32_t *faces;       /* the input's face that each triangle is what is left of */
    uint64_t triangle_count;
    uint32_t *vertex_origins, *corner_origins;
    uint32_t unique_count; /* entries of those two */
} hewn_clusters;

/* Makes clusters of a model; polygons are cut into triangles. Vertices stay where they are, so all levels have a part
 * of the input's. Boundaries, seams and borders between labels are kept as hewn_progressive_make() keeps them.
 * HEWN_INVALID_ARGUMENT for a bad `desc`; HEWN_LIMIT, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED; the errors of
 * hewn_model_check(). The same for any number of threads. `desc` may be NULL. */
HEWN_API hewn_result hewn_clusters_make(const hewn_model *model, const hewn_clusters_desc *desc, hewn_clusters *out,
                                        hewn_error *error);
HEWN_API void hewn_clusters_destroy(hewn_clusters *clusters);

/* From where clusters are looked at: an eye, the pixels that a length of 1 at a distance of 1 has in the picture
 * (lines / (2 tan(fov / 2))), and the pixels that an error may have. */
typedef struct hewn_cluster_view {
    double eye[3];
    double pixels, tolerance;
} hewn_cluster_view;

/* Whether an error, wherever in its sphere, shows as no more than the tolerance. */
HEWN_API bool hewn_cluster_bound_holds(const hewn_cluster_bound *bound, const hewn_cluster_view *view);

/* Whether a cluster is part of the view's cut. */
HEWN_API bool hewn_cluster_drawn(const hewn_cluster *cluster, const hewn_cluster_view *view);

#ifdef __cplusplus
}
#endif
#endif
