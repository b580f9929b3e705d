/* A dual surface whose vertices are gathered in clusters, each of which will be one vertex.
 *
 * The vertices of a uniform dual surface stand for patches, its quads for the points where four patches meet. A cluster
 * is a connected set of patches. Each quad becomes the polygon of the different clusters among its four vertices: a
 * quad or a triangle; with fewer than three it is gone. What is kept true, merge by merge:
 *
 * - every cluster is a disc, and no quad sees it twice (its patch is not pinched);
 * - two clusters meet along one curve at most, so that no edge is there twice;
 * - every cluster has at least three neighbours, and is at one boundary at most.
 *
 * Then the polygons are a closed 2-manifold of the same topology. It is the condition of Schaefer, Ju and Warren 2007
 * ('Manifold dual contouring'), but asked of the polygons themselves instead of the faces of octree cells, hence exact
 * and not only sufficient; for two clusters it is the link condition of edge collapses. Along a boundary there is one
 * more, imagined vertex for each loop of it, joined to the loop by polygons that are never put out: so a boundary stays
 * one, and stays simple. */
#ifndef HEWN_SRC_ISO_CLUSTER_H
#define HEWN_SRC_ISO_CLUSTER_H

#include "geom/bvh.h"
#include "iso/dual.h"
#include "iso/quadric.h"

#define HEWN_CLUSTER_NONE 0xFFFFFFFFu

/* The most clusters that one merge takes. */
enum { HEWN_CLUSTER_MOST = 64 };

/* Vertices are numbered along a Morton curve through their cells, so that those of an octree node follow each other; a
 * cluster has the number of its first vertex. Lengths are scene units. */
typedef struct hewn_clusters {
    const hewn_dual_surface *surface;
    double tolerance;      /* how far the surface may move */
    uint32_t vertex_count; /* without the imagined ones, which have the numbers that follow */
    uint32_t ghost_count;
    uint32_t quad_count; /* likewise */
    uint32_t imagined_count;
    uint64_t *keys;         /* a vertex: Morton code of its cell */
    uint32_t *order;        /* a vertex: which of the surface's it is */
    uint32_t *corners;      /* 4 a quad */
    uint32_t *cluster;      /* a vertex: the cluster it is in */
    uint32_t *next_member;  /* a vertex: another of its cluster, in a ring */
    uint32_t *mark;         /* a cluster: 1 while it is in the set that is to be merged, else 0 */
    uint32_t *valence;      /* a cluster: its neighbours, of which it has as many as polygons */
    uint32_t *first_use;    /* a cluster: a corner (4 * quad + k) that lies in it */
    uint32_t *next_use;     /* a corner: another in the same cluster; may name quads that are gone */
    uint32_t *first_hosted; /* a quad: points that lie nearest to it; those of the surface's quads, then its vertices */
    uint32_t *next_hosted;  /* a point */
    double (*position)[3];  /* a cluster */
    float (*normal)[3];     /* a cluster: the sum of its vertices' normals */
    hewn_quadric *quadric;  /* a cluster: the planes of each vertex's quads, added up */
    uint16_t (*box)[6];     /* a cluster: the cells that it may lie in, first and last of each axis */
    uint8_t *bounds;        /* a cluster: bit 2 * axis + side where it must stay on that side of an open grid */
    uint32_t *triangles;    /* of the uniform surface, as indices into its positions */
    hewn_bvh bvh;           /* of these */
} hewn_clusters;

/* Gives every vertex a cluster of its own. The surface must outlive them. HEWN_LIMIT, HEWN_OUT_OF_MEMORY,
 * HEWN_INVALID_ARGUMENT where it is not a manifold along its boundary. */
hewn_result hewn_clusters_create(const hewn_dual_surface *surface, double tolerance, hewn_clusters *out,
                                 hewn_error *error);
void hewn_clusters_free(hewn_clusters *clusters);

/* The clusters around a quad in order, each once; fewer than three where it is gone. */
uint32_t hewn_clusters_ring(const hewn_clusters *clusters, uint32_t quad, uint32_t ring[4]);

/* Where a sample of the grid lies along an axis. */
double hewn_dual_coordinate(const hewn_dual_surface *surface, int axis, uint32_t sample);

/* --- merging -------------------------------------------------------------------------------------------------------
 */

typedef enum hewn_merge_verdict {
    HEWN_MERGE_DONE,
    HEWN_MERGE_TOPOLOGY, /* would not be a manifold, or another one */
    HEWN_MERGE_QUADRIC,  /* no point is near enough to all planes */
    HEWN_MERGE_FOLD,     /* a polygon would turn against the surface */
    HEWN_MERGE_FAR,      /* points of the surface would be too far from the polygons, or polygons from the surface */
    HEWN_MERGE_MEMORY,
    HEWN_MERGE_VERDICTS
} hewn_merge_verdict;

typedef struct hewn_merge_triangle {
    double at[3][3];
    double lo[3], hi[3]; /* its box, grown by the tolerance */
    uint32_t quad;
} hewn_merge_triangle;

/* A merge in the making: one a thread, to be used again. Zero to begin with. */
typedef struct hewn_merge {
    const uint32_t *set; /* the clusters, the least first */
    uint32_t count;
    bool out_of_memory;
    uint32_t *quads; /* polygons of the set, imagined ones too, each once; those that remain first */
    size_t quad_count, remaining_count, quad_capacity;
    uint32_t *losers; /* neighbours, as often as they lose a polygon */
    size_t loser_count, loser_capacity;
    uint32_t *followers; /* what follows the set in the ring of each polygon that remains */
    size_t follower_capacity;
    hewn_merge_triangle *triangles; /* around the new vertex */
    size_t triangle_count, triangle_capacity;
    uint32_t *points, *hosts; /* the points of the polygons, and which polygons they go to */
    size_t point_count, point_capacity, host_capacity;
    hewn_quadric quadric;
    double position[3];
    uint16_t box[6];
    uint16_t
        slack; /* how many cells the vertex may leave the box by: a corner can lie in a cell that has no edge crossed */
    uint8_t bounds;
} hewn_merge;

void hewn_merge_free(hewn_merge *merge);

/* Makes one cluster of a connected set of them, if it remains a manifold within the tolerance. `box`, where it is not
 * NULL, is where the vertex may lie in place of the box around the set's. Merges may run side by side where no polygon
 * of a neighbour of the one set is at the other, or at a neighbour of it. */
hewn_merge_verdict hewn_clusters_merge(hewn_clusters *clusters, hewn_merge *merge, const uint32_t *set, uint32_t count,
                                       const uint16_t *box);

/* The parts of it. Whether the set may be merged as far as the topology goes; collects its polygons. */
bool hewn_merge_keeps_topology(hewn_clusters *clusters, hewn_merge *merge);

/* Where the vertex goes and what becomes of its polygons. */
hewn_merge_verdict hewn_merge_fit(const hewn_clusters *clusters, hewn_merge *merge);

/* Where the quadric of the set is least in the box; the distance to its planes there. */
double hewn_merge_place(const hewn_clusters *clusters, hewn_merge *merge);

/* 0 where a polygon of four is to be cut along its first and third corner, else 1. `at` and `quadric` are those of the
 * ring's clusters. */
uint32_t hewn_clusters_diagonal(const hewn_clusters *clusters, uint32_t quad, const double *const at[4],
                                const hewn_quadric *const quadric[4]);

/* The cosine of the angle between a triangle and the surface at the crossing of its quad; -1 where it has no area. */
double hewn_clusters_facing(const hewn_clusters *clusters, uint32_t quad, const double a[3], const double b[3],
                            const double c[3]);

#endif
