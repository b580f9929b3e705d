/* From level sets in .vdb files to meshes: Hewn beside OpenVDB's volumeToMesh, in turn and in one process, each with
 * its own reader. Both work on the tree; Hewn makes normals, OpenVDB makes none. usage: vdb [--runs N] [FILE ...];
 * without a file spheres of 128, 256 and 512 voxels. */
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hewn/hewn.h"
#include "samples.h"
#include "vdb_openvdb.h"

#include "base/clock.h"

enum { THREADS = 2 };

static void stop_on(hewn_result result, const hewn_error *error)
{
    if (result == HEWN_OK)
        return;
    fprintf(stderr, "bench: %s\n", error->message);
    exit(1);
}

static uint64_t run_hewn(const char *path, bool normals, double *read, double *mesh)
{
    hewn_error error = {0};
    hewn_volume volume;
    hewn_triangles triangles;
    hewn_volume_read_desc how = {.blocks = true};
    hewn_volume_extract_desc desc = {.no_normals = !normals};
    double begin = hewn_clock_now();
    stop_on(hewn_volume_read(path, &how, &volume, &error), &error);
    double middle = hewn_clock_now();
    stop_on(hewn_volume_extract(&volume, &desc, &triangles, NULL, &error), &error);
    *read = middle - begin;
    *mesh = hewn_clock_now() - middle;
    uint64_t count = triangles.triangle_count;
    hewn_triangles_destroy(&triangles);
    hewn_volume_destroy(&volume);
    return count;
}

static void compare(const char *path, const char *name, int runs)
{
    enum { READ, MESH, BARE, ALL, THEIR_READ, THEIR_MESH, THEIR_ALL, TIMES };
    double times[TIMES][MOST_RUNS], of[TIMES], unused;
    uint64_t triangles = 0, quads = 0;
    for (int run = 0; run < runs; run++) {
        double begin = bench_processor_now();
        triangles = run_hewn(path, true, &times[READ][run], &times[MESH][run]);
        times[ALL][run] = bench_processor_now() - begin;
        (void)run_hewn(path, false, &unused, &times[BARE][run]);
        begin = bench_processor_now();
        if (!vdb_openvdb_mesh(path, THREADS, &times[THEIR_READ][run], &times[THEIR_MESH][run], &quads)) {
            printf("%-16s has no grid of floats\n", name);
            return;
        }
        times[THEIR_ALL][run] = bench_processor_now() - begin;
    }
    for (int what = 0; what < TIMES; what++)
        of[what] = bench_median(times[what], runs);
    printf(
        "%-16s %9llu triangles, read %.3f, mesh %.3f (%.3f without normals), processor %.3f | %9llu quads, read %.3f, "
        "mesh %.3f, processor %.3f | mesh %.2f (%.2f), together %.2f, processor %.2f\n",
        name, (unsigned long long)triangles, of[READ], of[MESH], of[BARE], of[ALL], (unsigned long long)quads,
        of[THEIR_READ], of[THEIR_MESH], of[THEIR_ALL], of[MESH] / of[THEIR_MESH], of[BARE] / of[THEIR_MESH],
        (of[READ] + of[MESH]) / (of[THEIR_READ] + of[THEIR_MESH]), of[ALL] / of[THEIR_ALL]);
    fflush(stdout);
}

int main(int count, char **arguments)
{
    int runs = 5, at = 1;
    if (count > 2 && strcmp(arguments[1], "--runs") == 0) {
        runs = atoi(arguments[2]);
        runs = runs < 1 ? 1 : runs > MOST_RUNS ? MOST_RUNS : runs;
        at = 3;
    }
    omp_set_num_threads(THREADS);
    printf("%-16s Hewn | OpenVDB | time of Hewn by that of OpenVDB; seconds, medians of %d, %d threads\n", "", runs,
           THREADS);
    for (int n = at; n < count; n++) {
        const char *slash = strrchr(arguments[n], '/');
        compare(arguments[n], slash ? slash + 1 : arguments[n], runs);
    }
    for (int voxels = 128; at == count && voxels <= 512; voxels *= 2) {
        char path[64], name[32];
        snprintf(path, sizeof path, "/tmp/hewn-bench-%d-%d.vdb", (int)getpid(), voxels);
        snprintf(name, sizeof name, "sphere, %d", voxels);
        vdb_openvdb_write_sphere(path, voxels);
        compare(path, name, runs);
        unlink(path);
    }
    return 0;
}
