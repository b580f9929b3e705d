/* Meshing of a label volume in memory: all labels in one pass, its mask as one label, and VTK's flying edges for one
 * label after the other, in turn and in one process.
 * usage: labels [--runs N] [--relax N] [FILE]   (without a file: a made-up volume of 256³ with 64 labels) */
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hewn/labels.h"
#include "hewn/volume_io.h"
#include "labels_peers.h"
#include "samples.h"

#include "base/clock.h"

static void fail(const char *message)
{
    fprintf(stderr, "bench: %s\n", message);
    exit(1);
}

/* Voronoi cells of 64 points in a ball. */
static void make_up(uint32_t dims[3], uint16_t **out)
{
    enum { SIDE = 256, POINTS = 64 };
    float points[POINTS][3];
    srand48(3);
    for (int n = 0; n < POINTS; n++)
        for (int axis = 0; axis < 3; axis++)
            points[n][axis] = (float)(SIDE * drand48());
    dims[0] = dims[1] = dims[2] = SIDE;
    *out = calloc((size_t)SIDE * SIDE * SIDE, sizeof **out);
    if (!*out)
        fail("out of memory");
#pragma omp parallel for
    for (int at = 0; at < SIDE * SIDE * SIDE; at++) {
        float p[3] = {(float)(at % SIDE), (float)(at / SIDE % SIDE), (float)(at / SIDE / SIDE)}, best = 1e30f, off = 0;
        for (int axis = 0; axis < 3; axis++)
            off += (p[axis] - SIDE / 2) * (p[axis] - SIDE / 2);
        for (int n = 0; n < POINTS && off < 120 * 120; n++) {
            float d = 0;
            for (int axis = 0; axis < 3; axis++)
                d += (p[axis] - points[n][axis]) * (p[axis] - points[n][axis]);
            if (d < best) {
                best = d;
                (*out)[at] = (uint16_t)(n + 1);
            }
        }
    }
}

static void read(const char *path, uint32_t dims[3], uint16_t **out)
{
    hewn_volume volume;
    hewn_error error;
    if (hewn_volume_read(path, NULL, &volume, &error) != HEWN_OK)
        fail(error.message);
    uint64_t count = hewn_volume_frame_size(&volume);
    *out = malloc(count * sizeof **out);
    if (!*out)
        fail("out of memory");
    for (uint64_t at = 0; at < count; at++)
        (*out)[at] = (uint16_t)hewn_volume_value(&volume, at);
    memcpy(dims, volume.dims, sizeof volume.dims);
    hewn_volume_destroy(&volume);
}

static double mesh(const uint32_t dims[3], const uint16_t *voxels, uint32_t relaxations, hewn_label_mesh *out)
{
    hewn_volume volume = {.frame_count = 1, .type = HEWN_VOXEL_UINT16, .samples = voxels, .slope = 1};
    hewn_label_desc desc = {.relaxations = relaxations};
    hewn_error error;
    memcpy(volume.dims, dims, sizeof volume.dims);
    for (int i = 0; i < 4; i++)
        volume.to_world[5 * i] = 1;
    double begin = hewn_clock_now();
    if (hewn_labels_mesh(&volume, &desc, out, &error) != HEWN_OK)
        fail(error.message);
    return hewn_clock_now() - begin;
}

int main(int argc, char **argv)
{
    static double seconds[3][MOST_RUNS];
    static const char *const names[] = {"all labels in one pass", "the mask as one label",
                                        "flying edges, label by label"};
    int runs = 3, relaxations = 0;
    const char *path = NULL;
    for (int at = 1; at < argc; at++) {
        if (strcmp(argv[at], "--runs") == 0 && at + 1 < argc)
            runs = atoi(argv[++at]);
        else if (strcmp(argv[at], "--relax") == 0 && at + 1 < argc)
            relaxations = atoi(argv[++at]);
        else
            path = argv[at];
    }
    runs = runs < 1 ? 1 : runs > MOST_RUNS ? MOST_RUNS : runs;
    uint32_t dims[3];
    uint16_t *voxels;
    if (path)
        read(path, dims, &voxels);
    else
        make_up(dims, &voxels);
    size_t count = (size_t)dims[0] * dims[1] * dims[2];
    uint16_t *mask = malloc(count * sizeof *mask);
    if (!mask)
        fail("out of memory");
    for (size_t i = 0; i < count; i++)
        mask[i] = voxels[i] != 0;
    const int extent[3] = {(int)dims[0], (int)dims[1], (int)dims[2]};
    uint64_t triangles[3] = {0};
    uint32_t labels = 0;
    for (int run = 0; run < runs; run++) {
        hewn_label_mesh all, one;
        seconds[0][run] = mesh(dims, voxels, (uint32_t)relaxations, &all);
        seconds[1][run] = mesh(dims, mask, (uint32_t)relaxations, &one);
        seconds[2][run] = vtk_labels(voxels, extent, all.labels, all.label_count, omp_get_max_threads(), &triangles[2]);
        triangles[0] = all.triangle_count;
        triangles[1] = one.triangle_count;
        labels = all.label_count;
        hewn_label_mesh_destroy(&all);
        hewn_label_mesh_destroy(&one);
    }
    printf("%u x %u x %u, %u labels, %d relaxations, %d threads, medians of %d\n", dims[0], dims[1], dims[2], labels,
           relaxations, omp_get_max_threads(), runs);
    double base = 0;
    for (int i = 0; i < 3; i++) {
        double middle = bench_median(seconds[i], runs);
        base = i == 0 ? middle : base;
        printf("%-30s %8.4f s  %10llu triangles  %7.2f of the first\n", names[i], middle,
               (unsigned long long)triangles[i], middle / base);
    }
    free(mask);
    free(voxels);
    return 0;
}
