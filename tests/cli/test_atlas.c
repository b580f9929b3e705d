/* `hewn atlas`: an image and JSON as msdf-atlas-gen writes it, both or none; characters that are missing are told. */
#include "json_read.h"
#include "png_read.h"

static char *folder;
static char font[4096];

static int open_folder(void **state)
{
    (void)state;
    folder = run_folder_create();
    snprintf(font, sizeof font, "%s", run_project_file("assets/scenes/fonts/DejaVuSerif-Bold.ttf"));
    return 0;
}

static int close_folder(void **state)
{
    (void)state;
    run_folder_destroy(folder);
    return 0;
}

static run_result atlas(int code, const char *const *more)
{
    run_desc desc = {.folder = folder, .arguments = {"atlas", font}};
    for (int i = 0; more[i]; i++)
        desc.arguments[2 + i] = more[i];
    return run_expecting(code, &desc);
}

#define ATLAS(code, ...) atlas(code, (const char *const[]){__VA_ARGS__, NULL})

static char *read_json(const char *name)
{
    char *text = run_read_file(run_path(folder, name), &(size_t){0});
    assert_true(json_is_valid(text));
    return text;
}

static double of_glyph(const char *text, size_t i, const char *what)
{
    char path[64];
    snprintf(path, sizeof path, "glyphs.%zu.%s", i, what);
    return json_number(text, path);
}

/* The number of a glyph; fails where it is missing. */
static size_t glyph(const char *text, unsigned character)
{
    for (size_t i = 0; i < json_count(text, "glyphs"); i++)
        if (of_glyph(text, i, "unicode") == character)
            return i;
    fail_msg("no glyph for U+%04X", character);
    return 0;
}

static void images_and_json(void **state)
{
    (void)state;
    static const char *const types[] = {"msdf", "sdf", "psdf", "mtsdf"};
    static const uint32_t channels[] = {3, 1, 1, 4};
    for (int i = 0; i < 4; i++) {
        run_result result = ATLAS(0, "-o", "a.png", "--json", "a.json", "--type", types[i], "--size", "24", "--range",
                                  "3", "--chars", "HA V.");
        run_result_destroy(&result);
        char *text = read_json("a.json");
        png image = read_png(run_path(folder, "a.png"));
        assert_string_equal(json_string(text, "atlas.type"), types[i]);
        assert_string_equal(json_string(text, "atlas.yOrigin"), "bottom");
        assert_true(json_number(text, "atlas.distanceRange") == 3 && json_number(text, "atlas.size") == 24);
        assert_true(json_number(text, "atlas.width") == image.width &&
                    json_number(text, "atlas.height") == image.height);
        assert_int_equal(image.channels, channels[i]);
        assert_int_equal(image.depth, 8);
        assert_true(json_number(text, "metrics.emSize") == 1 && json_number(text, "metrics.lineHeight") > 1);
        assert_true(json_number(text, "metrics.ascender") > 0.7 && json_number(text, "metrics.descender") < -0.1);
        assert_true(json_number(text, "metrics.underlineY") < 0);
        assert_true(json_number(text, "metrics.underlineThickness") > 0);
        assert_int_equal(json_count(text, "glyphs"), 5);
        assert_null(json_find(text, "glyphs.0.planeBounds")); /* the blank */
        assert_true(of_glyph(text, 0, "advance") > 0.3);
        /* the left stem of H, half way up: inside by half of the stem's width */
        size_t h = glyph(text, 'H');
        double left = of_glyph(text, h, "planeBounds.left"), right = of_glyph(text, h, "planeBounds.right");
        double u = of_glyph(text, h, "atlasBounds.left"), v = of_glyph(text, h, "atlasBounds.right");
        double x = u + (0.19 - left) / (right - left) * (v - u);
        double bottom = of_glyph(text, h, "planeBounds.bottom"), top = of_glyph(text, h, "planeBounds.top");
        double low = of_glyph(text, h, "atlasBounds.bottom"), high = of_glyph(text, h, "atlasBounds.top");
        double y = image.height - (low + (0.2 - bottom) / (top - bottom) * (high - low));
        assert_true(fabs((v - u) - 24 * (right - left)) < 1e-9 && fabs((high - low) - 24 * (top - bottom)) < 1e-9);
        assert_true(value_of(&image, (uint32_t)x, (uint32_t)y, channels[i] - 1) > 190);
        assert_true(value_of(&image, (uint32_t)u, (uint32_t)y, channels[i] - 1) < 64);
        bool found = false;
        for (size_t k = 0; k < json_count(text, "kerning"); k++) {
            char path[3][64];
            static const char *const names[3] = {"unicode1", "unicode2", "advance"};
            for (int n = 0; n < 3; n++)
                snprintf(path[n], sizeof path[n], "kerning.%zu.%s", k, names[n]);
            found = found || (json_number(text, path[0]) == 'A' && json_number(text, path[1]) == 'V' &&
                              json_number(text, path[2]) < -0.02);
        }
        assert_true(found);
        free(image.rows);
        free(text);
    }
}

