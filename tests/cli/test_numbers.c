/* A scene meshed again with another number: nothing is compiled, and the mesh is what a fresh start makes. */
#include <ftw.h>
#include <signal.h>

#include "json_read.h"
#include "run.h"

static int files_seen; /* nftw() hands nothing of its caller's on */

static int see_file(const char *path, const struct stat *status, int kind, struct FTW *place)
{
    (void)path, (void)status, (void)place;
    files_seen += kind == FTW_F;
    return 0;
}

/* The caches of Hewn and of the driver: SPIR-V, pipelines, and on Mesa machine code. */
static int count_cached(const char *folder)
{
    files_seen = 0;
    assert_int_equal(nftw(folder, see_file, 16, FTW_PHYS), 0);
    assert_true(files_seen > 0);
    return files_seen;
}

static void write_scene(const char *folder, double radius, double shift)
{
    char text[512];
    snprintf(text, sizeof text,
             "bounds(-1.5, -1.5, -1.5, 1.5, 1.5, 1.5)\n"
             "return smooth_union(sphere(%g), torus(0.8, 0.2):move(%g, 0.1, 0), 0.2) & ~box(0.5, 0.6, 0.7)\n",
             radius, shift);
    run_write_file(run_path(folder, "s.lua"), text);
}

static double stage_seconds(const char *report, const char *name)
{
    for (size_t i = 0; i < json_count(report, "stages"); i++) {
        char path[64];
        snprintf(path, sizeof path, "stages.%zu.name", i);
        if (strcmp(json_string(report, path), name) != 0)
            continue;
        snprintf(path, sizeof path, "stages.%zu.seconds", i);
        return json_number(report, path);
    }
    fail_msg("no stage %s in %s", name, report);
    return 0;
}

/* Meshes s.lua afresh into FOLDER/fresh/s.ply (a file may hold its own name). */
static void mesh_afresh(const char *folder, const char *cache)
{
    run_desc desc = {
        .arguments = {"mesh", "s.lua", "-o", "fresh/s.ply", "--res", "64", "-q"}, .folder = folder, .changes = {cache}};
    run_result result = run_expecting(0, &desc);
    run_result_destroy(&result);
}

static void test_watch_compiles_once(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    char cache[600];
    snprintf(cache, sizeof cache, "XDG_CACHE_HOME=%s/cache", folder);
    run_subfolder(folder, "fresh");
    write_scene(folder, 0.7, 0.3);
    run_desc desc = {.arguments = {"mesh", "s.lua", "-o", "s.ply", "--res", "64", "--watch", "--report", "r.json"},
                     .folder = folder,
                     .terminal = true,
                     .changes = {"TERM=dumb", cache}};
    run_process process = run_start(&desc);
    run_await(&process, "watching s.lua");
    int cached = count_cached(run_path(folder, "cache"));
    char *first = run_read_file(run_path(folder, "r.json"), NULL);
    for (int i = 1; i <= 3; i++) {
        write_scene(folder, 0.7 + 0.05 * i, 0.3 - 0.1 * i);
        run_await(&process, "watching s.lua");
        assert_int_equal(count_cached(run_path(folder, "cache")), cached);
        char *report = run_read_file(run_path(folder, "r.json"), NULL);
        assert_true(json_number(report, "certificate.volume") != json_number(first, "certificate.volume"));
        /* compiling takes a tenth of a second from full caches already, new numbers a hundredth of that */
        assert_true(stage_seconds(report, "compile") < 0.5 * stage_seconds(first, "compile"));
        free(report);
        mesh_afresh(folder, cache);
        run_assert_same_file(run_path(folder, "s.ply"), run_path(folder, "fresh/s.ply"));
    }
    kill(process.id, SIGINT);
    run_result result = run_finish(&process);
    assert_int_equal(result.code, 130);
    run_result_destroy(&result);
    free(first);
    run_folder_destroy(folder);
}

/* A new process takes everything from the caches. */
static void test_next_run_compiles_nothing(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    char cache[600];
    snprintf(cache, sizeof cache, "XDG_CACHE_HOME=%s/cache", folder);
    run_subfolder(folder, "fresh");
    write_scene(folder, 0.7, 0.3);
    mesh_afresh(folder, cache);
    int cached = count_cached(run_path(folder, "cache"));
    write_scene(folder, 0.9, -0.2);
    mesh_afresh(folder, cache);
    assert_int_equal(count_cached(run_path(folder, "cache")), cached);
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_watch_compiles_once),
        cmocka_unit_test(test_next_run_compiles_nothing),
    };
    return cmocka_run_group_tests_name("numbers", tests, NULL, NULL);
}
