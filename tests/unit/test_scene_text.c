/* text() in scenes: the same as from C, fonts found beside the scene, and messages that say what is wrong. */
#include "test_scene.h"

#include "hewn/font.h"

#define FONT "fonts/DejaVuSerif-Bold.ttf"

static hewn_result load(const char *text, bool allow, hewn_scene **out, hewn_error *error)
{
    char path[4096];
    const char *folder = getenv("HEWN_SOURCE");
    snprintf(path, sizeof path, "%s/assets/scenes/made.lua", folder ? folder : ".");
    const hewn_scene_desc desc = {.path = path, .allow_path = allow};
    return hewn_scene_load_text(&desc, text, strlen(text), out, error);
}

static void the_same_as_from_c(void **state)
{
    (void)state;
    hewn_scene *scene;
    hewn_error error = {0};
    char path[4096];
    const char *folder = getenv("HEWN_SOURCE");
    if (load("local words = text('Ad\\nAV', '" FONT "', 1.5, {align = 'center', anchor = 'middle', spacing = 0.1,\n"
             "  line_spacing = 0.9, kerning = false, face = 1})\n"
             "return words | text('o', '" FONT "', 1)",
             false, &scene, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    hewn_font *font;
    snprintf(path, sizeof path, "%s/assets/scenes/" FONT, folder ? folder : ".");
    assert_int_equal(hewn_font_open(path, 0, &font, NULL), HEWN_OK);
    hewn_field *field;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    const hewn_text_desc desc = {.size = 1.5,
                                 .align = HEWN_ALIGN_CENTER,
                                 .anchor = HEWN_TEXT_MIDDLE,
                                 .spacing = 0.1,
                                 .line_spacing = 0.9,
                                 .no_kerning = true};
    hewn_node node = hewn_union(field, hewn_font_text(field, font, "Ad\nAV", &desc),
                                hewn_font_text(field, font, "o", &(hewn_text_desc){.size = 1}));
    double points[3 * TEST_POINTS], expected[TEST_POINTS], got[TEST_POINTS];
    test_points(points);
    test_values(scene, got);
    assert_int_equal(hewn_field_eval(field, node, points, TEST_POINTS, expected, NULL), HEWN_OK);
    assert_memory_equal(got, expected, sizeof got);
    assert_int_equal(hewn_scene_file_count(scene), 2); /* the scene and its font */
    hewn_font_destroy(&font);
    hewn_field_destroy(&field);
    hewn_scene_destroy(&scene);
}

static void refused(const char *text, const char *part)
{
    hewn_scene *scene;
    hewn_error error = {0};
    hewn_result result = load(text, false, &scene, &error);
    if (result != HEWN_BAD_INPUT || error.line != 1 || !strstr(error.message, part))
        fail_msg("%s\ngave %s, line %u: %s", text, hewn_result_name(result), error.line, error.message);
}

static void messages(void **state)
{
    (void)state;
    refused("return text('A')", "text takes 3 to 4 arguments");
    refused("return text(5, '" FONT "', 1)", "argument 1 must be a text");
    refused("return text('A', '" FONT "', -1)", "argument 3 must be a positive number");
    refused("return text('A', '" FONT "', 1, 2)", "argument 4 must be a table of options");
    refused("return text('A', '" FONT "', 1, {alig = 'left'})", "no option 'alig'");
    refused("return text('A', '" FONT "', 1, {align = 'middle'})", "align must be");
    refused("return text('A', '" FONT "', 1, {1})", "options have names");
    refused("return text('A', '" FONT "', 1, {kerning = 1})", "kerning must be true or false");
    refused("return text('A', '" FONT "', 1, {face = 2})", "it has no such face");
    refused("return text('A', 'fonts/none.ttf', 1)", "cannot find 'fonts/none.ttf'");
    refused("return text('A', 'gear.lua', 1)", "'gear.lua': not a font that can be read");
    refused("return text('A', '/etc/hostname', 1)", "absolute path");
    refused("return text('A', '../../README.md', 1)", "outside the scene's folder");
    refused("return text('\\u{6F22}', '" FONT "', 1)", "no glyph for");
    refused("return text('', '" FONT "', 1)", "nothing to see");
}

/* The fonts' paths are those of the file that says them; outside only where that is allowed. */
static void other_folders(void **state)
{
    (void)state;
    hewn_scene *scene;
    assert_int_equal(load("return text('A', '../../tests/fuzz/seeds_font/sans.ttf', 1)", true, &scene, NULL), HEWN_OK);
    hewn_scene_destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_as_from_c),
        cmocka_unit_test(messages),
        cmocka_unit_test(other_folders),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
