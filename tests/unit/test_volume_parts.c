/* Meshes of volumes in slabs: put together they are the mesh that is made at once, with its certificate and counts,
 * whatever the limit of memory; what is in use stays below it; and whatever goes wrong is an error, with nothing left.
 */
#include <malloc.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../oracle/random_grid.h"
#include "hewn/volume_extract.h"

static const hewn_method methods[] = {HEWN_METHOD_MC33, HEWN_METHOD_NETS, HEWN_METHOD_MARCHING_CUBES, HEWN_METHOD_DC};

/* --- the heap under watch: the linker leads Hewn's own allocations here --------------------------------------------
 */

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
void __wrap_free(void *block);

static struct {
    bool on;
    int64_t bytes, peak;
    uint64_t left, blocks; /* allocations that may yet succeed, and how many there were */
} heap;

static bool may_allocate(void)
{
    bool may = !heap.on || heap.left > 0;
    if (heap.on && may) {
        heap.left--;
        heap.blocks++;
    }
    return may;
}

static void add(void *block, int sign)
{
    if (!heap.on || !block)
        return;
    heap.bytes += sign * (int64_t)malloc_usable_size(block);
    heap.peak = heap.bytes > heap.peak ? heap.bytes : heap.peak;
}

void *__wrap_malloc(size_t size)
{
    void *block = may_allocate() ? __real_malloc(size) : NULL;
    add(block, 1);
    return block;
}

void *__wrap_calloc(size_t count, size_t size)
{
    void *block = may_allocate() ? __real_calloc(count, size) : NULL;
    add(block, 1);
    return block;
}

void *__wrap_realloc(void *block, size_t size)
{
    if (!may_allocate())
        return NULL;
    add(block, -1);
    void *moved = __real_realloc(block, size);
    add(moved ? moved : block, 1);
    return moved;
}

void __wrap_free(void *block)
{
    add(block, -1);
    __real_free(block);
}

static void watch(uint64_t left)
{
    heap.bytes = heap.peak = 0;
    heap.blocks = 0;
    heap.left = left;
    heap.on = true;
}

/* --- volumes ------------------------------------------------------------------------------------------------------ */

enum { MOST = 70 * 9 * 40 };

typedef struct grid {
    hewn_volume volume;
    float samples[MOST];
} grid;

/* Random values in places, and slices without surface between; some sizes are no multiples of a word. */
static void make_grid(grid *out, const uint32_t dims[3], random_kind kind, uint64_t seed)
{
    uint64_t random = seed + 1;
    *out = (grid){.volume = {.frame_count = 1, .type = HEWN_VOXEL_FLOAT, .slope = 1}};
    memcpy(out->volume.dims, dims, sizeof out->volume.dims);
    out->volume.samples = out->samples;
    for (int i = 0; i < 16; i++)
        out->volume.to_world[i] = i % 5 == 0;
    out->volume.to_world[1] = 0.25;
    for (uint32_t n = 0; n < dims[0] * dims[1] * dims[2]; n++) {
        uint32_t k = n / (dims[0] * dims[1]);
        out->samples[n] = k / 5 % 3 == 1 ? -1.0f : (float)random_value(&random, kind);
    }
}

