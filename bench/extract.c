/* From field to mesh in host memory: Hewn beside dense sampling in C and VTK's flying edges, in turn and in one
 * process; and how its time grows. C samples rows, of which it computes once what their samples share, or points.
 * usage: extract [--runs N] [--res N] [--peers 0] [--dual 0] [--as listed|straight]
 * [--json FILE] [SCENE ...], SCENE one of csg, gyroid, menger, random, random25, random50, random100, random10000,
 * csg256, csg1024, csg2048; FILE is bench/results/extract.json where it is not given. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dense.h"
#include "flying_edges.h"
#include "heap.h"
#include "hewn/hewn.h"
#include "samples.h"

#include "base/clock.h"
#include "eval/internal.h"
#include "iso/extractor.h"

#define THREADS 2

enum { STAGES = 5 };
static const char *const stage_names[STAGES] = {"cull", "evaluate", "extract", "suspects", "read_back"};

typedef struct contest {
    const char *name;
    const char *file;
    const hewn_scene_setting *settings;
    size_t setting_count;
    const dense_field *dense; /* NULL: a heap of shapes */
    uint32_t resolution;      /* where none is asked for */
    bool alone;               /* peers would take minutes, or 34 GB */
} contest;

static const hewn_scene_setting level_four[] = {{"L", 4}};
static const hewn_scene_setting hundred[] = {{"n", 100}}, thousand[] = {{"n", 1000}}, myriad[] = {{"n", 10000}},
                                few[] = {{"n", 25}}, some[] = {{"n", 50}};

static const contest contests[] = {
    {"csg", "csg.lua", NULL, 0, &dense_csg, 512, false},
    {"gyroid", "gyroid.lua", NULL, 0, &dense_gyroid, 512, false},
    {"menger", "menger.lua", level_four, 1, &dense_menger4, 512, false},
    {"random", "random.lua", thousand, 1, NULL, 256, false},
    {"random100", "random.lua", hundred, 1, NULL, 256, false},
    {"random25", "random.lua", few, 1, NULL, 256, false},
    {"random50", "random.lua", some, 1, NULL, 256, false},
    {"random10000", "random.lua", myriad, 1, NULL, 256, true},
    {"csg256", "csg.lua", NULL, 0, NULL, 256, true},
    {"csg1024", "csg.lua", NULL, 0, NULL, 1024, true},
    {"csg2048", "csg.lua", NULL, 0, NULL, 2048, true},
};

enum { CONTESTS = sizeof contests / sizeof *contests };

typedef struct outcome {
    double hewn[MOST_RUNS], sampling[MOST_RUNS], flying_edges[MOST_RUNS];
    double points[MOST_RUNS]; /* sampling by a function of a point, which shares nothing between samples; 0: none */
    double hewn_processor[MOST_RUNS], peer_processor[MOST_RUNS]; /* both cores together: other processes do not count */
    double dual[MOST_RUNS]; /* Hewn by dual contouring, which peers here do not have */
    double stage[STAGES];   /* processor seconds of the last run */
    double first;           /* compiling and the first run */
    bool listed;
    uint64_t hewn_triangles, peer_triangles;
    double brick_bytes, brick_operations; /* a brick writes and reads; 0: not known */
    bool ran;
} outcome;

typedef struct manner {
    hewn_evaluation evaluation;
    bool peers, dual;
} manner;

/* Bytes a second that both threads copy: what they read and what they write. */
static double copying_speed(void)
{
    enum { MEGABYTES = 256, TRIES = 5 };
    const size_t bytes = (size_t)MEGABYTES << 20, share = bytes / (2 * THREADS);
    char *block = malloc(bytes);
    double best = 0;
    if (!block)
        return 0;
    memset(block, 1, bytes);
    for (int i = 0; i < TRIES; i++) {
        double begin = hewn_clock_now();
#pragma omp parallel for schedule(static) num_threads(THREADS)
        for (int k = 0; k < THREADS; k++)
            memcpy(block + (size_t)(2 * k + 1) * share, block + (size_t)(2 * k) * share, share);
        best = fmax(best, (double)bytes / (hewn_clock_now() - begin));
    }
    free(block);
    return best;
}

