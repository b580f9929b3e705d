/* --sweep: a file for each value of a parameter, the same as one by one, and errors that name the step. */
#include "run.h"

static const char scene[] = "local t = param('t', 0, {max = 1})\n"
                            "return morph(sphere(0.5), box(0.9), t):color(t, 0, 0)\n";

static void assert_has(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("no '%s' in: %s", part, text);
}

static void meshes_are_those_of_single_runs(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), scene);
    run_result result = run_expecting(0, &(run_desc){.arguments = {"mesh", "s.lua", "-o", "out.part.ply", "--sweep",
                                                                   "t=0:1:3", "--res", "16", "--report", "r.json"},
                                                     .folder = folder});
    assert_has(result.err, "out.part-0003.ply:");
    run_result_destroy(&result);
    assert_int_equal(run_folder_count(folder), 7);
    static const char *const values[] = {"t=0", "t=0.5", "t=1"};
    static const char *const names[] = {"out.part-0001.ply", "out.part-0002.ply", "out.part-0003.ply"};
    for (int i = 0; i < 3; i++) {
        /* the same name: PLY has it in its comments */
        run_subfolder(folder, "one");
        char single[64];
        snprintf(single, sizeof single, "one/%s", names[i]);
        result =
            run_expecting(0, &(run_desc){.arguments = {"mesh", "s.lua", "-o", single, "-D", values[i], "--res", "16"},
                                         .folder = folder});
        run_result_destroy(&result);
        char path[4096];
        snprintf(path, sizeof path, "%s", run_path(folder, single));
        run_assert_same_file(run_path(folder, names[i]), path);
    }
    assert_true(run_file_exists(run_path(folder, "r-0002.json")));
    run_folder_destroy(folder);
}

static void pictures(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), scene);
    run_result result =
        run_expecting(0, &(run_desc){.arguments = {"render", "s.lua", "-o", "p.png", "--sweep", "t=1:0:2", "--size",
                                                   "40x30", "-q", "--device", "host"},
                                     .folder = folder});
    run_result_destroy(&result);
    assert_true(run_file_exists(run_path(folder, "p-0001.png")) && run_file_exists(run_path(folder, "p-0002.png")));
    assert_int_equal(run_folder_count(folder), 3);
    run_folder_destroy(folder);
}

/* What came before the step that fails stays; nothing comes after it. */
static void errors_name_the_step(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), scene);
    run_result result =
        run_expecting(3, &(run_desc){.arguments = {"mesh", "s.lua", "-o", "m.obj", "--sweep", "t=0:2:5", "--res", "8"},
                                     .folder = folder});
    assert_has(result.err, "step 4 of 5 (t = 1.5): ");
    assert_has(result.err, "s.lua:1: ");
    run_result_destroy(&result);
    assert_true(run_file_exists(run_path(folder, "m-0003.obj")));
    assert_int_equal(run_folder_count(folder), 4);
    result = run_expecting(
        3, &(run_desc){.arguments = {"mesh", "s.lua", "-o", "m.obj", "--sweep", "u=0:2:5"}, .folder = folder});
    assert_has(result.err, "there is no parameter 'u'");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void misuse(void **state)
{
    (void)state;
    static const struct {
        const char *arguments[9], *part;
    } cases[] = {
        {{"mesh", "s.lua", "-o", "a.ply", "--sweep", "t=0:1"}, "NAME=FROM:TO:COUNT"},
        {{"mesh", "s.lua", "-o", "a.ply", "--sweep", "0:1:3"}, "NAME=FROM:TO:COUNT"},
        {{"mesh", "s.lua", "-o", "a.ply", "--sweep", "t=0:1:3:4"}, "NAME=FROM:TO:COUNT"},
        {{"mesh", "s.lua", "-o", "a.ply", "--sweep", "t=0:one:3"}, "--sweep's TO"},
        {{"mesh", "s.lua", "-o", "a.ply", "--sweep", "t=0:1:0"}, "--sweep's COUNT"},
        {{"mesh", "s.lua", "-o", "a.ply", "--sweep", "t=0:1:1000000"}, "at most 100000"},
        {{"mesh", "s.lua", "-o", "a.ply", "--sweep", "t=0:1:2", "-D", "t=1"}, "both set t"},
        {{"mesh", "s.lua", "-o", "-", "--to", "obj", "--sweep", "t=0:1:2"}, "standard output"},
        {{"mesh", "-", "--from", "lua", "-o", "a.ply", "--sweep", "t=0:1:2"}, "standard input"},
        {{"mesh", "s.lua", "-o", "a.ply", "--watch", "--sweep", "t=0:1:2"}, "exclude"},
        {{"render", "m.ply", "-o", "a.png", "--sweep", "t=0:1:2"}, "a mesh has none"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {0};
        memcpy(desc.arguments, cases[i].arguments, sizeof cases[i].arguments);
        run_result result = run_expecting(2, &desc);
        assert_has(result.err, cases[i].part);
        run_result_destroy(&result);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_are_those_of_single_runs),
        cmocka_unit_test(pictures),
        cmocka_unit_test(errors_name_the_step),
        cmocka_unit_test(misuse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
