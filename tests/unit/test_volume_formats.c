/* Every format of volumes, of every type, byte order and packing that it has: each voxel has its value, at its place.
 */
#include <bzlib.h>
#include <zlib.h>

#include "volume_files.h"

/* A file in a folder of its own, read, and taken away again. */
static hewn_volume through_file(const hewn_text *text, const char *name, const hewn_volume_read_desc *desc)
{
    char folder[64], path[128];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    write_text(path, text);
    hewn_volume volume = read_volume(path, desc);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
    return volume;
}

static void put_gzip(hewn_text *text, const hewn_text *from, int window)
{
    char packed[1 << 16];
    z_stream stream = {0};
    assert_int_equal(deflateInit2(&stream, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = (Bytef *)from->bytes;
    stream.avail_in = (unsigned)from->length;
    stream.next_out = (Bytef *)packed;
    stream.avail_out = sizeof packed;
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    hewn_text_append_bytes(text, packed, sizeof packed - stream.avail_out);
    deflateEnd(&stream);
}

static void put_bzip2(hewn_text *text, const hewn_text *from)
{
    char packed[1 << 16];
    unsigned length = sizeof packed;
    assert_int_equal(BZ2_bzBuffToBuffCompress(packed, &length, from->bytes, (unsigned)from->length, 1, 0, 0), BZ_OK);
    hewn_text_append_bytes(text, packed, length);
}

static void test_nifti(void **state)
{
    (void)state;
    truth known = make_truth();
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++) {
        for (int variant = 0; variant < 16 && type != HEWN_VOXEL_HALF; variant++) {
            nifti_desc desc = {
                .second = variant & 1, .big = variant & 2, .qform = variant & 4, .type = (hewn_voxel)type};
            desc.frames = variant & 8 ? 3 : 1;
            hewn_text text = {0}, packed = {0};
            put_nifti_header(&text, &desc, &known);
            put_samples(&text, desc.type, desc.frames, desc.big);
            put_gzip(&packed, &text, 16 + MAX_WBITS);
            hewn_volume plain = through_file(&text, "a.nii", NULL),
                        from_packed = through_file(&packed, "a.nii.gz", NULL);
            assert_true_places(&plain, &known, desc.type, desc.frames);
            assert_true_places(&from_packed, &known, desc.type, desc.frames);
            assert_true_samples(&plain, desc.type, desc.frames);
            assert_true(plain.anatomical && plain.unit == hewn_unit_find("mm"));
            assert_true(hewn_volume_determinant(&plain) < 0);
            hewn_volume_destroy(&plain);
            hewn_volume_destroy(&from_packed);
            hewn_text_clear(&text);
            hewn_text_clear(&packed);
        }
    }
}

/* Header and samples apart, named by either, one of them compressed or none. */
static void test_nifti_pair(void **state)
{
    (void)state;
    truth known = make_truth();
    char folder[64], header_path[128], image_path[128];
    make_folder(folder);
    for (int variant = 0; variant < 4; variant++) {
        nifti_desc desc = {.second = variant & 1, .separate = true, .type = HEWN_VOXEL_INT16, .frames = 1};
        hewn_text header = {0}, image = {0}, packed = {0};
        put_nifti_header(&header, &desc, &known);
        put_samples(&image, desc.type, 1, false);
        put_gzip(&packed, &image, 16 + MAX_WBITS);
        snprintf(header_path, sizeof header_path, "%s/pair.hdr", folder);
        snprintf(image_path, sizeof image_path, "%s/pair.img%s", folder, variant & 2 ? ".gz" : "");
        write_text(header_path, &header);
        write_text(image_path, variant & 2 ? &packed : &image);
        hewn_volume by_header = read_volume(header_path, NULL);
        assert_true_places(&by_header, &known, desc.type, 1);
        hewn_volume_destroy(&by_header);
        if (!(variant & 2)) {
            hewn_volume by_image = read_volume(image_path, NULL);
            assert_true_places(&by_image, &known, desc.type, 1);
            hewn_volume_destroy(&by_image);
        }
        assert_int_equal(unlink(image_path), 0);
        hewn_volume none;
        hewn_error error = {0};
        assert_int_equal(hewn_volume_read(header_path, NULL, &none, &error), HEWN_IO);
        assert_non_null(strstr(error.file, "pair.img"));
        assert_int_equal(unlink(header_path), 0);
        hewn_text_clear(&header);
        hewn_text_clear(&image);
        hewn_text_clear(&packed);
    }
    assert_int_equal(rmdir(folder), 0);
}

static void test_nifti_scale(void **state)
{
    (void)state;
    truth known = make_truth();
    const struct {
        double slope, intercept, wanted_slope, wanted_intercept;
    } cases[] = {{0, 7, 1, 0}, {2.5, -3, 2.5, -3}, {NAN, 3, 1, 0}, {-1, 0, -1, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        nifti_desc desc = {.type = HEWN_VOXEL_UINT8, .frames = 1};
        hewn_text text = {0};
        put_nifti_header(&text, &desc, &known);
        poke_real(&text, 112, 4, false, cases[i].slope);
        poke_real(&text, 116, 4, false, cases[i].intercept);
        put_samples(&text, desc.type, 1, false);
        hewn_volume volume = through_file(&text, "a.nii", NULL);
        assert_true(volume.slope == cases[i].wanted_slope && volume.intercept == cases[i].wanted_intercept);
        assert_int_equal(volume.type, HEWN_VOXEL_UINT8);
        hewn_volume_range range = hewn_volume_find_range(&volume, 0);
        assert_true(range.lo <= range.hi);
        assert_true(hewn_volume_value(&volume, 3) == cases[i].wanted_slope * 3 + cases[i].wanted_intercept);
        hewn_volume_destroy(&volume);
        hewn_text_clear(&text);
    }
}

static void put_nrrd_samples(hewn_text *text, const hewn_text *samples, hewn_voxel type, int encoding)
{
    static const char *const names[] = {"raw", "gzip", "bzip2", "hex", "ascii"};
    hewn_text_print(text, "encoding: %s\n\n", names[encoding]);
    if (encoding == 0)
        hewn_text_append_bytes(text, samples->bytes, samples->length);
    else if (encoding == 1)
        put_gzip(text, samples, 16 + MAX_WBITS);
    else if (encoding == 2)
        put_bzip2(text, samples);
    for (size_t i = 0; encoding == 3 && i < samples->length; i++)
        hewn_text_print(text, "%02x%s", (unsigned char)samples->bytes[i], i % 20 == 19 ? "\n" : "");
    for (int index = 0; encoding == 4 && index < TRUTH_FRAME; index++)
        hewn_text_print(text, "%.17g%s",
                        truth_sample(type, index % TRUTH_X, index / TRUTH_X % TRUTH_Y, index / (TRUTH_X * TRUTH_Y), 0),
                        index % 7 == 6 ? "\n" : " ");
}

static void test_nrrd(void **state)
{
    (void)state;
    static const char *const letters[] = {"RAS", "LPS", "LAS"};
    truth known = make_truth();
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++) {
        for (int encoding = 0; encoding < 5 && type != HEWN_VOXEL_HALF; encoding++) {
            for (int big = 0; big < 2; big++) {
                hewn_text text = {0}, samples = {0};
                int space = (type + encoding + big) % 3;
                put_nrrd_header(&text, &known, (hewn_voxel)type, 1, false, letters[space], big);
                put_samples(&samples, (hewn_voxel)type, 1, big);
                put_nrrd_samples(&text, &samples, (hewn_voxel)type, encoding);
                hewn_volume volume = through_file(&text, "a.nrrd", NULL);
                assert_true_places(&volume, &known, (hewn_voxel)type, 1);
                assert_true(volume.anatomical && volume.unit == hewn_unit_find("mm"));
                hewn_volume_destroy(&volume);
                hewn_text_clear(&text);
                hewn_text_clear(&samples);
            }
        }
    }
}

static void test_nrrd_frames(void **state)
{
    (void)state;
    truth known = make_truth();
    for (int first = 0; first < 2; first++) {
        hewn_text text = {0};
        put_nrrd_header(&text, &known, HEWN_VOXEL_UINT16, 3, first, "LPS", true);
        hewn_text_append(&text, "encoding: raw\n\n");
        if (first)
            put_interleaved(&text, HEWN_VOXEL_UINT16, 3, true);
        else
            put_samples(&text, HEWN_VOXEL_UINT16, 3, true);
        hewn_volume volume = through_file(&text, "a.nrrd", NULL);
        assert_true_places(&volume, &known, HEWN_VOXEL_UINT16, 3);
        hewn_volume_destroy(&volume);
        hewn_text_clear(&text);
    }
}

/* Where a detached header's samples are: one file, a list of names, a pattern of names; bytes and lines before them. */
static void test_nrrd_detached(void **state)
{
    (void)state;
    static const char *const ways[] = {"data file: all.raw\nline skip: 1\nbyte skip: 3\n",
                                       "data file: ./all.raw\nbyte skip: -1\n", "data file: part%02d.raw 3 1 -1\n",
                                       "data file: LIST\npart03.raw\npart02.raw\npart01.raw\n"};
    truth known = make_truth();
    char folder[64], path[128];
    make_folder(folder);
    hewn_text samples = {0}, all = {0};
    put_samples(&samples, HEWN_VOXEL_INT32, 1, true);
    hewn_text_append(&all, "a line\nabc");
    hewn_text_append_bytes(&all, samples.bytes, samples.length);
    snprintf(path, sizeof path, "%s/all.raw", folder);
    write_text(path, &all);
    for (size_t k = 0; k < TRUTH_Z; k++) {
        size_t slice = samples.length / TRUTH_Z;
        hewn_text part = {.bytes = samples.bytes + k * slice, .length = slice};
        snprintf(path, sizeof path, "%s/part%02zu.raw", folder, TRUTH_Z - k);
        write_text(path, &part);
    }
    for (size_t way = 0; way < sizeof ways / sizeof *ways; way++) {
        hewn_text header = {0};
        put_nrrd_header(&header, &known, HEWN_VOXEL_INT32, 1, false, "RAS", true);
        hewn_text_print(&header, "encoding: raw\n%s", ways[way]);
        snprintf(path, sizeof path, "%s/a.nhdr", folder);
        write_text(path, &header);
        hewn_volume volume = read_volume(path, NULL);
        assert_true_places(&volume, &known, HEWN_VOXEL_INT32, 1);
        hewn_volume_destroy(&volume);
        assert_int_equal(unlink(path), 0);
        hewn_text_clear(&header);
    }
    static const char *const names[] = {"all.raw", "part01.raw", "part02.raw", "part03.raw"};
    for (size_t i = 0; i < 4; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        assert_int_equal(unlink(path), 0);
    }
    assert_int_equal(rmdir(folder), 0);
    hewn_text_clear(&samples);
    hewn_text_clear(&all);
}

static void test_metaimage(void **state)
{
    (void)state;
    truth known = make_truth();
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++) {
        for (int variant = 0; variant < 8 && type != HEWN_VOXEL_HALF; variant++) {
            bool big = variant & 1, packed = variant & 2;
            int channels = variant & 4 ? 2 : 1;
            hewn_text text = {0}, samples = {0};
            put_meta_header(&text, &known, (hewn_voxel)type, channels, big, packed);
            hewn_text_append(&text, "ElementDataFile = LOCAL\n");
            put_interleaved(&samples, (hewn_voxel)type, channels, big);
            if (packed)
                put_gzip(&text, &samples, MAX_WBITS);
            else
                hewn_text_append_bytes(&text, samples.bytes, samples.length);
            hewn_volume volume = through_file(&text, "a.mha", NULL);
            assert_true_places(&volume, &known, (hewn_voxel)type, channels);
            hewn_volume_destroy(&volume);
            hewn_text_clear(&text);
            hewn_text_clear(&samples);
        }
    }
}

