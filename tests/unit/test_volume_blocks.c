/* Volumes in blocks are what they would be if all their samples lay in a row: the same samples, the same range and
 * percentiles, and the same mesh byte for byte, at once or in slabs; for random trees of blocks and constants with
 * steps between them. */
#include <limits.h>
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
#include "hewn/mesh.h"
#include "hewn/volume_extract.h"
#include "volume/blocks.h"
#include "volume/voxel.h"

/* --- the same samples twice --------------------------------------------------------------------------------------- */

typedef struct twins {
    hewn_volume blocks, dense;
    hewn_blocks_plan plan;
    char *samples; /* of `dense`: filled by the test itself, as the tree is made */
    int32_t origin[3];
    uint64_t random;
    random_kind kind;
    int32_t where[8192][3]; /* blocks that there are */
    uint64_t count;
} twins;

/* Values with ties, as the type has them. */
static void put_value(twins *of, char *to)
{
    hewn_voxel type = of->dense.type;
    double value = random_value(&of->random, of->kind);
    float single = (float)value;
    uint16_t half = random_below(&of->random, 3) == 0 ? 0 : (uint16_t)random_below(&of->random, 0x10000);
    int64_t whole = (int64_t)(value * 3);
    if (!hewn_voxel_is_integer(type) && random_below(&of->random, 200) == 0)
        value = (double)(single = random_below(&of->random, 2) ? NAN : -INFINITY);
    if (type == HEWN_VOXEL_FLOAT)
        memcpy(to, &single, 4);
    else if (type == HEWN_VOXEL_DOUBLE)
        memcpy(to, &value, 8);
    else if (type == HEWN_VOXEL_HALF)
        memcpy(to, &half, 2);
    else
        memcpy(to, &whole, hewn_voxel_size(type));
}

/* A sample of the dense twin by its place in the file's lattice; NULL outside. */
static char *sample_at(const twins *of, int64_t x, int64_t y, int64_t z)
{
    const int64_t at[3] = {x - of->origin[0], y - of->origin[1], z - of->origin[2]};
    const uint32_t *dims = of->dense.dims;
    for (int axis = 0; axis < 3; axis++)
        if (at[axis] < 0 || at[axis] >= dims[axis])
            return NULL;
    return of->samples + hewn_voxel_size(of->dense.type) *
                             ((uint64_t)at[0] + dims[0] * ((uint64_t)at[1] + (uint64_t)dims[1] * (uint64_t)at[2]));
}

static void fill_cube(const twins *of, const int32_t origin[3], int32_t side, const char *value)
{
    int64_t lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = origin[axis] > of->origin[axis] ? origin[axis] : of->origin[axis];
        hi[axis] = (int64_t)of->origin[axis] + of->dense.dims[axis];
        hi[axis] = (int64_t)origin[axis] + side < hi[axis] ? (int64_t)origin[axis] + side : hi[axis];
    }
    for (int64_t z = lo[2]; z < hi[2]; z++)
        for (int64_t y = lo[1]; y < hi[1]; y++)
            for (int64_t x = lo[0]; x < hi[0]; x++)
                memcpy(sample_at(of, x, y, z), value, hewn_voxel_size(of->dense.type));
}

static int32_t floor_to(int32_t value, int32_t side)
{
    return value - ((value % side) + side) % side;
}

static void choose_cube(twins *of, int32_t side, int32_t origin[3])
{
    for (int axis = 0; axis < 3; axis++)
        origin[axis] =
            floor_to(of->origin[axis] + (int32_t)random_below(&of->random, of->dense.dims[axis] + 16) - 8, side);
}

static void add_constants(twins *of, int32_t side, uint32_t count)
{
    char value[8] = {0};
    for (uint32_t n = 0; n < count; n++) {
        int32_t origin[3];
        choose_cube(of, side, origin);
        put_value(of, value);
        fill_cube(of, origin, side, value);
        assert_int_equal(hewn_blocks_add_constant(&of->plan, origin, (uint32_t)side, value, NULL), HEWN_OK);
    }
}

