/* docs/scene.md is exact: every example in it runs, and its tables have the names that there are, no more and no less.
 */
#include "test_scene.h"

#include "field/catalogue.h"

static char *read_document(void)
{
    char path[512];
    size_t length;
    snprintf(path, sizeof path, "%s/docs/scene.md", test_source_root());
    char *text = test_read(path, &length);
    assert_non_null(text);
    return text;
}

/* The font that examples name. */
static void copy_font(const char *folder)
{
    char path[512];
    size_t length = 0;
    snprintf(path, sizeof path, "%s/assets/scenes/fonts/DejaVuSerif-Bold.ttf", test_source_root());
    char *bytes = test_read(path, &length);
    assert_non_null(bytes);
    test_write(folder, "letters.ttf", bytes, length);
    free(bytes);
}

/* Runs each block between ``` lines. One that begins with "-- name.lua" is a file beside those after it. */
static void test_examples_run(void **state)
{
    (void)state;
    char folder[64], *text = read_document();
    int lua = 0, vm = 0;
    test_make_folder(folder);
    copy_font(folder);
    for (char *at = text; (at = strstr(at, "\n```")) != NULL;) {
        at += 4;
        bool is_lua = strncmp(at, "lua\n", 4) == 0, is_vm = strncmp(at, "vm\n", 3) == 0;
        if (!is_lua && !is_vm)
            fail_msg("a block in docs/scene.md is neither lua nor vm: %.20s", at);
        char *begin = strchr(at, '\n') + 1, *end = strstr(begin, "\n```");
        assert_non_null(end);
        size_t length = (size_t)(end - begin) + 1;
        char name[64] = "scene.lua", path[256];
        if (is_vm)
            snprintf(name, sizeof name, "scene.vm");
        else if (sscanf(begin, "-- %60[a-z].lua\n", name) == 1)
            strcat(name, ".lua");
        else
            snprintf(name, sizeof name, "scene.lua");
        test_write(folder, name, begin, length);
        at = end + 4;
        lua += is_lua;
        vm += is_vm;
        if (strncmp(name, "scene.", 6) != 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, name);
        hewn_scene_desc desc = {.path = path};
        hewn_scene *scene;
        hewn_error error = {0};
        if (hewn_scene_load(&desc, &scene, &error) != HEWN_OK)
            fail_msg("%.*s\n%s:%u: %s", (int)length, begin, error.file, error.line, error.message);
        double values[TEST_POINTS];
        test_values(scene, values);
        for (int i = 0; i < TEST_POINTS; i++)
            assert_false(isnan(values[i]));
        hewn_scene_destroy(&scene);
    }
    assert_true(lua >= 10 && vm == 1);
    test_remove_folder(folder);
    free(text);
}

/* The names of functions that begin a row of a table: "| `name(". Appends " name" for each. */
static void list_functions(const char *text, char *names, size_t capacity)
{
    size_t used = 1;
    snprintf(names, capacity, " ");
    for (const char *at = text; (at = strstr(at, "\n| `")) != NULL; at += 4) {
        size_t length = strspn(at + 4, "abcdefghijklmnopqrstuvwxyz_0123456789");
        if (length == 0 || at[4 + length] != '(')
            continue;
        assert_true(used + length + 2 < capacity);
        used += (size_t)snprintf(names + used, capacity - used, "%.*s ", (int)length, at + 4);
    }
}

static void test_every_function_has_a_row(void **state)
{
    (void)state;
    static const char lua_names[] = " assert error getmetatable ipairs next pairs pcall print rawequal rawget rawlen "
                                    "rawset select setmetatable tonumber tostring type xpcall _G _VERSION math string "
                                    "table utf8 x y z ";
    char *text = read_document(), names[8192], script[16384];
    list_functions(text, names, sizeof names);
    /* Each row is a global function; each global is a row, or one of Lua's own; each of Lua's own is in the text. */
    snprintf(script, sizeof script,
             "local rows, own = '%s', '%s'\n"
             "local count = 0\n"
             "for name in rows:gmatch('%%S+') do count = count + 1 assert(type(_G[name]) == 'function', name) end\n"
             "assert(count > 45, count)\n"
             "for name in own:gmatch('%%S+') do assert(_G[name] ~= nil, name) end\n"
             "for name in pairs(_G) do\n"
             "    local word = ' ' .. name .. ' '\n"
             "    assert(rows:find(word, 1, true) or own:find(word, 1, true), name)\n"
             "end\n"
             "return x",
             names, lua_names);
    hewn_scene *scene = test_load_lua(script);
    hewn_scene_destroy(&scene);
    char list[sizeof lua_names];
    memcpy(list, lua_names, sizeof list);
    for (char *name = strtok(list, " "); name; name = strtok(NULL, " ")) {
        char quoted[64];
        snprintf(quoted, sizeof quoted, "`%s`", name);
        if (!strstr(text, quoted))
            fail_msg("docs/scene.md does not name %s", name);
    }
    free(text);
}

