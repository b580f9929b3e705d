/* Meshes in parts: put together they are the mesh that is made at once, with its certificate and statistics, whatever
 * the limit of memory; what is in use stays below the limit; and whatever goes wrong is an error, with nothing left. */
#include <malloc.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "eval/lists.h"
#include "gpu/device.h"
#include "gpu_test_device.h"
#include "hewn/hewn.h"
#include "iso/extractor.h"

static const hewn_method methods[] = {HEWN_METHOD_MARCHING_CUBES, HEWN_METHOD_MC33, HEWN_METHOD_NETS, HEWN_METHOD_DC};
enum { METHODS = sizeof methods / sizeof *methods };

/* --- the heap under watch ----------------------------------------------------------------------------------------- */

/* Hewn's own allocations, not those of the driver: the linker leads them here. */
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
void __wrap_free(void *block);

/* Several threads allocate: all of this is read and written one at a time. */
enum { MEMORIES = 256 };
static struct {
    bool on;
    int64_t bytes, peak; /* of heap and device since it was switched on, and the most of that */
    uint64_t left;       /* allocations that may yet succeed */
    VkDeviceMemory memories[MEMORIES];
    int64_t sizes[MEMORIES]; /* 0: there is none */
} heap;

static void note(int64_t bytes)
{
    heap.bytes += bytes;
    heap.peak = heap.bytes > heap.peak ? heap.bytes : heap.peak;
}

static bool may_allocate(void)
{
    bool may = true;
    if (heap.on) {
#pragma omp critical(test_heap)
        {
            may = heap.left > 0;
            heap.left -= may;
        }
    }
    return may;
}

