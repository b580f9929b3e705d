/* Scenes on disk: what they import, what they declare, and errors that name file and line. */
#include "test_scene.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    test_make_folder(folder);
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    test_remove_folder(folder);
    return 0;
}

static hewn_result load_path(const char *name, bool allow_path, hewn_scene **scene, hewn_error *error)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    hewn_scene_desc desc = {.path = path, .allow_path = allow_path};
    *error = (hewn_error){0};
    return hewn_scene_load(&desc, scene, error);
}

static hewn_scene *load_good(const char *name)
{
    hewn_scene *scene;
    hewn_error error;
    if (load_path(name, false, &scene, &error) != HEWN_OK)
        fail_msg("%s: %s:%u: %s", name, error.file, error.line, error.message);
    return scene;
}

static void load_bad(const char *name, const char *file, uint32_t line, const char *part)
{
    char path[512];
    hewn_scene *scene = (hewn_scene *)1;
    hewn_error error;
    hewn_result result = load_path(name, false, &scene, &error);
    snprintf(path, sizeof path, "%s/%s", folder, file);
    if (result != HEWN_BAD_INPUT || scene || strcmp(error.file, path) != 0 || error.line != line ||
        !strstr(error.message, part))
        fail_msg("%s gave %s, %s:%u: %s\nexpected %s:%u: ...%s...", name, hewn_result_name(result), error.file,
                 error.line, error.message, path, line, part);
}

static double value_at(const hewn_scene *scene, double x, double y, double z)
{
    const double point[3] = {x, y, z};
    double value;
    const hewn_field *field = hewn_scene_field(scene);
    assert_int_equal(hewn_field_eval(field, hewn_field_root(field), point, 1, &value, NULL), HEWN_OK);
    return value;
}

static void make_subfolder(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(mkdir(path, 0777), 0);
}

static void link_to(const char *target, const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(symlink(target, path), 0);
}

/* --- import --------------------------------------------------------------------------------------------------------
 */

static void test_import(void **state)
{
    (void)state;
    make_subfolder("parts");
    test_write_text(folder, "main.lua",
                    "local kit = import 'parts/kit.lua'\nlocal again = import('./parts/../parts/kit.lua')\n"
                    "assert(kit == again and kit.runs == 1)\n"
                    "assert(import 'parts/nothing.lua' == nil and import 'parts/nothing.lua' == nil)\n"
                    "return kit.ball(2) | import 'ring.lua' | import 'flat.vm'");
    test_write_text(folder, "parts/kit.lua",
                    "runs = (runs or 0) + 1\nunits('km') bounds(-9, -9, -9, 9, 9, 9) up('+X')\n"
                    "local inner = import 'inner.lua'\nreturn {runs = runs, ball = function(r) return inner(r) end}");
    test_write_text(folder, "parts/inner.lua", "return function(r) return import 'unit.lua' * r end");
    test_write_text(folder, "parts/unit.lua", "return sphere(1)");
    test_write_text(folder, "parts/nothing.lua", "nothings = (nothings or 0) + 1 assert(nothings == 1)");
    test_write_text(folder, "ring.lua", "return torus(1, 0.1)");
    test_write_text(folder, "flat.vm", "a var-y\n");
    hewn_scene *scene = load_good("main.lua");
    assert_true(value_at(scene, 0, 0.5, 0) == -1);
    assert_int_equal(hewn_scene_file_count(scene), 7);
    static const char *const files[] = {"main.lua",       "parts/kit.lua", "parts/inner.lua", "parts/nothing.lua",
                                        "parts/unit.lua", "ring.lua",      "flat.vm"};
    size_t found = 0;
    for (size_t i = 0; i < COUNT(files); i++)
        for (size_t j = 0; j < hewn_scene_file_count(scene); j++) {
            const char *path = hewn_scene_file(scene, j);
            assert_int_equal(access(path, R_OK), 0);
            found += strlen(path) > strlen(files[i]) && strcmp(path + strlen(path) - strlen(files[i]), files[i]) == 0;
        }
    assert_int_equal(found, COUNT(files));
    /* What an imported file says of itself does not speak for the scene. */
    hewn_box box;
    assert_false(hewn_scene_bounds(scene, &box));
    assert_string_equal(hewn_scene_unit(scene)->name, "m");
    assert_int_equal(hewn_scene_up(scene), HEWN_AXIS_PLUS_Y);
    assert_null(hewn_scene_file(scene, 7));
    hewn_scene_destroy(&scene);
}

