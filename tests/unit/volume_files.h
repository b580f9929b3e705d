/* Files of the truth, as other programs would write them, byte by byte: readers are tested against these and not
 * against anything of Hewn. */
#ifndef HEWN_TEST_VOLUME_FILES_H
#define HEWN_TEST_VOLUME_FILES_H

#include "test_volume_support.h"

/* Overwrites bytes of what is there by a number in either order: a whole one, or a float of 4 or 8 bytes. */
static inline void poke(hewn_text *text, size_t at, size_t size, bool big, int64_t value)
{
    for (size_t i = 0; i < size; i++)
        text->bytes[at + (big ? size - 1 - i : i)] = (char)((uint64_t)value >> 8 * i & 0xff);
}

static inline void poke_real(hewn_text *text, size_t at, size_t size, bool big, double value)
{
    float single = (float)value;
    uint32_t four;
    uint64_t eight;
    memcpy(&four, &single, 4);
    memcpy(&eight, &value, 8);
    poke(text, at, size, big, size == 4 ? (int64_t)four : (int64_t)eight);
}

static inline void put_zeroes(hewn_text *text, size_t count)
{
    for (size_t i = 0; i < count; i++)
        hewn_text_append_bytes(text, "", 1);
}

static inline int nifti_code(hewn_voxel type)
{
    static const int codes[HEWN_VOXEL_COUNT] = {256, 2, 4, 512, 8, 768, 1024, 1280, 0, 16, 64};
    return codes[type];
}

/* The quaternion of the truth's directions, the third turned around (qfac -1): from the matrix's trace. */
static inline void find_quatern(const truth *known, double out[3])
{
    double r[3][3], length;
    for (int column = 0; column < 3; column++) {
        length = sqrt(known->columns[column][0] * known->columns[column][0] +
                      known->columns[column][1] * known->columns[column][1] +
                      known->columns[column][2] * known->columns[column][2]);
        for (int row = 0; row < 3; row++)
            r[row][column] = known->columns[column][row] / length * (column == 2 ? -1 : 1);
    }
    double trace = r[0][0] + r[1][1] + r[2][2];
    double a = trace > -0.999 ? sqrt(1 + trace) / 2 : 0;
    assert_true(a > 1e-3);
    out[0] = (r[2][1] - r[1][2]) / (4 * a);
    out[1] = (r[0][2] - r[2][0]) / (4 * a);
    out[2] = (r[1][0] - r[0][1]) / (4 * a);
}

typedef struct nifti_desc {
    bool second, big, qform, separate;
    hewn_voxel type;
    int frames;
} nifti_desc;

/* The header alone, up to where samples begin. */
static inline void put_nifti_header(hewn_text *text, const nifti_desc *desc, const truth *known)
{
    bool wide = desc->second, big = desc->big;
    size_t real = wide ? 8 : 4, dim = wide ? 8 : 2, dims_at = wide ? 16 : 40, pixdim = wide ? 104 : 76;
    int64_t dims[8] = {desc->frames > 1 ? 4 : 3, TRUTH_X, TRUTH_Y, TRUTH_Z, desc->frames, 1, 1, 1};
    double quatern[3];
    put_zeroes(text, desc->separate ? (wide ? 540 : 348) : (wide ? 544 : 352));
    poke(text, 0, 4, big, wide ? 540 : 348);
    memcpy(text->bytes + (wide ? 4 : 344), desc->separate ? (wide ? "ni2" : "ni1") : (wide ? "n+2" : "n+1"), 4);
    for (size_t i = 0; i < 8; i++)
        poke(text, dims_at + i * dim, dim, big, dims[i]);
    poke(text, wide ? 12 : 70, 2, big, nifti_code(desc->type));
    poke(text, wide ? 14 : 72, 2, big, (int64_t)hewn_voxel_size(desc->type) * 8);
    if (wide)
        poke(text, 168, 8, big, desc->separate ? 0 : 544);
    else
        poke_real(text, 108, 4, big, desc->separate ? 0 : 352);
    poke(text, wide ? 500 : 123, wide ? 4 : 1, big, 2); /* mm */
    poke_real(text, pixdim, real, big, -1);
    for (size_t axis = 0; axis < 3; axis++) {
        const double *c = known->columns[axis];
        poke_real(text, pixdim + (axis + 1) * real, real, big, sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]));
    }
    find_quatern(known, quatern);
    poke(text, wide ? 344 : 252, wide ? 4 : 2, big, desc->qform);
    poke(text, wide ? 348 : 254, wide ? 4 : 2, big, !desc->qform);
    for (size_t i = 0; i < 3; i++) {
        poke_real(text, (wide ? 352 : 256) + i * real, real, big, quatern[i]);
        poke_real(text, (wide ? 376 : 268) + i * real, real, big, known->origin[i]);
        for (size_t column = 0; column < 4 && !desc->qform; column++)
            poke_real(text, (wide ? 400 : 280) + (4 * i + column) * real, real, big,
                      column < 3 ? known->columns[column][i] : known->origin[i]);
    }
}

