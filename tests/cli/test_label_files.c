/* hewn convert --labels: GLB with a node a label as assimp reads it, a file a label, the shared mesh, tables, refusals.
 */
#include <math.h>

#include "mesh_files.h"

/* 6 x 5 x 4 voxels, LAS with spacings 1, 2, 3: label 1 is i < 2, label 2 is i = 2 or 3, and label 5 is i = 4 where j is
 * below 3. */
static void write_labels(const char *folder)
{
    char text[2048];
    int length = snprintf(text, sizeof text,
                          "NRRD0004\ntype: short\ndimension: 3\nsizes: 6 5 4\nspace: RAS\n"
                          "space directions: (-1,0,0) (0,2,0) (0,0,3)\nspace origin: (0,0,0)\n"
                          "space units: \"mm\" \"mm\" \"mm\"\nencoding: ascii\n\n");
    for (int at = 0; at < 120; at++) {
        int i = at % 6, j = at / 6 % 5;
        length += snprintf(text + length, sizeof text - (size_t)length, "%d\n",
                           i < 2             ? 1
                           : i < 4           ? 2
                           : i == 4 && j < 3 ? 5
                                             : 0);
    }
    run_write_file(run_path(folder, "a.nrrd"), text);
    run_write_file(run_path(folder, "names.txt"),
                   "0 Clear 0 0 0 0\n1 left/part 255 0 0 255\n2 middle 0 255 0 255\n5 last 0 0 255 128\n");
}

static void check_closed(const char *folder, const char *name, double volume)
{
    run_result info = run_in(0, folder, (run_desc){.arguments = {"info", name, "--json"}});
    if (!json_bool(info.out, "certificate.closed") || !json_bool(info.out, "certificate.manifold") ||
        !json_bool(info.out, "certificate.oriented"))
        fail_msg("%s: %s", name, info.out);
    if (!(fabs(json_number(info.out, "certificate.volume") - volume) < 1e-5 * fabs(volume)))
        fail_msg("%s: volume %g, not %g", name, json_number(info.out, "certificate.volume"), volume);
    run_result_destroy(&info);
}

/* assimp finds the nodes with their names, and in each a closed mesh. */
static void test_glb(void **state)
{
    (void)state;
    run_need_program("assimp");
    char *folder = run_folder_create();
    write_labels(folder);
    run_result result = run_in(0, folder,
                               (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "--names", "names.txt",
                                                        "-o", "a.glb", "--report", "r.json"}});
    assert_has(result.err, "3 labels, which share ");
    assert_has(result.err, "unit mm -> m; up +Y; space gltf");
    run_result_destroy(&result);
    char *report = run_read_file(run_path(folder, "r.json"), NULL);
    assert_true(json_is_valid(report));
    assert_int_equal(json_count(report, "labels"), 3);
    assert_string_equal(json_string(report, "labels.0.name"), "left/part");
    assert_true(json_number(report, "labels.2.label") == 5 && json_number(report, "labels.2.voxels") == 12);
    assert_true(json_number(report, "labels.2.color.2") == 255);
    double sum = 0;
    for (int n = 0; n < 3; n++) {
        char path[64];
        snprintf(path, sizeof path, "labels.%d.certificate.volume", n);
        assert_true(json_number(report, path) > 0);
        sum += json_number(report, path);
    }
    run_result dump = run_in(0, folder, (run_desc){.program = "assimp", .arguments = {"info", "a.glb"}});
    static const char *const lines[] = {"Meshes:             3", "Materials:          3", "left/part", "middle",
                                        "last"};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        assert_has(dump.out, lines[i]);
    run_result_destroy(&dump);
    /* All meshes in one file, by assimp and back: the volumes of all shells together. */
    run_result export =
        run_in(0, folder, (run_desc){.program = "assimp", .arguments = {"export", "a.glb", "back.ply", "-fplyb"}});
    run_result_destroy(&export);
    check_closed(folder, "back.ply", sum);
    check_closed(folder, "a.glb", sum);
    free(report);
    run_folder_destroy(folder);
}

/* A file each, in a folder that is made and by a pattern; every one is closed by itself after it is read again. */
static void test_files(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_labels(folder);
    run_result result =
        run_in(0, folder,
               (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "2,1", "--names", "names.txt", "-o", "out/",
                                        "--smooth-labels", "0", "--report", "r.json", "-q"}});
    assert_string_equal(result.err, "");
    run_result_destroy(&result);
    assert_int_equal(run_folder_count(run_path(folder, "out")), 2);
    char *report = run_read_file(run_path(folder, "r.json"), NULL);
    assert_string_equal(json_string(report, "labels.0.output"), "out/left_part.stl");
    check_closed(folder, "out/left_part.stl", json_number(report, "labels.0.certificate.volume"));
    check_closed(folder, "out/middle.stl", json_number(report, "labels.1.certificate.volume"));
    free(report);
    result = run_in(0, folder,
                    (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "1-9", "-o", "x{label}-{name}.ply",
                                             "--smooth", "taubin"}});
    assert_has(result.err, "no voxel has label 3, 4, 6, 7, 8, 9");
    assert_has(result.err, "taubin");
    run_result_destroy(&result);
    assert_true(run_file_exists(run_path(folder, "x1-label_1.ply")));
    assert_true(run_file_exists(run_path(folder, "x2-label_2.ply")));
    assert_true(run_file_exists(run_path(folder, "x5-label_5.ply")));
    run_folder_destroy(folder);
}

