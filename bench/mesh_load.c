/* From a file to a half-edge mesh: Hewn beside OpenMesh, CGAL's Surface_mesh and assimp (which makes no half-edges), in
 * turn and in one process. usage: mesh_load [--runs N] [--triangles N] [FILE...]
 *
 * Without files a torus is written in each format that all can read, into a folder of its own, which goes again at the
 * end. The files are in the page cache. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hewn/hewn.h"
#include "load_peers.h"
#include "samples.h"
#include "torus.h"

#include "base/clock.h"

static peer_loaded hewn_load(const char *path)
{
    hewn_model model;
    hewn_mesh *mesh = NULL;
    hewn_error error;
    hewn_result result = hewn_model_read(path, NULL, &model, &error);
    if (result == HEWN_OK) {
        result = hewn_mesh_from_model(&model, NULL, &mesh, NULL, &error);
        hewn_model_destroy(&model);
    }
    if (result != HEWN_OK) {
        fprintf(stderr, "bench: %s: %s\n", path, error.message);
        return (peer_loaded){0};
    }
    return (peer_loaded){mesh, hewn_mesh_vert_count(mesh), hewn_mesh_face_count(mesh)};
}

static void hewn_release(void *mesh)
{
    hewn_mesh *own = mesh;
    hewn_mesh_destroy(&own);
}

typedef struct contender {
    const char *name;
    peer_loaded (*load)(const char *path);
    void (*release)(void *mesh);
} contender;

static const contender contenders[] = {
    {"hewn", hewn_load, hewn_release},
    {"openmesh", openmesh_load, openmesh_release},
    {"cgal", surface_mesh_load, surface_mesh_release},
    {"assimp", assimp_load, assimp_release},
};
enum { CONTENDERS = sizeof contenders / sizeof *contenders };

typedef struct outcome {
    double seconds[MOST_RUNS];
    peer_loaded loaded; /* its mesh is gone */
    bool refused;
} outcome;

static void run_once(const contender *entry, const char *path, int run, outcome *out)
{
    double begin = hewn_clock_now();
    out->loaded = entry->load(path);
    out->seconds[run] = hewn_clock_now() - begin;
    out->refused = out->loaded.faces == 0;
    if (out->loaded.mesh)
        entry->release(out->loaded.mesh);
}

static void measure(const char *path, int runs)
{
    static outcome outcomes[CONTENDERS];
    struct stat status;
    const char *slash = strrchr(path, '/');
    double mebibytes = stat(path, &status) == 0 ? (double)status.st_size / 0x1p20 : 0;
    for (int run = 0; run < runs; run++)
        for (int c = 0; c < CONTENDERS; c++)
            run_once(&contenders[c], path, run, &outcomes[c]);
    double ours = bench_median(outcomes[0].seconds, runs);
    printf("%s, %.1f MiB, medians of %d runs in turn\n%-10s %9s %9s %9s %10s %10s\n", slash ? slash + 1 : path,
           mebibytes, runs, "", "seconds", "MiB/s", "to Hewn's", "vertices", "faces");
    for (int c = 0; c < CONTENDERS; c++) {
        double seconds = bench_median(outcomes[c].seconds, runs);
        if (outcomes[c].refused)
            printf("%-10s made no mesh of it\n", contenders[c].name);
        else
            printf("%-10s %9.3f %9.0f %8.2fx %10llu %10llu\n", contenders[c].name, seconds, mebibytes / seconds,
                   seconds / ours, outcomes[c].loaded.vertices, outcomes[c].loaded.faces);
    }
}

static void measure_torus(uint64_t triangles, int runs)
{
    static const char *const formats[] = {"ply", "obj", "off", "stl"};
    char folder[] = "/tmp/hewn-bench-XXXXXX", path[64];
    hewn_error error;
    if (!mkdtemp(folder)) {
        perror("bench");
        exit(1);
    }
    peer_input torus = bench_torus(triangles);
    const hewn_model model = {.vertex_count = torus.vertex_count,
                              .positions = (double *)torus.positions,
                              .face_count = torus.triangle_count,
                              .corners = (uint32_t *)torus.indices};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        snprintf(path, sizeof path, "%s/torus.%s", folder, formats[i]);
        if (hewn_model_write(&model, path, NULL, &error) == HEWN_OK)
            measure(path, runs);
        else
            fprintf(stderr, "bench: %s\n", error.message);
        unlink(path);
    }
    rmdir(folder);
    free((void *)torus.positions);
    free((void *)torus.indices);
}

int main(int argc, char **argv)
{
    int runs = 3, at = 1;
    uint64_t triangles = 1000000;
    for (; at + 1 < argc && argv[at][0] == '-'; at += 2) {
        if (strcmp(argv[at], "--runs") == 0)
            runs = atoi(argv[at + 1]);
        else if (strcmp(argv[at], "--triangles") == 0)
            triangles = strtoull(argv[at + 1], NULL, 10);
    }
    runs = runs < 1 ? 1 : runs > MOST_RUNS ? MOST_RUNS : runs;
    if (at >= argc)
        measure_torus(triangles < 18 ? 18 : triangles, runs);
    for (; at < argc; at++)
        measure(argv[at], runs);
    return 0;
}