/* --- NRRD and MetaImage ------------------------------------------------------------------------------------------- */

static inline const char *nrrd_type(hewn_voxel type)
{
    static const char *const names[HEWN_VOXEL_COUNT] = {"signed char", "uchar", "short",    "unsigned short",
                                                        "int",         "uint",  "longlong", "ulonglong",
                                                        NULL,          "float", "double"};
    return names[type];
}

/* The lines up to "encoding", in a space whose x and y may be turned; frames first or last. */
static inline void put_nrrd_header(hewn_text *text, const truth *known, hewn_voxel type, int frames, bool frames_first,
                                   const char *space, bool big)
{
    double x = strchr(space, 'L') ? -1 : 1, y = strchr(space, 'P') ? -1 : 1;
    hewn_text_print(text, "NRRD0005\n# by a test\ntype: %s\ndimension: %d\nspace: %s\nsizes:", nrrd_type(type),
                    frames > 1 ? 4 : 3, space);
    if (frames > 1 && frames_first)
        hewn_text_print(text, " %d", frames);
    hewn_text_print(text, " %d %d %d", TRUTH_X, TRUTH_Y, TRUTH_Z);
    if (frames > 1 && !frames_first)
        hewn_text_print(text, " %d", frames);
    hewn_text_print(text, "\nspace directions:%s", frames > 1 && frames_first ? " none" : "");
    for (int column = 0; column < 3; column++)
        hewn_text_print(text, " (%.17g, %.17g,%.17g)", x * known->columns[column][0], y * known->columns[column][1],
                        known->columns[column][2]);
    hewn_text_print(text, "%s\nspace origin: (%.17g,%.17g,%.17g)\nspace units: \"mm\" \"mm\" \"mm\"\nendian: %s\n",
                    frames > 1 && !frames_first ? " none" : "", x * known->origin[0], y * known->origin[1],
                    known->origin[2], big ? "big" : "little");
}

static inline void put_meta_header(hewn_text *text, const truth *known, hewn_voxel type, int channels, bool big,
                                   bool packed)
{
    static const char *const names[HEWN_VOXEL_COUNT] = {"MET_CHAR", "MET_UCHAR", "MET_SHORT",     "MET_USHORT",
                                                        "MET_INT",  "MET_UINT",  "MET_LONG_LONG", "MET_ULONG_LONG",
                                                        NULL,       "MET_FLOAT", "MET_DOUBLE"};
    hewn_text_print(text,
                    "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = %s\n"
                    "CompressedData = %s\nTransformMatrix =",
                    big ? "True" : "False", packed ? "True" : "False");
    for (int column = 0; column < 3; column++) {
        const double *c = known->columns[column];
        double length = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
        hewn_text_print(text, " %.17g %.17g %.17g", -c[0] / length, -c[1] / length, c[2] / length);
    }
    hewn_text_print(text, "\nOffset = %.17g %.17g %.17g\nElementSpacing =", -known->origin[0], -known->origin[1],
                    known->origin[2]);
    for (int column = 0; column < 3; column++) {
        const double *c = known->columns[column];
        hewn_text_print(text, " %.17g", sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]));
    }
    hewn_text_print(text, "\nDimSize = %d %d %d\nElementNumberOfChannels = %d\nElementType = %s\n", TRUTH_X, TRUTH_Y,
                    TRUTH_Z, channels, names[type]);
}

/* Samples with the frames fastest, as channels and vectors are. */
static inline void put_interleaved(hewn_text *text, hewn_voxel type, int frames, bool big)
{
    for (int index = 0; index < TRUTH_FRAME * frames; index++) {
        int voxel = index / frames, i = voxel % TRUTH_X, j = voxel / TRUTH_X % TRUTH_Y, k = voxel / (TRUTH_X * TRUTH_Y);
        put_sample(text, type, truth_sample(type, i, j, k, index % frames), big);
    }
}

