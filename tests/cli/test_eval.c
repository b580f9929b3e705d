/* `hewn eval` and `hewn query`: what they print, and what they refuse. */
#include <math.h>

#include "run.h"

#define BALL "return sphere(1)\n"

static run_result eval_in(int code, const char *folder, const char *const *arguments)
{
    run_desc desc = {.folder = folder};
    for (int i = 0; arguments[i]; i++)
        desc.arguments[i] = arguments[i];
    return run_expecting(code, &desc);
}

#define RUN(code, folder, ...) eval_in(code, folder, (const char *const[]){__VA_ARGS__, NULL})

static void test_points(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "ball.lua"), BALL);
    run_write_file(run_path(folder, "p.txt"), "0 0 0\n\n# nothing here\n3,0,0 # behind\n\t0;4 0\r\n0 -2.5 0");
    run_result result = RUN(0, folder, "eval", "ball.lua", "--points", "p.txt");
    assert_string_equal(result.out, "-1\n2\n3\n1.5\n");
    run_result_destroy(&result);
    result = RUN(0, folder, "eval", "ball.lua", "--at", "0,0,2", "--at", "0,-3,0", "--gradient");
    assert_string_equal(result.out, "1 0 0 1\n2 0 -1 0\n");
    run_result_destroy(&result);
    result = RUN(0, folder, "eval", "ball.lua", "--points", "p.txt", "-o", "out.txt");
    assert_string_equal(result.out, "");
    size_t length;
    char *text = run_read_file(run_path(folder, "out.txt"), &length);
    assert_string_equal(text, "-1\n2\n3\n1.5\n");
    free(text);
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* A line that cannot be used is named by its number, and no file is left half written. */
static void test_bad_lines(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } lines[] = {{"0 0 0\n1 2\n", "p.txt:2: the line has 2 numbers"},
                 {"\n\n1 2 3 4\n", "p.txt:3: the line has 4 numbers"},
                 {"1 2 nan\n", "p.txt:1: 'nan' is not a finite number"},
                 {"1 2 3\n1 inf 3\n", "p.txt:2: 'inf' is not a finite number"},
                 {"1 2 1e999\n", "p.txt:1: '1e999' is not a finite number"},
                 {"1 2 0x3\n", "p.txt:1: '0x3' is not a finite number"},
                 {"1 2 --3\n", "p.txt:1: '--3' is not a finite number"},
                 {"garbage\n", "p.txt:1: 'garbage' is not a finite number"}};
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "ball.lua"), BALL);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        run_write_file(run_path(folder, "p.txt"), lines[i].text);
        run_result result = RUN(3, folder, "eval", "ball.lua", "--points", "p.txt", "-o", "out.txt");
        if (!strstr(result.err, lines[i].says))
            fail_msg("'%s' is missing in: %s", lines[i].says, result.err);
        assert_false(run_file_exists(run_path(folder, "out.txt")));
        assert_int_equal(run_folder_count(folder), 2);
        run_result_destroy(&result);
    }
    char *endless = malloc(10001);
    assert_non_null(endless);
    memset(endless, '1', 10000);
    endless[10000] = '\0';
    run_write_file(run_path(folder, "p.txt"), endless);
    free(endless);
    run_result result = RUN(3, folder, "eval", "ball.lua", "--points", "p.txt");
    assert_non_null(strstr(result.err, "p.txt:1: the line is longer than 4,096 characters"));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* More lines than are held at a time, in their order. */