static void add(void *block, int sign)
{
    if (!heap.on || !block)
        return;
#pragma omp critical(test_heap)
    note(sign * (int64_t)malloc_usable_size(block));
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

static PFN_vkAllocateMemory real_allocate;
static PFN_vkFreeMemory real_release;

static VKAPI_ATTR VkResult VKAPI_CALL watched_allocate(VkDevice handle, const VkMemoryAllocateInfo *info,
                                                       const VkAllocationCallbacks *callbacks, VkDeviceMemory *out)
{
    if (!may_allocate())
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    VkResult result = real_allocate(handle, info, callbacks, out);
    if (result != VK_SUCCESS)
        return result;
#pragma omp critical(test_heap)
    {
        int at = 0;
        while (at < MEMORIES - 1 && heap.sizes[at] > 0)
            at++;
        heap.memories[at] = *out;
        heap.sizes[at] = (int64_t)info->allocationSize;
        note(heap.sizes[at]);
    }
    return result;
}

static VKAPI_ATTR void VKAPI_CALL watched_release(VkDevice handle, VkDeviceMemory memory,
                                                  const VkAllocationCallbacks *callbacks)
{
#pragma omp critical(test_heap)
    for (int at = 0; at < MEMORIES; at++)
        if (heap.sizes[at] > 0 && heap.memories[at] == memory) {
            note(-heap.sizes[at]);
            heap.sizes[at] = 0;
        }
    real_release(handle, memory, callbacks);
}

/* From here on `count` allocations of heap and device succeed. */
static void watch_memory(uint64_t count)
{
    real_allocate = device->vk.AllocateMemory;
    real_release = device->vk.FreeMemory;
    device->vk.AllocateMemory = watched_allocate;
    device->vk.FreeMemory = watched_release;
    memset(heap.sizes, 0, sizeof heap.sizes);
    heap.bytes = heap.peak = 0;
    heap.left = count;
    heap.on = true;
}

static void watch_no_more(void)
{
    heap.on = false;
    device->vk.AllocateMemory = real_allocate;
    device->vk.FreeMemory = real_release;
}

/* --- fields ------------------------------------------------------------------------------------------------------- */

typedef hewn_node maker(hewn_field *field);

typedef struct subject {
    hewn_field *field;
    hewn_extractor *extractor;
} subject;

static subject make_subject(maker *make, hewn_evaluation evaluation)
{
    subject made = {0};
    hewn_code_desc desc = {.evaluation = evaluation};
    GPU_TEST_TRY(hewn_field_create(&made.field, &error));
    hewn_node root = make(made.field);
    GPU_TEST_TRY(hewn_field_status(made.field, &error));
    GPU_TEST_TRY(hewn_extractor_create_as(device, made.field, root, &desc, &made.extractor, &error));
    return made;
}

static void free_subject(subject *made)
{
    hewn_extractor_destroy(&made->extractor);
    hewn_field_destroy(&made->field);
}

/* A wall that leaves the bounds, a blend, a ring, and a wire that no sample shows. */
static hewn_node make_part(hewn_field *field)
{
    hewn_node wall = hewn_rotate(field, hewn_box_shape(field, 2.5, 0.09, 1.2), 1, 0.4, 0.3, 0.5);
    hewn_node wire = hewn_translate(field, hewn_box_shape(field, 0.0011, 0.0011, 1.7), -0.813, -0.827, 0);
    hewn_node round =
        hewn_smooth_union(field, hewn_sphere(field, 0.4), hewn_torus(field, 0.7, 0.11), HEWN_BLEND_QUADRATIC, 0.2);
    return hewn_union(field, wire, hewn_union(field, wall, round));
}

/* So rough that cells of all kinds come, and many of them: doubtful faces, and centres by mc33. */
static hewn_node make_rough(hewn_field *field)
{
    hewn_node sum = hewn_constant(field, 0);
    static const double waves[][4] = {{31, 17, 5, 0.3}, {7, 29, 23, 1.1}, {19, 3, 37, 2.7}, {41, 11, 13, 0.9}};
    for (size_t i = 0; i < sizeof waves / sizeof *waves; i++) {
        hewn_node x = hewn_mul(field, hewn_x(field), hewn_constant(field, waves[i][0]));
        hewn_node y = hewn_mul(field, hewn_y(field), hewn_constant(field, waves[i][1]));
        hewn_node z = hewn_mul(field, hewn_z(field), hewn_constant(field, waves[i][2]));
        hewn_node along = hewn_add(field, hewn_add(field, x, y), hewn_add(field, z, hewn_constant(field, waves[i][3])));
        sum = hewn_add(field, sum, hewn_sin(field, along));
    }
    return sum;
}

static hewn_node make_boxes(hewn_field *field)
{
    hewn_node all = HEWN_NODE_NONE;
    for (int i = 0; i < 27; i++) {
        hewn_node box = hewn_box_shape(field, 0.31, 0.23, 0.37);
        hewn_node ball = hewn_sphere(field, 0.17);
        hewn_node one = hewn_translate(field, hewn_rotate(field, i % 2 ? box : ball, 1, 0.2 * i, 1, 0.3 * i),
                                       0.6 * (i % 3 - 1), 0.6 * (i / 3 % 3 - 1), 0.6 * (i / 9 - 1));
        all = i == 0 ? one : hewn_smooth_union(field, all, one, HEWN_BLEND_QUADRATIC, 0.1);
    }
    return all;
}

/* --- putting parts together --------------------------------------------------------------------------------------- */

enum { MOST_PARTS = 4096 };

/* Takes parts into arrays that are as long as the whole, and certifies them. It may take its time, and hold memory. */
typedef struct collector {
    const hewn_triangles *whole;
    float *positions, *normals;
    uint32_t *indices;
    uint8_t *has_vertex, *has_triangle;
    uint64_t vertices, triangles;
    hewn_certifier *certifier;
    uint64_t parts, fail_at; /* 0: never */
    hewn_result failure;
    unsigned pause;              /* microseconds a part, more for every third one */
    uint64_t a_vertex, held;     /* bytes that are held from part to part for each vertex that came */
    void *blocks[MOST_PARTS];    /* they are */
    uint64_t firsts[MOST_PARTS]; /* the triangle that each part begins with */
} collector;

static collector make_collector(const hewn_triangles *whole)
{
    collector made = {.whole = whole};
    made.positions = malloc(12 * whole->vertex_count);
    made.normals = malloc(12 * whole->vertex_count);
    made.indices = malloc(12 * whole->triangle_count);
    made.has_vertex = calloc(whole->vertex_count, 1);
    made.has_triangle = calloc(whole->triangle_count, 1);
    GPU_TEST_TRY(hewn_certifier_create(&made.certifier, &error));
    return made;
}

static void free_collector(collector *made)
{
    free(made->positions);
    free(made->normals);
    free(made->indices);
    free(made->has_vertex);
    free(made->has_triangle);
    for (uint64_t i = 0; i < made->parts && i < MOST_PARTS; i++)
        free(made->blocks[i]);
    hewn_certifier_destroy(&made->certifier);
}

static void mark(uint8_t *has, uint64_t first, uint64_t count, uint64_t most)
{
    assert_true(first + count <= most);
    for (uint64_t i = first; i < first + count; i++) {
        assert_false(has[i]);
        has[i] = 1;
    }
}

static uint64_t hoard_of(const collector *of, const hewn_mesh_part *part)
{
    return of->a_vertex * (part->vertices[0].count + part->vertices[1].count);
}

/* Memory that stays until the collector goes. */
static hewn_result hoard(collector *to, const hewn_mesh_part *part)
{
    uint64_t bytes = hoard_of(to, part);
    void **block = &to->blocks[to->parts - 1];
    *block = bytes > 0 ? malloc(bytes) : NULL;
    to->held += *block ? malloc_usable_size(*block) : 0;
    return bytes == 0 || *block ? HEWN_OK : HEWN_OUT_OF_MEMORY;
}

static hewn_result take(void *user, const hewn_mesh_part *part, hewn_error *error)
{
    collector *to = user;
    assert_true(to->parts < MOST_PARTS);
    to->firsts[to->parts] = part->triangles[0].first;
    if (++to->parts == to->fail_at) {
        if (error)
            error->code = to->failure;
        return to->failure;
    }
    if (to->pause > 0)
        usleep(to->pause * (1 + 4 * (to->parts % 3 == 0)));
    if (hoard(to, part) != HEWN_OK)
        return HEWN_OUT_OF_MEMORY;
    for (int i = 0; i < 2; i++) {
        const hewn_vertex_run *vertices = &part->vertices[i];
        const hewn_triangle_run *triangles = &part->triangles[i];
        if (vertices->count > 0) {
            mark(to->has_vertex, vertices->first, vertices->count, to->whole->vertex_count);
            memcpy(to->positions + 3 * vertices->first, vertices->positions, 12 * vertices->count);
            memcpy(to->normals + 3 * vertices->first, vertices->normals, 12 * vertices->count);
        }
        if (triangles->count > 0) {
            mark(to->has_triangle, triangles->first, triangles->count, to->whole->triangle_count);
            memcpy(to->indices + 3 * triangles->first, triangles->indices, 12 * triangles->count);
        }
        to->vertices += vertices->count;
        to->triangles += triangles->count;
    }
    return hewn_certifier_take(to->certifier, part, error);
}

static uint64_t bytes(void *user, const hewn_mesh_part *part)
{
    const collector *of = user;
    return hewn_certifier_bytes(of->certifier, part) + of->held + (part ? hoard_of(of, part) + 32 : 0);
}

static void assert_same_certificate(const hewn_certificate *a, const hewn_certificate *b)
{
    assert_true(a->closed == b->closed && a->manifold == b->manifold && a->oriented == b->oriented);
    assert_int_equal(a->components, b->components);
    assert_int_equal(a->genus, b->genus);
    assert_int_equal(a->boundary_edges, b->boundary_edges);
    assert_int_equal(a->non_manifold_edges, b->non_manifold_edges);
    assert_int_equal(a->non_manifold_vertices, b->non_manifold_vertices);
    assert_int_equal(a->degenerate_faces, b->degenerate_faces);
    assert_memory_equal(&a->volume, &b->volume, sizeof a->volume);
    assert_memory_equal(&a->area, &b->area, sizeof a->area);
    assert_memory_equal(&a->bounds, &b->bounds, sizeof a->bounds);
}

static void assert_same_stats(const hewn_extract_stats *a, const hewn_extract_stats *b)
{
    assert_true(a->method == b->method && a->left_bounds == b->left_bounds);
    assert_memory_equal(&a->bounds, &b->bounds, sizeof a->bounds);
    assert_memory_equal(a->cells, b->cells, sizeof a->cells);
    assert_int_equal(a->cells_visited, b->cells_visited);
    assert_int_equal(a->bricks_active, b->bricks_active);
    assert_int_equal(a->cap_vertices, b->cap_vertices);
    assert_memory_equal(&a->max_residual, &b->max_residual, sizeof a->max_residual);
    assert_int_equal(a->suspect_cells, b->suspect_cells);
    assert_memory_equal(&a->first_suspect, &b->first_suspect, sizeof a->first_suspect);
    assert_int_equal(a->undefined_cells, b->undefined_cells);
    assert_int_equal(a->fans, b->fans);
    assert_int_equal(a->edge_vertices, b->edge_vertices);
    assert_int_equal(a->corner_vertices, b->corner_vertices);
    assert_int_equal(a->planes_found, b->planes_found);
    assert_int_equal(a->features_lost, b->features_lost);
}

/* What parts are held against. */
typedef struct whole {
    hewn_triangles mesh;
    hewn_extract_stats stats;
    hewn_certificate certificate;
} whole;

static whole make_whole(const subject *made, const hewn_extract_desc *desc)
{
    whole out;
    GPU_TEST_TRY(hewn_extract(made->extractor, desc, &out.mesh, &out.stats, &error));
    GPU_TEST_TRY(hewn_certify(&out.mesh, NULL, &out.certificate, &error));
    return out;
}

/* Makes the mesh in parts for a collector. */
static void collect(const subject *made, const hewn_extract_desc *desc, uint64_t limit, const whole *expected,
                    collector *to, hewn_extract_stats *stats)
{
    hewn_extract_desc limited = *desc;
    hewn_certificate certificate;
    const hewn_mesh_sink sink = {.user = to, .take = take, .bytes = bytes};
    limited.max_memory = limit;
    uint64_t device_bytes = device->bytes;
    watch_memory(UINT64_MAX);
    GPU_TEST_TRY(hewn_extract_parts(made->extractor, &limited, &sink, stats, &error));
    watch_no_more();
    assert_true(limit == 0 || stats->peak_memory <= limit);
    if (limit > 0 && heap.peak > (int64_t)limit)
        fail_msg("%lld bytes were in use, %llu are allowed", (long long)heap.peak, (unsigned long long)limit);
    assert_int_equal(device->bytes, device_bytes);
    GPU_TEST_TRY(hewn_certifier_finish(to->certifier, &certificate, &error));
    assert_int_equal(stats->parts, to->parts);
    assert_int_equal(stats->vertices, expected->mesh.vertex_count);
    assert_int_equal(stats->triangles, expected->mesh.triangle_count);
    assert_int_equal(to->vertices, expected->mesh.vertex_count);
    assert_int_equal(to->triangles, expected->mesh.triangle_count);
    assert_memory_equal(to->positions, expected->mesh.positions, 12 * to->vertices);
    assert_memory_equal(to->normals, expected->mesh.normals, 12 * to->vertices);
    assert_memory_equal(to->indices, expected->mesh.indices, 12 * to->triangles);
    assert_same_certificate(&certificate, &expected->certificate);
    assert_same_stats(stats, &expected->stats);
}

/* Makes the mesh in parts and returns how many there were. */
static uint64_t compare(const subject *made, const hewn_extract_desc *desc, uint64_t limit, const whole *expected)
{
    hewn_extract_stats stats;
    collector to = make_collector(&expected->mesh);
    collect(made, desc, limit, expected, &to, &stats);
    free_collector(&to);
    return stats.parts;
}

/* The same under several limits, which leave so many bytes beside what the device holds already. */
static void compare_limits(const subject *made, const hewn_extract_desc *desc, const uint64_t *limits, size_t count)
{
    whole expected = make_whole(made, desc);
    uint64_t least = compare(made, desc, 0, &expected);
    assert_int_equal(least, 1);
    for (size_t i = 0; i < count; i++) {
        uint64_t parts = compare(made, desc, limits[i], &expected);
        least = parts > least ? parts : least;
    }
    assert_true(least > 5);
    hewn_triangles_destroy(&expected.mesh);
}

#define LIMITS(...) (const uint64_t[]){__VA_ARGS__}, sizeof((const uint64_t[]){__VA_ARGS__}) / sizeof(uint64_t)

static const hewn_box unit_cube = {{-1, -1, -1}, {1, 1, 1}};

/* --- the same mesh ------------------------------------------------------------------------------------------------ */

static void test_every_method(void **state)
{
    (void)state;
    subject made = make_subject(make_part, HEWN_EVALUATION_STRAIGHT);
    for (size_t m = 0; m < METHODS; m++)
        for (int open = 0; open < 2; open++) {
            hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 64, .method = methods[m], .open = open};
            compare_limits(&made, &desc, LIMITS(1000000, 600000));
        }
    free_subject(&made);
}

