/* Noise taken off a machine part, by Hewn's bilateral smoothing and by VTK's and CGAL's filters with the best of their
 * parameters each: the share of the noise that is left, and the median change of sharp edges.
 * usage: denoise [MESH] [--noise EDGES]   (without a mesh: fandisk.off of the test data, where these are there) */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../tests/oracle/denoise.h"
#include "base/alloc.h"
#include "hewn/io.h"
#include "hewn/smooth.h"
#include "smooth_peers.h"

static double mean_edge(const hewn_model *model)
{
    double sum = 0;
    for (uint64_t c = 0; c < 3 * model->face_count; c++) {
        const double *a = model->positions + 3 * (size_t)model->corners[c],
                     *b = model->positions + 3 * (size_t)model->corners[c % 3 == 2 ? c - 2 : c + 1];
        sum += sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
    }
    return sum / (3 * (double)model->face_count);
}

/* What one filter with one set of parameters leaves. */
typedef struct outcome {
    double noise, change;
    char with[64];
} outcome;

typedef struct trial {
    const hewn_model *clean;
    peer_input noisy;
    const sharp_edge *sharp;
    size_t sharp_count;
    double *positions; /* of the result */
    double noise;      /* before */
} trial;

static void judge(const trial *run, const char *with, outcome *best)
{
    outcome now = {noise_left(run->clean, run->positions) / run->noise,
                   sharp_edges_change(run->clean, run->positions, run->sharp, run->sharp_count), ""};
    snprintf(now.with, sizeof now.with, "%s", with);
    if (now.noise < best->noise)
        *best = now;
}

static outcome try_hewn(trial *run, hewn_smooth_method method)
{
    outcome best = {INFINITY, 0, ""};
    const hewn_polygons polygons = {run->noisy.vertex_count, run->noisy.positions, run->noisy.triangle_count, NULL,
                                    run->noisy.indices};
    hewn_error error;
    if (hewn_polygons_smooth(&polygons, &(hewn_smooth_desc){.method = method}, run->positions, NULL, &error) !=
        HEWN_OK) {
        fprintf(stderr, "bench: %s\n", error.message);
        exit(1);
    }
    judge(run, "defaults", &best);
    return best;
}

static outcome try_vtk_sinc(trial *run, double angle)
{
    outcome best = {INFINITY, 0, ""};
    for (int iterations = 5; iterations <= 80; iterations *= 2)
        for (double passband = 0.01; passband < 1; passband *= 2) {
            char with[64];
            snprintf(with, sizeof with, "%d iterations, pass band %.2f", iterations, passband);
            vtk_windowed_sinc(&run->noisy, iterations, passband, angle, run->positions);
            judge(run, with, &best);
        }
    return best;
}

static outcome try_vtk_laplace(trial *run)
{
    outcome best = {INFINITY, 0, ""};
    for (int iterations = 1; iterations <= 64; iterations *= 2) {
        char with[64];
        snprintf(with, sizeof with, "%d iterations", iterations);
        vtk_laplace(&run->noisy, iterations, run->positions);
        judge(run, with, &best);
    }
    return best;
}

static outcome try_cgal(trial *run, double edge)
{
    outcome best = {INFINITY, 0, ""};
    for (double share = 1.0 / 256; share <= 4; share *= 2) {
        char with[64];
        snprintf(with, sizeof with, "time of %.3g square edges", share);
        cgal_smooth_shape(&run->noisy, share * edge * edge, 1, run->positions);
        judge(run, with, &best);
    }
    return best;
}

static void print(const char *name, const outcome *of)
{
    printf("%-34s %5.3f of the noise, sharp edges change by %5.2f degrees  (%s)\n", name, of->noise, of->change,
           of->with);
}

static const char *default_mesh(char path[4096])
{
    const char *data = getenv("HEWN_DATA");
    snprintf(path, 4096, "%s/mesh-cad/fandisk.off", data ? data : "../shared/data");
    return access(path, R_OK) == 0 ? path : NULL;
}

int main(int argc, char **argv)
{
    hewn_model clean;
    hewn_error error;
    char path[4096];
    bool named = argc > 1 && argv[1][0] != '-';
    const char *mesh = named ? argv[1] : default_mesh(path);
    double share = argc > 2 + named && strcmp(argv[1 + named], "--noise") == 0 ? atof(argv[2 + named]) : 0.1;
    if (!mesh) {
        fprintf(stderr, "bench: no test data here, and no mesh named\n");
        return 0;
    }
    if (hewn_model_read(mesh, NULL, &clean, &error) != HEWN_OK) {
        fprintf(stderr, "bench: %s: %s\n", mesh, error.message);
        return 1;
    }
    if (clean.first) {
        fprintf(stderr, "bench: %s is not of triangles\n", mesh);
        return 1;
    }
    size_t numbers = 3 * (size_t)clean.vertex_count;
    double edge = mean_edge(&clean), *noisy = hewn_alloc(numbers, 2 * sizeof *noisy);
    trial run = {.clean = &clean, .noisy = {clean.vertex_count, clean.face_count, noisy, clean.corners}};
    run.sharp = sharp_edges_find(&clean, 40, &run.sharp_count);
    if (!noisy || !run.sharp)
        return 1;
    run.positions = noisy + numbers;
    srand48(1);
    for (size_t i = 0; i < numbers; i++) {
        double u = drand48(), v = drand48();
        noisy[i] = clean.positions[i] + share * edge * sqrt(-2 * log(1 - u)) * cos(2 * M_PI * v);
    }
    run.noise = noise_left(&clean, noisy);
    printf("%s, %llu triangles, noise of %g edges, %zu sharp edges; peers with what leaves least noise\n", mesh,
           (unsigned long long)clean.face_count, share, run.sharp_count);
    const outcome all[] = {try_hewn(&run, HEWN_SMOOTH_BILATERAL),
                           try_hewn(&run, HEWN_SMOOTH_LAPLACIAN),
                           try_vtk_sinc(&run, 0),
                           try_vtk_sinc(&run, 40),
                           try_vtk_laplace(&run),
                           try_cgal(&run, edge)};
    static const char *const names[] = {"hewn bilateral",           "hewn laplacian", "vtk windowed sinc",
                                        "vtk windowed sinc, edges", "vtk laplace",    "cgal smooth_shape"};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        print(names[i], &all[i]);
    return 0;
}
