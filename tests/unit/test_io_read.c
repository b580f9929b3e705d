/* Reading meshes: the forms that the formats allow, broken files, and the files of the test data. */
#include <ftw.h>
#include <strings.h>
#include <sys/resource.h>

#include "base/error.h"
#include "base/file.h"
#include "io/formats.h"
#include "io/shim/number.h"
#include "test_mesh_support.h"

typedef hewn_result (*reader)(const char *, size_t, const char *, hewn_triangles *, hewn_error *);

static hewn_result read_gltf(const char *bytes, size_t length, const char *name, hewn_triangles *out, hewn_error *error)
{
    return hewn_gltf_read(bytes, length, name, NULL, out, error);
}

/* From a block of exactly its size, so that a sanitizer sees any step past it. */
static hewn_result read_exact(reader read, const void *bytes, size_t length, hewn_triangles *out, hewn_error *error)
{
    char *copy = hewn_alloc(length, 1);
    assert_non_null(copy);
    memcpy(copy, bytes, length);
    hewn_result result = read(copy, length, "given", out, error);
    hewn_free(copy);
    return result;
}

static hewn_triangles read_text(reader read, const char *text)
{
    hewn_triangles mesh;
    hewn_error error = {0};
    if (read_exact(read, text, strlen(text), &mesh, &error) != HEWN_OK)
        fail_msg("line %u: %s", error.line, error.message);
    return mesh;
}

static void assert_indices(hewn_triangles mesh, uint64_t vertices, uint64_t triangles, const uint32_t *indices)
{
    assert_int_equal(mesh.vertex_count, vertices);
    assert_int_equal(mesh.triangle_count, triangles);
    assert_memory_equal(mesh.indices, indices, triangles * 3 * sizeof *indices);
    hewn_triangles_destroy(&mesh);
}

/* Fails as bad input at this line (0: any), with a message that says `part`. */
static void assert_bad(reader read, const void *bytes, size_t length, uint32_t line, const char *part)
{
    hewn_triangles mesh = {.vertex_count = 1};
    hewn_error error = {0};
    hewn_result result = read_exact(read, bytes, length, &mesh, &error);
    if (result != HEWN_BAD_INPUT || !strstr(error.message, part) || (line && error.line != line))
        fail_msg("result %d, line %u (not %u): \"%s\" (not \"%s\")", result, error.line, line, error.message, part);
    assert_string_equal(error.file, "given");
    assert_int_equal(mesh.vertex_count, 0);
    assert_null(mesh.positions);
    assert_int_equal(read_exact(read, bytes, length, &mesh, NULL), HEWN_BAD_INPUT);
}

static void assert_bad_text(reader read, const char *text, uint32_t line, const char *part)
{
    assert_bad(read, text, strlen(text), line, part);
}

/* --- numbers
 * ------------------------------------------------------------------------------------------------------------ */

static void assert_float(const char *text, float expected)
{
    float value = 0;
    const char *end = text + strlen(text);
    assert_true(hewn_number_parse_float(text, end, &value) == end);
    assert_memory_equal(&value, &expected, sizeof value);
}

static void test_numbers(void **state)
{
    (void)state;
    assert_float("+1.5e+2", 150);
    assert_float("-.5", -0.5f);
    assert_float("1.", 1);
    assert_float("-0", -0.0f);
    assert_float("1e-46", 0);
    assert_float("-1e-400", -0.0f);
    assert_float("0.00000000000000000000000000000000000000000000000000001", 0);
    assert_float("1e39", INFINITY);
    assert_float("-1e99999999999999999999", -INFINITY);
    assert_float("1e-99999999999999999999", 0);
    assert_float("16777217.0000001", 16777218); /* through double it would be 16777216 */
    static const char *const wrong[] = {"", "+", "-", "+-1", "++1", ".", "e5", "x"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        float value;
        assert_null(hewn_number_parse_float(wrong[i], wrong[i] + strlen(wrong[i]), &value));
    }
    int64_t whole;
    static const char large[] = "9223372036854775808";
    assert_null(hewn_number_parse_integer(large, large + strlen(large), &whole));
}

/* --- OBJ
 * ---------------------------------------------------------------------------------------------------------------- */

#define FOUR "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static const uint32_t fan[] = {0, 1, 2, 0, 2, 3};