/* --- DICOM -------------------------------------------------------------------------------------------------------- */

/* An element in explicit VR, little-endian: text, padded to an even length. */
static inline void put_element(hewn_text *text, uint32_t group, uint32_t element, const char *vr, const char *value)
{
    size_t length = strlen(value), even = (length + 1) / 2 * 2;
    const char head[] = {
        (char)(group & 0xff), (char)(group >> 8), (char)(element & 0xff), (char)(element >> 8), vr[0], vr[1],
        (char)(even & 0xff),  (char)(even >> 8)};
    hewn_text_append_bytes(text, head, sizeof head);
    hewn_text_append_bytes(text, value, length);
    if (even > length)
        hewn_text_append_bytes(text, strcmp(vr, "UI") == 0 ? "" : " ", 1);
}

static inline void put_short(hewn_text *text, uint32_t group, uint32_t element, uint32_t value)
{
    const char bytes[] = {
        (char)(group & 0xff), (char)(group >> 8), (char)(element & 0xff), (char)(element >> 8), 'U', 'S', 2, 0,
        (char)(value & 0xff), (char)(value >> 8)};
    hewn_text_append_bytes(text, bytes, sizeof bytes);
}

/* Slice k of the truth as a CT image of 16 bits; `slope` is written, the intercept is -5. */
static inline void put_dicom_slice(hewn_text *text, const truth *known, int k, const char *series, double slope)
{
    char value[200];
    double place[3], length[2];
    truth_place(known, 0, 0, k, place);
    put_zeroes(text, 128);
    hewn_text_append_bytes(text, "DICM", 4);
    put_element(text, 2, 0x10, "UI", "1.2.840.10008.1.2.1");
    put_element(text, 8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2");
    snprintf(value, sizeof value, "1.2.3.%d", k + 1);
    put_element(text, 8, 0x18, "UI", value);
    put_element(text, 8, 0x60, "CS", "CT");
    put_element(text, 8, 0x103e, "LO", "truth");
    put_element(text, 0x20, 0x0e, "UI", series);
    snprintf(value, sizeof value, "%d", 100 - k);
    put_element(text, 0x20, 0x13, "IS", value);
    snprintf(value, sizeof value, "%.10g\\%.10g\\%.10g", -place[0], -place[1], place[2]);
    put_element(text, 0x20, 0x32, "DS", value);
    for (int column = 0; column < 2; column++) {
        const double *c = known->columns[column];
        length[column] = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
    }
    snprintf(value, sizeof value, "%.10g\\%.10g\\%.10g\\%.10g\\%.10g\\%.10g", -known->columns[0][0] / length[0],
             -known->columns[0][1] / length[0], known->columns[0][2] / length[0], -known->columns[1][0] / length[1],
             -known->columns[1][1] / length[1], known->columns[1][2] / length[1]);
    put_element(text, 0x20, 0x37, "DS", value);
    put_short(text, 0x28, 2, 1);
    put_element(text, 0x28, 4, "CS", "MONOCHROME2");
    put_short(text, 0x28, 0x10, TRUTH_Y);
    put_short(text, 0x28, 0x11, TRUTH_X);
    snprintf(value, sizeof value, "%.10g\\%.10g", length[1], length[0]); /* between rows first */
    put_element(text, 0x28, 0x30, "DS", value);
    put_short(text, 0x28, 0x100, 16);
    put_short(text, 0x28, 0x101, 16);
    put_short(text, 0x28, 0x102, 15);
    put_short(text, 0x28, 0x103, 1);
    put_element(text, 0x28, 0x1052, "DS", "-5");
    snprintf(value, sizeof value, "%g", slope);
    put_element(text, 0x28, 0x1053, "DS", value);
    uint32_t bytes = TRUTH_X * TRUTH_Y * 2;
    const char head[] = {'\xe0', '\x7f', '\x10', '\0', 'O', 'W', 0, 0, (char)(bytes & 0xff), (char)(bytes >> 8), 0, 0};
    hewn_text_append_bytes(text, head, sizeof head);
    for (int j = 0; j < TRUTH_Y; j++)
        for (int i = 0; i < TRUTH_X; i++)
            put_sample(text, HEWN_VOXEL_INT16, truth_sample(HEWN_VOXEL_INT16, i, j, k, 0), false);
}

#endif
