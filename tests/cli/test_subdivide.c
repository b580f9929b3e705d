/* hewn subdivide: from file to file, with attributes, tags and a report. */
#include <math.h>

#include "mesh_files.h"

static char *make_box_folder(void)
{
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "box.obj"), box_obj);
    return folder;
}

static void test_schemes(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    char *report = report_of(folder, (run_desc){.arguments = {"subdivide", "box.obj", "-o", "b.obj", "--levels", "3"}});
    assert_string_equal(json_string(report, "subdivide.scheme"), "catmull-clark");
    assert_true(json_number(report, "subdivide.levels") == 3);
    assert_true(json_number(report, "counts.faces") == 6 * 64);
    free(report);
    char *info = info_of(folder, "b.obj");
    assert_true(json_bool(info, "certificate.closed") && json_bool(info, "certificate.manifold"));
    assert_true(json_count(info, "attributes") == 2);
    assert_true(json_number(info, "certificate.volume") < 6);
    free(info);
    report =
        report_of(folder, (run_desc){.arguments = {"subdivide", "box.obj", "-o", "b.obj", "--scheme", "bilinear"}});
    free(report);
    info = info_of(folder, "b.obj");
    assert_true(fabs(json_number(info, "certificate.volume") - 6) < 1e-9);
    free(info);
    run_result result =
        run_in(3, folder, (run_desc){.arguments = {"subdivide", "box.obj", "-o", "c.obj", "--scheme", "loop"}});
    assert_has(result.err, "face 0 has 4 corners");
    run_result_destroy(&result);
    assert_false(run_file_exists(run_path(folder, "c.obj")));
    report = report_of(
        folder, (run_desc){.arguments = {"subdivide", "box.obj", "-o", "c.obj", "--scheme", "loop", "--triangulate"}});
    assert_true(json_number(report, "counts.faces") == 48);
    free(report);
    run_folder_destroy(folder);
}

static void test_tags(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    run_write_file(run_path(folder, "tags.obj"), "t crease 5/1/0 0 1 2 3 0 10\nt crease 2/1/0 4 5 2.5\r\n"
                                                 "t corner 1/1/0 6 10\nv 0 0 0\n");
    char *report =
        report_of(folder, (run_desc){.arguments = {"subdivide", "box.obj", "-o", "b.obj", "--creases", "tags.obj"}});
    assert_true(json_number(report, "subdivide.creases") == 5);
    assert_true(json_number(report, "subdivide.corners") == 1);
    free(report);
    report = report_of(folder, (run_desc){.arguments = {"subdivide", "box.obj", "-o", "b.obj", "--crease-angle", "60",
                                                        "--levels", "2", "--limit"}});
    assert_true(json_number(report, "subdivide.creases") == 12);
    free(report);
    char *info = info_of(folder, "b.obj");
    assert_true(fabs(json_number(info, "certificate.volume") - 6) < 1e-9);
    free(info);
    static const char *const bad[] = {"t crease 2/1/0 0\n", "v 0 0 0\nt crease 2/1/0 0 1 -1\n", "t corner 1/1/0 x 1\n"};
    for (int i = 0; i < 3; i++) {
        run_write_file(run_path(folder, "bad.obj"), bad[i]);
        run_result result =
            run_in(3, folder, (run_desc){.arguments = {"subdivide", "box.obj", "-o", "c.obj", "--creases", "bad.obj"}});
        assert_has(result.err, i == 1 ? "bad.obj:2:" : "bad.obj:1:");
        run_result_destroy(&result);
    }
    run_write_file(run_path(folder, "bad.obj"), "t crease 2/1/0 0 6 1\n");
    run_result result =
        run_in(3, folder, (run_desc){.arguments = {"subdivide", "box.obj", "-o", "c.obj", "--creases", "bad.obj"}});
    assert_has(result.err, "no edge from vertex 0 to 6");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* No cracks: the certificate finds the adaptive mesh closed and manifold. */
static void test_adaptive(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    char *report = report_of(folder, (run_desc){.arguments = {"subdivide", "box.obj", "-o", "b.obj", "--levels", "5",
                                                              "--adaptive", "0.01", "--limit"}});
    double faces = json_number(report, "counts.faces");
    assert_true(json_number(report, "subdivide.adaptive_faces") > 0);
    assert_true(faces > 100 && faces < 6 * 1024 / 2);
    free(report);
    char *info = info_of(folder, "b.obj");
    assert_true(json_bool(info, "certificate.closed") && json_bool(info, "certificate.manifold"));
    assert_true(json_bool(info, "certificate.oriented"));
    free(info);
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_schemes),
        cmocka_unit_test(test_tags),
        cmocka_unit_test(test_adaptive),
    };
    return cmocka_run_group_tests_name("subdivide", tests, NULL, NULL);
}
