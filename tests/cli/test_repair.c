/* hewn repair: what it mends, what it counts, what it refuses. */
#include <math.h>
#include <unistd.h>

#include "mesh_files.h"

/* Twelve triangles of a box from 0,0,0 to 1,1,1 with corners of their own, as scanners and old tools write them. */
static void write_torn_box(const char *path, int faces, int turned, double off)
{
    static const int corners[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    char text[8192] = "";
    size_t length = 0;
    for (int f = 0; f < faces; f++) {
        length += (size_t)snprintf(text + length, sizeof text - length, "g part%d\n", f % 3);
        for (int k = 0; k < 3; k++) {
            int v = corners[f][f < turned ? 2 - k : k];
            length += (size_t)snprintf(text + length, sizeof text - length, "v %g %d %d %g 0.5 0\n",
                                       (v & 1) + (f % 2 ? off : 0), v >> 1 & 1, v >> 2, v / 7.0);
        }
        length += (size_t)snprintf(text + length, sizeof text - length, "f -3 -2 -1\n");
    }
    run_write_file(path, text);
}

static void assert_whole_box(const char *report)
{
    assert_true(json_bool(report, "certificate.closed"));
    assert_true(json_bool(report, "certificate.manifold"));
    assert_true(json_bool(report, "certificate.oriented"));
    assert_true(json_number(report, "certificate.genus") == 0);
    assert_true(fabs(json_number(report, "certificate.volume") - 1) < 1e-3);
    assert_true(json_number(report, "certificate.self_intersections") == 0);
}

static void test_torn_box(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_torn_box(run_path(folder, "a.obj"), 12, 3, 0);
    run_desc desc = {.arguments = {"repair", "a.obj", "-o", "b.ply"}};
    run_result result = run_in(0, folder, desc);
    assert_string_equal(result.out, "");
    assert_has(result.err, "a.obj -> b.ply: 8 vertices, 12 faces; unit unknown; up unknown\n");
    assert_has(result.err, "\n  vertices welded to another             28\n");
    assert_has(result.err, "\n  faces turned over                      3\n");
    assert_has(result.err, "closed, manifold, oriented, no self-intersections");
    run_result_destroy(&result);
    char *report = report_of(folder, desc);
    assert_true(json_number(report, "counts_before.vertices") == 36);
    assert_true(json_number(report, "counts.vertices") == 8);
    assert_true(json_number(report, "repair.welded_vertices") == 28);
    assert_true(json_number(report, "repair.turned_faces") == 3);
    assert_int_equal(json_count(report, "repair"), 19);
    assert_whole_box(report);
    free(report);
    /* A second time there is nothing to do, and the bytes stay; an object is called after its file. */
    run_subfolder(folder, "sub");
    result = run_in(0, folder, (run_desc){.arguments = {"repair", "b.ply", "-o", "sub/b.ply", "--strict"}});
    assert_has(result.err, "nothing to repair");
    run_result_destroy(&result);
    assert_same_files(folder, "b.ply", "sub/b.ply");
    run_folder_destroy(folder);
}

/* Colours of vertices and groups of faces come along. */
static void test_attributes_survive(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_torn_box(run_path(folder, "a.obj"), 12, 5, 0);
    free(report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.obj"}}));
    char *info = info_of(folder, "b.obj");
    assert_true(json_number(info, "counts.vertices") == 8);
    int groups = 0;
    for (size_t i = 0; i < json_count(info, "attributes"); i++) {
        char path[64];
        snprintf(path, sizeof path, "attributes.%zu.name", i);
        if (strcmp(json_string(info, path), "group") != 0)
            continue;
        for (int value = 0; value < 3; value++) {
            snprintf(path, sizeof path, "attributes.%zu.values.%d.count", i, value);
            assert_true(json_number(info, path) == 4);
        }
        groups++;
    }
    assert_int_equal(groups, 1);
    free(info);
    char *text = read_text(folder, "b.obj");
    assert_has(text, "g part0\n");
    assert_has(text, " 0.5 0\n");
    free(text);
    run_folder_destroy(folder);
}

static void test_weld(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_torn_box(run_path(folder, "a.obj"), 12, 0, 1e-5);
    char *report = report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply"}});
    assert_false(json_bool(report, "certificate.closed"));
    free(report);
    report = report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply", "--weld", "1e-4"}});
    assert_whole_box(report);
    free(report);
    report = report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply", "--no-weld"}});
    assert_true(json_number(report, "repair.welded_vertices") == 0);
    assert_true(json_number(report, "counts.vertices") == 36);
    free(report);
    run_folder_destroy(folder);
}

static void test_fill(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_torn_box(run_path(folder, "a.obj"), 11, 0, 0);
    run_desc desc = {.arguments = {"repair", "a.obj", "-o", "a.obj", "--fill", "3"}};
    char *report = report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "open.ply"}});
    assert_false(json_bool(report, "certificate.closed"));
    assert_true(json_number(report, "certificate.boundary_edges") == 3);
    free(report);
    report = report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "open.ply", "--fill", "2"}});
    assert_true(json_number(report, "repair.filled_holes") == 0);
    free(report);
    report =
        report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply", "--fill=all", "--fill-flat"}});
    assert_true(json_number(report, "repair.added_vertices") == 0);
    assert_whole_box(report);
    free(report);
    report = report_of(folder, desc);
    assert_true(json_number(report, "repair.filled_holes") == 1);
    assert_true(json_number(report, "repair.added_faces") == 1);
    assert_whole_box(report);
    free(report);
    run_folder_destroy(folder);
}