static void test_metaimage_detached(void **state)
{
    (void)state;
    truth known = make_truth();
    char folder[64], header_path[128], data_path[128];
    make_folder(folder);
    hewn_text header = {0}, samples = {0};
    put_meta_header(&header, &known, HEWN_VOXEL_FLOAT, 1, false, false);
    hewn_text_append(&header, "HeaderSize = -1\nElementDataFile = with a blank.raw\n");
    hewn_text_append(&samples, "before");
    put_samples(&samples, HEWN_VOXEL_FLOAT, 1, false);
    snprintf(header_path, sizeof header_path, "%s/a.mhd", folder);
    snprintf(data_path, sizeof data_path, "%s/with a blank.raw", folder);
    write_text(header_path, &header);
    write_text(data_path, &samples);
    hewn_volume volume = read_volume(header_path, NULL);
    assert_true_places(&volume, &known, HEWN_VOXEL_FLOAT, 1);
    hewn_volume_destroy(&volume);
    assert_int_equal(unlink(header_path), 0);
    assert_int_equal(unlink(data_path), 0);
    assert_int_equal(rmdir(folder), 0);
    hewn_text_clear(&header);
    hewn_text_clear(&samples);
}

static void test_npy(void **state)
{
    (void)state;
    static const char *const codes[HEWN_VOXEL_COUNT] = {"i1", "u1", "i2", "u2", "i4", "u4",
                                                        "i8", "u8", "f2", "f4", "f8"};
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++) {
        for (int variant = 0; variant < 8; variant++) {
            bool big = variant & 1, fortran = variant & 2;
            int frames = variant & 4 ? 2 : 1;
            char shape[64], header[128];
            int x = TRUTH_X, y = TRUTH_Y, z = TRUTH_Z;
            if (frames > 1)
                snprintf(shape, sizeof shape, fortran ? "%d, %d, %d, 2" : "2, %d, %d, %d", fortran ? x : z, y,
                         fortran ? z : x);
            else
                snprintf(shape, sizeof shape, "%d, %d, %d", fortran ? x : z, y, fortran ? z : x);
            int length = snprintf(header, sizeof header, "{'descr': '%c%s', 'fortran_order': %s, 'shape': (%s), }\n",
                                  big ? '>' : '<', codes[type], fortran ? "True" : "False", shape);
            hewn_text text = {0};
            const char head[] = {'\x93', 'N', 'U', 'M', 'P', 'Y', 1, 0, (char)length, 0};
            hewn_text_append_bytes(&text, head, sizeof head);
            hewn_text_append(&text, header);
            put_samples(&text, (hewn_voxel)type, frames, big);
            hewn_volume volume = through_file(&text, "a.npy", NULL);
            assert_true_samples(&volume, (hewn_voxel)type, frames);
            assert_false(volume.anatomical);
            hewn_volume_destroy(&volume);
            hewn_text_clear(&text);
        }
    }
}

