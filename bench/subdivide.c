/* Subdivision in memory: Hewn beside OpenMesh, CGAL and OpenSubdiv, in turn and in one process.
 * usage: subdivide FILE.obj [--levels N] [--runs N]   Loop, for a file of triangles
 *        subdivide --quads N [--levels N] [--runs N]  Catmull-Clark, for a torus of about N quadrilaterals */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hewn/io.h"
#include "hewn/subdivide.h"
#include "samples.h"
#include "subdivide_peers.h"

#include "base/clock.h"

enum { HEWN, HEWN_TOPOLOGY, HEWN_POINTS, OPENMESH, CGAL, OSD, OSD_TOPOLOGY, OSD_POINTS, ROWS };
static const char *const names[ROWS] = {"hewn", "  topology", "  points",   "openmesh",
                                        "cgal", "opensubdiv", "  topology", "  points"};
static double seconds[ROWS][MOST_RUNS];

static void run_hewn(const cage *input, int levels, int run, uint64_t *faces)
{
    uint64_t *first = NULL;
    if (input->sides == 4) {
        first = malloc((input->face_count + 1) * sizeof *first);
        for (uint64_t f = 0; first && f <= input->face_count; f++)
            first[f] = 4 * f;
    }
    const hewn_polygons polygons = {input->vertex_count, input->positions, input->face_count, first, input->corners};
    hewn_subdivide_desc desc = {.levels = (uint32_t)levels,
                                .scheme = input->sides == 3 ? HEWN_SCHEME_LOOP : HEWN_SCHEME_CATMULL_CLARK};
    hewn_subdivision *subdivision;
    hewn_error error;
    double begin = hewn_clock_now();
    if (hewn_subdivision_create(&polygons, &desc, &subdivision, &error) != HEWN_OK) {
        fprintf(stderr, "bench: %s\n", error.message);
        exit(1);
    }
    double middle = hewn_clock_now();
    double *points = malloc(hewn_subdivision_vert_count(subdivision) * 3ull * sizeof *points);
    if (!points || hewn_subdivision_evaluate(subdivision, input->positions, 3, points, &error) != HEWN_OK)
        exit(1);
    double end = hewn_clock_now();
    seconds[HEWN][run] = end - begin;
    seconds[HEWN_TOPOLOGY][run] = middle - begin;
    seconds[HEWN_POINTS][run] = end - middle;
    *faces = hewn_subdivision_face_count(subdivision);
    free(points);
    free(first);
    hewn_subdivision_destroy(&subdivision);
}

static cage quads(uint64_t count)
{
    uint32_t m = (uint32_t)sqrt((double)count), n = (uint32_t)(count / m);
    cage out = {(uint64_t)n * m, (uint64_t)n * m, 4, NULL, NULL};
    double *positions = malloc(out.vertex_count * 3 * sizeof *positions);
    uint32_t *corners = malloc(out.face_count * 4 * sizeof *corners);
    if (!positions || !corners)
        exit(1);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++) {
            double u = 2 * M_PI * i / n, v = 2 * M_PI * j / m, radius = 1 + 0.3 * cos(v);
            uint32_t a = i * m + j;
            const double position[3] = {radius * cos(u), radius * sin(u), 0.3 * sin(v)};
            const uint32_t quad[4] = {a, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m};
            memcpy(positions + 3 * (size_t)a, position, sizeof position);
            memcpy(corners + 4 * (size_t)a, quad, sizeof quad);
        }
    out.positions = positions;
    out.corners = corners;
    return out;
}

int main(int argc, char **argv)
{
    int runs = 5, levels = 3;
    uint64_t quad_count = 0;
    const char *path = NULL;
    for (int at = 1; at < argc; at++) {
        if (at + 1 < argc && strcmp(argv[at], "--runs") == 0)
            runs = atoi(argv[++at]);
        else if (at + 1 < argc && strcmp(argv[at], "--levels") == 0)
            levels = atoi(argv[++at]);
        else if (at + 1 < argc && strcmp(argv[at], "--quads") == 0)
            quad_count = strtoull(argv[++at], NULL, 10);
        else
            path = argv[at];
    }
    runs = runs < 1 ? 1 : runs > MOST_RUNS ? MOST_RUNS : runs;
    hewn_model model = {0};
    hewn_error error;
    cage input = quads(quad_count ? quad_count : 16);
    if (path && hewn_model_read(path, NULL, &model, &error) != HEWN_OK) {
        fprintf(stderr, "bench: %s\n", error.message);
        return 1;
    }
    if (path)
        input = (cage){model.vertex_count, model.face_count, 3, model.positions, model.corners};
    uint64_t faces[4] = {0};
    for (int run = 0; run < runs; run++) {
        run_hewn(&input, levels, run, &faces[0]);
        seconds[OPENMESH][run] = openmesh_subdivide(&input, levels, &faces[1]);
        seconds[CGAL][run] = cgal_subdivide(&input, levels, &faces[2]);
        seconds[OSD][run] =
            osd_subdivide(&input, levels, &seconds[OSD_TOPOLOGY][run], &seconds[OSD_POINTS][run], &faces[3]);
    }
    printf("%llu faces, %d levels, %d threads, medians of %d; faces: %llu, %llu, %llu, %llu\n",
           (unsigned long long)input.face_count, levels, omp_get_max_threads(), runs, (unsigned long long)faces[0],
           (unsigned long long)faces[1], (unsigned long long)faces[2], (unsigned long long)faces[3]);
    for (int i = 0; i < ROWS; i++)
        printf("%-12s %8.3f s\n", names[i], bench_median(seconds[i], runs));
    return 0;
}
