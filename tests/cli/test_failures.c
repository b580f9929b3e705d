/* What cannot be meshed or written: each failure says what and where, has its exit code, and leaves nothing behind. */
#include "run.h"

#define BOX "--bounds", "-2,-2,-2,2,2,2"

typedef struct failure {
    const char *scene;
    int code;
    const char *says;
} failure;

/* With the bounds of BOX. */
static const failure scenes[] = {
    {"return sphere(", 3, "hewn: s.lua:1: "},
    {"local a = 1\nlocal b = a.c.d\nreturn sphere(1)", 3, "hewn: s.lua:2: "},
    {"return sphere(1) | nil", 3, "hewn: s.lua:1: "},
    {"return 5", 3, "hewn: s.lua: "},
    {"", 3, "hewn: s.lua: "},
    {"while true do end", 3, "hewn: s.lua:1: "},
    {"local t = {}\nlocal s = 'xxxxxxxx'\nfor i = 1, 1e9 do t[i] = s .. i end", 3, "hewn: s.lua:3: "},
    {"return io.open('/etc/passwd')", 3, "hewn: s.lua:1: "},
    {"return import('../../../etc/passwd.lua')", 3, "hewn: s.lua:1: "},
    {"\x1bLua\x54", 3, "hewn: s.lua"},
    {"return sqrt(-1 - x * x)", 3, "NaN"},
    {"return sphere(1):move(9, 0, 0)", 3, "hewn: s.lua: "},
    {"return sphere(1) + 5", 3, "hewn: s.lua: "},
    {"return x * x - 50", 3, "inside"},
};

static void assert_has(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("'%s' is missing in: %s", part, text);
}

/* One run in a folder of which it must leave as many entries as before. */
static void fail_in(const char *folder, const failure *expected, run_desc desc)
{
    int before = run_folder_count(folder);
    desc.folder = folder;
    run_result result = run_expecting(expected->code, &desc);
    assert_has(result.err, expected->says);
    run_result_destroy(&result);
    assert_int_equal(run_folder_count(folder), before);
}

static void test_scenes(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        run_write_file(run_path(folder, "s.lua"), scenes[i].scene);
        fail_in(folder, &scenes[i], (run_desc){.arguments = {"mesh", "s.lua", "-o", "s.ply", "--res", "32", BOX}});
        assert_false(run_file_exists(run_path(folder, "s.ply")));
    }
    run_folder_destroy(folder);
}

/* Without bounds, given or found. */
static void test_scenes_without_bounds(void **state)
{
    (void)state;
    static const failure cases[] = {
        {"return x", 3, "--bounds"},
        {"return x * 0 / 0", 3, "NaN"},
        {"return sphere(1) + 5", 3, "empty"},
        {"return x * 0 - 1", 3, "inside"},
    };
    char *folder = run_folder_create();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_write_file(run_path(folder, "s.lua"), cases[i].scene);
        fail_in(folder, &cases[i], (run_desc){.arguments = {"mesh", "s.lua", "-o", "s.glb", "--res", "32"}});
    }
    run_folder_destroy(folder);
}

static void test_error_in_an_import(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "return import('part.lua')");
    run_write_file(run_path(folder, "part.lua"), "\n\nerror('the part is broken')");
    failure expected = {NULL, 3, "part.lua:3: the part is broken"};
    fail_in(folder, &expected, (run_desc){.arguments = {"mesh", "s.lua", "-o", "s.glb"}});
    run_folder_destroy(folder);
}

static void test_bad_vm(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.vm"), "# a comment\n_0 var-x\n_1 frobnicate _0\n");
    failure expected = {NULL, 3, "s.vm:3: "};
    fail_in(folder, &expected, (run_desc){.arguments = {"mesh", "s.vm", "-o", "s.glb"}});
    run_folder_destroy(folder);
}

