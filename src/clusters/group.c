/* Which clusters are simplified together: those with the most edges in common. */
#include <stdlib.h>

#include "base/alloc.h"
#include "clusters/work.h"

/* An edge of an active cluster's outline or inside; then a pair of clusters that have one in common. */
typedef struct edge {
    uint32_t lo, hi, cluster;
} edge;

typedef struct pair {
    uint32_t a, b, weight;
} pair;

typedef struct graph {
    uint32_t *first; /* of each active cluster, in `to` */
    pair *to;        /* a: itself, b: the other */
    size_t count;
} graph;

static int compare_edges(const void *a, const void *b)
{
    const edge *one = a, *two = b;
    if (one->lo != two->lo)
        return one->lo < two->lo ? -1 : 1;
    if (one->hi != two->hi)
        return one->hi < two->hi ? -1 : 1;
    return (one->cluster > two->cluster) - (one->cluster < two->cluster);
}

static int compare_pairs(const void *a, const void *b)
{
    const pair *one = a, *two = b;
    if (one->a != two->a)
        return one->a < two->a ? -1 : 1;
    return (one->b > two->b) - (one->b < two->b);
}

static size_t count_triangles(const clusters_work *work)
{
    size_t count = 0;
    for (size_t i = 0; i < work->active_count; i++)
        count += work->out->clusters[work->active[i]].triangle_count;
    return count;
}

static size_t list_edges(const clusters_work *work, edge *out)
{
    size_t count = 0;
    for (uint32_t i = 0; i < work->active_count; i++) {
        const hewn_cluster *cluster = &work->out->clusters[work->active[i]];
        for (uint32_t t = 0; t < cluster->triangle_count; t++)
            for (uint32_t k = 0; k < 3; k++) {
                const uint32_t a = work->whole.wedge_vertices[clusters_wedge(work->out, cluster, t, k)];
                const uint32_t b = work->whole.wedge_vertices[clusters_wedge(work->out, cluster, t, (k + 1) % 3)];
                out[count++] = (edge){a < b ? a : b, a < b ? b : a, i};
            }
    }
    qsort(out, count, sizeof *out, compare_edges);
    return count;
}

/* Both directions of each pair of neighbours, one for each edge. */
static size_t list_pairs(const edge *edges, size_t count, pair *out)
{
    size_t made = 0;
    for (size_t i = 1; i < count; i++)
        if (edges[i].lo == edges[i - 1].lo && edges[i].hi == edges[i - 1].hi &&
            edges[i].cluster != edges[i - 1].cluster) {
            out[made++] = (pair){edges[i].cluster, edges[i - 1].cluster, 1};
            out[made++] = (pair){edges[i - 1].cluster, edges[i].cluster, 1};
        }
    qsort(out, made, sizeof *out, compare_pairs);
    size_t kept = 0;
    for (size_t i = 0; i < made; i++) {
        if (kept > 0 && out[kept - 1].a == out[i].a && out[kept - 1].b == out[i].b)
            out[kept - 1].weight++;
        else
            out[kept++] = out[i];
    }
    return kept;
}

static hewn_result make_graph(const clusters_work *work, graph *out, hewn_error *error)
{
    const size_t most = 3 * count_triangles(work);
    edge *edges = hewn_alloc(most, sizeof *edges);
    out->to = hewn_alloc(2 * most, sizeof *out->to);
    out->first = hewn_alloc_zero(work->active_count + 1, sizeof *out->first);
    const bool there = edges && out->to && out->first;
    if (there)
        out->count = list_pairs(edges, list_edges(work, edges), out->to);
    hewn_free(edges);
    if (!there)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for clusters");
    for (size_t i = 0; i < out->count; i++)
        out->first[out->to[i].a + 1]++;
    for (size_t i = 0; i < work->active_count; i++)
        out->first[i + 1] += out->first[i];
    return HEWN_OK;
}

/* The ungrouped cluster with the most edges to a group, by sums in `weights`; HEWN_NONE where it has no neighbour. */
static uint32_t choose(const graph *of, const uint32_t *members, uint32_t count, const uint32_t *groups,
                       uint32_t *weights)
{
    uint32_t best = HEWN_NONE;
    for (uint32_t m = 0; m < count; m++)
        for (uint32_t i = of->first[members[m]]; i < of->first[members[m] + 1]; i++)
            if (groups[of->to[i].b] == HEWN_NONE)
                weights[of->to[i].b] += of->to[i].weight;
    for (uint32_t m = 0; m < count; m++)
        for (uint32_t i = of->first[members[m]]; i < of->first[members[m] + 1]; i++) {
            const uint32_t other = of->to[i].b;
            if (groups[other] == HEWN_NONE && (best == HEWN_NONE || weights[other] > weights[best] ||
                                               (weights[other] == weights[best] && other < best)))
                best = other;
        }
    for (uint32_t m = 0; m < count; m++)
        for (uint32_t i = of->first[members[m]]; i < of->first[members[m] + 1]; i++)
            weights[of->to[i].b] = 0;
    return best;
}

/* A cluster that is left alone goes to the neighbour's group that it has the most edges with. */
static void join_single(const graph *of, uint32_t cluster, uint32_t *groups)
{
    uint32_t most = 0;
    for (uint32_t i = of->first[cluster]; i < of->first[cluster + 1]; i++)
        if (of->to[i].weight > most) {
            most = of->to[i].weight;
            groups[cluster] = groups[of->to[i].b];
        }
}

static void grow_groups(const clusters_work *work, const graph *of, uint32_t *groups, uint32_t *weights,
                        uint32_t *count)
{
    uint32_t members[32];
    for (uint32_t i = 0; i < work->active_count; i++)
        groups[i] = HEWN_NONE;
    *count = 0;
    for (uint32_t seed = 0; seed < work->active_count; seed++) {
        if (groups[seed] != HEWN_NONE)
            continue;
        uint32_t size = 0;
        for (uint32_t next = seed; next != HEWN_NONE && size < work->desc.group;) {
            members[size++] = next;
            groups[next] = *count;
            next = choose(of, members, size, groups, weights);
        }
        if (size == 1 && of->first[seed] < of->first[seed + 1])
            join_single(of, seed, groups);
        else
            ++*count;
    }
}

hewn_result hewn_clusters_group(const clusters_work *work, uint32_t **groups, uint32_t *count, hewn_error *error)
{
    graph of = {0};
    *groups = hewn_alloc(work->active_count, sizeof **groups);
    uint32_t *weights = hewn_alloc_zero(work->active_count, sizeof *weights);
    hewn_result result = *groups && weights ? make_graph(work, &of, error)
                                            : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for clusters");
    if (result == HEWN_OK)
        grow_groups(work, &of, *groups, weights, count);
    hewn_free(of.first);
    hewn_free(of.to);
    hewn_free(weights);
    if (result != HEWN_OK) {
        hewn_free(*groups);
        *groups = NULL;
    }
    return result;
}
