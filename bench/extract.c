/* From field to mesh in host memory: Hewn beside dense sampling in C and VTK's flying edges, in turn and in one
 * process. usage: extract [--runs N] [--res N] [--json FILE] [SCENE ...], SCENE one of csg, gyroid, menger. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "dense.h"
#include "flying_edges.h"
#include "hewn/hewn.h"
#include "samples.h"

#include "base/clock.h"

#define THREADS 2

typedef struct contest {
    const char *name;
    const char *file;
    const hewn_scene_setting *settings;
    size_t setting_count;
    const dense_field *dense;
} contest;

static const hewn_scene_setting level_four[] = {{"L", 4}};

static const contest contests[] = {
    {"csg", "csg.lua", NULL, 0, &dense_csg},
    {"gyroid", "gyroid.lua", NULL, 0, &dense_gyroid},
    {"menger", "menger.lua", level_four, 1, &dense_menger4},
};

typedef struct outcome {
    double hewn[MOST_RUNS], sampling[MOST_RUNS], flying_edges[MOST_RUNS];
    double dual[MOST_RUNS]; /* Hewn by dual contouring, which peers here do not have */
    double stage[4];
    uint64_t hewn_triangles, peer_triangles;
} outcome;

static void stop_on(hewn_result result, const hewn_error *error)
{
    if (result == HEWN_OK)
        return;
    fprintf(stderr, "bench: %s: %s\n", error->file, error->message);
    exit(1);
}

/* Seconds of an extraction; what `out` says of Hewn is from marching cubes, as flying edges is that too. */
static void run_hewn(hewn_extractor *extractor, const hewn_box *bounds, uint32_t resolution, hewn_method method,
                     double *seconds, outcome *out)
{
    static const char *const stages[4] = {"cull", "evaluate", "extract", "read_back"};
    hewn_error error = {0};
    hewn_extract_desc desc = {.bounds = *bounds, .resolution = resolution, .method = method};
    hewn_triangles triangles;
    hewn_extract_stats stats;
    double begin = hewn_clock_now();
    stop_on(hewn_extract(extractor, &desc, &triangles, &stats, &error), &error);
    *seconds = hewn_clock_now() - begin;
    for (uint32_t i = 0; method == HEWN_METHOD_MARCHING_CUBES && i < stats.stage_count; i++)
        for (int k = 0; k < 4; k++)
            if (strcmp(stats.stages[i].name, stages[k]) == 0)
                out->stage[k] = stats.stages[i].end - stats.stages[i].begin;
    if (method == HEWN_METHOD_MARCHING_CUBES)
        out->hewn_triangles = triangles.triangle_count;
    hewn_triangles_destroy(&triangles);
}

static void run_peers(const dense_field *field, uint32_t resolution, float *values, double *sampling, double *meshing,
                      outcome *out)
{
    size_t samples = (size_t)resolution + 1;
    double begin = hewn_clock_now();
    dense_sample(field, samples, values);
    *sampling = hewn_clock_now() - begin;
    uint64_t vertices;
    double step = (double)(field->hi - field->lo) / resolution;
    *meshing = flying_edges_run(values, samples, (double)field->lo, step, THREADS, &vertices, &out->peer_triangles);
}

static void run_contest(hewn_device *device, const contest *entry, const char *folder, uint32_t resolution, int runs,
                        outcome *out)
{
    char path[4096];
    hewn_error error = {0};
    hewn_scene *scene;
    hewn_extractor *extractor;
    hewn_box bounds;
    snprintf(path, sizeof path, "%s/%s", folder, entry->file);
    hewn_scene_desc desc = {.path = path, .settings = entry->settings, .setting_count = entry->setting_count};
    stop_on(hewn_scene_load(&desc, &scene, &error), &error);
    if (!hewn_scene_bounds(scene, &bounds))
        stop_on(hewn_field_find_box(hewn_scene_field(scene), hewn_field_root(hewn_scene_field(scene)), &bounds, &error),
                &error);
    stop_on(hewn_extractor_create(device, hewn_scene_field(scene), hewn_field_root(hewn_scene_field(scene)), &extractor,
                                  &error),
            &error);
    size_t samples = (size_t)resolution + 1;
    float *values = malloc(samples * samples * samples * sizeof *values);
    if (!values)
        exit(1);
    double unused[2];
    run_hewn(extractor, &bounds, resolution, HEWN_METHOD_MARCHING_CUBES, unused, out);
    run_hewn(extractor, &bounds, resolution, HEWN_METHOD_DC, unused, out);
    run_peers(entry->dense, resolution, values, unused, unused + 1, out);
    for (int i = 0; i < runs; i++) {
        run_hewn(extractor, &bounds, resolution, HEWN_METHOD_MARCHING_CUBES, &out->hewn[i], out);
        run_peers(entry->dense, resolution, values, &out->sampling[i], &out->flying_edges[i], out);
        run_hewn(extractor, &bounds, resolution, HEWN_METHOD_DC, &out->dual[i], out);
    }
    free(values);
    hewn_extractor_destroy(&extractor);
    hewn_scene_destroy(&scene);
}

