/* Meshes straight from samples: of every type, the same triangles as the serial twin with exact decisions makes, and
 * closed manifolds with the topology of the trilinear interpolant. HEWN_LONG asks for more grids. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../oracle/mc33.h"
#include "../oracle/random_grid.h"
#include "../oracle/trilinear.h"
#include "hewn/volume_extract.h"
#include "iso/decide.h"
#include "iso/threshold.h"

enum { N = 7, P = N + 2, COUNT = N * N * N };

static hewn_mc33_table table;

static int derive_table(void **state)
{
    (void)state;
    return hewn_mc33_table_derive(&table, NULL) == HEWN_OK ? 0 : -1;
}

static int drop_table(void **state)
{
    (void)state;
    hewn_mc33_table_destroy(&table);
    return 0;
}

/* --- volumes ------------------------------------------------------------------------------------------------------ */

typedef struct random_volume {
    hewn_volume volume;
    union {
        int8_t i8[COUNT];
        uint8_t u8[COUNT];
        int16_t i16[COUNT];
        uint16_t u16[COUNT];
        int32_t i32[COUNT];
        uint32_t u32[COUNT];
        int64_t i64[COUNT];
        uint64_t u64[COUNT];
        float f[COUNT];
        double d[COUNT];
    } samples;
    double iso;
} random_volume;

/* 0, the positive halves with bits 0x3400 to 0x3fff, or the same below 0. */
static uint16_t random_half(uint64_t *random)
{
    uint32_t pick = random_below(random, 16);
    return pick == 0 ? 0 : (uint16_t)((pick & 1 ? 0x8000u : 0) | (0x3400u + random_below(random, 0xc00)));
}

static void put_sample(random_volume *out, int i, double value, uint64_t *random)
{
    double large = round(value * 40);
    switch (out->volume.type) {
    case HEWN_VOXEL_INT8: out->samples.i8[i] = (int8_t)fmax(-128, fmin(127, large)); return;
    case HEWN_VOXEL_UINT8: out->samples.u8[i] = (uint8_t)fmax(0, fmin(255, large + 120)); return;
    case HEWN_VOXEL_INT16: out->samples.i16[i] = (int16_t)fmax(-32768, fmin(32767, large * 100)); return;
    case HEWN_VOXEL_UINT16: out->samples.u16[i] = (uint16_t)fmax(0, fmin(65535, large * 100 + 30000)); return;
    case HEWN_VOXEL_INT32: out->samples.i32[i] = (int32_t)(value * 1e8); return;
    case HEWN_VOXEL_UINT32: out->samples.u32[i] = (uint32_t)(2e9 + value * 1e8); return;
    case HEWN_VOXEL_INT64: out->samples.i64[i] = (int64_t)(value * 1e15); return;
    case HEWN_VOXEL_UINT64: out->samples.u64[i] = (uint64_t)(4e15 + value * 4e14); return;
    case HEWN_VOXEL_HALF: out->samples.u16[i] = random_half(random); return;
    case HEWN_VOXEL_FLOAT: out->samples.f[i] = (float)value; return;
    case HEWN_VOXEL_DOUBLE: out->samples.d[i] = value; return;
    }
}

static double middle_of(hewn_voxel type)
{
    switch (type) {
    case HEWN_VOXEL_UINT8: return 120;
    case HEWN_VOXEL_UINT16: return 30000;
    case HEWN_VOXEL_UINT32: return 2e9;
    case HEWN_VOXEL_UINT64: return 4e15;
    default: return 0;
    }
}

/* The iso value is in the middle: a value that samples have, or for small integers half way between two. */
static void make_volume(random_volume *out, hewn_voxel type, random_kind kind, uint64_t seed, bool half_way)
{
    uint64_t random = seed + 1;
    *out = (random_volume){.volume = {.dims = {N, N, N}, .frame_count = 1, .type = type, .slope = 1}};
    out->volume.samples = &out->samples;
    for (int i = 0; i < 16; i++)
        out->volume.to_world[i] = i % 5 == 0;
    for (int i = 0; i < COUNT; i++)
        put_sample(out, i, random_value(&random, kind), &random);
    out->iso = middle_of(type) + (half_way ? 0.5 : 0);
}

