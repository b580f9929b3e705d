/* The command line: help, version, mistakes, and what works without a device. Nothing here opens one, so everything
 * runs as on a machine that has no Vulkan loader. */
#include "json_read.h"
#include "run.h"

#define NO_LOADER "HEWN_VULKAN_LOADER=/nonexistent/libvulkan.so"

static const char *const commands[] = {"mesh",   "info",      "check",    "repair", "convert",
                                       "smooth", "subdivide", "simplify", "lod",    "voxelize",
                                       "render", "atlas",     "eval",     "query",  "devices"};
enum { COMMANDS = sizeof commands / sizeof *commands };

static run_result run_words(int code, const char *first, const char *second, const char *third)
{
    run_desc desc = {.arguments = {first, second, third}, .changes = {NO_LOADER}};
    return run_expecting(code, &desc);
}

static void assert_has(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("'%s' is missing in: %s", part, text);
}

static void test_help_of_each_command(void **state)
{
    (void)state;
    for (int i = 0; i < COMMANDS; i++) {
        char usage[64];
        snprintf(usage, sizeof usage, "Usage: hewn %s ", commands[i]);
        run_result help = run_words(0, commands[i], "--help", NULL);
        assert_has(help.out, usage);
        assert_has(help.out, "\nOptions:\n");
        assert_has(help.out, "Exit codes:\n");
        assert_has(help.out, "130 cancelled");
        assert_has(help.out, "\nExample");
        assert_string_equal(help.err, "");
        run_result other = run_words(0, "help", commands[i], NULL);
        assert_string_equal(help.out, other.out);
        run_result_destroy(&other);
        other = run_words(0, commands[i], "--no-such-option", "-h");
        assert_string_equal(help.out, other.out);
        run_result_destroy(&other);
        run_result_destroy(&help);
    }
}

static void test_help_names_all_commands(void **state)
{
    (void)state;
    run_result help = run_words(0, "--help", NULL, NULL);
    const char *at = strstr(help.out, "\nCommands:\n  ");
    assert_non_null(at);
    at += strlen("\nCommands:\n");
    for (int i = 0; i < COMMANDS + 2; i++) { /* "help" and "version" come last */
        char name[32];
        assert_int_equal(sscanf(at, "  %31s ", name), 1);
        assert_string_equal(name, i < COMMANDS ? commands[i] : i == COMMANDS ? "help" : "version");
        at = strchr(at, '\n') + 1;
    }
    assert_int_equal(*at, '\n'); /* no others */
    run_result_destroy(&help);
    run_result none = run(&(run_desc){.changes = {NO_LOADER}});
    assert_int_equal(none.code, 2);
    assert_has(none.err, "Usage: hewn ");
    assert_string_equal(none.out, "");
    run_result_destroy(&none);
}

static void test_help_fits_80_columns(void **state)
{
    (void)state;
    for (int i = -1; i < COMMANDS; i++) {
        run_result help = i < 0 ? run_words(0, "--help", NULL, NULL) : run_words(0, commands[i], "--help", NULL);
        for (const char *line = help.out; *line; line += strcspn(line, "\n") + 1)
            assert_true(strcspn(line, "\n") <= 80);
        run_result_destroy(&help);
    }
}

/* Runs `each` for every long option in a command's help, with whether it takes a value. */
static void for_each_option(const char *command, void (*each)(const char *command, const char *option, bool value))
{
    run_result help = run_words(0, command, "--help", NULL);
    int count = 0;
    for (const char *line = help.out; *line; line += strcspn(line, "\n") + 1) {
        if (strncmp(line, "      --", 8) != 0 && (strncmp(line, "  -", 3) != 0 || strncmp(line + 4, ", --", 4) != 0))
            continue;
        char option[64];
        int length = 6 + (int)strcspn(line + 6, " \n");
        snprintf(option, sizeof option, "%.*s", length - 6, line + 6);
        /* A value's name follows in capitals; a flag's help stands further to the right. */
        bool value = line[length] == ' ' && line[length + 1] != ' ' && line[length + 1] != '\n';
        if (strcmp(option, "--help") != 0)
            each(command, option, value);
        count++;
    }
    assert_true(count >= 2);
    run_result_destroy(&help);
}