static void test_import_stays_inside(void **state)
{
    (void)state;
    make_subfolder("scene");
    make_subfolder("scene-beside");
    test_write_text(folder, "outside.lua", "return sphere(1)");
    test_write_text(folder, "scene-beside/a.lua", "return sphere(1)");
    make_subfolder("scene/folder.lua");
    link_to("../outside.lua", "scene/link.lua");
    link_to("..", "scene/up");
    test_write_text(folder, "scene/inside.lua", "return sphere(1)");
    link_to("inside.lua", "scene/inner_link.lua");
    char absolute[256];
    snprintf(absolute, sizeof absolute, "return import '%s/scene/inside.lua'", folder);
    static const struct {
        const char *text, *part;
    } bad[] = {
        {"return import '../outside.lua'", "outside the scene's folder"},
        {"return import '../scene-beside/a.lua'", "outside the scene's folder"},
        {"return import 'link.lua'", "outside the scene's folder"},
        {"return import 'up/outside.lua'", "outside the scene's folder"},
        {"return import '/etc/passwd'", "absolute path"},
        {"return import 'up'", "outside the scene's folder"},
        {"return import '.'", "outside the scene's folder"},
        {"return import ''", "outside the scene's folder"},
        {"return import 'folder.lua'", "not a file"},
        {"return import 'absent.lua'", "No such file"},
        {"return import 'inside.lua\\0.txt'", "zero byte"},
        {"return import(7)", "must be a text"},
        {"return import()", "takes 1 argument"},
    };
    for (size_t i = 0; i < COUNT(bad); i++) {
        test_write_text(folder, "scene/main.lua", bad[i].text);
        load_bad("scene/main.lua", "scene/main.lua", 1, bad[i].part);
    }
    test_write_text(folder, "scene/main.lua", absolute);
    load_bad("scene/main.lua", "scene/main.lua", 1, "absolute path");
    static const char *const good[] = {"return import 'inside.lua'", "return import 'inner_link.lua'",
                                       "return import '../scene/inside.lua'"};
    for (size_t i = 0; i < COUNT(good); i++) {
        test_write_text(folder, "scene/main.lua", good[i]);
        hewn_scene *scene = load_good("scene/main.lua");
        hewn_scene_destroy(&scene);
    }
    static const char *const allowed[] = {"return import '../outside.lua'", "return import 'link.lua'",
                                          "return import 'up/outside.lua'", NULL};
    for (size_t i = 0; i < COUNT(allowed); i++) {
        hewn_scene *scene;
        hewn_error error;
        test_write_text(folder, "scene/main.lua", allowed[i] ? allowed[i] : absolute);
        assert_int_equal(load_path("scene/main.lua", true, &scene, &error), HEWN_OK);
        hewn_scene_destroy(&scene);
    }
}

static void test_import_circles(void **state)
{
    (void)state;
    test_write_text(folder, "self.lua", "\nreturn import 'self.lua'");
    load_bad("self.lua", "self.lua", 2, "in a circle");
    test_write_text(folder, "a.lua", "return import 'b.lua'");
    test_write_text(folder, "b.lua", "\n\nreturn import 'c.lua'");
    test_write_text(folder, "c.lua", "\nreturn import 'b.lua'");
    load_bad("a.lua", "c.lua", 2, "in a circle");
    test_write_text(folder, "c.lua", "return import './a.lua'");
    load_bad("a.lua", "c.lua", 1, "in a circle");
    test_write_text(folder, "c.lua", "for i = 1, 100 do assert(not pcall(import, 'b.lua')) end error('done')");
    load_bad("a.lua", "c.lua", 1, "done");
    for (int i = 0; i < 40; i++) {
        char name[32], text[64];
        snprintf(name, sizeof name, "deep%d.lua", i);
        snprintf(text, sizeof text, "return import 'deep%d.lua'", i + 1);
        test_write_text(folder, name, text);
    }
    hewn_scene *scene;
    hewn_error error;
    assert_int_equal(load_path("deep0.lua", false, &scene, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "deep"));
    /* A scene may catch the failure of an import, and try again. */
    test_write_text(folder, "a.lua",
                    "for i = 1, 2 do local ok, e = pcall(import, 'bad.lua') assert(not ok and e:find('bad.lua:2')) end "
                    "return x");
    test_write_text(folder, "bad.lua", "\nerror('no')");
    scene = load_good("a.lua");
    hewn_scene_destroy(&scene);
}

