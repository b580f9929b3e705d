/* STL: text and binary told apart, welding, solids and attributes, broken files, round trips, files of the test data.
 */
#include <float.h>

#include "base/text.h"
#include "io/welder.h"
#include "io_support.h"

#define FACET(a, b, c)                                                                                                 \
    "facet normal -nan(ind) 0 0\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet\n"

static const uint32_t two[] = {0, 1, 2, 0, 2, 3};

static void assert_corners(hewn_model model, uint64_t vertices, uint64_t corner_count, const uint32_t *corners)
{
    assert_int_equal(model.vertex_count, vertices);
    assert_int_equal(hewn_model_corner_count(&model), corner_count);
    if (corner_count > 0)
        assert_memory_equal(model.corners, corners, corner_count * sizeof *corners);
    hewn_model_destroy(&model);
}

static size_t put_stl(char *file, const char *head, uint32_t count, uint32_t facets, const float *corners)
{
    memset(file, 0, 84 + 50 * (size_t)facets);
    memcpy(file, head, strlen(head));
    memcpy(file + 80, &count, 4);
    for (uint32_t i = 0; i < facets; i++)
        memcpy(file + 84 + 50 * (size_t)i + 12, corners + 9 * (size_t)i, 36);
    return 84 + 50 * (size_t)facets;
}

/* --- forms -------------------------------------------------------------------------------------------------------- */

static void test_text(void **state)
{
    (void)state;
    hewn_model model = read_text(hewn_stl_read, "solid a name with facet\n" FACET("0 0 0", "1 0 0", "1 1 0")
                                                    FACET("-0 -0 -0", "1 1 0", "0 1e0 0") "endsolid a\n");
    assert_null(model.first);
    assert_int_equal(model.channel_count, 0);
    assert_corners(model, 4, 6, two);
    static const uint32_t quad[] = {0, 1, 2, 3};
    model = read_text(hewn_stl_read, "\n SOLID\nFacet Normal 0 0 1 OUTER loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 "
                                     "0 vertex 0 1 0 EndLoop endFacet EndSolid\nsolid b\nendsolid b");
    assert_int_equal(model.face_count, 1); /* uncut */
    assert_corners(model, 4, 4, quad);
    assert_corners(read_text(hewn_stl_read, "solid\nendsolid\n"), 0, 0, NULL);
    model = read_text(hewn_stl_read, "solid x\n" FACET("0.1 16777217.0000001 0", "1 0 0", "1 1 0") "endsolid");
    assert_true(model.positions[0] == (double)0.1f && model.positions[1] == 16777218); /* the nearest floats */
    hewn_model_destroy(&model);
}

static void test_binary(void **state)
{
    (void)state;
    static const float corners[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, -0.0f, 0, 0, 1, 1, 0, 0, 1, 0};
    char file[512];
    hewn_model model;
    static const char eighty[] = "solid text of eighty characters, which is as long as a binary STL file's head is";
    static const char *const heads[] = {"", "binary", "solid like text", "  solid", eighty};
    for (int i = 0; i < 5; i++) {
        size_t length = put_stl(file, heads[i], 2, 2, corners);
        model = read_bytes(hewn_stl_read, file, length);
        assert_false(signbit(model.positions[0]));
        assert_int_equal(model.channel_count, 0);
        assert_corners(model, 4, 6, two);
        assert_corners(read_bytes(hewn_stl_read, file, length + 7), 4, 6, two); /* something trails */
        for (size_t cut = 0; cut < length; cut++)
            assert_int_equal(read_exact(hewn_stl_read, file, cut, &model, NULL), HEWN_BAD_INPUT);
    }
    assert_corners(read_bytes(hewn_stl_read, file, put_stl(file, "", 0, 0, corners)), 0, 0, NULL);
}

static void test_solids(void **state)
{
    (void)state;
    static const char text[] = "solid  Left part \t\n" FACET(
        "0 0 0", "1 0 0", "1 1 0") "endsolid Left part\n"
                                   "solid empty\nendsolid\n"
                                   "SOLID\n" FACET("0 0 0", "1 0 0", "1 1 1")
                                       FACET("0 0 0", "1 0 0", "1 2 0") "ENDSOLID\nsolid Left part\n" FACET(
                                           "0 0 0", "1 0 0", "3 1 0") "endsolid\n"
                                                                      "solid none\nendsolid\n";
    hewn_model model = read_text(hewn_stl_read, text);
    const hewn_channel *object = hewn_model_find_channel(&model, HEWN_DOMAIN_FACE, "object");
    assert_non_null(object);
    static const int32_t values[] = {0, 1, 1, 0};
    assert_memory_equal(object->values, values, sizeof values);
    assert_int_equal(object->name_count, 2);
    assert_string_equal(object->names[0], "Left part");
    assert_string_equal(object->names[1], "solid 2");
    hewn_model_destroy(&model);
}