static void test_obj_forms(void **state)
{
    (void)state;
    static const char *const forms[] = {
        FOUR "f 1 2 3 4\n",
        FOUR "f 1 2 3 4",
        FOUR "f -4 -3 -2 -1 # fan\n",
        FOUR "vt 0 0\nf 1/1 2/1 3/1 4/1\n",
        FOUR "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/-1\n",
        FOUR "vn 0 0 1\nf 1//1 2//1 3//1 4//1\n",
        FOUR "f 1// 2/ 3/7/ 4//\n",
        FOUR "vn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//2\nf 1//1 3//1 4//1\n",
        "f 1 2 3 4\n" FOUR,
        "v 0 0 0\r\nv 1 0 0 1.0\r\nv 1 1 0 0.5 0.5 nan\r\n\tv\t0\t1\t0\r\nf 1 2 \\\r\n 3 4\r\n",
        "\xef\xbb\xbf# text\nmtllib x.mtl\n" FOUR "l 1 2\np 1\ng a\ns off\nusemtl \n\nf 1 2 3 4\n",
        FOUR "f 1 2 3\nf 1 3 4\n",
    };
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        hewn_triangles mesh = read_text(hewn_obj_read, forms[i]);
        assert_true((mesh.normals != NULL) == (i == 4 || i == 5));
        if (mesh.normals)
            assert_true(mesh.normals[3 * 3 + 2] == 1);
        assert_true(mesh.positions[3 * 3] == 0 && mesh.positions[3 * 3 + 1] == 1);
        assert_indices(mesh, 4, 2, fan);
    }
    assert_indices(read_text(hewn_obj_read, ""), 0, 0, fan);
}

static void test_obj_errors(void **state)
{
    (void)state;
    assert_bad_text(hewn_obj_read, FOUR "\nf 1 2 5\nf 1 2 3\n", 6, "vertex 5");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 0\n", 5, "\"0\"");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 -5\n", 5, "\"-5\"");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 3x\n", 5, "\"3x\"");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 99999999999999999999\n", 5, "corner");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 4294967296\n", 5, "corner");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2\n", 5, "three corners");
    assert_bad_text(hewn_obj_read, FOUR "f\n", 5, "three corners");
    assert_bad_text(hewn_obj_read, FOUR "vn 0 0 1\nf 1//1 2//2 3//1\n", 6, "normal 2");
    assert_bad_text(hewn_obj_read, "v 0 0\n", 1, "the line ends");
    assert_bad_text(hewn_obj_read, "v 0 0", 1, "the file ends");
    assert_bad_text(hewn_obj_read, "v 0 0 nan\n", 1, "not finite");
    assert_bad_text(hewn_obj_read, "v 0 0 1e39\n", 1, "not finite");
    assert_bad_text(hewn_obj_read, "v 0 0 \x01\x80\n", 1, "\"\?\?\"");
    assert_bad(hewn_obj_read, "\xff\xfe#\0", 4, 1, "UTF-16");
    assert_bad(hewn_obj_read, "v 0\0 0", 6, 1, "not text");
}

/* --- PLY
 * ---------------------------------------------------------------------------------------------------------------- */

#define PLY_HEAD(form, vertices, faces)                                                                                \
    "ply\nformat " form " 1.0\ncomment x\nobj_info y\nelement vertex " vertices                                        \
    "\nproperty float x\nproperty double y\nproperty short z\nproperty list uchar int extra\nelement mystery 2\n"      \
    "property char a\nelement face " faces                                                                             \
    "\nproperty uchar flag\nproperty list ushort int vertex_indices\nproperty float after\nend_header\n"

static void test_ply_text(void **state)
{
    (void)state;
    assert_indices(read_text(hewn_ply_read, PLY_HEAD("ascii", "4", "1") "0 0 0 0\n1 0 0 1 9\n1 1 0 2 9 9\n0 1 0 0\n"
                                                                        "7\n-7\n255 4 0 1 2 3 0.5\n"),
                   4, 2, fan);
    assert_indices(read_text(hewn_ply_read, "ply\r\nformat ascii 1.0\r\nelement vertex 0\r\nelement face 0\r\n"
                                            "end_header\r\n"),
                   0, 0, fan);
    hewn_triangles mesh = read_text(hewn_ply_read, "ply\nformat ascii 1.0\nelement vertex 1\nproperty float nz\n"
                                                   "property float ny\nproperty float nx\nproperty float z\n"
                                                   "property float y\nproperty float x\nend_header\n6 0 0 3 2 1");
    assert_true(mesh.positions[0] == 1 && mesh.positions[1] == 2 && mesh.positions[2] == 3);
    assert_true(mesh.normals && mesh.normals[2] == 1);
    hewn_triangles_destroy(&mesh);
}

