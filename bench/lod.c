/* Levels of detail of mesh files: making, writing and reading progressive meshes, how near they are beside hewn
 * simplify, clusters, and a camera that flies around the mesh. Distances are in diagonals of the input's box and
 * proven. usage: lod [--frames N] [--quick] FILE... */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hewn/clusters.h"
#include "hewn/distance.h"
#include "hewn/io.h"
#include "hewn/refinement.h"
#include "hewn/simplify.h"
#include "samples.h"

#include "base/clock.h"

static void need(hewn_result result, const hewn_error *error)
{
    if (result == HEWN_OK)
        return;
    fprintf(stderr, "bench: %s\n", error->message);
    exit(1);
}

/* Seconds of all of this process' threads together, and by the clock. */
typedef struct moment {
    double processor, clock;
} moment;

static moment now(void)
{
    return (moment){bench_processor_now(), hewn_clock_now()};
}

static void print_time(const char *what, moment begin)
{
    const moment end = now();
    printf("  %-28s %8.3f s, %8.3f s of processors\n", what, end.clock - begin.clock, end.processor - begin.processor);
}

static void find_box(const hewn_model *model, double middle[3], double *diagonal)
{
    double square = 0;
    for (size_t axis = 0; axis < 3; axis++) {
        double lo = INFINITY, hi = -INFINITY;
        for (uint64_t v = 0; v < model->vertex_count; v++) {
            lo = fmin(lo, model->positions[3 * v + axis]);
            hi = fmax(hi, model->positions[3 * v + axis]);
        }
        middle[axis] = (lo + hi) / 2;
        square += (hi - lo) * (hi - lo);
    }
    *diagonal = sqrt(square);
}

static double distance_of(const hewn_model *a, const hewn_model *b)
{
    hewn_error error = {0};
    hewn_distance distance;
    const hewn_polygons one = hewn_model_polygons(a), two = hewn_model_polygons(b);
    need(hewn_polygons_distance(&one, &two, NULL, &distance, &error), &error);
    return distance.high;
}

/* Meshes on the way beside those that vertices may move for. */
static void compare(const hewn_model *model, const hewn_progressive *made, double diagonal)
{
    hewn_error error = {0};
    for (double ratio = 0.25; ratio > 0.01; ratio /= 5) {
        hewn_model part, simplified;
        const uint64_t faces = (uint64_t)(ratio * (double)hewn_progressive_about(made).triangles);
        need(hewn_progressive_model(made, hewn_progressive_splits_for(made, faces), &part, &error), &error);
        need(hewn_model_copy(model, &simplified, &error), &error);
        need(hewn_model_simplify(&simplified, &(hewn_simplify_desc){.faces = faces}, NULL, &error), &error);
        printf("  %9llu triangles: progressive %.3e, simplified %.3e\n", (unsigned long long)faces,
               distance_of(&part, model) / diagonal, distance_of(&simplified, model) / diagonal);
        hewn_model_destroy(&part);
        hewn_model_destroy(&simplified);
    }
}

static void fly(const hewn_progressive *made, const double middle[3], double diagonal, int frames)
{
    hewn_error error = {0};
    hewn_refinement *refinement;
    uint64_t steps = 0, triangles = 0;
    double most = 0;
    moment begin = now();
    need(hewn_refinement_create(made, &refinement, &error), &error);
    print_time("hierarchy of splits", begin);
    for (int frame = -1; frame < frames; frame++) {
        const double turn = 2 * M_PI * frame / frames, away = diagonal * (0.6 + 0.5 * cos(3 * turn));
        hewn_refinement_stats stats;
        hewn_refinement_view view = {.pixels = 1300, .tolerance = 1, .back = 8};
        view.eye[0] = middle[0] + away * cos(turn);
        view.eye[1] = middle[1] + away * sin(turn);
        view.eye[2] = middle[2] + 0.3 * diagonal * sin(2 * turn);
        const moment start = now();
        need(hewn_refinement_update(refinement, &view, 0, &stats, &error), &error);
        if (frame < 0) {
            print_time("first frame", start);
            begin = now();
            continue;
        }
        uint64_t count;
        hewn_refinement_triangles(refinement, &count);
        triangles += count;
        steps += stats.splits + stats.folds;
        most = fmax(most, now().processor - start.processor);
    }
    printf("  %d frames: %.3f ms of a processor each, %.3f ms at most; %llu triangles, %llu splits and folds on "
           "average\n",
           frames, 1000 * (now().processor - begin.processor) / frames, 1000 * most,
           (unsigned long long)(triangles / (uint64_t)frames), (unsigned long long)(steps / (uint64_t)frames));
    hewn_refinement_destroy(&refinement);
}

static void measure(const char *path, int frames, bool quick)
{
    hewn_error error = {0};
    hewn_model model;
    hewn_progressive *made, *read;
    hewn_clusters clusters;
    double middle[3], diagonal;
    char *bytes;
    size_t length;
    need(hewn_model_read(path, NULL, &model, &error), &error);
    find_box(&model, middle, &diagonal);
    moment begin = now();
    need(hewn_progressive_make(&model, NULL, &made, &error), &error);
    const hewn_progressive_info info = hewn_progressive_about(made);
    printf("%s: %llu triangles, base of %llu\n", path, (unsigned long long)info.triangles,
           (unsigned long long)info.base_triangles);
    print_time("progressive mesh", begin);
    begin = now();
    need(hewn_progressive_encode(made, &bytes, &length, &error), &error);
    print_time("encoded", begin);
    begin = now();
    need(hewn_progressive_decode(bytes, length, path, false, &read, &error), &error);
    print_time("decoded", begin);
    printf("  %.1f bytes a triangle\n", (double)length / (double)info.triangles);
    if (!quick)
        compare(&model, made, diagonal);
    fly(made, middle, diagonal, frames);
    begin = now();
    need(hewn_clusters_make(&model, NULL, &clusters, &error), &error);
    print_time("clusters", begin);
    printf("  %u clusters in %u levels\n", clusters.count, clusters.level_count);
    hewn_clusters_destroy(&clusters);
    hewn_progressive_bytes_free(bytes);
    hewn_progressive_destroy(&made);
    hewn_progressive_destroy(&read);
    hewn_model_destroy(&model);
}

int main(int argc, char **argv)
{
    int frames = 300;
    bool quick = false;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--frames") == 0 && i + 1 < argc)
            frames = atoi(argv[++i]) > 0 ? atoi(argv[i]) : frames;
        else if (strcmp(argv[i], "--quick") == 0)
            quick = true;
        else
            measure(argv[i], frames, quick);
    }
    return 0;
}