static void y_from_the_top(void **state)
{
    (void)state;
    run_result result = ATLAS(0, "-o", "u.png", "--json", "u.json", "--chars", "Ag", "--no-kerning");
    run_result_destroy(&result);
    result = ATLAS(0, "-o", "d.png", "--json", "d.json", "--chars", "Ag", "--no-kerning", "--y-origin", "top");
    run_result_destroy(&result);
    char *up = read_json("u.json"), *down = read_json("d.json");
    run_assert_same_file(run_path(folder, "u.png"), run_path(folder, "d.png"));
    double height = json_number(up, "atlas.height");
    assert_string_equal(json_string(down, "atlas.yOrigin"), "top");
    assert_int_equal(json_count(down, "kerning"), 0);
    for (size_t i = 0; i < 2; i++) {
        static const char *const sides[2] = {"atlasBounds.bottom", "atlasBounds.top"}, *const planes[2] = {
                                                                                           "planeBounds.bottom",
                                                                                           "planeBounds.top"};
        for (int k = 0; k < 2; k++) {
            assert_true(of_glyph(down, i, sides[k]) == height - of_glyph(up, i, sides[k]));
            assert_true(of_glyph(down, i, planes[k]) == -of_glyph(up, i, planes[k]));
        }
    }
    assert_true(json_number(down, "metrics.ascender") == -json_number(up, "metrics.ascender"));
    free(up);
    free(down);
}

static void sets_of_characters(void **state)
{
    (void)state;
    run_write_file(run_path(folder, "set.txt"), "'A', [0x61, 0x63]\n\"xy\" 20320");
    run_write_file(run_path(folder, "text.txt"), "zA\n");
    run_result result = ATLAS(0, "-o", "s.png", "--json", "s.json", "--charset", "set.txt", "--chars", "@text.txt",
                              "--chars", "\xE6\xBC\xA2", "--dimensions", "pot");
    assert_non_null(strstr(result.err, "no glyph for 2 characters: U+4F60 U+6F22"));
    run_result_destroy(&result);
    char *text = read_json("s.json");
    static const unsigned wanted[] = {'A', 'a', 'b', 'c', 'x', 'y', 'z'};
    assert_int_equal(json_count(text, "glyphs"), 7);
    for (size_t i = 0; i < 7; i++)
        assert_int_equal((int)of_glyph(text, i, "unicode"), (int)wanted[i]);
    uint32_t width = (uint32_t)json_number(text, "atlas.width");
    assert_int_equal(width & (width - 1), 0);
    free(text);
    result = ATLAS(0, "-o", "-", "--json", "t.json"); /* ascii; the image to standard output */
    assert_memory_equal(result.out, "\x89PNG", 4);
    run_result_destroy(&result);
    text = read_json("t.json");
    assert_int_equal(json_count(text, "glyphs"), 95);
    free(text);
}