static void add_blocks(twins *of, uint32_t count)
{
    for (uint32_t n = 0; n < count; n++) {
        int32_t origin[3];
        bool added, known = false;
        choose_cube(of, HEWN_BLOCK, origin);
        for (uint64_t i = 0; i < of->count; i++)
            known |= memcmp(of->where[i], origin, sizeof origin) == 0;
        if (known)
            continue;
        assert_int_equal(hewn_blocks_add_block(&of->plan, origin, &added, NULL), HEWN_OK);
        assert_int_equal(added, hewn_blocks_hold(&of->plan, origin));
        if (added)
            memcpy(of->where[of->count++], origin, sizeof origin);
    }
}

static void fill_blocks(twins *of, char *samples)
{
    const size_t size = hewn_voxel_size(of->dense.type);
    for (uint64_t n = 0; n < of->count; n++)
        for (int i = 0; i < HEWN_BLOCK_SAMPLES; i++, samples += size) {
            put_value(of, samples);
            char *to = sample_at(of, of->where[n][0] + i % 8, of->where[n][1] + i / 8 % 8, of->where[n][2] + i / 64);
            if (to)
                memcpy(to, samples, size);
        }
}

/* Larger cubes first, as in a file, and each constant where no smaller thing is put later. */
static void make(twins *of, const uint32_t dims[3], hewn_voxel type, random_kind kind, uint64_t seed)
{
    char background[8] = {0};
    *of = (twins){.random = seed + 1, .kind = kind};
    of->dense = (hewn_volume){.frame_count = 1, .type = type, .slope = seed % 3 == 0 ? -0.5 : 1, .intercept = 0.25};
    memcpy(of->dense.dims, dims, sizeof of->dense.dims);
    for (int i = 0; i < 16; i++)
        of->dense.to_world[i] = i % 5 == 0;
    of->dense.to_world[2] = 0.25;
    of->dense.to_world[0] = seed % 2 ? -1 : 1;
    for (int axis = 0; axis < 3; axis++) { /* near where tables of all levels meet */
        static const int32_t near[4] = {0, -4096, 128, 4096 + 8};
        of->origin[axis] = near[random_below(&of->random, 4)] - (int32_t)random_below(&of->random, dims[axis] + 2);
    }
    of->samples = malloc((size_t)dims[0] * dims[1] * dims[2] * hewn_voxel_size(type));
    assert_non_null(of->samples);
    of->dense.samples = of->samples;
    put_value(of, background);
    const int32_t all[3] = {INT32_MIN / 2, INT32_MIN / 2, INT32_MIN / 2};
    fill_cube(of, all, INT32_MAX, background);
    assert_int_equal(hewn_blocks_begin(&of->dense, of->origin, background, &of->plan, NULL), HEWN_OK);
    if (seed % 4 == 0)
        add_constants(of, HEWN_UPPER_SPAN, 1);
    add_constants(of, HEWN_LOWER_SPAN, (uint32_t)(seed % 3));
    const uint32_t blocks = dims[0] * dims[1] * dims[2] / HEWN_BLOCK_SAMPLES + 1;
    add_constants(of, HEWN_BLOCK, random_below(&of->random, blocks));
    add_blocks(of, random_below(&of->random, blocks < 4000 ? blocks : 4000));
    of->blocks = of->dense;
    of->blocks.samples = NULL;
    of->blocks.memory_length = hewn_blocks_bytes(&of->plan);
    of->blocks.memory = aligned_alloc(64, of->blocks.memory_length);
    assert_non_null(of->blocks.memory);
    fill_blocks(of, hewn_blocks_finish(&of->plan, of->blocks.memory));
    of->blocks.blocks = of->blocks.memory;
    hewn_blocks_clear(&of->plan);
}

static void clear(twins *of)
{
    free(of->samples);
    free(of->blocks.memory);
}

