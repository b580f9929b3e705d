/* Smoothing of a noisy torus in memory: Hewn's methods beside VTK's, in turn and in one process. Times are those of the
 * whole call, neighbourhoods included, right after another of the same: what the one before left of pages and caches is
 * nobody's burden.
 * usage: smooth [--runs N] [--triangles N] [--iterations N] [--only NAME,NAME...] */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "hewn/smooth.h"
#include "samples.h"
#include "smooth_peers.h"
#include "torus.h"

#include "base/clock.h"

static double hewn_smooth(const peer_input *input, hewn_smooth_method method, int iterations, double *positions)
{
    const hewn_polygons polygons = {input->vertex_count, input->positions, input->triangle_count, NULL, input->indices};
    hewn_smooth_desc desc = {.volume = HEWN_SMOOTH_VOLUME_FREE, .method = method, .iterations = (uint32_t)iterations};
    hewn_error error;
    double begin = hewn_clock_now();
    if (hewn_polygons_smooth(&polygons, &desc, positions, NULL, &error) != HEWN_OK) {
        fprintf(stderr, "bench: %s\n", error.message);
        exit(1);
    }
    return hewn_clock_now() - begin;
}

static double run(const char *name, const peer_input *input, int iterations, double *positions)
{
    hewn_smooth_method method;
    if (hewn_smooth_method_find(name, &method))
        return hewn_smooth(input, method, iterations, positions);
    if (strcmp(name, "vtk laplace") == 0)
        return vtk_laplace(input, iterations, positions);
    return vtk_windowed_sinc(input, iterations, 0.1, 0, positions);
}

/* A tenth of an edge of noise. */
static void add_noise(peer_input *input)
{
    double *positions = (double *)input->positions, edge = 2 * M_PI / sqrt((double)input->vertex_count);
    srand48(1);
    for (uint64_t i = 0; i < 3 * input->vertex_count; i++)
        positions[i] += 0.1 * edge * (drand48() - 0.5);
}

/* Whether a list with commas has a name. */
static bool is_named(const char *list, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = list; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL)
        if (strncmp(at, name, length) == 0 && (at[length] == ',' || at[length] == '\0'))
            return true;
    return false;
}

int main(int argc, char **argv)
{
    static const char *const names[] = {"taubin",    "laplacian", "hc",       "cotan",
                                        "bilateral", "implicit",  "vtk sinc", "vtk laplace"};
    enum { NAMES = sizeof names / sizeof *names };
    static double seconds[NAMES][MOST_RUNS];
    int runs = 3, iterations = 10;
    uint64_t triangles = 2000000;
    const char *only = NULL;
    for (int at = 1; at + 1 < argc; at += 2) {
        if (strcmp(argv[at], "--runs") == 0)
            runs = atoi(argv[at + 1]);
        else if (strcmp(argv[at], "--triangles") == 0)
            triangles = strtoull(argv[at + 1], NULL, 10);
        else if (strcmp(argv[at], "--iterations") == 0)
            iterations = atoi(argv[at + 1]);
        else if (strcmp(argv[at], "--only") == 0)
            only = argv[at + 1];
    }
    runs = runs < 1 ? 1 : runs > MOST_RUNS ? MOST_RUNS : runs;
    peer_input input = bench_torus(triangles < 18 ? 18 : triangles);
    add_noise(&input);
    double *positions = malloc(input.vertex_count * 3 * sizeof *positions);
    if (!positions)
        return 1;
    for (int at = 0; at < runs; at++)
        for (int i = 0; i < NAMES; i++)
            if (!only || is_named(only, names[i])) {
                run(names[i], &input, iterations, positions);
                seconds[i][at] = run(names[i], &input, iterations, positions);
            }
    printf("%llu vertices, %d iterations, %d threads, medians of %d\n", (unsigned long long)input.vertex_count,
           iterations, omp_get_max_threads(), runs);
    for (int i = 0; i < NAMES; i++)
        if (!only || is_named(only, names[i]))
            printf("%-12s %8.3f s\n", names[i], bench_median(seconds[i], runs));
    struct rusage usage;
    if (only && getrusage(RUSAGE_SELF, &usage) == 0)
        printf("peak of the process %.1f MiB\n", (double)usage.ru_maxrss / 1024);
    return 0;
}
