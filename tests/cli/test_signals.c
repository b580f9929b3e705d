/* Ctrl-C and its like, and --watch, which only Ctrl-C ends. */
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "run.h"

static const char *menger(void)
{
    return run_project_file("assets/scenes/menger.lua");
}

static void assert_cancelled(run_process *process, const char *folder, int entries)
{
    run_result result = run_finish(process);
    if (result.code != 130)
        fail_msg("exit code %d (signal %d) instead of 130: %s", result.code, result.signal, result.err);
    if (!strstr(result.err, "hewn: cancelled"))
        fail_msg("not a word about it: %s", result.err);
    assert_int_equal(run_folder_count(folder), entries);
    run_result_destroy(&result);
}

/* In each stage that takes its time, known from the terminal. */
static void test_cancel_in_each_stage(void **state)
{
    (void)state;
    static const struct {
        const char *stage;
        int signal;
    } cases[] = {{"load", SIGINT},    {"startup", SIGINT}, {"compile", SIGTERM}, {"cull", SIGINT},
                 {"extract", SIGHUP}, {"certify", SIGINT}, {"write", SIGTERM}};
    char *folder = run_folder_create();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {.arguments = {"mesh", menger(), "-o", "a.obj", "--res", "300", "--report", "a.json"},
                         .folder = folder,
                         .changes = {"TERM=xterm"},
                         .terminal = true};
        run_process process = run_start(&desc);
        run_await(&process, cases[i].stage);
        kill(process.id, cases[i].signal);
        assert_cancelled(&process, folder, 0);
    }
    run_folder_destroy(folder);
}

/* Nor is anything left of a mesh in parts, while some are made and others go to disk. */
static void test_cancel_in_parts(void **state)
{
    (void)state;
    static const struct {
        const char *stage;
        int signal;
        double later; /* seconds from when the stage was told */
    } cases[] = {{"count", SIGTERM, 0}, {"extract", SIGINT, 0}, {"extract", SIGTERM, 0.2}, {"write", SIGTERM, 0}};
    char *folder = run_folder_create();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {.arguments = {"mesh", menger(), "-o", "a.obj", "--res", "300", "--max-memory", "64M"},
                         .folder = folder,
                         .changes = {"TERM=xterm"},
                         .terminal = true};
        run_process process = run_start(&desc);
        run_await(&process, cases[i].stage);
        run_sleep(cases[i].later);
        kill(process.id, cases[i].signal);
        assert_cancelled(&process, folder, 0);
    }
    run_folder_destroy(folder);
}

/* At any moment: either it is cancelled and nothing is there, or it was done already and the file is whole. */
static void test_cancel_at_any_moment(void **state)
{
    (void)state;
    int moments = getenv("HEWN_LONG") ? 60 : 12;
    for (int i = 0; i < moments; i++) {
        char *folder = run_folder_create();
        run_desc desc = {.arguments = {"mesh", menger(), "-o", "a.ply", "--res", "96"}, .folder = folder};
        run_process process = run_start(&desc);
        run_sleep(0.02 + 1.2 * i / moments);
        kill(process.id, SIGINT);
        run_result result = run_finish(&process);
        bool early = result.signal == SIGINT; /* before the command could ask for anything else */
        if (!early && result.code != 130 && result.code != 0)
            fail_msg("exit code %d (signal %d): %s", result.code, result.signal, result.err);
        assert_int_equal(run_folder_count(folder), result.code == 0 ? 1 : 0);
        assert_true(!early || i < moments / 2);
        run_result_destroy(&result);
        run_folder_destroy(folder);
    }
}

/* The scene's own endless loop has a limit, but nobody needs to wait for that. */
static void test_cancel_an_endless_scene(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "while true do end");
    run_desc desc = {.arguments = {"mesh", "s.lua", "-o", "a.ply"}, .folder = folder};
    run_process process = run_start(&desc);
    run_sleep(0.25);
    double asked = run_now();
    kill(process.id, SIGINT);
    assert_cancelled(&process, folder, 1);
    assert_true(run_now() - asked < 0.5);
    run_folder_destroy(folder);
}