/* --- errors --------------------------------------------------------------------------------------------------------
 */

static void test_error_places(void **state)
{
    (void)state;
    test_write_text(folder, "main.lua", "local p = import 'part.lua'\n\nreturn p(1)");
    static const struct {
        const char *text;
        uint32_t line;
        const char *part;
    } parts[] = {
        {"return function(a)\n  return sphere(-a)\nend", 2, "sphere: argument 1 must be a positive number, not -1.0"},
        {"return function(a)\n\n  error('broken')\nend", 3, "broken"},
        {"return function(a)\n\n  error({})\nend", 3, "an error that is a table"},
        {"return function(a)\n\n  error()\nend", 3, "an error that is a nil"},
        {"return function(a)\n\n  error('bare', 0)\nend", 3, "bare"},
        {"\nreturn function(a) return a.b.c end", 2, "attempt to index"},
        {"\n\nreturn function(a", 3, "expected"},
        {"\n\x1b[31m", 2, "unexpected symbol"},
        {"\nlocal x = nil + 1", 2, "arithmetic"},
        {"return function(a)\n while true do end end", 2, "endless loop"},
        {"return function(a)\n local t = {} while true do t[#t + 1] = {} end end", 2, "MiB of memory"},
        {"return function(a)\n return ('x'):rep(1 << 20) .. ('x'):rep(99) end", 2, "too large"},
        {"\x1bLuaS", 1, "compiled Lua"},
    };
    for (size_t i = 0; i < COUNT(parts); i++) {
        test_write_text(folder, "part.lua", parts[i].text);
        load_bad("main.lua", "part.lua", parts[i].line, parts[i].part);
    }
    test_write_text(folder, "main.lua", "\nreturn import 'part.vm'");
    test_write_text(folder, "part.vm", "a var-x\n\nb add a c\n");
    load_bad("main.lua", "part.vm", 3, "no line above this one is called 'c'");
    test_write_text(folder, "part.vm", "\n");
    load_bad("main.lua", "part.vm", 0, "no instruction");
    /* A path too long for Lua's own messages is named whole all the same. */
    char deep[128] = "a-folder-with-a-name-that-is-longer-than-sixty-characters-to-be-cut";
    make_subfolder(deep);
    strcat(deep, "/main.lua");
    test_write_text(folder, deep, "\n\nerror('far')");
    load_bad(deep, deep, 3, "far");
    test_write_text(folder, deep, "\n\nreturn return");
    load_bad(deep, deep, 3, "unexpected symbol");
}

static void test_messages_are_clean(void **state)
{
    (void)state;
    hewn_scene *scene;
    hewn_error error = {0};
    assert_int_equal(test_load("error('a\\27[2J\\n\\r\\xFFb\\xC2\\x9Bc\\u{E4}')", HEWN_SCENE_LUA, &scene, &error),
                     HEWN_BAD_INPUT);
    assert_string_equal(error.message, "a [2J  ?b c\xC3\xA4");
    assert_int_equal(test_load("error(('\\u{20AC}'):rep(1000))", HEWN_SCENE_LUA, &scene, &error), HEWN_BAD_INPUT);
    size_t length = strlen(error.message);
    assert_true(length % 3 == 0 && length > sizeof error.message - 4);
}

static void test_results(void **state)
{
    (void)state;
    test_refused("sphere(1)", HEWN_SCENE_LUA, 0, "returned nothing");
    test_refused("", HEWN_SCENE_LUA, 0, "returned nothing");
    test_refused("return {sphere(1)}", HEWN_SCENE_LUA, 0, "returned a table");
    test_refused("return 7", HEWN_SCENE_LUA, 0, "returned a number");
    test_refused("return nil", HEWN_SCENE_LUA, 0, "returned a nil");
    test_refused("return sphere", HEWN_SCENE_LUA, 0, "returned a function");
    test_refused("return x, y", HEWN_SCENE_LUA, 0, "returned 2 values");
}

