/* Every volume of the test data is read, or refused with the reason; copies of one head in other axes are one head. */
#include <dirent.h>

#include "test_volume_support.h"

/* What must be in a volume of the test data; with a message, how it must be refused. */
typedef struct known {
    const char *name;
    const char *message;
    hewn_voxel type;
    uint32_t dims[3];
    uint64_t frames;
    const char *orientation;
    double lo, hi; /* of frame 0, to 5 digits */
} known;

#define RAW_SAYS "a raw file does not say"

static const known files[] = {
    {"volume/AIL.nii.gz", NULL, HEWN_VOXEL_UINT8, {79, 67, 64}, 1, "AIL", 0, 92.5539},
    {"volume/BallBinary30x30x30.nhdr", NULL, HEWN_VOXEL_INT16, {30, 30, 30}, 1, "LPS", 0, 257},
    {"volume/BallBinary30x30x30.nrrd", NULL, HEWN_VOXEL_INT16, {30, 30, 30}, 1, "LPS", 0, 257},
    {"volume/BallBinary30x30x30.raw", RAW_SAYS, 0, {0}, 0, NULL, 0, 0},
    {"volume/BallBinary30x30x30_gz.nrrd", NULL, HEWN_VOXEL_INT16, {30, 30, 30}, 1, "LPS", 0, 257},
    {"volume/FLAIR.nrrd", NULL, HEWN_VOXEL_UINT8, {124, 160, 140}, 1, "RAS", 0, 255},
    {"volume/HeadMRVolume.mhd", NULL, HEWN_VOXEL_UINT8, {48, 62, 42}, 1, "LPS", 0, 255},
    {"volume/HeadMRVolume.raw", RAW_SAYS, 0, {0}, 0, NULL, 0, 0},
    {"volume/LPS.nii.gz", NULL, HEWN_VOXEL_UINT8, {64, 79, 67}, 1, "LPS", 0, 92.5539},
    {"volume/PSR.nii.gz", NULL, HEWN_VOXEL_UINT8, {79, 67, 64}, 1, "PSR", 0, 92.5539},
    {"volume/RAS.nii.gz", NULL, HEWN_VOXEL_UINT8, {64, 79, 67}, 1, "RAS", 0, 92.5539},
    {"volume/Skull.nrrd", NULL, HEWN_VOXEL_UINT8, {160, 232, 160}, 1, "LPS", 0, 1},
    {"volume/T1.nii.gz", NULL, HEWN_VOXEL_UINT8, {124, 160, 140}, 1, "RAS", 0, 252},
    {"volume/aal.nii.gz", NULL, HEWN_VOXEL_UINT8, {181, 217, 181}, 1, "RAS", 0, 116},
    {"volume/anatomical.nii", NULL, HEWN_VOXEL_INT16, {33, 41, 25}, 1, "LAS", -610, 30393},
    {"volume/ch2bet.nii.gz", NULL, HEWN_VOXEL_UINT8, {181, 217, 181}, 1, "RAS", 0, 133},
    {"volume/engine.nii.gz", NULL, HEWN_VOXEL_UINT8, {256, 256, 128}, 1, "RAS", 0, 255},
    {"volume/example4d.nii.gz", NULL, HEWN_VOXEL_INT16, {128, 96, 24}, 2, "LAS", 0, 1162},
    {"volume/fuel.nii.gz", NULL, HEWN_VOXEL_UINT8, {64, 33, 32}, 1, "RAS", 0, 255},
    {"volume/hippo.nii.gz", NULL, HEWN_VOXEL_FLOAT, {91, 109, 91}, 1, "LAS", 0, 9},
    {"volume/itkBrainSliceComplexMagnitude.mha", NULL, HEWN_VOXEL_FLOAT, {181, 217, 1}, 1, "LPS", 1, 300.561},
    {"volume/mha.mha", NULL, HEWN_VOXEL_INT16, {64, 64, 37}, 1, "LAS", 0, 6690},
    {"volume/skull_2.9.inr", NULL, HEWN_VOXEL_FLOAT, {64, 64, 64}, 1, "???", 0, 5.4288},
    {"volume/template_T2.nrrd", NULL, HEWN_VOXEL_FLOAT, {117, 159, 126}, 1, "LPS", 0, 710.678},
    {"volume/test1d_ascii.nrrd", NULL, HEWN_VOXEL_UINT8, {27, 1, 1}, 1, "???", 1, 27},
    {"volume/tooth.nhdr", NULL, HEWN_VOXEL_UINT16, {103, 94, 161}, 1, "???", 0, 1300},
    {"volume/tooth.raw", RAW_SAYS, 0, {0}, 0, NULL, 0, 0},
    {"volume/torsoLabel.nii.gz", NULL, HEWN_VOXEL_UINT8, {384, 320, 89}, 1, "RAS", 0, 11},
    {"vdb/grid0.vdb", NULL, HEWN_VOXEL_FLOAT, {83, 83, 83}, 1, "???", -0.235319, 1.38177},
    {"vdb/icosahedron.vdb", NULL, HEWN_VOXEL_FLOAT, {145, 151, 167}, 1, "???", -0.150024, 0.150024},
    {"vdb/sphere.vdb", NULL, HEWN_VOXEL_FLOAT, {127, 127, 127}, 1, "???", -0.150024, 0.150024},
    {"dicom/CT_small.dcm", NULL, HEWN_VOXEL_INT16, {128, 128, 1}, 1, "LPS", -896, 1167},
    {"dicom/MR_small.dcm", NULL, HEWN_VOXEL_INT16, {64, 64, 1}, 1, "LPS", 127, 2145},
    {"dicom/MR_truncated.dcm", "ends before its last pixel", 0, {0}, 0, NULL, 0, 0},
    {"dicom/adi", NULL, HEWN_VOXEL_UINT16, {384, 512, 3}, 1, "LPS", 0, 1937},
    {"dicom/seg3d", NULL, HEWN_VOXEL_UINT16, {640, 640, 4}, 1, "LPS", 0, 1452},
};