/* So does a pipe through which nothing comes. */
static void test_cancel_a_silent_pipe(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    const char *pipe_name = run_path(folder, "pipe");
    assert_int_equal(mkfifo(pipe_name, 0600), 0);
    int both_ends = open(pipe_name, O_RDWR | O_CLOEXEC);
    assert_true(both_ends >= 0);
    run_desc desc = {.arguments = {"mesh", "-", "--from", "lua", "-o", "a.ply"}, .folder = folder, .input = pipe_name};
    run_process process = run_start(&desc);
    run_sleep(0.25);
    assert_true(run_is_alive(&process));
    kill(process.id, SIGINT);
    assert_cancelled(&process, folder, 1);
    close(both_ends);
    run_folder_destroy(folder);
}

/* --- commands that answer --------------------------------------------------------------------------------------- */

/* The signal comes after `delay`; the end soon after it, with nothing left of the output. */
static void cancel_soon(const char *const *arguments, const char *input, double delay, int signal)
{
    char *folder = run_folder_create();
    run_desc desc = {.folder = folder, .input = input};
    for (int i = 0; arguments[i]; i++)
        desc.arguments[i] = arguments[i];
    if (!input) {
        FILE *file = fopen(run_path(folder, "points.txt"), "w");
        for (int i = 0; i < 200000; i++)
            fprintf(file, "%d %d %d\n", i % 97, i % 89, i % 83);
        fclose(file);
    }
    int before = run_folder_count(folder);
    run_process process = run_start(&desc);
    run_sleep(delay);
    assert_true(run_is_alive(&process));
    double asked = run_now();
    kill(process.id, signal);
    assert_cancelled(&process, folder, before);
    if (run_now() - asked > 8) /* the machine may be very busy; what goes on to its end takes minutes */
        fail_msg("%s took %.1f s to end", arguments[0], run_now() - asked);
    run_folder_destroy(folder);
}

#define CANCEL_SOON(input, delay, signal, ...)                                                                         \
    cancel_soon((const char *const[]){__VA_ARGS__, NULL}, input, delay, signal)

static void test_cancel_a_picture(void **state)
{
    (void)state;
    static const double delays[] = {0.2, 1.2}; /* the octree, rays */
    const char *scene = run_project_file("assets/scenes/gear.lua");
    for (int i = 0; i < 2; i++)
        CANCEL_SOON("/dev/null", delays[i], i == 1 ? SIGINT : SIGTERM, "render", scene, "-o", "a.png", "--device",
                    "host", "--size", "4000x3000");
    CANCEL_SOON("/dev/null", 0.6, SIGTERM, "render", scene, "-o", "a.png", "--size", "8000x6000", "--samples", "64");
}

static void test_cancel_values_and_queries(void **state)
{
    (void)state;
    const char *scene = run_project_file("assets/scenes/gear.lua");
    CANCEL_SOON("/dev/null", 0.5, SIGTERM, "eval", scene, "--grid", "2000x2000x2000", "-o", "a.txt", "--bounds",
                "-60,-60,-10,60,60,30");
    CANCEL_SOON(NULL, 0.8, SIGTERM, "query", scene, "--nearest", "points.txt", "-o", "a.txt", "--tolerance", "1e-9");
    CANCEL_SOON(NULL, 0.3, SIGINT, "query", scene, "--nearest", "points.txt", "-o", "a.txt");
}

static void test_cancel_where_nothing_is_read(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    const char *pipe_name = run_path(folder, "pipe");
    assert_int_equal(mkfifo(pipe_name, 0600), 0);
    int both_ends = open(pipe_name, O_RDWR | O_CLOEXEC);
    assert_true(both_ends >= 0);
    const char *scene = run_project_file("assets/scenes/csg.lua");
    CANCEL_SOON(pipe_name, 0.4, SIGTERM, "eval", scene, "--points", "-", "-o", "a.txt");
    CANCEL_SOON(pipe_name, 0.4, SIGINT, "query", scene, "--nearest", "-", "-o", "a.txt");
    close(both_ends);
    run_folder_destroy(folder);
}

static void test_cancel_an_atlas(void **state)
{
    (void)state;
    CANCEL_SOON("/dev/null", 0.5, SIGTERM, "atlas", run_project_file("assets/scenes/fonts/DejaVuSerif-Bold.ttf"), "-o",
                "a.png", "--json", "a.json", "--size", "1000", "--range", "64");
}

