/* Whether a set of clusters can become one without a trace in the topology; see cluster.h for what is asked. */
#include <stdlib.h>

#include "base/alloc.h"
#include "iso/cluster.h"

static bool in_set(const hewn_clusters *clusters, uint32_t cluster)
{
    return cluster < clusters->vertex_count && clusters->mark[cluster] == 1;
}

static bool reserve(hewn_merge *merge, void *items, size_t *capacity, size_t needed, size_t size)
{
    if (needed <= *capacity)
        return true;
    merge->out_of_memory = hewn_reserve(items, capacity, needed, size, NULL) != HEWN_OK;
    return !merge->out_of_memory;
}

/* The first corner of a quad that lies in a cluster, or in any of the set where `cluster` is none. */
static uint32_t first_corner(const hewn_clusters *clusters, uint32_t quad, uint32_t cluster)
{
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t here = clusters->cluster[clusters->corners[4 * (size_t)quad + k]];
        if (cluster == HEWN_CLUSTER_NONE ? in_set(clusters, here) : here == cluster)
            return 4 * quad + k;
    }
    return HEWN_CLUSTER_NONE;
}

/* The polygons of one cluster; drops from its list those that are gone, or there twice. A polygon of several of the set
 * is taken at the first of its corners. */
static bool collect(hewn_clusters *clusters, hewn_merge *merge, uint32_t cluster)
{
    uint32_t *link = &clusters->first_use[cluster];
    while (*link != HEWN_CLUSTER_NONE) {
        uint32_t corner = *link, quad = corner / 4, ring[4];
        if (hewn_clusters_ring(clusters, quad, ring) < 3 || first_corner(clusters, quad, cluster) != corner) {
            *link = clusters->next_use[corner];
            continue;
        }
        link = &clusters->next_use[corner];
        if (first_corner(clusters, quad, HEWN_CLUSTER_NONE) != corner)
            continue;
        if (!reserve(merge, &merge->quads, &merge->quad_capacity, merge->quad_count + 1, sizeof *merge->quads))
            return false;
        merge->quads[merge->quad_count++] = quad;
    }
    return true;
}

/* Counts for the Euler number of the set, doubled edges. */
typedef struct census {
    uint32_t sides, faces;
} census;

/* What becomes of one polygon; false where it would be pinched. */
static bool look_at(hewn_clusters *clusters, hewn_merge *merge, size_t place, census *counts)
{
    uint32_t ring[4], quad = merge->quads[place], count = hewn_clusters_ring(clusters, quad, ring);
    uint32_t within = 0, arcs = 0, follower = 0, outside = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool here = in_set(clusters, ring[i]), next = in_set(clusters, ring[(i + 1) % count]);
        within += here;
        counts->sides += here && next;
        if (here && !next) {
            arcs++;
            follower = ring[(i + 1) % count];
        }
        outside = here ? outside : ring[i];
    }
    if (arcs > 1)
        return false;
    if (within == count) {
        counts->faces++;
    } else if (count - within == 1) {
        if (!reserve(merge, &merge->losers, &merge->loser_capacity, merge->loser_count + 1, sizeof *merge->losers))
            return false;
        merge->losers[merge->loser_count++] = outside;
    } else { /* it remains */
        size_t at = merge->remaining_count++;
        if (!reserve(merge, &merge->followers, &merge->follower_capacity, merge->remaining_count,
                     sizeof *merge->followers))
            return false;
        merge->followers[at] = follower;
        merge->quads[place] = merge->quads[at];
        merge->quads[at] = quad;
    }
    return true;
}

static int compare(const void *a, const void *b)
{
    uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
    return p < q ? -1 : p > q;
}

/* No neighbour twice, one boundary at most, and each neighbour keeps three of its own. */
static bool neighbours_agree(const hewn_clusters *clusters, hewn_merge *merge)
{
    if (merge->remaining_count < 3)
        return false;
    qsort(merge->followers, merge->remaining_count, sizeof *merge->followers, compare);
    for (size_t i = 1; i < merge->remaining_count; i++)
        if (merge->followers[i] == merge->followers[i - 1])
            return false;
    if (merge->followers[merge->remaining_count - 2] >= clusters->vertex_count)
        return false; /* two imagined vertices: it would join two boundaries in a point */
    if (merge->loser_count)
        qsort(merge->losers, merge->loser_count, sizeof *merge->losers, compare);
    for (size_t i = 0, run = 0; i < merge->loser_count; i++) {
        run = i > 0 && merge->losers[i] == merge->losers[i - 1] ? run + 1 : 1;
        uint32_t valence;
#pragma omp atomic read
        valence = clusters->valence[merge->losers[i]];
        if (valence < 3 + run)
            return false;
    }
    return true;
}

bool hewn_merge_keeps_topology(hewn_clusters *clusters, hewn_merge *merge)
{
    census counts = {0};
    merge->quad_count = merge->remaining_count = merge->loser_count = 0;
    for (uint32_t i = 0; i < merge->count; i++)
        if (!collect(clusters, merge, merge->set[i]))
            return false;
    for (size_t i = 0; i < merge->quad_count; i++)
        if (!look_at(clusters, merge, i, &counts))
            return false;
    /* A disc: as many clusters and polygons within as edges, and one. Each edge within is a side of two polygons. */
    if (merge->count + counts.faces != counts.sides / 2 + 1)
        return false;
    return neighbours_agree(clusters, merge);
}