static void test_many_points(void **state)
{
    (void)state;
    enum { LINES = 200000 };
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "x.lua"), "bounds(-1,-1,-1,1,1,1)\nreturn x\n");
    FILE *file = fopen(run_path(folder, "p.txt"), "w");
    assert_non_null(file);
    for (int i = 0; i < LINES; i++)
        fprintf(file, "%d 0 0\n", i);
    fclose(file);
    const run_desc desc = {
        .folder = folder, .arguments = {"eval", "x.lua", "--points", "-"}, .input = run_path(folder, "p.txt")};
    run_result result = run_expecting(0, &desc);
    const char *at = result.out;
    for (long i = 0; i < LINES; i++) {
        char *end;
        assert_int_equal(strtol(at, &end, 10), i);
        assert_int_equal(*end, '\n');
        at = end + 1;
    }
    assert_int_equal(*at, '\0');
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* Numbers of two texts are the same to `off` of themselves and the unit; how many there are. */
static long compare_numbers(const char *a, const char *b, double off)
{
    long count = 0;
    for (;; count++) {
        char *end_a, *end_b;
        double x = strtod(a, &end_a), y = strtod(b, &end_b);
        assert_int_equal(end_a == a, end_b == b);
        if (end_a == a)
            return count;
        if (!(fabs(x - y) <= off * (1 + fabs(x))))
            fail_msg("number %ld is %.9g or %.9g", count, x, y);
        a = end_a;
        b = end_b;
    }
}

/* A device gives what the host gives, in single precision: at points, with gradients, on grids of more than one batch,
 * and of a field that is too large for it. */
static void test_device(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"),
                   "bounds(-2, -2, -2, 2, 2, 2)\n"
                   "return sphere(1):smooth_union(box(1.5, 0.7, 2):rotate_z(30), 0.2):twist(0.3) + 0.1 * sin(3 * x)\n");
    run_write_file(run_path(folder, "large.lua"),
                   "bounds(0, 0, 0, 10, 10, 10)\nlocal s = sphere(0.3)\nfor i = 1, 900 do\n"
                   "  s = s:union(sphere(0.3):move(i % 10, i // 10 % 10, i // 100))\nend\nreturn s\n");
    FILE *file = fopen(run_path(folder, "p.txt"), "w");
    assert_non_null(file);
    for (int i = 0; i < 70000; i++)
        fprintf(file, "%.3f %.3f %.3f\n", sin(i) * 2, cos(1.7 * i) * 2, sin(0.3 * i + 1) * 2);
    fclose(file);
    static const char *const ways[][6] = {{"s.lua", "--points", "p.txt", "--gradient"},
                                          {"s.lua", "--at", "0.5,0.25,1", "--at", "1,1,1"},
                                          {"s.lua", "--grid", "50x40x35"},
                                          {"s.lua", "--grid", "31x17"},
                                          {"large.lua", "--grid", "20x20x4"}};
    static const long counts[] = {280000, 2, 70000, 527, 1600};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        run_result results[2];
        for (int k = 0; k < 2; k++) {
            run_desc desc = {.folder = folder, .arguments = {"eval"}, .changes = {"HEWN_VALIDATION=1"}};
            int n = 1;
            for (int j = 0; ways[i][j]; j++)
                desc.arguments[n++] = ways[i][j];
            desc.arguments[n++] = "--device";
            desc.arguments[n++] = k == 0 ? "host" : "0";
            desc.arguments[n] = "-q";
            results[k] = run_expecting(0, &desc);
        }
        assert_int_equal(compare_numbers(results[0].out, results[1].out, 1e-4), counts[i]);
        run_result_destroy(&results[0]);
        run_result_destroy(&results[1]);
    }
    run_result result = RUN(2, folder, "eval", "s.lua", "--grid", "4x4", "--device", "0", "--report", "r.json");
    assert_non_null(strstr(result.err, "--report"));
    run_result_destroy(&result);
    result = RUN(4, folder, "eval", "s.lua", "--grid", "4x4", "--device", "no such device", "-o", "x.txt");
    run_result_destroy(&result);
    assert_int_equal(run_folder_count(folder), 3);
    run_folder_destroy(folder);
}

