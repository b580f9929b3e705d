/* `hewn simplify --max-memory`: meshes that do not fit are simplified in parts, within the limit as the system measures
 * it; what fits is done as without a limit; what is refused; and that nothing is left on disk. */
#include <math.h>
#include <signal.h>

#include "mesh_files.h"

enum { PLY, STL, OBJ };

/* A ball with bumps, closed, of 2 n (n - 1) triangles. */
typedef struct ball_file {
    FILE *file;
    int n, format;
} ball_file;

static void find_vertex(const ball_file *ball, int v, float at[3])
{
    const int n = ball->n, last = 1 + (n - 1) * n;
    const double up = M_PI * (v == 0 ? 0 : v == last ? n : 1 + (v - 1) / n) / n;
    const double around = 2 * M_PI * (v == 0 || v == last ? 0 : (v - 1) % n) / n;
    const double r = 1 + 0.05 * sin(9 * up) * sin(7 * around) + 0.01 * sin(41 * up) * cos(37 * around);
    at[0] = (float)(r * sin(up) * cos(around));
    at[1] = (float)(r * sin(up) * sin(around));
    at[2] = (float)(r * cos(up));
}

static void write_triangle(const ball_file *ball, int a, int b, int c)
{
    const int corners[3] = {a, b, c};
    char facet[50] = {0};
    if (ball->format == OBJ) {
        fprintf(ball->file, "f %d %d %d\n", a + 1, b + 1, c + 1);
        return;
    }
    if (ball->format == PLY) {
        facet[0] = 3;
        memcpy(facet + 1, corners, sizeof corners);
    }
    for (int k = 0; ball->format == STL && k < 3; k++) {
        float at[3];
        find_vertex(ball, corners[k], at);
        memcpy(facet + 12 * (k + 1), at, sizeof at);
    }
    fwrite(facet, ball->format == PLY ? 13 : 50, 1, ball->file);
}

static void write_head(const ball_file *ball, unsigned vertices, unsigned triangles)
{
    char header[84] = "a ball";
    if (ball->format == PLY)
        fprintf(ball->file,
                "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty float x\nproperty float y\n"
                "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                "element face %u\nproperty list uchar int vertex_indices\nend_header\n",
                vertices, triangles);
    memcpy(header + 80, &triangles, 4);
    if (ball->format == STL)
        fwrite(header, sizeof header, 1, ball->file);
    for (unsigned v = 0; ball->format != STL && v < vertices; v++) {
        float at[3];
        find_vertex(ball, (int)v, at);
        const unsigned char color[3] = {at[2] > 0.1F ? 255 : 0, 0, 0};
        if (ball->format == OBJ) {
            fprintf(ball->file, "v %.9g %.9g %.9g\n", (double)at[0], (double)at[1], (double)at[2]);
            continue;
        }
        fwrite(at, sizeof at, 1, ball->file);
        fwrite(color, sizeof color, 1, ball->file);
    }
}

static void write_ball(const char *path, int n, int format)
{
    const ball_file ball = {fopen(path, "wb"), n, format};
    const int last = 1 + (n - 1) * n;
    assert_non_null(ball.file);
    write_head(&ball, (unsigned)last + 1, 2 * (unsigned)n * (unsigned)(n - 1));
    for (int i = 0; i < n; i++)
        write_triangle(&ball, 0, 1 + i, 1 + (i + 1) % n);
    for (int ring = 0; ring + 2 < n; ring++)
        for (int i = 0; i < n; i++) {
            const int a = 1 + ring * n + i, b = 1 + ring * n + (i + 1) % n;
            write_triangle(&ball, a, a + n, b + n);
            write_triangle(&ball, a, b + n, b);
        }
    for (int i = 0; i < n; i++)
        write_triangle(&ball, last, last - n + (i + 1) % n, last - n + i);
    assert_int_equal(fclose(ball.file), 0);
}

/* Closed, manifold and one piece, which `hewn check` fails for otherwise. */
static void assert_sound(const char *folder, const char *name)
{
    run_result result = run_in(0, folder,
                               (run_desc){.arguments = {"check", name, "--require",
                                                        "closed,manifold,oriented,no-degenerate-faces,one-component"}});
    run_result_destroy(&result);
}

static double megabytes(double count)
{
    return count * 1024 * 1024;
}

