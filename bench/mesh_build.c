/* From indexed triangles in memory to a half-edge mesh: Hewn beside OpenMesh and CGAL's Surface_mesh, in turn and in
 * one process. usage: mesh_build [--runs N] [--triangles N] [--order grid|shuffled] [--only hewn|openmesh|cgal] [--json
 * FILE]
 *
 * The mesh is a torus, so it is closed and all valences are 6; `shuffled` numbers vertices and triangles at random, the
 * worst order for caches. Seconds of CPU are those of all threads, and tell more than the clock where the machine is
 * busy. Memory is what the heap holds more while the mesh stands. Peak memory (with --only) is that of the process,
 * input included. */
#include <malloc.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "hewn/mesh.h"
#include "mesh_peers.h"
#include "samples.h"
#include "torus.h"

#include "base/clock.h"

static void *hewn_build(const peer_input *input)
{
    const hewn_polygons polygons = {input->vertex_count, input->positions, input->triangle_count, NULL, input->indices};
    hewn_mesh *mesh;
    hewn_error error;
    if (hewn_mesh_from_polygons(&polygons, &mesh, &error) != HEWN_OK)
        fprintf(stderr, "bench: %s\n", error.message);
    return mesh;
}

static void hewn_release(void *mesh)
{
    hewn_mesh *own = mesh;
    hewn_mesh_destroy(&own);
}

typedef struct contender {
    const char *name;
    void *(*build)(const peer_input *input);
    void (*release)(void *mesh);
    double seconds[MOST_RUNS], cpu_seconds[MOST_RUNS];
    size_t bytes;
} contender;

static contender contenders[] = {
    {"hewn", hewn_build, hewn_release, {0}, {0}, 0},
    {"openmesh", openmesh_build, openmesh_free, {0}, {0}, 0},
    {"cgal", surface_mesh_build, surface_mesh_free, {0}, {0}, 0},
};
enum { CONTENDERS = sizeof contenders / sizeof *contenders };

/* --- input -------------------------------------------------------------------------------------------------------- */

static uint64_t random_bits(uint64_t *at)
{
    uint64_t z = *at += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static uint32_t *shuffled(uint64_t count, uint64_t seed)
{
    uint32_t *order = malloc(count * sizeof *order);
    for (uint64_t i = 0; order && i < count; i++) {
        uint64_t j = random_bits(&seed) % (i + 1);
        order[i] = (uint32_t)i;
        order[i] = order[j];
        order[j] = (uint32_t)i;
    }
    return order;
}

static void shuffle(double *positions, uint32_t *indices, uint64_t verts, uint64_t triangles)
{
    uint32_t *vert_order = shuffled(verts, 1), *triangle_order = shuffled(triangles, 2);
    double *old_positions = malloc(verts * 3 * sizeof *positions);
    uint32_t *old_indices = malloc(triangles * 3 * sizeof *indices);
    if (!vert_order || !triangle_order || !old_positions || !old_indices)
        exit(1);
    memcpy(old_positions, positions, verts * 3 * sizeof *positions);
    memcpy(old_indices, indices, triangles * 3 * sizeof *indices);
    for (uint64_t v = 0; v < verts; v++)
        memcpy(positions + 3 * (size_t)vert_order[v], old_positions + 3 * v, 3 * sizeof *positions);
    for (uint64_t t = 0; t < triangles; t++)
        for (uint64_t i = 0; i < 3; i++)
            indices[3 * (size_t)triangle_order[t] + i] = vert_order[old_indices[3 * t + i]];
    free(vert_order);
    free(triangle_order);
    free(old_positions);
    free(old_indices);
}

static peer_input make_torus(uint64_t triangles, bool in_order)
{
    peer_input torus = bench_torus(triangles);
    if (!in_order)
        shuffle((double *)torus.positions, (uint32_t *)torus.indices, torus.vertex_count, torus.triangle_count);
    return torus;
}

/* --- measuring ---------------------------------------------------------------------------------------------------- */

static size_t heap_bytes(void)
{
    struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

static void run_once(contender *entry, const peer_input *input, int run)
{
    size_t before = heap_bytes();
    double begin = hewn_clock_now();
    double cpu_begin = bench_processor_now();
    void *mesh = entry->build(input);
    entry->seconds[run] = hewn_clock_now() - begin;
    entry->cpu_seconds[run] = bench_processor_now() - cpu_begin;
    entry->bytes = heap_bytes() - before;
    if (!mesh) {
        fprintf(stderr, "bench: %s refused the mesh\n", entry->name);
        exit(1);
    }
    entry->release(mesh);
}

static void report(const peer_input *input, const char *order, const char *only, int runs, FILE *json)
{
    double ours = bench_median(contenders[0].seconds, runs);
    printf("%llu triangles in %s order, %d threads, medians of %d runs in turn\n%-10s %9s %9s %10s %9s\n",
           (unsigned long long)input->triangle_count, order, omp_get_max_threads(), runs, "", "seconds", "of CPU",
           "MiB held", "to Hewn's");
    for (int c = 0; c < CONTENDERS; c++) {
        if (only && strcmp(only, contenders[c].name) != 0)
            continue;
        double seconds = bench_median(contenders[c].seconds, runs), cpu = bench_median(contenders[c].cpu_seconds, runs);
        printf("%-10s %9.3f %9.3f %10.1f %8.2fx\n", contenders[c].name, seconds, cpu,
               (double)contenders[c].bytes / 0x1p20, only ? 1 : seconds / ours);
        if (json)
            fprintf(json,
                    "%s\n  {\"mesh\": \"%s\", \"order\": \"%s\", \"triangles\": %llu, \"runs\": %d, \"seconds\": %.4f, "
                    "\"cpu_seconds\": %.4f, "
                    "\"bytes\": %zu}",
                    c == 0 || only ? "" : ",", contenders[c].name, order, (unsigned long long)input->triangle_count,
                    runs, seconds, cpu, contenders[c].bytes);
    }
    struct rusage usage;
    if (only && getrusage(RUSAGE_SELF, &usage) == 0)
        printf("peak of the process %.1f MiB\n", (double)usage.ru_maxrss / 1024);
}

int main(int argc, char **argv)
{
    int runs = 5;
    uint64_t triangles = 10000000;
    const char *only = NULL, *order = "grid";
    FILE *json = NULL;
    for (int at = 1; at + 1 < argc; at += 2) {
        if (strcmp(argv[at], "--runs") == 0)
            runs = atoi(argv[at + 1]);
        else if (strcmp(argv[at], "--triangles") == 0)
            triangles = strtoull(argv[at + 1], NULL, 10);
        else if (strcmp(argv[at], "--order") == 0)
            order = argv[at + 1];
        else if (strcmp(argv[at], "--only") == 0)
            only = argv[at + 1];
        else if (strcmp(argv[at], "--json") == 0)
            json = fopen(argv[at + 1], "w");
    }
    runs = runs < 1 ? 1 : runs > MOST_RUNS ? MOST_RUNS : runs;
    peer_input input = make_torus(triangles < 18 ? 18 : triangles, strcmp(order, "shuffled") != 0);
    for (int run = 0; run < runs; run++)
        for (int c = 0; c < CONTENDERS; c++)
            if (!only || strcmp(only, contenders[c].name) == 0)
                run_once(&contenders[c], &input, run);
    if (json)
        fprintf(json, "[");
    report(&input, order, only, runs, json);
    if (json) {
        fprintf(json, "\n]\n");
        fclose(json);
    }
    return 0;
}
