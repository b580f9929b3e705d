/* What extraction makes of fields and moments that nobody wishes for, by every method: values that are no numbers,
 * surfaces on the grid itself, no surface at all, walls thinner than a cell, extreme scales, cancellation, and memory
 * that runs out. Whatever comes of it is a manifold or an error with its reason, and nothing is left behind. */
#include <math.h>
#include <string.h>

#include "gpu/device.h"
#include "gpu_test_device.h"
#include "hewn/hewn.h"

/* All methods: what is tested here must hold for each. */
static const hewn_method methods[] = {HEWN_METHOD_MARCHING_CUBES, HEWN_METHOD_MC33, HEWN_METHOD_NETS, HEWN_METHOD_DC};
enum { METHODS = sizeof methods / sizeof *methods };

typedef hewn_node maker(hewn_field *field);

typedef struct subject {
    hewn_field *field;
    hewn_extractor *extractor;
} subject;

static subject make_subject(maker *make)
{
    subject made = {0};
    GPU_TEST_TRY(hewn_field_create(&made.field, &error));
    hewn_node root = make(made.field);
    GPU_TEST_TRY(hewn_field_status(made.field, &error));
    GPU_TEST_TRY(hewn_extractor_create(device, made.field, root, &made.extractor, &error));
    return made;
}

static void free_subject(subject *made)
{
    hewn_extractor_destroy(&made->extractor);
    hewn_field_destroy(&made->field);
}

static const hewn_box unit_cube = {{-1, -1, -1}, {1, 1, 1}};

/* --- what every mesh must be -------------------------------------------------------------------------------------- */

static void check_numbers(const hewn_triangles *mesh, const hewn_extract_stats *stats)
{
    for (uint64_t i = 0; i < 3 * mesh->vertex_count; i++) {
        double lo = stats->bounds.lo[i % 3], hi = stats->bounds.hi[i % 3], slack = 1e-6 * (hi - lo);
        double at = (double)mesh->positions[i];
        assert_true(at >= lo - slack && at <= hi + slack); /* false for what is no number */
        assert_true(isfinite(mesh->normals[i]));
    }
    for (uint64_t i = 0; i < mesh->vertex_count; i++) {
        const float *normal = mesh->normals + 3 * i;
        assert_true(fabs(hypot(hypot((double)normal[0], (double)normal[1]), (double)normal[2]) - 1) < 1e-4);
    }
}

static hewn_certificate check_mesh(const hewn_triangles *mesh, const hewn_extract_stats *stats, bool open)
{
    hewn_certificate certificate;
    GPU_TEST_TRY(hewn_certify(mesh, NULL, &certificate, &error));
    assert_true(certificate.manifold && certificate.oriented);
    assert_true(open || certificate.closed);
    check_numbers(mesh, stats);
    return certificate;
}

/* Meshes by one method and holds the result against all that is promised. */
static hewn_certificate mesh_once(const subject *made, const hewn_extract_desc *desc)
{
    hewn_triangles mesh;
    hewn_extract_stats stats;
    GPU_TEST_TRY(hewn_extract(made->extractor, desc, &mesh, &stats, &error));
    assert_true(mesh.triangle_count > 0);
    hewn_certificate certificate = check_mesh(&mesh, &stats, desc->open);
    hewn_triangles_destroy(&mesh);
    return certificate;
}

static void mesh_always(maker *make, const uint32_t *resolutions, size_t count)
{
    subject made = make_subject(make);
    for (size_t m = 0; m < METHODS; m++)
        for (size_t r = 0; r < count; r++)
            for (int open = 0; open < 2; open++) {
                hewn_extract_desc desc = {
                    .bounds = unit_cube, .resolution = resolutions[r], .method = methods[m], .open = open};
                mesh_once(&made, &desc);
            }
    free_subject(&made);
}

static void mesh_all(maker *const *makers, size_t count)
{
    static const uint32_t resolutions[] = {8, 16, 23};
    for (size_t i = 0; i < count; i++)
        mesh_always(makers[i], resolutions, 3);
}

#define MESH_ALL(...)                                                                                                  \
    do {                                                                                                               \
        maker *const makers[] = {__VA_ARGS__};                                                                         \
        mesh_all(makers, sizeof makers / sizeof *makers);                                                              \
    } while (0)

