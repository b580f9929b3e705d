/* What `hewn convert` does to volumes and their meshes besides: smoothing values, bodies and cavities, smoothing and
 * simplifying the mesh; with --labels too. */
#include <dirent.h>
#include <math.h>
#include <sys/stat.h>

#include "json_read.h"
#include "mesh_files.h"
#include "run.h"

enum { SIDE = 40 };

/* The samples of a lattice of 0.5 x 0.5 x 1: balls, each a value with a middle and a radius in mm, later ones over
 * earlier ones. */
typedef struct ball {
    double at[3], radius;
    int value;
} ball;

static void write_balls(const char *path, const ball *balls, size_t count)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file,
            "NRRD0004\ntype: uchar\ndimension: 3\nspace: right-anterior-superior\nsizes: %d %d %d\n"
            "space directions: (0.5,0,0) (0,0.5,0) (0,0,1)\nspace origin: (0,0,0)\n"
            "space units: \"mm\" \"mm\" \"mm\"\nencoding: raw\n\n",
            2 * SIDE, 2 * SIDE, SIDE);
    for (int n = 0; n < 4 * SIDE * SIDE * SIDE; n++) {
        double at[3] = {0.5 * (n % (2 * SIDE)), 0.5 * (n / (2 * SIDE) % (2 * SIDE)), n / (4 * SIDE * SIDE)};
        int value = 0;
        for (size_t b = 0; b < count; b++) {
            double sum = 0;
            for (int axis = 0; axis < 3; axis++)
                sum += (at[axis] - balls[b].at[axis]) * (at[axis] - balls[b].at[axis]);
            value = sum < balls[b].radius * balls[b].radius ? balls[b].value : value;
        }
        fputc(value, file);
    }
    assert_int_equal(fclose(file), 0);
}

/* A ball of radius 9 with a cavity of 5, in which there is a ball of 2; balls of 4 and 1 apart. */
static const ball nested[] = {{{12, 12, 20}, 9, 200},
                              {{12, 12, 20}, 5, 0},
                              {{12, 12, 20}, 2, 200},
                              {{30, 30, 20}, 4, 200},
                              {{30, 12, 30}, 1, 200}};

static double of_ball(double radius)
{
    return 4.0 / 3 * 3.14159265358979 * radius * radius * radius;
}

static void assert_near(double value, double wanted, double share)
{
    if (!(fabs(value - wanted) <= share * wanted))
        fail_msg("%g is not %g", value, wanted);
}

/* The report of a job that succeeds; free it with run_result_destroy(). Its mesh is closed, in the file too. */
static run_result result_of(const char *folder, const char *output, const char *const *more)
{
    run_desc desc = {.arguments = {"convert", "a.nrrd", "-o", output, "--report", "-"}};
    for (int i = 0; more[i]; i++)
        desc.arguments[6 + i] = more[i];
    run_result result = run_in(0, folder, desc);
    assert_true(json_is_valid(result.out));
    run_result checked = run_in(
        0, folder,
        (run_desc){.arguments = {"check", output, "--require", "closed,manifold,oriented", "--no-self-intersections"}});
    run_result_destroy(&checked);
    return result;
}

static void check_bodies(const char *folder, const char *const *more, double bodies, double cavities, double volume)
{
    run_result result = result_of(folder, "out.stl", more);
    assert_true(json_number(result.out, "bodies.bodies") == 4);
    assert_true(json_number(result.out, "bodies.cavities") == 1);
    assert_true(json_number(result.out, "bodies.kept_bodies") == bodies);
    assert_true(json_number(result.out, "bodies.kept_cavities") == cavities);
    assert_true(json_number(result.out, "certificate.components") == bodies + cavities);
    assert_near(json_number(result.out, "certificate.volume"), volume, 0.04);
    run_result_destroy(&result);
}