/* What a brick with surface moves at the least, each thing written once and read once but the mesh, which is only
 * written; and about how many operations of a processor its field takes: a value a sample, and for each vertex five and
 * a gradient that costs as much as two. */
static void weigh_brick(const hewn_extractor *extractor, const hewn_extract_stats *stats,
                        const hewn_triangles *triangles, outcome *out)
{
    enum { WORDS = 8 + 16 + 2 * 48 + 2 + 1 + 2 + 2 + 16 }; /* links, signs, edges, counts, list, cuts, remote, marks */
    double bricks = (double)stats->bricks_active, vertices = (double)triangles->vertex_count / bricks, weight = 0;
    const hewn_listing *listing = &extractor->code->listing;
    out->brick_bytes = 2 * 4 * WORDS + vertices * (2 * 8 + 24) + 12 * (double)triangles->triangle_count / bricks;
    for (size_t i = 0; i < listing->count; i++)
        weight += hewn_listing_weight(&listing->steps[i]);
    out->brick_operations = out->listed ? 0 : weight * (512 + 7 * vertices);
}

static void stop_on(hewn_result result, const hewn_error *error)
{
    if (result == HEWN_OK)
        return;
    fprintf(stderr, "bench: %s: %s\n", error->file, error->message);
    exit(1);
}

/* Charges what the processors did since the last call to the stage that has ended. */
typedef struct meter {
    double last;
    double *stage;
} meter;

static bool charge(void *user, const char *stage, double fraction)
{
    meter *to = user;
    double now = bench_processor_now();
    (void)fraction;
    for (int k = 0; k < STAGES; k++)
        if (strcmp(stage, stage_names[k]) == 0)
            to->stage[k] = now - to->last;
    to->last = now;
    return true;
}

/* Seconds of an extraction; what `out` says of Hewn is from marching cubes, as flying edges is that too. */
static void run_hewn(hewn_extractor *extractor, const hewn_box *bounds, uint32_t resolution, hewn_method method,
                     double *seconds, outcome *out)
{
    hewn_error error = {0};
    bool cubes = method == HEWN_METHOD_MARCHING_CUBES;
    double unused[STAGES];
    meter processors = {bench_processor_now(), cubes ? out->stage : unused};
    hewn_progress progress = {.report = charge, .user = &processors};
    hewn_extract_desc desc = {.bounds = *bounds, .resolution = resolution, .method = method, .progress = &progress};
    hewn_triangles triangles;
    hewn_extract_stats stats;
    double begin = hewn_clock_now();
    stop_on(hewn_extract(extractor, &desc, &triangles, &stats, &error), &error);
    *seconds = hewn_clock_now() - begin;
    if (cubes) {
        out->hewn_triangles = triangles.triangle_count;
        weigh_brick(extractor, &stats, &triangles, out);
    }
    hewn_triangles_destroy(&triangles);
}

/* What the peers mesh: one of two ways to fill a cube with values. */
typedef struct peer {
    const dense_field *field;
    const dense_shape *heap;
    size_t heap_count;
    float lo, hi;
} peer;

static void run_peers(const peer *subject, uint32_t resolution, float *values, double *sampling, double *meshing,
                      outcome *out)
{
    size_t samples = (size_t)resolution + 1;
    double begin = hewn_clock_now();
    if (subject->field)
        dense_sample(subject->field, samples, values);
    else
        dense_sample_heap(subject->heap, subject->heap_count, subject->lo, subject->hi, samples, values);
    *sampling = hewn_clock_now() - begin;
    uint64_t vertices;
    double step = (double)(subject->hi - subject->lo) / resolution;
    *meshing = flying_edges_run(values, samples, (double)subject->lo, step, THREADS, &vertices, &out->peer_triangles);
}