static const uint32_t shapes[][3] = {{9, 10, 11},   {1, 7, 30}, {40, 9, 21}, {18, 33, 5},
                                     {150, 12, 10}, {8, 8, 8},  {17, 141, 6}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

/* --- samples and what is found in them ---------------------------------------------------------------------------- */

static void assert_same_double(double a, double b)
{
    if (memcmp(&a, &b, sizeof a) != 0 && !(isnan(a) && isnan(b)))
        fail_msg("%.17g is not %.17g", a, b);
}

static void test_same_samples(void **state)
{
    (void)state;
    static const hewn_voxel types[] = {HEWN_VOXEL_FLOAT, HEWN_VOXEL_HALF, HEWN_VOXEL_INT16, HEWN_VOXEL_DOUBLE};
    static twins of;
    for (uint64_t seed = 0; seed < 28; seed++) {
        make(&of, shapes[seed % SHAPES], types[seed % 4], (random_kind)(seed % RANDOM_KINDS), seed);
        const uint64_t size = hewn_volume_frame_size(&of.dense);
        for (uint64_t n = 0; n < size; n++)
            assert_same_double(hewn_volume_sample(&of.blocks, n), hewn_volume_sample(&of.dense, n));
        hewn_volume_range a = hewn_volume_find_range(&of.blocks, 0), b = hewn_volume_find_range(&of.dense, 0);
        assert_same_double(a.lo, b.lo);
        assert_same_double(a.hi, b.hi);
        assert_int_equal(a.finite_count, b.finite_count);
        assert_int_equal(a.nan_count, b.nan_count);
        assert_int_equal(a.infinite_count, b.infinite_count);
        for (double percent = 0; percent <= 100 && a.finite_count > 0; percent += 12.5) {
            double one, other;
            assert_int_equal(hewn_volume_find_percentile(&of.blocks, 0, percent, &one, NULL), HEWN_OK);
            assert_int_equal(hewn_volume_find_percentile(&of.dense, 0, percent, &other, NULL), HEWN_OK);
            assert_same_double(one, other);
        }
        hewn_volume_histogram one, other;
        if (a.sample_lo < a.sample_hi) {
            assert_int_equal(hewn_volume_find_histogram(&of.blocks, 0, a.sample_lo, a.sample_hi, 9, &one, NULL),
                             HEWN_OK);
            assert_int_equal(hewn_volume_find_histogram(&of.dense, 0, a.sample_lo, a.sample_hi, 9, &other, NULL),
                             HEWN_OK);
            assert_memory_equal(one.bins, other.bins, 9 * sizeof *one.bins);
            hewn_volume_histogram_destroy(&one);
            hewn_volume_histogram_destroy(&other);
        }
        clear(&of);
    }
}

/* --- meshes ------------------------------------------------------------------------------------------------------- */

static void assert_same_mesh(const hewn_triangles *a, const hewn_triangles *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->positions, b->positions, 12 * a->vertex_count);
    assert_int_equal(!a->normals, !b->normals);
    if (a->normals)
        assert_memory_equal(a->normals, b->normals, 12 * a->vertex_count);
    assert_memory_equal(a->indices, b->indices, 12 * a->triangle_count);
}

typedef struct collector {
    hewn_triangles mesh;
    uint64_t vertices, triangles, parts;
} collector;

static hewn_result take(void *user, const hewn_mesh_part *part, hewn_error *error)
{
    collector *to = user;
    (void)error;
    to->parts++;
    for (int i = 0; i < 2; i++) {
        const hewn_vertex_run *vertices = &part->vertices[i];
        const hewn_triangle_run *triangles = &part->triangles[i];
        assert_true(vertices->count == 0 || vertices->first + vertices->count <= to->mesh.vertex_count);
        assert_true(triangles->count == 0 || triangles->first + triangles->count <= to->mesh.triangle_count);
        if (vertices->count > 0)
            memcpy(to->mesh.positions + 3 * vertices->first, vertices->positions, 12 * vertices->count);
        if (vertices->count > 0 && vertices->normals)
            memcpy(to->mesh.normals + 3 * vertices->first, vertices->normals, 12 * vertices->count);
        if (triangles->count > 0)
            memcpy(to->mesh.indices + 3 * triangles->first, triangles->indices, 12 * triangles->count);
        to->vertices += vertices->count;
        to->triangles += triangles->count;
    }
    return HEWN_OK;
}