static void test_attributes(void **state)
{
    (void)state;
    random_state random = {3};
    hewn_model model = make_ring_model(6, 5, 2); /* quadrilaterals, which STL cuts, and triangles */
    hewn_channel *channel = add_channel(&model, "attribute", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1);
    for (uint64_t face = 0; face < model.face_count; face++)
        ((int32_t *)channel->values)[face] = (int32_t)random_below(&random, 65536);
    hewn_model read = through_file(&model, "stl");
    const hewn_channel *again = hewn_model_find_channel(&read, HEWN_DOMAIN_FACE, "attribute");
    assert_non_null(again);
    uint64_t triangle = 0;
    for (uint64_t face = 0; face < model.face_count; face++)
        for (uint64_t k = 2; k < first_of(&model, face + 1) - first_of(&model, face); k++)
            assert_int_equal(((int32_t *)again->values)[triangle++], ((int32_t *)channel->values)[face]);
    assert_int_equal(triangle, read.face_count);
    hewn_model twice = through_file(&read, "stl");
    assert_same_model(&read, &twice);
    hewn_model_destroy(&twice);
    hewn_model_destroy(&read);
    ((int32_t *)channel->values)[0] = 65536; /* two bytes cannot hold these */
    ((int32_t *)channel->values)[1] = -1;
    read = through_file(&model, "stl");
    again = hewn_model_find_channel(&read, HEWN_DOMAIN_FACE, "attribute");
    assert_int_equal(((int32_t *)again->values)[0], 0);
    hewn_model_destroy(&read);
    hewn_model_destroy(&model);
}

static void test_errors(void **state)
{
    (void)state;
    static const float corners[] = {0, 0, 0, 1, 0, NAN, 1, 1, 0};
    char file[512];
    assert_bad(hewn_stl_read, file, put_stl(file, "", 1, 1, corners), 0, "facet 0");
    assert_bad(hewn_stl_read, file, put_stl(file, "", 0xffffffff, 1, corners), 0, "4294967295 facets");
    assert_bad_text(hewn_stl_read, "", 0, "empty");
    assert_bad_text(hewn_stl_read, "solid x", 1, "the file ends");
    assert_bad_text(hewn_stl_read, "solid x\n" FACET("0 0 0", "1 0 0", "1 blah 0"), 6, "\"blah\"");
    assert_bad_text(hewn_stl_read, "solid x\n" FACET("0 0 0", "1 0 0", "1 inf 0"), 6, "\"inf\"");
    assert_bad_text(hewn_stl_read, "solid x\n" FACET("0 0 0", "1 0 0", "1 1e39 0"), 6, "\"1e39\"");
    assert_bad_text(hewn_stl_read, "solid x\n" FACET("0 0 0", "1 0 0", "1 0 0") "\nendfacet\n", 10, "\"endfacet\"");
    assert_bad_text(hewn_stl_read, "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n", 5, "\"vertex\"");
    assert_bad_text(hewn_stl_read, "solid x\nendsolid\nfacet\n", 3, "\"solid\"");
}

/* --- welding and round trips -------------------------------------------------------------------------------------- */

/* Positions among few values, so that many are equal, 0 and -0 among them. */
static void random_corner(random_state *random, float out[3])
{
    static const float few[] = {0, -0.0f, 1, -1, FLT_TRUE_MIN, FLT_MAX, 0.1f, 1e-30f};
    for (int axis = 0; axis < 3; axis++)
        out[axis] = random_below(random, 20) ? few[random_below(random, 8)] : random_float(random);
}