static void test_grids(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "sum.lua"), "bounds(0,0,0,2,4,6)\nreturn x + 10 * y + 100 * z\n");
    run_result result = RUN(0, folder, "eval", "sum.lua", "--grid", "2x2x3");
    assert_string_equal(result.out,
                        "110.5\n111.5\n130.5\n131.5\n310.5\n311.5\n330.5\n331.5\n510.5\n511.5\n530.5\n531.5\n");
    run_result_destroy(&result);
    result = RUN(0, folder, "eval", "sum.lua", "--grid", "2x1", "--bounds", "0,0,1,2,2,1", "-q");
    assert_string_equal(result.out, "110.5\n111.5\n");
    assert_string_equal(result.err, "");
    run_result_destroy(&result);
    run_write_file(run_path(folder, "disc.lua"), "bounds(-2,-2,-2,2,2,2)\nreturn sphere(1)\n");
    result = RUN(0, folder, "eval", "disc.lua", "--grid", "200x200", "--inside", "--report", "r.json");
    int inside = 0;
    for (const char *at = result.out; *at; at += 2)
        inside += *at == '1';
    assert_true(fabs(inside * (16.0 / 40000) - 3.14159265) < 0.02);
    size_t length;
    char *text = run_read_file(run_path(folder, "r.json"), &length);
    assert_non_null(strstr(text, "\"share_of_operations\""));
    assert_non_null(strstr(text, "\"share_decided_by_bounds\""));
    free(text);
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* The share of operations that a pixel of Prospero needs. */
static void test_share(void **state)
{
    (void)state;
    const char *model = run_data_file("implicit/prospero.vm");
    char *folder = run_folder_create();
    run_result result =
        RUN(0, folder, "eval", model, "--grid", "512x512", "--inside", "-o", "out.txt", "--report", "r.json");
    size_t length;
    char *text = run_read_file(run_path(folder, "r.json"), &length);
    const char *share = strstr(text, "\"share_with_bounds\": ");
    assert_non_null(share);
    assert_true(strtod(share + 21, NULL) < 0.05 && strtod(share + 21, NULL) > 0);
    free(text);
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* --- query ----------------------------------------------------------------------------------------------------------
 */

static void test_nearest(void **state)
{
    (void)state;
    char *folder = run_folder_create(), states[2][16], sure[2][16];
    run_write_file(run_path(folder, "ball.lua"), BALL);
    run_write_file(run_path(folder, "p.txt"), "3 0 0\n0 0 0.5\n");
    for (int device = 0; device < 2; device++) {
        run_desc desc = {.folder = folder, .arguments = {"query", "ball.lua", "--nearest", "p.txt"}};
        desc.changes[0] = device ? "HEWN_VALIDATION=1" : "HEWN_VULKAN_LOADER=/nonexistent/libvulkan.so";
        if (device) {
            desc.arguments[4] = "--device";
            desc.arguments[5] = "0";
        }
        run_result result = run_expecting(0, &desc);
        double a[8], b[8];
        int read = sscanf(result.out,
                          "# state sure low high x y z nx ny nz\n%15s %15s %lf %lf %lf %lf %lf %lf %lf %lf\n"
                          "%15s %15s %lf %lf %lf %lf %lf %lf %lf %lf\n",
                          states[0], sure[0], &a[0], &a[1], &a[2], &a[3], &a[4], &a[5], &a[6], &a[7], states[1],
                          sure[1], &b[0], &b[1], &b[2], &b[3], &b[4], &b[5], &b[6], &b[7]);
        assert_int_equal(read, 20);
        assert_string_equal(states[0], "outside");
        assert_string_equal(states[1], "inside");
        assert_string_equal(sure[0], "sure");
        assert_true(a[0] <= 2.00001 && a[1] >= 1.99999 && a[1] - a[0] < 1e-3 && fabs(a[2] - 1) < 1e-3);
        assert_true(b[0] <= 0.50001 && b[1] >= 0.49999 && b[1] - b[0] < 1e-3 && b[7] > 0.999);
        run_result_destroy(&result);
    }
    run_folder_destroy(folder);
}

static void test_rays(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "ball.lua"), BALL);
    run_write_file(run_path(folder, "r.txt"), "-3 0 0 2e200 0 0\n-3 5 0 1e-200 0 0\n");
    run_result result = RUN(0, folder, "query", "ball.lua", "--rays", "r.txt", "--radius", "0.5");
    double low, high;
    assert_int_equal(sscanf(result.out, "# state sure low high x y z nx ny nz\noutside sure %lf %lf", &low, &high), 2);
    assert_true(low <= 1.50001 && high >= 1.49999 && high - low < 1e-3);
    assert_non_null(strstr(result.out, "\nnothing sure inf inf 0 0 0 0 0 0\n"));
    run_result_destroy(&result);
    run_write_file(run_path(folder, "r.txt"), "-3 0 0 2 0 0\n\n1 1 1 0 0 0\n");
    result = RUN(3, folder, "query", "ball.lua", "--rays", "r.txt", "-o", "out.txt");
    assert_non_null(strstr(result.err, "r.txt:3: a ray has no direction"));
    assert_false(run_file_exists(run_path(folder, "out.txt")));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_clearance(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "ball.lua"), BALL);
    run_write_file(run_path(folder, "other.lua"), "return sphere(0.5):move(3, 0, 0)\n");
    run_write_file(run_path(folder, "within.lua"), "return sphere(0.2):move(0.1, 0, 0)\n");
    run_write_file(run_path(folder, "inch.lua"), "units(\"in\")\nreturn sphere(0.5):move(3, 0, 0)\n");
    run_result result = RUN(0, folder, "query", "ball.lua", "--clearance", "other.lua", "--tolerance", "0.01");
    double v[8];
    assert_int_equal(sscanf(result.out,
                            "# state sure low high ax ay az bx by bz\napart sure %lf %lf %lf %lf %lf %lf %lf %lf\n",
                            &v[0], &v[1], &v[2], &v[3], &v[4], &v[5], &v[6], &v[7]),
                     8);
    assert_true(v[0] <= 1.50001 && v[1] >= 1.49999 && v[1] - v[0] < 0.011 && fabs(v[2] - 1) < 0.01);
    run_result_destroy(&result);
    result = RUN(0, folder, "query", "ball.lua", "--clearance", "within.lua");
    assert_non_null(strstr(result.out, "\noverlap sure 0 0 "));
    run_result_destroy(&result);
    result = RUN(3, folder, "query", "ball.lua", "--clearance", "inch.lua");
    assert_non_null(strstr(result.err, "inch.lua: it is in another unit"));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_refusals(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "ball.lua"), BALL);
    run_write_file(run_path(folder, "half.lua"), "return half_space(0, 0, 1, 0)\n");
    run_write_file(run_path(folder, "p.txt"), "0 0 0\n");
    static const char *const misuse[][8] = {
        {"eval", "ball.lua"},
        {"eval", "ball.lua", "--at", "1,2"},
        {"eval", "ball.lua", "--at", "1,2,3,4"},
        {"eval", "ball.lua", "--at", "1,2,x"},
        {"eval", "ball.lua", "--at", "1,2,3", "--points", "p.txt"},
        {"eval", "ball.lua", "--at", "1,2,3", "--inside"},
        {"eval", "ball.lua", "--grid", "0x4"},
        {"eval", "ball.lua", "--grid", "4"},
        {"eval", "ball.lua", "--grid", "4x"},
        {"eval", "ball.lua", "--grid", "4x4x4x4"},
        {"eval", "ball.lua", "--grid", "1000000000x1000000000"},
        {"eval", "ball.lua", "--grid", "99999999999999999999x2"},
        {"eval", "ball.lua", "--grid", "-4x4"},
        {"eval", "ball.lua", "--grid", "4x4", "--gradient"},
        {"eval", "-", "--from", "lua", "--points", "-"},
        {"query", "ball.lua"},
        {"query", "ball.lua", "--nearest", "p.txt", "--rays", "p.txt"},
        {"query", "ball.lua", "--nearest", "p.txt", "--radius", "1"},
        {"query", "ball.lua", "--rays", "p.txt", "--radius", "-1"},
        {"query", "ball.lua", "--nearest", "p.txt", "--tolerance", "0"},
        {"query", "ball.lua", "--nearest", "p.txt", "--bounds", "1,0,0,0,1,1"},
        {"query", "ball.lua", "--clearance", "ball.lua", "--device", "0"},
    };
    for (size_t i = 0; i < sizeof misuse / sizeof *misuse; i++) {
        run_result result = eval_in(2, folder, misuse[i]);
        assert_non_null(strstr(result.err, "--help"));
        run_result_destroy(&result);
    }
    run_result result = RUN(3, folder, "query", "half.lua", "--nearest", "p.txt");
    assert_non_null(strstr(result.err, "--bounds"));
    run_result_destroy(&result);
    result = RUN(3, folder, "eval", "half.lua", "--grid", "4x4");
    assert_non_null(strstr(result.err, "--bounds"));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* An input that cannot be read is a bad input, whichever it is. */
