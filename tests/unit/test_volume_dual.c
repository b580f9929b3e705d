/* Surface nets of volumes: whatever the samples are, a closed manifold with a quad around each crossed edge of the
 * lattice, whose corners lie in the four cells there and which faces out; no two vertices at one place. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../oracle/random_grid.h"
#include "hewn/mesh.h"
#include "hewn/volume_extract.h"

enum { X = 9, Y = 7, Z = 8, COUNT = X * Y * Z };

typedef struct random_volume {
    hewn_volume volume;
    float samples[COUNT];
} random_volume;

static void make_volume(random_volume *out, random_kind kind, uint64_t seed)
{
    static const uint32_t dims[3] = {X, Y, Z};
    uint64_t random = seed + 1;
    *out = (random_volume){.volume = {.frame_count = 1, .type = HEWN_VOXEL_FLOAT, .slope = 1}};
    memcpy(out->volume.dims, dims, sizeof dims);
    out->volume.samples = out->samples;
    for (int i = 0; i < 16; i++)
        out->volume.to_world[i] = i % 5 == 0;
    for (int i = 0; i < COUNT; i++)
        out->samples[i] = (float)random_value(&random, kind);
}

/* Whether a sample is inside; what is past the last ones is not. */
static bool is_inside(const random_volume *of, bool above, const int at[3])
{
    static const int dims[3] = {X, Y, Z};
    for (int axis = 0; axis < 3; axis++)
        if (at[axis] < 0 || at[axis] >= dims[axis])
            return false;
    const float sample = of->samples[at[0] + X * (at[1] + Y * at[2])];
    return above ? sample >= 0 : sample < 0;
}

/* --- quads -------------------------------------------------------------------------------------------------------- */

/* The four corners of a quad in order, from its two triangles: the corner that only the first has, then around. */
static void find_corners(const uint32_t *triangles, uint32_t out[4])
{
    for (int c = 0; c < 3; c++) {
        bool shared = false;
        for (int d = 3; d < 6; d++)
            shared |= triangles[d] == triangles[c];
        if (shared)
            continue;
        for (int step = 0; step < 2; step++)
            out[step] = triangles[(c + step) % 3];
        out[3] = triangles[(c + 2) % 3];
        out[2] = UINT32_MAX;
        for (int d = 3; d < 6; d++)
            if (triangles[d] != out[1] && triangles[d] != out[3])
                out[2] = triangles[d];
        assert_true(out[2] != UINT32_MAX);
        return;
    }
    fail_msg("two triangles of a quad are the same");
}

/* The quad around the edge from `at` on: its corners are in four different cells that have the edge, and go around it
 * counter-clockwise seen from outside. */
static void check_quad(const hewn_triangles *mesh, const uint32_t *triangles, const int at[3], int axis, bool inside)
{
    uint32_t corners[4] = {0}, seen = 0;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double turn = 0;
    find_corners(triangles, corners);
    for (int c = 0; c < 4; c++) {
        const float *p = mesh->positions + 3 * (size_t)corners[c];
        const float *q = mesh->positions + 3 * (size_t)corners[(c + 1) % 4];
        const int side[2] = {(double)p[u] > at[u], (double)p[v] > at[v]};
        seen |= 1u << (side[0] + 2 * side[1]);
        for (int a = 0; a < 3; a++) {
            const int cell = (int)floorf(p[a]);
            assert_int_equal(cell, a == axis ? at[a] : at[a] - 1 + side[a == u ? 0 : 1]);
            assert_true(p[a] != floorf(p[a])); /* within the cell, not on its face */
        }
        turn += ((double)p[u] - at[u]) * ((double)q[v] - at[v]) - ((double)p[v] - at[v]) * ((double)q[u] - at[u]);
    }
    assert_int_equal(seen, 15);
    assert_true(inside ? turn > 0 : turn < 0);
}

