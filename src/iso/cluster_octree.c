/* Merging level by level in the nodes of an octree. */
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/order.h"
#include "base/progress.h"
#include "iso/cluster_passes.h"

enum { COLOURS = 27, MOST_LEVELS = 21, WORTH_A_TEAM = 48 };

/* The clusters of a node: a stretch of the list of all. */
typedef struct node {
    uint32_t begin, end;
} node;

/* A thread's own. */
typedef struct worker {
    hewn_merge merge;
    uint64_t *members; /* root << 32 | cluster, of the node at hand */
    size_t capacity;
    uint64_t verdicts[HEWN_MERGE_VERDICTS];
} worker;

typedef struct octree {
    hewn_clusters *clusters;
    uint32_t *clusters_left; /* in order */
    uint32_t count;
    uint32_t *parent; /* a cluster: towards the root of those that it is connected with */
    node *nodes;      /* of the level, those of a colour together */
    uint8_t *colours;
    uint32_t colour_ends[COLOURS + 1];
    unsigned level;
    worker *workers;
    int worker_count;
} octree;

/* --- nodes ---------------------------------------------------------------------------------------------------------
 */

static uint8_t colour_of(const octree *tree, uint32_t cluster)
{
    const hewn_clusters *clusters = tree->clusters;
    const uint32_t *cell = &clusters->surface->cells[3 * (size_t)clusters->order[cluster]];
    return (uint8_t)((cell[0] >> tree->level) % 3 + 3 * ((cell[1] >> tree->level) % 3) +
                     9 * ((cell[2] >> tree->level) % 3));
}

/* Lists the nodes of the level with more than one cluster, by colour. */
static void list_nodes(octree *tree)
{
    const hewn_clusters *clusters = tree->clusters;
    node *found = tree->nodes + tree->count; /* the second half, before they are sorted */
    uint32_t count = 0;
    memset(tree->colour_ends, 0, sizeof tree->colour_ends);
    for (uint32_t begin = 0, end; begin < tree->count; begin = end) {
        uint64_t code = clusters->keys[tree->clusters_left[begin]] >> 3 * tree->level;
        for (end = begin + 1; end < tree->count; end++)
            if (clusters->keys[tree->clusters_left[end]] >> 3 * tree->level != code)
                break;
        if (end - begin < 2)
            continue;
        tree->colours[count] = colour_of(tree, tree->clusters_left[begin]);
        tree->colour_ends[tree->colours[count] + 1]++;
        found[count++] = (node){begin, end};
    }
    for (int colour = 0; colour < COLOURS; colour++)
        tree->colour_ends[colour + 1] += tree->colour_ends[colour];
    for (uint32_t i = 0; i < count; i++) /* each end moves from where its colour begins to where it ends */
        tree->nodes[tree->colour_ends[tree->colours[i]]++] = found[i];
}

static uint32_t root_of(uint32_t *parent, uint32_t cluster)
{
    while (parent[cluster] != cluster)
        cluster = parent[cluster] = parent[parent[cluster]];
    return cluster;
}

/* The clusters of a node, those that are connected within it together. */
static bool find_connected(octree *tree, worker *own, node here)
{
    const hewn_clusters *clusters = tree->clusters;
    size_t count = here.end - here.begin;
    if (hewn_reserve((void **)&own->members, &own->capacity, count, sizeof *own->members, NULL) != HEWN_OK)
        return false;
    const uint32_t *list = &tree->clusters_left[here.begin];
    uint64_t code = clusters->keys[list[0]] >> 3 * tree->level;
    for (size_t i = 0; i < count; i++)
        tree->parent[list[i]] = list[i];
    for (size_t i = 0; i < count; i++)
        for (uint32_t use = clusters->first_use[list[i]]; use != HEWN_CLUSTER_NONE; use = clusters->next_use[use]) {
            uint32_t ring[4], length = hewn_clusters_ring(clusters, use / 4, ring);
            for (uint32_t k = 0; k < length; k++) {
                uint32_t from = ring[k], to = ring[(k + 1) % length];
                if (from != list[i] || to >= clusters->vertex_count || clusters->keys[to] >> 3 * tree->level != code)
                    continue;
                from = root_of(tree->parent, from);
                to = root_of(tree->parent, to);
                tree->parent[from < to ? to : from] = from < to ? from : to;
            }
        }
    for (size_t i = 0; i < count; i++)
        own->members[i] = (uint64_t)root_of(tree->parent, list[i]) << 32 | list[i];
    qsort(own->members, count, sizeof *own->members, hewn_order_uint64);
    return true;
}

/* The cells of a node, without those beyond the grid. */
static void box_of(const octree *tree, uint32_t cluster, uint16_t box[6])
{
    const hewn_dual_surface *surface = tree->clusters->surface;
    for (int axis = 0; axis < 3; axis++) {
        uint32_t low = surface->cells[3 * (size_t)tree->clusters->order[cluster] + axis] >> tree->level << tree->level;
        uint32_t high = low + (1u << tree->level) - 1, last = surface->grid.cells[axis] - 1;
        box[2 * axis] = (uint16_t)low;
        box[2 * axis + 1] = (uint16_t)(high < last ? high : last);
    }
}

