/* Making one cluster of several. */
#include <string.h>

#include "base/alloc.h"
#include "iso/cluster.h"

void hewn_merge_free(hewn_merge *merge)
{
    void *blocks[] = {merge->quads, merge->losers, merge->followers, merge->triangles, merge->points, merge->hosts};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        hewn_free(blocks[i]);
    *merge = (hewn_merge){0};
}

/* What the set has together. False where it would have to lie on two bounds that face each other. */
static bool add_up(const hewn_clusters *clusters, hewn_merge *merge, const uint16_t *box)
{
    merge->quadric = (hewn_quadric){0};
    merge->bounds = 0;
    merge->slack = box ? 0 : 1;
    memcpy(merge->box, box ? box : clusters->box[merge->set[0]], sizeof merge->box);
    for (uint32_t i = 0; i < merge->count; i++) {
        uint32_t cluster = merge->set[i];
        hewn_quadric_add(&merge->quadric, &clusters->quadric[cluster]);
        merge->bounds |= clusters->bounds[cluster];
        for (int axis = 0; axis < 3 && !box; axis++) {
            uint16_t low = clusters->box[cluster][2 * axis], high = clusters->box[cluster][2 * axis + 1];
            if (low < merge->box[2 * axis])
                merge->box[2 * axis] = low;
            if (high > merge->box[2 * axis + 1])
                merge->box[2 * axis + 1] = high;
        }
    }
    for (int axis = 0; axis < 3; axis++)
        if ((merge->bounds >> 2 * axis & 3) == 3)
            return false;
    return true;
}

static void relabel(hewn_clusters *clusters, uint32_t cluster, uint32_t into)
{
    for (uint32_t at = cluster;;) {
        clusters->cluster[at] = into;
        at = clusters->next_member[at];
        if (at == cluster)
            break;
    }
    uint32_t next = clusters->next_member[into]; /* two rings become one */
    clusters->next_member[into] = clusters->next_member[cluster];
    clusters->next_member[cluster] = next;
}

/* The list of the new cluster: a corner of each polygon that remains. */
static void relist(hewn_clusters *clusters, const hewn_merge *merge, uint32_t into)
{
    clusters->first_use[into] = HEWN_CLUSTER_NONE;
    for (size_t i = merge->remaining_count; i-- > 0;) {
        uint32_t corner = 4 * merge->quads[i];
        while (clusters->cluster[clusters->corners[corner]] != into)
            corner++;
        clusters->next_use[corner] = clusters->first_use[into];
        clusters->first_use[into] = corner;
    }
    clusters->valence[into] = (uint32_t)merge->remaining_count;
}

static void commit(hewn_clusters *clusters, const hewn_merge *merge)
{
    uint32_t into = merge->set[0];
    for (uint32_t i = 1; i < merge->count; i++) {
        uint32_t cluster = merge->set[i];
        relabel(clusters, cluster, into);
        for (int axis = 0; axis < 3; axis++)
            clusters->normal[into][axis] += clusters->normal[cluster][axis];
    }
    relist(clusters, merge, into);
    for (size_t i = 0; i < merge->loser_count; i++) {
#pragma omp atomic
        clusters->valence[merge->losers[i]]--;
    }
    for (size_t i = 0; i < merge->quad_count; i++)
        if (merge->quads[i] < clusters->quad_count)
            clusters->first_hosted[merge->quads[i]] = HEWN_CLUSTER_NONE;
    for (size_t i = 0; i < merge->point_count; i++) {
        clusters->next_hosted[merge->points[i]] = clusters->first_hosted[merge->hosts[i]];
        clusters->first_hosted[merge->hosts[i]] = merge->points[i];
    }
    memcpy(clusters->position[into], merge->position, sizeof merge->position);
    memcpy(clusters->box[into], merge->box, sizeof merge->box);
    clusters->quadric[into] = merge->quadric;
    clusters->bounds[into] = merge->bounds;
}

hewn_merge_verdict hewn_clusters_merge(hewn_clusters *clusters, hewn_merge *merge, const uint32_t *set, uint32_t count,
                                       const uint16_t *box)
{
    merge->set = set;
    merge->count = count;
    for (uint32_t i = 0; i < count; i++)
        clusters->mark[set[i]] = 1;
    hewn_merge_verdict verdict = HEWN_MERGE_TOPOLOGY;
    if (add_up(clusters, merge, box) && hewn_merge_keeps_topology(clusters, merge))
        verdict = hewn_merge_fit(clusters, merge);
    if (merge->out_of_memory)
        verdict = HEWN_MERGE_MEMORY;
    if (verdict == HEWN_MERGE_DONE)
        commit(clusters, merge);
    for (uint32_t i = 0; i < count; i++)
        clusters->mark[set[i]] = 0;
    return verdict;
}