/* In slabs as small as memory makes them: returns how many. */
static uint64_t compare_parts(const twins *of, const hewn_volume_extract_desc *desc, const hewn_triangles *whole)
{
    uint64_t most = 0;
    for (uint64_t limit = 0; limit < 1u << 26; limit = limit == 0 ? of->blocks.memory_length + 60000 : limit * 4) {
        hewn_volume_extract_desc limited = *desc;
        hewn_volume_extract_stats stats;
        collector to = {.mesh = *whole};
        limited.max_memory = limit;
        to.mesh.positions = malloc(12 * whole->vertex_count);
        to.mesh.normals = malloc(12 * whole->vertex_count);
        to.mesh.indices = malloc(12 * whole->triangle_count);
        assert_true(to.mesh.positions && to.mesh.normals && to.mesh.indices);
        const hewn_mesh_sink sink = {.user = &to, .take = take};
        hewn_error error = {0};
        hewn_result result = hewn_volume_extract_parts(&of->blocks, &limited, &sink, &stats, &error);
        if (result == HEWN_OK) {
            assert_int_equal(to.vertices, whole->vertex_count);
            assert_int_equal(to.triangles, whole->triangle_count);
            if (!whole->normals) {
                free(to.mesh.normals);
                to.mesh.normals = NULL;
            }
            assert_same_mesh(&to.mesh, whole);
            most = to.parts > most ? to.parts : most;
        } else {
            if (result != HEWN_OUT_OF_MEMORY || !strstr(error.message, "that are allowed"))
                fail_msg("%d: %s", result, error.message);
        }
        free(to.mesh.positions);
        free(to.mesh.normals);
        free(to.mesh.indices);
    }
    return most;
}

static void compare(const twins *of, const hewn_volume_extract_desc *desc, uint64_t *meshes, uint64_t *parts)
{
    hewn_triangles a, b;
    hewn_volume_extract_stats one, other;
    hewn_error first = {0}, second = {0};
    hewn_result result = hewn_volume_extract(&of->dense, desc, &a, &one, &first);
    assert_int_equal(hewn_volume_extract(&of->blocks, desc, &b, &other, &second), result);
    assert_string_equal(first.message, second.message);
    assert_int_equal(one.active_cells, other.active_cells);
    assert_int_equal(one.decided_cells, other.decided_cells);
    if (result == HEWN_OK) {
        assert_int_equal(one.cap_vertices, other.cap_vertices);
        assert_memory_equal(&one.bodies, &other.bodies, sizeof one.bodies);
        assert_same_mesh(&a, &b);
        *meshes += a.triangle_count > 0;
        if (!desc->keep) {
            uint64_t count = compare_parts(of, desc, &b);
            *parts = count > *parts ? count : *parts;
        }
    }
    hewn_triangles_destroy(&a);
    hewn_triangles_destroy(&b);
}

