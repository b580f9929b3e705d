/* hewn lod: levels as one GLB file and as separate ones, progressive meshes and what is taken from them. */
#include <math.h>

#include "mesh_files.h"

/* A ball of rings, with colours: 2 n (n - 1) triangles. */
static void write_ball(const char *path, int n)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face %d\n"
            "property list uchar int vertex_indices\nend_header\n",
            n * (n - 1) + 2, 2 * n * (n - 1));
    for (int ring = 1; ring < n; ring++)
        for (int i = 0; i < n; i++) {
            const double up = M_PI * ring / n, around = 2 * M_PI * i / n;
            fprintf(file, "%.17g %.17g %.17g %d 0 0\n", sin(up) * cos(around), sin(up) * sin(around), cos(up),
                    i < n / 2 ? 255 : 0);
        }
    fprintf(file, "0 0 1 255 0 0\n0 0 -1 0 255 0\n");
    for (int i = 0; i < n; i++)
        fprintf(file, "3 %d %d %d\n3 %d %d %d\n", n * (n - 1), i, (i + 1) % n, n * (n - 1) + 1,
                (n - 2) * n + (i + 1) % n, (n - 2) * n + i);
    for (int ring = 0; ring + 2 < n; ring++)
        for (int i = 0; i < n; i++) {
            const int a = ring * n + i, b = ring * n + (i + 1) % n;
            fprintf(file, "3 %d %d %d\n3 %d %d %d\n", a, a + n, b + n, a, b + n, b);
        }
    fclose(file);
}

static char *make_ball_folder(void)
{
    char *folder = run_folder_create();
    write_ball(run_path(folder, "ball.ply"), 40);
    return folder;
}

/* The JSON chunk of a GLB file; the caller frees it. */
static char *json_of_glb(const char *folder, const char *name)
{
    size_t length;
    char *bytes = run_read_file(run_path(folder, name), &length);
    uint32_t size;
    assert_true(length > 20);
    memcpy(&size, bytes + 12, sizeof size);
    char *json = strndup(bytes + 20, size);
    free(bytes);
    assert_true(json_is_valid(json));
    return json;
}

static double level_number(const char *report, int level, const char *name)
{
    char path[64];
    snprintf(path, sizeof path, "levels.%d.%s", level, name);
    return json_number(report, path);
}

/* --- levels ------------------------------------------------------------------------------------------------------- */

static void test_levels_in_one_file(void **state)
{
    (void)state;
    char *folder = make_ball_folder();
    char *report =
        report_of(folder, (run_desc){.arguments = {"lod", "ball.ply", "-o", "ball.glb", "--levels", "1,0.5,0.2,0.05"}});
    char *json = json_of_glb(folder, "ball.glb");
    assert_int_equal(json_count(report, "levels"), 4);
    assert_int_equal(json_count(json, "nodes"), 4);
    assert_int_equal(json_count(json, "meshes"), 4);
    assert_int_equal(json_count(json, "scenes.0.nodes"), 1);
    assert_int_equal(json_count(json, "nodes.0.extensions.MSFT_lod.ids"), 3);
    assert_has(json, "\"MSFT_lod\"");
    for (int i = 0; i < 4; i++) {
        char path[96];
        static const double ratios[] = {1, 0.5, 0.2, 0.05};
        const double triangles = level_number(report, i, "triangles"), all = json_number(report, "counts_before.faces");
        assert_true(triangles <= ratios[i] * all && triangles > ratios[i] * all - 4);
        assert_true(level_number(report, i, "error") >= level_number(report, i, "error_low"));
        assert_true(i == 0 || level_number(report, i, "error") > level_number(report, i - 1, "error"));
        snprintf(path, sizeof path, "nodes.0.extras.MSFT_screencoverage.%d", i);
        assert_true(json_number(json, path) == level_number(report, i, "screen_coverage"));
        if (i < 3) { /* there the next level's error is a line of 1080 */
            const double size = level_number(report, i, "screen_coverage") * 1080;
            const double shown = level_number(report, i + 1, "error") / json_number(report, "diagonal") * size;
            assert_true(fabs(shown - 1) < 1e-9 || (shown < 1 && size == 1080));
        }
        snprintf(path, sizeof path, "meshes.%d.primitives.0.attributes.POSITION", i);
        const int accessor = (int)json_number(json, path);
        snprintf(path, sizeof path, "accessors.%d.count", accessor);
        assert_true(json_number(json, path) == level_number(report, i, "vertices"));
        snprintf(path, sizeof path, "meshes.%d.primitives.0.attributes.COLOR_0", i);
        assert_true(json_find(json, path) != NULL);
    }
    free(json);
    free(report);
    char *info = info_of(folder, "ball.glb"); /* readers that know no levels see the first */
    assert_true(json_number(info, "counts.faces") == 3120);
    free(info);
    run_folder_destroy(folder);
}

