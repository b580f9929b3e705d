/* Surface nets and dual contouring of volumes: whatever the samples are, a manifold with a quad around each crossed
 * edge of the lattice, whose corners lie in the four cells there, or on the bounds of an open one, and which faces out;
 * no two vertices at one place. */
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
#include "geom/near_triangle.h"
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

static const hewn_method methods[] = {HEWN_METHOD_NETS, HEWN_METHOD_DC};

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

/* A vertex of the quad around the edge from `at` on: which of the four cells there it is in, seen along an axis across.
 * On the bounds of an open mesh it stands for a cell beyond them. */
static int side_of(const float *p, const int at[3], int axis, bool open)
{
    static const int dims[3] = {X, Y, Z};
    const bool on_bounds = open && (p[axis] == 0.0f || p[axis] == (float)(dims[axis] - 1));
    const int side = on_bounds ? at[axis] > 0 : (double)p[axis] > at[axis];
    if (on_bounds)
        assert_true((float)at[axis] == p[axis]);
    else
        assert_int_equal((int)floorf(p[axis]), at[axis] - 1 + side);
    assert_true(on_bounds || p[axis] != floorf(p[axis])); /* within the cell, not on its face */
    return side;
}

/* The corners of the quad are in four different cells that have the edge, and go around it counter-clockwise seen from
 * outside. */
static void check_quad(const hewn_triangles *mesh, const uint32_t *triangles, const int at[3], int axis, bool inside,
                       bool open)
{
    uint32_t corners[4] = {0}, seen = 0;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double turn = 0;
    find_corners(triangles, corners);
    for (int c = 0; c < 4; c++) {
        const float *p = mesh->positions + 3 * (size_t)corners[c];
        const float *q = mesh->positions + 3 * (size_t)corners[(c + 1) % 4];
        seen |= 1u << (side_of(p, at, u, open) + 2 * side_of(p, at, v, open));
        assert_int_equal((int)floorf(p[axis]), at[axis]);
        assert_true(p[axis] != floorf(p[axis]));
        turn += ((double)p[u] - at[u]) * ((double)q[v] - at[v]) - ((double)p[v] - at[v]) * ((double)q[u] - at[u]);
    }
    assert_int_equal(seen, 15);
    assert_true(inside ? turn > 0 : turn < 0);
}

static bool has_edge(const int at[3], const int next[3], bool open)
{
    static const int dims[3] = {X, Y, Z};
    bool within = true;
    for (int a = 0; a < 3; a++) {
        within &= at[a] >= 0 && next[a] < dims[a];
        if (next[a] > dims[a])
            return false;
    }
    return within || !open;
}