static void test_quads(void **state)
{
    (void)state;
    subject made = make_subject(make_part, HEWN_EVALUATION_STRAIGHT);
    for (size_t m = 2; m < METHODS; m++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 64, .method = methods[m], .quads = true};
        compare_limits(&made, &desc, LIMITS(900000));
    }
    free_subject(&made);
}

static void test_lists(void **state)
{
    (void)state;
    subject made = make_subject(make_boxes, HEWN_EVALUATION_LISTED);
    for (size_t m = 0; m < METHODS; m++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 72, .method = methods[m]};
        compare_limits(&made, &desc, LIMITS(1600000, 800000));
    }
    free_subject(&made);
}

/* Doubtful faces and cells that values decide, at all seams. */
static void test_rough(void **state)
{
    (void)state;
    subject made = make_subject(make_rough, HEWN_EVALUATION_STRAIGHT);
    for (size_t m = 0; m < METHODS; m++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 40, .method = methods[m]};
        compare_limits(&made, &desc, LIMITS(7000000, 4500000));
    }
    free_subject(&made);
}

/* Two and three levels of culling; parts end within blocks. */
static void test_levels(void **state)
{
    (void)state;
    static const double lengths[] = {180, 600};
    subject made = make_subject(make_rough, HEWN_EVALUATION_STRAIGHT);
    for (size_t i = 0; i < 2; i++)
        for (size_t m = 0; m < METHODS; m++)
            for (int axis = 0; axis < 3; axis++) {
                hewn_extract_desc desc = {.cell = 0.02, .method = methods[m]};
                for (int k = 0; k < 3; k++) {
                    desc.bounds.lo[k] = -0.14;
                    desc.bounds.hi[k] = k == axis ? 0.02 * lengths[i] - 0.14 : 0.14;
                }
                if (i == 0 || (m + (size_t)axis) % 3 == 0)
                    compare_limits(&made, &desc, LIMITS(900000));
            }
    free_subject(&made);
}