static void test_ply_strips(void **state)
{
    (void)state;
    static const uint32_t expected[] = {0, 1, 2, 2, 1, 3, 1, 2, 3};
    assert_indices(read_text(hewn_ply_read,
                             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                             "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                             "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 1 2 3\n"),
                   4, 3, expected);
}

static size_t put_bytes(char *to, uint64_t bits, size_t size, bool big)
{
    for (size_t i = 0; i < size; i++)
        to[i] = (char)(bits >> 8 * (big ? size - 1 - i : i) & 0xff);
    return size;
}

/* The same mesh in both orders, with every type of value. */
static void test_ply_binary(void **state)
{
    (void)state;
    for (int big = 0; big <= 1; big++) {
        char file[1024];
        const char *head = big ? PLY_HEAD("binary_big_endian", "4", "1") : PLY_HEAD("binary_little_endian", "4", "1");
        size_t length = strlen(head);
        memcpy(file, head, length);
        for (uint64_t v = 0; v < 4; v++) {
            bool x = v == 1 || v == 2, y = v >= 2;
            length += put_bytes(file + length, x ? 0x3f800000 : 0, 4, big);
            length += put_bytes(file + length, y ? 0x3ff0000000000000 : 0, 8, big);
            length += put_bytes(file + length, 0xfffe, 2, big);
            length += put_bytes(file + length, v, 1, big);
            for (uint64_t i = 0; i < v; i++)
                length += put_bytes(file + length, 9, 4, big);
        }
        length += put_bytes(file + length, 0x7f80, 2, big);
        length += put_bytes(file + length, 1, 1, big);
        length += put_bytes(file + length, 4, 2, big);
        for (uint64_t i = 0; i < 4; i++)
            length += put_bytes(file + length, i, 4, big);
        length += put_bytes(file + length, 0, 4, big);
        hewn_triangles mesh;
        assert_int_equal(read_exact(hewn_ply_read, file, length, &mesh, NULL), HEWN_OK);
        assert_true(mesh.positions[6] == 1 && mesh.positions[7] == 1 && mesh.positions[8] == -2);
        assert_indices(mesh, 4, 2, fan);
        for (size_t cut = strlen(head); cut < length; cut++) { /* every shorter file is refused */
            hewn_error error;
            assert_int_equal(read_exact(hewn_ply_read, file, cut, &mesh, &error), HEWN_BAD_INPUT);
        }
    }
}

#define PLY_PLAIN(vertices, faces, list)                                                                               \
    "ply\nformat ascii 1.0\nelement vertex " vertices                                                                  \
    "\nproperty float x\nproperty float y\nproperty float z\nelement face " faces "\nproperty list " list              \
    " vertex_indices\nend_header\n"

static void test_ply_errors(void **state)
{
    (void)state;
    static const char triangle[] = "0 0 0\n1 0 0\n0 1 0\n";
    char text[512];
    static const struct {
        const char *head, *tail;
        uint32_t line;
        const char *part;
    } cases[] = {
        {PLY_PLAIN("3", "1", "uchar int"), "3 0 1 3\n", 0, "vertex 3"},
        {PLY_PLAIN("3", "1", "uchar int"), "3 0 1 -1\n", 13, "-1"},
        {PLY_PLAIN("3", "1", "uchar int"), "3 0 1\n", 14, "the file ends"},
        {PLY_PLAIN("3", "1", "uchar int"), "-3 0 1 2\n", 13, "-3"},
        {PLY_PLAIN("3", "1", "uint int"), "4000000000 0 1 2\n", 13, "4000000000"},
        {PLY_PLAIN("3", "1", "uchar float"), "3 0 1 0.5\n", 13, "0.5"},
        {PLY_PLAIN("3", "1", "uchar int"), "3 0 1 x\n", 13, "\"x\""},
        {PLY_PLAIN("3", "1", "float int"), "3 0 1 2\n", 8, "whole number"},
        {PLY_PLAIN("3", "1", "uchar wide"), "3 0 1 2\n", 8, "\"wide\""},
        {PLY_PLAIN("353535235358", "1", "uchar int"), "", 0, "353535235358"},
        {PLY_PLAIN("3", "353535235358", "uchar int"), "3 0 1 2\n", 0, "353535235358"},
        {PLY_PLAIN("9223372036854775807", "1", "uchar int"), "", 0, "9223372036854775807"},
        {PLY_PLAIN("-1", "1", "uchar int"), "", 3, "\"-1\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, "%s%s%s", cases[i].head, triangle, cases[i].tail);
        assert_bad_text(hewn_ply_read, text, cases[i].line, cases[i].part);
    }
    assert_bad_text(hewn_ply_read, "", 1, "\"ply\"");
    assert_bad_text(hewn_ply_read, "plyx\n", 1, "\"plyx\"");
    assert_bad_text(hewn_ply_read, "ply\nformat utf8 1.0\n", 2, "\"utf8\"");
    assert_bad_text(hewn_ply_read, "ply\nelement vertex 0\n", 3, "no format or no end");
    assert_bad_text(hewn_ply_read, "ply\nelement vertex 0\nend_header\n", 4, "no format or no end");
    assert_bad_text(hewn_ply_read, "ply\nproperty float x\n", 2, "element");
    assert_bad_text(hewn_ply_read, "ply\nelement vertex 1\nelement vertex 1\n", 3, "once");
    assert_bad_text(hewn_ply_read, "ply\nelement vertex 1\nproperty float x\nproperty float x\n", 4, "once");
    assert_bad_text(hewn_ply_read, "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", 0,
                    "no x, y and z");
    assert_bad_text(hewn_ply_read, "ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n", 0,
                    "no x, y and z");
}

/* --- STL
 * ---------------------------------------------------------------------------------------------------------------- */

#define FACET(a, b, c)                                                                                                 \
    "facet normal -nan(ind) 0 0\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet\n"

static size_t put_stl(char *file, const char *head, uint32_t count, uint32_t facets, const float *corners)
{
    memset(file, 0, 84 + 50 * (size_t)facets);
    memcpy(file, head, strlen(head));
    memcpy(file + 80, &count, 4);
    for (uint32_t i = 0; i < facets; i++)
        memcpy(file + 84 + 50 * (size_t)i + 12, corners + 9 * (size_t)i, 36);
    return 84 + 50 * (size_t)facets;
}

static void test_stl_text(void **state)
{
    (void)state;
    assert_indices(read_text(hewn_stl_read, "solid a name with facet\n" FACET("0 0 0", "1 0 0", "1 1 0")
                                                FACET("-0 -0 -0", "1 1 0", "0 1e0 0") "endsolid a\n"),
                   4, 2, fan);
    assert_indices(read_text(hewn_stl_read,
                             "\n SOLID\nFacet Normal 0 0 1 OUTER loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 "
                             "0 vertex 0 1 0 EndLoop endFacet EndSolid\nsolid b\nendsolid b"),
                   4, 2, fan);
    assert_indices(read_text(hewn_stl_read, "solid\nendsolid\n"), 0, 0, fan);
}

static void test_stl_binary(void **state)
{
    (void)state;
    static const float corners[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, -0.0f, 0, 0, 1, 1, 0, 0, 1, 0};
    char file[512];
    hewn_triangles mesh;
    static const char *const heads[] = {"", "binary", "solid like text", "  solid"};
    for (int i = 0; i < 4; i++) {
        size_t length = put_stl(file, heads[i], 2, 2, corners);
        assert_int_equal(read_exact(hewn_stl_read, file, length, &mesh, NULL), HEWN_OK);
        assert_indices(mesh, 4, 2, fan);
        assert_int_equal(read_exact(hewn_stl_read, file, length + 7, &mesh, NULL), HEWN_OK); /* something trails */
        assert_indices(mesh, 4, 2, fan);
        for (size_t cut = 0; cut < length; cut++)
            assert_int_equal(read_exact(hewn_stl_read, file, cut, &mesh, NULL), HEWN_BAD_INPUT);
    }
    size_t length = put_stl(file, "", 0, 0, corners);
    assert_int_equal(read_exact(hewn_stl_read, file, length, &mesh, NULL), HEWN_OK);
    assert_indices(mesh, 0, 0, fan);
}

static void test_stl_errors(void **state)
{
    (void)state;
    static const float corners[] = {0, 0, 0, 1, 0, NAN, 1, 1, 0};
    char file[512];
    assert_bad(hewn_stl_read, file, put_stl(file, "", 1, 1, corners), 0, "facet 0");
    assert_bad(hewn_stl_read, file, put_stl(file, "", 0xffffffff, 1, corners), 0, "4294967295 facets");
    assert_bad_text(hewn_stl_read, "", 0, "empty");
    assert_bad_text(hewn_stl_read, "solid x", 1, "the file ends");
    assert_bad_text(hewn_stl_read, "solid x\n" FACET("0 0 0", "1 0 0", "1 blah 0"), 6, "\"blah\"");
    assert_bad_text(hewn_stl_read, "solid x\n" FACET("0 0 0", "1 0 0", "1 inf 0"), 6, "\"inf\"");
    assert_bad_text(hewn_stl_read, "solid x\n" FACET("0 0 0", "1 0 0", "1 0 0") "\nendfacet\n", 10, "\"endfacet\"");
    assert_bad_text(hewn_stl_read, "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n", 5, "\"vertex\"");
    assert_bad_text(hewn_stl_read, "solid x\nendsolid\nfacet\n", 3, "\"solid\"");
}

/* --- glTF
 * ---------------------------------------------------------------------------------------------------------------- */

/* A buffer of three positions (a right triangle in x and y) and the indices 0, 1, 2 in bytes. */
#define DATA                                                                                                           \
    "\"buffers\":[{\"byteLength\":40,\"uri\":\"data:application/octet-stream;base64,"                                  \
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAA==\"}],"
#define VIEWS                                                                                                          \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":3}],"            \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"                          \
    "{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}],"
#define MESH "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
#define ASSET "\"asset\":{\"version\":\"2.0\"}"
#define SCENE "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"

static const uint32_t one[] = {0, 1, 2}, mirrored[] = {0, 2, 1};

static void test_gltf_forms(void **state)
{
    (void)state;
    assert_indices(read_text(read_gltf, "{" DATA VIEWS MESH "\"nodes\":[{\"mesh\":0}]," SCENE ASSET "}"), 3, 1, one);
    assert_indices(read_text(read_gltf, "{" DATA VIEWS MESH ASSET "}"), 3, 1, one);
    assert_indices(read_text(read_gltf, "{" DATA VIEWS MESH "\"nodes\":[{\"mesh\":0}]," ASSET "}"), 3, 1, one);
    assert_indices(read_text(read_gltf, "{" DATA VIEWS MESH "\"nodes\":[{}]," SCENE ASSET "}"), 0, 0, one);
    assert_indices(read_text(read_gltf, "{\"extras\":[[[{\"x\":[]}]]],\"images\":[{\"uri\":\"no.png\"}]," DATA VIEWS
                                        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":1},"
                                        "{\"attributes\":{\"POSITION\":0}}]}]," ASSET "}"),
                   3, 1, one);
    assert_indices(read_text(read_gltf, "{" ASSET "}"), 0, 0, one);
}

static void test_gltf_transforms(void **state)
{
    (void)state;
    /* A parent moved by 10 along x and turned a quarter around z, a child scaled by 2, 3, -1. */
    hewn_triangles mesh = read_text(
        read_gltf, "{" DATA VIEWS MESH
                   "\"nodes\":[{\"children\":[1],\"translation\":[10,0,0],\"rotation\":[0,0,0.7071067811865476,"
                   "0.7071067811865476]},{\"mesh\":0,\"scale\":[2,3,-1]}]," SCENE ASSET "}");
    static const double expected[] = {10, 0, 0, 10, 2, 0, 7, 0, 0};
    for (int i = 0; i < 9; i++)
        assert_true(fabs((double)mesh.positions[i] - expected[i]) < 1e-6);
    assert_indices(mesh, 3, 1, mirrored); /* which turns triangles around */
    mesh = read_text(read_gltf,
                     "{" DATA VIEWS MESH "\"nodes\":[{\"mesh\":0,\"matrix\":[1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]},"
                     "{\"mesh\":0}],\"scenes\":[{\"nodes\":[1]},{\"nodes\":[0,1]}],\"scene\":1," ASSET "}");
    assert_int_equal(mesh.vertex_count, 6);
    assert_true(mesh.positions[0] == 5 && mesh.positions[1] == 6 && mesh.positions[2] == 7);
    assert_int_equal(mesh.indices[3], 3);
    hewn_triangles_destroy(&mesh);
}

static void test_gltf_errors(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"", "JSON"},
        {"{", "JSON"},
        {"[1]", "not an object"},
        {"{}", "asset"},
        {"{\"asset\":{\"version\":\"1.0\"}}", "version 1.0"},
        {"{\"asset\":{}}", "asset"},
        {"{" ASSET ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}", "KHR_draco_mesh_compression"},
        {"{" ASSET ",\"meshes\":{}}", "meshes"},
        {"{" ASSET ",\"meshes\":[{}]}", "primitives"},
        {"{" ASSET ",\"nodes\":[{\"matrix\":[[[[]]]]}]}", "matrix"},
        {"{" ASSET ",\"buffers\":[{}]}", "byteLength"},
        {"{" DATA VIEWS MESH "\"nodes\":[{\"mesh\":1}]," SCENE ASSET "}", "mesh that does not exist"},
        {"{" DATA VIEWS MESH "\"nodes\":[{\"mesh\":0,\"children\":[0]}]," SCENE ASSET "}", "twice"},
        {"{" DATA VIEWS MESH "\"nodes\":[{\"children\":[1]},{\"children\":[0]}]," SCENE ASSET "}", "twice"},
        {"{" DATA VIEWS MESH "\"nodes\":[{\"children\":[7]}]," SCENE ASSET "}", "node that does not exist"},
        {"{" DATA VIEWS "\"meshes\":[{\"primitives\":[{\"attributes\":{}}]}]," ASSET "}", "no positions"},
        {"{" DATA VIEWS "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":2}}]}]," ASSET "}", "accessor 2"},
        {"{" DATA VIEWS "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":1}}]}]," ASSET "}", "three floats"},
        {"{" DATA VIEWS "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":0}]}]," ASSET "}",
         "whole numbers"},
        {"{\"buffers\":[{\"byteLength\":50,\"uri\":\"data:;base64,AAAA\"}]," VIEWS MESH ASSET "}", "3 of the 50"},
        {"{\"buffers\":[{\"byteLength\":3,\"uri\":\"data:;base64,A?AA\"}]," VIEWS MESH ASSET "}", "base64"},
        {"{\"buffers\":[{\"byteLength\":3,\"uri\":\"data:text/plain,abc\"}]," VIEWS MESH ASSET "}", "base64"},
        {"{\"buffers\":[{\"byteLength\":3,\"uri\":\"x.bin\"}]," VIEWS MESH ASSET "}", "file of its own"},
        {"{\"buffers\":[{\"byteLength\":3}]," VIEWS MESH ASSET "}", "no data"},
        {"{\"buffers\":[]," VIEWS MESH ASSET "}", "buffer that does not exist"},
        {"{" DATA "\"bufferViews\":[{\"buffer\":0,\"byteLength\":41}],\"accessors\":[{\"bufferView\":0,"
         "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":0,\"componentType\":5121,\"count\":3,"
         "\"type\":\"SCALAR\"}]," MESH ASSET "}",
         "past its buffer"},
        {"{" DATA "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
         "\"componentType\":5126,\"count\":353535235358,\"type\":\"VEC3\"},{\"bufferView\":0,\"componentType\":5121,"
         "\"count\":3,\"type\":\"SCALAR\"}]," MESH ASSET "}",
         "past its bufferView"},
        {"{" DATA "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"componentType\":5126,"
         "\"count\":4000000000,\"type\":\"VEC3\"},{\"bufferView\":0,\"componentType\":5121,\"count\":3,"
         "\"type\":\"SCALAR\"}]," MESH ASSET "}",
         "without data"},
        {"{" DATA "\"bufferViews\":[{\"buffer\":0,\"byteLength\":40}],\"accessors\":[{\"bufferView\":0,"
         "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":0,\"componentType\":5121,"
         "\"byteOffset\":30,\"count\":3,\"type\":\"SCALAR\"}]," MESH ASSET "}",
         "vertex"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_bad_text(read_gltf, cases[i].text, 0, cases[i].part);
}