static void expect_known(const char *command, const char *option, bool value)
{
    run_result result = run(&(run_desc){.arguments = {command, option}, .changes = {NO_LOADER}});
    if (strstr(result.err, "unknown"))
        fail_msg("%s %s: %s", command, option, result.err);
    if (value)
        assert_has(result.err, "needs a value");
    run_result_destroy(&result);
}

static void test_every_option_of_the_help_exists(void **state)
{
    (void)state;
    for (int i = 0; i < COMMANDS; i++)
        for_each_option(commands[i], expect_known);
}

static void expect_hint(const char *command, const char *option, bool value)
{
    (void)value;
    char wrong[80], hint[80];
    snprintf(wrong, sizeof wrong, "--x%s", option + 2); /* at its end it would be as near to a plural */
    snprintf(hint, sizeof hint, "did you mean '%s'?", option);
    run_result result = run_words(2, command, wrong, NULL);
    assert_has(result.err, hint);
    run_result_destroy(&result);
}

static void test_a_wrong_option_hints_at_the_right_one(void **state)
{
    (void)state;
    for (int i = 0; i < COMMANDS; i++)
        for_each_option(commands[i], expect_hint);
}

static void test_version(void **state)
{
    (void)state;
    static const char *const words[] = {"--version", "-V", "version"};
    for (int i = 0; i < 3; i++) {
        run_result result = run_words(0, words[i], NULL, NULL);
        unsigned a, b, c;
        int end = 0;
        assert_int_equal(sscanf(result.out, "hewn %u.%u.%u%n", &a, &b, &c, &end), 3);
        assert_string_equal(result.out + end, "\n");
        run_result_destroy(&result);
    }
}

typedef struct mistake {
    const char *arguments[10];
    const char *says;
} mistake;

