/* Polygons of clusters as triangles. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "iso/cluster_passes.h"

#define NONE HEWN_CLUSTER_NONE

/* Edges and diagonals so far, by their ends: an open hash table. */
typedef struct edges {
    uint64_t *slots; /* low << 32 | high, plus 1; 0 where free */
    uint64_t mask;
} edges;

static bool add_edge(edges *table, uint32_t a, uint32_t b)
{
    uint64_t key = ((uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a)) + 1;
    uint64_t slot = (key * UINT64_C(0x9E3779B97F4A7C15)) >> 20 & table->mask;
    for (; table->slots[slot]; slot = (slot + 1) & table->mask)
        if (table->slots[slot] == key)
            return false;
    table->slots[slot] = key;
    return true;
}

typedef struct triangulation {
    const hewn_clusters *clusters;
    edges edges;
    uint32_t *names; /* a cluster: its vertex */
    uint64_t polygons, room;
    hewn_triangles *out;
} triangulation;

static void count_polygons(triangulation *run)
{
    for (uint32_t quad = 0; quad < run->clusters->quad_count; quad++) {
        uint32_t ring[4], count = hewn_clusters_ring(run->clusters, quad, ring);
        run->polygons += count >= 3;
        run->room += count == 4; /* a quad may need a vertex of its own */
        for (uint32_t k = 0; k < count && count >= 3; k++)
            run->names[ring[k]] = 0;
    }
    for (uint32_t i = 0; i < run->clusters->vertex_count; i++)
        run->room += run->names[i] == 0;
}

static hewn_result take_room(triangulation *run, hewn_error *error)
{
    uint64_t slots = 16;
    while (slots < 6 * run->polygons)
        slots *= 2;
    run->edges = (edges){.slots = hewn_alloc_zero(slots, sizeof *run->edges.slots), .mask = slots - 1};
    run->out->positions = hewn_alloc(3 * run->room, sizeof(float));
    run->out->normals = hewn_alloc(3 * run->room, sizeof(float));
    run->out->indices = hewn_alloc(12 * run->polygons, sizeof(uint32_t));
    if (!run->edges.slots || !run->out->positions || !run->out->normals || !run->out->indices)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu polygons",
                         (unsigned long long)run->polygons);
    return HEWN_OK;
}

/* A vertex merged with no other stays as it was. */
static void put_vertex(triangulation *run, uint32_t cluster)
{
    const hewn_clusters *clusters = run->clusters;
    size_t to = 3 * (size_t)run->out->vertex_count, from = 3 * (size_t)clusters->order[cluster];
    const float *normal = clusters->normal[cluster];
    double length = sqrt((double)normal[0] * (double)normal[0] + (double)normal[1] * (double)normal[1] +
                         (double)normal[2] * (double)normal[2]);
    bool kept = clusters->next_member[cluster] == cluster;
    for (size_t axis = 0; axis < 3; axis++) {
        run->out->positions[to + axis] = (float)clusters->position[cluster][axis];
        run->out->normals[to + axis] =
            kept || !(length > 1e-6) ? clusters->surface->normals[from + axis] : (float)((double)normal[axis] / length);
    }
    run->names[cluster] = (uint32_t)run->out->vertex_count++;
}

static void put_triangle(triangulation *run, uint32_t a, uint32_t b, uint32_t c)
{
    memcpy(&run->out->indices[3 * run->out->triangle_count++], (uint32_t[3]){a, b, c}, 3 * sizeof(uint32_t));
}

static void put_centre(triangulation *run, uint32_t quad, const uint32_t ring[4], hewn_adaptive_stats *stats)
{
    uint32_t centre = (uint32_t)run->out->vertex_count++;
    memcpy(&run->out->positions[3 * (size_t)centre], &run->clusters->surface->points[3 * (size_t)quad],
           3 * sizeof(float));
    memcpy(&run->out->normals[3 * (size_t)centre], &run->clusters->surface->gradients[3 * (size_t)quad],
           3 * sizeof(float));
    for (int k = 0; k < 4; k++)
        put_triangle(run, run->names[ring[k]], run->names[ring[(k + 1) % 4]], centre);
    stats->centres++;
}

static void put_polygon(triangulation *run, uint32_t quad, hewn_adaptive_stats *stats)
{
    const hewn_clusters *clusters = run->clusters;
    uint32_t ring[4], count = hewn_clusters_ring(clusters, quad, ring), cut = 0;
    const double *at[4];
    const hewn_quadric *quadric[4];
    bool given = count == 4;
    if (count < 3)
        return;
    for (uint32_t k = 0; k < count; k++) {
        at[k] = clusters->position[ring[k]];
        quadric[k] = &clusters->quadric[ring[k]];
        given &= clusters->next_member[ring[k]] == ring[k];
    }
    if (count == 4 && !given)
        cut = hewn_clusters_diagonal(clusters, quad, at, quadric);
    if (count == 4 && !add_edge(&run->edges, ring[cut], ring[cut + 2])) {
        cut = 1 - cut;
        if (!add_edge(&run->edges, ring[cut], ring[cut + 2])) {
            put_centre(run, quad, ring, stats);
            return;
        }
    }
    for (uint32_t i = 0; i < count - 2; i++)
        put_triangle(run, run->names[ring[cut]], run->names[ring[cut + 1 + i]],
                     run->names[ring[(cut + 2 + i) % count]]);
}

static hewn_result triangulate(triangulation *run, hewn_adaptive_stats *stats, hewn_error *error)
{
    const hewn_clusters *clusters = run->clusters;
    memset(run->names, 0xFF, clusters->vertex_count * sizeof *run->names);
    count_polygons(run);
    HEWN_TRY(take_room(run, error));
    for (uint32_t quad = 0; quad < clusters->quad_count; quad++) {
        uint32_t ring[4], count = hewn_clusters_ring(clusters, quad, ring);
        for (uint32_t k = 0; k < count && count >= 3; k++)
            (void)add_edge(&run->edges, ring[k], ring[(k + 1) % count]);
    }
    for (uint32_t i = 0; i < clusters->vertex_count; i++)
        if (run->names[i] != NONE)
            put_vertex(run, i);
    for (uint32_t quad = 0; quad < clusters->quad_count; quad++)
        put_polygon(run, quad, stats);
    return HEWN_OK;
}

hewn_result hewn_clusters_triangulate(const hewn_clusters *clusters, hewn_triangles *out, hewn_adaptive_stats *stats,
                                      hewn_error *error)
{
    triangulation run = {.clusters = clusters, .out = out};
    *out = (hewn_triangles){0};
    run.names = hewn_alloc(clusters->vertex_count, sizeof *run.names);
    if (!run.names)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u vertices", clusters->vertex_count);
    hewn_result result = triangulate(&run, stats, error);
    hewn_free(run.names);
    hewn_free(run.edges.slots);
    if (result != HEWN_OK)
        hewn_triangles_destroy(out);
    return result;
}