/* --- not a number, infinite --------------------------------------------------------------------------------------- */

static hewn_node number(hewn_field *field, double value)
{
    return hewn_constant(field, value);
}

static hewn_node plus(hewn_field *field, hewn_node a, double value)
{
    return hewn_add(field, a, number(field, value));
}

/* NaN in half of the sphere. */
static hewn_node make_half_nan(hewn_field *field)
{
    hewn_node root = hewn_sqrt(field, plus(field, hewn_x(field), 0.1));
    return hewn_max(field, plus(field, root, -2), hewn_sphere(field, 0.7));
}

/* NaN in a ball in the midst of the solid. */
static hewn_node make_nan_hole(hewn_field *field)
{
    hewn_node root = hewn_sqrt(field, hewn_sphere(field, 0.3));
    return hewn_max(field, plus(field, root, -9), hewn_box_shape(field, 1.5, 1.5, 1.5));
}

/* NaN on every second slab, as wide as a few cells. */
static hewn_node make_nan_slabs(hewn_field *field)
{
    hewn_node wave = hewn_sin(field, hewn_mul(field, hewn_y(field), number(field, 14)));
    return hewn_max(field, plus(field, hewn_sqrt(field, wave), -3), hewn_sphere(field, 0.8));
}

/* 0/0 at a single plane of samples. */
static hewn_node make_nan_plane(hewn_field *field)
{
    hewn_node one = hewn_div(field, hewn_x(field), hewn_x(field));
    return hewn_sub(field, hewn_mul(field, one, hewn_sphere(field, 0.7)), number(field, 0));
}

static hewn_node make_nan_logarithm(hewn_field *field)
{
    return hewn_max(field, hewn_ln(field, plus(field, hewn_z(field), 0.25)), hewn_sphere(field, 0.9));
}

static void test_not_a_number(void **state)
{
    (void)state;
    MESH_ALL(make_half_nan, make_nan_hole, make_nan_slabs, make_nan_plane, make_nan_logarithm);
}

/* Plus infinity on one side of x = 0, minus infinity on the other. */
static hewn_node make_pole(hewn_field *field)
{
    return hewn_max(field, hewn_div(field, number(field, 1), hewn_x(field)), hewn_sphere(field, 0.8));
}

/* Infinite wherever it is positive. */
static hewn_node make_overflow(hewn_field *field)
{
    hewn_node steep = hewn_mul(field, hewn_sphere(field, 0.6), number(field, 3e38));
    return hewn_mul(field, steep, number(field, 1e30));
}

static hewn_node make_exponential(hewn_field *field)
{
    hewn_node power = hewn_exp(field, hewn_mul(field, hewn_sphere(field, 0.6), number(field, 1e4)));
    return plus(field, power, -1);
}

/* Denormal near the surface, and 0 in much of its surroundings. */
static hewn_node make_underflow(hewn_field *field)
{
    hewn_node tiny = hewn_mul(field, hewn_sphere(field, 0.6), number(field, 1e-30));
    return hewn_mul(field, tiny, number(field, 1e-7));
}

static void test_infinite_values(void **state)
{
    (void)state;
    MESH_ALL(make_pole, make_overflow, make_exponential);
}

/* Values that vanish leave a sphere, or nothing on devices without denormals; no crash and no broken mesh. */
static void test_values_that_vanish(void **state)
{
    (void)state;
    subject made = make_subject(make_underflow);
    for (size_t m = 0; m < METHODS; m++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 20, .method = methods[m]};
        hewn_triangles mesh;
        hewn_extract_stats stats;
        hewn_result result = hewn_extract(made.extractor, &desc, &mesh, &stats, NULL);
        assert_true(result == HEWN_OK || result == HEWN_BAD_INPUT);
        if (result == HEWN_OK)
            check_mesh(&mesh, &stats, false);
        hewn_triangles_destroy(&mesh);
    }
    free_subject(&made);
}

/* --- on the grid -------------------------------------------------------------------------------------------------- */

/* Faces, edges and corners on samples and on cell faces, for every even resolution. */
static hewn_node make_grid_box(hewn_field *field)
{
    return hewn_box_shape(field, 1, 1, 1);
}