static void test_bodies(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_balls(run_path(folder, "a.nrrd"), nested, 5);
    double hull = of_ball(9), shell = hull - of_ball(5), all = shell + of_ball(2) + of_ball(4) + of_ball(1);
    check_bodies(folder, (const char *[]){"--largest", "9", NULL}, 4, 1, all);
    check_bodies(folder, (const char *[]){"--largest", "1", NULL}, 1, 1, shell);
    check_bodies(folder, (const char *[]){"--largest", "2", NULL}, 2, 1, shell + of_ball(4));
    check_bodies(folder, (const char *[]){"--fill-cavities", NULL}, 3, 0, hull + of_ball(4) + of_ball(1));
    check_bodies(folder, (const char *[]){"--min-volume", "20", NULL}, 3, 1, all - of_ball(1));
    check_bodies(folder, (const char *[]){"--min-volume", "200", "--fill-cavities", NULL}, 2, 0, hull + of_ball(4));
    run_result result =
        run_in(0, folder,
               (run_desc){.arguments = {"convert", "a.nrrd", "-o", "out.glb", "--min-volume", "200", "--report", "-"}});
    assert_true(json_number(result.out, "bodies.kept_bodies") == 2); /* in mm3, though the mesh is in metres */
    assert_has(result.err, "2 of 4 bodies and 1 of 1 cavity kept");
    run_result_destroy(&result);
    result = run_in(0, folder,
                    (run_desc){.arguments = {"convert", "a.nrrd", "-o", "out.stl", "--min-volume", "200", "--space",
                                             "voxel", "--report", "-"}});
    assert_true(json_number(result.out, "bodies.kept_bodies") == 2); /* and in voxels */
    run_result_destroy(&result);
    fail_in(3, folder, "none of the 4 bodies is as large as that",
            (run_desc){.arguments = {"convert", "a.nrrd", "-o", "no.stl", "--min-volume", "1e6"}});
    assert_false(run_file_exists(run_path(folder, "no.stl")));
    run_folder_destroy(folder);
}

/* Smoothing values takes specks away; the iso value half way keeps what is large where it is. */
static void test_smoothed_values(void **state)
{
    (void)state;
    static const char *const ways[] = {"1.2", "gaussian:1.2", "median:1.5"};
    char *folder = run_folder_create();
    write_balls(run_path(folder, "a.nrrd"),
                (const ball[]){{{20, 20, 20}, 9, 200}, {{5, 5, 20}, 0.8, 200}, {{33, 8, 12}, 0.8, 200}}, 3);
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        run_result result =
            result_of(folder, "out.stl", (const char *[]){"--iso", "100", "--smooth-volume", ways[i], NULL});
        assert_string_equal(json_string(result.out, "filter.kind"), i == 2 ? "median" : "gaussian");
        assert_true(json_number(result.out, "certificate.components") == 1);
        assert_near(json_number(result.out, "certificate.volume"), of_ball(9), 0.08); /* what is round shrinks */
        assert_has(result.err, "values smoothed by");
        run_result_destroy(&result);
    }
    run_folder_destroy(folder);
}

static void test_refined_meshes(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_balls(run_path(folder, "a.nrrd"), (const ball[]){{{20, 20, 20}, 12, 200}}, 1);
    run_result plain = result_of(folder, "out.stl", (const char *[]){"--iso", "100", NULL});
    run_result smooth = result_of(
        folder, "out.stl", (const char *[]){"--iso", "100", "--smooth", "taubin:iterations=30,passband=0.1", NULL});
    double volume = json_number(plain.out, "certificate.volume");
    assert_true(json_number(smooth.out, "smooth.iterations") == 30);
    assert_near(json_number(smooth.out, "certificate.volume"), volume, 1e-5);
    assert_true(json_number(smooth.out, "certificate.area") < 0.99 * json_number(plain.out, "certificate.area"));
    run_result_destroy(&smooth);
    /* Lengths are in the volume's mm, though the mesh is in metres; pairs alone are taubin's; then to few triangles. */
    run_result few = result_of(
        folder, "out.glb",
        (const char *[]){"--iso", "100", "--smooth", "implicit:step=1.5,volume=keep", "--simplify", "error:0.3", NULL});
    assert_true(json_number(few.out, "simplify.distance") <= 0.3e-3);
    assert_near(json_number(few.out, "simplify.error_allowed"), 0.3e-3, 1e-9);
    assert_near(json_number(few.out, "smooth.step"), 1.5e-3, 1e-9);
    assert_true(json_number(few.out, "counts.faces") < 0.2 * json_number(plain.out, "counts.faces"));
    assert_near(json_number(few.out, "certificate.volume"), volume * 1e-9, 0.02);
    run_result_destroy(&few);
    few = result_of(folder, "out.ply", (const char *[]){"--smooth", "iterations=5", "--simplify", "faces:500", NULL});
    assert_string_equal(json_string(few.out, "smooth.method"), "taubin");
    assert_true(json_number(few.out, "counts.faces") <= 500);
    run_result_destroy(&few);
    run_result_destroy(&plain);
    run_folder_destroy(folder);
}