static void test_raw(void **state)
{
    (void)state;
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++) {
        for (int big = 0; big < 2; big++) {
            hewn_volume_read_desc desc = {.format = HEWN_VOLUME_RAW};
            desc.raw = (hewn_raw_desc){
                .dims = {TRUTH_X, TRUTH_Y, TRUTH_Z}, .frame_count = 2, .type = (hewn_voxel)type, .big_endian = big};
            desc.raw.spacing[0] = 0.5;
            desc.raw.spacing[1] = 2;
            desc.raw.spacing[2] = 3;
            desc.raw.offset = 5;
            hewn_text text = {0};
            hewn_text_append(&text, "skip!");
            put_samples(&text, (hewn_voxel)type, 2, big);
            hewn_volume volume = through_file(&text, "a.bin", &desc);
            double spacing[3];
            assert_true_samples(&volume, (hewn_voxel)type, 2);
            hewn_volume_spacing(&volume, spacing);
            assert_true(spacing[0] == 0.5 && spacing[1] == 2 && spacing[2] == 3);
            hewn_volume_destroy(&volume);
            hewn_text_clear(&text);
        }
    }
}

static void test_inr(void **state)
{
    (void)state;
    hewn_text text = {0};
    hewn_text_append(&text, "#INRIMAGE-4#{\nXDIM=5\nYDIM=4\nZDIM=3\nVDIM=2\nTYPE=signed fixed\nPIXSIZE=16 "
                            "bits\nCPU=sun\nVX=0.5\nVY=2\nVZ=3\n");
    while (text.length < 252)
        hewn_text_append(&text, "\n");
    hewn_text_append(&text, "##}\n");
    put_interleaved(&text, HEWN_VOXEL_INT16, 2, true);
    hewn_volume volume = through_file(&text, "a.inr", NULL);
    assert_true_samples(&volume, HEWN_VOXEL_INT16, 2);
    assert_true(volume.to_world[0] == 0.5 && volume.to_world[5] == 2 && volume.to_world[10] == 3);
    hewn_volume_destroy(&volume);
    hewn_text_clear(&text);
}