/* --- triangles ---------------------------------------------------------------------------------------------------- */

/* Which vertex it is, whatever the order of vertices: three times the sample where its edge begins, and the axis. Those
 * in cells come in the same order by all, after those on edges. */
static void name_vertices(const hewn_triangles *mesh, uint32_t *names)
{
    uint32_t centres = 0;
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        const float *p = mesh->positions + 3 * v;
        int axis = -1, broken = 0;
        for (int a = 0; a < 3; a++)
            if (p[a] != floorf(p[a])) {
                axis = a;
                broken++;
            }
        uint32_t sample = (uint32_t)p[0] + N * ((uint32_t)p[1] + N * (uint32_t)p[2]);
        names[v] = broken == 1 ? 3 * sample + (uint32_t)axis : 3 * COUNT + centres++;
    }
}

static void check_same(const hewn_triangles *mesh, const hewn_triangles *twin, bool turned)
{
    static uint32_t names[COUNT * 8], twin_names[COUNT * 8];
    static float places[3 * COUNT + COUNT * 5][3];
    assert_int_equal(mesh->vertex_count, twin->vertex_count);
    assert_int_equal(mesh->triangle_count, twin->triangle_count);
    name_vertices(mesh, names);
    name_vertices(twin, twin_names);
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *one = mesh->indices + 3 * t, *other = twin->indices + 3 * t;
        for (int c = 0; c < 3; c++)
            assert_int_equal(names[one[c]], twin_names[other[turned && c > 0 ? 3 - c : c]]);
    }
    for (uint64_t v = 0; v < twin->vertex_count; v++)
        memcpy(places[twin_names[v]], twin->positions + 3 * v, sizeof places[0]);
    for (uint64_t v = 0; v < mesh->vertex_count; v++)
        for (int a = 0; a < 3; a++)
            assert_float_equal(mesh->positions[3 * v + (uint64_t)a], places[names[v]][a], 3e-4);
}

/* Values from double samples, below 0 where the twin's inside is. */
static void read_values(const random_volume *of, double *values)
{
    for (int i = 0; i < COUNT; i++)
        values[i] = hewn_volume_value(&of->volume, (uint64_t)i) - of->iso;
}

static void check_open(const random_volume *of, hewn_inside inside)
{
    static const uint32_t samples[3] = {N, N, N};
    double values[COUNT];
    hewn_triangles mesh, twin;
    hewn_error error = {0};
    hewn_volume_extract_desc desc = {.iso = of->iso, .inside = inside, .open = true};
    read_values(of, values);
    twin = oracle_mc33(samples, values, &table);
    hewn_result result = hewn_volume_extract(&of->volume, &desc, &mesh, NULL, &error);
    if (result != HEWN_OK)
        fail_msg("%s: %s", hewn_voxel_name(of->volume.type), error.message);
    check_same(&mesh, &twin, inside == HEWN_INSIDE_ABOVE);
    hewn_triangles_destroy(&mesh);
    hewn_triangles_destroy(&twin);
}

static void test_same_triangles_as_the_twin(void **state)
{
    (void)state;
    uint64_t grids = getenv("HEWN_LONG") ? 40 : 4;
    static random_volume volume;
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++)
        for (int kind = 0; kind < RANDOM_KINDS; kind++)
            for (uint64_t seed = 0; seed < grids; seed++) {
                make_volume(&volume, (hewn_voxel)type, (random_kind)kind, seed, seed % 2);
                check_open(&volume, HEWN_INSIDE_BELOW);
                check_open(&volume, HEWN_INSIDE_ABOVE);
            }
}

/* --- topology ----------------------------------------------------------------------------------------------------- */

/* The closed mesh against the interpolant of the samples with a layer of 0 around them. Above, a tie is inside: a hair
 * less than the iso value makes that so for the oracle, for which it is outside. */
