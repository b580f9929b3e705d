/* `hewn convert VOLUME --max-memory`: the same file as without it; a volume larger than memory; what it refuses. Files
 * of volumes are sparse: their zeros take no room on disk. HEWN_LONG asks for the largest. */
#include <fcntl.h>
#include <math.h>
#include <unistd.h>

#include "json_read.h"
#include "run.h"

/* A ball of values that fall with the distance from its middle, with ripples. */
typedef struct ball {
    int centre[3], radius;
} ball;

static void put_ball(int file, const int dims[3], const ball *of)
{
    int side = 2 * of->radius + 5;
    uint16_t *row = malloc((size_t)side * sizeof *row);
    assert_non_null(row);
    for (int z = 0; z < side; z++)
        for (int y = 0; y < side; y++) {
            int at[3] = {of->centre[0] - side / 2, of->centre[1] - side / 2 + y, of->centre[2] - side / 2 + z};
            for (int x = 0; x < side; x++) {
                double d = hypot(hypot(x - side / 2, y - side / 2), z - side / 2);
                double value = 2000 - 300 * (d - of->radius) + 400 * sin(1.3 * x) * sin(0.9 * y) * sin(1.7 * z);
                row[x] = (uint16_t)fmax(0, fmin(4000, value));
            }
            off_t place = 2 * ((off_t)dims[0] * ((off_t)dims[1] * at[2] + at[1]) + at[0]);
            assert_int_equal(pwrite(file, row, 2 * (size_t)side, place), 2 * side);
        }
    free(row);
}

static void write_volume(const char *path, const int dims[3], const ball *balls, int count)
{
    int file = open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);
    assert_true(file >= 0);
    assert_int_equal(ftruncate(file, (off_t)2 * dims[0] * dims[1] * dims[2]), 0);
    for (int i = 0; i < count; i++)
        put_ball(file, dims, &balls[i]);
    assert_int_equal(close(file), 0);
}

static const int middle_dims[3] = {300, 280, 200};
static const ball middle_balls[] = {{{60, 70, 40}, 30}, {{200, 180, 140}, 45}, {{150, 140, 90}, 20}};
#define MIDDLE "300,280,200"

/* --- the same file ------------------------------------------------------------------------------------------------ */

static void compare(const char *folder, const char *format, const char *method, const char *open, const char *limit,
                    double bytes)
{
    char one[32], other[32], report[32];
    run_subfolder(folder, format);
    snprintf(one, sizeof one, "%s/m.%s", format, format);
    run_desc desc = {.arguments = {"convert", "v.raw", "--dims", MIDDLE, "--type", "uint16", "--iso", "1500", "-o", one,
                                   "--method", method, "-q", open},
                     .folder = folder};
    run_result result = run_expecting(0, &desc);
    run_result_destroy(&result);
    snprintf(other, sizeof other, "%s/p", format);
    run_subfolder(folder, other);
    snprintf(other, sizeof other, "%s/p/m.%s", format, format);
    snprintf(report, sizeof report, "%s/r.json", format);
    int at = open ? 14 : 13;
    const char *const more[] = {"--max-memory", limit, "--report", report};
    desc.arguments[9] = other;
    for (int i = 0; i < 4; i++)
        desc.arguments[at + i] = more[i];
    result = run_expecting(0, &desc);
    run_result_destroy(&result);
    run_assert_same_file(run_path(folder, one), run_path(folder, other));
    char *text = run_read_file(run_path(folder, report), NULL);
    assert_true(json_number(text, "parts") >= 3);
    assert_true(json_number(text, "max_memory") == bytes);
    assert_true(json_number(text, "peak.counted_bytes") <= bytes);
    assert_int_equal(run_folder_count(run_path(folder, format)), 3); /* the mesh, the report, the folder */
    free(text);
}