/* Meshes that stand in the scene again and again must not fill the memory. */
static void test_gltf_instances_have_a_limit(void **state)
{
    (void)state;
    size_t room = 1 << 20, used;
    char *text = hewn_alloc(room, 1);
    assert_non_null(text);
    used = (size_t)snprintf(text, room, "{" ASSET "," DATA VIEWS "\"meshes\":[{\"primitives\":[");
    for (int i = 0; i < 4000; i++)
        used += (size_t)snprintf(text + used, room - used, "%s{\"attributes\":{\"POSITION\":0}}", i ? "," : "");
    used += (size_t)snprintf(text + used, room - used, "]}],\"nodes\":[");
    for (int i = 0; i < 4000; i++)
        used += (size_t)snprintf(text + used, room - used, "%s{\"mesh\":0}", i ? "," : "");
    used += (size_t)snprintf(text + used, room - used, "]}");
    hewn_triangles mesh;
    hewn_error error = {0};
    assert_int_equal(read_exact(read_gltf, text, used, &mesh, &error), HEWN_LIMIT);
    assert_non_null(strstr(error.message, "proportion"));
    hewn_free(text);
}

static void test_deep_json(void **state)
{
    (void)state;
    size_t depth = 200000;
    char *text = hewn_alloc(2 * depth + 64, 1);
    assert_non_null(text);
    size_t used = (size_t)sprintf(text, "{" ASSET ",\"extras\":");
    memset(text + used, '[', depth);
    memset(text + used + depth, ']', depth);
    text[used + 2 * depth] = '}';
    hewn_triangles mesh;
    assert_int_equal(read_exact(read_gltf, text, used + 2 * depth + 1, &mesh, NULL), HEWN_OK);
    hewn_triangles_destroy(&mesh);
    hewn_free(text);
}

