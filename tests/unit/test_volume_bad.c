/* Volume files that lie, end early or make no sense: each is refused with a reason, and nothing large is allocated. */
#include <sys/resource.h>
#include <zlib.h>

#include "volume_files.h"

static void assert_bad_nifti(const hewn_text *text, const char *part)
{
    assert_bad_volume(hewn_nifti_read, text->bytes, text->length, part);
}

static hewn_text make_nifti(void)
{
    truth known = make_truth();
    nifti_desc desc = {.type = HEWN_VOXEL_INT16, .frames = 1};
    hewn_text text = {0};
    put_nifti_header(&text, &desc, &known);
    put_samples(&text, desc.type, 1, false);
    return text;
}

static void test_nifti(void **state)
{
    (void)state;
    static const struct {
        size_t at, size;
        double value; /* as a float where size is 4 */
        const char *part;
    } cases[] = {
        {40, 2, 0, "0 axes"},
        {40, 2, 9, "9 axes"},
        {42, 2, 0, "0 voxels along axis 1"},
        {42, 2, -3, "-3 voxels along axis 1"},
        {46, 2, 32000, "bytes of samples, but there are only 120"},
        {108, 4, 1e30, "begin before the file"},
        {108, 4, 1e9, "but there are only 0"},
        {70, 2, 128, "colours"},
        {70, 2, 77, "type 77"},
        {112, 4, INFINITY, "infinite"},
        {280, 4, NAN, "not finite"},
        {344, 1, 'x', "file of their own"},
        {0, 4, 3, "no known size"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hewn_text text = make_nifti();
        if (cases[i].size == 4)
            poke_real(&text, cases[i].at, 4, false, cases[i].value);
        else
            poke(&text, cases[i].at, cases[i].size, false, (int64_t)cases[i].value);
        assert_bad_nifti(&text, cases[i].part);
        hewn_text_clear(&text);
    }
    hewn_text text = make_nifti();
    for (size_t length = 0; length < text.length; length++)
        assert_bad_volume(hewn_nifti_read, text.bytes, length, "");
    for (size_t row = 0; row < 3; row++) /* the third column becomes the first */
        memcpy(text.bytes + 280 + 16 * row + 8, text.bytes + 280 + 16 * row, 4);
    assert_bad_nifti(&text, "singular");
    for (size_t row = 0; row < 3; row++)
        poke_real(&text, 280 + 16 * row + 8, 4, false, 0);
    assert_bad_nifti(&text, "spacing of the voxels along axis 3 is 0");
    poke(&text, 254, 2, false, 0); /* no affine; spacings alone */
    poke_real(&text, 80, 4, false, 0);
    assert_bad_nifti(&text, "spacing of the voxels along axis 1 is 0");
    hewn_text_clear(&text);
}

static void assert_bad_nrrd(const char *text, const char *part)
{
    assert_bad_volume(hewn_nrrd_read, text, strlen(text), part);
}

#define NRRD "NRRD0004\ntype: uchar\ndimension: 3\n"
#define NRRD_RAW NRRD "sizes: 2 2 2\nencoding: raw\n"

static void test_nrrd(void **state)
{
    (void)state;
    assert_bad_nrrd("NRRX0004\n", "not an NRRD");
    assert_bad_nrrd("NRRD0004\n\n", "does not tell the dimension");
    assert_bad_nrrd(NRRD "encoding: raw\n\n", "does not tell the sizes");
    assert_bad_nrrd(NRRD "sizes: 2 2 2\n\n12345678", "does not tell the encoding");
    assert_bad_nrrd("NRRD0004\ndimension: 1\nsizes: 2\nencoding: raw\n\n12", "does not tell the type");
    assert_bad_nrrd("NRRD0004\ntype: short\ndimension: 1\nsizes: 1\nencoding: raw\n\n12", "byte order");
    assert_bad_nrrd("NRRD0004\ntype: block\n", "not a type");
    assert_bad_nrrd("NRRD0004\ndimension: 17\n", "dimension");
    assert_bad_nrrd("NRRD0004\nsizes: 1\n", "before the dimension");
    assert_bad_nrrd(NRRD "sizes: 2 2\n", "whole number");
    assert_bad_nrrd(NRRD "sizes: 2 0 2\n", "whole number");
    assert_bad_nrrd(NRRD "sizes: 2 4294967296 2\n", "whole number");
    assert_bad_nrrd(NRRD "sizes: 4000000000 4000000000 4000000000\nencoding: raw\n\n", "");
    assert_bad_nrrd(NRRD "sizes: 100000 100000 100\nencoding: raw\n\n12",
                    "1000000000000 bytes of samples, but there are only 2");
    assert_bad_nrrd(NRRD "sizes: 100000 100000 100\nencoding: ascii\n\n1 2", "only 3 bytes of text");
    assert_bad_nrrd(NRRD "sizes: 100000 100000 100\nencoding: hex\n\n12", "only 2 hexadecimal digits");
    assert_bad_nrrd(NRRD_RAW "\n1234567", "8 bytes of samples, but there are only 7");
    assert_bad_nrrd(NRRD_RAW "line skip: 9\n\n12345678", "fewer lines");
    assert_bad_nrrd(NRRD_RAW "byte skip: 9\n\n12345678", "fewer bytes");
    assert_bad_nrrd(NRRD_RAW "data file: other.raw\n", "file of their own");
    assert_bad_nrrd(NRRD_RAW "spacings: 1 0 1\n\n12345678", "spacing of the voxels along axis 2 is 0");
    assert_bad_nrrd(NRRD_RAW "spacings: 1 inf 1\n\n12345678", "not finite");
    assert_bad_nrrd(NRRD_RAW "space directions: (1,0,0) (0,1,0) (0,0,1)\n", "before the space");
    assert_bad_nrrd(NRRD_RAW "space: LPS\nspace directions: (1,0,0) (0,1,0)\n", "not a vector");
    assert_bad_nrrd(NRRD_RAW "space: LPS\nspace directions: (1,0,0) (0,1,0) (1,1,0)\n\n12345678", "singular");
    assert_bad_nrrd(NRRD_RAW "space: nowhere\n", "unknown space");
    assert_bad_nrrd(NRRD_RAW "space: LPS\nspace units: \"mm\" \"m\" \"mm\"\n", "different units");
    assert_bad_nrrd(NRRD "sizes: 2 2 2\nencoding: ascii\n\n1 2 3 4 5 6 7      ", "text ends before sample 8");
    assert_bad_nrrd(NRRD "sizes: 2 2 2\nencoding: ascii\n\n1 2 3 4 5 6 7 256",
                    "sample 8 of 8 is not a number of the type uint8");
    assert_bad_nrrd(NRRD "sizes: 2 2 2\nencoding: hex\n\n0123456789abcdeg", "hexadecimal");
    assert_bad_nrrd(NRRD "sizes: 2 2 2\nencoding: gzip\n\nnot packed at all", "damaged");
    assert_bad_nrrd(NRRD "sizes: 2 2 2\nencoding: bzip2\n\nnot packed at all", "damaged");
    assert_bad_nrrd(NRRD "no colon here\n", "field: value");
    assert_bad_nrrd(
        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 1 1 1 1\nencoding: raw\nkinds: domain domain domain domain\n\n1",
        "more than three");
}

static void test_nrrd_names(void **state)
{
    (void)state;
    static const char *const names[] = {"../up.raw", "/etc/passwd", "a/../../up.raw", ".."};
    static const hewn_volume_read_desc desc;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char text[256];
        hewn_volume volume;
        hewn_error error = {0};
        int length = snprintf(text, sizeof text, NRRD_RAW "data file: %s\n", names[i]);
        hewn_volume_source source = {
            .bytes = text, .length = (size_t)length, .name = "given", .path = "folder/a.nhdr", .desc = &desc};
        assert_int_equal(hewn_nrrd_read(&source, &volume, &error), HEWN_BAD_INPUT);
        assert_non_null(strstr(error.message, "leads out of the header's folder"));
    }
}