/* A folder whose files' names and numbers run against the slices' order, with something else among them. */
static void write_series(const char *folder, const truth *known, int skipped, double last_slope, const char *series)
{
    for (int k = 0; k < TRUTH_Z + 2; k++) {
        char path[128];
        hewn_text text = {0};
        if (k == skipped)
            continue;
        put_dicom_slice(&text, known, k, series, k == TRUTH_Z - 1 ? last_slope : 2);
        snprintf(path, sizeof path, "%s/%s%d", folder, series, 9 - k);
        write_text(path, &text);
        hewn_text_clear(&text);
    }
}

static void remove_files(const char *folder)
{
    char command[128];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    assert_int_equal(system(command), 0);
}

static void test_dicom(void **state)
{
    (void)state;
    truth known = make_truth();
    char folder[64], path[128];
    make_folder(folder);
    for (int k = 0; k < TRUTH_Z; k++) {
        hewn_text text = {0};
        put_dicom_slice(&text, &known, k, "1.2.9", 2);
        snprintf(path, sizeof path, "%s/%d", folder, 9 - k);
        write_text(path, &text);
        hewn_text_clear(&text);
    }
    hewn_volume volume = read_volume(folder, NULL);
    assert_true_places(&volume, &known, HEWN_VOXEL_INT16, 1);
    assert_true(volume.slope == 2 && volume.intercept == -5 && volume.hounsfield && volume.anatomical);
    assert_string_equal(volume.name, "truth");
    assert_null(volume.remark);
    hewn_volume_destroy(&volume);
    hewn_text other = {0};
    hewn_text_append(&other, "read me");
    snprintf(path, sizeof path, "%s/notes.txt", folder);
    write_text(path, &other);
    volume = read_volume(folder, NULL);
    assert_non_null(strstr(volume.remark, "1 file"));
    hewn_volume_destroy(&volume);
    hewn_text_clear(&other);
    remove_files(folder);
}