static void test_inputs(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "local r = param('r', 1)\nreturn sphere(1)");
    failure missing = {NULL, 3, "hewn: missing.lua: cannot open: No such file or directory"};
    fail_in(folder, &missing, (run_desc){.arguments = {"mesh", "missing.lua", "-o", "s.glb"}});
    failure unknown = {NULL, 3, "frobnicate"};
    fail_in(folder, &unknown, (run_desc){.arguments = {"mesh", "s.lua", "-o", "s.glb", "-D", "frobnicate=1"}});
    failure device = {NULL, 4, "frobnicate"};
    fail_in(folder, &device, (run_desc){.arguments = {"mesh", "s.lua", "-o", "s.glb", "--device", "frobnicate"}});
    failure far = {NULL, 2, "too far from the origin"};
    fail_in(folder, &far, (run_desc){.arguments = {"mesh", "s.lua", "-o", "s.glb", "--bounds", "1e6,0,0,1000001,1,1"}});
    failure fine = {NULL, 2, "8184"};
    fail_in(folder, &fine, (run_desc){.arguments = {"mesh", "s.lua", "-o", "s.glb", "--cell", "1e-5"}});
    run_folder_destroy(folder);
}

/* An output that cannot be written is refused before the scene is run: the scene here would loop for ever. */
static void test_outputs_are_checked_first(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "while true do end");
    run_write_file(run_path(folder, "file"), "");
    static const failure cases[] = {
        {"missing/s.glb", 1, "hewn: missing/s.glb: "},
        {"file/s.glb", 1, "hewn: file/s.glb: "},
        {"/proc/s.glb", 1, "hewn: /proc/s.glb: "},
        {"folder.glb/", 1, "folder.glb"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *path = cases[i].scene;
        fail_in(folder, &cases[i], (run_desc){.arguments = {"mesh", "s.lua", "--to", "glb", "-o", path}});
        fail_in(folder, &cases[i], (run_desc){.arguments = {"mesh", "s.lua", "-o", "s.glb", "--report", path}});
    }
    run_folder_destroy(folder);
}

static void test_full_disk(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "return sphere(1)");
    static const char *const names[] = {"s.glb", "s.obj", "s.ply", "s.stl"};
    for (int i = 0; i < 4; i++) {
        failure expected = {NULL, 1, "File too large"};
        run_desc desc = {.arguments = {"mesh", "s.lua", "-o", names[i]}, .file_limit = 100000};
        fail_in(folder, &expected, desc);
        expected.says = "No space left on device";
        desc = (run_desc){.arguments = {"mesh", "s.lua", "-o", "/dev/full", "--to", names[i] + 2}};
        fail_in(folder, &expected, desc);
        assert_true(run_file_exists("/dev/full"));
        if (i == 0)
            continue;
        desc = (run_desc){.arguments = {"mesh", "s.lua", "-o", "-", "--to", names[i] + 2}, .output = "/dev/full"};
        fail_in(folder, &expected, desc);
    }
    run_folder_destroy(folder);
}

/* A file that was there before stays as it was. */
static void test_failure_keeps_the_old_file(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "return sphere(1)");
    run_write_file(run_path(folder, "s.ply"), "old");
    failure expected = {NULL, 1, "File too large"};
    fail_in(folder, &expected, (run_desc){.arguments = {"mesh", "s.lua", "-o", "s.ply"}, .file_limit = 100000});
    char *text = run_read_file(run_path(folder, "s.ply"), NULL);
    assert_string_equal(text, "old");
    free(text);
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_scenes_without_bounds),
        cmocka_unit_test(test_error_in_an_import),
        cmocka_unit_test(test_bad_vm),
        cmocka_unit_test(test_inputs),
        cmocka_unit_test(test_outputs_are_checked_first),
        cmocka_unit_test(test_full_disk),
        cmocka_unit_test(test_failure_keeps_the_old_file),
    };
    return cmocka_run_group_tests_name("failures", tests, NULL, NULL);
}