static void test_small_parts(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_torn_box(run_path(folder, "a.obj"), 12, 0, 0);
    char *box = read_text(folder, "a.obj"), *both = malloc(strlen(box) + 200);
    assert_non_null(both);
    snprintf(both, strlen(box) + 200, "%sv 5 0 0\nv 5.01 0 0\nv 5 0.01 0\nf -3 -2 -1\n", box);
    run_write_file(run_path(folder, "a.obj"), both);
    char *report = report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply", "--drop-small", "2"}});
    assert_true(json_number(report, "repair.removed_components") == 1);
    assert_whole_box(report);
    free(report);
    report = report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply", "--drop-share", "0.1"}});
    assert_true(json_number(report, "repair.removed_faces") == 1);
    free(report);
    free(both);
    free(box);
    run_folder_destroy(folder);
}

/* Two boxes with one wall between them, and one box inside out. */
static void test_rules(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_torn_box(run_path(folder, "a.obj"), 12, 12, 0);
    char *report = report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply"}});
    assert_true(json_number(report, "certificate.volume") < 0);
    free(report);
    report = report_of(folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply", "--outward", "always"}});
    assert_true(json_number(report, "certificate.volume") > 0);
    assert_true(json_number(report, "repair.turned_components") == 1);
    free(report);
    run_write_file(run_path(folder, "t.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n");
    static const char *const rules[] = {"one", "both", "none"};
    static const int left[] = {1, 2, 0};
    for (int i = 0; i < 3; i++) {
        report = report_of(folder, (run_desc){.arguments = {"repair", "t.obj", "-o", "b.ply", "--opposite", rules[i]}});
        assert_true(json_number(report, "counts.faces") == left[i]);
        free(report);
    }
    run_write_file(run_path(folder, "d.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 9 9 9\nf 1 2 3\nf 2 3 4\n");
    report = report_of(
        folder, (run_desc){.arguments = {"repair", "d.obj", "-o", "b.ply", "--keep-directions", "--keep-isolated"}});
    assert_true(json_number(report, "repair.turned_faces") == 0);
    assert_true(json_number(report, "counts.vertices") == 7);
    free(report);
    run_folder_destroy(folder);
}

static void test_strict(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\n", "face 1"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n", "direction"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n", "edge"},
    };
    char *folder = run_folder_create();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_write_file(run_path(folder, "a.obj"), cases[i].text);
        fail_in(3, folder, "hewn: a.obj: ", (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply", "--strict"}});
        fail_in(3, folder, cases[i].says, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply", "--strict"}});
        run_result result = run_in(0, folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply"}});
        run_result_destroy(&result);
        assert_int_equal(unlink(run_path(folder, "b.ply")), 0);
    }
    run_folder_destroy(folder);
}

/* What was split lies at one place, so formats without shared vertices lose it, and say so. */
static void test_splits_that_do_not_last(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "a.obj"),
                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv -1 0 0\nv 0 -1 0\nv 0 0 -1\n"
                   "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nf 1 6 5\nf 1 5 7\nf 5 6 7\nf 1 7 6\n");
    run_result result = run_in(0, folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "a.stl"}});
    assert_has(result.err, "non-manifold vertices split            1\n");
    assert_has(result.err, "1 vertex that was split off");
    run_result_destroy(&result);
    result = run_in(0, folder, (run_desc){.arguments = {"repair", "a.obj", "-o", "a.off"}});
    assert_lacks(result.err, "split off");
    run_result_destroy(&result);
    char *info = info_of(folder, "a.off");
    assert_true(json_bool(info, "certificate.manifold"));
    free(info);
    run_folder_destroy(folder);
}

static void test_mistakes(void **state)
{
    (void)state;
    static const struct {
        const char *arguments[8];
        const char *says;
    } cases[] = {
        {{"repair", "a.obj"}, "Give -o FILE"},
        {{"repair", "a.obj", "-o", "b.xyz"}, "does not end in"},
        {{"repair", "a.obj", "-o", "b.ply", "--weld", "-1"}, "--weld must be at least 0"},
        {{"repair", "a.obj", "-o", "b.ply", "--weld", "x"}, "--weld takes a number"},
        {{"repair", "a.obj", "-o", "b.ply", "--weld", "1", "--no-weld"}, "exclude each other"},
        {{"repair", "a.obj", "-o", "b.ply", "--fill", "513"}, "--fill is at most 512"},
        {{"repair", "a.obj", "-o", "b.ply", "--fill", "x"}, "--fill takes a whole number"},
        {{"repair", "a.obj", "-o", "b.ply", "--drop-share", "2"}, "--drop-share is from 0 to 1"},
        {{"repair", "a.obj", "-o", "b.ply", "--outward", "up"}, "--outward is turned, never or always, not 'up'"},
        {{"repair", "a.obj", "-o", "b.ply", "--opposite", "x"}, "--opposite is one, both or none, not 'x'"},
    };
    char *folder = run_folder_create();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {0};
        memcpy(desc.arguments, cases[i].arguments, sizeof cases[i].arguments);
        fail_in(2, folder, cases[i].says, desc);
    }
    fail_in(3, folder, "a.obj: cannot open", (run_desc){.arguments = {"repair", "a.obj", "-o", "b.ply"}});
    run_write_file(run_path(folder, "a.obj"), box_obj);
    fail_in(1, folder, "No space left on device",
            (run_desc){.arguments = {"repair", "a.obj", "-o", "/dev/full", "--to", "off"}});
    fail_in(1, folder, "missing/b.ply", (run_desc){.arguments = {"repair", "a.obj", "-o", "missing/b.ply"}});
    run_folder_destroy(folder);
}

