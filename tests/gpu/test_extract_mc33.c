/* Extraction with the topology of the trilinear interpolant, on the device: the same triangles as its serial twin,
 * whose decisions are exact, and the same topology as the oracle's; closed manifolds of whatever field. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../oracle/mc33.h"
#include "../oracle/trilinear.h"
#include "eval/code.h"
#include "random_fields.h"

static hewn_device *device;
static hewn_mc33_table table;

static void must(hewn_result result, const hewn_error *error)
{
    if (result != HEWN_OK)
        fail_msg("%s", error->message);
}

static int open_device(void **state)
{
    (void)state;
    hewn_error error = {0};
    hewn_device_desc desc = {.validation = true};
    if (hewn_device_create(&desc, &device, &error) != HEWN_OK || hewn_mc33_table_derive(&table, &error) != HEWN_OK) {
        print_error("%s\n", error.message);
        return -1;
    }
    return 0;
}

static int close_device(void **state)
{
    (void)state;
    uint64_t messages = hewn_device_message_count(device);
    hewn_mc33_table_destroy(&table);
    hewn_device_destroy(&device);
    return messages == 0 ? 0 : -1;
}

/* --- a grid of unit cells, on the device and as values ------------------------------------------------------------ */

typedef struct subject {
    hewn_field *field;
    hewn_node root;
    hewn_extractor *extractor;
} subject;

static subject make_subject(maker *make, uint32_t seed)
{
    hewn_error error = {0};
    subject made = {0};
    must(hewn_field_create(&made.field, &error), &error);
    made.root = make(made.field, seed);
    must(hewn_field_status(made.field, &error), &error);
    must(hewn_extractor_create(device, made.field, made.root, &made.extractor, &error), &error);
    return made;
}

static void free_subject(subject *made)
{
    hewn_extractor_destroy(&made->extractor);
    hewn_field_destroy(&made->field);
}

static hewn_triangles extract(const subject *made, const hewn_extract_desc *desc)
{
    hewn_error error = {0};
    hewn_triangles mesh;
    must(hewn_extract(made->extractor, desc, &mesh, NULL, &error), &error);
    return mesh;
}

static hewn_certificate certify(const hewn_triangles *mesh)
{
    hewn_error error = {0};
    hewn_certificate certificate;
    must(hewn_certify(mesh, NULL, &certificate, &error), &error);
    return certificate;
}

/* What the device takes the samples for: on the bounds of a closed grid nothing is inside. */
static double *sample(const subject *made, const uint32_t samples[3], bool open)
{
    hewn_error error = {0};
    size_t count = (size_t)samples[0] * samples[1] * samples[2];
    float *points = malloc(3 * count * sizeof *points), *values = malloc(count * sizeof *values);
    double *out = malloc(count * sizeof *out);
    for (size_t i = 0; i < count; i++) {
        points[3 * i] = (float)(i % samples[0]);
        points[3 * i + 1] = (float)(i / samples[0] % samples[1]);
        points[3 * i + 2] = (float)(i / samples[0] / samples[1]);
    }
    hewn_code *code;
    must(hewn_code_create(device, made->field, made->root, &code, &error), &error);
    must(hewn_code_eval_points(device, code, points, count, values, &error), &error);
    hewn_code_destroy(device, &code);
    for (size_t i = 0; i < count; i++) {
        bool bound = false;
        for (size_t axis = 0; axis < 3; axis++)
            bound |= points[3 * i + axis] == 0 || points[3 * i + axis] == (float)(samples[axis] - 1);
        out[i] = bound && !open && values[i] < 0 ? 0 : (double)values[i];
    }
    free(points);
    free(values);
    return out;
}

/* --- triangles by name -------------------------------------------------------------------------------------------- */

typedef struct named {
    uint64_t corner[3];
} named;

/* The grid edge of a vertex, or the cell of one in a cell. */
static uint64_t vertex_name(const float at[3], const uint32_t samples[3], bool on_edge)
{
    uint64_t cell = 0, scale = 1;
    uint32_t along = 3;
    for (uint32_t axis = 0; axis < 3; axis++, scale *= samples[axis - 1]) {
        double low = floor((double)at[axis]);
        bool whole = low == (double)at[axis];
        if (on_edge && !whole)
            along = axis;
        cell += scale * (uint64_t)low;
    }
    if (!on_edge)
        return (UINT64_C(1) << 60) + cell;
    scale = 1;
    /* A cap's vertex is on a sample of the bounds: its edge leads inward from there. */
    for (uint32_t axis = 0; along == 3; axis++, scale *= samples[axis - 1]) {
        if (at[axis] != 0 && at[axis] != (float)(samples[axis] - 1))
            continue;
        along = axis;
        cell -= at[axis] != 0 ? scale : 0;
        break;
    }
    return 3 * cell + along;
}

static int by_name(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(named));
}

static named *name_triangles(const hewn_triangles *mesh, uint64_t on_edges, const uint32_t samples[3])
{
    named *out = malloc(mesh->triangle_count * sizeof *out + 1);
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        uint64_t name[3];
        uint32_t least = 0;
        for (uint32_t c = 0; c < 3; c++) {
            uint32_t vertex = mesh->indices[3 * t + c];
            name[c] = vertex_name(mesh->positions + (size_t)3 * vertex, samples, vertex < on_edges);
            least = name[c] < name[least] ? c : least;
        }
        for (uint32_t c = 0; c < 3; c++)
            out[t].corner[c] = name[(least + c) % 3];
    }
    qsort(out, mesh->triangle_count, sizeof *out, by_name);
    return out;
}