/* --- watching ---------------------------------------------------------------------------------------------------- */

/* As editors do it: a new file, renamed over the old one. */
static void replace_file(const char *folder, const char *name, const char *text)
{
    run_write_file(run_path(folder, "new"), text);
    assert_int_equal(rename(run_path(folder, "new"), run_path(folder, name)), 0);
}

static void assert_new_mesh(const char *folder, char **bytes, size_t *length)
{
    size_t new_length;
    char *new_bytes = run_read_file(run_path(folder, "s.ply"), &new_length);
    assert_true(new_length > 1000);
    assert_true(!*bytes || new_length != *length || memcmp(new_bytes, *bytes, new_length) != 0);
    free(*bytes);
    *bytes = new_bytes;
    *length = new_length;
}

static void test_watch(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "return import('part.lua'):move(1, 0, 0)");
    run_write_file(run_path(folder, "part.lua"), "return sphere(1)");
    run_desc desc = {.arguments = {"mesh", "s.lua", "-o", "s.ply", "--res", "24", "--watch"},
                     .folder = folder,
                     .terminal = true,
                     .changes = {"TERM=dumb"}};
    run_process process = run_start(&desc);
    char *bytes = NULL;
    size_t length = 0;
    run_await(&process, "watching s.lua");
    assert_new_mesh(folder, &bytes, &length);
    run_write_file(run_path(folder, "s.lua"), "return import('part.lua'):move(2, 0, 0)");
    run_await(&process, "watching s.lua");
    assert_new_mesh(folder, &bytes, &length);
    replace_file(folder, "part.lua", "return sphere(2)");
    run_await(&process, "watching s.lua");
    assert_new_mesh(folder, &bytes, &length);
    replace_file(folder, "part.lua", "\nreturn sphere(");
    run_await(&process, "part.lua:2: ");
    run_await(&process, "watching s.lua");
    replace_file(folder, "part.lua", "return sphere(3)");
    run_await(&process, "watching s.lua");
    assert_new_mesh(folder, &bytes, &length);
    assert_int_equal(unlink(run_path(folder, "s.lua")), 0);
    run_sleep(0.3);
    run_write_file(run_path(folder, "s.lua"), "return import('part.lua')");
    run_await(&process, "watching s.lua");
    assert_new_mesh(folder, &bytes, &length);
    free(bytes);
    kill(process.id, SIGINT);
    assert_cancelled(&process, folder, 3);
    run_folder_destroy(folder);
}

/* It starts with a scene that is wrong, too, and learns of a change in an import that it never could read. */
static void test_watch_starts_broken(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "return import('part.lua')");
    run_write_file(run_path(folder, "part.lua"), "return spere(1)");
    run_desc desc = {.arguments = {"mesh", "s.lua", "-o", "s.ply", "--res", "24", "--watch"},
                     .folder = folder,
                     .terminal = true,
                     .changes = {"TERM=dumb"}};
    run_process process = run_start(&desc);
    run_await(&process, "part.lua:1: ");
    run_await(&process, "watching s.lua");
    assert_false(run_file_exists(run_path(folder, "s.ply")));
    run_write_file(run_path(folder, "part.lua"), "return sphere(1)");
    run_await(&process, "s.ply: ");
    run_await(&process, "watching s.lua");
    assert_true(run_file_exists(run_path(folder, "s.ply")));
    kill(process.id, SIGINT);
    assert_cancelled(&process, folder, 3);
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cancel_in_each_stage),      cmocka_unit_test(test_cancel_in_parts),
        cmocka_unit_test(test_cancel_at_any_moment),      cmocka_unit_test(test_cancel_an_endless_scene),
        cmocka_unit_test(test_cancel_a_silent_pipe),      cmocka_unit_test(test_cancel_a_picture),
        cmocka_unit_test(test_cancel_values_and_queries), cmocka_unit_test(test_cancel_where_nothing_is_read),
        cmocka_unit_test(test_cancel_an_atlas),           cmocka_unit_test(test_watch),
        cmocka_unit_test(test_watch_starts_broken),
    };
    return cmocka_run_group_tests_name("signals", tests, NULL, NULL);
}