static const mistake mistakes[] = {
    {{"mehs"}, "did you mean 'mesh'?"},
    {{"frobnicate"}, "unknown command 'frobnicate'"},
    {{"--res"}, "unknown option '--res'"},
    {{"mesh"}, "which file?"},
    {{"mesh", "--"}, "which file?"},
    {{"mesh", ""}, "needs a name"},
    {{"mesh", "a.lua"}, "-o FILE"},
    {{"mesh", "a.lua", "b.lua", "-o", "a.glb"}, "'b.lua' is one too many"},
    {{"mesh", "a.lua", "-o"}, "needs a value"},
    {{"mesh", "a.lua", "--output="}, "needs a name"},
    {{"mesh", "a.lua", "-output", "a.glb"}, "did you mean '--output'?"},
    {{"mesh", "a.lua", "-o", "a.glb", "-Z"}, "unknown option '-Z'"},
    {{"mesh", "a.lua", "-o", "a.glb", "--open=yes"}, "takes no value"},
    {{"mesh", "a.lua", "-o", "a.glb", "--res", "0"}, "--res must be at least 1, not 0"},
    {{"mesh", "a.lua", "-o", "a.glb", "--res=-4"}, "--res must be at least 1, not -4"},
    {{"mesh", "a.lua", "-o", "a.glb", "--res", "12.5"}, "whole number, not '12.5'"},
    {{"mesh", "a.lua", "-o", "a.glb", "--res", "many"}, "whole number, not 'many'"},
    {{"mesh", "a.lua", "-o", "a.glb", "--res", " 8"}, "whole number, not ' 8'"},
    {{"mesh", "a.lua", "-o", "a.glb", "--res", ""}, "whole number, not ''"},
    {{"mesh", "a.lua", "-o", "a.glb", "--res", "100000"}, "more than 8184 cells"},
    {{"mesh", "a.lua", "-o", "a.glb", "--res", "4294967296"}, "more than 8184 cells"},
    {{"mesh", "a.lua", "-o", "a.glb", "--res", "99999999999999999999999"}, "more than 8184 cells"},
    {{"mesh", "a.lua", "-o", "a.glb", "--cell", "0"}, "--cell must be greater than 0"},
    {{"mesh", "a.lua", "-o", "a.glb", "--cell", "-1"}, "--cell must be greater than 0"},
    {{"mesh", "a.lua", "-o", "a.glb", "--cell", "nan"}, "a number, not 'nan'"},
    {{"mesh", "a.lua", "-o", "a.glb", "--cell", "0x1"}, "a number, not '0x1'"},
    {{"mesh", "a.lua", "-o", "a.glb", "--cell", "1e999"}, "a number, not '1e999'"},
    {{"mesh", "a.lua", "-o", "a.glb", "--res", "8", "--cell", "1"}, "exclude each other"},
    {{"mesh", "a.lua", "-o", "a.glb", "--bounds", "0,0,0,1,1"}, "six numbers"},
    {{"mesh", "a.lua", "-o", "a.glb", "--bounds", "0,0,0,1,1,1,1"}, "six numbers"},
    {{"mesh", "a.lua", "-o", "a.glb", "--bounds", "0,0,0,1,0,1"}, "y0 must be less than y1"},
    {{"mesh", "a.lua", "-o", "a.glb", "--bounds", "0,0,2,1,1,1"}, "z0 must be less than z1"},
    {{"mesh", "a.lua", "-o", "a.glb", "--bounds", "0,0,nan,1,1,1"}, "'nan' is not a number"},
    {{"mesh", "a.lua", "-o", "a.glb", "--bounds", "0,0,0,inf,1,1"}, "'inf' is not a number"},
    {{"mesh", "a.lua", "-o", "a.glb", "--bounds", "0,,0,1,1,1"}, "'' is not a number"},
    {{"mesh", "a.lua", "-o", "a.glb", "--method", "magic"}, "--method is mc, mc33, nets or dc, not 'magic'"},
    {{"mesh", "a.lua", "-o", "a.glb", "--quads"}, "glb files hold triangles only"},
    {{"mesh", "a.lua", "-o", "a.stl", "--quads"}, "stl files hold triangles only"},
    {{"mesh", "a.lua", "-o", "a.3mf", "--quads"}, "3mf files hold triangles only"},
    {{"mesh", "a.lua", "-o", "a.ply", "--quads", "--method", "mc"}, "the method mc makes triangles"},
    {{"mesh", "a.lua", "-o", "a.ply", "--quads", "--adaptive", "1"}, "merged faces are triangles"},
    {{"mesh", "a.lua", "-o", "a.ply", "--adaptive", "0"}, "--adaptive must be greater than 0"},
    {{"mesh", "a.lua", "-o", "a.ply", "--adaptive", "1", "--method", "nets"}, "not those of nets"},
    {{"mesh", "a.lua", "-o", "a.glb", "--threads", "0"}, "--threads must be at least 1"},
    {{"mesh", "a.lua", "-o", "a.glb", "--threads", "5000"}, "--threads is at most 4096"},
    {{"mesh", "a.lua", "-o", "a.glb", "-D", "L"}, "NAME=VALUE"},
    {{"mesh", "a.lua", "-o", "a.glb", "-D", "=3"}, "NAME=VALUE"},
    {{"mesh", "a.lua", "-o", "a.glb", "-DL=three"}, "a number, not 'three'"},
    {{"mesh", "a.lua", "-o", "a.glb", "--from", "scad"}, "not 'scad'"},
    {{"mesh", "a.lua", "-o", "a.glb", "--to", "gif"}, "not 'gif'"},
    {{"mesh", "a.lua", "-o", "a.foo"}, "does not end in .glb, .obj, .ply, .stl, .off or .3mf"},
    {{"mesh", "a.lua", "-o", "a"}, "does not end in .glb, .obj, .ply, .stl, .off or .3mf"},
    {{"mesh", "a.lua", "-o", "-"}, "--to obj, ply, stl or off"},
    {{"mesh", "a.lua", "-o", "-", "--to", "glb"}, "GLB cannot be written to standard output"},
    {{"mesh", "-", "-o", "a.glb"}, "--from"},
    {{"mesh", "-", "--from", "vm", "-o", "a.glb", "--watch"}, "--watch"},
    {{"mesh", "a.lua", "--to", "ply", "-o", "-", "--watch"}, "--watch"},
    {{"mesh", "a.lua", "--to", "ply", "-o", "-", "--report", "-"}, "standard output"},
    {{"mesh", "a.lua", "-o", "a.glb", "--report", "a.glb"}, "cannot both"},
    {{"info"}, "which file?"},
    {{"info", "a.glb", "-D", "x=1"}, "a.glb is a mesh"},
    {{"info", "a.txt"}, "a scene ends in .lua or .vm"},
    {{"smooth", "a.obj", "-o", "b.obj", "--method", "magic"}, "--method is taubin"},
    {{"convert", "a.obj", "-o", "b.obj", "--smooth", "magic"}, "--smooth is taubin"},
    {{"smooth", "a.obj", "-o", "b.obj", "--iterations", "0"}, "--iterations must be at least 1"},
    {{"smooth", "a.obj", "-o", "b.obj", "--step", "1"}, "--step is for cotan and implicit, not for taubin"},
    {{"smooth", "a.obj", "-o", "b.obj", "--method", "hc", "--passband", "1"}, "--passband is for taubin, not for hc"},
    {{"smooth", "a.obj", "-o", "b.obj", "--strength", "0"}, "--strength must be greater than 0"},
    {{"smooth", "a.obj", "-o", "b.obj", "--strength", "1.5"}, "--strength is at most 1"},
    {{"smooth", "a.obj", "-o", "b.obj", "--passband", "2"}, "--passband must be below 2"},
    {{"smooth", "a.obj", "-o", "b.obj", "--push", "1"}, "--push is for hc"},
    {{"smooth", "a.obj", "-o", "b.obj", "--lock", "boundary,corners"}, "not 'corners'"},
    {{"smooth", "a.obj", "-o", "b.obj", "--lock", "features:0"}, "not 'features:0'"},
    {{"smooth", "a.obj", "-o", "b.obj", "--lock", "labels,"}, "not ''"},
    {{"subdivide", "a.obj", "-o", "b.obj", "--scheme", "doo-sabin"}, "--scheme is catmull-clark, loop or bilinear"},
    {{"subdivide", "a.obj", "-o", "b.obj", "--levels", "17"}, "--levels is at most 16"},
    {{"subdivide", "a.obj", "-o", "b.obj", "--levels", "0"}, "--levels 0 needs --limit"},
    {{"subdivide", "a.obj", "-o", "b.obj", "--boundary", "x"}, "--boundary is edge-and-corner"},
    {{"subdivide", "a.obj", "-o", "b.obj", "--uv", "x"}, "--uv is corners-plus1"},
    {{"subdivide", "a.obj", "-o", "b.obj", "--crease-angle", "200"}, "--crease-angle is from 0 to 180"},
    {{"subdivide", "a.obj", "-o", "b.obj", "--adaptive", "0"}, "--adaptive must be greater than 0"},
    {{"devices", "all"}, "'all'"},
};

