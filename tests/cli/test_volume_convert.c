/* hewn convert of volumes: where the mesh is, what its files say of that, and what is refused. */
#include <math.h>

#include <sys/stat.h>

#include "../unit/vdb_write.h"
#include "mesh_files.h"

/* --- an ellipsoid in an oblique, anisotropic, left-handed lattice --------------------------------------------------
 */

enum { X = 31, Y = 26, Z = 22 };

/* Columns are the steps along i, j and k in RAS; rotations about two axes, the second column turned around. */
static double affine[3][4];
static float samples[X * Y * Z];
static double weights[3], centre[3], shortest;

static void fill_samples(void)
{
    for (int n = 0; n < X * Y * Z; n++) {
        const double at[3] = {n % X, n / X % Y, n / X / Y};
        double sum = 0;
        for (int row = 0; row < 3; row++) {
            double off = affine[row][3] - centre[row];
            for (int k = 0; k < 3; k++)
                off += affine[row][k] * at[k];
            sum += weights[row] * off * off;
        }
        samples[n] = (float)(10 - sum);
    }
}

static void make_lattice(void)
{
    const double spacing[3] = {0.8, 1.1, 1.7}, a = 0.4, b = -0.7, where[3] = {-12.5, 40.25, 133};
    const double sides[3] = {9, 6, 11}; /* in RAS: no two alike, so no symmetry hides a turn */
    shortest = 0.8;
    const double turn[3][3] = {
        {cos(a), -sin(a) * cos(b), sin(a) * sin(b)}, {sin(a), cos(a) * cos(b), -cos(a) * sin(b)}, {0, sin(b), cos(b)}};
    const double middle[3] = {14.7, 12.6, 10.2};
    for (int row = 0; row < 3; row++) {
        weights[row] = 1 / (sides[row] * sides[row]);
        affine[row][3] = centre[row] = where[row];
        for (int k = 0; k < 3; k++) {
            affine[row][k] = turn[row][k] * spacing[k] * (k == 1 ? -1 : 1);
            affine[row][3] -= affine[row][k] * middle[k];
        }
    }
    fill_samples();
}

/* A lattice along the axes, for formats that know no others. */
static void make_straight_lattice(const double spacing[3], const double origin[3])
{
    const double middle[3] = {14.7, 12.6, 10.2}, sides[3] = {11.3, 9.2, 7.9}; /* in voxels */
    shortest = fmin(spacing[0], fmin(spacing[1], spacing[2]));
    for (int row = 0; row < 3; row++) {
        weights[row] = 1 / (sides[row] * sides[row] * spacing[row] * spacing[row]);
        centre[row] = origin[row] + middle[row] * spacing[row];
        for (int k = 0; k < 3; k++)
            affine[row][k] = row == k ? spacing[k] : 0;
        affine[row][3] = origin[row];
    }
    fill_samples();
}

static void write_bytes(const char *path, const void *head, size_t head_length)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(head, 1, head_length, file), head_length);
    assert_int_equal(fwrite(samples, 1, sizeof samples, file), sizeof samples);
    assert_int_equal(fclose(file), 0);
}

static void write_nrrd(const char *path)
{
    char text[1024];
    int length = snprintf(text, sizeof text,
                          "NRRD0005\ntype: float\ndimension: 3\nsizes: %d %d %d\nspace: left-posterior-superior\n"
                          "space directions:",
                          X, Y, Z);
    for (int k = 0; k < 3; k++) /* in LPS */
        length += snprintf(text + length, sizeof text - (size_t)length, " (%.17g,%.17g,%.17g)", -affine[0][k],
                           -affine[1][k], affine[2][k]);
    length += snprintf(text + length, sizeof text - (size_t)length,
                       "\nspace origin: (%.17g,%.17g,%.17g)\nspace units: \"mm\" \"mm\" \"mm\"\nendian: little\n"
                       "encoding: raw\n\n",
                       -affine[0][3], -affine[1][3], affine[2][3]);
    write_bytes(path, text, (size_t)length);
}