static void test_wrong_arguments(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
    } bad[] = {
        {"return sphere()", "sphere takes 1 argument, not 0"},
        {"return sphere(1, 2)", "sphere takes 1 argument, not 2"},
        {"return sphere('1')", "sphere: argument 1 must be a positive number, not a string"},
        {"return sphere(0)", "must be a positive number, not 0.0"},
        {"return sphere(x)", "must be a positive number, not a field"},
        {"return sphere(1/0)", "must be a positive number, not inf"},
        {"return sphere(0/0)", "must be a positive number, not"},
        {"return box(1, 0, 1)", "box: argument 2 must be a positive number"},
        {"return box(1, 1)", "box takes 1 or 3 arguments, not 2"},
        {"return rounded_box(1, 1, 1, 0.6)", "half of the least size"},
        {"return rounded_box(1, 1, 1, -0.1)", "argument 4 must be a number of at least 0"},
        {"return torus(1)", "torus takes 2 arguments, not 1"},
        {"return torus(1, -1)", "torus: argument 2"},
        {"return cylinder(1, {})", "cylinder: argument 2 must be a positive number, not a table"},
        {"return capsule(-1, 1)", "capsule: argument 1"},
        {"return capsule(1, -1)", "capsule: argument 2"},
        {"return cone(0, 0, 1)", "one of the two radii"},
        {"return cone(1, -1, 1)", "cone: argument 2"},
        {"return cone(1, 1, 0)", "cone: argument 3"},
        {"return plane(0, 0, 0, 1)", "the normal must not be 0, 0, 0"},
        {"return plane(0, 1, 0)", "plane takes 4 arguments, not 3"},
        {"return plane(0, 1, 0, 1/0)", "plane: argument 4 must be a finite number"},
        {"return sin()", "sin takes 1 argument"},
        {"return sin('a')", "sin: argument 1 must be a field or a number, not a string"},
        {"return x:sin(1)", "sin takes 1 argument, not 2"},
        {"return atan2(x)", "atan2 takes 2 arguments, not 1"},
        {"return mod(x, nil)", "mod: argument 2 must be a field or a number, not a nil"},
        {"return min()", "min takes 1 to"},
        {"return min(x, {})", "min: argument 2"},
        {"return x + 'a'", "+: argument 2 must be a field or a number, not a string"},
        {"return {} * x", "*: argument 1 must be a field or a number, not a table"},
        {"return x + 0/0", "NaN"},
        {"return x ^ y", "^ takes a field and a whole number"},
        {"return x ^ 0.5", "^ takes a field and a whole number"},
        {"return 2 ^ x", "^ takes a field and a whole number"},
        {"return x ~ y", "a & ~b"},
        {"return x | 1", "|: argument 2 must be a field, not 1"},
        {"return 1 & x", "&: argument 1 must be a field, not 1"},
        {"return x < y", "compare(a, b)"},
        {"return x >= 1", "compare(a, b)"},
        {"return x .. 'a'", "attempt to concatenate a field value"},
        {"return x()", "attempt to call a field value"},
        {"return #x", "attempt to get length of a field value"},
        {"return union()", "union takes 1 to"},
        {"return union(x, 1)", "union: argument 2 must be a field, not 1"},
        {"return union({x, y})", "union: argument 1 must be a field, not a table"},
        {"return x:union(3)", "union: argument 1 must be a field, not 3"},
        {"return difference(1)", "difference: argument 1"},
        {"return complement(x, y)", "complement takes 1 argument, not 2"},
        {"return smooth_union(x, y)", "smooth_union takes 3 to 4 arguments, not 2"},
        {"return smooth_union(x, y, 0)", "smooth_union: argument 3 must be a positive number"},
        {"return smooth_union(x, y, 1, 'square')", "there is no blend 'square'"},
        {"return smooth_difference(x, y, 1, 2)", "smooth_difference: argument 4 must be a text"},
        {"return smooth_intersection(x, 1, 1)", "smooth_intersection: argument 2 must be a field"},
        {"return x:move(1, 2)", "translate takes 4 arguments, not 3"},
        {"return x:move(1, 'a', 3)", "translate: argument 2 must be a finite number, not a string"},
        {"return move(x, 1, 'a', 3)", "translate: argument 3 must be a finite number, not a string"},
        {"return move(1, 1, 1, 1)", "translate: argument 1 must be a field"},
        {"return x.move(1, 1, 1, 1)", "argument"},
        {"return x:rotate('w', 1)", "rotate: argument 1 must be \"x\", \"y\" or \"z\", not a string"},
        {"return x:rotate('x')", "rotate takes a shape"},
        {"return x:rotate(0, 0, 0, 1)", "the axis must not be 0, 0, 0"},
        {"return x:rotate_x()", "rotate_x takes 2 arguments, not 1"},
        {"return x:rotate_z('a')", "rotate_z: argument 1 must be a finite number"},
        {"return x:scale(0)", "scale: argument 1 must be a positive number"},
        {"return x:scale(1, 2)", "scale takes a shape and 1 or 3 factors"},
        {"return x:scale(1, 2, -3)", "scale: argument 3 must be a positive number"},
        {"return x:remap(1, 2)", "remap takes 4 arguments, not 3"},
        {"return x:remap(1, 2, 'a')", "remap: argument 3 must be a field or a number"},
        {"return bounds(1, 2, 3)", "bounds takes 6 arguments, not 3"},
        {"return bounds(0, 0, 0, 1, 0, 1)", "bounds: along y the lower end"},
        {"return bounds(0, 0, 0, 1, 1/0, 1)", "bounds: argument 5 must be a finite number"},
        {"return units('inch')", "there is no unit 'inch'; there are m, cm, mm"},
        {"return units(1)", "units: argument 1 must be a text"},
        {"return up('Z')", "there is no direction 'Z'"},
        {"return param('a')", "param takes 2 to 3 arguments"},
        {"return param('a b', 1)", "is no name"},
        {"return param('', 1)", "is no name"},
        {"return param('1a', 1)", "is no name"},
        {"return param('a', '1')", "param: argument 2 must be a finite number"},
        {"return param('a', 1, 2)", "param: argument 3 must be a table of options"},
        {"return param('a', 1, {mim = 2})", "there is no option 'mim'"},
        {"return param('a', 1, {'min'})", "there is no option"},
        {"return param('a', 1, {min = 'x'})", "min must be a number"},
        {"return param('a', 1, {integer = 1})", "integer must be true or false"},
        {"return param('a', 1, {help = 1})", "help must be a text"},
        {"return param('a', 1, {min = 3, max = 2})", "min is above max"},
        {"return param('a', 1, {min = 2, max = 3})", "the default, 1.0, is outside 2.0 to 3.0"},
        {"return param('a', 1, {min = 2})", "the default, 1.0, is below 2.0"},
        {"return param('a', 1, {max = 0})", "the default, 1.0, is above 0.0"},
        {"return param('a', 1.5, {integer = true})", "must be a whole number"},
        {"param('a', 1) return param('a', 2)", "declared twice"},
        {"param('a', 1) return param('a', 1, {max = 5})", "declared twice"},
    };
    for (size_t i = 0; i < COUNT(bad); i++)
        test_refused(bad[i].text, HEWN_SCENE_LUA, 1, bad[i].part);
}

