/* Bodies and cavities: what extraction says from the order of crossings, against winding numbers of the shells. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "hewn/volume_extract.h"

enum { N = 15, COUNT = N * N * N, MOST = 1024 };

static double unit(uint64_t *random)
{
    *random = *random * 6364136223846793005u + 1442695040888963407u;
    return (double)(*random >> 11) * 0x1p-53;
}

/* Concentric layers around a middle, torn by noise: bodies in cavities in bodies. */
static void make(uint64_t seed, double noise, float *samples)
{
    uint64_t random = seed;
    double middle[3], pitch = 1.5 + 0.5 * unit(&random);
    for (int axis = 0; axis < 3; axis++)
        middle[axis] = N / 2 + 2 * unit(&random) - 1;
    for (int n = 0; n < COUNT; n++) {
        double at[3] = {n % N, n / N % N, n / (N * N)}, sum = 0;
        for (int axis = 0; axis < 3; axis++)
            sum += (at[axis] - middle[axis]) * (at[axis] - middle[axis]);
        samples[n] = (float)(cos(sqrt(sum) * 3.14159265 / pitch) + noise * (2 * unit(&random) - 1));
    }
}

static hewn_volume volume_of(float *samples, uint32_t i, uint32_t j, uint32_t k)
{
    return (hewn_volume){.dims = {i, j, k},
                         .frame_count = 1,
                         .type = HEWN_VOXEL_FLOAT,
                         .samples = samples,
                         .slope = 1,
                         .to_world = {2, 0, 0, 5, 0, -1, 0.5, 0, 0, 0, 1.5, -7, 0, 0, 0, 1}};
}

/* --- shells, from the mesh alone ---------------------------------------------------------------------------------- */

typedef struct shells {
    uint32_t count, of[1 << 16]; /* of each vertex */
    uint32_t vertex[MOST];       /* one of each shell */
    double volume[MOST];         /* enclosed, without a sign */
    uint32_t depth[MOST], parent[MOST];
    double body[MOST]; /* of hulls, less cavities */
} shells;

static uint32_t root(uint32_t *of, uint32_t v)
{
    while (of[v] != v)
        v = of[v];
    return v;
}

static const float *corner(const hewn_triangles *mesh, uint64_t at)
{
    return mesh->positions + 3 * (size_t)mesh->indices[at];
}