static void write_meta(const char *path)
{
    char text[1024];
    double length[3];
    for (int k = 0; k < 3; k++)
        length[k] = sqrt(affine[0][k] * affine[0][k] + affine[1][k] * affine[1][k] + affine[2][k] * affine[2][k]);
    int used = snprintf(text, sizeof text,
                        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                        "TransformMatrix =");
    for (int k = 0; k < 3; k++)
        used += snprintf(text + used, sizeof text - (size_t)used, " %.17g %.17g %.17g", -affine[0][k] / length[k],
                         -affine[1][k] / length[k], affine[2][k] / length[k]);
    used += snprintf(text + used, sizeof text - (size_t)used,
                     "\nOffset = %.17g %.17g %.17g\nElementSpacing = %.17g %.17g %.17g\nDimSize = %d %d %d\n"
                     "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n",
                     -affine[0][3], -affine[1][3], affine[2][3], length[0], length[1], length[2], X, Y, Z);
    write_bytes(path, text, (size_t)used);
}

static void put(unsigned char *head, size_t at, size_t size, const void *value)
{
    memcpy(head + at, value, size);
}

static void write_nifti(const char *path)
{
    unsigned char head[352] = {0};
    const int32_t size = 348;
    const int16_t dims[4] = {3, X, Y, Z}, type = 16, bits = 32, form = 1;
    const float spacing[4] = {1, 0.8f, 1.1f, 1.7f}, offset = 352;
    put(head, 0, 4, &size);
    put(head, 40, sizeof dims, dims);
    put(head, 70, 2, &type);
    put(head, 72, 2, &bits);
    put(head, 76, sizeof spacing, spacing);
    put(head, 108, 4, &offset);
    head[123] = 2; /* millimetres */
    put(head, 254, 2, &form);
    for (size_t row = 0; row < 3; row++)
        for (size_t k = 0; k < 4; k++) {
            float value = (float)affine[row][k];
            put(head, 280 + 16 * row + 4 * k, 4, &value);
        }
    memcpy(head + 344, "n+1", 4);
    write_bytes(path, head, sizeof head);
}

static void write_vdb(const char *path)
{
    static double values[X * Y * Z];
    const int32_t dims[3] = {X, Y, Z}, first[3] = {-4100, 120, 7};
    double to_world[16] = {[15] = 1};
    for (int n = 0; n < X * Y * Z; n++)
        values[n] = (double)samples[n];
    for (int row = 0; row < 3; row++) {
        to_world[4 * row + 3] = affine[row][3];
        for (int k = 0; k < 3; k++) {
            to_world[4 * row + k] = affine[row][k];
            to_world[4 * row + 3] -= affine[row][k] * first[k];
        }
    }
    vdb_write(path, dims, values, first, to_world);
}

static void write_raw(const char *path)
{
    write_bytes(path, "", 0);
}

static void write_npy(const char *path)
{
    char text[129] = "\x93NUMPY\x01";
    memset(text + 7, ' ', 121);
    text[7] = 0;
    text[8] = 118; /* bytes of what follows, to a multiple of 64 in all */
    text[9] = 0;
    int used = snprintf(text + 10, 118, "{'descr': '<f4', 'fortran_order': False, 'shape': (%d, %d, %d), }", Z, Y, X);
    text[10 + used] = ' ';
    text[127] = '\n';
    write_bytes(path, text, 128);
}

static void write_inr(const char *path)
{
    char text[257];
    int used = snprintf(text, sizeof text,
                        "#INRIMAGE-4#{\nXDIM=%d\nYDIM=%d\nZDIM=%d\nVDIM=1\nTYPE=float\nPIXSIZE=32 bits\nCPU=decm\n"
                        "VX=0.8\nVY=1.1\nVZ=1.7\nTX=-3\nTY=17.5\nTZ=250\n",
                        X, Y, Z);
    memset(text + used, '\n', sizeof text - (size_t)used);
    memcpy(text + 252, "##}\n", 4);
    write_bytes(path, text, 256);
}

static void put_tag(unsigned char *at, unsigned tag, unsigned type, unsigned count, unsigned value)
{
    const unsigned numbers[4] = {tag | type << 16, count, value, 0};
    memcpy(at, numbers, 12);
}

