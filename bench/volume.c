/* From volumes to meshes: Hewn beside VTK's flying edges, in turn and in one process; samples in memory to a mesh with
 * normals, and a raw file to an STL file. usage: volume [--runs N] [--res N] [--file 0] [NAME ...], NAME one of ball,
 * waves, noise. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hewn/hewn.h"
#include "samples.h"
#include "volume_vtk.h"

#include "base/clock.h"

#define THREADS 2

typedef double (*shape)(double x, double y, double z); /* in [-1, 1]^3; above 0 inside, below 1 in size */

static double ball(double x, double y, double z)
{
    return (0.8 - sqrt(x * x + y * y + z * z)) / 1.0;
}

static double waves(double x, double y, double z)
{
    double a = 21 * x, b = 21 * y, c = 21 * z;
    return (sin(a) * cos(b) + sin(b) * cos(c) + sin(c) * cos(a)) / 3;
}

/* A ball with the grain of a scanner, about a tenth of its contrast. */
static double grain(double x, double y, double z)
{
    uint64_t seed = (uint64_t)((x + 2) * 1e6) * 73856093u ^ (uint64_t)((y + 2) * 1e6) * 19349663u ^
                    (uint64_t)((z + 2) * 1e6) * 83492791u;
    seed = (seed ^ seed >> 31) * 0x9e3779b97f4a7c15u;
    double noise = (double)(seed >> 11) * 0x1p-53 - 0.5;
    return 0.5 * tanh(40 * ball(x, y, z)) + 0.2 * noise;
}

static const struct {
    const char *name;
    shape value;
} subjects[] = {{"ball", ball}, {"waves", waves}, {"noise", grain}};

typedef struct contest {
    int side, runs;
    bool files;
    hewn_volume volume;
    void *samples;
} contest;

static void stop_on(hewn_result result, const hewn_error *error)
{
    if (result == HEWN_OK)
        return;
    fprintf(stderr, "bench: %s: %s\n", error->file, error->message);
    exit(1);
}

static void fill(contest *entry, shape value, bool shorts)
{
    int side = entry->side;
    float *floats = entry->samples;
    int16_t *integers = entry->samples;
#pragma omp parallel for num_threads(THREADS)
    for (int k = 0; k < side; k++)
        for (int j = 0; j < side; j++)
            for (int i = 0; i < side; i++) {
                double scale = 2.0 / (side - 1);
                double f = value(scale * i - 1, scale * j - 1, scale * k - 1);
                size_t at = (size_t)i + (size_t)side * ((size_t)j + (size_t)side * (size_t)k);
                if (shorts)
                    integers[at] = (int16_t)lrint(8000 * f);
                else
                    floats[at] = (float)f;
            }
    entry->volume = (hewn_volume){.dims = {(uint32_t)side, (uint32_t)side, (uint32_t)side},
                                  .frame_count = 1,
                                  .type = shorts ? HEWN_VOXEL_INT16 : HEWN_VOXEL_FLOAT,
                                  .samples = entry->samples,
                                  .slope = 1};
    for (int i = 0; i < 16; i++)
        entry->volume.to_world[i] = i % 5 == 0;
}

static double run_hewn(const contest *entry, uint64_t *triangles)
{
    hewn_triangles mesh;
    hewn_error error = {0};
    hewn_volume_extract_desc desc = {.iso = 0.1};
    double begin = hewn_clock_now();
    stop_on(hewn_volume_extract(&entry->volume, &desc, &mesh, NULL, &error), &error);
    double seconds = hewn_clock_now() - begin;
    *triangles = mesh.triangle_count;
    hewn_triangles_destroy(&mesh);
    return seconds;
}

static void run_in_memory(const contest *entry, const char *name, bool shorts)
{
    double hewn[MOST_RUNS], vtk[MOST_RUNS], ratios[MOST_RUNS];
    uint64_t triangles, peer_triangles;
    (void)run_hewn(entry, &triangles);
    for (int i = 0; i < entry->runs; i++) {
        vtk[i] = volume_vtk_extract(entry->samples, entry->side, shorts, 0.1, THREADS, &peer_triangles);
        hewn[i] = run_hewn(entry, &triangles);
        ratios[i] = hewn[i] / vtk[i];
    }
    printf("%-6s %-6s %5d  memory %8.3f %8.3f %6.2f of VTK's time   %9llu %9llu triangles\n", name,
           shorts ? "int16" : "float", entry->side, bench_median(hewn, entry->runs), bench_median(vtk, entry->runs),
           bench_median(ratios, entry->runs), (unsigned long long)triangles, (unsigned long long)peer_triangles);
}

