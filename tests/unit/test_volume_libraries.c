/* The formats that libraries read for Hewn, with files that the same libraries write: TIFF and OpenVDB; and NIfTI's
 * place in the world as NIfTI's own library has it. */
#include <nifti1_io.h>
#include <tiffio.h>

#include "base/file.h"
#include "io/shim/module.h"
#include "io/shim/vdb.h"
#include "vdb_write.h"
#include "volume_files.h"

/* --- TIFF --------------------------------------------------------------------------------------------------------- */

static void write_tiff(const char *path, hewn_voxel type, const char *mode, uint16_t packing, const char *description)
{
    static const uint16_t kinds[HEWN_VOXEL_COUNT] = {SAMPLEFORMAT_INT,    SAMPLEFORMAT_UINT,  SAMPLEFORMAT_INT,
                                                     SAMPLEFORMAT_UINT,   SAMPLEFORMAT_INT,   SAMPLEFORMAT_UINT,
                                                     SAMPLEFORMAT_INT,    SAMPLEFORMAT_UINT,  SAMPLEFORMAT_IEEEFP,
                                                     SAMPLEFORMAT_IEEEFP, SAMPLEFORMAT_IEEEFP};
    TIFF *file = TIFFOpen(path, mode);
    assert_non_null(file);
    for (int k = 0; k < TRUTH_Z; k++) {
        TIFFSetField(file, TIFFTAG_IMAGEWIDTH, TRUTH_X);
        TIFFSetField(file, TIFFTAG_IMAGELENGTH, TRUTH_Y);
        TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 8 * hewn_voxel_size(type));
        TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, kinds[type]);
        TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(file, TIFFTAG_COMPRESSION, packing);
        TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, 3);
        TIFFSetField(file, TIFFTAG_XRESOLUTION, 4.0);
        TIFFSetField(file, TIFFTAG_YRESOLUTION, 2.0);
        if (description && k == 0)
            TIFFSetField(file, TIFFTAG_IMAGEDESCRIPTION, description);
        for (uint32_t j = 0; j < TRUTH_Y; j++) {
            hewn_text row = {0};
            for (int i = 0; i < TRUTH_X; i++)
                put_sample(&row, type, truth_sample(type, i, (int)j, k, 0), false);
            assert_int_equal(TIFFWriteScanline(file, row.bytes, j, 0), 1);
            hewn_text_clear(&row);
        }
        assert_int_equal(TIFFWriteDirectory(file), 1);
    }
    TIFFClose(file);
}

static void test_tiff(void **state)
{
    (void)state;
    static const char *const modes[] = {"wl", "wb", "wl8"}; /* little, big, BigTIFF */
    static const uint16_t packings[] = {COMPRESSION_NONE, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_LZW};
    char folder[64], path[96];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.tif", folder);
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++) {
        for (int variant = 0; variant < 9; variant++) {
            write_tiff(path, (hewn_voxel)type, modes[variant % 3], packings[variant / 3], NULL);
            hewn_volume volume = read_volume(path, NULL);
            assert_true_samples(&volume, (hewn_voxel)type, 1);
            assert_true(volume.to_world[0] == 1 && !volume.unit);
            hewn_volume_destroy(&volume);
        }
    }
    write_tiff(path, HEWN_VOXEL_UINT16, "wl", COMPRESSION_NONE,
               "ImageJ=1.53t\nimages=3\nslices=3\nunit=micron\nspacing=1.5\n");
    hewn_volume volume = read_volume(path, NULL);
    assert_true(volume.to_world[0] == 0.25 && volume.to_world[5] == 0.5 && volume.to_world[10] == 1.5);
    assert_true(volume.unit == hewn_unit_find("um"));
    hewn_volume_destroy(&volume);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

/* --- OpenVDB ------------------------------------------------------------------------------------------------------ */

/* Every set voxel is in its place with its value, and a layer of background lies around all. */
static void assert_grid(const char *path, const char *grid, hewn_voxel type, const truth *known)
{
    hewn_volume_read_desc desc = {.grid = grid};
    hewn_volume volume = read_volume(path, &desc);
    static const uint32_t dims[3] = {TRUTH_X + 2, TRUTH_Y + 2, TRUTH_Z + 2};
    double back[12];
    hewn_volume_from_world(&volume, back);
    assert_int_equal(volume.type, type);
    assert_string_equal(volume.name, grid ? grid : "fog");
    assert_memory_equal(volume.dims, dims, sizeof dims);
    for (int index = 0; index < TRUTH_FRAME; index++) {
        int i = index % TRUTH_X, j = index / TRUTH_X % TRUTH_Y, k = index / (TRUTH_X * TRUTH_Y);
        const double wanted_at[3] = {i + 1, j + 1, k + 1};
        double place[3], wanted = index / 2.0 + 1;
        truth_place(known, i, j, k, place);
        for (int axis = 0; axis < 3; axis++) {
            double at = back[4 * axis] * place[0] + back[4 * axis + 1] * place[1] + back[4 * axis + 2] * place[2] +
                        back[4 * axis + 3];
            assert_true(fabs(at - wanted_at[axis]) < 1e-4);
        }
        double sample =
            hewn_volume_sample(&volume, (uint64_t)(i + 1 + (TRUTH_X + 2) * (j + 1 + (TRUTH_Y + 2) * (k + 1))));
        assert_true(sample == (type == HEWN_VOXEL_UINT8 ? 1 : type == HEWN_VOXEL_INT32 ? floor(wanted) : wanted));
    }
    hewn_volume_range range = hewn_volume_find_range(&volume, 0);
    assert_true(range.lo == 0);
    hewn_volume_destroy(&volume);
}