/* Every length of a gzip stream, and each of its bytes changed. */
static void test_damaged_packing(void **state)
{
    (void)state;
    static const char head[] = NRRD "sizes: 20 20 20\nencoding: gzip\n\n";
    char samples[8000], file[10000];
    for (size_t i = 0; i < sizeof samples; i++)
        samples[i] = (char)(i * i >> 7);
    z_stream stream = {0};
    memcpy(file, head, sizeof head - 1);
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = (Bytef *)samples;
    stream.avail_in = sizeof samples;
    stream.next_out = (Bytef *)file + sizeof head - 1;
    stream.avail_out = sizeof file - sizeof head + 1;
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    size_t length = sizeof file - stream.avail_out;
    deflateEnd(&stream);
    for (size_t cut = sizeof head - 1; cut < length; cut += cut < length - 20 ? 13 : 1)
        assert_bad_volume(hewn_nrrd_read, file, cut, "");
    for (size_t at = sizeof head + 11; at < length; at += 7) {
        file[at] ^= 0x10;
        assert_bad_volume(hewn_nrrd_read, file, length, "");
        file[at] ^= 0x10;
    }
    /* A header that claims more than comes out gets no more room than comes out. */
    char liar[10000];
    int used = snprintf(liar, sizeof liar, NRRD "sizes: 20 20 20000000\nencoding: gzip\n\n");
    memcpy(liar + used, file + sizeof head - 1, length - sizeof head + 1);
    assert_bad_volume(hewn_nrrd_read, liar, (size_t)used + length - sizeof head + 1, "but there are only 8000");
}