/* One shell in another, an island apart, and a hollow; neighbours go on fitting after simplification. */
static void test_labels(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_balls(run_path(folder, "a.nrrd"),
                (const ball[]){{{18, 18, 20}, 12, 1}, {{18, 18, 20}, 8, 2}, {{18, 18, 20}, 3, 0}, {{35, 35, 36}, 3, 2}},
                4);
    run_result result = run_in(0, folder,
                               (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "-o", "out.ply",
                                                        "--largest", "1", "--fill-cavities", "--report", "-"}});
    assert_true(json_number(result.out, "islands.bodies") == 3);
    assert_true(json_number(result.out, "islands.kept_bodies") == 2);
    assert_true(json_number(result.out, "islands.kept_cavities") == 0);
    assert_true(json_number(result.out, "labels.1.certificate.components") == 1);
    assert_near(json_number(result.out, "labels.1.certificate.volume"), of_ball(8), 0.08);
    assert_near(json_number(result.out, "labels.0.certificate.volume"), of_ball(12) - of_ball(8), 0.08);
    double faces = json_number(result.out, "counts.faces");
    run_result_destroy(&result);
    result = run_in(0, folder,
                    (run_desc){.arguments = {"convert", "a.nrrd", "--labels", "all", "-o", "out.ply", "--smooth",
                                             "taubin:iterations=5", "--simplify", "ratio:0.2", "--report", "-"}});
    assert_true(json_number(result.out, "counts.faces") < 0.25 * faces + 500);
    assert_true(json_number(result.out, "smooth.iterations") == 5);
    double sum =
        json_number(result.out, "labels.0.certificate.volume") + json_number(result.out, "labels.1.certificate.volume");
    assert_near(sum, of_ball(12), 0.05); /* neither a gap nor an overlap */
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_bad_requests(void **state)
{
    (void)state;
    static const struct {
        int code;
        const char *says;
        const char *more[6];
    } cases[] = {
        {2, "do not go with --open", {"--open", "--largest", "1"}},
        {2, "--largest", {"--largest", "0"}},
        {2, "--min-volume must be greater", {"--min-volume", "-3"}},
        {2, "--smooth-volume must be greater", {"--smooth-volume", "0"}},
        {2, "gaussian:LENGTH or median:LENGTH", {"--smooth-volume", "box:3"}},
        {2, "reaches no neighbour", {"--smooth-volume", "median:0.3"}},
        {2, "is only 40 long", {"--smooth-volume", "100"}},
        {2, "--smooth is taubin", {"--smooth", "magic"}},
        {2, "--smooth knows", {"--smooth", "taubin:speed=3"}},
        {2, "--smooth step= is for cotan", {"--smooth", "taubin:step=3"}},
        {2, "--smooth takes METHOD:KEY=VALUE", {"--smooth", "taubin:"}},
        {2, "--smooth takes METHOD:KEY=VALUE", {"--smooth", "taubin:iterations"}},
        {2, "--smooth iterations=", {"--smooth", "taubin:iterations=0"}},
        {2, "--smooth passband= must be below", {"--smooth", "strength=1,passband=1.5"}},
        {2, "--smooth volume= is keep or free", {"--smooth", "taubin:volume=half"}},
        {2, "lock=labels is for meshes", {"--smooth", "taubin:lock=labels"}},
        {2, "--simplify takes", {"--simplify", "half"}},
        {2, "is for surfaces of values", {"--labels", "all", "--smooth-volume", "3"}},
        {3, "no island of any label", {"--labels", "all", "--min-volume", "1e9"}},
    };
    char *folder = run_folder_create();
    write_balls(run_path(folder, "a.nrrd"), nested, 5);
    int files = run_folder_count(folder);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {.arguments = {"convert", "a.nrrd", "-o", "out.ply"}};
        for (int k = 0; k < 6 && cases[i].more[k]; k++)
            desc.arguments[4 + k] = cases[i].more[k];
        fail_in(cases[i].code, folder, cases[i].says, desc);
        assert_int_equal(run_folder_count(folder), files);
    }
    run_write_file(run_path(folder, "a.obj"), box_obj);
    fail_in(2, folder, "do not go with a.obj",
            (run_desc){.arguments = {"convert", "a.obj", "-o", "b.obj", "--largest", "1"}});
    run_result result = run_in(0, folder,
                               (run_desc){.arguments = {"convert", "a.obj", "-o", "b.obj", "--smooth",
                                                        "laplacian:iterations=1", "--report", "-"}});
    assert_true(json_number(result.out, "smooth.iterations") == 1);
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* --- every volume of the data ------------------------------------------------------------------------------------- */