/* --- what a scene declares -----------------------------------------------------------------------------------------
 */

static hewn_result load_set(const char *text, const hewn_scene_setting *settings, size_t count, hewn_scene **scene,
                            hewn_error *error)
{
    hewn_scene_desc desc = {
        .path = "scene.lua", .format = HEWN_SCENE_LUA, .settings = settings, .setting_count = count};
    *error = (hewn_error){0};
    return hewn_scene_load_text(&desc, text, strlen(text), scene, error);
}

static void test_parameters(void **state)
{
    (void)state;
    static const char text[] =
        "local n = param('n', 3, {min = 1, max = 5, integer = true, help = 'how many'})\n"
        "local r = param('r_2', 0.5)\nassert(math.type(n) == 'integer' and param('r_2', 0.5) == r)\n"
        "return sphere(n + r)";
    hewn_scene *scene;
    hewn_error error;
    assert_int_equal(load_set(text, NULL, 0, &scene, &error), HEWN_OK);
    assert_int_equal(hewn_scene_parameter_count(scene), 2);
    const hewn_scene_parameter *n = hewn_scene_parameter_at(scene, 0), *r = hewn_scene_parameter_at(scene, 1);
    assert_string_equal(n->name, "n");
    assert_string_equal(n->help, "how many");
    assert_true(n->initial == 3 && n->value == 3 && n->lo == 1 && n->hi == 5 && n->integer);
    assert_string_equal(r->name, "r_2");
    assert_null(r->help);
    assert_true(r->initial == 0.5 && r->value == 0.5 && isinf(r->lo) && isinf(r->hi) && !r->integer);
    assert_null(hewn_scene_parameter_at(scene, 2));
    assert_true(value_at(scene, 0, 0, 0) == -3.5);
    hewn_scene_destroy(&scene);

    const hewn_scene_setting set[] = {{"r_2", 0.25}, {"n", 5}};
    assert_int_equal(load_set(text, set, 2, &scene, &error), HEWN_OK);
    assert_true(value_at(scene, 0, 0, 0) == -5.25);
    assert_true(hewn_scene_parameter_at(scene, 0)->value == 5 && hewn_scene_parameter_at(scene, 0)->initial == 3);
    hewn_scene_destroy(&scene);
}