/* With a certificate, as `hewn convert` makes it, and without. */
static double convert(const contest *entry, const char *raw, const char *stl, bool certify)
{
    hewn_volume volume;
    hewn_triangles mesh;
    hewn_certificate certificate;
    hewn_error error = {0};
    hewn_volume_read_desc read = {.format = HEWN_VOLUME_RAW, .raw = {.type = entry->volume.type}};
    hewn_volume_extract_desc desc = {.iso = 0.1, .no_normals = true};
    hewn_write_desc write = {.format = HEWN_MESH_STL};
    memcpy(read.raw.dims, entry->volume.dims, sizeof read.raw.dims);
    double begin = hewn_clock_now();
    stop_on(hewn_volume_read(raw, &read, &volume, &error), &error);
    stop_on(hewn_volume_extract(&volume, &desc, &mesh, NULL, &error), &error);
    if (certify)
        stop_on(hewn_certify(&mesh, NULL, &certificate, &error), &error);
    stop_on(hewn_triangles_write(&mesh, stl, &write, &error), &error);
    double seconds = hewn_clock_now() - begin;
    hewn_triangles_destroy(&mesh);
    hewn_volume_destroy(&volume);
    return seconds;
}

static void run_files(const contest *entry, const char *name, bool shorts)
{
    const char *folder = getenv("TMPDIR");
    char raw[4096], stl[4096];
    double hewn[MOST_RUNS], certified[MOST_RUNS], vtk[MOST_RUNS], ratios[MOST_RUNS], certified_ratios[MOST_RUNS];
    snprintf(raw, sizeof raw, "%s/bench_volume.raw", folder ? folder : "/tmp");
    snprintf(stl, sizeof stl, "%s/bench_volume.stl", folder ? folder : "/tmp");
    FILE *file = fopen(raw, "wb");
    size_t count = (size_t)entry->side * (size_t)entry->side * (size_t)entry->side;
    if (!file || fwrite(entry->samples, shorts ? 2 : 4, count, file) != count || fclose(file) != 0)
        exit(1);
    for (int i = 0; i < entry->runs; i++) { /* nobody waits for what the one before left to be written */
        sync();
        vtk[i] = volume_vtk_convert(raw, entry->side, shorts, 0.1, THREADS, stl);
        sync();
        hewn[i] = convert(entry, raw, stl, false);
        sync();
        certified[i] = convert(entry, raw, stl, true);
        ratios[i] = vtk[i] / hewn[i];
        certified_ratios[i] = vtk[i] / certified[i];
    }
    remove(raw);
    remove(stl);
    printf("%-6s %-6s %5d  files  %8.3f %8.3f %6.2f times as fast as VTK; with certificate %.3f, %.2f times\n", name,
           shorts ? "int16" : "float", entry->side, bench_median(hewn, entry->runs), bench_median(vtk, entry->runs),
           bench_median(ratios, entry->runs), bench_median(certified, entry->runs),
           bench_median(certified_ratios, entry->runs));
}

static bool wanted(const char *name, int argc, char **argv, int from)
{
    for (int i = from; i < argc; i++)
        if (strcmp(argv[i], name) == 0)
            return true;
    return from >= argc;
}

int main(int argc, char **argv)
{
    contest entry = {.side = 512, .runs = 5, .files = true};
    int at = 1;
    for (; at + 1 < argc && strncmp(argv[at], "--", 2) == 0; at += 2) {
        if (strcmp(argv[at], "--runs") == 0)
            entry.runs = atoi(argv[at + 1]);
        else if (strcmp(argv[at], "--res") == 0)
            entry.side = atoi(argv[at + 1]);
        else if (strcmp(argv[at], "--file") == 0)
            entry.files = atoi(argv[at + 1]) != 0;
    }
    entry.runs = entry.runs < 1 ? 1 : entry.runs > MOST_RUNS ? MOST_RUNS : entry.runs;
    omp_set_num_threads(THREADS);
    entry.samples = malloc(4 * (size_t)entry.side * (size_t)entry.side * (size_t)entry.side);
    if (!entry.samples)
        return 1;
    printf("mc33 of Hewn and flying edges of VTK on %d threads; medians of %d runs in turn, seconds\n", THREADS,
           entry.runs);
    printf("%-6s %-6s %5s  %-6s %8s %8s\n", "volume", "type", "side", "from", "Hewn", "VTK");
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++)
        for (int shorts = 0; shorts < 2 && wanted(subjects[i].name, argc, argv, at); shorts++) {
            fill(&entry, subjects[i].value, shorts);
            run_in_memory(&entry, subjects[i].name, shorts);
            if (entry.files)
                run_files(&entry, subjects[i].name, shorts);
        }
    free(entry.samples);
    return 0;
}