/* What there is no mesh of, and why. */
static const struct {
    const char *name, *says;
} refused[] = {{"BallBinary30x30x30.raw", "does not say how many voxels"},
               {"HeadMRVolume.raw", "does not say how many voxels"},
               {"tooth.raw", "does not say how many voxels"},
               {"MR_truncated.dcm", "ends before its last pixel"}};

static const char *why_refused(const char *name)
{
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        if (strcmp(refused[i].name, name) == 0)
            return refused[i].says;
    return NULL;
}

/* Small files alone where `most` bytes are less than they have. */
static int convert_all(const char *folder, const char *data, const char *subfolder, off_t most)
{
    char directory[2048], path[4096];
    snprintf(directory, sizeof directory, "%s/%s", data, subfolder);
    DIR *all = opendir(directory);
    int count = 0;
    if (!all)
        return 0;
    for (struct dirent *entry; (entry = readdir(all)) != NULL;) {
        struct stat facts;
        snprintf(path, sizeof path, "%s/%s", directory, entry->d_name);
        const char *says = why_refused(entry->d_name);
        bool is_folder = stat(path, &facts) == 0 && S_ISDIR(facts.st_mode);
        if (entry->d_name[0] == '.' || ((is_folder || facts.st_size > most) && most > 0))
            continue;
        run_desc desc = {.arguments = {"convert", path, "-o", "out.stl"}};
        count++;
        if (says) {
            fail_in(says[0] == 'd' ? 2 : 3, folder, says, desc);
            continue;
        }
        for (int way = 0; way < 2; way++) {
            if (most > 0 && way != count % 2)
                continue;
            desc.arguments[4] = "--method";
            desc.arguments[5] = way == 0 ? "mc33" : "nets";
            run_result result = run_in(0, folder, desc);
            assert_has(result.err, "closed, manifold, oriented");
            run_result_destroy(&result);
            result = run_in(0, folder,
                            (run_desc){.arguments = {"check", "out.stl", "--require", "closed,manifold,oriented",
                                                     "--no-self-intersections"}});
            run_result_destroy(&result);
        }
    }
    closedir(all);
    return count;
}

static void test_all_data(void **state)
{
    (void)state;
    const char *known = run_data_file("volume/fuel.nii.gz"); /* skips where there is no data */
    char *folder = run_folder_create(), data[2048];
    snprintf(data, sizeof data, "%.*s", (int)(strlen(known) - strlen("/volume/fuel.nii.gz")), known);
    off_t most = getenv("HEWN_LONG") ? 0 : 140000;
    int count = convert_all(folder, data, "volume", most) + convert_all(folder, data, "vdb", most) +
                convert_all(folder, data, "dicom", most);
    assert_true(count >= (most > 0 ? 12 : 36));
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bodies), cmocka_unit_test(test_smoothed_values), cmocka_unit_test(test_refined_meshes),
        cmocka_unit_test(test_labels), cmocka_unit_test(test_bad_requests),    cmocka_unit_test(test_all_data),
    };
    return cmocka_run_group_tests_name("volume_steps", tests, NULL, NULL);
}