/* A device whose memory the host does not reach, as graphics cards are. */
static void test_memory_out_of_reach(void **state)
{
    (void)state;
    const hewn_device_kind kind = device->info.kind;
    for (size_t m = 0; m < METHODS; m++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 48, .method = methods[m]};
        device->info.kind = HEWN_DEVICE_DISCRETE;
        subject made = make_subject(make_part, HEWN_EVALUATION_STRAIGHT);
        compare_limits(&made, &desc, LIMITS(600000));
        free_subject(&made);
        device->info.kind = kind;
    }
}

/* Sinks that hold more with each part leave less for the next ones. However long they take, parts are the same. */
static void test_sinks_that_hold_memory(void **state)
{
    (void)state;
    static const unsigned pauses[] = {0, 2000, 300};
    for (size_t m = 0; m < METHODS; m++) {
        subject made = make_subject(make_part, HEWN_EVALUATION_STRAIGHT);
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 64, .method = methods[m]};
        whole expected = make_whole(&made, &desc);
        uint64_t a_vertex = 1000000 / expected.mesh.vertex_count, parts = 0, peak = 0;
        uint64_t *firsts = calloc(MOST_PARTS, sizeof *firsts);
        for (size_t i = 0; i < sizeof pauses / sizeof *pauses; i++) {
            hewn_extract_stats stats;
            collector to = make_collector(&expected.mesh);
            to.pause = pauses[i];
            to.a_vertex = a_vertex;
            collect(&made, &desc, 1900000, &expected, &to, &stats);
            assert_true(to.held >= a_vertex * to.vertices && stats.parts > 4);
            assert_true(i == 0 || (stats.parts == parts && stats.peak_memory == peak));
            if (i > 0)
                assert_memory_equal(firsts, to.firsts, parts * sizeof *firsts);
            parts = stats.parts;
            peak = stats.peak_memory;
            memcpy(firsts, to.firsts, sizeof to.firsts);
            free_collector(&to);
        }
        free(firsts);
        hewn_triangles_destroy(&expected.mesh);
        free_subject(&made);
    }
}

