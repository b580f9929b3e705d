/* `hewn mesh --adaptive`: far fewer faces, still proven, the same bytes for any number of threads, and what `hewn
 * check` says of the file. What it refuses is in test_usage.c. */
#include <math.h>

#include "json_read.h"
#include "run.h"

/* Meshes a scene and returns the report; the caller frees it. */
static char *mesh(const char *folder, const char *scene, const char *output, const char *adaptive, const char *threads,
                  bool open)
{
    run_desc desc = {.arguments = {"mesh", run_project_file(scene), "-o", output, "--res", "48", "--threads", threads,
                                   "--report", "r.json", "-q"},
                     .folder = folder};
    int at = 11;
    if (adaptive) {
        desc.arguments[at++] = "--adaptive";
        desc.arguments[at++] = adaptive;
    }
    if (open) {
        desc.arguments[at++] = "--open";
        desc.arguments[at++] = "--bounds=-0.6,-0.5,-0.7,0.6,0.5,0.7";
    }
    run_result result = run_expecting(0, &desc);
    run_result_destroy(&result);
    return run_read_file(run_path(folder, "r.json"), NULL);
}

static void test_fewer_faces(void **state)
{
    (void)state;
    static const char *const scenes[] = {"assets/scenes/csg.lua", "assets/scenes/bracket.lua"};
    char *folder = run_folder_create();
    for (int i = 0; i < 2; i++) {
        char *uniform = mesh(folder, scenes[i], "a.ply", NULL, "1", false);
        double cell = json_number(uniform, "cell");
        char length[32];
        snprintf(length, sizeof length, "%g", cell / 8);
        char *merged = mesh(folder, scenes[i], "b.ply", length, "1", false);
        assert_true(json_number(merged, "adaptive") > 0);
        assert_true(json_bool(merged, "certificate.closed"));
        assert_true(json_bool(merged, "certificate.manifold"));
        assert_true(json_bool(merged, "certificate.oriented"));
        assert_true(json_number(merged, "certificate.genus") == json_number(uniform, "certificate.genus"));
        assert_true(json_number(merged, "certificate.components") == json_number(uniform, "certificate.components"));
        double volume = json_number(uniform, "certificate.volume"), area = json_number(uniform, "certificate.area");
        assert_true(fabs(json_number(merged, "certificate.volume") - volume) < 0.05 * area * cell);
        assert_true(5 * json_number(merged, "counts.faces") < json_number(uniform, "counts.faces"));
        free(uniform);
        free(merged);
        run_desc desc = {.arguments = {"check", "b.ply", "-q"}, .folder = folder};
        run_result result = run_expecting(0, &desc);
        run_result_destroy(&result);
    }
    run_folder_destroy(folder);
}

static void test_threads_and_runs_agree(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    size_t sizes[2];
    char *files[2];
    for (int i = 0; i < 2; i++) { /* the same name: the file says with what command it was made */
        free(mesh(folder, "assets/scenes/csg.lua", "a.stl", "0.005", i ? "3" : "1", false));
        files[i] = run_read_file(run_path(folder, "a.stl"), &sizes[i]);
    }
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(files[0], files[1], sizes[0]);
    free(files[0]);
    free(files[1]);
    run_folder_destroy(folder);
}

static void test_open(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    char *uniform = mesh(folder, "assets/scenes/csg.lua", "a.ply", NULL, "2", true);
    char *merged = mesh(folder, "assets/scenes/csg.lua", "b.ply", "0.01", "2", true);
    assert_true(json_bool(merged, "certificate.manifold"));
    assert_false(json_bool(merged, "certificate.closed"));
    assert_true(json_number(merged, "certificate.components") == json_number(uniform, "certificate.components"));
    assert_true(json_number(merged, "certificate.boundary_edges") >= 3);
    assert_true(json_number(merged, "certificate.boundary_edges") < json_number(uniform, "certificate.boundary_edges"));
    free(uniform);
    free(merged);
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fewer_faces),
        cmocka_unit_test(test_threads_and_runs_agree),
        cmocka_unit_test(test_open),
    };
    return cmocka_run_group_tests_name("adaptive", tests, NULL, NULL);
}