/* --- files of the test data
 * --------------------------------------------------------------------------------------------- */

static bool is_readable(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && (hewn_mesh_format_of(path) != HEWN_MESH_UNKNOWN || strcasecmp(dot, ".gltf") == 0);
}

static size_t visited, refused;

static int visit(const char *path, const struct stat *status, int kind, struct FTW *where)
{
    (void)status;
    (void)where;
    if (kind != FTW_F || !is_readable(path))
        return 0;
    hewn_triangles mesh;
    hewn_error error = {0};
    hewn_certificate certificate;
    hewn_result result = hewn_mesh_read(path, &mesh, &error);
    visited++;
    if (result == HEWN_OK) {
        result = hewn_certify(&mesh, NULL, &certificate, &error);
        hewn_triangles_destroy(&mesh);
        return result != HEWN_OK;
    }
    refused++;
    bool told = (result == HEWN_BAD_INPUT || result == HEWN_IO) && error.message[0] && error.file[0];
    if (!told || mesh.positions || mesh.indices)
        print_error("%s: %d %s\n", path, result, error.message);
    return !told || mesh.positions || mesh.indices;
}

/* Every file is either a mesh that can be examined or a clear error, and none takes much memory. */
static void test_data_malformed(void **state)
{
    (void)state;
    char data[4096], path[4200];
    if (!data_folder(data))
        skip();
    struct rusage before, after;
    getrusage(RUSAGE_SELF, &before);
    visited = refused = 0;
    static const char *const parts[] = {"malformed", "mesh-nasty"};
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", data, parts[i]);
        assert_int_equal(nftw(path, visit, 8, FTW_PHYS), 0);
    }
    getrusage(RUSAGE_SELF, &after);
    assert_true(visited >= 50);
    assert_true(refused >= 15 && refused <= 30);
    assert_true(after.ru_maxrss - before.ru_maxrss < 64 * 1024);
}

