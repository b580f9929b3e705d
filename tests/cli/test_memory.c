/* `hewn mesh --max-memory`: the same file and report as without it, in every format and by every method; what it
 * refuses; and that nothing is left on disk when it fails. */
#include "json_read.h"
#include "run.h"

/* What meshing adds to a command without a limit; the last two may be NULL. */
typedef struct wanted {
    const char *scene, *method, *format, *resolution, *more, *even_more;
} wanted;

/* Meshes into a folder of its own, since files carry their names, and returns the report; the caller frees it. */
static char *mesh(const char *folder, const wanted *what, const char *name, const char *limit)
{
    char output[64], report[64];
    run_subfolder(folder, name);
    snprintf(output, sizeof output, "%s/mesh.%s", name, what->format);
    snprintf(report, sizeof report, "%s/report.json", name);
    run_desc desc = {.arguments = {"mesh", run_project_file(what->scene), "-o", output, "--res", what->resolution,
                                   "--method", what->method, "--report", report, "-q"},
                     .folder = folder};
    int at = 11;
    if (what->more)
        desc.arguments[at++] = what->more;
    if (what->even_more)
        desc.arguments[at++] = what->even_more;
    if (limit) {
        desc.arguments[at++] = "--max-memory";
        desc.arguments[at++] = limit;
    }
    run_result result = run_expecting(0, &desc);
    run_result_destroy(&result);
    assert_int_equal(run_folder_count(run_path(folder, name)), 2); /* the mesh and the report */
    return run_read_file(run_path(folder, report), NULL);
}

static const char *const kept[] = {
    "bricks_active",           "cells_visited",           "cap_vertices",           "suspect_cells",
    "undefined_cells",         "counts.vertices",         "counts.faces",           "certificate.area",
    "certificate.volume",      "certificate.genus",       "certificate.components", "certificate.max_residual",
    "certificate.bounds.lo.0", "certificate.bounds.hi.2",
};

static void compare(const wanted *what, const char *limit, double bytes, double least_parts)
{
    char *folder = run_folder_create(), one[64], other[64];
    char *whole = mesh(folder, what, "whole", NULL), *parts = mesh(folder, what, "parts", limit);
    snprintf(one, sizeof one, "whole/mesh.%s", what->format);
    snprintf(other, sizeof other, "parts/mesh.%s", what->format);
    run_assert_same_file(run_path(folder, one), run_path(folder, other));
    for (size_t i = 0; i < sizeof kept / sizeof *kept; i++)
        if (json_number(whole, kept[i]) != json_number(parts, kept[i]))
            fail_msg("%s is %g and not %g", kept[i], json_number(parts, kept[i]), json_number(whole, kept[i]));
    assert_true(json_number(parts, "max_memory") == bytes);
    assert_true(json_number(parts, "peak.counted_bytes") <= bytes);
    assert_true(json_number(parts, "parts") >= least_parts);
    free(whole);
    free(parts);
    run_folder_destroy(folder);
}

static void test_every_format(void **state)
{
    (void)state;
    static const char *const formats[] = {"glb", "obj", "ply", "stl", "off", "3mf"};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        const wanted csg = {"assets/scenes/csg.lua", i % 2 ? "mc33" : "dc", formats[i], "80", NULL, NULL};
        compare(&csg, "900K", 900 * 1024, 4);
    }
}

static void test_every_method(void **state)
{
    (void)state;
    static const char *const methods[] = {"mc", "mc33", "nets", "dc"};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        const wanted sponge = {"assets/scenes/menger.lua", methods[i], "ply", "54", NULL, NULL};
        compare(&sponge, "3M", 3 * 1024 * 1024, 3);
        const wanted open = {"assets/scenes/gyroid.lua", methods[i], "obj", "40", "--open", NULL};
        compare(&open, "4194304", 4194304, 1);
    }
    const wanted quads = {"assets/scenes/bracket.lua", "nets", "off", "64", "--quads", NULL};
    compare(&quads, "1G", 1024 * 1024 * 1024, 1);
    const wanted few = {"assets/scenes/bracket.lua", "dc", "obj", "64", "--quads", NULL};
    compare(&few, "1000K", 1000 * 1024, 4);
}

