/* `hewn mesh` on what it is made for: reports, formats, the same bytes each time, and what the options do. */
#include <math.h>

#include "json_read.h"
#include "run.h"

static void assert_has(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("'%s' is missing in: %s", part, text);
}

static const char *csg(void)
{
    return run_project_file("assets/scenes/csg.lua");
}

/* Meshes and returns the report; the caller frees it. */
static char *mesh_report(const char *folder, run_desc desc)
{
    int at = 0;
    while (desc.arguments[at])
        at++;
    desc.arguments[at] = "--report";
    desc.arguments[at + 1] = "report.json";
    desc.folder = folder;
    run_result result = run_expecting(0, &desc);
    run_result_destroy(&result);
    char *report = run_read_file(run_path(folder, "report.json"), NULL);
    assert_true(json_is_valid(report));
    return report;
}

static void assert_proven(const char *report)
{
    assert_true(json_bool(report, "certificate.closed"));
    assert_true(json_bool(report, "certificate.manifold"));
    assert_true(json_bool(report, "certificate.oriented"));
    assert_true(json_number(report, "certificate.boundary_edges") == 0);
    assert_true(json_number(report, "certificate.volume") > 0);
}

/* --- the report -------------------------------------------------------------------------------------------------- */

static void test_report_has_all_names(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    char *report = mesh_report(folder, (run_desc){.arguments = {"mesh", csg(), "-o", "a.ply", "--res", "64"}});
    static const char *const names[] = {
        "version",
        "input",
        "files.0",
        "parameters",
        "units",
        "output",
        "format",
        "method",
        "open",
        "quads",
        "colors",
        "labels",
        "adaptive",
        "resolution",
        "threads",
        "device",
        "driver",
        "seconds",
        "stages",
        "bounds.lo.2",
        "bounds.hi.2",
        "bounds_from",
        "cell",
        "cells.2",
        "left_bounds",
        "cap_vertices",
        "cells_visited",
        "bricks_active",
        "suspect_cells",
        "first_suspect",
        "undefined_cells",
        "fans",
        "features.edge_vertices",
        "features.corner_vertices",
        "features.planes_found",
        "features.lost",
        "peak.host_bytes",
        "counts.faces",
        "certificate",
        "validation_messages",
        "peak.device_bytes",
        "counts.vertices",
    };
    static const char *const certificate[] = {"closed",
                                              "manifold",
                                              "oriented",
                                              "components",
                                              "genus",
                                              "volume",
                                              "area",
                                              "bounds.lo.0",
                                              "bounds.hi.2",
                                              "max_residual",
                                              "boundary_edges",
                                              "non_manifold_edges",
                                              "degenerate_faces",
                                              "non_manifold_vertices"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!json_find(report, names[i]))
            fail_msg("the report has no '%s'", names[i]);
    for (size_t i = 0; i < sizeof certificate / sizeof *certificate; i++)
        if (!json_find(json_find(report, "certificate"), certificate[i]))
            fail_msg("the certificate has no '%s'", certificate[i]);
    assert_proven(report);
    assert_true(json_number(report, "resolution") == 64);
    assert_true(json_number(report, "cells.0") == 64);
    assert_true(json_number(report, "peak.host_bytes") > 1e6);
    assert_true(json_number(report, "peak.device_bytes") > 1e4);
    assert_true(json_number(report, "cells_visited") > 0);
    assert_true(json_number(report, "bricks_active") > 0);
    double residual = json_number(report, "certificate.max_residual");
    assert_true(residual >= 0 && residual < 0.1); /* a vertex in a cell is off a curved surface by its sagitta */
    free(report);
    run_folder_destroy(folder);
}

/* The share of `wall` seconds that lies in at least one stage. */
static double stage_cover(const char *report, double wall)
{
    double covered = 0, reached = 0;
    size_t count = json_count(report, "stages");
    for (size_t round = 0; round < count; round++) { /* the stage that begins first among those that reach further */
        double begin = INFINITY, end = 0;
        for (size_t i = 0; i < count; i++) {
            char path[64];
            snprintf(path, sizeof path, "stages.%zu.begin", i);
            double from = json_number(report, path);
            snprintf(path, sizeof path, "stages.%zu.end", i);
            double to = json_number(report, path);
            if (to > reached && from < begin) {
                begin = from;
                end = to;
            }
        }
        if (begin < INFINITY)
            covered += end - fmax(begin, reached);
        reached = fmax(reached, end);
    }
    return covered / wall;
}