/* Each file is as near as the report says, by a measure of its own. */
static void test_levels_in_separate_files(void **state)
{
    (void)state;
    char *folder = make_ball_folder();
    char *report =
        report_of(folder, (run_desc){.arguments = {"lod", "ball.ply", "-o", "l{level}.off", "--errors", "0,0.01,0.1"}});
    static const double allowed[] = {0, 0.01, 0.1};
    for (int i = 0; i < 3; i++) {
        char name[16];
        snprintf(name, sizeof name, "l%d.off", i);
        assert_true(level_number(report, i, "error") <= allowed[i]);
        run_result result = run_in(0, folder,
                                   (run_desc){.arguments = {"check", name, "--against", "ball.ply", "--json",
                                                            "--require", "closed,manifold,oriented,one-component"}});
        assert_true(json_number(result.out, "distance.low") <= level_number(report, i, "error") + 1e-12);
        assert_true(json_number(result.out, "distance.high") >= level_number(report, i, "error_low"));
        run_result_destroy(&result);
    }
    assert_true(level_number(report, 2, "triangles") < level_number(report, 1, "triangles"));
    free(report);
    run_folder_destroy(folder);
}

/* The same bytes by one thread and by three. */
static void test_threads_change_nothing(void **state)
{
    (void)state;
    char *folder = make_ball_folder();
    static const char *const outputs[][2] = {{"a.glb", "b.glb"}, {"a.hpm", "b.hpm"}};
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) {
            run_desc desc = {.arguments = {"lod", "ball.ply", "-o", outputs[i][k], "-q"}, .folder = folder};
            desc.changes[0] = k == 0 ? "OMP_NUM_THREADS=1" : "OMP_NUM_THREADS=3";
            run_result result = run_expecting(0, &desc);
            run_result_destroy(&result);
        }
    }
    assert_same_files(folder, "a.hpm", "b.hpm");
    char *a = json_of_glb(folder, "a.glb"), *b = json_of_glb(folder, "b.glb");
    assert_int_equal(strlen(a), strlen(b)); /* but for the name of the object, which is that of the file */
    free(a);
    free(b);
    size_t a_length, b_length;
    char *one = run_read_file(run_path(folder, "a.glb"), &a_length);
    char *two = run_read_file(run_path(folder, "b.glb"), &b_length);
    uint32_t json;
    memcpy(&json, one + 12, sizeof json);
    assert_int_equal(a_length, b_length);
    assert_memory_equal(one + 20 + json, two + 20 + json, a_length - 20 - json);
    free(one);
    free(two);
    run_folder_destroy(folder);
}

/* --- progressive meshes ------------------------------------------------------------------------------------------- */