/* Quadrilaterals stay, and a quiet run is quiet. */
static void test_quiet(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "box.obj"), box_obj);
    run_result result = run_in(0, folder, (run_desc){.arguments = {"repair", "-q", "box.obj", "-o", "b.obj"}});
    assert_string_equal(result.err, "");
    assert_string_equal(result.out, "");
    run_result_destroy(&result);
    char *info = info_of(folder, "b.obj");
    assert_true(json_number(info, "counts.quads") == 6);
    free(info);
    run_folder_destroy(folder);
}

/* Its rims are there twice, a hair apart. */
static void test_a_part_that_comes_apart(void **state)
{
    (void)state;
    const char *path = run_data_file("mesh-misc/featuretype.STL");
    char *folder = run_folder_create();
    char *report = report_of(folder, (run_desc){.arguments = {"repair", path, "-o", "a.stl"}});
    assert_true(json_number(report, "certificate.boundary_loops") == 16);
    free(report);
    report = report_of(folder, (run_desc){.arguments = {"repair", path, "-o", "a.stl", "--weld", "1e-4"}});
    assert_true(json_bool(report, "certificate.closed"));
    assert_true(json_number(report, "certificate.genus") == 9);
    assert_true(json_number(report, "certificate.self_intersections") == 0);
    free(report);
    run_folder_destroy(folder);
}

static void test_real_files(void **state)
{
    (void)state;
    static const char *const files[] = {"mesh-nasty/nonmanifold.stl",   "mesh-nasty/quads_to_stitch.off",
                                        "mesh-nasty/cube-shuffled.off", "mesh-open/moebius.obj",
                                        "mesh-misc/conrod.off",         "gltf/simple_pole.glb"};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const char *path = run_data_file(files[i]);
        char *folder = run_folder_create();
        char *report = report_of(folder, (run_desc){.arguments = {"repair", path, "-o", "a.ply"}});
        assert_true(json_bool(report, "certificate.manifold"));
        assert_true(json_bool(report, "certificate.oriented"));
        free(report);
        report =
            report_of(folder, (run_desc){.arguments = {"repair", "a.ply", "-o", "b.ply", "--no-weld", "--strict"}});
        free(report);
        run_folder_destroy(folder);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_torn_box),
        cmocka_unit_test(test_attributes_survive),
        cmocka_unit_test(test_weld),
        cmocka_unit_test(test_fill),
        cmocka_unit_test(test_small_parts),
        cmocka_unit_test(test_rules),
        cmocka_unit_test(test_strict),
        cmocka_unit_test(test_splits_that_do_not_last),
        cmocka_unit_test(test_mistakes),
        cmocka_unit_test(test_quiet),
        cmocka_unit_test(test_a_part_that_comes_apart),
        cmocka_unit_test(test_real_files),
    };
    return cmocka_run_group_tests_name("repair", tests, NULL, NULL);
}