static hewn_node make_grid_sphere(hewn_field *field)
{
    return hewn_sphere(field, 0.5);
}

/* 0 on all cells outside. */
static hewn_node make_flat_outside(hewn_field *field)
{
    return hewn_min(field, number(field, 0), hewn_sphere(field, 0.6));
}

/* 0 on a shell of several cells around the inside. */
static hewn_node make_flat_shell(hewn_field *field)
{
    hewn_node outer = hewn_max(field, number(field, 0), hewn_sphere(field, 0.8));
    hewn_node inner = hewn_min(field, number(field, 0), hewn_sphere(field, 0.4));
    return hewn_add(field, outer, inner);
}

/* Jumps from -1 to 0 to 1 on cell faces. */
static hewn_node make_compare(hewn_field *field)
{
    return hewn_compare(field, hewn_box_shape(field, 1, 1.5, 1), number(field, 0));
}

static hewn_node make_steps(hewn_field *field)
{
    hewn_node steps = hewn_floor(field, hewn_mul(field, hewn_sphere(field, 0.55), number(field, 8)));
    return plus(field, steps, 0.5);
}

static hewn_node make_diagonal(hewn_field *field)
{
    return hewn_max(field, hewn_plane(field, 1, 1, 1, 0), hewn_box_shape(field, 1.5, 1.5, 1.5));
}

static void test_surfaces_on_the_grid(void **state)
{
    (void)state;
    MESH_ALL(make_grid_box, make_grid_sphere, make_flat_outside, make_flat_shell, make_compare, make_steps,
             make_diagonal);
}

/* --- two surfaces in a cell --------------------------------------------------------------------------------------- */

static hewn_node make_thin_shell(hewn_field *field)
{
    return plus(field, hewn_abs(field, hewn_sphere(field, 0.7)), -0.04);
}

static hewn_node make_touching_spheres(hewn_field *field)
{
    return hewn_union(field, hewn_translate(field, hewn_sphere(field, 0.375), -0.375, 0, 0),
                      hewn_translate(field, hewn_sphere(field, 0.375), 0.375, 0, 0));
}

static hewn_node make_near_spheres(hewn_field *field)
{
    return hewn_union(field, hewn_translate(field, hewn_sphere(field, 0.37), -0.375, 0, 0),
                      hewn_translate(field, hewn_sphere(field, 0.37), 0.375, 0, 0));
}

static hewn_node two_boxes(hewn_field *field, double x, double y, double z)
{
    return hewn_union(field,
                      hewn_translate(field, hewn_box_shape(field, 0.5, 0.5, 0.5), -0.25 * x, -0.25 * y, -0.25 * z),
                      hewn_translate(field, hewn_box_shape(field, 0.5, 0.5, 0.5), 0.25 * x, 0.25 * y, 0.25 * z));
}

static hewn_node make_boxes_at_a_face(hewn_field *field)
{
    return two_boxes(field, 1, 0, 0);
}

static hewn_node make_boxes_at_an_edge(hewn_field *field)
{
    return two_boxes(field, 1, 1, 0);
}

static hewn_node make_boxes_at_a_corner(hewn_field *field)
{
    return two_boxes(field, 1, 1, 1);
}

static hewn_node make_boxes_with_a_gap(hewn_field *field)
{
    return two_boxes(field, 1.02, 1.02, 1.02);
}

/* A wall thinner than a cell, found here and there only. */
static hewn_node make_broken_wall(hewn_field *field)
{
    hewn_node wall = hewn_rotate(field, hewn_box_shape(field, 1.5, 0.05, 1.5), 1, 0.4, 0.3, 0.5);
    return hewn_union(field, wall, hewn_sphere(field, 0.3));
}

static void test_two_surfaces_in_a_cell(void **state)
{
    (void)state;
    MESH_ALL(make_thin_shell, make_touching_spheres, make_near_spheres, make_boxes_at_a_face, make_boxes_at_an_edge,
             make_boxes_at_a_corner, make_boxes_with_a_gap, make_broken_wall);
}

/* --- scales and grids --------------------------------------------------------------------------------------------- */

