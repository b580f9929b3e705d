/* Numbers in buffers: the same mesh as with literals, and another number compiles nothing. */
#include "test_code_support.h"

#include <ftw.h>
#include <unistd.h>

#include "iso/extractor.h"

/* A field whose numbers can be others in the same expressions: the shapes stay, a ball grows and moves. */
typedef struct scene {
    hewn_field *field;
    hewn_node root;
} scene;

static scene make_scene(uint64_t seed, int count, double radius, double shift)
{
    scene made;
    GPU_TEST_TRY(hewn_field_create(&made.field, &error));
    hewn_node shapes = code_many_shapes(made.field, &seed, count);
    hewn_node ball = hewn_translate(made.field, hewn_sphere(made.field, radius), shift, 0.1, 0.2);
    made.root = hewn_smooth_union(made.field, shapes, ball, HEWN_BLEND_CUBIC, radius / 4);
    GPU_TEST_TRY(hewn_field_status(made.field, &error));
    return made;
}

static hewn_extractor *make_extractor(hewn_device *device, const scene *from, hewn_numbers numbers)
{
    hewn_extractor *extractor;
    GPU_TEST_TRY(hewn_extractor_create_with(device, from->field, from->root, numbers, &extractor, &error));
    return extractor;
}

static hewn_triangles mesh_with(hewn_extractor *extractor)
{
    const hewn_extract_desc desc = {
        .bounds = {{-1.3, -1.3, -1.3}, {1.3, 1.3, 1.3}}, .resolution = 72, .method = HEWN_METHOD_MARCHING_CUBES};
    hewn_triangles triangles;
    GPU_TEST_TRY(hewn_extract(extractor, &desc, &triangles, NULL, &error));
    assert_true(triangles.vertex_count > 1000);
    return triangles;
}

static bool same_mesh(const hewn_triangles *a, const hewn_triangles *b)
{
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           memcmp(a->positions, b->positions, 12 * a->vertex_count) == 0 &&
           memcmp(a->normals, b->normals, 12 * a->vertex_count) == 0 &&
           memcmp(a->indices, b->indices, 12 * a->triangle_count) == 0;
}

/* Meshes a scene with a code of its own. */
static hewn_triangles mesh_of(hewn_device *device, const scene *from, hewn_numbers numbers)
{
    hewn_extractor *extractor = make_extractor(device, from, numbers);
    hewn_triangles triangles = mesh_with(extractor);
    hewn_extractor_destroy(&extractor);
    return triangles;
}

/* --- bytes ------------------------------------------------------------------------------------------------------- */

static void meshes_are_those_of_literals(void **test_state)
{
    (void)test_state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    for (uint64_t seed = 1; seed <= (gpu_test_long() ? 20 : 3); seed++) {
        scene made = make_scene(seed, (int)(6 * seed), 0.4, 0.3);
        hewn_triangles buffer = mesh_of(device, &made, HEWN_NUMBERS_IN_BUFFER);
        hewn_triangles literals = mesh_of(device, &made, HEWN_NUMBERS_IN_CODE);
        hewn_triangles chosen = mesh_of(device, &made, HEWN_NUMBERS_AUTO);
        assert_true(same_mesh(&buffer, &literals));
        assert_true(same_mesh(&buffer, &chosen));
        hewn_triangles_destroy(&buffer);
        hewn_triangles_destroy(&literals);
        hewn_triangles_destroy(&chosen);
        hewn_field_destroy(&made.field);
    }
    gpu_test_close(&device, &messages);
}

/* --- compiling --------------------------------------------------------------------------------------------------- */

static size_t files_seen; /* nftw() hands nothing of its caller's on */

static int see_file(const char *path, const struct stat *status, int kind, struct FTW *place)
{
    (void)path, (void)status, (void)place;
    files_seen += kind == FTW_F;
    return 0;
}

static int erase_entry(const char *path, const struct stat *status, int kind, struct FTW *place)
{
    (void)status, (void)kind, (void)place;
    return remove(path);
}