/* A page a slice, as ImageJ writes them: spacings across and down are in the resolution, that of slices in a text. */
static void write_tiff(const char *path)
{
    enum { TAGS = 12, PAGE = 2 + 12 * TAGS + 4, TEXT = 128 };
    static const char text[TEXT] = "ImageJ=1.53t\nimages=22\nslices=22\nunit=mm\nspacing=1.7\n";
    static const unsigned across[2] = {10, 8}, down[2] = {10, 11};
    const unsigned pages = 8 + TEXT + 16, data = pages + PAGE * Z;
    unsigned char *head = calloc(data, 1);
    assert_non_null(head);
    memcpy(head, "II*", 4);
    memcpy(head + 4, &pages, 4);
    memcpy(head + 8, text, TEXT);
    memcpy(head + 8 + TEXT, across, 8);
    memcpy(head + 8 + TEXT + 8, down, 8);
    for (unsigned k = 0; k < Z; k++) {
        unsigned char *page = head + pages + (size_t)PAGE * k;
        const unsigned next = k + 1 < Z ? pages + PAGE * (k + 1) : 0, slice = 4 * X * Y;
        page[0] = TAGS;
        put_tag(page + 2, 256, 4, 1, X);
        put_tag(page + 14, 257, 4, 1, Y);
        put_tag(page + 26, 258, 3, 1, 32);
        put_tag(page + 38, 259, 3, 1, 1);
        put_tag(page + 50, 262, 3, 1, 1);
        put_tag(page + 62, 270, 2, TEXT, 8);
        put_tag(page + 74, 273, 4, 1, data + slice * k);
        put_tag(page + 86, 277, 3, 1, 1);
        put_tag(page + 98, 279, 4, 1, slice);
        put_tag(page + 110, 282, 5, 1, 8 + TEXT);
        put_tag(page + 122, 283, 5, 1, 8 + TEXT + 8);
        put_tag(page + 134, 339, 3, 1, 3); /* floats */
        memcpy(page + 146, &next, 4);
    }
    write_bytes(path, head, data);
    free(head);
}

/* An element of a DICOM file, explicit and little-endian. */
static void put_element(FILE *file, unsigned group, unsigned element, const char *vr, const void *value, size_t length)
{
    const unsigned size = (unsigned)(length + (length & 1));
    const unsigned char head[8] = {(unsigned char)group,          (unsigned char)(group >> 8), (unsigned char)element,
                                   (unsigned char)(element >> 8), (unsigned char)vr[0],        (unsigned char)vr[1],
                                   (unsigned char)size,           (unsigned char)(size >> 8)};
    const bool is_long = strcmp(vr, "OW") == 0;
    assert_int_equal(fwrite(head, 1, is_long ? 6 : 8, file), is_long ? 6 : 8);
    if (is_long) {
        const unsigned char longer[6] = {
            0, 0, (unsigned char)size, (unsigned char)(size >> 8), (unsigned char)(size >> 16), 0};
        assert_int_equal(fwrite(longer, 1, 6, file), 6);
    }
    assert_int_equal(fwrite(value, 1, length, file), length);
    if (length & 1)
        assert_int_not_equal(fputc(strcmp(vr, "UI") == 0 ? 0 : ' ', file), EOF);
}

static void put_text(FILE *file, unsigned group, unsigned element, const char *vr, const char *value)
{
    put_element(file, group, element, vr, value, strlen(value));
}

static void put_short(FILE *file, unsigned group, unsigned element, unsigned value)
{
    const unsigned char bytes[2] = {(unsigned char)value, (unsigned char)(value >> 8)};
    put_element(file, group, element, "US", bytes, 2);
}