/* All edges in the order of quads. Returns how many are crossed. */
static uint64_t check_quads(const random_volume *of, bool above, const hewn_triangles *mesh)
{
    static const int dims[3] = {X, Y, Z};
    uint64_t quads = 0;
    int at[3];
    for (at[2] = -1; at[2] <= Z; at[2]++)
        for (at[1] = -1; at[1] <= Y; at[1]++)
            for (int axis = 0; axis < 3; axis++)
                for (at[0] = -1; at[0] <= X; at[0]++) {
                    int next[3] = {at[0], at[1], at[2]};
                    next[axis]++;
                    const bool inside = is_inside(of, above, at);
                    if (at[axis] == dims[axis] || inside == is_inside(of, above, next))
                        continue;
                    assert_true(2 * quads + 1 < mesh->triangle_count);
                    check_quad(mesh, mesh->indices + 6 * quads++, at, axis, inside);
                }
    return quads;
}

/* --- the mesh ----------------------------------------------------------------------------------------------------- */

static int by_place(const void *a, const void *b)
{
    return memcmp(a, b, 3 * sizeof(float));
}

static void assert_distinct(const hewn_triangles *mesh)
{
    float *sorted = malloc(12 * mesh->vertex_count);
    assert_non_null(sorted);
    memcpy(sorted, mesh->positions, 12 * mesh->vertex_count);
    for (uint64_t i = 0; i < 3 * mesh->vertex_count; i++)
        sorted[i] += 0.0f; /* one zero */
    qsort(sorted, mesh->vertex_count, 12, by_place);
    for (uint64_t v = 1; v < mesh->vertex_count; v++)
        assert_memory_not_equal(sorted + 3 * v - 3, sorted + 3 * v, 12);
    free(sorted);
}

