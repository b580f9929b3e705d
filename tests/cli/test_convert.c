/* hewn convert: formats, units, axes, and the truth about what was done. */
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "mesh_files.h"

static char *make_box_folder(void)
{
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "box.obj"), box_obj);
    return folder;
}

static void assert_near(double value, double expected)
{
    if (!(fabs(value - expected) <= 1e-6 * fmax(1, fabs(expected))))
        fail_msg("%.17g instead of %.17g", value, expected);
}

static void assert_bounds(const char *info, double x0, double y0, double z0, double x1, double y1, double z1)
{
    const double expected[] = {x0, y0, z0, x1, y1, z1};
    for (int i = 0; i < 6; i++) {
        char path[32];
        snprintf(path, sizeof path, "bounds.%s.%d", i < 3 ? "lo" : "hi", i % 3);
        assert_near(json_number(info, path), expected[i]);
    }
}

/* Through every format: the same box, quadrilaterals where they can be. */
static void test_formats(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        bool polygons, reads;
    } formats[] = {{"b.obj", true, true},  {"b.ply", true, true},  {"b.off", true, true},  {"b.stl", false, true},
                   {"b.glb", false, true}, {"B.STL", false, true}, {"b.3mf", false, false}};
    char *folder = make_box_folder();
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        const char *name = formats[i].name;
        char *report = report_of(folder, (run_desc){.arguments = {"convert", "box.obj", "-o", name}});
        assert_string_equal(json_string(report, "from"), "obj");
        assert_true(json_number(report, "counts.faces") == 6);
        assert_true(json_number(report, "not_kept.cut_faces") == (formats[i].polygons ? 0 : 6));
        free(report);
        if (!formats[i].reads)
            continue;
        char *info = info_of(folder, name);
        assert_true(json_number(info, "counts.faces") == (formats[i].polygons ? 6 : 12));
        assert_true(json_number(info, "counts.vertices") == 8);
        assert_bounds(info, 0, 0, 0, 1, 2, 3);
        assert_near(json_number(info, "certificate.volume"), 6);
        free(info);
    }
    run_folder_destroy(folder);
}

/* From every format that is read to every one that is written. */
static void test_all_pairs(void **state)
{
    (void)state;
    static const char *const names[] = {"obj", "ply", "off", "stl", "glb", "3mf"};
    char *folder = make_box_folder();
    for (int i = 0; i < 5; i++) {
        char from[16], to[16];
        snprintf(from, sizeof from, "a.%s", names[i]);
        free(report_of(folder, (run_desc){.arguments = {"convert", "box.obj", "-o", from}}));
        for (int j = 0; j < 6; j++) {
            snprintf(to, sizeof to, "b.%s", names[j]);
            free(report_of(folder, (run_desc){.arguments = {"convert", from, "-o", to}}));
            if (j == 5)
                continue;
            char *info = info_of(folder, to);
            assert_near(json_number(info, "certificate.volume"), 6);
            assert_true(json_number(info, "counts.vertices") == 8);
            free(info);
        }
    }
    run_folder_destroy(folder);
}

/* --- units and axes ---------------------------------------------------------------------------------------------- */

static void test_units_and_axes(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    run_desc desc = {.arguments = {"convert", "box.obj", "--unit", "in", "--up", "z", "-o", "b.glb"}};
    run_result result = run_in(0, folder, desc);
    assert_string_equal(result.out, "");
    assert_has(result.err, "box.obj -> b.glb: 8 vertices, 6 faces; unit in -> m (times 127/5000); "
                           "up +Z -> +Y (turned by [1 0 0; 0 0 1; 0 -1 0])\n");
    run_result_destroy(&result);
    char *info = info_of(folder, "b.glb");
    assert_bounds(info, 0, 0, -2 * 0.0254, 0.0254, 3 * 0.0254, 0);
    assert_string_equal(json_string(info, "unit"), "m");
    assert_string_equal(json_string(info, "up"), "+Y");
    free(info);
    char *report = report_of(folder, desc);
    assert_string_equal(json_string(report, "conversion.unit_before"), "in");
    assert_string_equal(json_string(report, "conversion.unit_after"), "m");
    assert_true(json_is_null(report, "conversion.unit_in_file"));
    assert_true(json_number(report, "conversion.scale.0") == 127);
    assert_true(json_number(report, "conversion.scale.1") == 5000);
    static const int rotation[] = {1, 0, 0, 0, 0, 1, 0, -1, 0};
    for (int i = 0; i < 9; i++) {
        char path[32];
        snprintf(path, sizeof path, "conversion.rotation.%d", i);
        assert_true(json_number(report, path) == rotation[i]);
    }
    free(report);
    /* Back to where it was. */
    desc = (run_desc){.arguments = {"convert", "b.glb", "--to-unit", "in", "--to-up", "+Z", "-o", "c.off"}};
    report = report_of(folder, desc);
    assert_string_equal(json_string(report, "conversion.unit_in_file"), "m");
    assert_string_equal(json_string(report, "conversion.up_in_file"), "+Y");
    free(report);
    info = info_of(folder, "c.off");
    assert_bounds(info, 0, 0, 0, 1, 2, 3);
    free(info);
    run_folder_destroy(folder);
}