static const uint32_t shapes[][3] = {{7, 7, 7}, {63, 4, 21}, {62, 5, 13}, {70, 9, 40}, {3, 8, 1}, {2, 2, 2}, {9, 9, 3}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

/* --- putting slabs together --------------------------------------------------------------------------------------- */

typedef struct collector {
    const hewn_triangles *whole;
    float *positions, *normals;
    uint32_t *indices;
    uint64_t vertices, triangles, parts, fail_at;
    hewn_certifier *certifier;
} collector;

static void make_collector(collector *out, const hewn_triangles *whole)
{
    *out = (collector){.whole = whole};
    out->positions = malloc(12 * whole->vertex_count);
    out->normals = malloc(12 * whole->vertex_count);
    out->indices = malloc(12 * whole->triangle_count);
    assert_true(out->positions && out->normals && out->indices);
    assert_int_equal(hewn_certifier_create(&out->certifier, NULL), HEWN_OK);
}

static void free_collector(collector *made)
{
    free(made->positions);
    free(made->normals);
    free(made->indices);
    hewn_certifier_destroy(&made->certifier);
}

static hewn_result take(void *user, const hewn_mesh_part *part, hewn_error *error)
{
    collector *to = user;
    if (++to->parts == to->fail_at)
        return HEWN_IO;
    for (int i = 0; i < 2; i++) {
        const hewn_vertex_run *vertices = &part->vertices[i];
        const hewn_triangle_run *triangles = &part->triangles[i];
        assert_true(vertices->first + vertices->count <= to->whole->vertex_count);
        assert_true(triangles->count == 0 || triangles->first + triangles->count <= to->whole->triangle_count);
        if (vertices->count > 0)
            memcpy(to->positions + 3 * vertices->first, vertices->positions, 12 * vertices->count);
        if (vertices->count > 0 && vertices->normals)
            memcpy(to->normals + 3 * vertices->first, vertices->normals, 12 * vertices->count);
        if (triangles->count > 0)
            memcpy(to->indices + 3 * triangles->first, triangles->indices, 12 * triangles->count);
        to->vertices += vertices->count;
        to->triangles += triangles->count;
    }
    return hewn_certifier_take(to->certifier, part, error);
}

static uint64_t bytes(void *user, const hewn_mesh_part *part)
{
    return hewn_certifier_bytes(((collector *)user)->certifier, part);
}

typedef struct whole {
    hewn_triangles mesh;
    hewn_volume_extract_stats stats;
    hewn_certificate certificate;
} whole;

static bool make_whole(const grid *of, const hewn_volume_extract_desc *desc, whole *out)
{
    if (hewn_volume_extract(&of->volume, desc, &out->mesh, &out->stats, NULL) != HEWN_OK)
        return false;
    assert_int_equal(hewn_certify(&out->mesh, NULL, &out->certificate, NULL), HEWN_OK);
    return true;
}

static void assert_same(const collector *to, const hewn_volume_extract_stats *stats, const whole *expected)
{
    hewn_certificate certificate;
    const hewn_triangles *mesh = &expected->mesh;
    assert_int_equal(to->vertices, mesh->vertex_count);
    assert_int_equal(to->triangles, mesh->triangle_count);
    assert_int_equal(stats->vertices, mesh->vertex_count);
    assert_int_equal(stats->triangles, mesh->triangle_count);
    assert_int_equal(stats->parts, to->parts);
    assert_int_equal(stats->active_cells, expected->stats.active_cells);
    assert_int_equal(stats->decided_cells, expected->stats.decided_cells);
    assert_int_equal(stats->cap_vertices, expected->stats.cap_vertices);
    assert_memory_equal(to->positions, mesh->positions, 12 * mesh->vertex_count);
    if (mesh->normals)
        assert_memory_equal(to->normals, mesh->normals, 12 * mesh->vertex_count);
    assert_memory_equal(to->indices, mesh->indices, 12 * mesh->triangle_count);
    assert_int_equal(hewn_certifier_finish(to->certifier, &certificate, NULL), HEWN_OK);
    assert_int_equal(certificate.closed, expected->certificate.closed);
    assert_int_equal(certificate.manifold, expected->certificate.manifold);
    assert_int_equal(certificate.components, expected->certificate.components);
    assert_int_equal(certificate.genus, expected->certificate.genus);
    assert_memory_equal(&certificate.volume, &expected->certificate.volume, sizeof certificate.volume);
    assert_memory_equal(&certificate.area, &expected->certificate.area, sizeof certificate.area);
}

/* Returns how many parts there were; 0 where a slice does not fit, which must be told. */
static uint64_t compare(const grid *of, const hewn_volume_extract_desc *desc, uint64_t limit, const whole *expected)
{
    hewn_volume_extract_desc limited = *desc;
    hewn_volume_extract_stats stats;
    hewn_error error = {0};
    collector to;
    limited.max_memory = limit;
    make_collector(&to, &expected->mesh);
    const hewn_mesh_sink sink = {.user = &to, .take = take, .bytes = bytes};
    watch(UINT64_MAX);
    hewn_result result = hewn_volume_extract_parts(&of->volume, &limited, &sink, &stats, &error);
    heap.on = false;
    if (result == HEWN_OK)
        assert_same(&to, &stats, expected);
    else
        assert_true(result == HEWN_OUT_OF_MEMORY && limit > 0 && strstr(error.message, "that are allowed"));
    assert_true(limit == 0 || stats.peak_memory <= limit);
    free_collector(&to);
    return result == HEWN_OK ? stats.parts : 0;
}

/* --- the same mesh: HEWN_LONG asks for more requests and limits -----------------------------------------------------
 */

static void check_limits(const grid *of, const hewn_volume_extract_desc *desc, uint64_t *most)
{
    whole expected;
    if (!make_whole(of, desc, &expected))
        return;
    assert_int_equal(compare(of, desc, 0, &expected), 1);
    uint64_t step = getenv("HEWN_LONG") ? 4 : 1;
    for (uint64_t limit = 80000; limit < 8000000; limit += limit * 3 / step) {
        uint64_t parts = compare(of, desc, limit, &expected);
        *most = parts > *most ? parts : *most;
    }
    hewn_triangles_destroy(&expected.mesh);
}

static void test_same_mesh(void **state)
{
    (void)state;
    static grid of;
    uint64_t most = 0;
    for (int s = 0; s < SHAPES; s++)
        for (int kind = 0; kind < RANDOM_KINDS; kind++)
            for (int way = 0; way < 16; way++) {
                if (!getenv("HEWN_LONG") && (s + 3 * kind + way) % 7 != 0)
                    continue;
                make_grid(&of, shapes[s], (random_kind)kind, (uint64_t)(10 * s + kind));
                const hewn_volume_extract_desc desc = {.method = methods[way & 3],
                                                       .open = way & 4,
                                                       .no_normals = way & 8,
                                                       .inside = kind & 1 ? HEWN_INSIDE_BELOW : HEWN_INSIDE_ABOVE};
                check_limits(&of, &desc, &most);
            }
    if (most < 5)
        fail_msg("%llu parts at most", (unsigned long long)most);
}

/* What is counted is what is in use, but for a fixed table and what the heap adds to each block. */
static void test_heap_stays_below(void **state)
{
    (void)state;
    static grid of;
    make_grid(&of, shapes[3], RANDOM_NORMAL, 5);
    for (int method = 0; method < 4; method += 3) {
        const hewn_volume_extract_desc desc = {.method = methods[method]};
        whole expected;
        uint64_t most = 0;
        assert_true(make_whole(&of, &desc, &expected));
        for (uint64_t limit = 400000; limit < 4000000; limit += 700000) {
            const uint64_t parts = compare(&of, &desc, limit, &expected);
            most = parts > most ? parts : most;
            if (parts > 0 && heap.peak > (int64_t)limit + (64 << 10))
                fail_msg("%lld bytes were in use, %llu are allowed", (long long)heap.peak, (unsigned long long)limit);
        }
        assert_true(most > 2);
        hewn_triangles_destroy(&expected.mesh);
    }
}

/* --- what goes wrong ---------------------------------------------------------------------------------------------- */

static void test_every_allocation_fails(void **state)
{
    (void)state;
    static grid of;
    make_grid(&of, shapes[1], RANDOM_UNIFORM, 3);
    hewn_volume_extract_desc desc = {0};
    whole expected;
    assert_true(make_whole(&of, &desc, &expected));
    desc.max_memory = 450000;
    assert_true(compare(&of, &desc, desc.max_memory, &expected) > 2);
    uint64_t blocks = heap.blocks;
    assert_true(blocks > 20);
    for (uint64_t left = 0; left < blocks; left++) {
        collector to;
        hewn_error error = {0};
        make_collector(&to, &expected.mesh);
        const hewn_mesh_sink sink = {.user = &to, .take = take, .bytes = bytes};
        watch(left);
        hewn_result result = hewn_volume_extract_parts(&of.volume, &desc, &sink, NULL, &error);
        hewn_certifier_destroy(&to.certifier); /* made before the watch began */
        heap.on = false;
        assert_int_equal(result, HEWN_OUT_OF_MEMORY);
        assert_true(error.message[0] != '\0');
        if (heap.bytes > 0)
            fail_msg("%lld bytes were left behind", (long long)heap.bytes);
        free_collector(&to);
    }
    hewn_triangles_destroy(&expected.mesh);
}

static void test_failing_sink(void **state)
{
    (void)state;
    static grid of;
    make_grid(&of, shapes[1], RANDOM_UNIFORM, 3);
    hewn_volume_extract_desc desc = {0};
    whole expected;
    assert_true(make_whole(&of, &desc, &expected));
    desc.max_memory = 450000;
    for (uint64_t at = 1; at < 3; at++) {
        collector to;
        make_collector(&to, &expected.mesh);
        to.fail_at = at;
        const hewn_mesh_sink sink = {.user = &to, .take = take, .bytes = bytes};
        assert_int_equal(hewn_volume_extract_parts(&of.volume, &desc, &sink, NULL, NULL), HEWN_IO);
        assert_int_equal(to.parts, at);
        free_collector(&to);
    }
    hewn_triangles_destroy(&expected.mesh);
}

static bool keep_going(void *user, const char *stage, double share)
{
    uint64_t *left = user;
    assert_string_equal(stage, "extract");
    assert_true(share >= 0 && share <= 1);
    return (*left)-- > 0;
}

static void test_cancelled_at_every_report(void **state)
{
    (void)state;
    static grid of;
    uint64_t left = UINT64_MAX;
    const hewn_progress progress = {.report = keep_going, .user = &left};
    make_grid(&of, shapes[1], RANDOM_UNIFORM, 3);
    hewn_volume_extract_desc desc = {.progress = &progress};
    whole expected;
    assert_true(make_whole(&of, &desc, &expected));
    desc.max_memory = 450000;
    left = UINT64_MAX;
    assert_true(compare(&of, &desc, desc.max_memory, &expected) > 2);
    uint64_t reports = UINT64_MAX - left;
    assert_true(reports > 5);
    for (uint64_t stop = 0; stop < reports; stop++) {
        collector to;
        make_collector(&to, &expected.mesh);
        const hewn_mesh_sink sink = {.user = &to, .take = take, .bytes = bytes};
        left = stop;
        assert_int_equal(hewn_volume_extract_parts(&of.volume, &desc, &sink, NULL, NULL), HEWN_CANCELLED);
        free_collector(&to);
    }
    hewn_triangles_destroy(&expected.mesh);
}

static void test_no_surface(void **state)
{
    (void)state;
    static grid of;
    collector to = {0};
    const hewn_mesh_sink sink = {.user = &to, .take = take};
    hewn_volume_extract_desc desc = {.iso = 1e9, .max_memory = 200000};
    hewn_volume_extract_stats stats;
    make_grid(&of, shapes[0], RANDOM_UNIFORM, 1);
    assert_int_equal(hewn_volume_extract_parts(&of.volume, &desc, &sink, &stats, NULL), HEWN_BAD_INPUT);
    assert_true(to.parts == 0 && stats.active_cells == 0 && stats.stage_count > 0);
    desc.iso = NAN;
    assert_int_equal(hewn_volume_extract_parts(&of.volume, &desc, &sink, &stats, NULL), HEWN_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_mesh),
        cmocka_unit_test(test_heap_stays_below),
        cmocka_unit_test(test_every_allocation_fails),
        cmocka_unit_test(test_failing_sink),
        cmocka_unit_test(test_cancelled_at_every_report),
        cmocka_unit_test(test_no_surface),
    };
    return cmocka_run_group_tests_name("volume_parts", tests, NULL, NULL);
}
