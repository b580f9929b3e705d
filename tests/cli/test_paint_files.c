/* Colours and labels of scenes in files: the right numbers for each format, through simplification, and in pictures. */
#include <math.h>

#include "json_read.h"
#include "run.h"

/* A red ball and a blue one whose labels are 3 and 5; between them a fillet. */
static const char scene[] = "local a = sphere(0.5):color('#ff0000'):label(3)\n"
                            "local b = sphere(0.5):color(0, 0, 1):label(5):move(0.8, 0, 0)\n"
                            "return smooth_union(a, b, 0.3)\n";

static char *make(const char *text, const char *name, const char *more, const char *value)
{
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), text);
    run_result result = run_expecting(
        0, &(run_desc){.arguments = {"mesh", "s.lua", "-o", name, "--res", "24", more, value}, .folder = folder});
    run_result_destroy(&result);
    return folder;
}

typedef struct vertex {
    double x, color[3];
} vertex;

/* Positions and colours of an OBJ file that Hewn wrote. */
static size_t read_obj(const char *path, vertex *out, size_t most)
{
    char *text = run_read_file(path, NULL);
    size_t count = 0;
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        double y, z;
        vertex v;
        if (sscanf(line, "v %lf %lf %lf %lf %lf %lf", &v.x, &y, &z, &v.color[0], &v.color[1], &v.color[2]) != 6)
            continue;
        assert_true(count < most);
        out[count++] = v;
    }
    free(text);
    return count;
}

static void check_colors(const vertex *vertices, size_t count)
{
    int mixed = 0;
    assert_true(count > 20);
    for (size_t i = 0; i < count; i++) {
        const vertex *v = &vertices[i];
        assert_true(v->color[1] == 0);
        if (v->x < 0.1)
            assert_true(v->color[0] == 1 && v->color[2] == 0);
        if (v->x > 0.7)
            assert_true(v->color[0] == 0 && v->color[2] == 1);
        mixed += v->color[0] > 0.3 && v->color[2] > 0.3;
        if (fabs(v->x - 0.4) < 1e-6) /* halfway, in linear light: 188 of 255 on a screen */
            assert_true(fabs(v->color[0] - 188.0 / 255) < 0.02 && fabs(v->color[2] - 188.0 / 255) < 0.02);
    }
    assert_true(mixed > 3);
}

static void colors_are_srgb_in_obj(void **state)
{
    (void)state;
    enum { MOST = 20000 };
    static vertex vertices[MOST];
    char *folder = make(scene, "a.obj", NULL, NULL);
    check_colors(vertices, read_obj(run_path(folder, "a.obj"), vertices, MOST));
    run_folder_destroy(folder);
}

static double number_of(const char *json, const char *name)
{
    return json_number(json, name);
}

/* The attributes as `hewn info --json` sees them, of a file that has been read again. */
static char *describe(const char *folder, const char *name)
{
    run_result result = run_expecting(0, &(run_desc){.arguments = {"info", name, "--json"}, .folder = folder});
    char *out = strdup(result.out);
    run_result_destroy(&result);
    return out;
}

static void labels_and_colors_in_ply_and_glb(void **state)
{
    (void)state;
    static const char *const names[] = {"a.ply", "a.glb"};
    for (int i = 0; i < 2; i++) {
        char *folder = make(scene, names[i], NULL, NULL), *json = describe(folder, names[i]);
        assert_non_null(strstr(json, "color"));
        assert_non_null(strstr(json, "label"));
        assert_true(number_of(json, "counts.vertices") > 100);
        free(json);
        run_folder_destroy(folder);
    }
    /* glTF's colours are linear: what is half of the light is 0.5 there and 188 elsewhere */
    char *folder = make("return sphere(1):color('#bcbcbc')", "a.glb", NULL, NULL);
    size_t length;
    char *bytes = run_read_file(run_path(folder, "a.glb"), &length);
    const float wanted = 0.5028865F;
    size_t found = 0;
    for (size_t i = 0; i + 4 <= length; i += 4) {
        float value;
        memcpy(&value, bytes + i, 4);
        found += fabsf(value - wanted) < 1e-6F;
    }
    assert_true(found > 300);
    free(bytes);
    run_folder_destroy(folder);
}

static void simplification_takes_them_along(void **state)
{
    (void)state;
    enum { MOST = 20000 };
    static vertex vertices[MOST];
    char *folder = make(scene, "a.obj", "--simplify", "ratio:0.3");
    size_t count = read_obj(run_path(folder, "a.obj"), vertices, MOST);
    assert_true(count > 20 && count < 1200);
    for (size_t i = 0; i < count; i++) {
        if (vertices[i].x < 0)
            assert_true(vertices[i].color[0] > 0.97 && vertices[i].color[2] < 0.25);
        if (vertices[i].x > 0.8)
            assert_true(vertices[i].color[2] > 0.97 && vertices[i].color[0] < 0.25);
    }
    run_folder_destroy(folder);
}

static void bare_scenes_stay_bare(void **state)
{
    (void)state;
    char *folder = make("return sphere(1)", "a.obj", NULL, NULL);
    vertex none[1];
    assert_int_equal(read_obj(run_path(folder, "a.obj"), none, 1), 0);
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colors_are_srgb_in_obj),
        cmocka_unit_test(labels_and_colors_in_ply_and_glb),
        cmocka_unit_test(simplification_takes_them_along),
        cmocka_unit_test(bare_scenes_stay_bare),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