static void assert_refused_folder(const char *folder, const char *part)
{
    hewn_volume volume;
    hewn_error error = {0};
    assert_int_equal(hewn_volume_read(folder, NULL, &volume, &error), HEWN_BAD_INPUT);
    if (!strstr(error.message, part))
        fail_msg("\"%s\" (not \"%s\")", error.message, part);
}

static void test_dicom_series(void **state)
{
    (void)state;
    truth known = make_truth();
    char folder[64];
    make_folder(folder);
    assert_refused_folder(folder, "no file of the folder");
    write_series(folder, &known, 2, 2, "1.2.9");
    assert_refused_folder(folder, "slices are missing");
    write_series(folder, &known, -1, 4, "1.2.8");
    assert_refused_folder(folder, "2 series; choose one with --series UID: 1.2.8 (CT, 5 files); 1.2.9 (CT, 4 files)");
    /* Slices that are scaled differently become float values. */
    hewn_volume_read_desc desc = {.series = "1.2.8"};
    hewn_volume volume = read_volume(folder, &desc);
    assert_int_equal(volume.type, HEWN_VOXEL_FLOAT);
    assert_int_equal(volume.dims[2], TRUTH_Z + 2);
    hewn_volume_destroy(&volume);
    desc.series = "1.2.7";
    assert_int_equal(hewn_volume_read(folder, &desc, &volume, NULL), HEWN_BAD_INPUT);
    remove_files(folder);
}

/* A file of which each byte in turn is changed, among them some that the library behind the reader ends the process
 * for: this process lives on and says why. */