/* What the text says are functions and methods are both. */
static void test_methods_are_as_told(void **state)
{
    (void)state;
    static const char *const chapters[] = {"## Fields and numbers", "## Combining", "## Moving"};
    char *text = read_document(), names[8192], script[16384];
    for (size_t i = 0; i < 3; i++) {
        char *begin = strstr(text, chapters[i]);
        assert_non_null(begin);
        char *end = strstr(begin + 3, "\n## ");
        assert_non_null(end);
        *end = '\0';
        list_functions(begin, names, sizeof names);
        *end = '\n';
        assert_true(strlen(names) > 20);
        snprintf(script, sizeof script,
                 "for name in ('%s'):gmatch('%%S+') do assert(x[name] == _G[name], name) end return x", names);
        hewn_scene *scene = test_load_lua(script);
        hewn_scene_destroy(&scene);
    }
    free(text);
    test_refused("return x:sphere(1)", HEWN_SCENE_LUA, 1, "a field has no method 'sphere'");
}

/* The tables are those of the catalogue, word for word (`./dev docs` writes them). */
static void test_tables_are_the_catalogue(void **state)
{
    (void)state;
    char *text = read_document();
    for (int section = 0; section < HEWN_SECTIONS; section++) {
        hewn_text table = {0};
        const char *name = hewn_section_name((hewn_section)section);
        hewn_text_print(&table, "<!-- table: %s -->\n", name);
        hewn_catalogue_write((hewn_section)section, &table);
        hewn_text_append(&table, "<!-- end -->\n");
        assert_false(table.failed);
        if (!strstr(text, table.bytes))
            fail_msg("the table of %s in docs/scene.md is not that of src/field/catalogue.c: run ./dev docs", name);
        hewn_text_clear(&table);
    }
    free(text);
}

/* Each function of the tables has a picture, and a scene that it is drawn from; no scene is of none. */
static void test_every_function_has_a_picture(void **state)
{
    (void)state;
    char path[512], line[80];
    size_t length, scenes = 0;
    snprintf(path, sizeof path, "%s/docs/pictures/examples.txt", test_source_root());
    char *examples = test_read(path, &length);
    assert_non_null(examples);
    for (size_t i = 0; i < hewn_function_count; i++) {
        snprintf(path, sizeof path, "%s/docs/pictures/%s.png", test_source_root(), hewn_functions[i].name);
        char *picture = test_read(path, &length);
        if (!picture || length < 1000 || memcmp(picture, "\x89PNG", 4) != 0)
            fail_msg("%s is no picture; ./dev docs draws it", path);
        free(picture);
        snprintf(line, sizeof line, "\n%s: ", hewn_functions[i].name);
        if (!strstr(examples, line))
            fail_msg("docs/pictures/examples.txt has no line for %s", hewn_functions[i].name);
    }
    for (const char *at = examples; (at = strchr(at, '\n')) != NULL && at[1]; at++)
        scenes += at[1] != '#';
    assert_int_equal(scenes, hewn_function_count);
    free(examples);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tables_are_the_catalogue),
        cmocka_unit_test(test_every_function_has_a_picture),
        cmocka_unit_test(test_examples_run),
        cmocka_unit_test(test_every_function_has_a_row),
        cmocka_unit_test(test_methods_are_as_told),
    };
    return cmocka_run_group_tests_name("scene_docs", tests, NULL, NULL);
}