static void test_mistakes(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        run_desc desc = {.folder = folder, .changes = {NO_LOADER}};
        memcpy(desc.arguments, mistakes[i].arguments, sizeof mistakes[i].arguments);
        run_result result = run_expecting(2, &desc);
        assert_has(result.err, mistakes[i].says);
        assert_has(result.err, "--help'.\n");
        assert_string_equal(result.out, "");
        run_result_destroy(&result);
        assert_int_equal(run_folder_count(folder), 0);
    }
    run_folder_destroy(folder);
}

static void test_help_on_a_full_disk_fails(void **state)
{
    (void)state;
    run_desc desc = {.arguments = {"--help"}, .output = "/dev/full"};
    run_result result = run_expecting(1, &desc);
    assert_has(result.err, "No space left on device");
    run_result_destroy(&result);
}

static const char scene_text[] = "local p = param and 1\n"
                                 "return sphere(1)\n";

static void test_info_needs_no_loader(void **state)
{
    (void)state;
    run_result text = run_words(0, "info", run_project_file("assets/scenes/menger.lua"), NULL);
    assert_has(text.out, "nodes ");
    assert_has(text.out, "units ");
    assert_has(text.out, "bounds ");
    assert_has(text.out, "\n  L ");
    run_result_destroy(&text);
    run_result json = run_words(0, "info", run_project_file("assets/scenes/menger.lua"), "--json");
    assert_true(json_is_valid(json.out));
    assert_string_equal(json_string(json.out, "parameters.0.name"), "L");
    assert_true(json_number(json.out, "parameters.0.default") == 3);
    assert_true(json_number(json.out, "parameters.0.value") == 3);
    assert_int_equal(json_count(json.out, "parameters.0.range"), 2);
    assert_string_equal(json_string(json.out, "bounds_from"), "scene");
    assert_true(json_number(json.out, "bounds.lo.0") == -1.2);
    assert_true(json_number(json.out, "bounds.hi.2") == 1.2);
    assert_true(json_number(json.out, "nodes") > 10);
    assert_true(json_number(json.out, "metres_per_unit") == 1);
    assert_string_equal(json_string(json.out, "up"), "+Y");
    assert_int_equal(json_count(json.out, "files"), 1);
    run_result_destroy(&json);
    run_desc desc = {
        .arguments = {"info", run_project_file("assets/scenes/menger.lua"), "--json", "-D", "L=2", "-DL=1"},
        .changes = {NO_LOADER}};
    json = run_expecting(0, &desc);
    assert_true(json_number(json.out, "parameters.0.value") == 1);
    run_result_destroy(&json);
}

