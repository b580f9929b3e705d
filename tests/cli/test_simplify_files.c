/* hewn simplify: from file to file, with attributes, promises and a report; --simplify elsewhere; check --against. */
#include <math.h>

#include "mesh_files.h"

/* A half ball of rings over a disc, with colours: open, 2 n n + n triangles about. */
static void write_dome(const char *path, int n)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face %d\n"
            "property list uchar int vertex_indices\nend_header\n",
            n * n + 1, 2 * n * n - n);
    fprintf(file, "0 0 1 255 0 0\n");
    for (int ring = 1; ring <= n; ring++)
        for (int i = 0; i < n; i++) {
            const double up = M_PI / 2 * ring / n, around = 2 * M_PI * i / n;
            fprintf(file, "%.17g %.17g %.17g %d 0 0\n", sin(up) * cos(around), sin(up) * sin(around), cos(up),
                    i < n / 2 ? 255 : 0);
        }
    for (int i = 0; i < n; i++)
        fprintf(file, "3 0 %d %d\n", 1 + i, 1 + (i + 1) % n);
    for (int ring = 1; ring < n; ring++)
        for (int i = 0; i < n; i++) {
            const int a = 1 + (ring - 1) * n + i, b = 1 + (ring - 1) * n + (i + 1) % n;
            fprintf(file, "3 %d %d %d\n3 %d %d %d\n", a, a + n, b + n, a, b + n, b);
        }
    fclose(file);
}

static char *make_dome_folder(void)
{
    char *folder = run_folder_create();
    write_dome(run_path(folder, "dome.ply"), 60);
    return folder;
}

static void test_targets(void **state)
{
    (void)state;
    char *folder = make_dome_folder();
    static const struct {
        const char *option, *value;
        double most;
    } cases[] = {
        {"--ratio", "0.1", 714}, {"--faces", "300", 300}, {"--error", "0.01", 2000}, {"--error-rel", "0.01", 2000}};
    for (int i = 0; i < 4; i++) {
        char *report = report_of(
            folder, (run_desc){.arguments = {"simplify", "dome.ply", "-o", "d.ply", cases[i].option, cases[i].value}});
        assert_true(json_number(report, "simplify.triangles_before") == 7140);
        assert_true(json_number(report, "simplify.triangles") <= cases[i].most);
        assert_true(json_number(report, "counts.faces") == json_number(report, "simplify.triangles"));
        assert_true(json_number(report, "simplify.distance") >= json_number(report, "simplify.distance_low"));
        if (i == 2)
            assert_true(json_number(report, "simplify.distance") <= 0.01);
        run_result result =
            run_in(0, folder,
                   (run_desc){.arguments = {"check", "d.ply", "--against", "dome.ply", "--json", "--require",
                                            "manifold,oriented,no-degenerate-faces,one-component"}});
        assert_true(json_is_valid(result.out));
        const double low = json_number(result.out, "distance.low"), high = json_number(result.out, "distance.high");
        assert_true(low <= high);
        assert_true(low <= json_number(report, "simplify.distance"));
        assert_true(high >= json_number(report, "simplify.distance_low"));
        assert_true(json_number(result.out, "certificate.boundary_loops") == 1);
        run_result_destroy(&result);
        free(report);
    }
    run_folder_destroy(folder);
}

static void test_locks_and_attributes(void **state)
{
    (void)state;
    char *folder = make_dome_folder();
    char *report = report_of(folder, (run_desc){.arguments = {"simplify", "dome.ply", "-o", "d.ply", "--ratio", "0.1",
                                                              "--lock", "boundary,features:80"}});
    assert_true(json_number(report, "simplify.locked_vertices") == 60);
    free(report);
    char *info = info_of(folder, "d.ply");
    assert_true(json_count(info, "attributes") == 1);
    free(info);
    report = report_of(folder, (run_desc){.arguments = {"simplify", "dome.ply", "-o", "d.ply", "--faces", "1"}});
    assert_true(json_number(report, "simplify.triangles") >= 1);
    free(report);
    run_folder_destroy(folder);
}

