/* Merging neighbours pair by pair, those first that cost least. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/progress.h"
#include "iso/cluster_passes.h"

enum { MOST_ROUNDS = 64 };

typedef struct pair {
    float cost;
    uint32_t a, b; /* a < b */
} pair;

typedef struct pairing {
    hewn_clusters *clusters;
    hewn_merge merge;
    pair *pairs;
    size_t count, capacity;
    uint32_t *touched; /* a cluster: the last round in which it or a neighbour changed */
    uint32_t round;
    uint64_t verdicts[HEWN_MERGE_VERDICTS];
} pairing;

/* Mean error as a share of the tolerance; and of pairs as good, the nearest first, so that patches grow evenly. */
static double cost_of(pairing *run, uint32_t a, uint32_t b)
{
    hewn_clusters *clusters = run->clusters;
    hewn_merge *merge = &run->merge;
    merge->quadric = clusters->quadric[a];
    hewn_quadric_add(&merge->quadric, &clusters->quadric[b]);
    merge->bounds = clusters->bounds[a] | clusters->bounds[b];
    double apart = 0;
    for (int axis = 0; axis < 3; axis++) {
        const uint16_t *p = clusters->box[a], *q = clusters->box[b];
        double step = clusters->position[a][axis] - clusters->position[b][axis];
        apart += step * step;
        merge->box[2 * axis] = p[2 * axis] < q[2 * axis] ? p[2 * axis] : q[2 * axis];
        merge->box[2 * axis + 1] = p[2 * axis + 1] > q[2 * axis + 1] ? p[2 * axis + 1] : q[2 * axis + 1];
    }
    double error = hewn_merge_place(clusters, merge) / clusters->tolerance;
    return error <= 1 ? error * error + 1e-3 * sqrt(apart) / (double)clusters->surface->grid.cell : INFINITY;
}

static int compare(const void *a, const void *b)
{
    const pair *p = a, *q = b;
    if (p->cost != q->cost)
        return p->cost < q->cost ? -1 : 1;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return p->b < q->b ? -1 : p->b > q->b;
}

/* Neighbours of which one changed since they were last looked at. */
static hewn_result list_pairs(pairing *run, hewn_error *error)
{
    const hewn_clusters *clusters = run->clusters;
    run->count = 0;
    for (uint32_t a = 0; a < clusters->vertex_count; a++) {
        if (clusters->cluster[a] != a)
            continue;
        for (uint32_t use = clusters->first_use[a]; use != HEWN_CLUSTER_NONE; use = clusters->next_use[use]) {
            uint32_t ring[4], length = hewn_clusters_ring(clusters, use / 4, ring);
            for (uint32_t k = 0; k < length && length >= 3; k++) {
                uint32_t b = ring[(k + 1) % length];
                if (ring[k] != a || b >= clusters->vertex_count)
                    continue;
                uint32_t low = a < b ? a : b, high = a < b ? b : a;
                /* An edge is seen from both sides, but on a boundary from one; twice does no harm. */
                if (run->touched[a] + 1 < run->round && run->touched[b] + 1 < run->round)
                    continue;
                double cost = cost_of(run, low, high);
                if (!(cost < INFINITY))
                    continue;
                HEWN_TRY(hewn_reserve((void **)&run->pairs, &run->capacity, run->count + 1, sizeof *run->pairs, error));
                run->pairs[run->count++] = (pair){(float)cost, low, high};
            }
        }
    }
    if (run->count)
        qsort(run->pairs, run->count, sizeof *run->pairs, compare);
    return HEWN_OK;
}

static void touch_around(pairing *run, uint32_t cluster)
{
    const hewn_clusters *clusters = run->clusters;
    run->touched[cluster] = run->round;
    for (uint32_t use = clusters->first_use[cluster]; use != HEWN_CLUSTER_NONE; use = clusters->next_use[use]) {
        uint32_t ring[4], length = hewn_clusters_ring(clusters, use / 4, ring);
        for (uint32_t k = 0; k < length; k++)
            if (ring[k] < clusters->vertex_count)
                run->touched[ring[k]] = run->round;
    }
}

static hewn_result merge_round(pairing *run, uint64_t *merged, hewn_error *error)
{
    hewn_clusters *clusters = run->clusters;
    HEWN_TRY(list_pairs(run, error));
    *merged = 0;
    for (size_t i = 0; i < run->count; i++) {
        uint32_t set[2] = {run->pairs[i].a, run->pairs[i].b};
        if (i > 0 && run->pairs[i - 1].a == set[0] && run->pairs[i - 1].b == set[1])
            continue;
        /* What changed in this round is for the next: its cost is another one. */
        if (run->touched[set[0]] == run->round || run->touched[set[1]] == run->round)
            continue;
        hewn_merge_verdict verdict = hewn_clusters_merge(clusters, &run->merge, set, 2, NULL);
        run->verdicts[verdict]++;
        if (verdict == HEWN_MERGE_MEMORY)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory merging pairs of clusters");
        if (verdict == HEWN_MERGE_DONE) {
            touch_around(run, set[0]);
            ++*merged;
        }
    }
    return HEWN_OK;
}

/* Where the best place of a vertex was refused when its cluster was made, it may be free now that others have moved. */
static hewn_result settle(pairing *run, hewn_error *error)
{
    hewn_clusters *clusters = run->clusters;
    for (uint32_t a = 0; a < clusters->vertex_count; a++) {
        if (clusters->cluster[a] != a || clusters->next_member[a] == a)
            continue;
        run->merge.quadric = clusters->quadric[a];
        run->merge.bounds = clusters->bounds[a];
        memcpy(run->merge.box, clusters->box[a], sizeof run->merge.box);
        double here = hewn_quadric_distance(&clusters->quadric[a], clusters->position[a]);
        if (here <= 1.01 * hewn_merge_place(clusters, &run->merge) + 0.001 * clusters->tolerance)
            continue;
        if (hewn_clusters_merge(clusters, &run->merge, &a, 1, NULL) == HEWN_MERGE_MEMORY)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory moving a vertex");
    }
    return HEWN_OK;
}

static hewn_result merge_rounds(pairing *run, const hewn_progress *progress, hewn_error *error)
{
    uint64_t merged = 1;
    for (run->round = 2; merged && run->round < MOST_ROUNDS; run->round++) {
        HEWN_TRY(merge_round(run, &merged, error));
        HEWN_TRY(hewn_progress_report(progress, "collapse", 0.6 + 0.3 * (1 - 2.0 / run->round), error));
    }
    return settle(run, error);
}

hewn_result hewn_clusters_merge_pairs(hewn_clusters *clusters, const hewn_progress *progress,
                                      hewn_adaptive_stats *stats, hewn_error *error)
{
    pairing run = {.clusters = clusters, .merge.slack = 1};
    run.touched = hewn_alloc(clusters->vertex_count, sizeof *run.touched);
    if (!run.touched)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u vertices", clusters->vertex_count);
    for (uint32_t i = 0; i < clusters->vertex_count; i++)
        run.touched[i] = 1;
    hewn_result result = merge_rounds(&run, progress, error);
    stats->pair_merges = run.verdicts[HEWN_MERGE_DONE];
    for (int k = 0; k < 4; k++)
        stats->refused[k] += run.verdicts[HEWN_MERGE_TOPOLOGY + k];
    hewn_merge_free(&run.merge);
    hewn_free(run.touched);
    hewn_free(run.pairs);
    return result;
}
