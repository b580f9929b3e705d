/* Shared by the tests of meshes and mesh files: a seeded generator, and meshes that are known. */
#ifndef HEWN_TEST_MESH_SUPPORT_H
#define HEWN_TEST_MESH_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/alloc.h"
#include "hewn/triangles.h"
#include "test_data.h"

typedef struct random_state {
    uint64_t at;
} random_state;

static inline uint64_t random_bits(random_state *random)
{
    uint64_t z = random->at += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static inline uint32_t random_below(random_state *random, uint32_t count)
{
    return (uint32_t)(random_bits(random) % count);
}

static inline double random_unit(random_state *random)
{
    return (double)(random_bits(random) >> 11) * 0x1p-53;
}

/* Any finite float, also denormal and -0. */
static inline float random_float(random_state *random)
{
    for (;;) {
        uint32_t bits = (uint32_t)random_bits(random);
        float value;
        memcpy(&value, &bits, sizeof value);
        if (isfinite(value))
            return value;
    }
}

static inline hewn_triangles make_mesh(uint64_t vertices, uint64_t triangles)
{
    hewn_triangles mesh = {.vertex_count = vertices, .triangle_count = triangles};
    mesh.positions = hewn_alloc_zero(vertices, 3 * sizeof(float));
    mesh.indices = hewn_alloc_zero(triangles, 3 * sizeof(uint32_t));
    assert_non_null(mesh.positions);
    assert_non_null(mesh.indices);
    return mesh;
}

static inline void set_triangle(hewn_triangles *mesh, uint64_t t, uint32_t a, uint32_t b, uint32_t c)
{
    mesh->indices[3 * t] = a;
    mesh->indices[3 * t + 1] = b;
    mesh->indices[3 * t + 2] = c;
}

static inline void set_vertex(hewn_triangles *mesh, uint64_t v, double x, double y, double z)
{
    mesh->positions[3 * v] = (float)x;
    mesh->positions[3 * v + 1] = (float)y;
    mesh->positions[3 * v + 2] = (float)z;
}

/* From literals: positions and indices are copied. */
static inline hewn_triangles make_from(const float *positions, uint64_t vertices, const uint32_t *indices,
                                       uint64_t triangles)
{
    hewn_triangles mesh = make_mesh(vertices, triangles);
    memcpy(mesh.positions, positions, vertices * 3 * sizeof(float));
    if (triangles > 0)
        memcpy(mesh.indices, indices, triangles * 3 * sizeof(uint32_t));
    return mesh;
}

/* The cube from 0 to 1, corners numbered by their bits. */
static inline hewn_triangles make_cube(void)
{
    static const uint32_t indices[] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                       2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    hewn_triangles mesh = make_mesh(8, 12);
    for (uint32_t v = 0; v < 8; v++)
        set_vertex(&mesh, v, v & 1, v >> 1 & 1, v >> 2 & 1);
    memcpy(mesh.indices, indices, sizeof indices);
    return mesh;
}

/* A ring around z, radii 1 and 0.3, of n × m quads cut in two; with unit normals. */
static inline hewn_triangles make_torus(uint32_t n, uint32_t m)
{
    hewn_triangles mesh = make_mesh((uint64_t)n * m, 2ull * n * m);
    mesh.normals = hewn_alloc((size_t)n * m, 3 * sizeof(float));
    assert_non_null(mesh.normals);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++) {
            double u = 2 * M_PI * i / n, v = 2 * M_PI * j / m, radius = 1 + 0.3 * cos(v);
            uint32_t a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m, d = i * m + (j + 1) % m;
            set_vertex(&mesh, a, radius * cos(u), radius * sin(u), 0.3 * sin(v));
            mesh.normals[3 * a] = (float)(cos(v) * cos(u));
            mesh.normals[3 * a + 1] = (float)(cos(v) * sin(u));
            mesh.normals[3 * a + 2] = (float)sin(v);
            set_triangle(&mesh, 2 * (uint64_t)a, a, b, c);
            set_triangle(&mesh, 2 * (uint64_t)a + 1, a, c, d);
        }
    return mesh;
}

/* Two poles joined by a ring of n vertices: closed, with two vertices of n triangles. */
static inline hewn_triangles make_bipyramid(uint32_t n)
{
    hewn_triangles mesh = make_mesh(n + 2ull, 2ull * n);
    set_vertex(&mesh, n, 0, 0, 1);
    set_vertex(&mesh, n + 1ull, 0, 0, -1);
    for (uint32_t i = 0; i < n; i++) {
        set_vertex(&mesh, i, cos(2 * M_PI * i / n), sin(2 * M_PI * i / n), 0);
        set_triangle(&mesh, 2 * (uint64_t)i, i, (i + 1) % n, n);
        set_triangle(&mesh, 2 * (uint64_t)i + 1, (i + 1) % n, i, n + 1);
    }
    return mesh;
}

/* Both meshes in one, the second moved along x; takes them over. Normals are left behind. */
static inline hewn_triangles join_meshes(hewn_triangles a, hewn_triangles b, double move)
{
    hewn_triangles mesh = make_mesh(a.vertex_count + b.vertex_count, a.triangle_count + b.triangle_count);
    for (uint64_t v = 0; v < mesh.vertex_count; v++) {
        const float *p = v < a.vertex_count ? a.positions + 3 * v : b.positions + 3 * (v - a.vertex_count);
        set_vertex(&mesh, v, (double)p[0] + (v < a.vertex_count ? 0 : move), (double)p[1], (double)p[2]);
    }
    for (uint64_t i = 0; i < 3 * mesh.triangle_count; i++)
        mesh.indices[i] =
            i < 3 * a.triangle_count ? a.indices[i] : b.indices[i - 3 * a.triangle_count] + (uint32_t)a.vertex_count;
    hewn_triangles_destroy(&a);
    hewn_triangles_destroy(&b);
    return mesh;
}

/* Renumbers vertices, reorders triangles and turns their corners; the surface stays the same. */
static inline void shuffle_mesh(hewn_triangles *mesh, random_state *random)
{
    uint32_t *number = hewn_alloc(mesh->vertex_count, sizeof *number);
    float *positions = hewn_alloc(mesh->vertex_count, 3 * sizeof(float));
    assert_non_null(number);
    assert_non_null(positions);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t other = random_below(random, v + 1);
        number[v] = number[other];
        number[other] = v;
    }
    for (uint64_t v = 0; v < mesh->vertex_count; v++)
        memcpy(positions + 3 * (size_t)number[v], mesh->positions + 3 * v, 3 * sizeof(float));
    hewn_free(mesh->positions);
    mesh->positions = positions;
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        uint64_t other = random_bits(random) % (t + 1);
        uint32_t turn = random_below(random, 3), corner[3], moved[3];
        for (uint32_t k = 0; k < 3; k++)
            corner[(k + turn) % 3] = number[mesh->indices[3 * t + k]];
        memcpy(moved, mesh->indices + 3 * other, sizeof moved);
        if (other != t)
            memcpy(mesh->indices + 3 * t, moved, sizeof moved);
        memcpy(mesh->indices + 3 * other, corner, sizeof corner);
    }
    hewn_free(number);
}

/* A folder for one test, removed by whoever made it. */
static inline void make_folder(char path[64])
{
    snprintf(path, 64, "/tmp/hewn-test-XXXXXX");
    assert_non_null(mkdtemp(path));
}

#endif