static void test_info_of_a_mesh(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    const char *path = run_path(folder, "tetrahedron.obj");
    run_write_file(path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    run_result text = run_words(0, "info", path, NULL);
    assert_has(text.out, "closed                 yes");
    assert_has(text.out, "genus                  0");
    run_result_destroy(&text);
    run_result json = run_words(0, "info", path, "--json");
    assert_true(json_is_valid(json.out));
    assert_true(json_number(json.out, "counts.faces") == 4);
    assert_true(json_bool(json.out, "certificate.manifold"));
    assert_true(json_number(json.out, "certificate.volume") > 0.1666);
    assert_true(json_is_null(json.out, "certificate.max_residual"));
    run_result_destroy(&json);
    run_write_file(path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    run_result bad = run_words(3, "info", path, NULL);
    assert_has(bad.err, "tetrahedron.obj");
    run_result_destroy(&bad);
    bad = run_words(3, "info", run_path(folder, "missing.stl"), NULL);
    assert_has(bad.err, "missing.stl: ");
    run_result_destroy(&bad);
    run_folder_destroy(folder);
}

static void test_dashes_and_order(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "-x.lua"), scene_text);
    run_desc desc = {.arguments = {"info", "--json", "--", "-x.lua"}, .folder = folder, .changes = {NO_LOADER}};
    run_result result = run_expecting(0, &desc);
    assert_string_equal(json_string(result.out, "input"), "-x.lua");
    run_result_destroy(&result);
    run_desc piped = {.arguments = {"info", "--from=lua", "-", "--json"},
                      .input = run_path(folder, "-x.lua"),
                      .changes = {NO_LOADER}};
    result = run_expecting(0, &piped);
    assert_string_equal(json_string(result.out, "input"), "-");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_no_loader(void **state)
{
    (void)state;
    run_result result = run_words(4, "devices", NULL, NULL);
    assert_has(result.err, "loader");
    run_result_destroy(&result);
    char *folder = run_folder_create();
    run_desc desc = {.arguments = {"mesh", run_project_file("assets/scenes/csg.lua"), "-o", "a.glb"},
                     .folder = folder,
                     .changes = {NO_LOADER}};
    result = run_expecting(4, &desc);
    assert_has(result.err, "loader");
    assert_int_equal(run_folder_count(folder), 0);
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_devices(void **state)
{
    (void)state;
    run_result text = run(&(run_desc){.arguments = {"devices"}});
    if (text.code == 4)
        skip();
    assert_int_equal(text.code, 0);
    run_result json = run_expecting(0, &(run_desc){.arguments = {"devices", "--json"}});
    assert_true(json_is_valid(json.out));
    size_t count = json_count(json.out, "devices");
    for (size_t i = 0; i < count; i++) {
        char path[64];
        snprintf(path, sizeof path, "devices.%zu.index", i);
        assert_true(json_number(json.out, path) == (double)i);
        snprintf(path, sizeof path, "devices.%zu.limits.max_allocation", i);
        assert_true(json_number(json.out, path) > 0);
        snprintf(path, sizeof path, "devices.%zu.name", i);
        assert_has(text.out, json_string(json.out, path));
    }
    run_result_destroy(&json);
    run_result_destroy(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_help_of_each_command),
        cmocka_unit_test(test_help_names_all_commands),
        cmocka_unit_test(test_help_fits_80_columns),
        cmocka_unit_test(test_every_option_of_the_help_exists),
        cmocka_unit_test(test_a_wrong_option_hints_at_the_right_one),
        cmocka_unit_test(test_version),
        cmocka_unit_test(test_mistakes),
        cmocka_unit_test(test_help_on_a_full_disk_fails),
        cmocka_unit_test(test_info_needs_no_loader),
        cmocka_unit_test(test_info_of_a_mesh),
        cmocka_unit_test(test_dashes_and_order),
        cmocka_unit_test(test_no_loader),
        cmocka_unit_test(test_devices),
    };
    return cmocka_run_group_tests_name("usage", tests, NULL, NULL);
}