/* What nobody said is taken for what is wanted, and said to be so; numbers stay. */
static void test_assumed(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    run_desc desc = {.arguments = {"convert", "box.obj", "-o", "b.glb"}};
    run_result result = run_in(0, folder, desc);
    assert_has(result.err, "unit m (assumed); up +Y (assumed)\n");
    run_result_destroy(&result);
    char *report = report_of(folder, desc);
    assert_true(json_bool(report, "conversion.unit_assumed"));
    assert_true(json_bool(report, "conversion.up_assumed"));
    assert_true(json_is_null(report, "conversion.unit_before"));
    assert_true(json_number(report, "conversion.scale.0") == 1);
    free(report);
    result = run_in(0, folder, (run_desc){.arguments = {"convert", "box.obj", "-o", "b.3mf"}});
    assert_has(result.err, "unit mm (assumed); up +Z (assumed)\n");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* A file that says nothing stays a file that says nothing, and what a file says is kept and can be overruled. */
static void test_known_and_unknown(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    static const char *const names[] = {"b.obj", "b.ply", "b.off", "b.stl"};
    for (int i = 0; i < 4; i++) {
        run_result result = run_in(0, folder, (run_desc){.arguments = {"convert", "box.obj", "-o", names[i]}});
        assert_has(result.err, "unit unknown; up unknown\n");
        run_result_destroy(&result);
        char *info = info_of(folder, names[i]);
        assert_true(json_is_null(info, "unit"));
        assert_true(json_is_null(info, "up"));
        free(info);
        run_desc desc = {.arguments = {"convert", "box.obj", "--unit", "ft", "--up", "X", "-o", names[i]}};
        free(report_of(folder, desc));
        info = info_of(folder, names[i]);
        assert_string_equal(json_string(info, "unit"), "ft");
        assert_string_equal(json_string(info, "up"), "+X");
        free(info);
        desc = (run_desc){.arguments = {"convert", "box.obj", "--unit", "mm", "-o", "half.obj"}};
        free(report_of(folder, desc));
        desc = (run_desc){.arguments = {"convert", "half.obj", "-o", i == 0 ? "half.ply" : names[i]}};
        free(report_of(folder, desc));
        info = info_of(folder, desc.arguments[3]);
        assert_string_equal(json_string(info, "unit"), "mm");
        assert_true(json_is_null(info, "up"));
        free(info);
        free(report_of(folder,
                       (run_desc){.arguments = {"convert", "box.obj", "--unit", "ft", "--up", "X", "-o", names[i]}}));
        desc = (run_desc){
            .arguments = {"convert", names[i], "--unit", "in", "--up", "y", "--to-unit", "ft", "-o", "c.obj"}};
        result = run_in(0, folder, desc);
        assert_has(result.err, "unit in -> ft (times 1/12)");
        assert_has(result.err, "note: --unit in overrules the file, which says ft\n");
        assert_has(result.err, "note: --up +Y overrules the file, which says +X\n");
        run_result_destroy(&result);
        info = info_of(folder, "c.obj");
        assert_near(json_number(info, "bounds.hi.1"), 2.0 / 12);
        free(info);
    }
    run_folder_destroy(folder);
}

static void test_formats_with_a_frame_of_their_own(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    fail_in(2, folder, "GLB is always in metres, not in mm",
            (run_desc){.arguments = {"convert", "box.obj", "-o", "b.glb", "--to-unit", "mm"}});
    fail_in(2, folder, "GLB always has +Y up, not +Z",
            (run_desc){.arguments = {"convert", "box.obj", "-o", "b.glb", "--to-up", "+Z"}});
    fail_in(2, folder, "3MF always has +Z up, not +Y",
            (run_desc){.arguments = {"convert", "box.obj", "-o", "b.3mf", "--to-up", "+Y"}});
    fail_in(2, folder, "3MF cannot be in km",
            (run_desc){.arguments = {"convert", "box.obj", "-o", "b.3mf", "--to-unit", "km"}});
    run_desc desc = {.arguments = {"convert", "box.obj", "--unit", "km", "--up", "+Y", "-o", "b.3mf"}};
    run_result result = run_in(0, folder, desc);
    assert_has(result.err, "unit km -> m (times 1000/1); up +Y -> +Z (turned by [1 0 0; 0 0 -1; 0 1 0])\n");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* --- what is kept ------------------------------------------------------------------------------------------------ */

/* Doubles, polygons and groups come through untouched, over the file itself too. */
static void test_nothing_is_touched(void **state)
{
    (void)state;
    static const char exact[] = "v 0.1 0.30000000000000004 1e-300\nv 1.7976931348623157e+308 0 0\nv 0 1 0\n"
                                "v -0.5 3.1415926535897931 5e-324\ng a\nf 1 2 3 4\n";
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "a.obj"), exact);
    static const char *const chain[] = {"a.obj", "b.ply", "c.obj", "c.obj", "sub/b.ply"};
    run_subfolder(folder, "sub"); /* an object is called after its file */
    for (int i = 0; i < 4; i++) {
        char *report = report_of(folder, (run_desc){.arguments = {"convert", chain[i], "-o", chain[i + 1]}});
        assert_int_equal(json_count(report, "not_kept.attributes"), 0);
        assert_true(json_number(report, "not_kept.rounded_vertices") == 0);
        free(report);
    }
    assert_same_files(folder, "b.ply", "sub/b.ply");
    char *text = read_text(folder, "c.obj");
    assert_has(text, "0.1 0.30000000000000004 1e-300");
    assert_has(text, "g a\n");
    assert_has(text, "f 1 2 3 4");
    free(text);
    assert_int_equal(run_folder_count(folder), 4);
    run_folder_destroy(folder);
}