/* All edges in the order of quads. Returns how many are crossed. */
static uint64_t check_quads(const random_volume *of, bool above, bool open, const hewn_triangles *mesh)
{
    uint64_t quads = 0;
    int at[3];
    for (at[2] = -1; at[2] <= Z; at[2]++)
        for (at[1] = -1; at[1] <= Y; at[1]++)
            for (int axis = 0; axis < 3; axis++)
                for (at[0] = -1; at[0] <= X; at[0]++) {
                    int next[3] = {at[0], at[1], at[2]};
                    next[axis]++;
                    const bool inside = is_inside(of, above, at);
                    if (!has_edge(at, next, open) || inside == is_inside(of, above, next))
                        continue;
                    assert_true(2 * quads + 1 < mesh->triangle_count);
                    check_quad(mesh, mesh->indices + 6 * quads++, at, axis, inside, open);
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

static hewn_triangles make_dual(const hewn_volume *volume, const hewn_volume_extract_desc *desc, hewn_certificate *out)
{
    hewn_triangles mesh;
    hewn_error error = {0};
    if (hewn_volume_extract(volume, desc, &mesh, NULL, &error) != HEWN_OK ||
        hewn_certify(&mesh, NULL, out, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    assert_true(out->manifold && out->oriented);
    assert_true(desc->open || (out->closed && out->volume > 0));
    assert_distinct(&mesh);
    return mesh;
}

static void test_random_volumes(void **state)
{
    (void)state;
    static random_volume of;
    uint64_t seeds = getenv("HEWN_LONG") ? 3000 : 60;
    for (uint64_t seed = 0; seed < seeds; seed++) {
        const bool above = seed / 4 % 2, open = seed / 8 % 2;
        make_volume(&of, (random_kind)(seed % RANDOM_KINDS), seed);
        const hewn_volume_extract_desc desc = {
            .method = methods[seed / 2 % 2], .open = open, .inside = above ? HEWN_INSIDE_ABOVE : HEWN_INSIDE_BELOW};
        hewn_certificate certificate;
        hewn_triangles mesh = make_dual(&of.volume, &desc, &certificate);
        assert_int_equal(2 * check_quads(&of, above, open, &mesh), mesh.triangle_count);
        hewn_triangles_destroy(&mesh);
    }
}

/* As far away as floats allow, mirrored, sheared: nothing falls together. */
static void test_far_away(void **state)
{
    (void)state;
    static random_volume of;
    static const double place[16] = {-1, 0.25, 0, 100000, 0, 1.5, 0.5, -40000, 0, 0, 2, 7, 0, 0, 0, 1};
    for (uint64_t seed = 0; seed < 24; seed++) {
        make_volume(&of, (random_kind)(seed % RANDOM_KINDS), 500 + seed);
        for (int i = 0; i < COUNT && seed % 3 == 0; i += 2)
            of.samples[i] *= 1e-6f; /* crossings that are next to samples */
        const hewn_volume_extract_desc desc = {.method = methods[seed / 3 % 2], .open = seed % 2, .place = place};
        hewn_certificate certificate;
        hewn_triangles mesh = make_dual(&of.volume, &desc, &certificate);
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
    const hewn_volume_extract_desc desc = {.method = HEWN_METHOD_DC};
    for (int threads = 1; threads <= 4; threads++) {
        omp_set_num_threads(threads);
        hewn_triangles mesh = make_dual(&of.volume, &desc, &certificate);
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
    hewn_triangles mesh = make_dual(&volume, &desc, &certificate);
    assert_int_equal(certificate.components, 3);
    hewn_triangles_destroy(&mesh);
    desc.keep = &largest;
    mesh = make_dual(&volume, &desc, &certificate);
    assert_int_equal(certificate.components, 2);
    hewn_triangles_destroy(&mesh);
    desc.keep = &filled;
    mesh = make_dual(&volume, &desc, &certificate);
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

/* --- edges and corners -------------------------------------------------------------------------------------------- */

/* A box in a lattice whose axes are neither as long as each other nor upright. Samples are distances to its sides, so
 * that differences are what its planes are, but for next to its edges. */
typedef struct box_volume {
    hewn_volume volume;
    float samples[SIDE * SIDE * SIDE];
    double half[3];
} box_volume;

static double off_box(const double half[3], const float *p)
{
    double most = -INFINITY;
    for (int axis = 0; axis < 3; axis++)
        most = fmax(most, fabs((double)p[axis]) - half[axis]);
    return most;
}

static void make_box(box_volume *out)
{
    static const double place[16] = {0.9, -0.2, 0.15, -6.3, 0.2, 0.7, 0.1, -12.6, -0.1, 0.05, 1.4, -17.4, 0, 0, 0, 1};
    *out = (box_volume){.volume = {.dims = {SIDE, SIDE, SIDE}, .frame_count = 1, .type = HEWN_VOXEL_FLOAT, .slope = 1},
                        .half = {4.1, 3.3, 6.2}};
    memcpy(out->volume.to_world, place, sizeof place);
    out->volume.samples = out->samples;
    for (int n = 0; n < SIDE * SIDE * SIDE; n++) {
        const double at[3] = {n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE};
        float p[3];
        for (int i = 0; i < 3; i++)
            p[i] =
                (float)(place[4 * i] * at[0] + place[4 * i + 1] * at[1] + place[4 * i + 2] * at[2] + place[4 * i + 3]);
        out->samples[n] = (float)off_box(out->half, p);
    }
}

/* How far a point is from the nearest edge of the box. */
static double off_edge(const double half[3], const float *p)
{
    double off[3];
    for (int axis = 0; axis < 3; axis++)
        off[axis] = fabs(fabs((double)p[axis]) - half[axis]);
    return fmin(fmin(hypot(off[0], off[1]), hypot(off[1], off[2])), hypot(off[0], off[2]));
}

/* Points of the box's edges from which the mesh is more than 0.15 away, a fifth of the shortest step between samples: a
 * share of some. And how far vertices are off its sides where no edge is near. */
static double share_of_lost_edges(const box_volume *of, const hewn_triangles *mesh, double *off_faces)
{
    uint64_t lost = 0, count = 0, plain = 0;
    double sum = 0;
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        const float *p = mesh->positions + 3 * v;
        if (off_edge(of->half, p) < 2)
            continue;
        sum += fabs(off_box(of->half, p));
        plain++;
    }
    assert_true(plain > 50);
    *off_faces = sum / (double)plain;
    for (int edge = 0; edge < 12; edge++)
        for (double t = -0.8; t < 0.81; t += 0.1) {
            double at[3], near = INFINITY;
            const int axis = edge / 4;
            at[axis] = t * of->half[axis];
            at[(axis + 1) % 3] = edge & 1 ? of->half[(axis + 1) % 3] : -of->half[(axis + 1) % 3];
            at[(axis + 2) % 3] = edge & 2 ? of->half[(axis + 2) % 3] : -of->half[(axis + 2) % 3];
            for (uint64_t c = 0; c < 3 * mesh->triangle_count; c += 3) {
                double corner[3][3];
                for (int i = 0; i < 9; i++)
                    corner[i / 3][i % 3] =
                        (double)mesh->positions[3 * (size_t)mesh->indices[c + (uint64_t)(i / 3)] + (size_t)(i % 3)];
                near = fmin(near, hewn_triangle_distance_squared(at, corner[0], corner[1], corner[2]));
            }
            lost += near > 0.15 * 0.15;
            count++;
        }
    return (double)lost / (double)count;
}

static void test_box(void **state)
{
    (void)state;
    static box_volume of;
    double lost[2], off[2];
    make_box(&of);
    for (int m = 0; m < 2; m++) {
        hewn_certificate certificate;
        const hewn_volume_extract_desc desc = {.method = methods[m], .inside = HEWN_INSIDE_BELOW};
        hewn_triangles mesh = make_dual(&of.volume, &desc, &certificate);
        assert_int_equal(certificate.components, 1);
        assert_int_equal(certificate.genus, 0);
        lost[m] = share_of_lost_edges(&of, &mesh, &off[m]);
        hewn_triangles_destroy(&mesh);
    }
    assert_true(off[0] < 1e-5 && off[1] < 1e-5);
    assert_true(lost[0] > 0.8 && lost[1] < 0.05);
}

/* --- what is refused ---------------------------------------------------------------------------------------------- */

static void test_refused(void **state)
{
    (void)state;
    hewn_volume volume = make_balls(false);
    hewn_triangles mesh;
    hewn_error error = {0};
    hewn_volume_extract_desc desc = {.method = HEWN_METHOD_NETS, .iso = -100, .inside = HEWN_INSIDE_BELOW};
    assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, NULL, &error), HEWN_BAD_INPUT);
    desc.iso = 0;
    desc.open = true;
    volume.dims[1] = 1;
    for (int m = 0; m < 2; m++) { /* around one slice there is nothing that could stay open */
        desc.method = methods[m];
        assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, NULL, &error), HEWN_BAD_INPUT);
        assert_non_null(strstr(error.message, "one slice"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_volumes),
        cmocka_unit_test(test_far_away),
        cmocka_unit_test(test_same_bytes_for_any_threads),
        cmocka_unit_test(test_ball),
        cmocka_unit_test(test_box),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