static bool merge_node(octree *tree, worker *own, node here)
{
    if (!find_connected(tree, own, here))
        return false;
    uint16_t box[6];
    box_of(tree, tree->clusters_left[here.begin], box);
    size_t count = here.end - here.begin;
    for (size_t begin = 0, end; begin < count; begin = end) {
        uint32_t set[HEWN_CLUSTER_MOST], members = 0;
        for (end = begin; end < count && own->members[end] >> 32 == own->members[begin] >> 32; end++)
            if (members < HEWN_CLUSTER_MOST)
                set[members++] = (uint32_t)own->members[end];
        if (members < 2 || end - begin > HEWN_CLUSTER_MOST)
            continue;
        hewn_merge_verdict verdict = hewn_clusters_merge(tree->clusters, &own->merge, set, members, box);
        own->verdicts[verdict]++;
        if (verdict == HEWN_MERGE_MEMORY)
            return false;
    }
    return true;
}

/* --- levels --------------------------------------------------------------------------------------------------------
 */

static int team_for(const octree *tree, uint32_t nodes)
{
    return nodes >= WORTH_A_TEAM ? tree->worker_count : 1;
}

static hewn_result merge_level(octree *tree, hewn_error *error)
{
    uint32_t failures = 0, begin = 0;
    list_nodes(tree);
    for (int colour = 0; colour < COLOURS; colour++) {
        uint32_t end = tree->colour_ends[colour];
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : failures) num_threads(team_for(tree, end - begin))
        for (uint32_t i = begin; i < end; i++)
            failures += !merge_node(tree, &tree->workers[omp_get_thread_num()], tree->nodes[i]);
        begin = end;
    }
    if (failures)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory merging %u clusters", tree->count);
    uint32_t left = 0;
    for (uint32_t i = 0; i < tree->count; i++)
        if (tree->clusters->cluster[tree->clusters_left[i]] == tree->clusters_left[i])
            tree->clusters_left[left++] = tree->clusters_left[i];
    tree->count = left;
    return HEWN_OK;
}

static hewn_result prepare(octree *tree, hewn_error *error)
{
    uint32_t count = tree->clusters->vertex_count;
    tree->worker_count = omp_get_max_threads();
    tree->clusters_left = hewn_alloc(count, sizeof *tree->clusters_left);
    tree->parent = hewn_alloc(count, sizeof *tree->parent);
    tree->nodes = hewn_alloc(2 * (size_t)count, sizeof *tree->nodes);
    tree->colours = hewn_alloc(count, sizeof *tree->colours);
    tree->workers = hewn_alloc_zero((size_t)tree->worker_count, sizeof *tree->workers);
    if (!tree->clusters_left || !tree->parent || !tree->nodes || !tree->colours || !tree->workers)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an octree over %u vertices", count);
    for (uint32_t i = 0; i < count; i++)
        if (tree->clusters->first_use[i] != HEWN_CLUSTER_NONE)
            tree->clusters_left[tree->count++] = i;
    return HEWN_OK;
}

static uint64_t merges_so_far(const octree *tree)
{
    uint64_t sum = 0;
    for (int i = 0; i < tree->worker_count; i++)
        sum += tree->workers[i].verdicts[HEWN_MERGE_DONE];
    return sum;
}

/* Upward until two levels in a row have nothing to merge. */
static hewn_result merge_levels(octree *tree, const hewn_progress *progress, hewn_adaptive_stats *stats,
                                hewn_error *error)
{
    const uint32_t *cells = tree->clusters->surface->grid.cells;
    uint32_t most = cells[0] > cells[1] ? cells[0] : cells[1], idle = 0;
    most = cells[2] > most ? cells[2] : most;
    for (tree->level = 1; tree->level < MOST_LEVELS && idle < 2 && (most - 1) >> (tree->level - 1); tree->level++) {
        uint64_t before = merges_so_far(tree);
        HEWN_TRY(hewn_progress_report(progress, "collapse", 0.1 + 0.5 * (1 - 1.0 / tree->level), error));
        HEWN_TRY(merge_level(tree, error));
        idle = merges_so_far(tree) == before ? idle + 1 : 0;
        stats->levels = idle ? stats->levels : tree->level;
    }
    stats->octree_merges = merges_so_far(tree);
    stats->octree_vertices = tree->count;
    for (int i = 0; i < tree->worker_count; i++)
        for (int k = 0; k < 4; k++)
            stats->refused[k] += tree->workers[i].verdicts[HEWN_MERGE_TOPOLOGY + k];
    return HEWN_OK;
}

hewn_result hewn_clusters_merge_octree(hewn_clusters *clusters, const hewn_progress *progress,
                                       hewn_adaptive_stats *stats, hewn_error *error)
{
    octree tree = {.clusters = clusters};
    hewn_result result = prepare(&tree, error);
    if (result == HEWN_OK)
        result = merge_levels(&tree, progress, stats, error);
    for (int i = 0; i < tree.worker_count && tree.workers; i++) {
        hewn_merge_free(&tree.workers[i].merge);
        hewn_free(tree.workers[i].members);
    }
    hewn_free(tree.workers);
    hewn_free(tree.clusters_left);
    hewn_free(tree.parent);
    hewn_free(tree.nodes);
    hewn_free(tree.colours);
    return result;
}
