/* What another reader makes of our files: assimp reads the finely meshed scenes and writes what it understood, and that
 * has to be the same closed surface still. */
#include <math.h>

#include "json_read.h"
#include "run.h"

/* The certificate of a mesh file by our own reader; the caller frees it. */
static char *examine(const char *folder, const char *name)
{
    run_result result = run_expecting(0, &(run_desc){.arguments = {"info", name, "--json"}, .folder = folder});
    char *report = result.out;
    free(result.err);
    assert_true(json_is_valid(report));
    return report;
}

static void assert_same_number(const char *a, const char *b, const char *path, double share, const char *what)
{
    double before = json_number(a, path), after = json_number(b, path);
    if (!(fabs(before - after) <= share * fabs(before)))
        fail_msg("%s: %s is %.17g instead of %.17g", what, path, after, before);
}

/* `after` describes the same surface as `before`: the same numbers of vertices and faces, pieces and handles. */
static void assert_same_surface(const char *before, const char *after, const char *what)
{
    static const char *const proofs[] = {"certificate.closed", "certificate.manifold", "certificate.oriented"};
    static const char *const counts[] = {"counts.vertices", "counts.faces", "certificate.components",
                                         "certificate.genus"};
    for (int i = 0; i < 3; i++)
        if (!json_bool(after, proofs[i]))
            fail_msg("%s: not %s", what, proofs[i]);
    for (int i = 0; i < 4; i++)
        assert_same_number(before, after, counts[i], 0, what);
    assert_same_number(before, after, "certificate.volume", 1e-6, what);
}

/* Through one format there and back. assimp keeps the vertices of PLY and GLB; STL has none, so our reader welds equal
 * positions of what assimp wrote, and vertices that had fallen together would be missing then. */
static void check_format(const char *folder, const char *scene, const char *extension)
{
    bool stl = strcmp(extension, "stl") == 0;
    const char *back = stl ? "back.stl" : "back.ply";
    char name[32], what[1100];
    snprintf(name, sizeof name, "mesh.%s", extension);
    snprintf(what, sizeof what, "%s as %s", scene, extension);
    run_result result =
        run_expecting(0, &(run_desc){.arguments = {"mesh", scene, "-o", name, "--res", "256", "--report", "-", "-q"},
                                     .folder = folder});
    char *own = examine(folder, name);
    assert_same_surface(result.out, own, what);
    run_desc export = {
        .program = "assimp", .arguments = {"export", name, back, stl ? "-fstlb" : "-fplyb"}, .folder = folder};
    run_result exported = run(&export);
    if (exported.code != 0)
        fail_msg("%s: assimp gave %d: %s%s", what, exported.code, exported.out, exported.err);
    char *theirs = examine(folder, back);
    assert_same_surface(result.out, theirs, what);
    run_result_destroy(&exported);
    run_result_destroy(&result);
    free(own);
    free(theirs);
}

static bool is_long(void)
{
    const char *value = getenv("HEWN_LONG");
    return value && *value && strcmp(value, "0") != 0;
}

static void skip_unless_long(void)
{
    if (!is_long()) {
        print_message("# many triangles: only with HEWN_LONG set\n");
        skip();
    }
}

static void check_scene(const char *path)
{
    char *scene = strdup(path); /* the buffers of run_path() are few */
    char *folder = run_folder_create();
    check_format(folder, scene, "ply");
    check_format(folder, scene, "glb");
    if (is_long() || strstr(scene, "csg"))
        check_format(folder, scene, "stl");
    run_folder_destroy(folder);
    free(scene);
}

static void test_csg(void **state)
{
    (void)state;
    run_need_program("assimp");
    check_scene(run_project_file("assets/scenes/csg.lua"));
}

static void test_menger(void **state)
{
    (void)state;
    run_need_program("assimp");
    skip_unless_long();
    check_scene(run_project_file("assets/scenes/menger.lua"));
}

static void test_gyroid(void **state)
{
    (void)state;
    run_need_program("assimp");
    check_scene(run_project_file("assets/scenes/gyroid.lua"));
}

static void test_colonnade(void **state)
{
    (void)state;
    run_need_program("assimp");
    skip_unless_long();
    check_scene(run_data_file("implicit/colonnade.vm"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_csg),
        cmocka_unit_test(test_menger),
        cmocka_unit_test(test_gyroid),
        cmocka_unit_test(test_colonnade),
    };
    return cmocka_run_group_tests_name("assimp", tests, NULL, NULL);
}