/* The same bytes on every run, for any number of threads. */
static void the_same_every_time(void **state)
{
    (void)state;
    run_desc desc = {.folder = folder,
                     .arguments = {"atlas", font, "-o", "1.png", "--json", "1.json", "--chars", "Rag&", "-q"},
                     .changes = {"OMP_NUM_THREADS=1"}};
    run_result result = run_expecting(0, &desc);
    assert_string_equal(result.err, "");
    run_result_destroy(&result);
    desc.arguments[3] = "2.png";
    desc.arguments[5] = "2.json";
    desc.changes[0] = "OMP_NUM_THREADS=3";
    result = run_expecting(0, &desc);
    run_result_destroy(&result);
    run_assert_same_file(run_path(folder, "1.png"), run_path(folder, "2.png"));
    run_assert_same_file(run_path(folder, "1.json"), run_path(folder, "2.json"));
}

/* Nothing is left behind, and files that were there stay. */
static void refused(int code, const char *says, const char *const *arguments)
{
    run_desc desc = {.folder = folder, .arguments = {"atlas"}};
    for (int i = 0; arguments[i]; i++)
        desc.arguments[1 + i] = arguments[i];
    int before = run_folder_count(folder);
    run_result result = run_expecting(code, &desc);
    if (!strstr(result.err, says))
        fail_msg("'%s' is missing in: %s", says, result.err);
    run_result_destroy(&result);
    assert_int_equal(run_folder_count(folder), before);
}

#define REFUSED(code, says, ...) refused(code, says, (const char *const[]){__VA_ARGS__, NULL})

static void refusals(void **state)
{
    (void)state;
    run_write_file(run_path(folder, "bad.txt"), "65\n66 zz\n");
    run_write_file(run_path(folder, "no.ttf"), "no font at all");
    run_subfolder(folder, "sub");
    REFUSED(2, "which font", "-o", "x.png");
    REFUSED(2, "-o FILE", font);
    REFUSED(2, "--type is", font, "-o", "x.png", "--type", "ssdf");
    REFUSED(2, "--size is 1 to 4096", font, "-o", "x.png", "--size", "0");
    REFUSED(2, "--range is", font, "-o", "x.png", "--range", "1e9");
    REFUSED(2, "--y-origin", font, "-o", "x.png", "--y-origin", "left");
    REFUSED(2, "empty", font, "-o", "x.png", "--chars", "");
    REFUSED(2, "byte 2", font, "-o", "x.png", "--chars", "a\xFF");
    REFUSED(2, "standard output", font, "-o", "-", "--json", "-");
    REFUSED(2, "same file", font, "-o", "x.png", "--json", "x.png");
    REFUSED(3, "bad.txt:2: ", font, "-o", "x.png", "--charset", "bad.txt");
    REFUSED(3, "gone.txt: ", font, "-o", "x.png", "--charset", "gone.txt");
    REFUSED(3, "no.ttf: ", "no.ttf", "-o", "x.png", "--json", "x.json");
    REFUSED(3, "gone.ttf: ", "gone.ttf", "-o", "x.png");
    REFUSED(3, "none of the 1", font, "-o", "x.png", "--json", "x.json", "--chars", "\xE6\xBC\xA2");
    REFUSED(1, "do not fit", font, "-o", "x.png", "--json", "x.json", "--dimensions", "64x64");
    REFUSED(1, "sub: ", font, "-o", "x.png", "--json", "sub");
    REFUSED(1, "none/x.png", font, "-o", "none/x.png", "--json", "x.json");
}

/* A disk that is full before the second file is complete: neither appears. */
static void both_or_none(void **state)
{
    (void)state;
    int before = run_folder_count(folder);
    run_desc desc = {.folder = folder,
                     .arguments = {"atlas", font, "-o", "f.png", "--json", "f.json", "--type", "sdf", "--size", "8"},
                     .file_limit = 20000};
    run_result result = run_expecting(1, &desc); /* the JSON is longer than that, the image is not */
    assert_non_null(strstr(result.err, "f.json"));
    run_result_destroy(&result);
    assert_int_equal(run_folder_count(folder), before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(images_and_json),     cmocka_unit_test(y_from_the_top), cmocka_unit_test(sets_of_characters),
        cmocka_unit_test(the_same_every_time), cmocka_unit_test(refusals),       cmocka_unit_test(both_or_none),
    };
    return cmocka_run_group_tests_name("atlas", tests, open_folder, close_folder);
}