static void test_a_progressive_mesh_gives_the_input_back(void **state)
{
    (void)state;
    char *folder = make_ball_folder();
    run_write_file(run_path(folder, "box.obj"), box_obj);
    static const char *const files[][3] = {{"ball.ply", "ball.hpm", "ply"}, {"box.obj", "box.hpm", "obj"}};
    for (int i = 0; i < 2; i++) {
        char *report = report_of(folder, (run_desc){.arguments = {"lod", files[i][0], "-o", files[i][1]}});
        assert_true(json_bool(report, "progressive.complete"));
        assert_true(json_number(report, "progressive.base_vertices") + json_number(report, "progressive.splits") ==
                    json_number(report, "progressive.vertices"));
        free(report);
        run_result one =
            run_in(0, folder, (run_desc){.arguments = {"convert", files[i][0], "-o", "-", "--to", files[i][2]}});
        run_result two =
            run_in(0, folder, (run_desc){.arguments = {"convert", files[i][1], "-o", "-", "--to", files[i][2]}});
        assert_true(one.out_length > 200 && one.out_length == two.out_length);
        assert_memory_equal(one.out, two.out, one.out_length);
        run_result_destroy(&one);
        run_result_destroy(&two);
    }
    run_folder_destroy(folder);
}

static void test_meshes_are_taken(void **state)
{
    (void)state;
    char *folder = make_ball_folder();
    char *made = report_of(folder, (run_desc){.arguments = {"lod", "ball.ply", "-o", "ball.hpm", "--faces", "100"}});
    assert_true(json_number(made, "progressive.base_triangles") <= 100);
    const size_t marks = json_count(made, "progressive.marks");
    assert_true(marks > 2);
    static const char *const faces[] = {"100", "777", "3119", "99999"};
    for (int i = 0; i < 4; i++) {
        char *report =
            report_of(folder, (run_desc){.arguments = {"lod", "ball.hpm", "-o", "part.ply", "--faces", faces[i]}});
        char *info = info_of(folder, "part.ply");
        const double triangles = json_number(report, "counts.triangles"), most = atof(faces[i]);
        assert_true(json_number(info, "counts.faces") == triangles);
        assert_true(triangles <= most && triangles >= fmin(most, 3120) - 2);
        free(info);
        free(report);
    }
    char *report = report_of(folder, (run_desc){.arguments = {"lod", "ball.hpm", "-o", "e.ply", "--error", "0.05"}});
    run_result result = run_in(0, folder,
                               (run_desc){.arguments = {"check", "e.ply", "--against", "ball.ply", "--json",
                                                        "--require", "closed,manifold,oriented"}});
    assert_true(json_number(result.out, "distance.low") <= 0.05);
    assert_true(json_number(report, "counts.triangles") < 1600);
    run_result_destroy(&result);
    free(report);
    free(made);
    run_folder_destroy(folder);
}