/* Shared faces once, with both labels; and all shells as objects of one file. */
static void test_together(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_labels(folder);
    run_result result = run_in(
        0, folder, (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "--complex", "-o", "c.ply", "-q"}});
    run_result_destroy(&result);
    result = run_in(0, folder, (run_desc){.arguments = {"info", "c.ply", "--json"}});
    assert_has(result.out, "\"back\"");
    assert_has(result.out, "\"front\"");
    assert_false(json_bool(result.out, "certificate.manifold"));
    assert_true(json_bool(result.out, "certificate.closed"));
    run_result_destroy(&result);
    result = run_in(
        0, folder,
        (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "--names", "names.txt", "-o", "c.obj", "-q"}});
    run_result_destroy(&result);
    char *obj = run_read_file(run_path(folder, "c.obj"), NULL);
    assert_has(obj, "left/part");
    assert_has(obj, "middle");
    free(obj);
    result = run_in(0, folder, (run_desc){.arguments = {"check", "c.obj", "--json"}});
    assert_true(json_bool(result.out, "certificate.closed") && json_bool(result.out, "certificate.manifold"));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* Fewer triangles, shells as sound as before, and vertices on borders that are still shared. */
static void test_simplified(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_labels(folder);
    run_result result =
        run_in(0, folder,
               (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "--simplify", "ratio:0.4", "-o",
                                        "all.ply", "--complex", "--report", "r.json"}});
    assert_has(result.err, " triangles left");
    run_result_destroy(&result);
    char *report = run_read_file(run_path(folder, "r.json"), NULL);
    assert_true(json_is_valid(report));
    const double before = json_number(report, "simplify.triangles_before");
    const double after = json_number(report, "simplify.triangles");
    assert_true(after > 0 && after <= 0.4 * before);
    assert_true(json_number(report, "counts.faces") == after);
    double faces = 0;
    for (int n = 0; n < 3; n++) {
        char key[64];
        snprintf(key, sizeof key, "labels.%d.certificate.closed", n);
        assert_true(json_bool(report, key));
        snprintf(key, sizeof key, "labels.%d.certificate.manifold", n);
        assert_true(json_bool(report, key));
        snprintf(key, sizeof key, "labels.%d.faces", n);
        faces += json_number(report, key);
    }
    assert_true(faces > after); /* faces between two labels are there once */
    free(report);
    result = run_in(
        2, folder,
        (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "--simplify", "ratio:2", "-o", "bad.ply"}});
    assert_has(result.err, "ratio");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        int code;
        const char *arguments[9];
        const char *reason;
    } bad[] = {
        {2, {"--labels", "all", "-o", "x.stl"}, "cannot be told apart in one stl file"},
        {2, {"--labels", "", "-o", "x.glb"}, "--labels takes"},
        {2, {"--labels", "1,,2", "-o", "x.glb"}, "--labels takes"},
        {2, {"--labels", "5-1", "-o", "x.glb"}, "from 5 to 1"},
        {2, {"--labels", "1", "--iso", "3", "-o", "x.glb"}, "--iso"},
        {2, {"--names", "names.txt", "-o", "x.glb"}, "go with --labels"},
        {2, {"--labels", "all", "--complex", "-o", "x.obj"}, "--complex needs PLY"},
        {2, {"--labels", "all", "-o", "x.glb", "--to-unit", "mm"}, "metres"},
        {2, {"--labels", "all", "--names", "same.txt", "-o", "{name}.stl"}, "would both be written to a.stl"},
        {2, {"--labels", "all", "-o", "{label}/x.stl"}, "names of files only"},
        {2, {"--labels", "all", "-o", "x.glb", "--frame", "1"}, "no frame 1"},
        {3, {"--labels", "77", "-o", "x.glb"}, "no voxel has a label that was asked for"},
        {3, {"--labels", "all", "--names", "broken.txt", "-o", "x.glb"}, "broken.txt:2: "},
        {3, {"--labels", "all", "--names", "missing.txt", "-o", "x.glb"}, "missing.txt"},
        {1, {"--labels", "all", "-o", "no/such/x.glb"}, "no/such"},
    };
    char *folder = run_folder_create();
    write_labels(folder);
    run_write_file(run_path(folder, "same.txt"), "1 a\n2 a\n");
    run_write_file(run_path(folder, "broken.txt"), "1 a\ntwo b\n");
    int files = run_folder_count(folder);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        run_desc desc = {.arguments = {"convert", "a.nrrd"}};
        for (int k = 0; bad[i].arguments[k]; k++)
            desc.arguments[2 + k] = bad[i].arguments[k];
        run_result result = run_in(bad[i].code, folder, desc);
        if (!strstr(result.err, bad[i].reason))
            fail_msg("case %zu: %s", i, result.err);
        run_result_destroy(&result);
        assert_int_equal(run_folder_count(folder), files);
    }
    run_folder_destroy(folder);
}

