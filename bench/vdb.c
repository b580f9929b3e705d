/* From level sets in .vdb files to meshes: Hewn beside OpenVDB's volumeToMesh, in turn and in one process, each with
 * its own reader. Hewn fills the box of the grid with samples and makes normals, OpenVDB works on the tree and makes
 * none. usage: vdb [--runs N] [FILE ...]; without a file spheres of 128, 256 and 512 voxels. */
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hewn/hewn.h"
#include "vdb_openvdb.h"

#include "base/clock.h"

enum { THREADS = 2, MOST_RUNS = 99 };

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, by_value);
    return values[count / 2];
}

static void stop_on(hewn_result result, const hewn_error *error)
{
    if (result == HEWN_OK)
        return;
    fprintf(stderr, "bench: %s\n", error->message);
    exit(1);
}

static uint64_t run_hewn(const char *path, double *read, double *mesh)
{
    hewn_error error = {0};
    hewn_volume volume;
    hewn_triangles triangles;
    hewn_volume_read_desc how = {.blocks = true};
    hewn_volume_extract_desc desc = {0};
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
    double times[4][MOST_RUNS];
    uint64_t triangles = 0, quads = 0;
    for (int run = 0; run < runs; run++) {
        triangles = run_hewn(path, &times[0][run], &times[1][run]);
        if (!vdb_openvdb_mesh(path, THREADS, &times[2][run], &times[3][run], &quads)) {
            printf("%-16s has no grid of floats\n", name);
            return;
        }
    }
    double of[4];
    for (int what = 0; what < 4; what++)
        of[what] = median(times[what], runs);
    printf("%-16s %9llu triangles, read %.3f, mesh %.3f | %9llu quads, read %.3f, mesh %.3f | together %.2f\n", name,
           (unsigned long long)triangles, of[0], of[1], (unsigned long long)quads, of[2], of[3],
           (of[0] + of[1]) / (of[2] + of[3]));
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
