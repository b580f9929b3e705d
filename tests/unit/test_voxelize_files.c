/* Meshes and scenes to volume files and back: OpenVDB reads them as level sets with the distances that they should
 * have, and what they are meshed to lies within a cell of what they were made of. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hewn/hewn.h"
#include "test_data.h"
#include "vdb_look.h"

static char folder[64];

static const char *in_folder(const char *name)
{
    static char paths[4][256];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void write_text(const char *name, const char *text)
{
    FILE *file = fopen(in_folder(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static hewn_voxelize_report voxelize(const char *input, const char *output, double cell, bool dense)
{
    hewn_voxelize_report report;
    hewn_error error = {0};
    const hewn_voxelize_job_desc desc = {
        .scene.path = input, .output = output, .cell = cell, .dense = dense, .unit = hewn_unit_find("mm")};
    if (hewn_voxelize_file(&desc, &report, &error) != HEWN_OK)
        fail_msg("%s: %s", input, error.message);
    return report;
}

/* --- a ball ---------------------------------------------------------------------------------------------------------
 */

static const char ball[] = "units(\"mm\")\nreturn sphere(1.3):move(0.2, -0.1, 0.4)\n";

static double to_ball(const double at[3])
{
    return sqrt((at[0] - 0.2) * (at[0] - 0.2) + (at[1] + 0.1) * (at[1] + 0.1) + (at[2] - 0.4) * (at[2] - 0.4)) - 1.3;
}

static void check_ball(const char *path, const hewn_voxelize_report *report, bool dense)
{
    enum { COUNT = 3000 };
    static int32_t at[3 * COUNT];
    static float values[COUNT];
    vdb_facts facts;
    assert_true(vdb_look(path, &facts));
    assert_true(facts.grids == 1 && facts.floats && facts.level_set);
    assert_string_equal(facts.name, "surface");
    assert_string_equal(facts.unit, "mm");
    assert_true(fabs(facts.voxel - 0.05) < 1e-12);
    if (!dense)
        assert_string_equal(facts.complaint, "");
    assert_true(fabs(facts.background - 0.15) < 1e-7 || dense);
    assert_int_equal(facts.active, report->written.active);
    uint32_t seed = 7;
    for (int n = 0; n < 3 * COUNT; n++) {
        seed = seed * 1664525u + 1013904223u;
        at[n] = (int32_t)((seed >> 8) % (report->written.dims[n % 3] - 1));
    }
    assert_true(vdb_values(path, at, COUNT, values));
    for (int n = 0; n < COUNT; n++) {
        double world[3], expected;
        for (int i = 0; i < 3; i++)
            world[i] = facts.origin[i] + facts.voxel * at[3 * n + i];
        expected = to_ball(world);
        if (!dense)
            expected = fmax(fmin(expected, 0.15), -0.15);
        if (!(fabs((double)values[n] - expected) < 1e-5))
            fail_msg("(%g, %g, %g): %g instead of %g", world[0], world[1], world[2], (double)values[n], expected);
    }
}

static void fields_are_level_sets(void **state)
{
    (void)state;
    write_text("ball.lua", ball);
    for (int dense = 0; dense < 2; dense++) {
        hewn_voxelize_report report = voxelize(in_folder("ball.lua"), in_folder("ball.vdb"), 0.05, dense != 0);
        check_ball(in_folder("ball.vdb"), &report, dense != 0);
    }
}

/* --- back to meshes -------------------------------------------------------------------------------------------------
 */