/* What a run without a report tells on standard error. */
typedef struct told_numbers {
    double triangles, before, peak;
    int passes, parts;
} told_numbers;

static told_numbers simplify_ball(const char *folder, const char *name, const char *ratio, const char *limit)
{
    told_numbers out = {0};
    run_result result =
        run_in(0, folder,
               (run_desc){.arguments = {"simplify", name, "-o", "small.ply", "--ratio", ratio, "--max-memory", limit}});
    const char *counts = strstr(result.err, "\n  "), *work = strstr(result.err, "  in ");
    assert_non_null(counts);
    assert_non_null(work);
    assert_int_equal(sscanf(counts, " %lf of %lf triangles left", &out.triangles, &out.before), 2);
    const char *rest = strstr(work, " over ");
    assert_non_null(rest);
    assert_int_equal(sscanf(work, "  in %d pass", &out.passes), 1);
    assert_int_equal(sscanf(rest, " over up to %d parts; at most %lf MB", &out.parts, &out.peak), 2);
    run_result_destroy(&result);
    assert_sound(folder, "small.ply");
    return out;
}

/* Within a limit that the mesh does not fit in; where there is time one that it is several times too large for. */
static void test_peak_stays_below_the_limit(void **state)
{
    (void)state;
    static const char *const names[] = {"ball.ply", "ball.stl", "ball.obj"};
    const bool slow = getenv("HEWN_LONG") != NULL;
    char *folder = run_folder_create();
    for (int format = PLY; format <= OBJ; format++) {
        const int n = slow ? 710 : format == PLY ? 220 : 140;
        const double before = 2.0 * n * (n - 1);
        write_ball(run_path(folder, names[format]), n, format);
        const told_numbers told = simplify_ball(folder, names[format], "0.05", slow ? "64M" : "34M");
        assert_true(1e6 * told.peak <= megabytes(slow ? 64 : 34));
        assert_true(told.passes >= 1 && told.parts >= 3);
        assert_true(told.before == before);
        assert_true(told.triangles <= 0.05 * before && told.triangles > 0.049 * before);
        assert_int_equal(run_folder_count(folder), format + 2);
    }
    run_folder_destroy(folder);
}

static void test_report(void **state)
{
    (void)state;
    const double count = 2.0 * 110 * 109;
    char *folder = run_folder_create();
    write_ball(run_path(folder, "ball.ply"), 110, PLY);
    char *report = report_of(folder, (run_desc){.arguments = {"simplify", "ball.ply", "-o", "small.ply", "--ratio",
                                                              "0.1", "--max-memory", "33M"}});
    assert_true(json_number(report, "max_memory") == megabytes(33));
    assert_true(json_number(report, "peak.host_bytes") <= megabytes(33));
    assert_true(json_number(report, "passes") >= 1);
    assert_true(json_number(report, "parts") >= 2);
    assert_true(json_number(report, "disk_bytes") > 0);
    assert_true(json_number(report, "counts_before.faces") == count);
    assert_true(json_number(report, "simplify.triangles_before") == count);
    assert_true(json_number(report, "counts.faces") == json_number(report, "simplify.triangles"));
    assert_true(json_number(report, "simplify.distance") >= json_number(report, "simplify.distance_low"));
    const double distance = json_number(report, "simplify.distance");
    run_result result =
        run_in(0, folder, (run_desc){.arguments = {"check", "small.ply", "--against", "ball.ply", "--json"}});
    assert_true(json_number(result.out, "distance.low") <= distance);
    run_result_destroy(&result);
    free(report);
    run_folder_destroy(folder);
}

/* Where even the result does not fit in memory to be simplified, passes go on until it is small enough. */
static void test_results_that_are_large(void **state)
{
    (void)state;
    const double before = 2.0 * 140 * 139;
    char *folder = run_folder_create();
    write_ball(run_path(folder, "ball.stl"), 140, STL);
    const told_numbers told = simplify_ball(folder, "ball.stl", "0.5", "33M");
    assert_true(told.passes >= 2);
    assert_true(1e6 * told.peak <= megabytes(33));
    assert_true(told.triangles <= 0.5 * before && told.triangles > 0.48 * before);
    run_folder_destroy(folder);
}