/* A slice of 32 bits, in ten-millionths. What of the lattice is not said by this slice is said by the next one. */
static void write_slice(const char *path, int k)
{
    static const unsigned preamble[32];
    static int32_t pixels[X * Y];
    char value[256];
    double length[3];
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(preamble, 1, 128, file), 128);
    assert_int_equal(fwrite("DICM", 1, 4, file), 4);
    for (int c = 0; c < 2; c++)
        length[c] = sqrt(affine[0][c] * affine[0][c] + affine[1][c] * affine[1][c] + affine[2][c] * affine[2][c]);
    put_text(file, 2, 0x10, "UI", "1.2.840.10008.1.2.1");
    put_text(file, 8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2");
    snprintf(value, sizeof value, "1.2.3.%d", k + 1);
    put_text(file, 8, 0x18, "UI", value);
    put_text(file, 8, 0x60, "CS", "MR");
    put_text(file, 0x20, 0x0e, "UI", "1.2.9");
    snprintf(value, sizeof value, "%d", 100 - k);
    put_text(file, 0x20, 0x13, "IS", value);
    snprintf(value, sizeof value, "%.10g\\%.10g\\%.10g", -affine[0][3] - k * affine[0][2],
             -affine[1][3] - k * affine[1][2], affine[2][3] + k * affine[2][2]);
    put_text(file, 0x20, 0x32, "DS", value);
    snprintf(value, sizeof value, "%.12g\\%.12g\\%.12g\\%.12g\\%.12g\\%.12g", -affine[0][0] / length[0],
             -affine[1][0] / length[0], affine[2][0] / length[0], -affine[0][1] / length[1], -affine[1][1] / length[1],
             affine[2][1] / length[1]);
    put_text(file, 0x20, 0x37, "DS", value);
    put_short(file, 0x28, 2, 1);
    put_text(file, 0x28, 4, "CS", "MONOCHROME2");
    put_short(file, 0x28, 0x10, Y);
    put_short(file, 0x28, 0x11, X);
    snprintf(value, sizeof value, "%.10g\\%.10g", length[1], length[0]); /* between rows first */
    put_text(file, 0x28, 0x30, "DS", value);
    put_short(file, 0x28, 0x100, 32);
    put_short(file, 0x28, 0x101, 32);
    put_short(file, 0x28, 0x102, 31);
    put_short(file, 0x28, 0x103, 1);
    put_text(file, 0x28, 0x1052, "DS", "0");
    put_text(file, 0x28, 0x1053, "DS", "1e-7");
    for (int n = 0; n < X * Y; n++)
        pixels[n] = (int32_t)lround((double)samples[n + X * Y * k] * 1e7);
    put_element(file, 0x7fe0, 0x10, "OW", pixels, sizeof pixels);
    assert_int_equal(fclose(file), 0);
}

static void write_dicom(const char *folder)
{
    char name[4200];
    assert_int_equal(mkdir(folder, 0700), 0);
    for (int k = 0; k < Z; k++) {
        snprintf(name, sizeof name, "%.4000s/%d.dcm", folder, k * 7 % Z); /* names do not tell the order */
        write_slice(name, k);
    }
}