static void test_wrong_settings(void **state)
{
    (void)state;
    static const char text[] = "\nlocal n = param('n', 3, {min = 1, max = 5, integer = true})\n"
                               "return sphere(n + param('r', 0))";
    static const struct {
        hewn_scene_setting set[2];
        size_t count;
        uint32_t line;
        const char *part;
    } bad[] = {
        {{{"N", 1}}, 1, 0, "there is no parameter 'N'; the scene's parameters are: n, r"},
        {{{"n", 6}}, 1, 2, "parameter 'n': the value set, 6.0, is outside 1.0 to 5.0"},
        {{{"n", 0}}, 1, 2, "outside"},
        {{{"n", 2.5}}, 1, 2, "must be a whole number"},
        {{{"n", NAN}}, 1, 0, "not a finite number"},
        {{{"r", INFINITY}}, 1, 0, "not a finite number"},
        {{{"n", 2}, {"n", 3}}, 2, 0, "set twice"},
    };
    hewn_scene *scene;
    hewn_error error;
    for (size_t i = 0; i < COUNT(bad); i++) {
        assert_int_equal(load_set(text, bad[i].set, bad[i].count, &scene, &error), HEWN_BAD_INPUT);
        assert_null(scene);
        if (error.line != bad[i].line || !strstr(error.message, bad[i].part))
            fail_msg("line %u: %s\nexpected line %u: %s", error.line, error.message, bad[i].line, bad[i].part);
    }
    assert_int_equal(load_set("return x", bad[0].set, 1, &scene, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "parameters are: none"));
}

static void test_declarations(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double metres;
    } units[] = {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"um", 1e-6}, {"km", 1000}, {"in", 0.0254}, {"ft", 0.3048}};
    static const char *const ups[] = {"+Y", "+Z", "+X"};
    hewn_scene *scene = test_load_lua("return x");
    hewn_box box;
    assert_true(!hewn_scene_bounds(scene, &box) && hewn_scene_metres_per_unit(scene) == 1);
    assert_int_equal(hewn_scene_up(scene), HEWN_AXIS_PLUS_Y);
    hewn_scene_destroy(&scene);
    for (size_t i = 0; i < COUNT(units); i++) {
        char text[200];
        snprintf(text, sizeof text, "units('%s') up('%s') bounds(-1, -2, -3, 4, 5, 6) return x", units[i].name,
                 ups[i % 3]);
        scene = test_load_lua(text);
        assert_string_equal(hewn_scene_unit(scene)->name, units[i].name);
        assert_true(hewn_scene_metres_per_unit(scene) == units[i].metres);
        assert_int_equal(hewn_scene_up(scene), i % 3);
        assert_true(hewn_scene_bounds(scene, &box));
        for (int k = 0; k < 3; k++)
            assert_true(box.lo[k] == -1 - k && box.hi[k] == 4 + k);
        hewn_scene_destroy(&scene);
    }
}

/* --- the door ------------------------------------------------------------------------------------------------------
 */