static void run_points(const dense_field *field, size_t samples, float *values, double *seconds)
{
    double begin = hewn_clock_now();
    dense_sample_points(field, samples, values);
    *seconds = hewn_clock_now() - begin;
}

/* As Hewn, peers have had their memory from the system before they are timed. Of a heap a few shapes do for that: all
 * of them may take minutes. */
static void warm_peers(const peer *subject, uint32_t resolution, float *values, outcome *out)
{
    enum { SOME = 16 };
    double unused[2];
    peer fewer = *subject;
    fewer.heap_count = subject->heap_count < SOME ? subject->heap_count : SOME;
    run_peers(&fewer, resolution, values, &unused[0], &unused[1], out);
}

static void run_contest(hewn_device *device, const contest *entry, const char *folder, uint32_t resolution, int runs,
                        const manner *how, outcome *out)
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
    double compile = hewn_clock_now();
    stop_on(hewn_extractor_create_as(device, hewn_scene_field(scene), hewn_field_root(hewn_scene_field(scene)),
                                     &(hewn_code_desc){.evaluation = how->evaluation}, &extractor, &error),
            &error);
    out->listed = hewn_code_is_listed(extractor->code);
    peer subject = {.field = entry->dense, .lo = (float)bounds.lo[0], .hi = (float)bounds.hi[0]};
    if (entry->dense) {
        subject.lo = entry->dense->lo;
        subject.hi = entry->dense->hi;
    } else {
        subject.heap = heap_read(hewn_scene_field(scene), &subject.heap_count);
    }
    bool peers = how->peers && !entry->alone && (subject.field || subject.heap);
    size_t samples = (size_t)resolution + 1;
    float *values = peers ? malloc(samples * samples * samples * sizeof *values) : NULL;
    if (peers && !values)
        exit(1);
    double unused[2];
    run_hewn(extractor, &bounds, resolution, HEWN_METHOD_MARCHING_CUBES, unused, out);
    out->first = hewn_clock_now() - compile;
    bool dual = how->dual && !entry->alone;
    if (dual)
        run_hewn(extractor, &bounds, resolution, HEWN_METHOD_DC, unused, out);
    if (peers)
        warm_peers(&subject, resolution, values, out);
    for (int i = 0; i < runs; i++) {
        double begin = bench_processor_now();
        run_hewn(extractor, &bounds, resolution, HEWN_METHOD_MARCHING_CUBES, &out->hewn[i], out);
        double between = bench_processor_now();
        if (peers)
            run_peers(&subject, resolution, values, &out->sampling[i], &out->flying_edges[i], out);
        out->hewn_processor[i] = between - begin;
        out->peer_processor[i] = bench_processor_now() - between;
        if (peers && subject.field)
            run_points(subject.field, samples, values, &out->points[i]);
        if (dual)
            run_hewn(extractor, &bounds, resolution, HEWN_METHOD_DC, &out->dual[i], out);
    }
    free((void *)subject.heap);
    free(values);
    hewn_extractor_destroy(&extractor);
    hewn_scene_destroy(&scene);
}

/* How many times as long as Hewn a way to sample and flying edges take. */
static double paired_ratio(const outcome *result, const double *sampling, int runs)
{
    double ratios[MOST_RUNS];
    for (int i = 0; i < runs; i++)
        ratios[i] = (sampling[i] + result->flying_edges[i]) / result->hewn[i];
    return bench_median(ratios, runs);
}

static double processor_ratio(const outcome *result, int runs)
{
    double ratios[MOST_RUNS];
    for (int i = 0; i < runs; i++)
        ratios[i] = result->peer_processor[i] / result->hewn_processor[i];
    return bench_median(ratios, runs);
}