/* Meshes the volume, which says itself that it is a level set, and returns how far the two surfaces are apart. */
static double back_again(const char *mesh, const char *volume, hewn_volume_report *report)
{
    hewn_error error = {0};
    const char *made = in_folder("back.ply");
    const hewn_volume_job_desc desc = {.input = volume, .output = made};
    if (hewn_volume_convert(&desc, report, &error) != HEWN_OK)
        fail_msg("%s: %s", volume, error.message);
    assert_true(report->extraction.below && report->iso_value == 0);
    hewn_model one, two;
    assert_int_equal(hewn_model_read(mesh, NULL, &one, &error), HEWN_OK);
    assert_int_equal(hewn_model_read(made, NULL, &two, &error), HEWN_OK);
    hewn_polygons a = hewn_model_polygons(&one), b = hewn_model_polygons(&two);
    hewn_distance distance;
    if (hewn_polygons_distance(&a, &b, NULL, &distance, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    hewn_model_destroy(&one);
    hewn_model_destroy(&two);
    return distance.high;
}

static void meshes_come_back(void **state)
{
    (void)state;
    char mesh[8192];
    if (!data_file(mesh, "mesh-scan/elephant.off")) {
        print_message("# no data in %s\n", mesh);
        skip();
    }
    hewn_model model;
    hewn_error error = {0};
    assert_int_equal(hewn_model_read(mesh, NULL, &model, &error), HEWN_OK);
    double lo = INFINITY, hi = -INFINITY;
    for (uint64_t i = 0; i < model.vertex_count; i++) {
        lo = fmin(lo, model.positions[3 * i]);
        hi = fmax(hi, model.positions[3 * i]);
    }
    hewn_model_destroy(&model);
    double cell = (hi - lo) / 100;
    static const char *const outputs[] = {"scan.vdb", "scan.nrrd"};
    for (int i = 0; i < 2; i++) {
        hewn_voxelize_report made = voxelize(mesh, in_folder(outputs[i]), cell, false);
        hewn_volume_report report;
        double apart = back_again(mesh, in_folder(outputs[i]), &report);
        assert_true(made.is_mesh && made.mesh.confidence > 0.99);
        assert_true(report.certificate.closed && report.certificate.manifold && report.certificate.oriented);
        if (!(apart < cell))
            fail_msg("%s: %g is more than the cell %g", outputs[i], apart, cell);
        hewn_volume_report_destroy(&report);
    }
}

/* --- what is refused ------------------------------------------------------------------------------------------------
 */

static void expect(const hewn_voxelize_job_desc *desc, hewn_result code, const char *message)
{
    hewn_voxelize_report report;
    hewn_error error = {0};
    hewn_result result = hewn_voxelize_file(desc, &report, &error);
    if (result != code || !strstr(error.message, message))
        fail_msg("%s: %s, expected '%s'", hewn_result_name(result), error.message, message);
    assert_int_equal(access(desc->output, F_OK), -1);
}

static void bad_jobs_are_refused(void **state)
{
    (void)state;
    write_text("ball.lua", ball);
    write_text("endless.lua", "return x + 1");
    write_text("nothing.stl", "solid x\nendsolid x\n");
    const char *out = strdup(in_folder("none.vdb")), *odd = strdup(in_folder("none.png"));
    const char *scene = strdup(in_folder("ball.lua"));
    expect(&(hewn_voxelize_job_desc){.scene.path = scene, .output = odd}, HEWN_INVALID_ARGUMENT, ".vdb or .nrrd");
    expect(&(hewn_voxelize_job_desc){.scene.path = scene, .output = out, .cell = -1}, HEWN_INVALID_ARGUMENT, "cell");
    expect(&(hewn_voxelize_job_desc){.scene.path = scene, .output = out, .cell = 1e-3, .memory_limit = 1 << 20},
           HEWN_LIMIT, "would do");
    expect(&(hewn_voxelize_job_desc){.scene.path = in_folder("endless.lua"), .output = out}, HEWN_BAD_INPUT, "box");
    expect(&(hewn_voxelize_job_desc){.scene.path = in_folder("nothing.stl"), .output = out}, HEWN_BAD_INPUT,
           "no faces");
    free((char *)out);
    free((char *)odd);
    free((char *)scene);
}

/* --- heights in scenes ----------------------------------------------------------------------------------------------
 */

/* 3 x 2 values of 16 bits: 0, 65535, 0 above 0, 0, 65535. */
static void heightmaps_and_meshes_are_fields(void **state)
{
    (void)state;
    const unsigned char raw[12] = {0, 0, 0xff, 0xff, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
    FILE *file = fopen(in_folder("h.raw"), "wb");
    assert_int_equal(fwrite(raw, 1, sizeof raw, file), sizeof raw);
    assert_int_equal(fclose(file), 0);
    write_text("land.lua", "return heightmap('h.raw', {size = {4, 2}, height = 0.5, dims = {3, 2}})");
    const hewn_scene_desc desc = {.path = in_folder("land.lua"), .reader = hewn_scene_reader_standard()};
    hewn_scene *scene;
    hewn_error error = {0};
    if (hewn_scene_load(&desc, &scene, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    const hewn_field *field = hewn_scene_field(scene);
    const double at[4][3] = {{0, 1, 0.5}, {2, -1, 0.5}, {-2, 1, 0}, {0, 0, 0.25}};
    double values[4];
    assert_int_equal(hewn_field_eval(field, hewn_field_root(field), at[0], 4, values, &error), HEWN_OK);
    for (int i = 0; i < 4; i++)
        assert_true(fabs(values[i]) < 1e-6);
    assert_int_equal(hewn_scene_sampled_count(scene), 1);
    assert_int_equal(hewn_scene_file_count(scene), 2);
    hewn_scene_destroy(&scene);
    static const struct {
        const char *text, *message;
    } bad[] = {
        {"return heightmap('h.raw', {size = 1})", "give dims"},
        {"return heightmap('h.raw', {size = 1, dims = {30, 2}})", "h.raw"},
        {"return heightmap('h.raw', {dims = {3, 2}})", "needs a size"},
        {"return heightmap('h.raw', {size = -1, dims = {3, 2}})", "above 0"},
        {"return heightmap('h.raw', {size = 1, dims = {3, 2}, type = 'word'})", "no type 'word'"},
        {"return heightmap('h.raw', {size = 1, dims = {3, 2}, endian = 'odd'})", "endian"},
        {"return heightmap('h.raw', {size = 1, dimensions = 3})", "no option 'dimensions'"},
        {"return heightmap('none.png', {size = 1})", "cannot find"},
        {"return heightmap('land.lua', {size = 1})", "none of them"},
        {"return heightmap('h.png', {size = 1})", "not a PNG"},
        {"return heightmap('/etc/passwd', {size = 1})", "absolute path"},
        {"return mesh_field('h.raw')", "h.raw"},
        {"return mesh_field('../../../../etc/hosts')", "outside the scene's folder"},
        {"return mesh_field('tri.obj', {cell = 0})", "above 0"},
        {"return mesh_field('tri.obj', {cell = 1e-9})", "cell"},
        {"return mesh_field()", "argument"},
    };
    write_text("h.png", "no picture");
    write_text("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        write_text("bad.lua", bad[i].text);
        const hewn_scene_desc job = {.path = in_folder("bad.lua"), .reader = hewn_scene_reader_standard()};
        hewn_result result = hewn_scene_load(&job, &scene, &error);
        if (result != HEWN_BAD_INPUT || !strstr(error.message, bad[i].message))
            fail_msg("%s: %s: %s", bad[i].text, hewn_result_name(result), error.message);
        assert_int_equal(error.line, 1);
    }
    const hewn_scene_desc without = {.path = in_folder("land.lua")};
    assert_int_equal(hewn_scene_load(&without, &scene, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "reads no such files"));
}

/* The same file asked for twice is read once, and the thread's time is not the script's. */
static void files_are_sampled_once(void **state)
{
    (void)state;
    write_text("box.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                          "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    write_text("two.lua",
               "local a = mesh_field('box.obj', {cell = 0.1})\nlocal b = mesh_field('box.obj', {cell = 0.1})\n"
               "local c = mesh_field('box.obj', {cell = 0.2})\nreturn a | b:move(3, 0, 0) | c:move(0, 3, 0)");
    const hewn_scene_desc desc = {.path = in_folder("two.lua"), .reader = hewn_scene_reader_standard()};
    hewn_scene *scene;
    hewn_error error = {0};
    if (hewn_scene_load(&desc, &scene, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    assert_int_equal(hewn_scene_sampled_count(scene), 2);
    const hewn_scene_sampled *told = hewn_scene_sampled_at(scene, 0);
    assert_true(told->is_mesh && told->confidence > 0.999 && told->cell == 0.1);
    const hewn_field *field = hewn_scene_field(scene);
    const double at[3][3] = {{0.5, 0.5, 0.5}, {3.5, 0.5, 0.5}, {0.5, 3.5, 0.5}};
    double values[3];
    assert_int_equal(hewn_field_eval(field, hewn_field_root(field), at[0], 3, values, &error), HEWN_OK);
    for (int i = 0; i < 3; i++)
        assert_true(values[i] < -0.3 && values[i] > -0.51);
    hewn_box box;
    assert_int_equal(hewn_field_find_box(field, hewn_field_root(field), &box, &error), HEWN_OK);
    assert_true(box.lo[0] <= 0 && box.hi[0] >= 4 && box.hi[0] < 5.5);
    hewn_scene_destroy(&scene);
}

static int make_folder(void **state)
{
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/hewn-voxelize-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fields_are_level_sets),  cmocka_unit_test(meshes_come_back),
        cmocka_unit_test(bad_jobs_are_refused),   cmocka_unit_test(heightmaps_and_meshes_are_fields),
        cmocka_unit_test(files_are_sampled_once),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