/* --- what goes wrong ---------------------------------------------------------------------------------------------- */

static void test_refusals(void **state)
{
    (void)state;
    subject made = make_subject(make_part, HEWN_EVALUATION_STRAIGHT);
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 48};
    whole expected = make_whole(&made, &desc);
    collector to = make_collector(&expected.mesh);
    const hewn_mesh_sink sink = {.user = &to, .take = take, .bytes = bytes};
    hewn_error error = {0};
    uint64_t before = device->bytes;
    desc.max_memory = 20000;
    assert_int_equal(hewn_extract_parts(made.extractor, &desc, &sink, NULL, &error), HEWN_OUT_OF_DEVICE_MEMORY);
    assert_non_null(strstr(error.message, "more than the 20000 that are allowed"));
    desc.adaptive = 0.1;
    assert_int_equal(hewn_extract_parts(made.extractor, &desc, &sink, NULL, &error), HEWN_INVALID_ARGUMENT);
    desc.adaptive = 0;
    hewn_triangles mesh;
    assert_int_equal(hewn_extract(made.extractor, &desc, &mesh, NULL, &error), HEWN_OUT_OF_DEVICE_MEMORY);
    assert_int_equal(to.parts, 0);
    assert_int_equal(device->bytes, before);
    assert_int_equal(device->most_bytes, 0);
    free_collector(&to);
    hewn_triangles_destroy(&expected.mesh);
    free_subject(&made);
}