static void test_lists(void **state)
{
    (void)state;
    const wanted many = {"assets/scenes/random.lua", "dc", "stl", "64", "-D", "n=200"};
    compare(&many, "1500K", 1500 * 1024, 3);
}

static void test_standard_output(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_desc desc = {
        .arguments = {"mesh", run_project_file("assets/scenes/csg.lua"), "-o", "-", "--to", "ply", "--res", "48", "-q"},
        .folder = folder,
        .output = run_path(folder, "whole.ply")};
    run_result result = run_expecting(0, &desc);
    run_result_destroy(&result);
    desc.arguments[9] = "--max-memory";
    desc.arguments[10] = "800K";
    desc.output = run_path(folder, "parts.ply");
    result = run_expecting(0, &desc);
    run_result_destroy(&result);
    run_assert_same_file(run_path(folder, "whole.ply"), run_path(folder, "parts.ply"));
    run_folder_destroy(folder);
}

static double stage_time(const char *report, const char *name, const char *which)
{
    char path[64];
    for (size_t i = 0; i < json_count(report, "stages"); i++) {
        snprintf(path, sizeof path, "stages.%zu.name", i);
        if (strcmp(json_string(report, path), name) != 0)
            continue;
        snprintf(path, sizeof path, "stages.%zu.%s", i, which);
        return json_number(report, path);
    }
    fail_msg("there is no stage %s", name);
    return 0;
}

/* The first part is certified and stored before the last one is made. */
static void test_stages_overlap(void **state)
{
    (void)state;
    static const char *const beside[] = {"certify", "store"};
    char *folder = run_folder_create();
    const wanted csg = {"assets/scenes/csg.lua", "mc", "ply", "128", NULL, NULL};
    char *report = mesh(folder, &csg, "parts", "2M");
    assert_true(json_number(report, "parts") > 3);
    for (size_t i = 0; i < sizeof beside / sizeof *beside; i++) {
        double begin = stage_time(report, beside[i], "begin"), end = stage_time(report, beside[i], "end");
        assert_true(begin < end && begin > stage_time(report, "extract", "begin"));
        assert_true(begin < stage_time(report, "extract", "end"));
        assert_true(end <= stage_time(report, "write", "begin"));
    }
    free(report);
    run_folder_destroy(folder);
}

/* --- failures ----------------------------------------------------------------------------------------------------- */

static void refuse(int code, const char *says, run_desc desc)
{
    char *folder = run_folder_create();
    desc.folder = folder;
    run_result result = run_expecting(code, &desc);
    if (!strstr(result.err, says))
        fail_msg("'%s' is missing in: %s", says, result.err);
    run_result_destroy(&result);
    assert_int_equal(run_folder_count(folder), 0);
    run_folder_destroy(folder);
}

#define MESH "mesh", run_project_file("assets/scenes/csg.lua"), "-o", "x.ply", "--res", "96"

static void test_sizes_that_make_no_sense(void **state)
{
    (void)state;
    static const char *const sizes[] = {
        "", "M", "-5", "0", "0K", "1.5G", "12Q", "12MB", "99999999999999999999", "17179869184G"};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        refuse(2, "--max-memory", (run_desc){.arguments = {MESH, "--max-memory", sizes[i]}});
}

static void test_refusals(void **state)
{
    (void)state;
    refuse(2, "memory", (run_desc){.arguments = {MESH, "--max-memory", "1G", "--adaptive", "0.01"}});
    refuse(2, "memory", (run_desc){.arguments = {MESH, "--max-memory", "1G", "--simplify", "faces:1000"}});
    refuse(5, "more than the 20480 that are allowed", (run_desc){.arguments = {MESH, "--max-memory", "20K"}});
    /* The spool of parts and the file both have to fit. */
    refuse(1, "temporary file", (run_desc){.arguments = {MESH, "--max-memory", "2M"}, .file_limit = 100000});
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_format),   cmocka_unit_test(test_every_method),
        cmocka_unit_test(test_lists),          cmocka_unit_test(test_standard_output),
        cmocka_unit_test(test_stages_overlap), cmocka_unit_test(test_sizes_that_make_no_sense),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests_name("memory", tests, NULL, NULL);
}