static void print_outcome(FILE *json, const contest *entry, uint32_t resolution, const outcome *result, int runs,
                          bool first)
{
    double ours = bench_median(result->hewn, runs), sampling = bench_median(result->sampling, runs);
    double meshing = bench_median(result->flying_edges, runs), ratio = paired_ratio(result, result->sampling, runs);
    double points = bench_median(result->points, runs), by_points = paired_ratio(result, result->points, runs);
    double dual = bench_median(result->dual, runs);
    double processor = bench_median(result->hewn_processor, runs), by_processor = processor_ratio(result, runs);
    printf("%-12s %5u  %-8s %6.2f %8.3f  %8.3f + %-7.3f  %5.2fx  ", entry->name, resolution,
           result->listed ? "lists" : "straight", result->first, ours, sampling, meshing, ratio);
    if (points > 0)
        printf("%6.3f %6.2fx", points, by_points);
    else
        printf("%6s %6s ", "-", "-");
    printf("   cpu %7.3f %6.2fx   dc %8.3f   %9llu %9llu   cpu:", processor, by_processor, dual,
           (unsigned long long)result->hewn_triangles, (unsigned long long)result->peer_triangles);
    for (int k = 0; k < STAGES; k++)
        printf(" %s %.3f", stage_names[k], result->stage[k]);
    printf("   a brick: %.0f bytes, %.0f operations\n", result->brick_bytes, result->brick_operations);
    if (json)
        fprintf(json,
                "%s\n    {\"scene\": \"%s\", \"resolution\": %u, \"evaluation\": \"%s\", \"runs\": %d, "
                "\"first_seconds\": %.4f, \"hewn_seconds\": %.4f, \"hewn_processor_seconds\": %.4f, "
                "\"triangles\": %llu, \"brick_bytes\": %.0f, \"brick_operations\": %.0f",
                first ? "" : ",", entry->name, resolution, result->listed ? "lists" : "straight", runs, result->first,
                ours, processor, (unsigned long long)result->hewn_triangles, result->brick_bytes,
                result->brick_operations);
    if (json && meshing > 0)
        fprintf(json,
                ", \"sampling_seconds\": %.4f, \"flying_edges_seconds\": %.4f, \"times_faster\": %.3f, "
                "\"times_less_processor\": %.3f",
                sampling, meshing, ratio, by_processor);
    if (json && points > 0)
        fprintf(json, ", \"point_sampling_seconds\": %.4f, \"times_faster_than_by_points\": %.3f", points, by_points);
    if (json && dual > 0)
        fprintf(json, ", \"hewn_dc_seconds\": %.4f", dual);
    if (json)
        fprintf(json, "}");
}

/* How many times as long as the first of two contests the second one takes; 0 where they did not both run. */
static double times_as_long(const outcome *results, const char *first, const char *second, int runs)
{
    double seconds[2] = {0};
    for (int i = 0; i < CONTESTS; i++)
        for (int k = 0; k < 2; k++)
            if (results[i].ran && strcmp(contests[i].name, k ? second : first) == 0)
                seconds[k] = bench_median(results[i].hewn, runs);
    return seconds[0] > 0 ? seconds[1] / seconds[0] : 0;
}

static void print_growth(FILE *json, const outcome *results, int runs)
{
    static const char *const steps[][2] = {
        {"random100", "random"}, {"csg256", "csg"}, {"csg", "csg1024"}, {"csg1024", "csg2048"}};
    bool first = true;
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        double times = times_as_long(results, steps[i][0], steps[i][1], runs);
        if (!(times > 0))
            continue;
        printf("%s takes %.2f times as long as %s\n", steps[i][1], times, steps[i][0]);
        if (json)
            fprintf(json, "%s{\"from\": \"%s\", \"to\": \"%s\", \"times\": %.3f}", first ? "" : ", ", steps[i][0],
                    steps[i][1], times);
        first = false;
    }
}

/* How many processes want the processors, on average over a minute; negative: not known. */
static double machine_load(void)
{
    double load[1];
    return getloadavg(load, 1) == 1 ? load[0] : -1;
}