static void assert_no_grid(const char *path, const char *grid, const char *part)
{
    hewn_volume_read_desc desc = {.grid = grid};
    hewn_volume volume;
    hewn_error error = {0};
    assert_int_equal(hewn_volume_read(path, &desc, &volume, &error), HEWN_BAD_INPUT);
    if (!strstr(error.message, part))
        fail_msg("\"%s\" (not \"%s\")", error.message, part);
}

static void test_vdb(void **state)
{
    (void)state;
    truth known = make_truth();
    char folder[64], path[96];
    const int32_t dims[3] = {TRUTH_X, TRUTH_Y, TRUTH_Z}, first[3] = {-3, 100, 7};
    double values[TRUTH_FRAME], to_world[16] = {[15] = 1};
    for (int i = 0; i < TRUTH_FRAME; i++)
        values[i] = i / 2.0 + 1;
    for (int row = 0; row < 3; row++) {
        to_world[4 * row + 3] = known.origin[row];
        for (int column = 0; column < 3; column++) {
            to_world[4 * row + column] = known.columns[column][row];
            to_world[4 * row + 3] -= first[column] * known.columns[column][row];
        }
    }
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.vdb", folder);
    vdb_write(path, dims, values, first, to_world);
    assert_grid(path, NULL, HEWN_VOXEL_FLOAT, &known);
    assert_grid(path, "fog", HEWN_VOXEL_FLOAT, &known);
    assert_grid(path, "half", HEWN_VOXEL_FLOAT, &known);
    assert_grid(path, "wide", HEWN_VOXEL_DOUBLE, &known);
    assert_grid(path, "count", HEWN_VOXEL_INT32, &known);
    assert_grid(path, "mask", HEWN_VOXEL_UINT8, &known);
    assert_no_grid(path, "velocity", "not of scalars");
    assert_no_grid(path, "frustum", "frustum");
    assert_no_grid(path, "empty", "no active voxel");
    assert_no_grid(path, "smoke", "there is no grid 'smoke'; there are: velocity (vec3s), fog (float)");
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

/* Leaves hold what the dense way has, wherever a leaf lies within its box. */
static void test_vdb_leaves(void **state)
{
    (void)state;
    char data[4096], path[4200], message[256], *bytes;
    size_t length;
    if (!data_folder(data))
        skip();
    snprintf(path, sizeof path, "%s/vdb/sphere.vdb", data);
    const hewn_vdb_module *module = hewn_module_load("hewn_vdb", message, sizeof message);
    hewn_vdb *grid;
    hewn_vdb_facts facts;
    float samples[HEWN_VDB_LEAF];
    assert_non_null(module);
    assert_int_equal(hewn_file_read(path, SIZE_MAX / 4, &bytes, &length, NULL), HEWN_OK);
    assert_int_equal(module->open(bytes, length, NULL, &grid, &facts, message, sizeof message), HEWN_VDB_OK);
    hewn_free(bytes);
    hewn_volume volume = read_volume(path, NULL);
    assert_true(volume.level_set && facts.level_set && facts.leaf_count > 100);
    uint64_t compared = 0;
    for (uint64_t leaf = 0; leaf < facts.leaf_count; leaf++) {
        int32_t origin[3];
        module->leaf(grid, leaf, origin, samples);
        for (int at = 0; at < HEWN_VDB_LEAF; at++) {
            int64_t i = origin[0] + at % 8 - facts.lo[0] + 1, j = origin[1] + at / 8 % 8 - facts.lo[1] + 1,
                    k = origin[2] + at / 64 - facts.lo[2] + 1;
            if (i < 0 || j < 0 || k < 0 || i >= volume.dims[0] || j >= volume.dims[1] || k >= volume.dims[2])
                continue;
            uint64_t index = (uint64_t)i + volume.dims[0] * ((uint64_t)j + volume.dims[1] * (uint64_t)k);
            assert_true(hewn_volume_sample(&volume, index) == (double)samples[at]);
            compared++;
        }
    }
    assert_true(compared > 10000);
    /* It is what it is called: the distance from a sphere of radius 3 about the origin, where that is near. */
    for (uint64_t index = 0; index < hewn_volume_frame_size(&volume); index += 37) {
        double ijk[3] = {(double)(index % volume.dims[0]), (double)(index / volume.dims[0] % volume.dims[1]),
                         (double)(index / volume.dims[0] / volume.dims[1])},
               at[3];
        hewn_volume_to_world(&volume, ijk, at);
        double distance = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]) - 3;
        if (fabs(distance) < 0.1)
            assert_true(fabs(hewn_volume_sample(&volume, index) - distance) < 2e-3);
    }
    module->close(&grid);
    hewn_volume_destroy(&volume);
}

