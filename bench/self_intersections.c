/* How long it takes to look for self-intersections: of a bumpy torus of a million triangles, its vertices and faces in
 * order and shuffled, and of mesh files. usage: self_intersections [--runs N] [FILE ...] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "hewn/check.h"
#include "hewn/io.h"
#include "samples.h"

enum { AROUND = 1000, ACROSS = 500 };

static void stop(const char *what)
{
    fprintf(stderr, "self_intersections: %s\n", what);
    exit(1);
}

static hewn_triangles make_torus(void)
{
    hewn_triangles mesh = {.vertex_count = AROUND * ACROSS, .triangle_count = 2 * AROUND * ACROSS};
    mesh.positions = hewn_alloc(mesh.vertex_count, 3 * sizeof(float));
    mesh.indices = hewn_alloc(mesh.triangle_count, 3 * sizeof(uint32_t));
    if (!mesh.positions || !mesh.indices)
        stop("out of memory");
    for (uint32_t i = 0; i < AROUND; i++)
        for (uint32_t j = 0; j < ACROSS; j++) {
            double u = 2 * M_PI * i / AROUND, v = 2 * M_PI * j / ACROSS;
            double tube = 0.3 * (1 + 0.1 * sin(40 * u) * sin(20 * v)), radius = 1 + tube * cos(v);
            uint32_t a = i * ACROSS + j, b = (i + 1) % AROUND * ACROSS + j;
            uint32_t c = (i + 1) % AROUND * ACROSS + (j + 1) % ACROSS, d = i * ACROSS + (j + 1) % ACROSS;
            float *p = mesh.positions + 3 * (size_t)a;
            p[0] = (float)(radius * cos(u));
            p[1] = (float)(radius * sin(u));
            p[2] = (float)(tube * sin(v));
            memcpy(mesh.indices + 6 * (size_t)a, (uint32_t[]){a, b, c, a, c, d}, 6 * sizeof(uint32_t));
        }
    return mesh;
}

/* Vertices and faces out of order, as worst for the caches. */
static void shuffle(hewn_triangles *mesh)
{
    uint32_t *number = hewn_alloc(mesh->vertex_count, sizeof *number);
    float *positions = hewn_alloc(mesh->vertex_count, 3 * sizeof *positions);
    if (!number || !positions)
        stop("out of memory");
    uint64_t state = 1;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t other = (uint32_t)(((state = state * 6364136223846793005u + 1) >> 33) % (v + 1));
        number[v] = number[other];
        number[other] = v;
    }
    for (uint64_t v = 0; v < mesh->vertex_count; v++)
        memcpy(positions + 3 * (size_t)number[v], mesh->positions + 3 * v, 3 * sizeof *positions);
    hewn_free(mesh->positions);
    mesh->positions = positions;
    for (uint64_t i = 0; i < 3 * mesh->triangle_count; i++)
        mesh->indices[i] = number[mesh->indices[i]];
    for (uint64_t t = mesh->triangle_count - 1; t > 0; t--) {
        uint64_t other = ((state = state * 6364136223846793005u + 1) >> 33) % (t + 1);
        uint32_t held[3];
        memcpy(held, mesh->indices + 3 * t, sizeof held);
        memmove(mesh->indices + 3 * t, mesh->indices + 3 * other, sizeof held);
        memcpy(mesh->indices + 3 * other, held, sizeof held);
    }
    hewn_free(number);
}

/* The best of several runs. */
static void measure(const char *name, const hewn_triangles *mesh, int runs)
{
    double wall = INFINITY, processor = INFINITY;
    uint64_t found = 0;
    for (int run = 0; run < runs; run++) {
        hewn_error error = {0};
        double began = hewn_clock_now(), spent = bench_processor_now();
        if (hewn_triangles_count_self_intersections(mesh, 0, NULL, NULL, &found, &error) != HEWN_OK)
            stop(error.message);
        wall = fmin(wall, hewn_clock_now() - began);
        processor = fmin(processor, bench_processor_now() - spent);
    }
    printf("%-40s %9llu triangles %9llu pairs %8.3f s %8.3f s of processor\n", name,
           (unsigned long long)mesh->triangle_count, (unsigned long long)found, wall, processor);
}

int main(int count, char **arguments)
{
    int runs = 3, first = 1;
    if (count > 2 && strcmp(arguments[1], "--runs") == 0) {
        runs = (int)strtol(arguments[2], NULL, 10);
        first = 3;
    }
    if (runs < 1 || runs > MOST_RUNS)
        stop("--runs takes 1 to 99");
    hewn_triangles torus = make_torus();
    measure("torus", &torus, runs);
    shuffle(&torus);
    measure("torus, shuffled", &torus, runs);
    hewn_triangles_destroy(&torus);
    for (int k = first; k < count; k++) {
        hewn_triangles mesh;
        hewn_error error = {0};
        if (hewn_triangles_read(arguments[k], &mesh, &error) != HEWN_OK)
            stop(error.message);
        measure(arguments[k], &mesh, runs);
        hewn_triangles_destroy(&mesh);
    }
    return 0;
}