static void test_inputs_that_cannot_be_read(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "ball.lua"), BALL);
    run_write_file(run_path(folder, "p.txt"), "0 0 0\n");
    static const char *const cases[][8] = {{"eval", "ball.lua", "--points", "missing.txt"},
                                           {"eval", "missing.lua", "--at", "0,0,0"},
                                           {"query", "ball.lua", "--nearest", "missing.txt"},
                                           {"query", "missing.lua", "--nearest", "p.txt"},
                                           {"query", "ball.lua", "--clearance", "missing.lua"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_result result = eval_in(3, folder, cases[i]);
        assert_non_null(strstr(result.err, "hewn: missing."));
        assert_non_null(strstr(result.err, "cannot open: No such file"));
        run_result_destroy(&result);
    }
    run_result result = RUN(3, folder, "eval", "ball.lua", "--points", ".");
    assert_non_null(strstr(result.err, "folder"));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* Outputs that cannot be written are refused before the scene is run: this one would loop for ever. */
static void test_outputs_are_checked_first(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "s.lua"), "while true do end");
    run_write_file(run_path(folder, "p.txt"), "0 0 0\n");
    static const char *const cases[][10] = {
        {"eval", "s.lua", "--grid", "4x4", "-o", "missing/x.txt"},
        {"eval", "s.lua", "--grid", "4x4", "-o", "x.txt", "--report", "missing/r.json"},
        {"query", "s.lua", "--nearest", "p.txt", "-o", "missing/x.txt"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_result result = eval_in(1, folder, cases[i]);
        assert_non_null(strstr(result.err, "hewn: missing/"));
        run_result_destroy(&result);
        assert_int_equal(run_folder_count(folder), 2);
    }
    run_result result = RUN(2, folder, "eval", "s.lua", "--grid", "4x4", "-o", "x", "--report", "x");
    assert_non_null(strstr(result.err, "cannot both go to x"));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* Long numbers are numbers; of what is none a message shows the beginning. */
static void test_long_numbers(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "x.lua"), "return x\n");
    run_write_file(run_path(folder, "p.txt"),
                   "0.100000000000000000000000000000000000000000000000000000000000000001 0 0\n"
                   "0000000000000000000000000000000000000000000000000000000000000000000003.5,0,0\n");
    run_result result = RUN(0, folder, "eval", "x.lua", "--points", "p.txt");
    assert_string_equal(result.out, "0.1\n3.5\n");
    run_result_destroy(&result);
    run_write_file(run_path(folder, "p.txt"), "1 2 3\n1234567890123456789012345678901234567890123456789012345x 0 0\n");
    result = RUN(3, folder, "eval", "x.lua", "--points", "p.txt");
    assert_non_null(strstr(result.err, "p.txt:2: '123456789012345678901234567890123456789012345678...' is not a"));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_bad_lines),
        cmocka_unit_test(test_many_points),
        cmocka_unit_test(test_grids),
        cmocka_unit_test(test_share),
        cmocka_unit_test(test_nearest),
        cmocka_unit_test(test_device),
        cmocka_unit_test(test_rays),
        cmocka_unit_test(test_clearance),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_inputs_that_cannot_be_read),
        cmocka_unit_test(test_outputs_are_checked_first),
        cmocka_unit_test(test_long_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