static void test_same_file(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_volume(run_path(folder, "v.raw"), middle_dims, middle_balls, 3);
    compare(folder, "ply", "mc33", NULL, "4M", 4 * 1024 * 1024);
    compare(folder, "stl", "mc33", NULL, "5000K", 5000 * 1024);
    compare(folder, "glb", "nets", NULL, "5M", 5 * 1024 * 1024);
    compare(folder, "obj", "dc", "--open", "5M", 5 * 1024 * 1024);
    compare(folder, "3mf", "mc", "--open", "5M", 5 * 1024 * 1024);
    run_folder_destroy(folder);
}

/* --- larger than memory ------------------------------------------------------------------------------------------- */

/* The most that was resident, pages of the file and the program with them, stays below the limit. */
static void test_peak(void **state)
{
    (void)state;
    bool large = getenv("HEWN_LONG");
    const int dims[3] = {2048, 2048, large ? 1024 : 32};
    const ball balls[] = {{{300, 400, 16}, 12}, {{1500, 1300, large ? 700 : 15}, large ? 250 : 11}};
    char *folder = run_folder_create(), text[32];
    write_volume(run_path(folder, "v.raw"), dims, balls, 2);
    snprintf(text, sizeof text, "%d,%d,%d", dims[0], dims[1], dims[2]);
    run_desc desc = {.arguments = {"convert", "v.raw", "--dims", text, "--type", "uint16", "--iso", "1500", "-o",
                                   "m.stl", "--report", "r.json", "--max-memory", large ? "1G" : "64M", "-q"},
                     .folder = folder,
                     .timeout = 550};
    run_result result = run_expecting(0, &desc);
    run_result_destroy(&result);
    char *report = run_read_file(run_path(folder, "r.json"), NULL);
    double limit = large ? 1024.0 * 1024 * 1024 : 64.0 * 1024 * 1024;
    print_message("# resident at most: %.0f bytes, counted %.0f, in %.1f s\n", json_number(report, "peak.host_bytes"),
                  json_number(report, "peak.counted_bytes"), json_number(report, "seconds"));
    assert_true(json_number(report, "peak.counted_bytes") <= limit);
    assert_true(json_number(report, "peak.host_bytes") <= limit);
    assert_true(json_number(report, "certificate.components") >= 2);
    free(report);
    run_folder_destroy(folder);
}

/* --- refusals ----------------------------------------------------------------------------------------------------- */

static void refuse(const char *folder, int code, const char *says, const char *const more[4])
{
    run_desc desc = {.arguments = {"convert", "v.raw", "--dims", MIDDLE, "--type", "uint16", "-o", "x.ply"},
                     .folder = folder};
    int files = run_folder_count(folder);
    for (int i = 0; i < 4; i++)
        desc.arguments[8 + i] = more[i];
    run_result result = run_expecting(code, &desc);
    if (!strstr(result.err, says))
        fail_msg("'%s' is missing in: %s", says, result.err);
    run_result_destroy(&result);
    assert_int_equal(run_folder_count(folder), files);
}

static void test_refusals(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_volume(run_path(folder, "v.raw"), middle_dims, middle_balls, 3);
    refuse(folder, 5, "is read whole", (const char *const[4]){"--max-memory", "8M", "--endian", "big"});
    refuse(folder, 5, "that are allowed", (const char *const[4]){"--max-memory", "400K", "--iso", "1500"});
    refuse(folder, 3, "no surface at the iso value", (const char *const[4]){"--max-memory", "8M", "--iso", "9999"});
    refuse(folder, 2, "--max-memory", (const char *const[4]){"--max-memory", "8X"});
    refuse(folder, 2, "--labels", (const char *const[4]){"--max-memory", "8M", "--labels", "all"});
    run_write_file(run_path(folder, "t.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    run_desc mesh = {.arguments = {"convert", "t.obj", "-o", "y.ply", "--max-memory", "8M"}, .folder = folder};
    run_result result = run_expecting(2, &mesh);
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_file),
        cmocka_unit_test(test_peak),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests_name("volume_memory", tests, NULL, NULL);
}
