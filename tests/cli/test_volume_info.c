/* hewn info of volumes: what it tells, as text and JSON, and how it refuses. */
#include <math.h>

#include "mesh_files.h"

/* 4 x 3 x 2 voxels with values from 0 to 23, of which the lattice is LPS with spacings 1, 2 and 3. */
static void write_nrrd(const char *folder)
{
    char text[512];
    int length = snprintf(text, sizeof text,
                          "NRRD0004\ncontent: test\ntype: uchar\ndimension: 3\nsizes: 4 3 2\nspace: LPS\n"
                          "space directions: (1,0,0) (0,2,0) (0,0,3)\nspace origin: (-10,-20,30)\n"
                          "space units: \"mm\" \"mm\" \"mm\"\nencoding: ascii\n\n");
    for (int i = 0; i < 24; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, "%d\n", i);
    run_write_file(run_path(folder, "a.nrrd"), text);
}

static void test_text(void **state)
{
    (void)state;
    static const char *const lines[] = {"a.nrrd: volume (nrrd)\n",  "name         test\n",
                                        "voxels       4 x 3 x 2\n", "type         uint8\n",
                                        "spacing      1 x 2 x 3\n", "unit         mm\n",
                                        "orientation  LPS\n",       "bounds       7,16,30 to 10,20,33 (RAS)\n",
                                        "frames       1\n",         "range        0 to 23\n",
                                        "NaN          0\n",         "iso value    11\n"};
    char *folder = run_folder_create();
    write_nrrd(folder);
    run_result result = run_in(0, folder, (run_desc){.arguments = {"info", "a.nrrd", "--iso", "p50"}});
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        assert_has(result.out, lines[i]);
    assert_string_equal(result.err, "");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_json(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    write_nrrd(folder);
    run_result result = run_in(0, folder, (run_desc){.arguments = {"info", "a.nrrd", "--json", "--iso", "otsu"}});
    assert_true(json_is_valid(result.out));
    assert_string_equal(json_string(result.out, "format"), "nrrd");
    assert_string_equal(json_string(result.out, "type"), "uint8");
    assert_string_equal(json_string(result.out, "orientation"), "LPS");
    assert_string_equal(json_string(result.out, "world"), "RAS");
    assert_string_equal(json_string(result.out, "unit"), "mm");
    assert_int_equal(json_count(result.out, "dims"), 3);
    assert_true(json_number(result.out, "dims.0") == 4 && json_number(result.out, "dims.2") == 2);
    assert_true(json_number(result.out, "spacing.1") == 2);
    assert_int_equal(json_count(result.out, "to_world"), 16);
    assert_true(json_number(result.out, "to_world.0") == -1 && json_number(result.out, "to_world.3") == 10);
    assert_true(json_number(result.out, "range.lo") == 0 && json_number(result.out, "range.hi") == 23);
    assert_true(json_number(result.out, "range.finite") == 24);
    assert_true(json_number(result.out, "iso") == 11.5);
    assert_false(json_bool(result.out, "left_handed"));
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* Samples without a header, from a file and from standard input. */
static void test_raw(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "a.bin"), "xxABCDEFGH");
    run_desc desc = {.arguments = {"info", "a.bin", "--dims", "2,1,1,2", "--type", "int16", "--endian", "big", "--skip",
                                   "2", "--spacing", "1,2,3", "--frame", "1", "--json"}};
    run_result result = run_in(0, folder, desc);
    assert_string_equal(json_string(result.out, "format"), "raw");
    assert_true(json_number(result.out, "frames") == 2 && json_number(result.out, "frame") == 1);
    assert_true(json_number(result.out, "range.lo") == 0x4546 && json_number(result.out, "range.hi") == 0x4748);
    assert_true(json_is_null(result.out, "orientation") && json_is_null(result.out, "unit"));
    run_result_destroy(&result);
    desc = (run_desc){.arguments = {"info", "-", "--from", "raw", "--dims", "10,1,1", "--type", "uint8"},
                      .input = run_path(folder, "a.bin")};
    result = run_in(0, folder, desc);
    assert_has(result.out, "standard input: volume (raw)\n");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        int code;
        const char *arguments[6];
        const char *says;
    } cases[] = {
        {3, {"info", "none.nii"}, "cannot open"},
        {3, {"info", "short.nrrd"}, "1000000 bytes of samples, but there are only 2"},
        {3, {"info", "a.nrrd", "--iso", "99"}, "the values are from 0 to 23"},
        {2, {"info", "a.nrrd", "--iso", "high"}, "an iso value is a number"},
        {2, {"info", "a.nrrd", "--frame", "1"}, "there is no frame 1"},
        {2, {"info", "a.raw"}, "that must be given"},
        {2, {"info", "a.raw", "--dims", "1,1,1"}, "needs both --dims and --type"},
        {2, {"info", "a.raw", "--dims", "1,1", "--type", "int8"}, "--dims takes"},
        {2, {"info", "a.raw", "--dims", "1,1,1", "--type", "byte"}, "--type is"},
        {2, {"info", "a.obj", "--frame", "1"}, "which is a mesh"},
        {2, {"info", "a.nrrd", "-D", "x=1"}, "is a volume"},
        {3, {"info", "."}, "no file of the folder is a DICOM image"},
    };
    char *folder = run_folder_create();
    write_nrrd(folder);
    run_write_file(run_path(folder, "a.raw"), "1");
    run_write_file(run_path(folder, "short.nrrd"),
                   "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 100 100 100\nencoding: raw\n\n12");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {0};
        memcpy(desc.arguments, cases[i].arguments, sizeof cases[i].arguments);
        run_result result = run_in(cases[i].code, folder, desc);
        assert_has(result.err, cases[i].says);
        assert_string_equal(result.out, "");
        run_result_destroy(&result);
    }
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_json),
        cmocka_unit_test(test_raw),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests_name("volume info", tests, NULL, NULL);
}
