/* hewn smooth: from file to file, with attributes and a report. */
#include <math.h>

#include "mesh_files.h"

static char *make_box_folder(void)
{
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "box.obj"), box_obj);
    return folder;
}

static void test_every_method(void **state)
{
    (void)state;
    static const char *const methods[] = {"taubin", "laplacian", "cotan", "implicit", "bilateral", "hc"};
    char *folder = make_box_folder();
    for (int i = 0; i < 6; i++) {
        char *report =
            report_of(folder, (run_desc){.arguments = {"smooth", "box.obj", "-o", "b.ply", "--method", methods[i]}});
        assert_string_equal(json_string(report, "smooth.method"), methods[i]);
        assert_true(json_number(report, "smooth.volume_before") == 6);
        assert_true(json_number(report, "smooth.largest_move") > 0);
        bool kept = strcmp(methods[i], "taubin") == 0;
        assert_true(kept == (fabs(json_number(report, "smooth.volume_after") - 6) < 1e-8));
        assert_true(json_number(report, "counts.faces") == 6);
        free(report);
        char *info = info_of(folder, "b.ply");
        assert_true(json_count(info, "attributes") >= 2);
        free(info);
        size_t b_length, c_length;
        char *b = run_read_file(run_path(folder, "b.ply"), &b_length);
        report =
            report_of(folder, (run_desc){.arguments = {"convert", "box.obj", "-o", "b.ply", "--smooth", methods[i]}});
        assert_string_equal(json_string(report, "smooth.method"), methods[i]);
        free(report);
        char *c = run_read_file(run_path(folder, "b.ply"), &c_length);
        assert_int_equal(b_length, c_length);
        assert_memory_equal(b, c, b_length);
        free(b);
        free(c);
    }
    run_folder_destroy(folder);
}

static void test_locks_and_volume(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    char *report = report_of(folder, (run_desc){.arguments = {"smooth", "box.obj", "-o", "b.obj", "--method",
                                                              "laplacian", "--keep-volume"}});
    assert_true(fabs(json_number(report, "smooth.volume_after") - 6) < 1e-8);
    assert_true(json_number(report, "smooth.closed_components") == 1);
    free(report);
    report = report_of(folder, (run_desc){.arguments = {"smooth", "box.obj", "-o", "b.obj", "--free-volume"}});
    assert_true(fabs(json_number(report, "smooth.volume_after") - 6) > 1e-3);
    free(report);
    /* Groups "ends" and "sides" meet at every vertex, and all edges are sharp. */
    static const char *const locks[] = {"labels", "features:60", "boundary,features:89"};
    for (int i = 0; i < 3; i++) {
        report = report_of(folder, (run_desc){.arguments = {"smooth", "box.obj", "-o", "b.obj", "--lock", locks[i]}});
        assert_true(json_number(report, "smooth.locked_vertices") == 8);
        assert_true(json_number(report, "smooth.largest_move") == 0);
        free(report);
    }
    run_folder_destroy(folder);
}

static void test_mask(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "a.ply"),
                   "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                   "property uchar soft\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
                   "0 0 0 0\n1 0 0 255\n0 1 0 0\n0 0 1 0\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
    char *report = report_of(folder, (run_desc){.arguments = {"smooth", "a.ply", "-o", "b.ply", "--mask", "soft"}});
    assert_true(json_number(report, "smooth.locked_vertices") == 3);
    assert_true(json_number(report, "smooth.largest_move") > 0);
    free(report);
    run_result result =
        run_in(2, folder, (run_desc){.arguments = {"smooth", "a.ply", "-o", "c.ply", "--mask", "hard"}});
    assert_has(result.err, "no vertex attribute \"hard\"");
    run_result_destroy(&result);
    assert_false(run_file_exists(run_path(folder, "c.ply")));
    run_folder_destroy(folder);
}

static void test_bad_input(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_result result = run_in(3, folder, (run_desc){.arguments = {"smooth", "none.obj", "-o", "b.obj"}});
    assert_has(result.err, "none.obj");
    run_result_destroy(&result);
    assert_int_equal(run_folder_count(folder), 0);
    run_folder_destroy(folder);
}

/* A scene's mesh, smoothed before it is written: proven all the same, and what cannot be is refused at once. */
static void test_scenes(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    const char *scene = run_project_file("assets/scenes/csg.lua");
    run_desc desc = {.arguments = {"mesh", scene, "-o", "b.ply", "--res", "24", "--smooth",
                                   "laplacian:iterations=3,volume=keep", "--report", "report.json"},
                     .folder = folder};
    run_result done = run_expecting(0, &desc);
    run_result_destroy(&done);
    char *report = read_text(folder, "report.json");
    assert_string_equal(json_string(report, "smooth.method"), "laplacian");
    assert_true(json_number(report, "smooth.iterations") == 3);
    double volume = json_number(report, "smooth.volume_before");
    assert_true(volume > 0 && fabs(json_number(report, "smooth.volume_after") / volume - 1) < 1e-8);
    assert_true(fabs(json_number(report, "certificate.volume") / volume - 1) < 1e-5);
    assert_true(json_number(report, "smooth.area_after") < json_number(report, "smooth.area_before"));
    assert_true(json_bool(report, "certificate.closed") && json_bool(report, "certificate.manifold"));
    free(report);
    static const char *const wrong[][3] = {{"none", NULL}, {"taubin:lock=labels", NULL}, {"taubin", "--max-memory=1G"}};
    for (int i = 0; i < 3; i++) {
        run_result result = run_in(
            2, folder, (run_desc){.arguments = {"mesh", scene, "-o", "c.ply", "--smooth", wrong[i][0], wrong[i][1]}});
        run_result_destroy(&result);
        assert_false(run_file_exists(run_path(folder, "c.ply")));
    }
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_method), cmocka_unit_test(test_locks_and_volume), cmocka_unit_test(test_mask),
        cmocka_unit_test(test_bad_input),    cmocka_unit_test(test_scenes),
    };
    return cmocka_run_group_tests_name("smooth", tests, NULL, NULL);
}