/* A machine under load may take its time to start a process, which no stage can know: the best of a few counts. */
static void test_stages_cover_the_wall_time(void **state)
{
    (void)state;
#ifdef __SANITIZE_ADDRESS__
    skip(); /* at the end of the process its leaks are looked for, which takes its time too */
#endif
    char *folder = run_folder_create();
    double best = 0;
    for (int attempt = 0; attempt < 5 && best < 0.9; attempt++) {
        run_desc desc = {.arguments = {"mesh", csg(), "-o", "a.ply", "--report", "r.json"}, .folder = folder};
        run_result result = run_expecting(0, &desc);
        char *report = run_read_file(run_path(folder, "r.json"), NULL);
        static const char *const names[] = {"startup", "load",     "compile",   "prepare", "cull", "evaluate",
                                            "extract", "suspects", "read_back", "certify", "write"};
        for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
            char quoted[32];
            snprintf(quoted, sizeof quoted, "\"name\": \"%s\"", names[i]);
            assert_has(report, quoted);
        }
        double cover = stage_cover(report, result.seconds);
        assert_true(cover <= 1.001);
        best = fmax(best, cover);
        free(report);
        run_result_destroy(&result);
    }
    if (best < 0.9)
        fail_msg("the stages cover %.3f of the wall time", best);
    run_folder_destroy(folder);
}