/* The same facets as text and binary, against a search through all corners. */
static void test_welding(void **state)
{
    (void)state;
    random_state random = {17};
    for (int round = 0; round < 40; round++) {
        uint32_t facets = 1 + random_below(&random, 120), fresh = 0;
        float *corners = hewn_alloc(9 * (size_t)facets, sizeof *corners);
        uint32_t *expected = hewn_alloc(3 * (size_t)facets, sizeof *expected);
        hewn_text text = {0};
        hewn_text_append(&text, "solid\n");
        for (uint32_t i = 0; i < 3 * facets; i++) {
            float *corner = corners + 3 * (size_t)i;
            random_corner(&random, corner);
            expected[i] = fresh;
            for (uint32_t k = 0; k < i && expected[i] == fresh; k++)
                if (corner[0] == corners[3 * k] && corner[1] == corners[3 * k + 1] && corner[2] == corners[3 * k + 2])
                    expected[i] = expected[k];
            fresh += expected[i] == fresh;
            hewn_text_print(&text, "%svertex %.9g %.9g %.9g\n", i % 3 ? "" : "facet normal 0 0 0\nouter loop\n",
                            (double)corner[0], (double)corner[1], (double)corner[2]);
            if (i % 3 == 2)
                hewn_text_append(&text, "endloop\nendfacet\n");
        }
        hewn_text_append(&text, "endsolid\n");
        char *file = hewn_alloc(84 + 50 * (size_t)facets, 1);
        hewn_model binary = read_bytes(hewn_stl_read, file, put_stl(file, "", facets, facets, corners));
        hewn_model words = read_text(hewn_stl_read, text.bytes);
        assert_same_model(&binary, &words);
        for (uint32_t i = 0; i < 3 * facets; i++)
            for (int axis = 0; axis < 3; axis++)
                assert_true(binary.positions[3 * (size_t)expected[i] + axis] == (double)corners[3 * i + axis]);
        assert_corners(binary, fresh, 3 * (uint64_t)facets, expected);
        hewn_model_destroy(&words);
        hewn_free(file);
        hewn_free(expected);
        hewn_free(corners);
        hewn_text_clear(&text);
    }
}

/* Vertices that were there before a welder's first call stay apart, also after it was cleared. */
static void test_welder_starts_anew(void **state)
{
    (void)state;
    hewn_builder builder = {0};
    hewn_welder welder = {0};
    for (uint32_t part = 0; part < 3; part++) {
        for (uint32_t i = 0; i < 5000; i++) {
            uint32_t vertex;
            double position[3] = {i % 1000, part % 2, -0.0};
            assert_int_equal(hewn_welder_add(&welder, &builder, position, &vertex, NULL), HEWN_OK);
            assert_int_equal(vertex, 1000 * part + i % 1000);
        }
        hewn_welder_clear(&welder);
    }
    assert_int_equal(builder.model.vertex_count, 3000);
    assert_false(signbit(builder.model.positions[2]));
    hewn_builder_clear(&builder);
}

static void test_unit_and_axes(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(5, 4, 2);
    const hewn_unit *unit;
    for (size_t i = 0; (unit = hewn_unit_at(i)); i++)
        for (int up = HEWN_AXIS_PLUS_Y; up <= HEWN_AXIS_PLUS_X; up++) {
            model.unit = unit;
            model.up = (hewn_axis)up;
            model.up_known = true;
            hewn_model read = through_file(&model, "stl");
            assert_ptr_equal(read.unit, unit);
            assert_int_equal(read.up, up);
            assert_true(read.up_known);
            hewn_model_destroy(&read);
        }
    for (int known = 0; known < 4; known++) { /* what is not known stays so */
        model.unit = known & 1 ? hewn_unit_find("in") : NULL;
        model.up = known & 2 ? HEWN_AXIS_PLUS_X : HEWN_AXIS_PLUS_Y;
        model.up_known = (known & 2) != 0;
        hewn_model read = through_file(&model, "stl");
        assert_ptr_equal(read.unit, model.unit);
        assert_int_equal(read.up, model.up);
        assert_int_equal(read.up_known, model.up_known);
        hewn_model_destroy(&read);
    }
    hewn_model_destroy(&model);
}

static void test_too_far_out(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(5, 4, 2);
    hewn_error error = {0};
    char folder[64], path[96];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/mesh.stl", folder);
    model.positions[4] = -(double)FLT_MAX;
    assert_int_equal(hewn_model_write(&model, path, NULL, &error), HEWN_OK);
    assert_int_equal(unlink(path), 0);
    model.positions[4] = -1e39;
    assert_int_equal(hewn_model_write(&model, path, NULL, &error), HEWN_LIMIT);
    assert_non_null(strstr(error.message, "vertex 1"));
    assert_int_equal(rmdir(folder), 0);
    hewn_model_destroy(&model);
}