static void test_losses_are_told(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    run_write_file(run_path(folder, "a.obj"), "v 0.1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nvt 0 0\ng one\n"
                                              "f 1/1 2/1 3/1 4/1\n");
    run_desc desc = {.arguments = {"convert", "a.obj", "-o", "a.stl"}};
    run_result result = run_in(0, folder, desc);
    assert_has(result.err, "hewn: note: not kept by STL: 1 polygon, cut into triangles; vertex uv, face group; "
                           "double precision (1 vertex rounded to floats, by at most 1.5e-09); "
                           "1 vertex without a face\n");
    run_result_destroy(&result);
    char *report = report_of(folder, desc);
    assert_true(json_number(report, "not_kept.cut_faces") == 1);
    assert_int_equal(json_count(report, "not_kept.attributes"), 2);
    assert_string_equal(json_string(report, "not_kept.attributes.0"), "vertex uv");
    assert_true(json_number(report, "not_kept.rounded_vertices") == 1);
    assert_true(json_number(report, "not_kept.rounding") > 1.4e-9);
    assert_true(json_number(report, "not_kept.isolated_vertices") == 1);
    free(report);
    result = run_in(0, folder, (run_desc){.arguments = {"convert", "a.obj", "-o", "a.ply"}});
    assert_lacks(result.err, "note");
    run_result_destroy(&result);
    result = run_in(0, folder, (run_desc){.arguments = {"convert", "a.obj", "-o", "a.off", "--quiet"}});
    assert_string_equal(result.err, "");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* --- streams ----------------------------------------------------------------------------------------------------- */

static void test_streams(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    run_desc desc = {.arguments = {"convert", "-", "--from", "obj", "-o", "-", "--to", "off"},
                     .input = run_path(folder, "box.obj")};
    run_result result = run_in(0, folder, desc);
    assert_has(result.out, "\n8 6 0\n");
    assert_has(result.err, "standard input -> standard output: 8 vertices, 6 faces");
    run_write_file(run_path(folder, "b.off"), result.out);
    run_result_destroy(&result);
    run_result file = run_in(0, folder, (run_desc){.arguments = {"convert", "box.obj", "-o", "c.off", "-q"}});
    run_result_destroy(&file);
    assert_same_files(folder, "b.off", "c.off");
    desc = (run_desc){.arguments = {"convert", "box.obj", "-o", "b.ply", "--report", "-"}};
    result = run_in(0, folder, desc);
    assert_true(json_is_valid(result.out));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* --- failures ---------------------------------------------------------------------------------------------------- */

static void test_refused_before_any_work(void **state)
{
    (void)state;
    static const struct {
        const char *arguments[8];
        const char *says;
    } cases[] = {
        {{"convert"}, "which file?"},
        {{"convert", "a.obj", "b.obj", "-o", "c.obj"}, "one file at a time"},
        {{"convert", "a.obj"}, "Give -o FILE"},
        {{"convert", "a.obj", "-o", ""}, "a file needs a name"},
        {{"convert", "a.xyz", "-o", "b.obj"}, "ends in no mesh format that Hewn reads"},
        {{"convert", "a.obj", "-o", "b.xyz"}, "does not end in"},
        {{"convert", "a.obj", "-o", "b"}, "does not end in"},
        {{"convert", "a.obj", "-o", "b.gltf"}, "can be read only"},
        {{"convert", "a.obj", "-o", "b.ply.gz"}, "compressed files can be read only"},
        {{"convert", "a.3mf", "-o", "b.ply"}, "3MF can be written, but not read"},
        {{"convert", "-", "-o", "b.ply"}, "--from"},
        {{"convert", "a.obj", "-o", "-"}, "--to obj, ply, stl or off"},
        {{"convert", "a.obj", "-o", "-", "--to", "glb"}, "GLB cannot be written to standard output"},
        {{"convert", "a.obj", "-o", "-", "--to", "3mf"}, "3MF cannot be written to standard output"},
        {{"convert", "a.obj", "-o", "b.obj", "--to", "gif"}, "not 'gif'"},
        {{"convert", "a.obj", "-o", "b.obj", "--from", "x.obj"}, "not 'x.obj'"},
        {{"convert", "a.obj", "-o", "b.obj", "--unit", "parsec"}, "--unit is one of m, cm, mm"},
        {{"convert", "a.obj", "-o", "b.obj", "--up", "-Z"}, "--up is +X, +Y or +Z, not '-Z'"},
        {{"convert", "a.obj", "-o", "b.obj", "--to-up", "up"}, "--to-up is +X, +Y or +Z, not 'up'"},
        {{"convert", "a.obj", "-o", "b.obj", "--report", "b.obj"}, "cannot both go to b.obj"},
    };
    char *folder = run_folder_create();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {0};
        memcpy(desc.arguments, cases[i].arguments, sizeof cases[i].arguments);
        fail_in(2, folder, cases[i].says, desc);
    }
    run_folder_destroy(folder);
}

static void test_bad_inputs(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "bad.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    run_write_file(run_path(folder, "bad.ply"), "ply\nformat ascii 1.0\nelement vertex 9999999999999\n");
    run_write_file(run_path(folder, "bad.stl"), "solid x\nfacet");
    run_write_file(run_path(folder, "bad.off"), "OFF\n1 1\n");
    run_write_file(run_path(folder, "bad.glb"), "glTF");
    run_write_file(run_path(folder, "bad.obj.gz"), "\x1f\x8b\x08 and then nothing");
    static const char *const names[] = {"bad.obj", "bad.ply", "bad.stl", "bad.off", "bad.glb", "bad.obj.gz"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        fail_in(3, folder, names[i], (run_desc){.arguments = {"convert", names[i], "-o", "out.ply"}});
    fail_in(3, folder, "missing.obj: cannot open: No such file",
            (run_desc){.arguments = {"convert", "missing.obj", "-o", "out.ply"}});
    fail_in(3, folder, "is a folder", (run_desc){.arguments = {"convert", "--from", "obj", ".", "-o", "out.ply"}});
    fail_in(3, folder, "standard input",
            (run_desc){.arguments = {"convert", "--from", "obj", "-", "-o", "out.ply"},
                       .input = run_path(folder, "bad.obj")});
    run_folder_destroy(folder);
}

static void test_bad_outputs(void **state)
{
    (void)state;
    char *folder = make_box_folder();
    fail_in(1, folder, "missing/b.ply: ", (run_desc){.arguments = {"convert", "none.obj", "-o", "missing/b.ply"}});
    fail_in(1, folder,
            "missing/r: ", (run_desc){.arguments = {"convert", "none.obj", "-o", "b.ply", "--report", "missing/r"}});
    static const char *const formats[] = {"obj", "ply", "off", "stl", "glb", "3mf"};
    for (int i = 0; i < 6; i++) {
        char name[16];
        snprintf(name, sizeof name, "b.%s", formats[i]);
        run_desc desc = {.arguments = {"convert", "box.obj", "-o", "/dev/full", "--to", formats[i]}};
        fail_in(1, folder, "No space left on device", desc);
        fail_in(1, folder, "File too large",
                (run_desc){.arguments = {"convert", "box.obj", "-o", name}, .file_limit = 100});
        desc = (run_desc){.arguments = {"convert", "box.obj", "-o", "-", "--to", formats[i]}, .output = "/dev/full"};
        if (i < 4)
            fail_in(1, folder, "No space left on device", desc);
    }
    /* A failure keeps the file that was there, even where it is the input. */
    fail_in(1, folder, "File too large",
            (run_desc){.arguments = {"convert", "box.obj", "-o", "box.obj"}, .file_limit = 100});
    char *text = read_text(folder, "box.obj");
    assert_string_equal(text, box_obj);
    free(text);
    run_write_file(run_path(folder, "far.obj"), "v 1e300 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    fail_in(1, folder, "vertex", (run_desc){.arguments = {"convert", "far.obj", "-o", "far.stl"}});
    fail_in(
        1, folder, "too far out",
        (run_desc){.arguments = {"convert", "far.obj", "--unit", "km", "--to-unit", "um", "-o", "b.obj", "--up", "Y"}});
    run_folder_destroy(folder);
}

static void test_cancel(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    const char *pipe_name = run_path(folder, "pipe");
    assert_int_equal(mkfifo(pipe_name, 0600), 0);
    int both_ends = open(pipe_name, O_RDWR | O_CLOEXEC);
    assert_true(both_ends >= 0);
    static const char *const words[] = {"convert", "repair", "check"};
    for (int i = 0; i < 3; i++) {
        run_desc desc = {.arguments = {words[i], "-", "--from", "stl", i < 2 ? "-o" : NULL, "a.ply"},
                         .folder = folder,
                         .input = pipe_name};
        run_process process = run_start(&desc);
        run_sleep(0.25);
        assert_true(run_is_alive(&process));
        kill(process.id, SIGINT);
        run_result result = run_finish(&process);
        assert_int_equal(result.code, 130);
        assert_has(result.err, "hewn: cancelled");
        assert_int_equal(run_folder_count(folder), 1);
        run_result_destroy(&result);
    }
    close(both_ends);
    run_folder_destroy(folder);
}

/* Real files, there and back. */
static void test_real_files(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double vertices, faces;
    } files[] = {{"mesh-scan/spot.obj", -1, -1},
                 {"mesh-scan/dragon_vrip_res3.ply.gz", -1, -1},
                 {"mesh-misc/dodecahedron_poly.obj", 20, 12},
                 {"mesh-misc/stl_box_binary.stl", 8, 12},
                 {"gltf/cube.glb", 8, 12}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const char *path = run_data_file(files[i].name);
        char *folder = run_folder_create();
        char *before = info_of(folder, path);
        free(report_of(folder, (run_desc){.arguments = {"convert", path, "-o", "a.ply"}}));
        free(report_of(folder, (run_desc){.arguments = {"convert", "a.ply", "-o", "a.obj"}}));
        free(report_of(folder, (run_desc){.arguments = {"convert", "a.obj", "-o", "b.ply"}}));
        char *after = info_of(folder, "b.ply");
        static const char *const same[] = {"counts.vertices", "counts.faces", "counts.quads", "bounds.lo.0",
                                           "bounds.hi.2"};
        for (size_t k = 0; k < sizeof same / sizeof *same; k++)
            assert_true(json_number(before, same[k]) == json_number(after, same[k]));
        if (files[i].vertices > 0) {
            assert_true(json_number(before, "counts.vertices") == files[i].vertices);
            assert_true(json_number(before, "counts.faces") == files[i].faces);
        }
        free(before);
        free(after);
        run_folder_destroy(folder);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formats),
        cmocka_unit_test(test_all_pairs),
        cmocka_unit_test(test_units_and_axes),
        cmocka_unit_test(test_assumed),
        cmocka_unit_test(test_known_and_unknown),
        cmocka_unit_test(test_formats_with_a_frame_of_their_own),
        cmocka_unit_test(test_nothing_is_touched),
        cmocka_unit_test(test_losses_are_told),
        cmocka_unit_test(test_streams),
        cmocka_unit_test(test_refused_before_any_work),
        cmocka_unit_test(test_bad_inputs),
        cmocka_unit_test(test_bad_outputs),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_real_files),
    };
    return cmocka_run_group_tests_name("convert", tests, NULL, NULL);
}