static hewn_triangles make_nets(const hewn_volume *volume, const hewn_volume_extract_desc *desc, hewn_certificate *out)
{
    hewn_triangles mesh;
    hewn_error error = {0};
    if (hewn_volume_extract(volume, desc, &mesh, NULL, &error) != HEWN_OK ||
        hewn_certify(&mesh, NULL, out, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    assert_true(out->closed && out->manifold && out->oriented && out->volume > 0);
    assert_distinct(&mesh);
    return mesh;
}

static void test_random_volumes(void **state)
{
    (void)state;
    static random_volume of;
    uint64_t seeds = getenv("HEWN_LONG") ? 3000 : 60;
    for (uint64_t seed = 0; seed < seeds; seed++) {
        const bool above = seed / 4 % 2;
        make_volume(&of, (random_kind)(seed % RANDOM_KINDS), seed);
        const hewn_volume_extract_desc desc = {.method = HEWN_METHOD_NETS,
                                               .inside = above ? HEWN_INSIDE_ABOVE : HEWN_INSIDE_BELOW};
        hewn_certificate certificate;
        hewn_triangles mesh = make_nets(&of.volume, &desc, &certificate);
        assert_int_equal(2 * check_quads(&of, above, &mesh), mesh.triangle_count);
        hewn_triangles_destroy(&mesh);
    }
}

/* As far away as floats allow, mirrored, sheared: nothing falls together. */
static void test_far_away(void **state)
{
    (void)state;
    static random_volume of;
    static const double place[16] = {-1, 0.25, 0, 100000, 0, 1.5, 0.5, -40000, 0, 0, 2, 7, 0, 0, 0, 1};
    for (uint64_t seed = 0; seed < 12; seed++) {
        make_volume(&of, (random_kind)(seed % RANDOM_KINDS), 500 + seed);
        for (int i = 0; i < COUNT && seed % 3 == 0; i += 2)
            of.samples[i] *= 1e-6f; /* crossings that are next to samples */
        const hewn_volume_extract_desc desc = {.method = HEWN_METHOD_NETS, .place = place};
        hewn_certificate certificate;
        hewn_triangles mesh = make_nets(&of.volume, &desc, &certificate);
        hewn_triangles_destroy(&mesh);
    }
}

static void test_same_bytes_for_any_threads(void **state)
{
    (void)state;
    static random_volume of;
    hewn_triangles first = {0};
    hewn_certificate certificate;
    make_volume(&of, RANDOM_NORMAL, 42);
    const hewn_volume_extract_desc desc = {.method = HEWN_METHOD_NETS};
    for (int threads = 1; threads <= 4; threads++) {
        omp_set_num_threads(threads);
        hewn_triangles mesh = make_nets(&of.volume, &desc, &certificate);
        if (threads == 1) {
            first = mesh;
            continue;
        }
        assert_int_equal(mesh.vertex_count, first.vertex_count);
        assert_memory_equal(mesh.positions, first.positions, 12 * mesh.vertex_count);
        assert_memory_equal(mesh.normals, first.normals, 12 * mesh.vertex_count);
        assert_memory_equal(mesh.indices, first.indices, 12 * mesh.triangle_count);
        hewn_triangles_destroy(&mesh);
    }
    hewn_triangles_destroy(&first);
}

/* --- shapes ------------------------------------------------------------------------------------------------------- */

enum { SIDE = 26 };
static float ball[SIDE * SIDE * SIDE];

/* Distances, inside below 0: a ball with a hollow, and a smaller one beside it. */
static hewn_volume make_balls(bool hollow)
{
    hewn_volume out = {
        .dims = {SIDE, SIDE, SIDE}, .frame_count = 1, .type = HEWN_VOXEL_FLOAT, .samples = ball, .slope = 1};
    for (int i = 0; i < 16; i++)
        out.to_world[i] = i % 5 == 0;
    for (int n = 0; n < SIDE * SIDE * SIDE; n++) {
        const double at[3] = {n % SIDE - 10.2, n / SIDE % SIDE - 10.4, n / SIDE / SIDE - 10.1};
        const double off = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
        const double far = sqrt(pow(at[0] - 12, 2) + pow(at[1] - 12, 2) + pow(at[2] - 12, 2)) - 2.5;
        ball[n] = (float)fmin(hollow ? fmax(off - 9, 3 - off) : off - 9, far);
    }
    return out;
}

static void test_ball(void **state)
{
    (void)state;
    static const hewn_body_choice largest = {.largest = 1}, filled = {.largest = 1, .fill_cavities = true};
    hewn_volume volume = make_balls(true);
    hewn_volume_extract_desc desc = {.method = HEWN_METHOD_NETS, .inside = HEWN_INSIDE_BELOW};
    hewn_certificate certificate;
    hewn_triangles mesh = make_nets(&volume, &desc, &certificate);
    assert_int_equal(certificate.components, 3);
    hewn_triangles_destroy(&mesh);
    desc.keep = &largest;
    mesh = make_nets(&volume, &desc, &certificate);
    assert_int_equal(certificate.components, 2);
    hewn_triangles_destroy(&mesh);
    desc.keep = &filled;
    mesh = make_nets(&volume, &desc, &certificate);
    assert_int_equal(certificate.components, 1);
    assert_int_equal(certificate.genus, 0);
    assert_true(fabs(certificate.volume / (4.0 / 3 * 3.14159265358979 * 729) - 1) < 0.02);
    for (uint64_t v = 0; v < mesh.vertex_count; v++) {
        const float *p = mesh.positions + 3 * v, *n = mesh.normals + 3 * v;
        const double at[3] = {(double)p[0] - 10.2, (double)p[1] - 10.4, (double)p[2] - 10.1};
        const double off = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
        const double out = ((double)n[0] * at[0] + (double)n[1] * at[1] + (double)n[2] * at[2]) / off;
        assert_true(fabs(off - 9) < 0.1);
        assert_true(out > 0.995 && out < 1.00001);
    }
    hewn_triangles_destroy(&mesh);
}

/* --- what is refused ---------------------------------------------------------------------------------------------- */

static hewn_result take(void *user, const hewn_mesh_part *part, hewn_error *error)
{
    (void)user;
    (void)part;
    (void)error;
    return HEWN_OK;
}

static void test_refused(void **state)
{
    (void)state;
    hewn_volume volume = make_balls(false);
    hewn_triangles mesh;
    hewn_error error = {0};
    const hewn_mesh_sink sink = {.take = take};
    hewn_volume_extract_desc desc = {.method = HEWN_METHOD_NETS, .open = true};
    assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, NULL, &error), HEWN_INVALID_ARGUMENT);
    assert_non_null(strstr(error.message, "nets"));
    desc.open = false;
    assert_int_equal(hewn_volume_extract_parts(&volume, &desc, &sink, NULL, &error), HEWN_INVALID_ARGUMENT);
    assert_non_null(strstr(error.message, "nets"));
    desc.iso = -100;
    desc.inside = HEWN_INSIDE_BELOW;
    assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, NULL, &error), HEWN_BAD_INPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_volumes),
        cmocka_unit_test(test_far_away),
        cmocka_unit_test(test_same_bytes_for_any_threads),
        cmocka_unit_test(test_ball),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