static void test_report_goes_to_standard_output(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_desc desc = {.arguments = {"mesh", csg(), "-o", "a.stl", "--res", "32", "--report", "-", "-q"},
                     .folder = folder};
    run_result result = run_expecting(0, &desc);
    assert_true(json_is_valid(result.out));
    assert_string_equal(json_string(result.out, "format"), "stl");
    assert_string_equal(result.err, "");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* The same surface in triangles and in quads, in each format that has them. */
static void test_quads(void **state)
{
    (void)state;
    static const char *const formats[] = {"a.ply", "a.obj", "a.off"}, *const methods[] = {"nets", "dc"};
    char *folder = run_folder_create();
    for (int i = 0; i < 6; i++) {
        run_desc desc = {.arguments = {"mesh", csg(), "-o", formats[i / 2], "--res", "32", "--quads", "--method",
                                       methods[i % 2], "--report", "r.json", "-q"},
                         .folder = folder};
        run_result result = run_expecting(0, &desc);
        run_result_destroy(&result);
        char *report = run_read_file(run_path(folder, "r.json"), NULL);
        assert_proven(report);
        assert_true(json_bool(report, "quads"));
        assert_string_equal(json_string(report, "method"), methods[i % 2]);
        double faces = json_number(report, "counts.faces"), vertices = json_number(report, "counts.vertices");
        assert_true(faces == vertices - 2); /* a sphere of quads (Euler) */
        free(report);
        desc = (run_desc){.arguments = {"info", formats[i / 2], "--json"}, .folder = folder};
        result = run_expecting(0, &desc);
        assert_true(json_number(result.out, "counts.faces") == faces);
        assert_true(json_number(result.out, "counts.quads") == faces);
        run_result_destroy(&result);
    }
    run_folder_destroy(folder);
}

/* The summary goes to stderr; nothing is drawn there where it is no terminal. */
static void test_summary(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_desc desc = {.arguments = {"mesh", csg(), "-o", "a.glb", "--res", "32"}, .folder = folder};
    run_result result = run_expecting(0, &desc);
    assert_has(result.err, "a.glb: ");
    assert_has(result.err, "closed, manifold, oriented; 1 component, genus 0");
    assert_null(strpbrk(result.err, "\r\033"));
    assert_string_equal(result.out, "");
    assert_int_equal(run_folder_count(folder), 1);
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_progress_on_a_terminal(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_desc desc = {.arguments = {"mesh", csg(), "-o", "a.glb", "--res", "32"},
                     .folder = folder,
                     .changes = {"TERM=xterm"},
                     .terminal = true};
    run_result result = run(&desc);
    assert_int_equal(result.code, 0);
    assert_has(result.err, "\r\033[Kextract");
    char *last = strrchr(result.err, '\033');
    assert_non_null(last);
    assert_memory_equal(last, "\033[Ka.glb: ", strlen("\033[Ka.glb: ")); /* the line is gone at the end */
    run_result_destroy(&result);
    desc.arguments[6] = "--quiet";
    result = run(&desc);
    assert_int_equal(result.code, 0);
    assert_string_equal(result.err, "");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* --- bytes ------------------------------------------------------------------------------------------------------- */

/* Runs as often as there are changes of the environment, each but the first compared with the first. A file may hold
 * its own name, so they lie in two folders under the same one. */
static void expect_same_bytes(const char *const *changes, size_t count, const char *scene, const char *name)
{
    char *folder = run_folder_create();
    run_subfolder(folder, "first");
    run_subfolder(folder, "next");
    char output[2][64];
    snprintf(output[0], sizeof output[0], "first/%s", name);
    snprintf(output[1], sizeof output[1], "next/%s", name);
    for (size_t i = 0; i < count; i++) {
        run_desc desc = {.arguments = {"mesh", scene, "-o", output[i > 0], "--res", "48", "-q"},
                         .folder = folder,
                         .changes = {changes[i]}};
        run_result result = run_expecting(0, &desc);
        run_result_destroy(&result);
        if (i > 0)
            run_assert_same_file(run_path(folder, output[0]), run_path(folder, output[1]));
    }
    run_folder_destroy(folder);
}

static void test_same_bytes_each_time(void **state)
{
    (void)state;
    static const char *const changes[] = {"LP_NUM_THREADS", "LP_NUM_THREADS",   "LP_NUM_THREADS",  "LP_NUM_THREADS",
                                          "LP_NUM_THREADS", "LP_NUM_THREADS=1", "LP_NUM_THREADS=2"};
    char *scene = strdup(run_project_file("assets/scenes/gyroid.lua"));
    expect_same_bytes(changes, 7, scene, "a.glb");
    expect_same_bytes(changes + 4, 3, scene, "a.obj");
    expect_same_bytes(changes + 4, 3, scene, "a.ply");
    expect_same_bytes(changes + 4, 3, scene, "a.stl");
    free(scene);
}

static void test_threads_do_not_change_the_mesh(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    static const char *const threads[] = {"1", "2", "5"};
    for (int i = 0; i < 3; i++) {
        const char *output = i == 0 ? "first/a.ply" : "next/a.ply";
        run_subfolder(folder, i == 0 ? "first" : "next");
        run_desc desc = {.arguments = {"mesh", csg(), "-o", output, "--threads", threads[i], "--res", "50"},
                         .folder = folder};
        run_result result = run_expecting(0, &desc);
        run_result_destroy(&result);
        if (i > 0)
            run_assert_same_file(run_path(folder, "first/a.ply"), run_path(folder, "next/a.ply"));
    }
    run_folder_destroy(folder);
}

/* --- formats ----------------------------------------------------------------------------------------------------- */

/* Meshes into `name` and reads it back with `hewn info`: the same shape, still proven. */
static void mesh_and_read(const char *folder, const char *name)
{
    char *report = mesh_report(folder, (run_desc){.arguments = {"mesh", csg(), "-o", name, "--res", "48"}});
    run_desc desc = {.arguments = {"info", name, "--json"}, .folder = folder};
    run_result result = run_expecting(0, &desc);
    assert_true(json_is_valid(result.out));
    assert_proven(result.out);
    assert_true(json_number(result.out, "counts.faces") == json_number(report, "counts.faces"));
    assert_true(json_number(result.out, "counts.vertices") == json_number(report, "counts.vertices"));
    assert_true(json_number(result.out, "certificate.genus") == json_number(report, "certificate.genus"));
    double before = json_number(report, "certificate.volume"), after = json_number(result.out, "certificate.volume");
    assert_true(fabs(before - after) < 1e-6 * before);
    run_result_destroy(&result);
    free(report);
}

static void test_formats_read_back(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    static const char *const names[] = {"csg.glb", "csg.obj", "csg.ply", "csg.stl", "csg.GLB"};
    for (int i = 0; i < 5; i++)
        mesh_and_read(folder, names[i]);
    run_folder_destroy(folder);
}

static void test_standard_output(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    static const char *const names[] = {"csg.obj", "csg.ply", "csg.stl"};
    for (int i = 0; i < 3; i++) {
        run_desc desc = {.arguments = {"mesh", csg(), "-o", names[i], "--res", "48"}, .folder = folder};
        run_result file = run_expecting(0, &desc);
        run_desc piped = {.arguments = {"mesh", csg(), "-o", "-", "--to", names[i] + 4, "--res", "48"}};
        run_result stream = run_expecting(0, &piped);
        size_t length;
        char *bytes = run_read_file(run_path(folder, names[i]), &length);
        assert_int_equal(length, stream.out_length);
        assert_memory_equal(bytes, stream.out, length);
        free(bytes);
        run_result_destroy(&file);
        run_result_destroy(&stream);
    }
    run_folder_destroy(folder);
}

static void test_piped_scene(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    const char *text = "# a sphere\n_0 var-x\n_1 var-y\n_2 var-z\n_3 square _0\n_4 square _1\n_5 square _2\n"
                       "_6 add _3 _4\n_7 add _5 _6\n_8 sqrt _7\n_9 const 0.7\n_a sub _8 _9\n";
    run_write_file(run_path(folder, "ball.vm"), text);
    run_desc desc = {.arguments = {"mesh", "ball.vm", "-o", "first/a.ply", "--res", "40"}, .folder = folder};
    run_subfolder(folder, "first");
    run_subfolder(folder, "next");
    run_result result = run_expecting(0, &desc);
    run_result_destroy(&result);
    desc = (run_desc){.arguments = {"mesh", "-", "--from", "vm", "-o", "next/a.ply", "--res", "40"},
                      .folder = folder,
                      .input = run_path(folder, "ball.vm")};
    result = run_expecting(0, &desc);
    run_result_destroy(&result);
    run_assert_same_file(run_path(folder, "first/a.ply"), run_path(folder, "next/a.ply"));
    run_folder_destroy(folder);
}

/* --- options ----------------------------------------------------------------------------------------------------- */

static void test_cap_and_open(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "return sphere(1)");
    run_desc desc = {.arguments = {"mesh", "s.lua", "-o", "s.ply", "--res", "40", "--bounds", "-2,-2,-2,0,2,2"},
                     .folder = folder};
    char *report = mesh_report(folder, desc);
    assert_proven(report);
    assert_true(json_bool(report, "left_bounds"));
    assert_true(json_number(report, "cap_vertices") > 0);
    assert_true(json_number(report, "certificate.bounds.hi.0") == 0);
    assert_string_equal(json_string(report, "bounds_from"), "given");
    double half = 2 * 3.14159265 / 3;
    assert_true(fabs(json_number(report, "certificate.volume") - half) < 0.03 * half);
    free(report);
    run_result result = run_expecting(0, &desc);
    assert_has(result.err, "note: the surface reaches the bounds");
    run_result_destroy(&result);
    desc.arguments[8] = "--open";
    report = mesh_report(folder, desc);
    assert_false(json_bool(report, "certificate.closed"));
    assert_true(json_bool(report, "certificate.manifold"));
    assert_true(json_bool(report, "certificate.oriented"));
    assert_true(json_number(report, "certificate.boundary_edges") > 0);
    assert_true(json_bool(report, "left_bounds"));
    free(report);
    run_folder_destroy(folder);
}

/* --- what a mesh may lack ---------------------------------------------------------------------------------------- */

static void check_warning(const char *folder, const char *option, const char *value, const char *remedy)
{
    run_desc desc = {.arguments = {"mesh", "thin.lua", "-o", "s.ply", option, value}, .folder = folder};
    run_result result = run_expecting(0, &desc);
    assert_has(result.err, "hewn: warning: ");
    assert_has(result.err, " cells away from the surface may hold features thinner than a cell");
    assert_has(result.err, "the first is at (");
    assert_has(result.err, remedy);
    run_result_destroy(&result);
    char *report = mesh_report(folder, desc);
    assert_true(json_number(report, "suspect_cells") > 100);
    assert_true(json_number(report, "undefined_cells") == 0);
    double lo = json_number(report, "first_suspect.lo.2"), hi = json_number(report, "first_suspect.hi.2");
    assert_true(lo < 0.31 && hi > 0.308 && fabs(hi - lo - json_number(report, "cell")) < 1e-9);
    assert_proven(report);
    free(report);
    desc.arguments[6] = "-q";
    result = run_expecting(0, &desc);
    assert_string_equal(result.err, "");
    run_result_destroy(&result);
}

static void test_thin_features_are_warned_of(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "thin.lua"), "bounds(-1, -1, -1, 1, 1, 1)\n"
                                                 "local plate = box(1, 1, 0.002):move(0.3, 0.3, 0.309)\n"
                                                 "return sphere(0.4):move(-0.5, -0.5, -0.5) | plate");
    check_warning(folder, "--res", "32", "--res 64 may show them");
    check_warning(folder, "--cell", "0.0625", "--cell 0.03125 may show them");
    run_desc desc = {.arguments = {"mesh", "thin.lua", "-o", "s.ply", "--cell", "0.03"}, .folder = folder};
    desc.arguments[1] = csg();
    char *report = mesh_report(folder, desc);
    assert_true(json_number(report, "suspect_cells") == 0);
    assert_true(json_is_null(report, "first_suspect"));
    free(report);
    run_result result = run_expecting(0, &desc);
    assert_null(strstr(result.err, "warning"));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_undefined_cells_are_noted(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "nan.lua"), "bounds(-1, -1, -1, 1, 1, 1)\nreturn max(sqrt(x + 0.5) - 0.9, "
                                                "abs(y) - 0.5, abs(z) - 0.5)");
    run_desc desc = {.arguments = {"mesh", "nan.lua", "-o", "s.ply", "--res", "32"}, .folder = folder};
    run_result result = run_expecting(0, &desc);
    assert_has(result.err, "hewn: note: in ");
    assert_has(result.err, "the field has no bounds");
    assert_null(strstr(result.err, "warning"));
    run_result_destroy(&result);
    char *report = mesh_report(folder, desc);
    assert_true(json_number(report, "suspect_cells") == 0);
    assert_true(json_number(report, "undefined_cells") > 500);
    free(report);
    run_folder_destroy(folder);
}