static double det(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether a shell winds around a point (Van Oosterom and Strackee 1983). */
static bool winds(const hewn_triangles *mesh, const shells *all, uint32_t shell, const float *point)
{
    double sum = 0;
    for (uint64_t t = 0; t < 3 * mesh->triangle_count; t += 3) {
        double p[3][3], length[3];
        if (all->of[mesh->indices[t]] != shell)
            continue;
        for (uint64_t c = 0; c < 3; c++) {
            for (int axis = 0; axis < 3; axis++)
                p[c][axis] = (double)corner(mesh, t + c)[axis] - (double)point[axis];
            length[c] = sqrt(dot(p[c], p[c]));
        }
        sum += 2 * atan2(det(p[0], p[1], p[2]), length[0] * length[1] * length[2] + dot(p[0], p[1]) * length[2] +
                                                    dot(p[1], p[2]) * length[0] + dot(p[2], p[0]) * length[1]);
    }
    return fabs(sum) > 6.28;
}

static void find(const hewn_triangles *mesh, shells *all)
{
    assert_in_range(mesh->vertex_count, 1, 1 << 16);
    all->count = 0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        all->of[v] = v;
    for (uint64_t c = 0; c < 3 * mesh->triangle_count; c++) {
        uint32_t a = root(all->of, mesh->indices[c]), b = root(all->of, mesh->indices[c - c % 3]);
        all->of[a > b ? a : b] = a > b ? b : a;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t r = root(all->of, v);
        if (r == v) {
            assert_true(all->count < MOST);
            all->vertex[all->count] = v;
            all->volume[all->count++] = 0;
        }
    }
    for (uint32_t v = (uint32_t)mesh->vertex_count; v-- > 0;) /* from above: roots stay until they are asked for */
        all->of[v] = root(all->of, v);
    for (uint32_t s = 0; s < all->count; s++)
        for (uint32_t v = 0; v < mesh->vertex_count; v++)
            if (v != all->vertex[s] && all->of[v] == all->vertex[s])
                all->of[v] = 0x80000000u | s;
    for (uint32_t s = 0; s < all->count; s++)
        all->of[all->vertex[s]] = 0x80000000u | s;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        all->of[v] &= 0x7FFFFFFFu;
    for (uint64_t t = 0; t < 3 * mesh->triangle_count; t += 3) {
        double p[3][3];
        for (uint64_t c = 0; c < 3; c++)
            for (int axis = 0; axis < 3; axis++)
                p[c][axis] = (double)corner(mesh, t + c)[axis];
        all->volume[all->of[mesh->indices[t]]] += det(p[0], p[1], p[2]) / 6;
    }
    for (uint32_t s = 0; s < all->count; s++)
        all->volume[s] = fabs(all->volume[s]);
}

/* Shells within an even number of others are hulls. The deepest of those around is the parent. */
static void nest(const hewn_triangles *mesh, shells *all)
{
    static bool around[MOST][MOST];
    for (uint32_t s = 0; s < all->count; s++) {
        all->depth[s] = 0;
        for (uint32_t other = 0; other < all->count; other++) {
            around[s][other] = other != s && all->volume[other] > all->volume[s] &&
                               winds(mesh, all, other, mesh->positions + 3 * (size_t)all->vertex[s]);
            all->depth[s] += around[s][other];
        }
    }
    for (uint32_t s = 0; s < all->count; s++) {
        all->parent[s] = MOST;
        for (uint32_t other = 0; other < all->count; other++)
            if (around[s][other] && all->depth[other] + 1 == all->depth[s])
                all->parent[s] = other;
    }
    for (uint32_t s = 0; s < all->count; s++)
        all->body[s] = all->volume[s];
    for (uint32_t s = 0; s < all->count; s++)
        if (all->depth[s] % 2 == 1)
            all->body[all->parent[s]] -= all->volume[s];
}

/* --- against them ------------------------------------------------------------------------------------------------- */

typedef struct expectation {
    uint64_t hulls, cavities, vertices;
    double volume;
} expectation;

static expectation expect(const hewn_triangles *mesh, const shells *all, const hewn_body_choice *choice)
{
    static bool kept[MOST];
    expectation out = {0};
    for (uint32_t s = 0; s < all->count; s++) {
        uint64_t larger = 0;
        for (uint32_t other = 0; other < all->count; other++)
            larger += all->depth[other] % 2 == 0 && all->body[other] > all->body[s];
        kept[s] = all->depth[s] % 2 == 0 && (choice->largest == 0 || larger < choice->largest) &&
                  (choice->least_volume == 0 || all->body[s] >= choice->least_volume);
    }
    for (uint32_t s = 0; s < all->count; s++)
        if (all->depth[s] % 2 == 1)
            kept[s] = kept[all->parent[s]] && !choice->fill_cavities;
    for (uint32_t depth = 2; choice->fill_cavities && depth < 16; depth += 2)
        for (uint32_t s = 0; s < all->count; s++)
            if (all->depth[s] == depth)
                for (uint32_t up = all->parent[s]; up != MOST; up = all->parent[up])
                    kept[s] = kept[s] && (all->depth[up] % 2 == 1 || !kept[up]);
    for (uint32_t s = 0; s < all->count; s++) {
        bool cavity = all->depth[s] % 2 == 1;
        out.hulls += kept[s] && !cavity;
        out.cavities += kept[s] && cavity;
        out.volume += !kept[s] ? 0 : cavity ? -all->volume[s] : all->volume[s];
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        out.vertices += kept[all->of[v]];
    return out;
}

static double signed_volume(const hewn_triangles *mesh)
{
    double sum = 0;
    for (uint64_t t = 0; t < 3 * mesh->triangle_count; t += 3) {
        double p[3][3];
        for (uint64_t c = 0; c < 3; c++)
            for (int axis = 0; axis < 3; axis++)
                p[c][axis] = (double)corner(mesh, t + c)[axis];
        sum += det(p[0], p[1], p[2]) / 6;
    }
    return sum;
}

static void check(const hewn_volume *volume, const hewn_volume_extract_desc *desc, const hewn_triangles *whole,
                  const shells *all, const hewn_body_choice *choice)
{
    expectation wanted = expect(whole, all, choice);
    hewn_volume_extract_desc with = *desc;
    hewn_volume_extract_stats stats;
    hewn_triangles mesh;
    hewn_error error = {0};
    with.keep = choice;
    hewn_result result = hewn_volume_extract(volume, &with, &mesh, &stats, &error);
    if (wanted.hulls == 0) {
        assert_int_equal(result, HEWN_BAD_INPUT);
        assert_non_null(strstr(error.message, "as large as that"));
        return;
    }
    assert_int_equal(result, HEWN_OK);
    assert_int_equal(stats.bodies.bodies + stats.bodies.cavities, all->count);
    assert_int_equal(stats.bodies.kept_bodies, wanted.hulls);
    assert_int_equal(stats.bodies.kept_cavities, wanted.cavities);
    assert_int_equal(mesh.vertex_count, wanted.vertices);
    assert_true(fabs(signed_volume(&mesh) - wanted.volume) < 1e-3);
    uint64_t at = 0; /* what is left is in its order */
    for (uint64_t v = 0; v < mesh.vertex_count; v++) {
        while (at < whole->vertex_count && memcmp(mesh.positions + 3 * v, whole->positions + 3 * at, 12) != 0)
            at++;
        assert_true(at < whole->vertex_count);
        assert_memory_equal(mesh.normals + 3 * v, whole->normals + 3 * at, 12);
    }
    hewn_triangles_destroy(&mesh);
}

static void test_random_volumes(void **state)
{
    (void)state;
    static float samples[COUNT];
    static shells all;
    uint32_t trials = getenv("HEWN_LONG") ? 400 : 10;
    uint64_t deepest = 0;
    for (uint32_t trial = 0; trial < trials; trial++) {
        make(trial + 1, 0.25 * (trial % 6), samples);
        hewn_volume volume = volume_of(samples, N, N, N);
        hewn_volume_extract_desc desc = {.iso = 0.1,
                                         .method = trial % 3 == 2 ? HEWN_METHOD_MARCHING_CUBES : HEWN_METHOD_MC33,
                                         .inside = trial % 5 == 4 ? HEWN_INSIDE_BELOW : HEWN_INSIDE_ABOVE};
        hewn_triangles whole;
        assert_int_equal(hewn_volume_extract(&volume, &desc, &whole, NULL, NULL), HEWN_OK);
        find(&whole, &all);
        nest(&whole, &all);
        for (uint32_t s = 0; s < all.count; s++)
            deepest = all.depth[s] > deepest ? all.depth[s] : deepest;
        for (uint32_t n = 0; n < 16; n++) {
            hewn_body_choice choice = {.largest = n & 1 ? 1 + n / 4 : 0,
                                       .least_volume = n & 2 ? 0.7 * (double)(1u << n / 2) : 0,
                                       .fill_cavities = n & 4};
            check(&volume, &desc, &whole, &all, &choice);
        }
        hewn_triangles_destroy(&whole);
    }
    assert_true(deepest >= 4); /* bodies in cavities of bodies in cavities */
}

/* Vertices of the cap that are left are counted anew: a corner block and one in the middle. */
static void test_cap_of_what_is_left(void **state)
{
    (void)state;
    float samples[8 * 8 * 8] = {0};
    hewn_volume volume = volume_of(samples, 8, 8, 8);
    hewn_volume_extract_stats whole, left;
    hewn_triangles mesh;
    for (int n = 0; n < 8; n++)
        samples[n % 2 + 8 * (n / 2 % 2) + 64 * (n / 4)] = 1;
    hewn_volume_extract_desc desc = {.iso = 0.5};
    assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, &whole, NULL), HEWN_OK);
    hewn_triangles_destroy(&mesh);
    for (int n = 0; n < 27; n++)
        samples[3 + n % 3 + 8 * (3 + n / 3 % 3) + 64 * (3 + n / 9)] = 1;
    hewn_body_choice choice = {.largest = 1};
    desc.keep = &choice;
    assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, &left, NULL), HEWN_OK);
    hewn_triangles_destroy(&mesh);
    assert_true(whole.cap_vertices > 0);
    assert_int_equal(left.cap_vertices, 0);
    samples[7 + 8 * 7 + 64 * 7] = 1; /* and one that goes, at the other corner */
    choice.largest = 2;
    assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, &left, NULL), HEWN_OK);
    hewn_triangles_destroy(&mesh);
    assert_int_equal(left.cap_vertices, whole.cap_vertices);
    assert_int_equal(left.bodies.bodies, 3);
}

static void test_requests_that_make_no_sense(void **state)
{
    (void)state;
    float samples[8] = {0, 0, 0, 0, 0, 0, 0, 1};
    hewn_volume volume = volume_of(samples, 2, 2, 2);
    hewn_body_choice choice = {.largest = 1};
    hewn_volume_extract_desc desc = {.iso = 0.5, .keep = &choice, .open = true};
    hewn_triangles mesh;
    assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, NULL, NULL), HEWN_INVALID_ARGUMENT);
    desc.open = false;
    choice.least_volume = NAN;
    assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, NULL, NULL), HEWN_INVALID_ARGUMENT);
    assert_null(mesh.positions);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_volumes),
                                       cmocka_unit_test(test_cap_of_what_is_left),
                                       cmocka_unit_test(test_requests_that_make_no_sense)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