static double paired_ratio(const outcome *result, int runs)
{
    double ratios[MOST_RUNS];
    for (int i = 0; i < runs; i++)
        ratios[i] = (result->sampling[i] + result->flying_edges[i]) / result->hewn[i];
    return bench_median(ratios, runs);
}

static void print_outcome(FILE *json, const contest *entry, uint32_t resolution, const outcome *result, int runs,
                          bool first)
{
    double ours = bench_median(result->hewn, runs), sampling = bench_median(result->sampling, runs);
    double meshing = bench_median(result->flying_edges, runs), ratio = paired_ratio(result, runs);
    double dual = bench_median(result->dual, runs);
    printf("%-8s %5u  %8.3f  %8.3f + %-7.3f  %5.2fx   dc %8.3f   %9llu %9llu   cull %.3f, evaluate %.3f, extract %.3f, "
           "read back "
           "%.3f\n",
           entry->name, resolution, ours, sampling, meshing, ratio, dual, (unsigned long long)result->hewn_triangles,
           (unsigned long long)result->peer_triangles, result->stage[0], result->stage[1], result->stage[2],
           result->stage[3]);
    if (json)
        fprintf(json,
                "%s\n  {\"scene\": \"%s\", \"resolution\": %u, \"runs\": %d, \"hewn_seconds\": %.4f, "
                "\"hewn_dc_seconds\": %.4f, "
                "\"sampling_seconds\": %.4f, "
                "\"flying_edges_seconds\": %.4f, \"times_faster\": %.3f, \"triangles\": %llu}",
                first ? "" : ",", entry->name, resolution, runs, ours, dual, sampling, meshing, ratio,
                (unsigned long long)result->hewn_triangles);
}

static bool wanted(const contest *entry, int argc, char **argv, int from)
{
    for (int i = from; i < argc; i++)
        if (strcmp(argv[i], entry->name) == 0)
            return true;
    return from >= argc;
}

int main(int argc, char **argv)
{
    const char *folder = getenv("HEWN_SCENES");
    int runs = 5, at = 1;
    uint32_t resolution = 512;
    FILE *json = NULL;
    for (; at + 1 < argc && strncmp(argv[at], "--", 2) == 0; at += 2) {
        if (strcmp(argv[at], "--runs") == 0)
            runs = atoi(argv[at + 1]);
        else if (strcmp(argv[at], "--res") == 0)
            resolution = (uint32_t)atoi(argv[at + 1]);
        else if (strcmp(argv[at], "--json") == 0)
            json = fopen(argv[at + 1], "w");
    }
    runs = runs < 1 ? 1 : runs > MOST_RUNS ? MOST_RUNS : runs;
    hewn_error error = {0};
    hewn_device *device;
    stop_on(hewn_device_create(NULL, &device, &error), &error);
    printf(
        "device %s; dense sampling in C and VTK flying edges (%s) on %d threads; medians of %d runs in turn, seconds\n",
        hewn_device_get_info(device)->name, flying_edges_backend(), THREADS, runs);
    printf("%-8s %5s  %8s  %18s  %6s   %11s   %9s %9s\n", "scene", "cells", "Hewn mc", "sampling + VTK", "ratio",
           "Hewn dc", "triangles", "VTK's");
    if (json)
        fprintf(json, "[");
    bool first = true;
    for (size_t i = 0; i < sizeof contests / sizeof *contests; i++) {
        if (!wanted(&contests[i], argc, argv, at))
            continue;
        outcome result = {0};
        run_contest(device, &contests[i], folder ? folder : "assets/scenes", resolution, runs, &result);
        print_outcome(json, &contests[i], resolution, &result, runs, first);
        first = false;
        fflush(stdout);
    }
    if (json) {
        fprintf(json, "\n]\n");
        fclose(json);
    }
    hewn_device_destroy(&device);
    return 0;
}