static void test_scales(void **state)
{
    (void)state;
    static const double scales[] = {1e-15, 1e-6, 1e6, 1e15};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        double scale = scales[i];
        subject made = {0};
        GPU_TEST_TRY(hewn_field_create(&made.field, &error));
        GPU_TEST_TRY(
            hewn_extractor_create(device, made.field, hewn_sphere(made.field, 0.7 * scale), &made.extractor, &error));
        for (size_t m = 0; m < METHODS; m++) {
            hewn_extract_desc desc = {.resolution = 20, .method = methods[m]};
            for (int axis = 0; axis < 3; axis++) {
                desc.bounds.lo[axis] = -scale;
                desc.bounds.hi[axis] = scale;
            }
            hewn_certificate certificate = mesh_once(&made, &desc);
            double volume = certificate.volume / (scale * scale * scale);
            assert_true(certificate.components == 1 && certificate.genus == 0);
            assert_true(fabs(volume / (4. / 3 * 3.14159265 * 0.343) - 1) < 0.03);
        }
        free_subject(&made);
    }
}

static hewn_node make_oblique(hewn_field *field)
{
    return hewn_plane(field, 0.5, 0.7, 0.2, 0.1);
}

/* One cell on some or all axes: closed, every sample lies on the bounds and is outside. */
static void test_least_grids(void **state)
{
    (void)state;
    static const uint32_t cells[][3] = {{1, 1, 1},  {1, 9, 14}, {9, 1, 14}, {9, 14, 1},
                                        {1, 1, 20}, {20, 1, 1}, {2, 2, 2}};
    subject made = make_subject(make_oblique);
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++)
        for (size_t m = 0; m < METHODS; m++)
            for (int open = 0; open < 2; open++) {
                hewn_extract_desc desc = {.cell = 0.1, .method = methods[m], .open = open};
                bool one = false;
                for (int axis = 0; axis < 3; axis++) {
                    desc.bounds.lo[axis] = -0.05 * cells[i][axis];
                    desc.bounds.hi[axis] = 0.05 * cells[i][axis];
                    one |= cells[i][axis] == 1;
                }
                hewn_triangles mesh;
                hewn_extract_stats stats;
                hewn_error error = {0};
                hewn_result result = hewn_extract(made.extractor, &desc, &mesh, &stats, &error);
                for (int axis = 0; axis < 3; axis++)
                    assert_int_equal(stats.cells[axis], cells[i][axis]);
                if (result == HEWN_OK)
                    check_mesh(&mesh, &stats, open);
                else if (result != HEWN_BAD_INPUT || (open && i != 0) || !strstr(error.message, "no surface"))
                    fail_msg("grid %zu: %s", i, error.message);
                assert_true(open || !one || result == HEWN_BAD_INPUT);
                hewn_triangles_destroy(&mesh);
            }
    free_subject(&made);
}

/* --- no surface --------------------------------------------------------------------------------------------------- */

static hewn_node make_all_outside(hewn_field *field)
{
    return plus(field, hewn_square(field, hewn_x(field)), 0.5);
}

static hewn_node make_touching_zero(hewn_field *field)
{
    return hewn_abs(field, hewn_x(field));
}

static hewn_node make_all_inside(hewn_field *field)
{
    return plus(field, hewn_neg(field, hewn_square(field, hewn_x(field))), -0.5);
}

static hewn_node make_all_nan(hewn_field *field)
{
    return hewn_sqrt(field, make_all_inside(field));
}

static hewn_node make_nan_and_outside(hewn_field *field)
{
    return plus(field, hewn_sqrt(field, hewn_x(field)), 0.5);
}

static hewn_node make_elsewhere(hewn_field *field)
{
    return hewn_translate(field, hewn_sphere(field, 1), 7, 0, 0);
}

static const struct {
    maker *make;
    const char *reason;
} empty[] = {
    {make_all_outside, "the field is nowhere negative in the bounds"},
    {make_touching_zero, "the field is nowhere negative in the bounds"},
    {make_all_inside, "the field is negative everywhere in the bounds"},
    {make_all_nan, "the field is not a number (NaN) everywhere in the bounds"},
    {make_nan_and_outside, "and in places not a number (NaN)"},
    {make_elsewhere, "the field is nowhere negative in the bounds"},
};