static void test_convert_does_the_same(void **state)
{
    (void)state;
    char *folder = make_dome_folder();
    static const char *const targets[][3] = {
        {"--ratio", "0.2", "ratio:0.2"}, {"--faces", "500", "faces:500"}, {"--error", "0.02", "error:0.02"}};
    for (int i = 0; i < 3; i++) {
        run_result result = run_in(
            0, folder, (run_desc){.arguments = {"simplify", "dome.ply", "-o", "a.ply", targets[i][0], targets[i][1]}});
        assert_has(result.err, "of 7140 triangles left");
        run_result_destroy(&result);
        size_t one_length, two_length;
        char *one = run_read_file(run_path(folder, "a.ply"), &one_length);
        result = run_in(0, folder,
                        (run_desc){.arguments = {"convert", "dome.ply", "-o", "a.ply", "--simplify", targets[i][2]}});
        assert_has(result.err, "of 7140 triangles left");
        run_result_destroy(&result);
        char *two = run_read_file(run_path(folder, "a.ply"), &two_length);
        assert_int_equal(one_length, two_length);
        assert_memory_equal(one, two, one_length);
        free(one);
        free(two);
    }
    run_folder_destroy(folder);
}

static void test_misuse(void **state)
{
    (void)state;
    char *folder = make_dome_folder();
    static const struct {
        const char *says;
        const char *arguments[4];
    } cases[] = {
        {"simplify how far?", {NULL}},
        {"--ratio is above 0 and at most 1, not 0", {"--ratio", "0"}},
        {"--ratio is above 0 and at most 1, not 1.5", {"--ratio", "1.5"}},
        {"--ratio takes a number", {"--ratio", "nan"}},
        {"--faces must be at least 1", {"--faces", "0"}},
        {"--error must be greater than 0", {"--error", "0"}},
        {"--error takes a number", {"--error", "nan"}},
        {"--error-rel must be greater than 0", {"--error-rel", "-1"}},
        {"exclude each other", {"--faces", "10", "--ratio", "0.5"}},
        {"exclude each other", {"--error", "10", "--error-rel", "0.5"}},
        {"--lock features: takes a number", {"--faces", "10", "--lock", "features:x"}},
        {"--lock takes boundary", {"--faces", "10", "--lock", "all"}},
        {"--preserve takes uv", {"--faces", "10", "--preserve", "uv,shape"}},
        {"--preserve none excludes", {"--faces", "10", "--preserve", "none,uv"}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {.arguments = {"simplify", "dome.ply", "-o", "d.ply"}};
        for (int k = 0; k < 4; k++)
            desc.arguments[4 + k] = cases[i].arguments[k];
        fail_in(2, folder, cases[i].says, desc);
    }
    fail_in(2, folder, "--simplify takes faces:N, ratio:R or error:LENGTH",
            (run_desc){.arguments = {"convert", "dome.ply", "-o", "d.ply", "--simplify", "0.5"}});
    fail_in(2, folder, "--simplify ratio: is above 0",
            (run_desc){.arguments = {"convert", "dome.ply", "-o", "d.ply", "--simplify", "ratio:7"}});
    fail_in(2, folder, "--against takes a file", (run_desc){.arguments = {"check", "dome.ply", "--against", "-"}});
    run_write_file(run_path(folder, "none.obj"), "v 0 0 0\n");
    fail_in(3, folder, "no faces to simplify",
            (run_desc){.arguments = {"simplify", "none.obj", "-o", "d.ply", "--faces", "1"}});
    fail_in(3, folder, "second surface has no faces",
            (run_desc){.arguments = {"check", "dome.ply", "--quiet", "--against", "none.obj"}});
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_targets),
        cmocka_unit_test(test_locks_and_attributes),
        cmocka_unit_test(test_convert_does_the_same),
        cmocka_unit_test(test_misuse),
    };
    return cmocka_run_group_tests_name("simplify", tests, NULL, NULL);
}