/* A sink's failure ends the run, also where a part that is refused for its size would be made smaller. */
static void test_failing_sink(void **state)
{
    (void)state;
    static const hewn_result failures[] = {HEWN_IO, HEWN_LIMIT, HEWN_OUT_OF_DEVICE_MEMORY, HEWN_CANCELLED};
    subject made = make_subject(make_part, HEWN_EVALUATION_STRAIGHT);
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 48};
    whole expected = make_whole(&made, &desc);
    desc.max_memory = 500000;
    uint64_t before = device->bytes;
    for (size_t i = 0; i < sizeof failures / sizeof *failures; i++)
        for (uint64_t at = 1; at < 4; at++) {
            collector to = make_collector(&expected.mesh);
            const hewn_mesh_sink sink = {.user = &to, .take = take, .bytes = bytes};
            to.fail_at = at;
            to.failure = failures[i];
            assert_int_equal(hewn_extract_parts(made.extractor, &desc, &sink, NULL, NULL), failures[i]);
            assert_int_equal(to.parts, at);
            assert_int_equal(device->bytes, before);
            free_collector(&to);
        }
    hewn_triangles_destroy(&expected.mesh);
    free_subject(&made);
}

static hewn_node make_nowhere(hewn_field *field)
{
    return hewn_add(field, hewn_square(field, hewn_x(field)), hewn_constant(field, 0.5));
}

static hewn_node make_everywhere(hewn_field *field)
{
    return hewn_neg(field, make_nowhere(field));
}

static void test_no_surface(void **state)
{
    (void)state;
    maker *const makers[] = {make_nowhere, make_everywhere};
    for (size_t i = 0; i < 2; i++)
        for (size_t m = 0; m < METHODS; m++) {
            subject made = make_subject(makers[i], HEWN_EVALUATION_STRAIGHT);
            hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 20, .method = methods[m]};
            hewn_triangles mesh;
            hewn_error plain = {0}, parts = {0};
            static float room[1 << 20];
            collector to = {.whole = &(hewn_triangles){.vertex_count = 1 << 16, .triangle_count = 1 << 16}};
            to.positions = to.normals = room;
            to.indices = (uint32_t *)room;
            to.has_vertex = calloc(1 << 16, 1);
            to.has_triangle = calloc(1 << 16, 1);
            GPU_TEST_TRY(hewn_certifier_create(&to.certifier, &error));
            const hewn_mesh_sink sink = {.user = &to, .take = take, .bytes = bytes};
            assert_int_equal(hewn_extract(made.extractor, &desc, &mesh, NULL, &plain), HEWN_BAD_INPUT);
            desc.max_memory = 4000000;
            assert_int_equal(hewn_extract_parts(made.extractor, &desc, &sink, NULL, &parts), HEWN_BAD_INPUT);
            assert_string_equal(plain.message, parts.message);
            free(to.has_vertex);
            free(to.has_triangle);
            hewn_certifier_destroy(&to.certifier);
            free_subject(&made);
        }
}