static void assert_bad_meta(const char *text, const char *part)
{
    assert_bad_volume(hewn_metaimage_read, text, strlen(text), part);
}

#define META "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n"

static void test_metaimage(void **state)
{
    (void)state;
    assert_bad_meta("", "no DimSize");
    assert_bad_meta("NDims = 11\n", "NDims");
    assert_bad_meta("DimSize = 2 2 2\n", "before NDims");
    assert_bad_meta("NDims = 3\nDimSize = 2 2\n", "DimSize");
    assert_bad_meta("NDims = 3\nDimSize = 2 2 2\nElementType = MET_STRING\n", "not a type");
    assert_bad_meta(META, "no ElementDataFile");
    assert_bad_meta(META "ElementDataFile = LOCAL\n1234567", "8 bytes of samples, but there are only 7");
    assert_bad_meta(META "ElementDataFile = other.raw\n", "file of their own");
    assert_bad_meta(META "ElementSpacing = 1 0 1\nElementDataFile = LOCAL\n12345678",
                    "spacing of the voxels along axis 2 is 0");
    assert_bad_meta(META "ElementSpacing = 1 nan 1\nElementDataFile = LOCAL\n12345678", "not finite");
    assert_bad_meta(META "TransformMatrix = 1 0 0 1 0 0 0 0 1\nElementDataFile = LOCAL\n12345678", "singular");
    assert_bad_meta(META "TransformMatrix = 1 0 0 1\nElementDataFile = LOCAL\n12345678", "as many numbers");
    assert_bad_meta(META "ElementToIntensityFunctionSlope = 0\nElementDataFile = LOCAL\n12345678", "says nothing");
    assert_bad_meta(META "ElementNumberOfChannels = 9223372036854775807\nElementDataFile = LOCAL\n12345678", "");
    assert_bad_meta(META "CompressedData = True\nElementDataFile = LOCAL\n12345678", "damaged");
    assert_bad_meta("nothing = 1\nrubbish\n", "Key = value");
}

static void assert_bad_npy(const char *header, const char *part)
{
    char file[512];
    size_t length = strlen(header);
    memcpy(file, "\x93NUMPY\1\0", 8);
    file[8] = (char)length;
    file[9] = (char)(length >> 8);
    memcpy(file + 10, header, length);
    assert_bad_volume(hewn_npy_read, file, 10 + length, part);
}

