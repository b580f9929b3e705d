/* Lists so long that a CPU driver's iterations would not do: work is split where it can be, and else refused. */
#include <math.h>
#include <stdlib.h>

#include "eval/lists.h"
#include "gpu_test_device.h"
#include "hewn/hewn.h"
#include "iso/extractor.h"

enum { CROWD = 4000 };

/* Boxes so much alike that no interval tells them apart, so that all of them matter everywhere. */
static hewn_extractor *make_crowd(int count, hewn_evaluation evaluation)
{
    hewn_field *field;
    hewn_extractor *extractor;
    uint64_t random = 5;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    hewn_node box = hewn_rotate(field, hewn_box_shape(field, 1, 1.2, 1.1), 1, 2, 3, 0.5), all = box;
    for (int i = 1; i < count; i++) {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = 1e-4 * ((double)(gpu_test_random(&random) % 2001) / 1000 - 1);
        all = hewn_union(field, all, hewn_translate(field, box, at[0], at[1], at[2]));
    }
    GPU_TEST_TRY(hewn_field_status(field, &error));
    const hewn_code_desc desc = {.evaluation = evaluation};
    GPU_TEST_TRY(hewn_extractor_create_as(device, field, all, &desc, &extractor, &error));
    hewn_field_destroy(&field);
    return extractor;
}

/* One brick, of vertices for three turns. */
static hewn_result extract(int count, hewn_method method, hewn_triangles *out, hewn_error *error)
{
    hewn_extractor *extractor = make_crowd(count, count > 1 ? HEWN_EVALUATION_LISTED : HEWN_EVALUATION_STRAIGHT);
    hewn_extract_desc desc = {.bounds = {{-1, -1, -1}, {1, 1, 1}}, .resolution = 8, .method = method};
    hewn_result result = hewn_extract(extractor, &desc, out, NULL, error);
    hewn_extractor_destroy(&extractor);
    return result;
}

/* How far out a mesh goes. */
static void find_box(const hewn_triangles *mesh, float box[6])
{
    for (int k = 0; k < 6; k++)
        box[k] = -INFINITY;
    for (uint64_t i = 0; i < 3 * mesh->vertex_count; i++) {
        box[i % 3] = fmaxf(box[i % 3], mesh->positions[i]);
        box[3 + i % 3] = fmaxf(box[3 + i % 3], -mesh->positions[i]);
    }
}

/* A crowd goes as far out as one box, with nearly as many vertices: which cells an edge passes, its width decides. */
static void assert_as_large_as_one(const hewn_triangles *crowd, hewn_method method)
{
    hewn_triangles one;
    float boxes[2][6];
    GPU_TEST_TRY(extract(1, method, &one, &error));
    assert_true(llabs((long long)crowd->vertex_count - (long long)one.vertex_count) <=
                (long long)one.vertex_count / 20);
    find_box(crowd, boxes[0]);
    find_box(&one, boxes[1]);
    for (int k = 0; k < 6; k++)
        assert_true(fabsf(boxes[0][k] - boxes[1][k]) < 0.01f);
    hewn_triangles_destroy(&one);
}

/* A crowd's mesh by marching cubes is nearly that of one box. */
static void assert_nearly_one(const hewn_triangles *crowd, hewn_method method)
{
    hewn_triangles one;
    GPU_TEST_TRY(extract(1, method, &one, &error));
    assert_int_equal(crowd->vertex_count, one.vertex_count);
    assert_int_equal(crowd->triangle_count, one.triangle_count);
    for (uint64_t i = 0; i < 3 * one.vertex_count; i++)
        assert_true(fabsf(crowd->positions[i] - one.positions[i]) < 0.01f);
    hewn_triangles_destroy(&one);
}

/* In one go each invocation would need more than 100,000 iterations. */
static void test_vertices_are_solved_in_turns(void **state)
{
    (void)state;
    hewn_triangles mesh;
    GPU_TEST_TRY(extract(CROWD, HEWN_METHOD_MARCHING_CUBES, &mesh, &error));
    assert_true(mesh.vertex_count > 64);
    assert_nearly_one(&mesh, HEWN_METHOD_MARCHING_CUBES);
    hewn_triangles_destroy(&mesh);
}

/* A vertex at a corner asks more than an invocation can answer, and nothing splits it. A driver without such a bound
 * makes the mesh. */
static void test_what_cannot_be_split_is_refused(void **state)
{
    (void)state;
    hewn_triangles mesh;
    hewn_error error = {0};
    hewn_result result = extract(CROWD, HEWN_METHOD_DC, &mesh, &error);
    if (result == HEWN_OK) {
        assert_as_large_as_one(&mesh, HEWN_METHOD_DC);
        hewn_triangles_destroy(&mesh);
    } else {
        assert_int_equal(result, HEWN_LIMIT);
        assert_non_null(strstr(error.message, "shapes matter in one place"));
        print_message("# refused: %s\n", error.message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_vertices_are_solved_in_turns),
        cmocka_unit_test(test_what_cannot_be_split_is_refused),
    };
    return cmocka_run_group_tests_name("long_lists", tests, open_device, close_device);
}