/* Bounds that are found from the field keep clear of the surface, at any resolution. */
static void test_found_bounds(void **state)
{
    (void)state;
    static const char *const grids[][2] = {{"--res", "3"}, {"--res", "7"}, {"--res", "64"}, {"--cell", "0.11"}};
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "return sphere(1):move(3, 4, 5)");
    for (int i = 0; i < 4; i++) {
        run_desc desc = {.arguments = {"mesh", "s.lua", "-o", "s.ply", grids[i][0], grids[i][1]}, .folder = folder};
        char *report = mesh_report(folder, desc);
        assert_string_equal(json_string(report, "bounds_from"), "field");
        assert_false(json_bool(report, "left_bounds"));
        assert_true(json_number(report, "cap_vertices") == 0);
        assert_true(json_number(report, "bounds.lo.0") < 2);
        assert_true(json_number(report, "bounds.hi.2") > 6);
        if (i == 3) {
            assert_true(fabs(json_number(report, "cell") - 0.11) < 1e-8);
            assert_true(json_is_null(report, "resolution"));
        }
        assert_proven(report);
        free(report);
    }
    run_folder_destroy(folder);
}

static void test_parameters(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    double volumes[2];
    for (int i = 0; i < 2; i++) {
        const char *scene = run_project_file("assets/scenes/menger.lua");
        run_desc desc = {.arguments = {"mesh", scene, "-o", "s.stl", "--res", "54", "-D", i ? "L=2" : "L=1"}};
        char *report = mesh_report(folder, desc);
        assert_true(json_number(report, "parameters.L") == i + 1);
        volumes[i] = json_number(report, "certificate.volume");
        free(report);
    }
    assert_true(fabs(volumes[0] / (8 * 20. / 27) - 1) < 0.02);
    assert_true(fabs(volumes[1] / (8 * 20. / 27 * 20 / 27) - 1) < 0.04);
    run_folder_destroy(folder);
}