static void test_same_mesh(void **state)
{
    (void)state;
    static const hewn_voxel types[] = {HEWN_VOXEL_FLOAT, HEWN_VOXEL_UINT8, HEWN_VOXEL_HALF, HEWN_VOXEL_DOUBLE,
                                       HEWN_VOXEL_INT32};
    static const hewn_method methods[] = {HEWN_METHOD_MC33, HEWN_METHOD_NETS, HEWN_METHOD_MC33,
                                          HEWN_METHOD_DC,   HEWN_METHOD_NETS, HEWN_METHOD_MARCHING_CUBES};
    static const hewn_body_choice choices[] = {{.largest = 2}, {.fill_cavities = true}, {.least_volume = 3}};
    static twins of;
    uint64_t meshes = 0, parts = 0, seeds = getenv("HEWN_LONG") ? 1500 : 35;
    for (uint64_t seed = 0; seed < seeds; seed++) {
        make(&of, shapes[seed % SHAPES], types[seed % 5], (random_kind)(seed / 2 % RANDOM_KINDS), 1000 + seed);
        const hewn_volume_extract_desc desc = {.method = methods[seed % 6],
                                               .iso = of.dense.type == HEWN_VOXEL_UINT8 ? 1.25 : 0.25,
                                               .inside = seed % 3 == 1 ? HEWN_INSIDE_BELOW : HEWN_INSIDE_ABOVE,
                                               .open = seed % 5 == 2,
                                               .no_normals = seed % 7 == 6,
                                               .keep = seed % 11 < 3 && seed % 5 != 2 ? &choices[seed % 11] : NULL};
        compare(&of, &desc, &meshes, &parts);
        clear(&of);
    }
    if (meshes < seeds / 2 || parts < 4)
        fail_msg("%llu meshes and %llu parts at most are too few to tell", (unsigned long long)meshes,
                 (unsigned long long)parts);
}

/* --- what is refused ---------------------------------------------------------------------------------------------- */

static void test_bricks_need_rows(void **state)
{
    (void)state;
    static twins of;
    hewn_volume_bricks bricks;
    hewn_error error = {0};
    make(&of, shapes[0], HEWN_VOXEL_FLOAT, RANDOM_UNIFORM, 7);
    assert_int_equal(hewn_volume_find_bricks(&of.blocks, 0, &bricks, &error), HEWN_INVALID_ARGUMENT);
    assert_non_null(strstr(error.message, "blocks"));
    assert_null(hewn_volume_frame(&of.blocks, 0));
    clear(&of);
}

/* A background that is inside, `side` samples long, with two blocks at its ends that are not: its border passes
 * 6 (side / 8)^2 blocks, however little the file holds. */
static hewn_volume make_hollow(uint32_t side)
{
    const int32_t first[3] = {0, 0, 0};
    const float inside = 1;
    hewn_volume volume = {.dims = {side, side, side}, .type = HEWN_VOXEL_FLOAT, .frame_count = 1, .slope = 1};
    hewn_blocks_plan plan;
    for (int i = 0; i < 16; i++)
        volume.to_world[i] = i % 5 == 0;
    assert_int_equal(hewn_blocks_begin(&volume, first, &inside, &plan, NULL), HEWN_OK);
    for (int32_t n = 0; n < 2; n++) {
        const int32_t at = n * ((int32_t)side - 8) / 8 * 8, origin[3] = {at, at, at};
        bool added;
        assert_int_equal(hewn_blocks_add_block(&plan, origin, &added, NULL), HEWN_OK);
        assert_true(added);
    }
    volume.memory_length = hewn_blocks_bytes(&plan);
    volume.memory = aligned_alloc(64, volume.memory_length);
    assert_non_null(volume.memory);
    memset(hewn_blocks_finish(&plan, volume.memory), 0, 2 * sizeof(float) * HEWN_BLOCK_SAMPLES);
    volume.blocks = volume.memory;
    hewn_blocks_clear(&plan);
    return volume;
}

static bool go_on_for(void *user, const char *stage, double fraction)
{
    int *calls = user;
    assert_string_equal(stage, "extract");
    assert_true(fraction == 0);
    return (*calls)-- > 0;
}

static void assert_refused(const hewn_volume *volume, uint64_t max_memory, int calls, hewn_result code,
                           const char *message)
{
    const hewn_mesh_sink sink = {.user = NULL, .take = NULL}; /* nothing gets so far */
    const hewn_progress progress = {.report = go_on_for, .user = &calls};
    const hewn_volume_extract_desc desc = {.iso = 0.5, .max_memory = max_memory, .progress = &progress};
    hewn_volume_extract_stats stats;
    hewn_error error = {0};
    const hewn_result result = hewn_volume_extract_parts(volume, &desc, &sink, &stats, &error);
    if (result != code || !strstr(error.message, message))
        fail_msg("%d: %s", result, error.message);
}