static void test_dicom_damaged(void **state)
{
    (void)state;
    truth known = make_truth();
    static const hewn_volume_read_desc desc = {.memory_limit = 1 << 24};
    hewn_text text = {0};
    int refused = 0, fatal = 0;
    put_dicom_slice(&text, &known, 0, "1.2.9", 2);
    for (size_t at = 140; at < text.length - TRUTH_X * TRUTH_Y * 2; at += 3) {
        text.bytes[at] ^= 0x40;
        hewn_volume_source source = {.bytes = text.bytes, .length = text.length, .name = "given", .desc = &desc};
        hewn_volume volume;
        hewn_error error = {0};
        if (hewn_dicom_read(&source, &volume, &error) != HEWN_OK) {
            assert_string_equal(error.file, "given");
            refused++;
            fatal += strstr(error.message, "does not survive") != NULL;
        }
        hewn_volume_destroy(&volume);
        text.bytes[at] ^= 0x40;
    }
    print_message("# %d refused, %d of them fatal to the library\n", refused, fatal);
    assert_true(refused > 0);
    hewn_text_clear(&text);
}

/* Who asks for the end while another process reads gets it, however soon that one is done. */
static bool refuse(void *user, const char *stage, double fraction)
{
    (void)stage;
    (void)fraction;
    ++*(int *)user;
    return false;
}

static void test_apart_cancelled(void **state)
{
    (void)state;
    truth known = make_truth();
    int calls = 0;
    const hewn_progress progress = {refuse, &calls};
    const hewn_volume_read_desc desc = {.progress = &progress};
    hewn_text text = {0};
    put_dicom_slice(&text, &known, 0, "1.2.9", 2);
    hewn_volume_source source = {.bytes = text.bytes, .length = text.length, .name = "given", .desc = &desc};
    hewn_volume volume;
    assert_int_equal(hewn_dicom_read(&source, &volume, NULL), HEWN_CANCELLED);
    assert_int_equal(calls, 1);
    assert_null(volume.samples);
    hewn_text_clear(&text);
}

/* Large files are looked at where they lie; what is there is what a small one has. */
static void test_mapped(void **state)
{
    (void)state;
    char folder[64], path[128];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/large.raw", folder);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fseeko(file, (off_t)512 * 512 * 512 * 2 - 2, SEEK_SET), 0); /* a hole: no disk */
    const unsigned char last[] = {0x34, 0x12};
    assert_int_equal(fwrite(last, 1, 2, file), 2);
    assert_int_equal(fclose(file), 0);
    hewn_volume_read_desc desc = {.raw = {.dims = {512, 512, 512}, .type = HEWN_VOXEL_UINT16}, .memory_limit = 1 << 20};
    hewn_volume volume = read_volume(path, &desc);
    assert_true(volume.mapped);
    assert_true(hewn_volume_sample(&volume, (uint64_t)512 * 512 * 512 - 1) == 0x1234);
    hewn_volume_forget(&volume, 0, 0, 512);
    assert_true(hewn_volume_sample(&volume, (uint64_t)512 * 512 * 512 - 1) == 0x1234);
    hewn_volume_destroy(&volume);
    /* Samples that must be turned around cannot stay there, and are over the limit. */
    desc.raw.big_endian = true;
    hewn_error error = {0};
    assert_int_equal(hewn_volume_read(path, &desc, &volume, &error), HEWN_LIMIT);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nifti),         cmocka_unit_test(test_nifti_pair),
        cmocka_unit_test(test_nifti_scale),   cmocka_unit_test(test_nrrd),
        cmocka_unit_test(test_nrrd_frames),   cmocka_unit_test(test_nrrd_detached),
        cmocka_unit_test(test_metaimage),     cmocka_unit_test(test_metaimage_detached),
        cmocka_unit_test(test_npy),           cmocka_unit_test(test_raw),
        cmocka_unit_test(test_inr),           cmocka_unit_test(test_dicom),
        cmocka_unit_test(test_dicom_series),  cmocka_unit_test(test_mapped),
        cmocka_unit_test(test_dicom_damaged), cmocka_unit_test(test_apart_cancelled),
    };
    return cmocka_run_group_tests_name("volume formats", tests, NULL, NULL);
}