static uint64_t crossed_edges(const double *values, const uint32_t samples[3])
{
    uint64_t count = 0;
    uint32_t n = samples[0] * samples[1] * samples[2];
    for (uint32_t i = 0; i < n; i++) {
        uint32_t step = 1;
        for (uint32_t axis = 0, rest = i; axis < 3; axis++, rest /= samples[axis - 1], step *= samples[axis - 1])
            count += rest % samples[axis] + 1 < samples[axis] && (values[i] < 0) != (values[i + step] < 0);
    }
    return count;
}

/* Returns how many vertices are in cells. */
static uint64_t check_twin(maker *make, uint32_t seed, const uint32_t cells[3], bool open)
{
    uint32_t samples[3] = {cells[0] + 1, cells[1] + 1, cells[2] + 1};
    subject made = make_subject(make, seed);
    hewn_extract_desc desc = {
        .bounds = {{0, 0, 0}, {cells[0], cells[1], cells[2]}}, .cell = 1, .method = HEWN_METHOD_MC33, .open = open};
    hewn_triangles mesh = extract(&made, &desc);
    double *values = sample(&made, samples, open);
    hewn_triangles twin = oracle_mc33(samples, values, &table);
    uint64_t on_edges = crossed_edges(values, samples);
    assert_int_equal(mesh.vertex_count, twin.vertex_count);
    assert_int_equal(mesh.triangle_count, twin.triangle_count);
    named *mine = name_triangles(&mesh, on_edges, samples), *theirs = name_triangles(&twin, on_edges, samples);
    assert_memory_equal(mine, theirs, mesh.triangle_count * sizeof *mine);
    hewn_certificate certificate = certify(&mesh);
    assert_true(certificate.manifold && certificate.oriented);
    if (!open) {
        oracle_topology exact = oracle_trilinear(samples, values);
        assert_true(certificate.closed && certificate.volume > 0);
        assert_int_equal(certificate.components, exact.components);
        assert_int_equal(2 * (int64_t)certificate.components - 2 * certificate.genus, exact.euler);
    }
    uint64_t in_cells = twin.vertex_count - on_edges;
    hewn_triangles_destroy(&mesh);
    hewn_triangles_destroy(&twin);
    free(mine);
    free(theirs);
    free(values);
    free_subject(&made);
    return in_cells;
}

static void test_same_as_the_twin(void **state)
{
    (void)state;
    uint64_t waves = 0, integers = 0;
    static const uint32_t cells[][3] = {{24, 20, 17}, {8, 8, 8}, {33, 9, 16}};
    for (uint32_t i = 0; i < sizeof cells / sizeof *cells; i++)
        for (int open = 0; open < 2; open++) {
            waves += check_twin(make_waves, i, cells[i], open);
            integers += check_twin(make_integers, i, cells[i], open);
        }
    assert_true(waves > 50 && integers > 50);
}

/* --- meshes ------------------------------------------------------------------------------------------------------- */

static void test_random_trees_are_closed_manifolds(void **state)
{
    (void)state;
    uint32_t trees = getenv("HEWN_LONG") ? 100 : 8;
    for (uint32_t seed = 0; seed < trees; seed++) {
        subject made = make_subject(make_tree, seed);
        for (uint32_t resolution = 9; resolution < 60; resolution += 24) {
            hewn_extract_desc desc = {
                .bounds = {{-1, -1, -1}, {1, 1, 1}}, .resolution = resolution, .method = HEWN_METHOD_MC33};
            hewn_triangles mesh = extract(&made, &desc);
            hewn_certificate certificate = certify(&mesh);
            assert_true(certificate.closed && certificate.manifold && certificate.oriented && certificate.volume > 0);
            hewn_triangles_destroy(&mesh);
        }
        free_subject(&made);
    }
}

static void test_same_bytes_every_time(void **state)
{
    (void)state;
    subject made = make_subject(make_waves, 3);
    hewn_extract_desc desc = {.bounds = {{0, 0, 0}, {30, 30, 30}}, .cell = 1, .method = HEWN_METHOD_MC33};
    hewn_triangles first = extract(&made, &desc);
    for (int i = 0; i < 3; i++) {
        hewn_triangles again = extract(&made, &desc);
        assert_int_equal(again.vertex_count, first.vertex_count);
        assert_int_equal(again.triangle_count, first.triangle_count);
        assert_memory_equal(again.positions, first.positions, 12 * first.vertex_count);
        assert_memory_equal(again.normals, first.normals, 12 * first.vertex_count);
        assert_memory_equal(again.indices, first.indices, 12 * first.triangle_count);
        hewn_triangles_destroy(&again);
    }
    for (uint64_t i = 0; i < first.vertex_count; i++) {
        const float *n = first.normals + 3 * i;
        assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f);
    }
    hewn_triangles_destroy(&first);
    free_subject(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_as_the_twin),
        cmocka_unit_test(test_random_trees_are_closed_manifolds),
        cmocka_unit_test(test_same_bytes_every_time),
    };
    return cmocka_run_group_tests_name("extract_mc33", tests, open_device, close_device);
}