/* The point of the lattice at a place in RAS, by Cramer's rule. */
static double determinant(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static void find_lattice(const double ras[3], double out[3])
{
    double column[3][3], off[3];
    for (int row = 0; row < 3; row++) {
        off[row] = ras[row] - affine[row][3];
        for (int k = 0; k < 3; k++)
            column[k][row] = affine[row][k];
    }
    double whole = determinant(column[0], column[1], column[2]);
    for (int k = 0; k < 3; k++) {
        double changed[3][3];
        memcpy(changed, column, sizeof changed);
        memcpy(changed[k], off, sizeof off);
        out[k] = determinant(changed[0], changed[1], changed[2]) / whole;
    }
}

/* A vertex on an edge of the lattice is where the line between two samples has the value, and there the ellipsoid's
 * own is less by what a parabola is above its chord. So it is known to rounding on which ellipsoid it must be. Returns
 * how far it is from that, in voxels along their shortest side. */
static double error_at(const double ras[3])
{
    double ijk[3], most = 0, sum = 0, steep = 0;
    int along = 0;
    find_lattice(ras, ijk);
    for (int k = 0; k < 3; k++)
        if (fabs(ijk[k] - round(ijk[k])) > most) {
            most = fabs(ijk[k] - round(ijk[k]));
            along = k;
        }
    for (int k = 0; k < 3; k++)
        if (k != along && fabs(ijk[k] - round(ijk[k])) > 1e-4)
            return fabs(ijk[k] - round(ijk[k])); /* off the lattice's edges */
    double share = ijk[along] - floor(ijk[along]), chord = 0;
    for (int row = 0; row < 3; row++) {
        double off = ras[row] - centre[row], step = affine[row][along];
        sum += weights[row] * off * off;
        chord += weights[row] * step * step;
        steep += 4 * weights[row] * weights[row] * off * off;
    }
    return fabs((sum + share * (1 - share) * chord - 1) / sqrt(steep) / shortest);
}

/* Reads the vertices of an OBJ file that is in another space, by signed axes: out[row] = sign × in[axis]. */
static uint32_t check_vertices(const char *text, const int axes[3], double scale)
{
    uint32_t count = 0;
    double volume = 0;
    static double places[20000][3];
    for (const char *line = text; line; line = strchr(line, '\n'), line += line != NULL) {
        double p[3], ras[3];
        long f[3];
        if (sscanf(line, "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3) {
            for (int row = 0; row < 3; row++)
                ras[abs(axes[row]) - 1] = p[row] * (axes[row] < 0 ? -scale : scale);
            if (error_at(ras) > 1e-4)
                fail_msg("vertex %u is off by %g of a voxel", (unsigned)count, error_at(ras));
            assert_true(count < 20000);
            memcpy(places[count++], p, sizeof p);
        } else if (sscanf(line, "f %ld//%*d %ld//%*d %ld", &f[0], &f[1], &f[2]) == 3) {
            volume += determinant(places[f[0] - 1], places[f[1] - 1], places[f[2] - 1]) / 6;
        }
    }
    double expected = 4.0 / 3 * 3.14159265358979 / sqrt(weights[0] * weights[1] * weights[2]) / (scale * scale * scale);
    assert_true(volume > 0.98 * expected && volume < expected); /* faces turn outward */
    return count;
}

static void convert_and_check(const char *folder, const char *input, const char *space, const char *to_unit,
                              const int axes[3], double scale)
{
    size_t length;
    run_desc desc = {.arguments = {"convert", input, "-o", "out.obj", "--iso", "9", "--space", space}};
    bool raw = strstr(input, ".raw");
    if (raw) {
        const char *more[6] = {"--dims", "31,26,22", "--type", "float", "--spacing", "0.8,1.1,1.7"};
        memcpy(desc.arguments + 8, more, sizeof more);
    } else if (to_unit) {
        desc.arguments[8] = "--to-unit";
        desc.arguments[9] = to_unit;
    }
    run_result result = run_in(0, folder, desc);
    double columns[3][3];
    for (int row = 0; row < 3; row++)
        for (int k = 0; k < 3; k++)
            columns[k][row] = affine[row][k];
    bool slices =
        strcmp(input, "slices") == 0; /* are put in order along their normal, which makes the lattice right-handed */
    if (!slices && determinant(columns[0], columns[1], columns[2]) < 0)
        assert_has(result.err, "left-handed");
    run_result_destroy(&result);
    char *text = run_read_file(run_path(folder, "out.obj"), &length);
    assert_true(check_vertices(text, axes, scale) > 500);
    free(text);
}

static void test_place_of_an_oblique_volume(void **state)
{
    (void)state;
    static const char *const files[] = {"a.nrrd", "a.mha", "a.nii", "slices"};
    static const int ras[3] = {1, 2, 3}, lps[3] = {-1, -2, 3}, gltf[3] = {-1, 3, 2};
    char *folder = run_folder_create();
    make_lattice();
    write_nrrd(run_path(folder, "a.nrrd"));
    write_meta(run_path(folder, "a.mha"));
    write_nifti(run_path(folder, "a.nii"));
    write_dicom(run_path(folder, "slices"));
    write_vdb(run_path(folder, "a.vdb")); /* its world is no patient's */
    convert_and_check(folder, "a.vdb", "world", NULL, ras, 1);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        convert_and_check(folder, files[i], "ras", NULL, ras, 1);
        convert_and_check(folder, files[i], "lps", NULL, lps, 1);
        convert_and_check(folder, files[i], "lps", "cm", lps, 10);
        convert_and_check(folder, files[i], "gltf", NULL, gltf, 1000);
    }
    run_folder_destroy(folder);
}

/* What formats without directions can say: spacings, and where the first sample is. */
static void test_place_of_a_straight_volume(void **state)
{
    (void)state;
    static const int same[3] = {1, 2, 3};
    static const double spacing[3] = {0.8, 1.1, 1.7}, one[3] = {1, 1, 1}, none[3] = {0}, origin[3] = {-3, 17.5, 250};
    char *folder = run_folder_create();
    make_straight_lattice(spacing, none);
    write_raw(run_path(folder, "a.raw"));
    write_tiff(run_path(folder, "a.tif"));
    convert_and_check(folder, "a.raw", "world", NULL, same, 1);
    convert_and_check(folder, "a.tif", "world", NULL, same, 1);
    make_straight_lattice(spacing, origin);
    write_inr(run_path(folder, "a.inr"));
    convert_and_check(folder, "a.inr", "world", NULL, same, 1);
    make_straight_lattice(one, none);
    write_npy(run_path(folder, "a.npy"));
    convert_and_check(folder, "a.npy", "world", NULL, same, 1);
    run_folder_destroy(folder);
}

/* --- three copies of one head ---------------------------------------------------------------------------------------
 */

static int by_place(const void *a, const void *b)
{
    const float *left = a, *right = b;
    for (int axis = 0; axis < 3; axis++) {
        float one = roundf(left[axis] * 64), other = roundf(right[axis] * 64);
        if (one != other)
            return one < other ? -1 : 1;
    }
    return 0;
}

/* The vertices of a PLY file with float positions and normals, in the order of their places. */
static float (*read_places(const char *path, size_t *count))[6]
{
    size_t length;
    char *bytes = run_read_file(path, &length), *at = strstr(bytes, "element vertex ");
    assert_non_null(at);
    *count = strtoul(at + 15, NULL, 10);
    at = strstr(at, "end_header\n");
    assert_non_null(at);
    float(*out)[6] = malloc(*count * sizeof *out);
    assert_non_null(out);
    memcpy(out, at + 11, *count * sizeof *out);
    free(bytes);
    qsort(out, *count, sizeof *out, by_place);
    return out;
}

/* Lattices of three orders and both hands: the vertices are the same, and so are the normals. */
static void test_copies_of_a_head_agree(void **state)
{
    (void)state;
    static const char *const copies[] = {"RAS.nii.gz", "LPS.nii.gz", "PSR.nii.gz"};
    float(*first)[6] = NULL;
    size_t first_count = 0;
    char *folder = run_folder_create();
    for (size_t i = 0; i < 3; i++) {
        char name[64], data[4096];
        size_t count, strays = 0;
        snprintf(name, sizeof name, "volume/%s", copies[i]);
        snprintf(data, sizeof data, "%s", run_data_file(name));
        run_result result =
            run_in(0, folder, (run_desc){.arguments = {"convert", data, "-o", "out.ply", "--iso", "36.5"}});
        run_result_destroy(&result);
        float(*places)[6] = read_places(run_path(folder, "out.ply"), &count);
        if (i == 0) {
            first = places;
            first_count = count;
            continue;
        }
        assert_int_equal(count, first_count);
        for (size_t v = 0; v < count; v++) {
            bool same = true;
            for (int axis = 0; axis < 6; axis++)
                same &= fabsf(places[v][axis] - first[v][axis]) < (axis < 3 ? 2e-2f : 1e-2f);
            strays += !same;
        }
        assert_true(strays * 100 < count); /* places that are rounded to either side of a step sort differently */
        free(places);
    }
    free(first);
    run_folder_destroy(folder);
}

/* --- what files say -------------------------------------------------------------------------------------------------
 */

static void test_files_say_where_they_are(void **state)
{
    (void)state;
    static const struct {
        const char *file, *space, *says;
    } cases[] = {{"a.stl", "ras", "1 unit = 0.001 m, +Z up, SPACE=RAS"},
                 {"a.stl", "lps", "SPACE=LPS"},
                 {"a.obj", "lps", "+Z up, SPACE=LPS\n"},
                 {"a.ply", "ras", "+Z up, SPACE=RAS\n"},
                 {"a.off", "ras", "SPACE=RAS\n"},
                 {"a.glb", "gltf", "\"extras\":{\"space\":\"x left, y head, z front\"}"}};
    char *folder = run_folder_create();
    make_lattice();
    write_nrrd(run_path(folder, "a.nrrd"));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        size_t length;
        run_result result = run_in(0, folder,
                                   (run_desc){.arguments = {"convert", "a.nrrd", "-o", cases[i].file, "--iso", "9",
                                                            "--space", cases[i].space}});
        run_result_destroy(&result);
        char *bytes = run_read_file(run_path(folder, cases[i].file), &length);
        if (!memmem(bytes, length, cases[i].says, strlen(cases[i].says)))
            fail_msg("%s in %s lacks '%s'", cases[i].file, cases[i].space, cases[i].says);
        free(bytes);
        result = run_in(0, folder, (run_desc){.arguments = {"check", cases[i].file}});
        run_result_destroy(&result);
        result = run_in(0, folder, (run_desc){.arguments = {"info", cases[i].file, "--json"}});
        assert_string_equal(json_string(result.out, "unit"), strstr(cases[i].file, "glb") ? "m" : "mm");
        run_result_destroy(&result);
    }
    run_folder_destroy(folder);
}