/* --- NIfTI -------------------------------------------------------------------------------------------------------- */

static void test_nifti_place(void **state)
{
    (void)state;
    char data[4096], path[4400];
    static const char *const names[] = {"AIL.nii.gz",       "LPS.nii.gz",       "PSR.nii.gz",     "RAS.nii.gz",
                                        "T1.nii.gz",        "aal.nii.gz",       "anatomical.nii", "ch2bet.nii.gz",
                                        "engine.nii.gz",    "example4d.nii.gz", "fuel.nii.gz",    "hippo.nii.gz",
                                        "torsoLabel.nii.gz"};
    if (!data_folder(data))
        skip();
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(path, sizeof path, "%s/volume/%s", data, names[i]);
        nifti_image *image = nifti_image_read(path, 0);
        assert_non_null(image);
        hewn_volume volume = read_volume(path, NULL);
        assert_int_equal(volume.dims[0], image->nx);
        assert_int_equal(volume.dims[1], image->ny);
        assert_int_equal(volume.dims[2], image->nz);
        assert_int_equal(hewn_voxel_size(volume.type), image->nbyper);
        const mat44 *wanted = image->sform_code > 0 ? &image->sto_xyz : &image->qto_xyz;
        for (int at = 0; at < 12; at++)
            assert_true(fabs(volume.to_world[at] - (double)wanted->m[at / 4][at % 4]) < 1e-5);
        if (image->scl_slope != 0)
            assert_true(volume.slope == (double)image->scl_slope && volume.intercept == (double)image->scl_inter);
        hewn_volume_destroy(&volume);
        nifti_image_free(image);
    }
}

/* Headers with a rotation, as the library understands them: any quaternion, either handedness. */
static void test_nifti_rotation(void **state)
{
    (void)state;
    random_state random = {8};
    truth known = make_truth();
    static const hewn_volume_read_desc defaults;
    for (int round = 0; round < 300; round++) {
        nifti_desc desc = {.qform = true, .type = HEWN_VOXEL_UINT8, .frames = 1};
        hewn_text text = {0};
        float q[4], length = 0, spacing[3], sign = random_below(&random, 2) ? 1 : -1;
        for (int i = 0; i < 4; i++) {
            q[i] = round % 3 == 0 && i == 0 ? 0 : (float)random_below(&random, 2001) / 1000 - 1; /* half turns too */
            length += q[i] * q[i];
        }
        put_nifti_header(&text, &desc, &known);
        put_samples(&text, desc.type, 1, false);
        for (int i = 0; i < 4; i++)
            q[i] /= sqrtf(length) * (q[0] < 0 ? -1 : 1);
        poke_real(&text, 76, 4, false, sign);
        for (size_t i = 0; i < 3; i++) {
            spacing[i] = 0.1f + (float)random_below(&random, 50) / 10;
            poke_real(&text, 80 + 4 * i, 4, false, spacing[i]);
            poke_real(&text, 256 + 4 * i, 4, false, q[i + 1]);
            poke_real(&text, 268 + 4 * i, 4, false, (double)i - 1);
        }
        mat44 wanted = nifti_quatern_to_mat44(q[1], q[2], q[3], -1, 0, 1, spacing[0], spacing[1], spacing[2], sign);
        hewn_volume_source source = {.bytes = text.bytes, .length = text.length, .name = "given", .desc = &defaults};
        hewn_volume volume;
        assert_int_equal(hewn_nifti_read(&source, &volume, NULL), HEWN_OK);
        for (int at = 0; at < 12; at++)
            assert_true(fabs(volume.to_world[at] - (double)wanted.m[at / 4][at % 4]) < 1e-4 * 5);
        hewn_volume_destroy(&volume);
        hewn_text_clear(&text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tiff),           cmocka_unit_test(test_vdb),
        cmocka_unit_test(test_vdb_leaves),     cmocka_unit_test(test_nifti_place),
        cmocka_unit_test(test_nifti_rotation),
    };
    return cmocka_run_group_tests_name("volume libraries", tests, NULL, NULL);
}