static void test_npy(void **state)
{
    (void)state;
    assert_bad_npy("[]", "not a dictionary");
    assert_bad_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 2), }",
                   "32 bytes of samples, but there are only 0");
    assert_bad_npy("{'descr': '<c8', 'fortran_order': False, 'shape': (2, 2, 2), }", "'<c8'");
    assert_bad_npy("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (2,), }", "no simple type");
    assert_bad_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (), }", "single number");
    assert_bad_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 1, 1, 1), }", "1 to 4");
    assert_bad_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (0, 1), }", "no voxels along axis 2");
    assert_bad_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999, 1), }", "past what is possible");
    assert_bad_npy("{'descr': '<f4', 'shape': (1, 1), }", "incomplete");
    assert_bad_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1)", "damaged");
    assert_bad_volume(hewn_npy_read, "\x93NUMPY\1\0\xff\xff{}", 12, "longer than the file");
    assert_bad_volume(hewn_npy_read, "\x93NUMPY\7\0\0\0\0\0", 12, "version 7");
}

static void test_others(void **state)
{
    (void)state;
    static const hewn_volume_format_read readers[] = {hewn_tiff_read, hewn_vdb_read, hewn_dicom_read, hewn_inr_read,
                                                      hewn_nifti_read};
    char rubbish[600];
    for (size_t i = 0; i < sizeof rubbish; i++)
        rubbish[i] = (char)(i * 37 >> 2);
    for (size_t i = 0; i < sizeof readers / sizeof *readers; i++) {
        assert_bad_volume(readers[i], rubbish, sizeof rubbish, "");
        assert_bad_volume(readers[i], rubbish, 0, "");
    }
    /* A TIFF page that claims a million by a million pixels. */
    static const unsigned char page[] = {'I', 'I', 42,   0, 8,  0, 0, 0, 4, 0,  0,  1,  4, 0, 1, 0, 0, 0, 64, 66, 15,
                                         0,   1,   1,    4, 0,  1, 0, 0, 0, 64, 66, 15, 0, 2, 1, 3, 0, 1, 0,  0,  0,
                                         8,   0,   0x00, 0, 17, 1, 4, 0, 1, 0,  0,  0,  8, 0, 0, 0, 0, 0, 0,  0};
    assert_bad_volume(hewn_tiff_read, page, sizeof page, "");
}

static void test_arguments(void **state)
{
    (void)state;
    hewn_volume volume;
    hewn_error error = {0};
    assert_int_equal(hewn_volume_read("nowhere.nii", NULL, &volume, &error), HEWN_IO);
    assert_int_equal(hewn_volume_read("nowhere.obj", NULL, &volume, &error), HEWN_INVALID_ARGUMENT);
    assert_non_null(strstr(error.message, ".nrrd"));
    assert_int_equal(
        hewn_volume_read("/dev/null", &(hewn_volume_read_desc){.format = HEWN_VOLUME_RAW}, &volume, &error),
        HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_volume_format_of("a/b.NII.GZ"), HEWN_VOLUME_NIFTI);
    assert_int_equal(hewn_volume_format_of("vdb"), HEWN_VOLUME_VDB);
    assert_int_equal(hewn_volume_format_of("a/vdb"), HEWN_VOLUME_UNKNOWN);
    for (int format = HEWN_VOLUME_NIFTI; format <= HEWN_VOLUME_DICOM; format++) {
        hewn_volume_format found;
        assert_true(hewn_volume_format_find(hewn_volume_format_name((hewn_volume_format)format), &found));
        assert_int_equal(found, format);
    }
    assert_null(hewn_volume_format_name(HEWN_VOLUME_UNKNOWN));
}

int main(void)
{
    /* What allocates what a header claims fails here, or in the kernel. */
    const struct rlimit limit = {(rlim_t)8 << 30, (rlim_t)8 << 30};
#ifndef __SANITIZE_ADDRESS__
    setrlimit(RLIMIT_AS, &limit);
#else
    (void)limit;
#endif
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nifti),     cmocka_unit_test(test_nrrd),      cmocka_unit_test(test_nrrd_names),
        cmocka_unit_test(test_metaimage), cmocka_unit_test(test_npy),       cmocka_unit_test(test_damaged_packing),
        cmocka_unit_test(test_others),    cmocka_unit_test(test_arguments),
    };
    return cmocka_run_group_tests_name("bad volumes", tests, NULL, NULL);
}