static bool wanted(const contest *entry, int argc, char **argv, int from)
{
    for (int i = from; i < argc; i++)
        if (strcmp(argv[i], entry->name) == 0)
            return true;
    return from >= argc;
}

/* What the command line asks for. */
typedef struct request {
    int runs, first_scene; /* the latter of the arguments */
    uint32_t resolution;
    manner how;
    const char *json;
} request;

static request read_request(int argc, char **argv)
{
    request out = {5, 1, 0, {HEWN_EVALUATION_AUTO, true, true}, "bench/results/extract.json"};
    for (; out.first_scene + 1 < argc && strncmp(argv[out.first_scene], "--", 2) == 0; out.first_scene += 2) {
        const char *name = argv[out.first_scene], *value = argv[out.first_scene + 1];
        if (strcmp(name, "--runs") == 0)
            out.runs = atoi(value);
        else if (strcmp(name, "--res") == 0)
            out.resolution = (uint32_t)atoi(value);
        else if (strcmp(name, "--peers") == 0)
            out.how.peers = atoi(value) != 0;
        else if (strcmp(name, "--dual") == 0)
            out.how.dual = atoi(value) != 0;
        else if (strcmp(name, "--as") == 0)
            out.how.evaluation = strcmp(value, "listed") == 0     ? HEWN_EVALUATION_LISTED
                                 : strcmp(value, "straight") == 0 ? HEWN_EVALUATION_STRAIGHT
                                                                  : HEWN_EVALUATION_AUTO;
        else if (strcmp(name, "--json") == 0)
            out.json = value;
    }
    out.runs = out.runs < 1 ? 1 : out.runs > MOST_RUNS ? MOST_RUNS : out.runs;
    return out;
}

int main(int argc, char **argv)
{
    const char *folder = getenv("HEWN_SCENES");
    const request asked = read_request(argc, argv);
    const int runs = asked.runs;
    FILE *json = fopen(asked.json, "w");
    if (!json)
        fprintf(stderr, "bench: %s cannot be written\n", asked.json);
    hewn_error error = {0};
    hewn_device *device;
    stop_on(hewn_device_create(NULL, &device, &error), &error);
    printf(
        "device %s; dense sampling in C and VTK flying edges (%s) on %d threads; medians of %d runs in turn, seconds\n",
        hewn_device_get_info(device)->name, flying_edges_backend(), THREADS, runs);
    printf("%-12s %5s  %-8s %6s %8s  %18s  %6s  %14s   %19s   %11s   %9s %9s\n", "scene", "cells", "as", "first",
           "Hewn mc", "by rows + VTK", "ratio", "points, ratio", "processor, ratio", "Hewn dc", "triangles", "VTK's");
    double speed = copying_speed();
    printf("copying moves %.1f GB/s (read and written); load of the machine %.1f\n", 1e-9 * speed, machine_load());
    if (json)
        fprintf(
            json,
            "{\"device\": \"%s\", \"threads\": %d, \"copy_bytes_per_second\": %.3e, \"load\": %.1f,\n  \"scenes\": [",
            hewn_device_get_info(device)->name, THREADS, speed, machine_load());
    static outcome results[CONTESTS];
    bool first = true;
    for (int i = 0; i < CONTESTS; i++) {
        if (!wanted(&contests[i], argc, argv, asked.first_scene))
            continue;
        outcome *result = &results[i];
        uint32_t resolution = asked.resolution ? asked.resolution : contests[i].resolution;
        run_contest(device, &contests[i], folder ? folder : "assets/scenes", resolution, runs, &asked.how, result);
        print_outcome(json, &contests[i], resolution, result, runs, first);
        result->ran = true;
        first = false;
        fflush(stdout);
    }
    if (json)
        fprintf(json, "\n  ], \"growth\": [");
    print_growth(json, results, runs);
    if (json) {
        fprintf(json, "], \"load_at_end\": %.1f}\n", machine_load());
        fclose(json);
    }
    hewn_device_destroy(&device);
    return 0;
}