static void test_report(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    make_lattice();
    write_nrrd(run_path(folder, "a.nrrd"));
    run_result result = run_in(
        0, folder, (run_desc){.arguments = {"convert", "a.nrrd", "-o", "a.stl", "--iso", "9", "--report", "-", "-q"}});
    assert_true(json_is_valid(result.out));
    assert_string_equal(result.err, "");
    assert_string_equal(json_string(result.out, "method"), "mc33");
    assert_string_equal(json_string(result.out, "space"), "ras");
    assert_string_equal(json_string(result.out, "iso.inside"), "above");
    assert_true(json_number(result.out, "iso.value") == 9);
    assert_true(json_bool(result.out, "certificate.closed") && json_bool(result.out, "certificate.manifold"));
    assert_true(json_bool(result.out, "left_handed"));
    assert_int_equal(json_count(result.out, "histogram"), 32);
    assert_int_equal(json_count(result.out, "place"), 16);
    assert_true(json_number(result.out, "range.hi") < 10 && json_number(result.out, "range.hi") > 9.9);
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* --- values that part nothing off, and other trouble ----------------------------------------------------------------
 */

static void test_odd_values_are_explained(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    make_lattice();
    write_nrrd(run_path(folder, "a.nrrd"));
    fail_in(3, folder, "the values are from",
            (run_desc){.arguments = {"convert", "a.nrrd", "-o", "a.stl", "--iso", "12"}});
    fail_in(3, folder, "three quarters up to",
            (run_desc){.arguments = {"convert", "a.nrrd", "-o", "a.stl", "--iso", "12"}});
    run_result result =
        run_in(0, folder, (run_desc){.arguments = {"convert", "a.nrrd", "-o", "a.stl", "--iso", "-1000"}});
    assert_has(result.err, "hardly more than a box");
    run_result_destroy(&result);
    result = run_in(0, folder, (run_desc){.arguments = {"convert", "a.nrrd", "-o", "b.stl", "--iso", "7"}});
    assert_has(result.err, "closed there with a flat cap");
    run_result_destroy(&result);
    result = run_in(0, folder, (run_desc){.arguments = {"convert", "a.nrrd", "-o", "b.ply", "--iso", "7", "--open"}});
    assert_has(result.err, "; open, manifold");
    run_result_destroy(&result);
    result = run_in(0, folder,
                    (run_desc){.arguments = {"convert", "a.nrrd", "-o", "b.ply", "--iso", "9", "--inside", "below"}});
    assert_has(result.err, "inside where values are below");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_bad_requests(void **state)
{
    (void)state;
    static const struct {
        int code;
        const char *says;
        const char *arguments[RUN_MAX_ARGUMENTS];
    } cases[] = {
        {2, "-o FILE", {"convert", "a.nrrd"}},
        {2, "--method of a volume", {"convert", "a.nrrd", "-o", "a.stl", "--method", "magic"}},
        {2, "--inside is", {"convert", "a.nrrd", "-o", "a.stl", "--inside", "out"}},
        {2, "--space is", {"convert", "a.nrrd", "-o", "a.stl", "--space", "moon"}},
        {2, "glTF's space", {"convert", "a.nrrd", "-o", "a.glb", "--space", "ras"}},
        {2, "always in metres", {"convert", "a.nrrd", "-o", "a.glb", "--to-unit", "mm"}},
        {2, "lengths are voxels", {"convert", "a.nrrd", "-o", "a.stl", "--space", "voxel", "--to-unit", "mm"}},
        {2, "--space says", {"convert", "a.nrrd", "-o", "a.stl", "--to-up", "+Y"}},
        {2, "no frame 3", {"convert", "a.nrrd", "-o", "a.stl", "--frame", "3"}},
        {2, "an iso value is", {"convert", "a.nrrd", "-o", "a.stl", "--iso", "bone"}},
        {2, "do not go with", {"convert", "a.obj", "-o", "a.stl", "--iso", "3"}},
        {3,
         "does not say how its axes lie",
         {"convert", "a.raw", "-o", "a.stl", "--dims", "31,26,22", "--type", "float", "--iso", "9", "--space", "lps"}},
        {3, "not in Hounsfield units", {"convert", "b.nrrd", "-o", "a.stl", "--iso", "hu:bone"}},
        {3, "all values of the volume", {"convert", "c.nrrd", "-o", "a.stl", "--iso", "3"}},
    };
    char *folder = run_folder_create();
    make_lattice();
    write_nrrd(run_path(folder, "a.nrrd"));
    write_bytes(run_path(folder, "a.raw"), "", 0);
    run_write_file(run_path(folder, "a.obj"), box_obj);
    run_write_file(run_path(folder, "b.nrrd"),
                   "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n\n0 1 2 3 4 5 6 7\n");
    run_write_file(run_path(folder, "c.nrrd"),
                   "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n\n1 1 1 1 1 1 1 1\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {0};
        memcpy(desc.arguments, cases[i].arguments, sizeof desc.arguments);
        fail_in(cases[i].code, folder, cases[i].says, desc);
    }
    run_folder_destroy(folder);
}

/* --- real data ------------------------------------------------------------------------------------------------------
 */

static void test_same_bytes_for_any_threads(void **state)
{
    (void)state;
    static const char *const counts[] = {"1", "2", "5"};
    char *folder = run_folder_create(), data[4096], *first = NULL;
    size_t first_length = 0;
    snprintf(data, sizeof data, "%s", run_data_file("volume/tooth.nhdr"));
    for (size_t i = 0; i < 3; i++) { /* into one file, since its name is in it */
        size_t length;
        run_result result =
            run_in(0, folder, (run_desc){.arguments = {"convert", data, "-o", "out.ply", "--threads", counts[i]}});
        run_result_destroy(&result);
        char *bytes = run_read_file(run_path(folder, "out.ply"), &length);
        if (i == 0) {
            first = bytes;
            first_length = length;
            continue;
        }
        assert_int_equal(length, first_length);
        assert_memory_equal(bytes, first, length);
        free(bytes);
    }
    free(first);
    run_folder_destroy(folder);
}

/* Each of them is closed, manifold and oriented, also as a file that is read again. */
static void test_data_converts(void **state)
{
    (void)state;
    static const char *const all[] = {"volume/fuel.nii.gz",
                                      "volume/mha.mha",
                                      "volume/HeadMRVolume.mhd",
                                      "volume/itkBrainSliceComplexMagnitude.mha",
                                      "volume/skull_2.9.inr",
                                      "dicom/CT_small.dcm",
                                      "vdb/sphere.vdb",
                                      "volume/anatomical.nii",
                                      "volume/AIL.nii.gz",
                                      "volume/Skull.nrrd",
                                      "volume/T1.nii.gz",
                                      "volume/aal.nii.gz",
                                      "volume/ch2bet.nii.gz",
                                      "volume/engine.nii.gz",
                                      "volume/example4d.nii.gz",
                                      "volume/FLAIR.nrrd",
                                      "volume/hippo.nii.gz",
                                      "volume/template_T2.nrrd",
                                      "volume/test1d_ascii.nrrd",
                                      "volume/tooth.nhdr",
                                      "volume/torsoLabel.nii.gz",
                                      "volume/BallBinary30x30x30_gz.nrrd",
                                      "vdb/grid0.vdb",
                                      "vdb/icosahedron.vdb",
                                      "dicom/adi",
                                      "dicom/seg3d"};
    size_t count = getenv("HEWN_LONG") ? sizeof all / sizeof *all : 7;
    char *folder = run_folder_create(), data[4096];
    for (size_t i = 0; i < count; i++) {
        snprintf(data, sizeof data, "%s", run_data_file(all[i]));
        run_result result = run_in(0, folder, (run_desc){.arguments = {"convert", data, "-o", "out.stl"}});
        assert_has(result.err, "closed, manifold, oriented");
        run_result_destroy(&result);
        result = run_in(0, folder,
                        (run_desc){.arguments = {"check", "out.stl", "--require", "closed,manifold,oriented",
                                                 "--no-self-intersections"}});
        run_result_destroy(&result);
    }
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_place_of_an_oblique_volume),
        cmocka_unit_test(test_place_of_a_straight_volume),
        cmocka_unit_test(test_copies_of_a_head_agree),
        cmocka_unit_test(test_files_say_where_they_are),
        cmocka_unit_test(test_report),
        cmocka_unit_test(test_odd_values_are_explained),
        cmocka_unit_test(test_bad_requests),
        cmocka_unit_test(test_same_bytes_for_any_threads),
        cmocka_unit_test(test_data_converts),
    };
    return cmocka_run_group_tests_name("volume_convert", tests, NULL, NULL);
}