static void test_files_that_are_cut_off(void **state)
{
    (void)state;
    char *folder = make_ball_folder();
    run_result result = run_in(0, folder, (run_desc){.arguments = {"lod", "ball.ply", "-o", "ball.hpm"}});
    run_result_destroy(&result);
    size_t length;
    char *bytes = run_read_file(run_path(folder, "ball.hpm"), &length);
    FILE *file = fopen(run_path(folder, "cut.hpm"), "wb");
    assert_int_equal(fwrite(bytes, 1, length / 2, file), length / 2);
    fclose(file);
    free(bytes);
    fail_in(3, folder, "the file is cut off in the block at byte",
            (run_desc){.arguments = {"lod", "cut.hpm", "-o", "part.ply"}});
    fail_in(3, folder, "the file is cut off in the block at byte",
            (run_desc){.arguments = {"convert", "cut.hpm", "-o", "part.ply"}});
    result = run_in(0, folder, (run_desc){.arguments = {"lod", "cut.hpm", "-o", "part.ply", "--partial"}});
    assert_has(result.err, "note: the file is cut off");
    run_result_destroy(&result);
    result = run_in(0, folder, (run_desc){.arguments = {"check", "part.ply", "--require", "closed,manifold,oriented"}});
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* --- clusters ----------------------------------------------------------------------------------------------------- */

/* Where a view of the binary chunk begins. */
static const char *view_of(const char *glb, const char *json, int view)
{
    char path[64];
    uint32_t text;
    memcpy(&text, glb + 12, sizeof text);
    snprintf(path, sizeof path, "bufferViews.%d.byteOffset", view);
    return glb + 28 + text + (json_find(json, path) ? (size_t)json_number(json, path) : 0);
}

static uint32_t word(const char *at, size_t index)
{
    uint32_t value;
    memcpy(&value, at + 4 * index, sizeof value);
    return value;
}

static float real(const char *at, size_t index)
{
    float value;
    memcpy(&value, at + 4 * index, sizeof value);
    return value;
}

/* What a renderer would do with the file alone: the cut for an error everywhere, as an OFF file. */
static void write_cut(const char *glb, const char *json, double allowed, const char *path)
{
    const char *clusters = view_of(glb, json, (int)json_number(json, "meshes.0.extras.hewn_clusters.clusters"));
    const char *vertices = view_of(glb, json, (int)json_number(json, "meshes.0.extras.hewn_clusters.vertices"));
    const char *corners = view_of(glb, json, (int)json_number(json, "meshes.0.extras.hewn_clusters.corners"));
    const char *positions = view_of(glb, json, 0);
    const int count = (int)json_number(json, "meshes.0.extras.hewn_clusters.count");
    const int points = (int)json_number(json, "accessors.0.count");
    int faces = 0;
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int pass = 0; pass < 2; pass++) {
        if (pass == 1)
            fprintf(file, "OFF\n%d %d 0\n", points, faces);
        for (size_t v = 0; pass == 1 && v < (size_t)points; v++)
            fprintf(file, "%.9g %.9g %.9g\n", (double)real(positions, 3 * v), (double)real(positions, 3 * v + 1),
                    (double)real(positions, 3 * v + 2));
        for (int i = 0; i < count; i++) {
            const char *at = clusters + 80 * (size_t)i;
            if ((double)real(at, 16) > allowed || (double)real(at, 17) <= allowed)
                continue;
            faces += (int)word(at, 3);
            for (size_t t = 0; pass == 1 && t < word(at, 3); t++) {
                const unsigned char *corner = (const unsigned char *)corners + 3 * (word(at, 2) + t);
                fprintf(file, "3 %u %u %u\n", word(vertices, word(at, 0) + corner[0]),
                        word(vertices, word(at, 0) + corner[1]), word(vertices, word(at, 0) + corner[2]));
            }
        }
    }
    fclose(file);
}

static void test_clusters_in_a_file(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_ball(run_path(folder, "ball.ply"), 60);
    char *report = report_of(folder, (run_desc){.arguments = {"lod", "ball.ply", "-o", "c.glb", "--clusters"}});
    char *json = json_of_glb(folder, "c.glb"), *glb = run_read_file(run_path(folder, "c.glb"), NULL);
    assert_true(json_number(report, "triangles") == 7080);
    assert_true(json_number(json, "meshes.0.extras.hewn_clusters.count") == json_number(report, "clusters"));
    const int levels = (int)json_count(report, "levels");
    assert_true(levels > 4 && levels == (int)json_number(json, "meshes.0.extras.hewn_clusters.levels"));
    double last = 1e9;
    for (int i = 0; i < levels; i++) {
        const double error = level_number(report, i, "error");
        write_cut(glb, json, error, run_path(folder, "cut.off"));
        run_result result = run_in(0, folder,
                                   (run_desc){.arguments = {"check", "cut.off", "--json", "--against", "ball.ply",
                                                            "--require", "closed,manifold,oriented,one-component"}});
        assert_true(json_number(result.out, "distance.low") <= error + json_number(report, "rounding") + 1e-9);
        assert_true(json_number(result.out, "counts.faces") < last);
        last = json_number(result.out, "counts.faces");
        run_result_destroy(&result);
    }
    assert_true(last < 500);
    char *info = info_of(folder, "c.glb");
    assert_true(json_number(info, "counts.faces") == 7080);
    free(info);
    free(glb);
    free(json);
    free(report);
    fail_in(2, folder, "--levels does not go with --clusters",
            (run_desc){.arguments = {"lod", "ball.ply", "-o", "c.glb", "--clusters", "--levels", "1"}});
    fail_in(2, folder, "clusters are written as .glb only",
            (run_desc){.arguments = {"lod", "ball.ply", "-o", "c.ply", "--clusters"}});
    fail_in(2, folder, "--cluster-size is V,T",
            (run_desc){.arguments = {"lod", "ball.ply", "-o", "d.glb", "--clusters", "--cluster-size", "300,9"}});
    run_folder_destroy(folder);
}