static void test_validation_layer_is_silent(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_desc desc = {.arguments = {"mesh", csg(), "-o", "a.ply", "--res", "64", "--report", "r.json"},
                     .folder = folder,
                     .changes = {"HEWN_VALIDATION=1"}};
    run_result result = run(&desc);
    if (result.code == 4 && strstr(result.err, "is not installed"))
        skip();
    if (result.code != 0)
        fail_msg("%s", result.err);
    char *report = run_read_file(run_path(folder, "r.json"), NULL);
    assert_true(json_number(report, "validation_messages") == 0);
    free(report);
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_report_has_all_names),
        cmocka_unit_test(test_stages_cover_the_wall_time),
        cmocka_unit_test(test_report_goes_to_standard_output),
        cmocka_unit_test(test_quads),
        cmocka_unit_test(test_summary),
        cmocka_unit_test(test_progress_on_a_terminal),
        cmocka_unit_test(test_same_bytes_each_time),
        cmocka_unit_test(test_threads_do_not_change_the_mesh),
        cmocka_unit_test(test_formats_read_back),
        cmocka_unit_test(test_standard_output),
        cmocka_unit_test(test_piped_scene),
        cmocka_unit_test(test_cap_and_open),
        cmocka_unit_test(test_thin_features_are_warned_of),
        cmocka_unit_test(test_undefined_cells_are_noted),
        cmocka_unit_test(test_found_bounds),
        cmocka_unit_test(test_parameters),
        cmocka_unit_test(test_validation_layer_is_silent),
    };
    return cmocka_run_group_tests_name("mesh", tests, NULL, NULL);
}