static void check_closed(const random_volume *of, hewn_inside inside)
{
    static const uint32_t samples[3] = {P, P, P};
    bool above = inside == HEWN_INSIDE_ABOVE;
    double values[P * P * P] = {0};
    hewn_certificate certificate;
    hewn_triangles mesh;
    hewn_error error = {0};
    for (int k = 0; k < N; k++)
        for (int j = 0; j < N; j++)
            for (int i = 0; i < N; i++) {
                double value = hewn_volume_value(&of->volume, (uint64_t)(i + N * (j + N * k))) - of->iso;
                values[i + 1 + P * (j + 1 + P * (k + 1))] = above ? -value - 0x1p-40 : value;
            }
    hewn_volume_extract_desc desc = {.iso = of->iso, .inside = inside};
    if (hewn_volume_extract(&of->volume, &desc, &mesh, NULL, &error) != HEWN_OK ||
        hewn_certify(&mesh, NULL, &certificate, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    oracle_topology exact = oracle_trilinear(samples, values);
    assert_true(certificate.closed && certificate.manifold && certificate.oriented);
    assert_true(certificate.volume > 0);
    assert_int_equal((int64_t)mesh.vertex_count - (int64_t)mesh.triangle_count / 2, exact.euler);
    assert_int_equal(certificate.components, exact.components);
    hewn_triangles_destroy(&mesh);
}

static void test_topology_of_the_interpolant(void **state)
{
    (void)state;
    static const hewn_voxel types[] = {HEWN_VOXEL_UINT8, HEWN_VOXEL_INT8, HEWN_VOXEL_FLOAT, HEWN_VOXEL_DOUBLE};
    uint64_t grids = getenv("HEWN_LONG") ? 150 : 4;
    static random_volume volume;
    for (size_t type = 0; type < sizeof types / sizeof *types; type++)
        for (int kind = 0; kind < RANDOM_KINDS; kind++)
            for (uint64_t seed = 0; seed < grids; seed++) {
                make_volume(&volume, types[type], (random_kind)kind, 1000 + seed, false);
                check_closed(&volume, HEWN_INSIDE_BELOW);
                check_closed(&volume, HEWN_INSIDE_ABOVE);
            }
}

/* --- decisions ---------------------------------------------------------------------------------------------------- */

static uint32_t bits_at(uint32_t value, uint32_t mask)
{
    uint32_t out = 0, bit = 0;
    for (uint32_t face = 0; face < 6; face++)
        if (mask >> face & 1)
            out |= (value >> face & 1) << bit++;
    return out;
}

/* Values of any size, and such that what is compared nearly or exactly cancels. */
static void random_cell(uint64_t *random, uint32_t trial, double values[8])
{
    for (int c = 0; c < 8; c++) {
        values[c] = random_value(random, (random_kind)(trial % RANDOM_KINDS));
        if (trial % 3 == 1)
            values[c] = ldexp(round(values[c] * 3), (int)random_below(random, 3));
        if (trial % 5 == 2)
            values[c] *= ldexp(1, (int)random_below(random, 120) - 60);
    }
    if (trial % 7 == 3) { /* a product of linear functions: its saddles are at 0 */
        double a = random_value(random, RANDOM_NORMAL), b = random_value(random, RANDOM_NORMAL);
        for (int c = 0; c < 8; c++)
            values[c] = (float)(((c & 1) - a) * ((c >> 1 & 1) - b)) * (c >> 2 ? 1 : -2);
        values[random_below(random, 8)] *= 1 + 0x1p-52;
    }
}

static void test_decisions_are_exact(void **state)
{
    (void)state;
    uint64_t random = 77;
    uint32_t joins = 0, trials = getenv("HEWN_LONG") ? 300000 : 15000;
    for (uint32_t trial = 0; trial < trials; trial++) {
        double values[8];
        uint32_t pattern = 0;
        random_cell(&random, trial, values);
        for (uint32_t c = 0; c < 8; c++)
            pattern |= (values[c] < 0 ? 1u : 0u) << c;
        uint32_t ambiguous = hewn_mc33_ambiguous(pattern);
        hewn_mc33_join join = oracle_mc33_join(values);
        assert_int_equal(hewn_decide_faces(values, ambiguous), bits_at(oracle_mc33_joined(values), ambiguous));
        assert_int_equal(hewn_decide_join(values), join);
        joins += join != HEWN_MC33_NO_JOIN;
    }
    assert_true(joins > 0);
}

/* --- thresholds --------------------------------------------------------------------------------------------------- */

static const double scales[][2] = {{1, 0},     {-1, 0},   {0.1, -3}, {-0.37, 1024}, {1e-7, 5},
                                   {1e30, -1}, {1, 1e-9}, {3, 0.1},  {1, -1024},    {-1e5, 1e12}};

/* Whatever slope and intercept are: a sample is inside where the value that is told of it says so. */
static void test_thresholds_agree_with_values(void **state)
{
    (void)state;
    static random_volume of;
    uint8_t inside[COUNT];
    uint64_t random = 9;
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++)
        for (size_t scale = 0; scale < sizeof scales / sizeof *scales; scale++)
            for (uint32_t trial = 0; trial < 40; trial++) {
                make_volume(&of, (hewn_voxel)type, (random_kind)(trial % RANDOM_KINDS), trial, false);
                of.volume.slope = scales[scale][0];
                of.volume.intercept = scales[scale][1];
                if (type == HEWN_VOXEL_FLOAT) {
                    of.samples.f[1] = -0.0f;
                    of.samples.f[2] = INFINITY;
                    of.samples.f[3] = -INFINITY;
                    of.samples.f[4] = NAN;
                }
                if (type == HEWN_VOXEL_HALF) {
                    static const uint16_t odd[] = {0x8000, 0x7c00, 0xfc00, 0x7e00, 0xfe00, 1, 0x8001};
                    memcpy(of.samples.u16 + 1, odd, sizeof odd);
                }
                double iso = hewn_volume_value(&of.volume, random_below(&random, COUNT));
                if (trial % 4 == 1)
                    iso = nextafter(iso, INFINITY);
                if (trial % 4 == 2)
                    iso = trial == 2 ? 1e300 : -1e300;
                for (int below = 0; below < 2 && iso == iso; below++) {
                    hewn_threshold threshold = hewn_threshold_find(&of.volume, iso, below);
                    hewn_threshold_apply(&threshold, &of.volume, 0, COUNT, inside);
                    for (uint64_t i = 0; i < COUNT; i++) {
                        double value = hewn_volume_value(&of.volume, i);
                        assert_int_equal(inside[i], below ? value < iso : value >= iso);
                    }
                }
            }
}

/* --- odd volumes -------------------------------------------------------------------------------------------------- */

/* NaN is outside and infinities are inside or outside as any other value; the mesh stays whole and finite. */
static void test_values_that_are_not_finite(void **state)
{
    (void)state;
    static random_volume of;
    uint64_t random = 3;
    for (uint64_t seed = 0; seed < 16; seed++)
        for (int inside = HEWN_INSIDE_ABOVE; inside <= HEWN_INSIDE_BELOW; inside++) {
            make_volume(&of, seed % 2 ? HEWN_VOXEL_FLOAT : HEWN_VOXEL_DOUBLE, RANDOM_UNIFORM, seed, false);
            static const double odd[] = {NAN, INFINITY, -INFINITY, 1e38};
            for (int i = 0; i < COUNT; i++)
                if (random_below(&random, 3) == 0 && seed % 2)
                    of.samples.f[i] = (float)odd[random_below(&random, 4)];
                else if (random_below(&random, 3) == 0)
                    of.samples.d[i] = odd[random_below(&random, 4)] * (seed % 4 ? 1 : 1e200);
            hewn_volume_extract_desc desc = {.iso = 0, .inside = (hewn_inside)inside};
            hewn_triangles mesh;
            hewn_certificate certificate;
            assert_int_equal(hewn_volume_extract(&of.volume, &desc, &mesh, NULL, NULL), HEWN_OK);
            assert_int_equal(hewn_certify(&mesh, NULL, &certificate, NULL), HEWN_OK);
            assert_true(certificate.closed && certificate.manifold && certificate.oriented);
            for (uint64_t i = 0; i < mesh.vertex_count; i++) {
                const float *n = mesh.normals + 3 * i;
                assert_float_equal(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-5);
            }
            hewn_triangles_destroy(&mesh);
        }
}

static hewn_volume plain_volume(uint32_t x, uint32_t y, uint32_t z, hewn_voxel type, const void *samples)
{
    hewn_volume out = {.dims = {x, y, z}, .frame_count = 1, .type = type, .samples = samples, .slope = 1};
    for (int i = 0; i < 16; i++)
        out.to_world[i] = i % 5 == 0;
    return out;
}

/* Single samples, rows and slices, and the widths around a word's: all is inside, so the mesh is the box. */
static void test_all_inside_is_a_box(void **state)
{
    (void)state;
    static const uint32_t sizes[][3] = {{1, 1, 1},  {1, 5, 1},  {4, 1, 3},  {61, 2, 2},
                                        {62, 3, 1}, {63, 2, 3}, {64, 2, 2}, {5000, 2, 1}};
    static uint8_t samples[20000];
    memset(samples, 7, sizeof samples);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        hewn_volume volume = plain_volume(sizes[i][0], sizes[i][1], sizes[i][2], HEWN_VOXEL_UINT8, samples);
        hewn_volume_extract_desc desc = {.iso = 7};
        hewn_volume_extract_stats stats;
        hewn_triangles mesh;
        hewn_certificate certificate;
        assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, &stats, NULL), HEWN_OK);
        assert_int_equal(hewn_certify(&mesh, NULL, &certificate, NULL), HEWN_OK);
        assert_true(certificate.closed && certificate.manifold && certificate.oriented);
        assert_int_equal(certificate.components, 1);
        assert_int_equal(certificate.genus, 0);
        assert_int_equal(stats.cap_vertices, mesh.vertex_count);
        for (int axis = 0; axis < 3; axis++) {
            assert_true(fabs(certificate.bounds.lo[axis]) < 2e-3);
            assert_true(fabs(certificate.bounds.hi[axis] - sizes[i][axis] + 1) < 2e-3);
        }
        hewn_triangles_destroy(&mesh);
        desc.iso = 8;
        hewn_error error = {0};
        assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, &stats, &error), HEWN_BAD_INPUT);
        assert_null(mesh.positions);
        desc.iso = 7;
        desc.open = true; /* nothing is outside */
        assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, &stats, &error), HEWN_BAD_INPUT);
    }
}