static void test_no_surface(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof empty / sizeof *empty; i++) {
        subject made = make_subject(empty[i].make);
        for (size_t m = 0; m < METHODS; m++)
            for (int open = 0; open < 2; open++)
                for (int run = 0; run < 2; run++) { /* the first may make what stays with the extractor */
                    hewn_extract_desc desc = {
                        .bounds = unit_cube, .resolution = 20, .method = methods[m], .open = open};
                    hewn_triangles mesh;
                    hewn_error error = {0};
                    uint64_t bytes = device->bytes;
                    assert_int_equal(hewn_extract(made.extractor, &desc, &mesh, NULL, &error), HEWN_BAD_INPUT);
                    if (!strstr(error.message, empty[i].reason))
                        fail_msg("'%s' does not say '%s'", error.message, empty[i].reason);
                    assert_null(mesh.positions);
                    assert_true(run == 0 || device->bytes == bytes);
                }
        free_subject(&made);
    }
}

/* --- what goes wrong on the way ----------------------------------------------------------------------------------- */

/* Meshes a part that has all kinds of cells, by a method, and keeps a copy. */
static hewn_node make_part(hewn_field *field)
{
    hewn_node wall = hewn_rotate(field, hewn_box_shape(field, 1.5, 0.09, 1.2), 1, 0.4, 0.3, 0.5);
    return hewn_union(
        field, wall,
        hewn_smooth_union(field, hewn_sphere(field, 0.4), hewn_torus(field, 0.7, 0.11), HEWN_BLEND_QUADRATIC, 0.2));
}

typedef struct copy {
    hewn_triangles view;
    void *bytes[3];
    size_t sizes[3];
} copy;

static copy mesh_copy(const subject *made, const hewn_extract_desc *desc)
{
    copy kept = {0};
    hewn_triangles mesh;
    GPU_TEST_TRY(hewn_extract(made->extractor, desc, &mesh, NULL, &error));
    const void *from[3] = {mesh.positions, mesh.normals, mesh.indices};
    uint64_t items[3] = {mesh.vertex_count, mesh.vertex_count, mesh.triangle_count};
    for (int i = 0; i < 3; i++) {
        kept.sizes[i] = (size_t)(12 * items[i]);
        kept.bytes[i] = malloc(kept.sizes[i]);
        memcpy(kept.bytes[i], from[i], kept.sizes[i]);
    }
    hewn_triangles_destroy(&mesh);
    return kept;
}

static void free_copy(copy *kept)
{
    for (int i = 0; i < 3; i++)
        free(kept->bytes[i]);
}

static void assert_same_mesh(const subject *made, const hewn_extract_desc *desc, const copy *expected)
{
    copy again = mesh_copy(made, desc);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(again.sizes[i], expected->sizes[i]);
        assert_memory_equal(again.bytes[i], expected->bytes[i], again.sizes[i]);
    }
    free_copy(&again);
}

typedef struct patience {
    uint32_t calls, most; /* the callback says stop after `most` calls */
} patience;

static bool keep_going(void *user, const char *stage, double share)
{
    patience *left = user;
    assert_non_null(stage);
    assert_true(share >= 0 && share <= 1);
    return ++left->calls <= left->most;
}

static void test_cancelled_in_every_stage(void **state)
{
    (void)state;
    subject made = make_subject(make_part);
    for (size_t m = 0; m < METHODS; m++) {
        hewn_extract_desc plain = {.bounds = unit_cube, .resolution = 40, .method = methods[m]};
        copy expected = mesh_copy(&made, &plain);
        uint64_t bytes = device->bytes;
        patience left = {.most = UINT32_MAX};
        const hewn_progress progress = {.report = keep_going, .user = &left};
        hewn_extract_desc watched = plain;
        watched.progress = &progress;
        assert_same_mesh(&made, &watched, &expected);
        uint32_t reports = left.calls;
        assert_true(reports >= 4);
        for (uint32_t stop = 0; stop < reports; stop++) {
            left = (patience){.most = stop};
            hewn_triangles mesh;
            hewn_error error = {0};
            assert_int_equal(hewn_extract(made.extractor, &watched, &mesh, NULL, &error), HEWN_CANCELLED);
            assert_int_equal(error.code, HEWN_CANCELLED);
            assert_int_equal(left.calls, stop + 1);
            assert_null(mesh.positions);
            assert_int_equal(device->bytes, bytes);
            assert_same_mesh(&made, &plain, &expected);
        }
        free_copy(&expected);
    }
    free_subject(&made);
}