/* Work is refused before it is done: at the border of what memory or numbers allow, or when nobody wants it any more.
 */
static void test_large_surfaces_are_refused(void **state)
{
    (void)state;
    const bool all = getenv("HEWN_LONG") != NULL;
    hewn_volume volume = make_hollow(all ? 1 << 17 : 1 << 15);
    assert_refused(&volume, volume.memory_length + (4 << 20), INT_MAX, HEWN_OUT_OF_MEMORY,
                   "blocks that the surface passes");
    assert_refused(&volume, 1 << 10, INT_MAX, HEWN_OUT_OF_MEMORY, "that are allowed");
    assert_refused(&volume, 0, 3, HEWN_CANCELLED, "extract");
    assert_refused(&volume, (uint64_t)1 << 40, 3, HEWN_CANCELLED, "extract");
    if (all)
        assert_refused(&volume, 0, INT_MAX, HEWN_LIMIT, "blocks of 8 x 8 x 8");
    free(volume.memory);
}

/* Cubes that do not begin at a multiple of their side, and second ones at one place, wherever they lie. */
static void test_places_are_checked(void **state)
{
    (void)state;
    const hewn_volume volume = {.dims = {40, 40, 40}, .type = HEWN_VOXEL_FLOAT, .frame_count = 1};
    const float background = 1, value = 2;
    static const uint32_t sides[3] = {HEWN_UPPER_SPAN, HEWN_LOWER_SPAN, HEWN_BLOCK};
    static const int32_t starts[][3] = {{18, 18, 18}, {0, 0, 0}, {1, 4095, -4000}, {INT32_MIN / 2, 3, 4}};
    uint64_t random = 5;
    for (uint32_t n = 0; n < 4000; n++) {
        const int32_t *first = starts[n % 4];
        const uint32_t side = sides[n / 4 % 3];
        hewn_blocks_plan plan;
        hewn_error error = {0};
        int32_t origin[3], shift = 0;
        bool added = true;
        assert_int_equal(hewn_blocks_begin(&volume, first, &background, &plan, NULL), HEWN_OK);
        for (int axis = 0; axis < 3; axis++) {
            origin[axis] = floor_to(first[axis] + (int32_t)random_below(&random, 40), (int32_t)side);
            if (n % 2 && random_below(&random, 2)) {
                origin[axis] += (int32_t)random_below(&random, 2 * side - 1) - (int32_t)side + 1;
                shift |= origin[axis] % (int32_t)side;
            }
        }
        const hewn_result wanted = shift ? HEWN_BAD_INPUT : HEWN_OK;
        if (side == HEWN_BLOCK && n / 12 % 2) {
            assert_int_equal(hewn_blocks_add_block(&plan, origin, &added, &error), wanted);
            assert_int_equal(added, plan.head.block_count);
            assert_true(!added || hewn_blocks_hold(&plan, origin));
            if (added) {
                assert_int_equal(hewn_blocks_add_block(&plan, origin, &added, &error), HEWN_BAD_INPUT);
                assert_false(added);
                assert_int_equal(hewn_blocks_add_constant(&plan, origin, side, &value, &error), HEWN_BAD_INPUT);
                assert_non_null(strstr(error.message, "two cubes"));
                assert_int_equal(plan.head.block_count, 1);
            }
        } else {
            assert_int_equal(hewn_blocks_add_constant(&plan, origin, side, &value, &error), wanted);
        }
        if (shift)
            assert_non_null(strstr(error.message, "multiples"));
        hewn_blocks_clear(&plan);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_samples),       cmocka_unit_test(test_same_mesh),
        cmocka_unit_test(test_bricks_need_rows),   cmocka_unit_test(test_large_surfaces_are_refused),
        cmocka_unit_test(test_places_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