static void test_requests_that_make_no_sense(void **state)
{
    (void)state;
    static const float samples[8] = {1};
    hewn_volume volume = plain_volume(2, 2, 2, HEWN_VOXEL_FLOAT, samples);
    hewn_triangles mesh;
    hewn_error error;
    const hewn_volume_extract_desc bad[] = {{.iso = NAN},
                                            {.iso = INFINITY},
                                            {.iso = 0.5, .frame = 1},
                                            {.iso = 0.5, .method = (hewn_method)99},
                                            {.iso = 0.5, .place = (const double[16]){1, 0, 0, 0, 0, 1, 0, 0, 1, 1}},
                                            {.iso = 0.5, .place = (const double[16]){NAN, 0, 0, 0, 0, 1}}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(hewn_volume_extract(&volume, &bad[i], &mesh, NULL, &error), HEWN_INVALID_ARGUMENT);
    const hewn_volume_extract_desc far = {
        .iso = 0.5, .place = (const double[16]){1, 0, 0, 1e8, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    assert_int_equal(hewn_volume_extract(&volume, &far, &mesh, NULL, &error), HEWN_BAD_INPUT);
}

/* --- place -------------------------------------------------------------------------------------------------------- */

/* A ball in an oblique, anisotropic lattice of either hand: vertices lie on it, normals and faces point away from its
 * centre. Samples are squared distances, so crossings are off by the second order along an edge only. */
static void check_ball(bool mirrored, double slope)
{
    enum { X = 40, Y = 36, Z = 30 };
    static float samples[X * Y * Z];
    const double radius = 6, centre[3] = {103, -52, 31};
    hewn_volume volume = plain_volume(X, Y, Z, HEWN_VOXEL_FLOAT, samples);
    const double place[16] = {
        0.54, -0.28, 0.42, 0, 0.31, 0.62, -0.11 * (mirrored ? -1 : 1), 0, -0.2, 0.15, mirrored ? -0.9 : 0.9,
        0,    0,     0,    0, 1};
    memcpy(volume.to_world, place, sizeof place);
    for (int a = 0; a < 3; a++)
        volume.to_world[4 * a + 3] =
            centre[a] - place[4 * a] * 19.3 - place[4 * a + 1] * 17.7 - place[4 * a + 2] * 14.6;
    volume.slope = slope;
    volume.intercept = 10;
    for (int i = 0; i < X * Y * Z; i++) {
        const double at[3] = {i % X, i / X % Y, i / X / Y};
        double world[3], sum = 0;
        hewn_volume_to_world(&volume, at, world);
        for (int a = 0; a < 3; a++)
            sum += (world[a] - centre[a]) * (world[a] - centre[a]);
        samples[i] = (float)((radius * radius - sum) / slope);
    }
    hewn_volume_extract_desc desc = {.iso = 10};
    hewn_triangles mesh;
    hewn_certificate certificate;
    assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, NULL, NULL), HEWN_OK);
    assert_int_equal(hewn_certify(&mesh, NULL, &certificate, NULL), HEWN_OK);
    assert_true(certificate.closed && certificate.oriented && certificate.genus == 0);
    assert_true(fabs(certificate.volume / (4.0 / 3 * 3.14159265358979 * radius * radius * radius) - 1) < 0.03);
    for (uint64_t v = 0; v < mesh.vertex_count; v++) {
        double sum = 0, along = 0;
        for (uint64_t a = 0; a < 3; a++) {
            double off = (double)mesh.positions[3 * v + a] - centre[a];
            sum += off * off;
            along += off * (double)mesh.normals[3 * v + a];
        }
        assert_true(fabs(sqrt(sum) - radius) < 0.03);
        assert_true(along / sqrt(sum) > 0.9999);
    }
    hewn_triangles_destroy(&mesh);
}

static void test_ball_in_an_oblique_lattice(void **state)
{
    (void)state;
    check_ball(false, 1);
    check_ball(true, 1);
    check_ball(false, -2);
    check_ball(true, -2);
}

/* --- threads ------------------------------------------------------------------------------------------------------ */

static void test_same_bytes_for_any_threads(void **state)
{
    (void)state;
    enum { SIDE = 70 };
    static int16_t samples[SIDE * SIDE * SIDE];
    uint64_t random = 4;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        samples[i] = (int16_t)(random_below(&random, 2000) - 1000);
    hewn_volume volume = plain_volume(SIDE, SIDE, SIDE, HEWN_VOXEL_INT16, samples);
    hewn_volume_extract_desc desc = {.iso = 600};
    hewn_triangles first, mesh;
    int before = omp_get_max_threads();
    omp_set_num_threads(1);
    assert_int_equal(hewn_volume_extract(&volume, &desc, &first, NULL, NULL), HEWN_OK);
    for (int threads = 2; threads < 6; threads++) {
        omp_set_num_threads(threads);
        assert_int_equal(hewn_volume_extract(&volume, &desc, &mesh, NULL, NULL), HEWN_OK);
        assert_int_equal(mesh.vertex_count, first.vertex_count);
        assert_int_equal(mesh.triangle_count, first.triangle_count);
        assert_memory_equal(mesh.positions, first.positions, 12 * first.vertex_count);
        assert_memory_equal(mesh.normals, first.normals, 12 * first.vertex_count);
        assert_memory_equal(mesh.indices, first.indices, 12 * first.triangle_count);
        hewn_triangles_destroy(&mesh);
    }
    omp_set_num_threads(before);
    hewn_triangles_destroy(&first);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_thresholds_agree_with_values), cmocka_unit_test(test_decisions_are_exact),
        cmocka_unit_test(test_same_triangles_as_the_twin),   cmocka_unit_test(test_topology_of_the_interpolant),
        cmocka_unit_test(test_values_that_are_not_finite),   cmocka_unit_test(test_all_inside_is_a_box),
        cmocka_unit_test(test_requests_that_make_no_sense),  cmocka_unit_test(test_ball_in_an_oblique_lattice),
        cmocka_unit_test(test_same_bytes_for_any_threads),
    };
    return cmocka_run_group_tests_name("volume_extract", tests, derive_table, drop_table);
}
