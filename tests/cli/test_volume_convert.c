/* hewn convert of volumes: where the mesh is, what its files say of that, and what is refused. */
#include <math.h>

#include "mesh_files.h"

/* --- an ellipsoid in an oblique, anisotropic, left-handed lattice --------------------------------------------------
 */

enum { X = 31, Y = 26, Z = 22 };

/* Columns are the steps along i, j and k in RAS; rotations about two axes, the second column turned around. */
static double affine[3][4];
static float samples[X * Y * Z];
static const double weights[3] = {1 / 81.0, 1 / 36.0,
                                  1 / 121.0}; /* of RAS: no two alike, so no symmetry hides a turn */
static const double centre[3] = {-12.5, 40.25, 133};

static void make_lattice(void)
{
    const double spacing[3] = {0.8, 1.1, 1.7}, a = 0.4, b = -0.7;
    const double turn[3][3] = {
        {cos(a), -sin(a) * cos(b), sin(a) * sin(b)}, {sin(a), cos(a) * cos(b), -cos(a) * sin(b)}, {0, sin(b), cos(b)}};
    const double middle[3] = {14.7, 12.6, 10.2};
    for (int row = 0; row < 3; row++) {
        affine[row][3] = centre[row];
        for (int k = 0; k < 3; k++) {
            affine[row][k] = turn[row][k] * spacing[k] * (k == 1 ? -1 : 1);
            affine[row][3] -= affine[row][k] * middle[k];
        }
    }
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
    return fabs((sum + share * (1 - share) * chord - 1) / sqrt(steep) / 0.8);
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
    double expected = 4.0 / 3 * 3.14159265358979 * 9 * 6 * 11 / (scale * scale * scale);
    assert_true(volume > 0.98 * expected && volume < expected); /* faces turn outward */
    return count;
}

static void convert_and_check(const char *folder, const char *input, const char *space, const char *to_unit,
                              const int axes[3], double scale)
{
    size_t length;
    run_desc desc = {.arguments = {"convert", input, "-o", "out.obj", "--iso", "9", "--space", space}};
    if (to_unit) {
        desc.arguments[8] = "--to-unit";
        desc.arguments[9] = to_unit;
    }
    run_result result = run_in(0, folder, desc);
    assert_has(result.err, "left-handed");
    run_result_destroy(&result);
    char *text = run_read_file(run_path(folder, "out.obj"), &length);
    assert_true(check_vertices(text, axes, scale) > 500);
    free(text);
}

static void test_place_of_an_oblique_volume(void **state)
{
    (void)state;
    static const char *const files[] = {"a.nrrd", "a.mha", "a.nii"};
    static const int ras[3] = {1, 2, 3}, lps[3] = {-1, -2, 3}, gltf[3] = {-1, 3, 2};
    char *folder = run_folder_create();
    make_lattice();
    write_nrrd(run_path(folder, "a.nrrd"));
    write_meta(run_path(folder, "a.mha"));
    write_nifti(run_path(folder, "a.nii"));
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        convert_and_check(folder, files[i], "ras", NULL, ras, 1);
        convert_and_check(folder, files[i], "lps", NULL, lps, 1);
        convert_and_check(folder, files[i], "lps", "cm", lps, 10);
        convert_and_check(folder, files[i], "gltf", NULL, gltf, 1000);
    }
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
        {2, "--method of a volume", {"convert", "a.nrrd", "-o", "a.stl", "--method", "dc"}},
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
        cmocka_unit_test(test_place_of_an_oblique_volume), cmocka_unit_test(test_copies_of_a_head_agree),
        cmocka_unit_test(test_files_say_where_they_are),   cmocka_unit_test(test_report),
        cmocka_unit_test(test_odd_values_are_explained),   cmocka_unit_test(test_bad_requests),
        cmocka_unit_test(test_same_bytes_for_any_threads), cmocka_unit_test(test_data_converts),
    };
    return cmocka_run_group_tests_name("volume_convert", tests, NULL, NULL);
}
