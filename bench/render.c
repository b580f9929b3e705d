/* How long pictures take: prospero.vm filled at 1024 x 1024 beside the unpruned shader of the same field, and 1280 x
 * 720 of each scene with shadow and ambient occlusion. First runs have nothing cached: caches are in a folder of the
 * program's own, which starts empty and goes at the end. usage: render [--runs N] [--size WxH] [SCENE...] */
#include <dirent.h>
#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "eval/lists.h"
#include "hewn/hewn.h"
#include "samples.h"

enum { SIDE = 1024, MOST_SCENES = 64 };

static hewn_error error;

static void check(hewn_result result, const char *what)
{
    if (result == HEWN_OK)
        return;
    fprintf(stderr, "render: %s: %s\n", what, error.message);
    exit(1);
}

static char caches[] = "/tmp/hewn-bench-XXXXXX";

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *at)
{
    (void)info;
    (void)kind;
    (void)at;
    return remove(path);
}

static void remove_caches(void)
{
    nftw(caches, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

/* Hewn's and Mesa's. */
static void start_without_caches(void)
{
    if (!mkdtemp(caches) || setenv("XDG_CACHE_HOME", caches, 1) != 0 || unsetenv("MESA_SHADER_CACHE_DIR") != 0)
        exit(1);
    atexit(remove_caches);
}

static float *make_points(void)
{
    float *points = hewn_alloc((size_t)SIDE * SIDE, 3 * sizeof *points);
    for (size_t i = 0; points && i < (size_t)SIDE * SIDE; i++) {
        points[3 * i] = (float)(-1 + 2 * ((double)(i % SIDE) + 0.5) / SIDE);
        points[3 * i + 1] = (float)(1 - 2 * ((double)(i / SIDE) + 0.5) / SIDE);
        points[3 * i + 2] = 0;
    }
    return points;
}

/* The shader of all operations, at every pixel; the first run is the driver's compilation too. */
static double time_shader(const hewn_field *field, int runs, double *first)
{
    hewn_device *device;
    hewn_code *code;
    const hewn_code_desc straight = {.evaluation = HEWN_EVALUATION_STRAIGHT};
    float *points = make_points(), *values = hewn_alloc((size_t)SIDE * SIDE, sizeof *values);
    double best = INFINITY, began = hewn_clock_now();
    if (!points || !values)
        exit(1);
    check(hewn_device_create(NULL, &device, &error), "a device");
    check(hewn_code_create_as(device, field, hewn_field_root(field), &straight, &code, &error), "the shader");
    check(hewn_code_eval_points(device, code, points, (size_t)SIDE * SIDE, values, &error), "the shader");
    *first = hewn_clock_now() - began;
    for (int i = 0; i < runs; i++) {
        began = hewn_clock_now();
        check(hewn_code_eval_points(device, code, points, (size_t)SIDE * SIDE, values, &error), "the shader");
        best = fmin(best, hewn_clock_now() - began);
    }
    hewn_code_destroy(device, &code);
    hewn_device_destroy(&device);
    hewn_free(points);
    hewn_free(values);
    return best;
}

static void fill_plane(int runs)
{
    const char *data = getenv("HEWN_DATA");
    char path[1024];
    snprintf(path, sizeof path, "%s/implicit/prospero.vm", data ? data : "../shared/data");
    const hewn_scene_desc desc = {.path = path};
    hewn_scene *scene;
    double began = hewn_clock_now(), best = INFINITY, first;
    if (hewn_scene_load(&desc, &scene, &error) != HEWN_OK) {
        printf("no %s: %s\n", path, error.message);
        return;
    }
    const hewn_field *field = hewn_scene_field(scene);
    const hewn_plane_desc plane = {.lo = {-1, -1}, .hi = {1, 1}, .width = SIDE, .height = SIDE};
    hewn_plane_stats stats;
    hewn_picture picture;
    check(hewn_render_plane(field, hewn_field_root(field), &plane, &picture, &stats, &error), "the plane");
    first = hewn_clock_now() - began;
    hewn_picture_destroy(&picture);
    for (int i = 0; i < runs; i++) {
        began = hewn_clock_now();
        check(hewn_render_plane(field, hewn_field_root(field), &plane, &picture, &stats, &error), "the plane");
        best = fmin(best, hewn_clock_now() - began);
        hewn_picture_destroy(&picture);
    }
    double shader_first, shader = time_shader(field, runs, &shader_first);
    double all = (double)stats.operations;
    printf("prospero.vm at %d x %d, seconds (best of %d)\n", SIDE, SIDE, runs);
    printf("  unpruned shader   %.3f (first run, compiled: %.2f)\n", shader, shader_first);
    printf("  filled            %.3f (first run, file read: %.2f): %.1f times faster\n", best, first, shader / best);
    printf("  operations a pixel %.2f of %.0f (%.2f %%), with bounds %.2f %%\n", stats.operations_a_pixel, all,
           100 * stats.operations_a_pixel / all, 100 * (stats.operations_a_pixel + stats.bounds_a_pixel) / all);
    hewn_scene_destroy(&scene);
}

static void render_scene(const char *path, uint32_t width, uint32_t height, int runs)
{
    hewn_render_job_desc desc = {.scene = {.path = path, .reader = hewn_scene_reader_standard()},
                                 .output = "/dev/null"};
    hewn_render_report report = {0};
    double first = 0, first_spent = 0, best = INFINITY, spent = INFINITY;
    desc.render.width = width;
    desc.render.height = height;
    for (int i = 0; i <= runs; i++) {
        double began = bench_processor_now(), took;
        if (hewn_render_file(&desc, &report, &error) != HEWN_OK) {
            printf("  %-24s %s\n", path, error.message);
            return;
        }
        took = bench_processor_now() - began;
        if (i == 0) {
            first = report.seconds;
            first_spent = took;
        } else {
            best = fmin(best, report.seconds);
            spent = fmin(spent, took);
        }
    }
    const char *slash = strrchr(path, '/');
    printf("  %-14s %7.2f %7.2f %8.2f %7.2f %8.2f %8.2f %9llu  %s\n", slash ? slash + 1 : path, first, best,
           first_spent, spent, report.stats.prepare_seconds, report.stats.trace_seconds,
           (unsigned long long)report.stats.rays, report.where);
    fflush(stdout);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* All of assets/scenes. */
static int find_scenes(char **names)
{
    DIR *folder = opendir("assets/scenes");
    int count = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL && count < MOST_SCENES;) {
        const char *dot = strrchr(entry->d_name, '.');
        char path[512];
        if (!dot || strcmp(dot, ".lua") != 0)
            continue;
        snprintf(path, sizeof path, "assets/scenes/%s", entry->d_name);
        names[count++] = hewn_strdup(path);
    }
    if (folder)
        closedir(folder);
    qsort(names, (size_t)count, sizeof *names, by_name);
    return count;
}

int main(int argc, char **argv)
{
    char *names[MOST_SCENES];
    int count = 0, runs = 2;
    unsigned width = 1280, height = 720;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--runs") == 0 && i + 1 < argc)
            runs = atoi(argv[++i]);
        else if (strcmp(argv[i], "--size") == 0 && i + 1 < argc && sscanf(argv[i + 1], "%ux%u", &width, &height) == 2)
            i++;
        else if (count < MOST_SCENES)
            names[count++] = hewn_strdup(argv[i]);
    }
    if (runs < 1)
        runs = 1;
    start_without_caches();
    double load[1];
    if (getloadavg(load, 1) == 1)
        printf("%ld processors, load %.1f at the start\n\n", sysconf(_SC_NPROCESSORS_ONLN), load[0]);
    fill_plane(runs);
    if (count == 0)
        count = find_scenes(names);
    printf(
        "\n%u x %u with shadow and ambient occlusion: seconds by the clock and of processors, with nothing cached and "
        "best of %d after that\n",
        width, height, runs);
    printf("  scene            first    next   first     next  prepare    trace      rays\n");
    printf("                   clock   clock  process  process    clock    clock\n");
    for (int i = 0; i < count; i++) {
        render_scene(names[i], width, height, runs);
        hewn_free(names[i]);
    }
    return 0;
}