static bool keep_going(void *user, const char *stage, double share)
{
    uint64_t *left = user;
    assert_non_null(stage);
    assert_true(share >= 0 && share <= 1);
    return (*left)-- > 0;
}

static void test_cancelled_at_every_report(void **state)
{
    (void)state;
    subject made = make_subject(make_part, HEWN_EVALUATION_STRAIGHT);
    uint64_t left = UINT64_MAX, before = 0;
    const hewn_progress progress = {.report = keep_going, .user = &left};
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 40};
    whole expected = make_whole(&made, &desc);
    desc.max_memory = 500000;
    desc.progress = &progress;
    compare(&made, &desc, desc.max_memory, &expected);
    uint64_t reports = UINT64_MAX - left;
    assert_true(reports > 6);
    before = device->bytes;
    for (uint64_t stop = 0; stop < reports; stop += gpu_test_long() || stop < 8 ? 1 : 7) {
        collector to = make_collector(&expected.mesh);
        const hewn_mesh_sink sink = {.user = &to, .take = take, .bytes = bytes};
        left = stop;
        assert_int_equal(hewn_extract_parts(made.extractor, &desc, &sink, NULL, NULL), HEWN_CANCELLED);
        assert_int_equal(device->bytes, before);
        free_collector(&to);
    }
    left = UINT64_MAX;
    compare(&made, &desc, desc.max_memory, &expected);
    hewn_triangles_destroy(&expected.mesh);
    free_subject(&made);
}

/* Every allocation of heap and device fails in turn, and all after it. */
static void test_memory_runs_out(void **state)
{
    (void)state;
    for (size_t m = 0; m < METHODS; m++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 48, .method = methods[m]};
        subject made = make_subject(make_part, HEWN_EVALUATION_STRAIGHT);
        whole expected = make_whole(&made, &desc);
        uint64_t before = device->bytes, count = 0;
        desc.max_memory = 700000;
        hewn_result result = HEWN_OUT_OF_MEMORY;
        while (result != HEWN_OK && count < 20000) {
            collector to = make_collector(&expected.mesh);
            const hewn_mesh_sink sink = {.user = &to, .take = take, .bytes = bytes};
            hewn_error error = {0};
            watch_memory(count);
            result = hewn_extract_parts(made.extractor, &desc, &sink, NULL, &error);
            watch_no_more();
            if (result != HEWN_OK && result != HEWN_OUT_OF_MEMORY && result != HEWN_OUT_OF_DEVICE_MEMORY)
                fail_msg("allocation %llu: %s: %s", (unsigned long long)count, hewn_result_name(result), error.message);
            assert_true(result == HEWN_OK || error.message[0] != '\0');
            assert_int_equal(device->bytes, before);
            free_collector(&to);
            count += gpu_test_long() || count < 40 ? 1 : 101;
        }
        assert_int_equal(result, HEWN_OK);
        assert_true(count > 30);
        assert_true(compare(&made, &desc, desc.max_memory, &expected) > 1);
        hewn_triangles_destroy(&expected.mesh);
        free_subject(&made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_method),
        cmocka_unit_test(test_quads),
        cmocka_unit_test(test_lists),
        cmocka_unit_test(test_rough),
        cmocka_unit_test(test_levels),
        cmocka_unit_test(test_memory_out_of_reach),
        cmocka_unit_test(test_sinks_that_hold_memory),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_failing_sink),
        cmocka_unit_test(test_no_surface),
        cmocka_unit_test(test_cancelled_at_every_report),
        cmocka_unit_test(test_memory_runs_out),
    };
    return cmocka_run_group_tests_name("parts", tests, open_device, close_device);
}