/* --- memory ------------------------------------------------------------------------------------------------------- */

static PFN_vkAllocateMemory real_allocate;
static uint32_t allocations_left;

static VKAPI_ATTR VkResult VKAPI_CALL scarce_allocate(VkDevice handle, const VkMemoryAllocateInfo *info,
                                                      const VkAllocationCallbacks *callbacks, VkDeviceMemory *out)
{
    if (allocations_left == 0)
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    allocations_left--;
    return real_allocate(handle, info, callbacks, out);
}

/* Fails the device's allocations from number `count` on. */
static void allow_allocations(uint32_t count)
{
    real_allocate = device->vk.AllocateMemory;
    device->vk.AllocateMemory = scarce_allocate;
    allocations_left = count;
}

static void allow_all(void)
{
    device->vk.AllocateMemory = real_allocate;
}

/* Lets every allocation of a run fail in turn; the first run of an extractor makes what stays with it. */
static void fail_each_allocation(const subject *made, const hewn_extract_desc *desc, const copy *expected)
{
    uint64_t bytes = device->bytes;
    hewn_result result = HEWN_OUT_OF_DEVICE_MEMORY;
    uint32_t count = 0;
    for (; count < 200; count++) {
        hewn_triangles mesh;
        hewn_error error = {0};
        allow_allocations(count);
        result = hewn_extract(made->extractor, desc, &mesh, NULL, &error);
        allow_all();
        hewn_triangles_destroy(&mesh);
        if (result == HEWN_OK)
            break;
        assert_int_equal(result, HEWN_OUT_OF_DEVICE_MEMORY);
        assert_non_null(strstr(error.message, "out of device memory"));
        if (expected)
            assert_int_equal(device->bytes, bytes);
    }
    assert_int_equal(result, HEWN_OK);
    assert_true(count > 20);
    if (expected)
        assert_same_mesh(made, desc, expected);
}

static void test_device_memory_runs_out(void **state)
{
    (void)state;
    for (size_t m = 0; m < METHODS; m++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 24, .method = methods[m]};
        uint64_t before = device->bytes;
        subject made = make_subject(make_part);
        fail_each_allocation(&made, &desc, NULL);
        copy expected = mesh_copy(&made, &desc);
        fail_each_allocation(&made, &desc, &expected);
        free_copy(&expected);
        free_subject(&made);
        assert_int_equal(device->bytes, before);
    }
}

/* The same while an extractor is made. */
static void test_memory_for_an_extractor_runs_out(void **state)
{
    (void)state;
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    hewn_node root = make_part(field);
    uint64_t bytes = device->bytes;
    hewn_result result = HEWN_OUT_OF_DEVICE_MEMORY;
    for (uint32_t count = 0; count < 20 && result != HEWN_OK; count++) {
        hewn_extractor *extractor;
        allow_allocations(count);
        result = hewn_extractor_create(device, field, root, &extractor, NULL);
        allow_all();
        assert_true(result == HEWN_OK || result == HEWN_OUT_OF_DEVICE_MEMORY);
        assert_true((result == HEWN_OK) == (extractor != NULL));
        hewn_extractor_destroy(&extractor);
        assert_int_equal(device->bytes, bytes);
    }
    assert_int_equal(result, HEWN_OK);
    hewn_field_destroy(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_not_a_number),
        cmocka_unit_test(test_infinite_values),
        cmocka_unit_test(test_values_that_vanish),
        cmocka_unit_test(test_surfaces_on_the_grid),
        cmocka_unit_test(test_two_surfaces_in_a_cell),
        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_least_grids),
        cmocka_unit_test(test_no_surface),
        cmocka_unit_test(test_cancelled_in_every_stage),
        cmocka_unit_test(test_device_memory_runs_out),
        cmocka_unit_test(test_memory_for_an_extractor_runs_out),
    };
    return cmocka_run_group_tests_name("extract_failures", tests, open_device, close_device);
}