/* --- misuse ------------------------------------------------------------------------------------------------------- */

static void test_misuse(void **state)
{
    (void)state;
    char *folder = make_ball_folder();
    static const struct {
        const char *says, *output;
        const char *arguments[4];
    } cases[] = {
        {"exclude each other", "a.glb", {"--levels", "1", "--errors", "0"}},
        {"a level is a share above 0 and at most 1, not 2", "a.glb", {"--levels", "2,1"}},
        {"a level is a share above 0 and at most 1, not 0", "a.glb", {"--levels", "1,0"}},
        {"levels fall from fine to coarse", "a.glb", {"--levels", "0.5,1"}},
        {"errors rise from fine to coarse", "a.glb", {"--errors", "1,0.5"}},
        {"--errors takes a number", "a.glb", {"--errors", "nan"}},
        {"--levels takes a number", "a.glb", {"--levels", "1,,2"}},
        {"--pixels must be greater than 0", "a.glb", {"--pixels", "0"}},
        {"ply holds one level only", "a.ply", {NULL}},
        {"cannot be written to standard output", "-", {"--to", "ply"}},
        {"--faces is for progressive meshes", "a.glb", {"--faces", "10"}},
        {"--levels is for levels, not for progressive meshes", "a.hpm", {"--levels", "1"}},
        {"--faces must be at least 1", "a.hpm", {"--faces", "0"}},
        {"for meshes that are taken from a progressive one", "a.hpm", {"--error", "1"}},
        {"for meshes that are taken from a progressive one", "a.hpm", {"--partial"}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {.arguments = {"lod", "ball.ply", "-o", cases[i].output}};
        for (int k = 0; k < 4; k++)
            desc.arguments[4 + k] = cases[i].arguments[k];
        fail_in(2, folder, cases[i].says, desc);
    }
    fail_in(2, folder, "are written by `hewn lod` only",
            (run_desc){.arguments = {"convert", "ball.ply", "-o", "ball.hpm"}});
    run_write_file(run_path(folder, "bad.hpm"), "not one\n");
    fail_in(3, folder, "this is no progressive mesh", (run_desc){.arguments = {"lod", "bad.hpm", "-o", "a.ply"}});
    run_write_file(run_path(folder, "none.obj"), "v 0 0 0\n");
    fail_in(3, folder, "no faces", (run_desc){.arguments = {"lod", "none.obj", "-o", "a.glb"}});
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_levels_in_one_file),     cmocka_unit_test(test_levels_in_separate_files),
        cmocka_unit_test(test_threads_change_nothing), cmocka_unit_test(test_a_progressive_mesh_gives_the_input_back),
        cmocka_unit_test(test_meshes_are_taken),       cmocka_unit_test(test_files_that_are_cut_off),
        cmocka_unit_test(test_clusters_in_a_file),     cmocka_unit_test(test_misuse),
    };
    return cmocka_run_group_tests_name("lod", tests, NULL, NULL);
}