/* All regions of a brain: every shell is closed, and they fill the brain's own shell. */
static void test_brain(void **state)
{
    (void)state;
    char *volume = strdup(run_data_file("volume/aal.nii.gz")), *folder = run_folder_create();
    run_result result =
        run_in(0, folder,
               (run_desc){.arguments = {"convert", volume, "--labels", "all", "-o", "aal.glb", "--report", "r.json"}});
    assert_has(result.err, "116 labels");
    run_result_destroy(&result);
    char *report = run_read_file(run_path(folder, "r.json"), NULL);
    assert_int_equal(json_count(report, "labels"), 116);
    for (int n = 0; n < 116; n++) {
        char path[64];
        snprintf(path, sizeof path, "labels.%d.certificate.manifold", n);
        assert_true(json_bool(report, path));
        snprintf(path, sizeof path, "labels.%d.certificate.volume", n);
        double is = json_number(report, path) * 1e9;
        snprintf(path, sizeof path, "labels.%d.voxels", n);
        double voxels = json_number(report, path); /* of 1 mm */
        if (!(is > 0.8 * voxels && is < 1.1 * voxels))
            fail_msg("label number %d has %g voxels and a volume of %g", n, voxels, is);
    }
    free(report);
    free(volume);
    run_folder_destroy(folder);
}

/* --- spaces ------------------------------------------------------------------------------------------------------- */

/* Bounds of the labels' mesh, and what its file says of it. */
static void check_space(const char *folder, const char *file, const char *space, const char *says, const double lo[3],
                        const double hi[3])
{
    run_desc desc = {.arguments = {"convert", "a.nrrd", "--labels", "all", "--smooth-labels", "0", "-o", file}};
    if (space) {
        desc.arguments[8] = "--space";
        desc.arguments[9] = space;
    }
    run_result result = run_in(0, folder, desc);
    run_result_destroy(&result);
    char *text = run_read_file(run_path(folder, file), NULL);
    if (says)
        assert_has(text, says);
    free(text);
    run_result info = run_in(0, folder, (run_desc){.arguments = {"info", file, "--json"}});
    for (int axis = 0; axis < 3; axis++) {
        char path[64];
        snprintf(path, sizeof path, "certificate.bounds.lo.%d", axis);
        const double low = json_number(info.out, path);
        snprintf(path, sizeof path, "certificate.bounds.hi.%d", axis);
        const double high = json_number(info.out, path), off = 0.02 * (hi[axis] - lo[axis]);
        if (!(fabs(low - lo[axis]) < off && fabs(high - hi[axis]) < off))
            fail_msg("%s: %g to %g along axis %d", file, low, high, axis);
    }
    run_result_destroy(&info);
}

/* Voxels reach from i = -0.5 to 4.5, of 1, 2 and 3 mm, and i runs to the left. */
static void test_spaces(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_labels(folder);
    check_space(folder, "ras.ply", NULL, "SPACE=RAS", (double[]){-4.5, -1, -1.5}, (double[]){0.5, 9, 10.5});
    check_space(folder, "lps.obj", "lps", "SPACE=LPS", (double[]){-0.5, -9, -1.5}, (double[]){4.5, 1, 10.5});
    check_space(folder, "voxel.ply", "voxel", NULL, (double[]){-0.5, -0.5, -0.5}, (double[]){4.5, 4.5, 3.5});
    check_space(folder, "gltf.obj", "gltf", NULL, (double[]){-0.0005, -0.0015, -0.001},
                (double[]){0.0045, 0.0105, 0.009});
    run_result result =
        run_in(0, folder, (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "-o", "a.glb"}});
    run_result_destroy(&result);
    size_t length;
    char *glb = run_read_file(run_path(folder, "a.glb"), &length);
    assert_has(glb + 20, "\"space\": \"x left, y head, z front\""); /* behind the head, which has zeros */
    free(glb);
    fail_in(2, folder, "glTF's space",
            (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "-o", "b.glb", "--space", "lps"}});
    fail_in(2, folder, "--space is",
            (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "-o", "b.ply", "--space", "moon"}});
    fail_in(2, folder, "--to-up",
            (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "-o", "b.ply", "--space", "lps", "--to-up",
                                     "+y"}});
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spaces),   cmocka_unit_test(test_glb),        cmocka_unit_test(test_files),
        cmocka_unit_test(test_together), cmocka_unit_test(test_simplified), cmocka_unit_test(test_refused),
        cmocka_unit_test(test_brain),
    };
    return cmocka_run_group_tests_name("label_files", tests, NULL, NULL);
}