static bool count_down(void *user, const char *stage, double fraction)
{
    assert_string_equal(stage, "load");
    assert_true(fraction >= 0 && fraction <= 1);
    return (*(int *)user)-- > 0;
}

static void test_cancelling(void **state)
{
    (void)state;
    static const char start[] = "solid\n", facet[] = FACET("0 0 0", "1 0 0", "1 1 0"), end[] = "endsolid\n";
    hewn_text text = {0};
    hewn_text_append(&text, start);
    for (int i = 0; i < 40000; i++)
        hewn_text_append(&text, facet);
    hewn_text_append(&text, end);
    hewn_model model = make_ring_model(300, 100, 0);
    char *binary = written_text(&model, "stl");
    for (int form = 0; form < 2; form++)
        for (int allowed = 0;; allowed++) {
            int left = allowed;
            hewn_model read;
            hewn_progress progress = {count_down, &left};
            hewn_source source = {.bytes = form ? binary : text.bytes,
                                  .length = form ? 84 + 50 * 60000 : text.length,
                                  .name = "given",
                                  .progress = &progress};
            hewn_result result = hewn_stl_read(&source, &read, NULL);
            if (result == HEWN_OK) {
                assert_true(allowed >= 3);
                hewn_model_destroy(&read);
                break;
            }
            assert_int_equal(result, HEWN_CANCELLED);
            assert_null(read.positions);
        }
    hewn_free(binary);
    hewn_text_clear(&text);
    hewn_model_destroy(&model);
}

/* --- files of the test data --------------------------------------------------------------------------------------- */

static void check_data_file(const char *path, const char *statistics)
{
    hewn_model model = read_model(path);
    if ((long long)model.vertex_count != statistic(statistics, "V=") ||
        (long long)model.face_count != statistic(statistics, "F="))
        fail_msg("%s: %llu vertices, %llu faces; %s", path, (unsigned long long)model.vertex_count,
                 (unsigned long long)model.face_count, statistics);
    hewn_model again = through_file(&model, "stl");
    assert_int_equal(again.vertex_count, model.vertex_count);
    assert_int_equal(again.face_count, model.face_count);
    assert_memory_equal(again.positions, model.positions, 3 * sizeof(double) * model.vertex_count);
    assert_memory_equal(again.corners, model.corners, 3 * sizeof(uint32_t) * model.face_count);
    hewn_model_destroy(&again);
    hewn_model_destroy(&model);
}

static void test_data_round_trips(void **state)
{
    (void)state;
    static const char *const folders[] = {"mesh-scan", "mesh-misc", "mesh-nasty", "malformed"};
    int checked = for_each_statistic(folders, 4, "stl", check_data_file);
    if (checked < 0)
        skip();
    checked += for_each_statistic(folders, 4, "STL", check_data_file);
    assert_true(checked >= 14);
}

static void test_data_objects(void **state)
{
    (void)state;
    char data[4096], path[4200];
    if (!data_folder(data))
        skip();
    static const char *const files[] = {"triangle_with_two_solids.stl", "two_objects_mixed_case_names.stl"};
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/malformed/%s", data, files[i]);
        hewn_model model = read_model(path);
        const hewn_channel *object = hewn_model_find_channel(&model, HEWN_DOMAIN_FACE, "object");
        assert_non_null(object);
        assert_int_equal(object->name_count, 2);
        assert_int_equal(((int32_t *)object->values)[0], 0);
        assert_int_equal(((int32_t *)object->values)[model.face_count - 1], 1);
        hewn_model_destroy(&model);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_binary),
        cmocka_unit_test(test_solids),
        cmocka_unit_test(test_attributes),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_welding),
        cmocka_unit_test(test_welder_starts_anew),
        cmocka_unit_test(test_unit_and_axes),
        cmocka_unit_test(test_too_far_out),
        cmocka_unit_test(test_cancelling),
        cmocka_unit_test(test_data_round_trips),
        cmocka_unit_test(test_data_objects),
    };
    return cmocka_run_group_tests_name("stl", tests, NULL, NULL);
}
