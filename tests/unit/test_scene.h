/* What the tests of scenes share: loading a text, comparing fields, folders that vanish again. */
#ifndef HEWN_TEST_SCENE_H
#define HEWN_TEST_SCENE_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "hewn/scene.h"
#include "scene/scene.h"

enum { TEST_POINTS = 64 };

/* The same points on every run, in the cube of +-2. */
static inline void test_points(double *points)
{
    uint64_t state = 0x9E3779B97F4A7C15u;
    for (int i = 0; i < 3 * TEST_POINTS; i++) {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        points[i] = 4 * ((double)(state >> 11) * 0x1p-53) - 2;
    }
}

static inline hewn_result test_load(const char *text, hewn_scene_format format, hewn_scene **scene, hewn_error *error)
{
    hewn_scene_desc desc = {.path = format == HEWN_SCENE_VM ? "scene.vm" : "scene.lua", .format = format};
    return hewn_scene_load_text(&desc, text, strlen(text), scene, error);
}

/* Loads a Lua text that must be good. */
static inline hewn_scene *test_load_lua(const char *text)
{
    hewn_scene *scene;
    hewn_error error = {0};
    if (test_load(text, HEWN_SCENE_LUA, &scene, &error) != HEWN_OK)
        fail_msg("%s\n%s:%u: %s", text, error.file, error.line, error.message);
    return scene;
}

/* Loads a text that must fail on `line` with a message that has `part` in it. */
static inline void test_refused(const char *text, hewn_scene_format format, uint32_t line, const char *part)
{
    hewn_scene *scene = (hewn_scene *)1;
    hewn_error error = {0};
    hewn_result result = test_load(text, format, &scene, &error);
    if (result != HEWN_BAD_INPUT || scene != NULL || error.code != result || error.line != line ||
        !strstr(error.message, part) || strncmp(error.file, "scene.", 6) != 0)
        fail_msg("%.200s\ngave %s, %s:%u: %s\nexpected line %u: ...%s...", text, hewn_result_name(result), error.file,
                 error.line, error.message, line, part);
}

/* The root's values at the test's points. */
static inline void test_values(const hewn_scene *scene, double *values)
{
    double points[3 * TEST_POINTS];
    const hewn_field *field = hewn_scene_field(scene);
    test_points(points);
    assert_int_equal(hewn_field_eval(field, hewn_field_root(field), points, TEST_POINTS, values, NULL), HEWN_OK);
}

/* Whether a Lua text and a node have the same bits at every test point (or both NaN). */
static inline void test_same(const char *text, const hewn_field *field, hewn_node node)
{
    double points[3 * TEST_POINTS], expected[TEST_POINTS], got[TEST_POINTS];
    hewn_scene *scene = test_load_lua(text);
    test_points(points);
    assert_false(hewn_node_is_none(node));
    assert_int_equal(hewn_field_eval(field, node, points, TEST_POINTS, expected, NULL), HEWN_OK);
    test_values(scene, got);
    for (int i = 0; i < TEST_POINTS; i++)
        if (!(got[i] == expected[i] || (isnan(got[i]) && isnan(expected[i]))))
            fail_msg("%s\nat %g %g %g is %.17g, not %.17g", text, points[3 * i], points[3 * i + 1], points[3 * i + 2],
                     got[i], expected[i]);
    hewn_scene_destroy(&scene);
    assert_null(scene);
}

/* --- files ---------------------------------------------------------------------------------------------------------
 */

static inline void test_make_folder(char folder[64])
{
    snprintf(folder, 64, "/tmp/hewn-scene-XXXXXX");
    assert_non_null(mkdtemp(folder));
}

static inline void test_write(const char *folder, const char *name, const void *bytes, size_t length)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

static inline void test_write_text(const char *folder, const char *name, const char *text)
{
    test_write(folder, name, text, strlen(text));
}

static inline void test_remove_folder(const char *folder)
{
    char command[128];
    assert_int_equal(strncmp(folder, "/tmp/hewn-scene-", 16), 0);
    snprintf(command, sizeof command, "rm -rf -- '%s'", folder);
    assert_int_equal(system(command), 0);
}

static inline char *test_read(const char *path, size_t *length)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    struct stat status;
    assert_int_equal(fstat(fileno(file), &status), 0);
    char *text = calloc((size_t)status.st_size + 1, 1);
    assert_non_null(text);
    *length = fread(text, 1, (size_t)status.st_size, file);
    assert_int_equal(*length, status.st_size);
    fclose(file);
    return text;
}

static inline const char *test_source_root(void)
{
    const char *root = getenv("HEWN_SOURCE");
    return root ? root : ".";
}

#endif