static void test_data_known_results(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        hewn_result result;
        uint32_t line;
        uint64_t vertices, triangles;
    } known[] = {
        {"malformed/Spider_ascii.stl", HEWN_OK, 0, 722, 1368},
        {"malformed/Wuson.ply", HEWN_OK, 0, 11184, 3732},
        {"malformed/busted.STL", HEWN_OK, 0, 1941, 3878},
        {"malformed/cornell_box.obj", HEWN_OK, 0, 76, 36},
        {"malformed/cube_binary_header_with_RN_newline.ply", HEWN_OK, 0, 8, 12},
        {"malformed/empty.stl", HEWN_OK, 0, 0, 0},
        {"malformed/wallhole.obj", HEWN_OK, 0, 92, 66},
        {"malformed/triangle_with_two_solids.stl", HEWN_OK, 0, 6, 2},
        {"malformed/negative_indices.obj", HEWN_OK, 0, 8, 12},
        {"malformed/BoxTextured.glb", HEWN_OK, 0, 24, 12},
        {"malformed/glb/valid_buffer.glb", HEWN_OK, 0, 0, 0},
        {"mesh-nasty/far-out-ring.obj", HEWN_OK, 0, 1536, 3072},
        {"malformed/number_formats.obj", HEWN_BAD_INPUT, 11, 0, 0},
        {"malformed/test-nan.obj", HEWN_BAD_INPUT, 12, 0, 0},
        {"malformed/issue623.ply", HEWN_BAD_INPUT, 14, 0, 0},
        {"malformed/malformed.obj", HEWN_BAD_INPUT, 28, 0, 0},
        {"malformed/box_UTF16BE.obj", HEWN_BAD_INPUT, 1, 0, 0},
        {"malformed/IndexOutOfRange.gltf", HEWN_IO, 0, 0, 0},
        {"malformed/glb/chunk_too_big.glb", HEWN_BAD_INPUT, 0, 0, 0},
        {"mesh-nasty/invalidvertex.stl", HEWN_BAD_INPUT, 0, 0, 0},
        {"mesh-nasty/unparseable.stl", HEWN_BAD_INPUT, 4, 0, 0},
        {"mesh-nasty/empty.stl", HEWN_BAD_INPUT, 0, 0, 0},
    };
    char data[4096], path[4200];
    if (!data_folder(data))
        skip();
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        snprintf(path, sizeof path, "%s/%s", data, known[i].file);
        hewn_triangles mesh;
        hewn_error error = {0};
        hewn_result result = hewn_mesh_read(path, &mesh, &error);
        if (result != known[i].result || mesh.vertex_count != known[i].vertices ||
            mesh.triangle_count != known[i].triangles || (known[i].line && error.line != known[i].line))
            fail_msg("%s: %d, line %u %s, %llu vertices, %llu triangles", known[i].file, result, error.line,
                     error.message, (unsigned long long)mesh.vertex_count, (unsigned long long)mesh.triangle_count);
        hewn_triangles_destroy(&mesh);
    }
}