/* What all caches hold: SPIR-V, the driver's pipelines and, on Mesa, its machine code. */
static size_t count_cached(const char *folder)
{
    files_seen = 0;
    assert_int_equal(nftw(folder, see_file, 16, FTW_PHYS), 0);
    return files_seen;
}

static void renumber(hewn_extractor *extractor, const scene *to, bool expected)
{
    bool taken;
    GPU_TEST_TRY(hewn_extractor_renumber(extractor, to->field, to->root, &taken, &error));
    assert_true(taken == expected);
}

/* Renumbers there and back, and offers other expressions, which must not be taken and change nothing. */
static void check_renumbering(hewn_device *device)
{
    scene first = make_scene(5, 9, 0.4, 0.3), second = make_scene(5, 9, 0.55, -0.2),
          other = make_scene(5, 10, 0.4, 0.3);
    hewn_extractor *extractor = make_extractor(device, &first, HEWN_NUMBERS_AUTO);
    hewn_program *const before[] = {extractor->cull, extractor->signs, extractor->vertices};
    hewn_triangles meshes[4];
    meshes[0] = mesh_with(extractor);
    renumber(extractor, &second, true);
    meshes[1] = mesh_with(extractor);
    meshes[2] = mesh_of(device, &second, HEWN_NUMBERS_AUTO);
    renumber(extractor, &other, false);
    renumber(extractor, &first, true);
    renumber(extractor, &other, false);
    meshes[3] = mesh_with(extractor);
    assert_true(before[0] == extractor->cull && before[1] == extractor->signs && before[2] == extractor->vertices);
    assert_true(same_mesh(&meshes[1], &meshes[2]));
    assert_true(same_mesh(&meshes[0], &meshes[3]));
    assert_false(same_mesh(&meshes[0], &meshes[1]));
    for (int i = 0; i < 4; i++)
        hewn_triangles_destroy(&meshes[i]);
    hewn_extractor_destroy(&extractor);
    hewn_field_destroy(&first.field);
    hewn_field_destroy(&second.field);
    hewn_field_destroy(&other.field);
}

static void fill_caches(hewn_device *device)
{
    scene first = make_scene(5, 9, 0.4, 0.3);
    hewn_triangles mesh = mesh_of(device, &first, HEWN_NUMBERS_AUTO);
    hewn_triangles_destroy(&mesh);
    hewn_field_destroy(&first.field);
}

static void check_literals(hewn_device *device)
{
    scene first = make_scene(5, 9, 0.4, 0.3), second = make_scene(5, 9, 0.55, -0.2);
    hewn_extractor *extractor = make_extractor(device, &first, HEWN_NUMBERS_IN_CODE);
    renumber(extractor, &second, false);
    hewn_extractor_destroy(&extractor);
    hewn_field_destroy(&first.field);
    hewn_field_destroy(&second.field);
}

/* Runs with a device of its own. The driver writes its cache in a thread of its own, which ends with the device. */
static void with_device(void (*check)(hewn_device *device))
{
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    check(device);
    gpu_test_close(&device, &messages);
}

static void another_number_compiles_nothing(void **test_state)
{
    (void)test_state;
    char folder[] = "/tmp/hewn_numbers_XXXXXX";
    const char *before = getenv("XDG_CACHE_HOME");
    char *kept = before ? hewn_strdup(before) : NULL;
    assert_non_null(mkdtemp(folder));
    assert_int_equal(setenv("XDG_CACHE_HOME", folder, 1), 0);
    with_device(fill_caches);
    size_t cached = count_cached(folder);
    assert_true(cached > 0);
    with_device(check_renumbering);
    assert_int_equal(count_cached(folder), cached);
    with_device(check_literals);
    assert_int_equal(nftw(folder, erase_entry, 16, FTW_PHYS | FTW_DEPTH), 0);
    assert_int_equal(kept ? setenv("XDG_CACHE_HOME", kept, 1) : unsetenv("XDG_CACHE_HOME"), 0);
    hewn_free(kept);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_are_those_of_literals),
        cmocka_unit_test(another_number_compiles_nothing),
    };
    return cmocka_run_group_tests_name("code_numbers", tests, NULL, NULL);
}