static void test_the_same_bytes(void **state)
{
    (void)state;
    static const char *const threads[] = {"OMP_NUM_THREADS=1", "OMP_NUM_THREADS=3"};
    char *folder = run_folder_create();
    write_ball(run_path(folder, "ball.ply"), 150, PLY);
    for (int i = 0; i < 2; i++) {
        run_subfolder(folder, i ? "b" : "a");
        run_desc desc = {.arguments = {"simplify", "ball.ply", "-o", i ? "b/small.ply" : "a/small.ply", "--ratio",
                                       "0.1", "--max-memory", "33M", "-q"},
                         .folder = folder,
                         .changes = {NO_LOADER, threads[i]}};
        run_result result = run_expecting(0, &desc);
        run_result_destroy(&result);
    }
    run_assert_same_file(run_path(folder, "a/small.ply"), run_path(folder, "b/small.ply"));
    run_folder_destroy(folder);
}

static void test_what_fits_is_the_same(void **state)
{
    (void)state;
    static const char *const limits[] = {NULL, "1G"};
    char *folder = run_folder_create();
    write_ball(run_path(folder, "ball.ply"), 30, PLY);
    for (int i = 0; i < 2; i++) {
        run_subfolder(folder, i ? "b" : "a");
        run_result result = run_in(
            0, folder,
            (run_desc){.arguments = {"simplify", "ball.ply", "-o", i ? "b/small.ply" : "a/small.ply", "--error", "0.1",
                                     "--no-self-intersections", limits[i] ? "--max-memory" : NULL, limits[i]}});
        assert_lacks(result.err, "passes");
        run_result_destroy(&result);
    }
    run_assert_same_file(run_path(folder, "a/small.ply"), run_path(folder, "b/small.ply"));
    run_folder_destroy(folder);
}

/* --- failures ----------------------------------------------------------------------------------------------------- */

#define SIMPLIFY "simplify", "ball.ply", "-o", "small.ply", "--ratio", "0.1"

static void test_refusals(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_ball(run_path(folder, "ball.ply"), 150, PLY);
    fail_in(2, folder, "--max-memory", (run_desc){.arguments = {SIMPLIFY, "--max-memory", "12Q"}});
    fail_in(5, folder, "too small", (run_desc){.arguments = {SIMPLIFY, "--max-memory", "5M"}});
    fail_in(2, folder, "in memory",
            (run_desc){.arguments = {SIMPLIFY, "--max-memory", "33M", "--no-self-intersections"}});
    fail_in(5, folder, "read in parts",
            (run_desc){.arguments = {"simplify", "-", "--from", "ply", "-o", "small.ply", "--ratio", "0.1",
                                     "--max-memory", "33M"},
                       .input = run_path(folder, "ball.ply")});
    fail_in(
        3, folder, "missing.ply",
        (run_desc){.arguments = {"simplify", "missing.ply", "-o", "a.ply", "--ratio", "0.1", "--max-memory", "33M"}});
    /* The disk is full before all is there. */
    fail_in(1, folder, "temporary file",
            (run_desc){.arguments = {SIMPLIFY, "--max-memory", "33M"}, .file_limit = 200000});
    run_folder_destroy(folder);
}

/* At any moment: either it is cancelled and nothing is there, or it was done already and the file is whole. */
static void test_cancel_at_any_moment(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_ball(run_path(folder, "ball.ply"), 150, PLY);
    for (int i = 0; i < 4; i++) {
        run_desc desc = {.arguments = {SIMPLIFY, "--max-memory", "33M"}, .folder = folder, .changes = {NO_LOADER}};
        run_process process = run_start(&desc);
        run_sleep(0.05 + 0.2 * i);
        kill(process.id, i % 2 ? SIGTERM : SIGINT);
        run_result result = run_finish(&process);
        if (result.signal == 0 && result.code != 130 && result.code != 0)
            fail_msg("exit code %d (signal %d): %s", result.code, result.signal, result.err);
        assert_int_equal(run_folder_count(folder), result.code == 0 ? 2 : 1);
        if (result.code == 0)
            assert_int_equal(unlink(run_path(folder, "small.ply")), 0);
        run_result_destroy(&result);
    }
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_peak_stays_below_the_limit), cmocka_unit_test(test_report),
        cmocka_unit_test(test_results_that_are_large),     cmocka_unit_test(test_the_same_bytes),
        cmocka_unit_test(test_what_fits_is_the_same),      cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_cancel_at_any_moment),
    };
    return cmocka_run_group_tests_name("simplify_memory", tests, NULL, NULL);
}
