/* The shipped scenes and the shared models, meshed and proven; and how fast the error of a sphere falls. */
#include <dirent.h>
#include <math.h>

#include "json_read.h"
#include "run.h"

/* Meshes `scene` into FOLDER/NAME with lavapipe on `threads` threads and returns the report, which the caller frees. */
static char *mesh_scene(const char *folder, const char *scene, const char *name, const char *resolution,
                        const char *threads)
{
    run_desc desc = {.arguments = {"mesh", scene, "-o", name, "--res", resolution, "--report", "report.json", "-q"},
                     .folder = folder,
                     .changes = {threads},
                     .timeout = 240};
    run_result result = run_expecting(0, &desc);
    run_result_destroy(&result);
    return run_read_file(run_path(folder, "report.json"), NULL);
}

/* The same by a method of that name. */
static char *mesh_scene_by(const char *method, const char *folder, const char *scene)
{
    run_desc desc = {.arguments = {"mesh", scene, "-o", "scene.glb", "--res", "64", "--method", method, "--report",
                                   "report.json", "-q"},
                     .folder = folder,
                     .timeout = 240};
    run_result result = run_expecting(0, &desc);
    run_result_destroy(&result);
    return run_read_file(run_path(folder, "report.json"), NULL);
}

static void assert_proven(const char *report, const char *scene)
{
    bool proven = json_bool(report, "certificate.closed") && json_bool(report, "certificate.manifold") &&
                  json_bool(report, "certificate.oriented");
    if (!proven)
        fail_msg("%s is not closed, manifold and oriented: %s", scene, report);
}

static void test_shipped_scenes(void **state)
{
    (void)state;
    char *scenes = strdup(run_project_file("assets/scenes")); /* the buffers of run_path() are few */
    char *folder = run_folder_create();
    DIR *listing = opendir(scenes);
    assert_non_null(listing);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(listing)) != NULL;) {
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || strcmp(dot, ".lua") != 0)
            continue;
        char *report = mesh_scene(folder, run_path(scenes, entry->d_name), "scene.glb", "64", "LP_NUM_THREADS");
        assert_proven(report, entry->d_name);
        assert_false(json_bool(report, "left_bounds"));
        bool specks = strcmp(entry->d_name, "random.lua") == 0; /* shapes smaller than a cell here, and lost ones */
        assert_true((json_number(report, "suspect_cells") > 0) == specks);
        assert_true(json_number(report, "undefined_cells") == 0);
        static const char *const others[] = {"mc", "mc33", "nets"};
        assert_string_equal(json_string(report, "method"), "dc");
        for (int i = 0; i < 3; i++) {
            free(report);
            report = mesh_scene_by(others[i], folder, run_path(scenes, entry->d_name));
            assert_proven(report, entry->d_name);
            assert_string_equal(json_string(report, "method"), others[i]);
        }
        free(report);
        count++;
    }
    closedir(listing);
    free(scenes);
    assert_true(count >= 4);
    run_folder_destroy(folder);
}

/* At 256 cells a side: proven, the same bytes on one and two threads (over five more runs in long tests), and still
 * proven for our own reader. */
static char *mesh_finely(const char *folder, const char *path)
{
    char *scene = strdup(path);     /* the buffers of run_path() are few */
    run_subfolder(folder, "first"); /* a file may hold its own name, so both have the same one */
    run_subfolder(folder, "next");
    char *report = mesh_scene(folder, scene, "first/mesh.ply", "256", "LP_NUM_THREADS=1");
    assert_proven(report, scene);
    const char *extended = getenv("HEWN_LONG");
    int runs = extended && *extended && strcmp(extended, "0") != 0 ? 6 : 1;
    for (int i = 0; i < runs; i++) {
        char *again = mesh_scene(folder, scene, "next/mesh.ply", "256", i == 0 ? "LP_NUM_THREADS=2" : "LP_NUM_THREADS");
        assert_true(json_number(again, "certificate.genus") == json_number(report, "certificate.genus"));
        free(again);
        run_assert_same_file(run_path(folder, "first/mesh.ply"), run_path(folder, "next/mesh.ply"));
    }
    run_result info = run_expecting(0, &(run_desc){.arguments = {"info", "next/mesh.ply", "--json"}, .folder = folder});
    assert_proven(info.out, scene);
    assert_true(json_number(info.out, "certificate.genus") == json_number(report, "certificate.genus"));
    run_result_destroy(&info);
    free(scene);
    return report;
}

static void test_csg_finely(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    free(mesh_finely(folder, run_project_file("assets/scenes/csg.lua")));
    run_folder_destroy(folder);
}

static void test_menger_finely(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    char *report = mesh_finely(folder, run_project_file("assets/scenes/menger.lua"));
    double exact = 8 * pow(20. / 27, 3);
    assert_true(fabs(json_number(report, "certificate.volume") / exact - 1) < 0.01);
    free(report);
    run_folder_destroy(folder);
}

static void test_gyroid_finely(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    free(mesh_finely(folder, run_project_file("assets/scenes/gyroid.lua")));
    run_folder_destroy(folder);
}

static void test_colonnade_finely(void **state)
{
    (void)state;
    const char *scene = run_data_file("implicit/colonnade.vm");
    char *folder = run_folder_create();
    free(mesh_finely(folder, scene));
    run_folder_destroy(folder);
}

static double sphere_volume(const char *folder, const char *resolution)
{
    run_desc desc = {.arguments = {"mesh", "s.lua", "-o", "s.stl", "--report", "-", "-q", "--bounds",
                                   "-1.3,-1.3,-1.3,1.3,1.3,1.3", "--res", resolution},
                     .folder = folder};
    run_result result = run_expecting(0, &desc);
    double volume = json_number(result.out, "certificate.volume");
    run_result_destroy(&result);
    return volume;
}

static void test_sphere_converges(void **state)
{
    (void)state;
    static const char *const resolutions[] = {"32", "64", "128", "256"};
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "return sphere(1)");
    double exact = 4 * acos(-1) / 3, before = 0;
    for (int i = 0; i < 4; i++) {
        double error = fabs(sphere_volume(folder, resolutions[i]) - exact);
        double ratio = before / error;
        if (i > 0 && !(ratio > 3.7 && ratio < 4.3))
            fail_msg("from half of %s cells the error falls by %g", resolutions[i], ratio);
        before = error;
    }
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shipped_scenes),   cmocka_unit_test(test_csg_finely),
        cmocka_unit_test(test_menger_finely),    cmocka_unit_test(test_gyroid_finely),
        cmocka_unit_test(test_colonnade_finely), cmocka_unit_test(test_sphere_converges),
    };
    return cmocka_run_group_tests_name("scenes", tests, NULL, NULL);
}