static void check_file(const known *wanted, const char *path)
{
    hewn_volume volume;
    hewn_error error = {0};
    char orientation[4];
    hewn_result result = hewn_volume_read(path, NULL, &volume, &error);
    print_message("# %s: %s\n", wanted->name, result == HEWN_OK ? "read" : error.message);
    if (wanted->message) {
        assert_true(result == HEWN_BAD_INPUT || result == HEWN_INVALID_ARGUMENT);
        assert_non_null(strstr(error.message, wanted->message));
        return;
    }
    assert_int_equal(result, HEWN_OK);
    assert_int_equal(hewn_volume_check(&volume, NULL), HEWN_OK);
    assert_int_equal(volume.type, wanted->type);
    assert_memory_equal(volume.dims, wanted->dims, sizeof wanted->dims);
    assert_int_equal(volume.frame_count, wanted->frames);
    hewn_volume_orientation(&volume, orientation);
    assert_string_equal(orientation, wanted->orientation);
    hewn_volume_range range = hewn_volume_find_range(&volume, 0);
    assert_true(fabs(range.lo - wanted->lo) <= 1e-5 * fabs(wanted->lo) + 1e-9);
    assert_true(fabs(range.hi - wanted->hi) <= 1e-5 * fabs(wanted->hi) + 1e-9);
    hewn_volume_destroy(&volume);
}

/* How many entries of a folder are not in the list above. */
static int count_strangers(const char *data, const char *folder)
{
    char path[4400];
    int strangers = 0;
    snprintf(path, sizeof path, "%s/%s", data, folder);
    DIR *directory = opendir(path);
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        bool found = entry->d_name[0] == '.';
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        for (size_t i = 0; i < sizeof files / sizeof *files; i++)
            found = found || strcmp(files[i].name, path) == 0;
        if (!found)
            print_message("# %s is new\n", path);
        strangers += !found;
    }
    closedir(directory);
    return strangers;
}

static void test_all(void **state)
{
    (void)state;
    char data[4096], path[4400];
    if (!data_folder(data))
        skip();
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        snprintf(path, sizeof path, "%s/%s", data, files[i].name);
        check_file(&files[i], path);
    }
    assert_int_equal(count_strangers(data, "volume") + count_strangers(data, "vdb") + count_strangers(data, "dicom"),
                     0);
}

/* At every voxel's place in one, the others have a voxel, with the same value. */
static void test_one_head(void **state)
{
    (void)state;
    static const char *const names[] = {"LPS", "PSR", "AIL"};
    char data[4096], path[4400];
    if (!data_folder(data))
        skip();
    snprintf(path, sizeof path, "%s/volume/RAS.nii.gz", data);
    hewn_volume head = read_volume(path, NULL);
    for (size_t n = 0; n < 3; n++) {
        double back[12];
        snprintf(path, sizeof path, "%s/volume/%s.nii.gz", data, names[n]);
        hewn_volume other = read_volume(path, NULL);
        hewn_volume_from_world(&other, back);
        assert_int_equal(hewn_volume_frame_size(&head), hewn_volume_frame_size(&other));
        for (uint64_t index = 0; index < hewn_volume_frame_size(&head); index++) {
            double ijk[3] = {(double)(index % head.dims[0]), (double)(index / head.dims[0] % head.dims[1]),
                             (double)(index / head.dims[0] / head.dims[1])};
            double world[3];
            uint64_t at = 0;
            hewn_volume_to_world(&head, ijk, world);
            for (int axis = 2; axis >= 0; axis--) {
                double there = back[4 * axis] * world[0] + back[4 * axis + 1] * world[1] +
                               back[4 * axis + 2] * world[2] + back[4 * axis + 3];
                assert_true(fabs(there - round(there)) < 1e-4);
                at = at * other.dims[axis] + (uint64_t)round(there);
            }
            if (hewn_volume_value(&head, index) != hewn_volume_value(&other, at))
                fail_msg("%s differs at sample %llu", names[n], (unsigned long long)index);
        }
        hewn_volume_destroy(&other);
    }
    hewn_volume_destroy(&head);
}

/* The same samples with a header of one kind and another. */
static void test_same_samples(void **state)
{
    (void)state;
    char data[4096], path[4400];
    if (!data_folder(data))
        skip();
    snprintf(path, sizeof path, "%s/volume/BallBinary30x30x30.raw", data);
    hewn_volume_read_desc desc = {.raw = {.dims = {30, 30, 30}, .type = HEWN_VOXEL_INT16}};
    hewn_volume raw = read_volume(path, &desc);
    static const char *const names[] = {"BallBinary30x30x30.nhdr", "BallBinary30x30x30.nrrd",
                                        "BallBinary30x30x30_gz.nrrd"};
    for (size_t i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/volume/%s", data, names[i]);
        hewn_volume other = read_volume(path, NULL);
        assert_memory_equal(other.samples, raw.samples, (size_t)30 * 30 * 30 * 2);
        hewn_volume_destroy(&other);
    }
    hewn_volume_destroy(&raw);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all),
        cmocka_unit_test(test_one_head),
        cmocka_unit_test(test_same_samples),
    };
    return cmocka_run_group_tests_name("volume data", tests, NULL, NULL);
}