static long long number_after(const char *line, const char *key)
{
    const char *at = strstr(line, key);
    return at ? strtoll(at + strlen(key), NULL, 10) : -1;
}

/* One line of STATS.txt, which another program counted, against what Hewn reads and certifies. */
static bool check_stats(const char *data, const char *line)
{
    static const char *const parts[] = {"mesh-scan/", "mesh-open/", "mesh-control/", "subdiv-baseline/", "boolean/"};
    char file[256], path[4400];
    bool wanted = false;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        wanted = wanted || strncmp(line, parts[i], strlen(parts[i])) == 0;
    if (!wanted || sscanf(line, "%255s", file) != 1 || !is_readable(file) || !strstr(line, " V="))
        return false;
    snprintf(path, sizeof path, "%s/%s", data, file);
    hewn_triangles mesh;
    hewn_error error = {0};
    hewn_certificate c;
    if (hewn_mesh_read(path, &mesh, &error) != HEWN_OK || hewn_certify(&mesh, NULL, &c, &error) != HEWN_OK)
        fail_msg("%s: %s", file, error.message);
    long long chi = number_after(line, " chi=");
    bool same = (long long)mesh.vertex_count == number_after(line, " V=") &&
                (long long)mesh.triangle_count == number_after(line, " triangulated=") &&
                (long long)c.components == number_after(line, " comp=") &&
                (long long)c.boundary_edges == number_after(line, " bndE=") &&
                (long long)c.non_manifold_edges == number_after(line, " nonmanE=") &&
                c.oriented == (number_after(line, " flipE=") == 0) &&
                (c.genus < 0 || 2 * ((long long)c.components - c.genus) == chi);
    if (!same)
        fail_msg("%s: %llu vertices, %llu components, genus %lld, %llu boundary, %llu non-manifold, oriented %d; %s",
                 file, (unsigned long long)mesh.vertex_count, (unsigned long long)c.components, (long long)c.genus,
                 (unsigned long long)c.boundary_edges, (unsigned long long)c.non_manifold_edges, c.oriented, line);
    hewn_triangles_destroy(&mesh);
    return true;
}