static void test_loading(void **state)
{
    (void)state;
    hewn_scene *scene = (hewn_scene *)1;
    hewn_error error;
    assert_int_equal(load_path("absent.lua", false, &scene, &error), HEWN_IO);
    assert_null(scene);
    assert_non_null(strstr(error.file, "absent.lua"));
    test_write_text(folder, "scene.txt", "return x");
    assert_int_equal(load_path("scene.txt", false, &scene, &error), HEWN_INVALID_ARGUMENT);
    assert_non_null(strstr(error.message, ".lua or .vm"));
    test_write_text(folder, "noext", "return x");
    assert_int_equal(load_path("noext", false, &scene, &error), HEWN_INVALID_ARGUMENT);
    test_write_text(folder, "SCENE.LUA", "return x");
    scene = load_good("SCENE.LUA");
    hewn_scene_destroy(&scene);
    hewn_scene_destroy(&scene); /* nothing to do */
    hewn_scene_desc desc = {.path = "-"};
    assert_int_equal(hewn_scene_load(&desc, &scene, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_scene_load(&desc, &scene, NULL), HEWN_INVALID_ARGUMENT);
    desc.path = NULL;
    assert_int_equal(hewn_scene_load(&desc, &scene, &error), HEWN_INVALID_ARGUMENT);
    char path[600];
    snprintf(path, sizeof path, "%s/huge.vm", folder);
    test_write_text(folder, "huge.vm", "a var-x\n");
    assert_int_equal(truncate(path, ((off_t)64 << 20) + 1), 0);
    assert_int_equal(load_path("huge.vm", false, &scene, &error), HEWN_BAD_INPUT);
}

/* "-" reads standard input, and the scene's folder is then the current one. */
static void test_standard_input(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        hewn_scene_format format;
        double value;
    } scenes[] = {{"return import 'part.lua' + 1", HEWN_SCENE_LUA, -1}, {"a var-y\nb neg a", HEWN_SCENE_VM, -0.5}};
    char here[4096];
    assert_non_null(getcwd(here, sizeof here));
    test_write_text(folder, "part.lua", "return sphere(2.5)");
    assert_int_equal(chdir(folder), 0);
    int kept = dup(STDIN_FILENO);
    for (size_t i = 0; i < COUNT(scenes); i++) {
        test_write_text(folder, "input", scenes[i].text);
        assert_non_null(freopen("input", "rb", stdin));
        hewn_scene_desc desc = {.path = "-", .format = scenes[i].format};
        hewn_scene *scene;
        hewn_error error = {0};
        if (hewn_scene_load(&desc, &scene, &error) != HEWN_OK)
            fail_msg("%s:%u: %s", error.file, error.line, error.message);
        assert_true(value_at(scene, 0, 0.5, 0) == scenes[i].value);
        hewn_scene_destroy(&scene);
    }
    dup2(kept, STDIN_FILENO);
    close(kept);
    assert_int_equal(chdir(here), 0);
}

/* The scenes that are shipped: each loads, with the values that its formula gives. */
static void test_shipped(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double x, y, z, value;
    } scenes[] = {
        {"csg.lua", -0.6, 0, 0, -0.2}, /* in the ball, far from the cut and the ring */
        {"csg.lua", 0.5, 0.5, 0.5, 0.45},
        {"menger.lua", 0, 0, 0, 1.0 / 3},
        {"menger.lua", 1.2, 0.5, 0.5, 0.2},
        {"gyroid.lua", 0, 0, 0, -0.4},
        {"gyroid.lua", 1, 1, 1, 0.9583675430099355},
        {"bracket.lua", 0, 0, 80, 15},
        {"bracket.lua", 0, 0, -2, 2},
    };
    for (size_t i = 0; i < COUNT(scenes); i++) {
        char path[512];
        snprintf(path, sizeof path, "%s/assets/scenes/%s", test_source_root(), scenes[i].name);
        hewn_scene_desc desc = {.path = path};
        hewn_scene *scene;
        hewn_error error = {0};
        if (hewn_scene_load(&desc, &scene, &error) != HEWN_OK)
            fail_msg("%s:%u: %s", error.file, error.line, error.message);
        hewn_box box;
        assert_true(hewn_scene_bounds(scene, &box));
        double value = value_at(scene, scenes[i].x, scenes[i].y, scenes[i].z);
        if (!(fabs(value - scenes[i].value) < 1e-12))
            fail_msg("%s is %.17g at %g %g %g", scenes[i].name, value, scenes[i].x, scenes[i].y, scenes[i].z);
        hewn_scene_destroy(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_import, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_import_stays_inside, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_import_circles, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_error_places, make_folder, remove_folder),
        cmocka_unit_test(test_messages_are_clean),
        cmocka_unit_test(test_results),
        cmocka_unit_test(test_wrong_arguments),
        cmocka_unit_test(test_parameters),
        cmocka_unit_test(test_wrong_settings),
        cmocka_unit_test(test_declarations),
        cmocka_unit_test_setup_teardown(test_loading, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_standard_input, make_folder, remove_folder),
        cmocka_unit_test(test_shipped),
    };
    return cmocka_run_group_tests_name("scene_files", tests, NULL, NULL);
}