static void test_data_agrees_with_its_statistics(void **state)
{
    (void)state;
    char data[4096], path[4200], line[1024];
    FILE *stats = NULL;
    if (data_folder(data)) {
        snprintf(path, sizeof path, "%s/STATS.txt", data);
        stats = fopen(path, "r");
    }
    if (!stats)
        skip();
    size_t checked = 0;
    while (fgets(line, sizeof line, stats)) {
        char *tab = strchr(line, '\t');
        if (tab)
            *tab = ' ';
        checked += check_stats(data, line);
    }
    fclose(stats);
    assert_true(checked >= 60);
}

static void test_mesh_read_errors(void **state)
{
    (void)state;
    hewn_triangles mesh = {.vertex_count = 1};
    hewn_error error;
    assert_int_equal(hewn_mesh_read("x.unknown", &mesh, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(mesh.vertex_count, 0);
    assert_int_equal(hewn_mesh_read("/nonexistent/x.stl", &mesh, &error), HEWN_IO);
    assert_string_equal(error.file, "/nonexistent/x.stl");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_obj_forms),
        cmocka_unit_test(test_obj_errors),
        cmocka_unit_test(test_ply_text),
        cmocka_unit_test(test_ply_strips),
        cmocka_unit_test(test_ply_binary),
        cmocka_unit_test(test_ply_errors),
        cmocka_unit_test(test_stl_text),
        cmocka_unit_test(test_stl_binary),
        cmocka_unit_test(test_stl_errors),
        cmocka_unit_test(test_gltf_forms),
        cmocka_unit_test(test_gltf_transforms),
        cmocka_unit_test(test_gltf_errors),
        cmocka_unit_test(test_gltf_instances_have_a_limit),
        cmocka_unit_test(test_deep_json),
        cmocka_unit_test(test_data_malformed),
        cmocka_unit_test(test_data_known_results),
        cmocka_unit_test(test_data_agrees_with_its_statistics),
        cmocka_unit_test(test_mesh_read_errors),
    };
    return cmocka_run_group_tests_name("io_read", tests, NULL, NULL);
}
