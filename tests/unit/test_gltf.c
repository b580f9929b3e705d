/* Reading glTF and GLB: the forms that the format allows, broken files, and the files of the test data. */
#include <math.h>

#include "gltf_support.h"

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

/* Checks counts and corners, and destroys the model. */
static void assert_faces(hewn_model model, uint64_t vertices, uint64_t faces, const uint32_t *corners)
{
    assert_int_equal(model.vertex_count, vertices);
    assert_int_equal(model.face_count, faces);
    if (faces > 0)
        assert_memory_equal(model.corners, corners, faces * 3 * sizeof *corners);
    assert_null(model.first);
    assert_string_equal(model.unit->name, "m");
    assert_true(model.up == HEWN_AXIS_PLUS_Y && model.up_known);
    hewn_model_destroy(&model);
}

static const uint32_t one[] = {0, 1, 2}, mirrored[] = {0, 2, 1};

/* --- GLB files made here ------------------------------------------------------------------------------------------ */

typedef struct blob {
    char bytes[1 << 14];
    size_t length;
} blob;

static void put_words(blob *to, const uint32_t *words, size_t count, size_t size)
{
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < size; k++)
            to->bytes[to->length++] = (char)(words[i] >> 8 * k & 0xff);
}

static void put_floats(blob *to, const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        put_words(to, &bits, 1, 4);
    }
}

/* A GLB file of this JSON (without braces and asset) and one buffer. */
static blob make_glb(const char *json, const blob *data)
{
    blob file = {.length = 0};
    char text[1 << 13];
    int length = snprintf(text, sizeof text, "{\"buffers\":[{\"byteLength\":%zu}],%s," ASSET "}", data->length, json);
    assert_true(length > 0 && (size_t)length < sizeof text);
    uint32_t padded = ((uint32_t)length + 3) & ~3u, rest = ((uint32_t)data->length + 3) & ~3u;
    const uint32_t head[] = {0x46546C67, 2, 28 + padded + rest, padded, 0x4E4F534A}, middle[] = {rest, 0x004E4942};
    put_words(&file, head, 5, 4);
    memset(file.bytes + file.length, ' ', padded);
    memcpy(file.bytes + file.length, text, (size_t)length);
    file.length += padded;
    put_words(&file, middle, 2, 4);
    memcpy(file.bytes + file.length, data->bytes, data->length);
    file.length += rest;
    return file;
}

static hewn_model read_glb(const char *json, const blob *data)
{
    blob file = make_glb(json, data);
    return read_bytes(hewn_gltf_read, file.bytes, file.length);
}

static void assert_bad_glb(const char *json, const blob *data, const char *part)
{
    blob file = make_glb(json, data);
    assert_bad(hewn_gltf_read, file.bytes, file.length, 0, part);
}

/* --- forms -------------------------------------------------------------------------------------------------------- */

static void test_forms(void **state)
{
    (void)state;
    static const char *const forms[] = {
        "{" DATA VIEWS MESH "\"nodes\":[{\"mesh\":0}]," SCENE ASSET "}",
        "{" DATA VIEWS MESH ASSET "}",
        "{" DATA VIEWS MESH "\"nodes\":[{\"mesh\":0}]," ASSET "}",
        "{\"extras\":[[[{\"x\":[]}]]],\"images\":[{\"uri\":\"no.png\"}]," DATA VIEWS
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":1},"
        "{\"attributes\":{\"POSITION\":0}}]}]," ASSET "}",
        "{\"extensionsRequired\":[\"KHR_mesh_quantization\",\"KHR_materials_unlit\",\"EXT_mesh_manifold\"]," DATA VIEWS
            MESH ASSET "}",
    };
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
        assert_faces(read_text(hewn_gltf_read, forms[i]), 3, 1, one);
    assert_faces(read_text(hewn_gltf_read, "{" DATA VIEWS MESH "\"nodes\":[{}]," SCENE ASSET "}"), 0, 0, one);
    assert_faces(read_text(hewn_gltf_read, "{" ASSET "}"), 0, 0, one);
}

static void test_transforms(void **state)
{
    (void)state;
    /* A parent moved by 10 along x and turned a quarter around z, a child scaled by 2, 3, -1. */
    hewn_model model = read_text(
        hewn_gltf_read, "{" DATA VIEWS MESH
                        "\"nodes\":[{\"children\":[1],\"translation\":[10,0,0],\"rotation\":[0,0,0.7071067811865476,"
                        "0.7071067811865476]},{\"mesh\":0,\"scale\":[2,3,-1]}]," SCENE ASSET "}");
    static const double expected[] = {10, 0, 0, 10, 2, 0, 7, 0, 0};
    for (int i = 0; i < 9; i++)
        assert_true(fabs(model.positions[i] - expected[i]) < 1e-15);
    assert_faces(model, 3, 1, mirrored); /* which turns triangles around */
    model = read_text(hewn_gltf_read,
                      "{" DATA VIEWS MESH "\"nodes\":[{\"mesh\":0,\"matrix\":[1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]},"
                      "{\"mesh\":0}],\"scenes\":[{\"nodes\":[1]},{\"nodes\":[0,1]}],\"scene\":1," ASSET "}");
    assert_true(model.positions[0] == 5 && model.positions[1] == 6 && model.positions[2] == 7);
    static const uint32_t two[] = {0, 1, 2, 3, 4, 5};
    assert_faces(model, 6, 2, two);
}

/* Five vertices in a row of points, as strip and fan, with every type of index. */
static void test_strips_and_fans(void **state)
{
    (void)state;
    static const struct {
        int type;
        size_t size;
    } types[] = {{5121, 1}, {5123, 2}, {5125, 4}};
    static const uint32_t given[] = {0, 1, 2, 3, 3, 4};
    static const uint32_t strip[] = {0, 1, 2, 2, 1, 3}, fan[] = {0, 1, 2, 0, 2, 3, 0, 3, 3, 0, 3, 4};
    for (int i = 0; i < 3; i++)
        for (int mode = 5; mode <= 6; mode++) {
            blob data = {.length = 0};
            float positions[15];
            for (int k = 0; k < 15; k++)
                positions[k] = (float)(k * k);
            put_floats(&data, positions, 15);
            put_words(&data, given, 6, types[i].size);
            char json[1024];
            snprintf(json, sizeof json,
                     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":60},{\"buffer\":0,\"byteOffset\":60,"
                     "\"byteLength\":%zu}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":5,"
                     "\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":%d,\"count\":6,\"type\":\"SCALAR\"}],"
                     "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":%d}]}]",
                     6 * types[i].size, types[i].type, mode);
            assert_faces(read_glb(json, &data), 5, mode == 5 ? 2 : 4, mode == 5 ? strip : fan);
        }
}

/* Positions on top of others, or of zeros; a sparse index; the places in bytes and in words. */
static void test_sparse(void **state)
{
    (void)state;
    static const float base[] = {9, 9, 9, 1, 0, 0, 9, 9, 9}, over[] = {5, 6, 7, 0, 1, 0};
    static const uint32_t places[] = {0, 2}, indices[] = {0, 1, 1};
    for (int size = 1; size <= 4; size *= 2)
        for (int based = 0; based <= 1; based++) {
            blob data = {.length = 0};
            put_floats(&data, base, 9);
            put_floats(&data, over, 6);
            put_words(&data, places, 2, (size_t)size);
            data.length = 68;
            put_words(&data, indices, 3, 4);
            put_words(&data, &places[1], 1, 4);
            char json[2048];
            snprintf(json, sizeof json,
                     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":"
                     "24},{\"buffer\":0,\"byteOffset\":60,\"byteLength\":8},{\"buffer\":0,\"byteOffset\":68,"
                     "\"byteLength\":16}],\"accessors\":[{%s\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
                     "\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":2,\"componentType\":%d},\"values\":{"
                     "\"bufferView\":1}}},{\"bufferView\":3,\"componentType\":5125,\"count\":3,\"type\":\"SCALAR\","
                     "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":3,\"byteOffset\":12,\"componentType\":5125},"
                     "\"values\":{\"bufferView\":3,\"byteOffset\":12}}}],"
                     "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]",
                     based ? "\"bufferView\":0," : "",
                     size == 1   ? 5121
                     : size == 2 ? 5123
                                 : 5125);
            hewn_model model = read_glb(json, &data);
            const double expected[] = {5, 6, 7, based ? 1 : 0, 0, 0, 0, 1, 0};
            assert_memory_equal(model.positions, expected, sizeof expected);
            assert_faces(model, 3, 1, one);
        }
}

/* An accessor without a view is zeros; as many as the JSON likes, but not for nothing. */
static void test_zeros_have_a_limit(void **state)
{
    (void)state;
    blob data = {.length = 4};
    hewn_model model = read_glb("\"accessors\":[{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
                                "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]",
                                &data);
    static const uint32_t same[] = {0, 0, 0};
    assert_faces(model, 1, 1, same);
    blob file = make_glb("\"accessors\":[{\"componentType\":5126,\"count\":353535235358,\"type\":\"VEC3\"}],"
                         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]",
                         &data);
    hewn_error error = {0};
    assert_int_equal(read_exact(hewn_gltf_read, file.bytes, file.length, &model, &error), HEWN_LIMIT);
    assert_non_null(strstr(error.message, "proportion"));
}

/* What whole numbers of each type mean, for three components with a stride. */
static void test_quantization(void **state)
{
    (void)state;
    static const struct {
        int type;
        size_t size;
        uint32_t given[3];
        double whole[3], most;
    } types[] = {
        {5120, 1, {0x81, 0x80, 0x7f}, {-127, -128, 127}, 127},
        {5121, 1, {0, 0xff, 0x80}, {0, 255, 128}, 255},
        {5122, 2, {0x8001, 0x8000, 0x7fff}, {-32767, -32768, 32767}, 32767},
        {5123, 2, {0, 0xffff, 0x1234}, {0, 65535, 0x1234}, 65535},
    };
    for (int i = 0; i < 4; i++)
        for (int normalised = 0; normalised <= 1; normalised++) {
            blob data = {.length = 0};
            static const uint32_t nothing[3] = {0};
            for (int v = 0; v < 3; v++) {
                put_words(&data, v == 1 ? types[i].given : nothing, 3, types[i].size);
                data.bytes[data.length] = (char)v; /* y tells the others apart */
                if (v == 2)
                    data.bytes[data.length - 2 * types[i].size] = 7;
                data.length += types[i].size;
            }
            char json[1024];
            snprintf(json, sizeof json,
                     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu,\"byteStride\":%zu}],\"accessors\":[{"
                     "\"bufferView\":0,\"componentType\":%d,\"count\":3,\"type\":\"VEC3\",\"normalized\":%s}],"
                     "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":0}}]}]",
                     data.length, 4 * types[i].size, types[i].type, normalised ? "true" : "false");
            hewn_model model = read_glb(json, &data);
            double normal[16];
            get_numbers(&model, "normal", 1, normal);
            for (int axis = 0; axis < 3; axis++) {
                double expected = types[i].whole[axis];
                if (normalised)
                    expected = fmax(expected / types[i].most, -1);
                assert_true(model.positions[3 + axis] == expected);
                assert_true(normal[axis] == (double)(float)expected);
            }
            assert_faces(model, 3, 1, one);
        }
}

/* --- seams -------------------------------------------------------------------------------------------------------- */

/* Two triangles that share an edge of which both have their own copies: vertices 1, 2 and 3, 4. Then normals, texture
 * coordinates (those of 2 and 4 differ), and indices. */
#define SEAM_VIEWS                                                                                                     \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":72},{\"buffer\":0,\"byteOffset\":72,\"byteLength\":72},"            \
    "{\"buffer\":0,\"byteOffset\":144,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":192,\"byteLength\":24},"         \
    "{\"buffer\":0,\"byteOffset\":216,\"byteLength\":16}],"                                                            \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":6,\"type\":\"VEC3\"},"                          \
    "{\"bufferView\":1,\"componentType\":5126,\"count\":6,\"type\":\"VEC3\"},"                                         \
    "{\"bufferView\":2,\"componentType\":5126,\"count\":6,\"type\":\"VEC2\"},"                                         \
    "{\"bufferView\":3,\"componentType\":5125,\"count\":6,\"type\":\"SCALAR\"},"                                       \
    "{\"bufferView\":3,\"componentType\":5125,\"count\":6,\"type\":\"SCALAR\",\"sparse\":{\"count\":1,\"indices\":"    \
    "{\"bufferView\":4,\"componentType\":5125},\"values\":{\"bufferView\":4,\"byteOffset\":4}}},"                      \
    "{\"bufferView\":4,\"componentType\":5125,\"count\":1,\"type\":\"SCALAR\"},"                                       \
    "{\"bufferView\":4,\"byteOffset\":4,\"componentType\":5125,\"count\":1,\"type\":\"SCALAR\"},"                      \
    "{\"bufferView\":3,\"componentType\":5125,\"count\":3,\"type\":\"SCALAR\"},"                                       \
    "{\"bufferView\":3,\"byteOffset\":12,\"componentType\":5125,\"count\":3,\"type\":\"SCALAR\"}]"
#define SEAM_ATTRIBUTES "\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2}"
#define SEAM_TOPOLOGY                                                                                                  \
    "\"extensions\":{\"EXT_mesh_manifold\":{\"manifoldPrimitive\":{\"indices\":4,\"mode\":4,\"attributes\":"           \
    "{\"POSITION\":0}},\"mergeIndices\":5,\"mergeValues\":6}}"

static blob make_seam(uint32_t place, uint32_t vertex)
{
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, -0.0f, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    static const float uv[] = {0, 0, 1, 0, 0, 1, 1, 0, 0.5f, 0.25f, 0, 0};
    static const uint32_t indices[] = {0, 1, 2, 4, 3, 5};
    blob data = {.length = 0};
    put_floats(&data, positions, 18);
    for (int v = 0; v < 6; v++)
        put_floats(&data, (const float[]){0, 0, 1}, 3);
    put_floats(&data, uv, 12);
    put_words(&data, indices, 6, 4);
    put_words(&data, (const uint32_t[]){place, vertex, 0, 0}, 4, 4);
    return data;
}

static void check_seam(const hewn_model *model)
{
    static const double uv[] = {0, 1, 1, 1, 0, 0, 0.5, 0.75, 1, 1, 0, 1};
    const hewn_channel *channel = hewn_model_find_channel(model, HEWN_DOMAIN_CORNER, "uv");
    assert_non_null(channel);
    assert_memory_equal(channel->values, uv, sizeof uv);
    assert_non_null(hewn_model_find_channel(model, HEWN_DOMAIN_VERT, "normal"));
    assert_true(signbit(model->positions[8])); /* the first wedge's bits */
}

static void test_seams_are_welded(void **state)
{
    (void)state;
    static const uint32_t welded[] = {0, 1, 2, 2, 1, 3};
    blob data = make_seam(0, 0);
    hewn_model model =
        read_glb(SEAM_VIEWS ",\"meshes\":[{\"primitives\":[{" SEAM_ATTRIBUTES ",\"indices\":3}]}]", &data);
    check_seam(&model);
    assert_faces(model, 4, 2, welded);
    model = read_glb(SEAM_VIEWS ",\"meshes\":[{\"primitives\":[{" SEAM_ATTRIBUTES ",\"indices\":7},{" SEAM_ATTRIBUTES
                                ",\"indices\":8}]}]",
                     &data);
    check_seam(&model);
    assert_faces(model, 4, 2, welded);
    /* One of the parts has no normals: then there are none. */
    model = read_glb(SEAM_VIEWS ",\"meshes\":[{\"primitives\":[{" SEAM_ATTRIBUTES
                                ",\"indices\":7},{\"attributes\":{\"POSITION\":0},\"indices\":8}]}]",
                     &data);
    assert_null(hewn_model_find_channel(&model, HEWN_DOMAIN_VERT, "normal"));
    assert_null(hewn_model_find_channel(&model, HEWN_DOMAIN_CORNER, "normal"));
    assert_faces(model, 4, 2, welded);
    /* Instances stay apart. */
    static const uint32_t twice[] = {0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7};
    model = read_glb(SEAM_VIEWS ",\"meshes\":[{\"primitives\":[{" SEAM_ATTRIBUTES
                                ",\"indices\":3}]}],\"nodes\":[{\"mesh\":0},{\"mesh\":0}]",
                     &data);
    assert_faces(model, 8, 4, twice);
}

/* What EXT_mesh_manifold names is merged, nothing else. */
static void test_manifold_extension(void **state)
{
    (void)state;
    static const uint32_t expected[] = {0, 1, 2, 3, 1, 4};
    static const char *const forms[] = {
        SEAM_VIEWS ",\"meshes\":[{\"primitives\":[{" SEAM_ATTRIBUTES ",\"indices\":3}]," SEAM_TOPOLOGY "}]",
        SEAM_VIEWS ",\"meshes\":[{\"primitives\":[{" SEAM_ATTRIBUTES ",\"indices\":7},{\"attributes\":{\"POSITION\":0},"
                   "\"indices\":8}]," SEAM_TOPOLOGY "}]",
    };
    blob data = make_seam(4, 1); /* corner 4, at vertex 3, counts as vertex 1 */
    for (int i = 0; i < 2; i++)
        assert_faces(read_glb(forms[i], &data), 5, 2, expected);
    data = make_seam(4, 5);
    assert_bad_glb(forms[0], &data, "different positions");
    data = make_seam(4, 6);
    assert_bad_glb(forms[0], &data, "does not exist");
    data = make_seam(6, 1);
    assert_bad_glb(forms[0], &data, "past its end");
    assert_bad_glb(SEAM_VIEWS ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":1},\"indices\":3}]," //
                   SEAM_TOPOLOGY "}]",
                   &data, "other positions");
}

/* --- attributes --------------------------------------------------------------------------------------------------- */

static void check_values(const hewn_model *model, const char *name, hewn_scalar scalar, uint32_t components,
                         const double *expected)
{
    const hewn_channel *channel = hewn_model_find_channel(model, HEWN_DOMAIN_VERT, name);
    if (!channel)
        fail_msg("no channel \"%s\"", name);
    assert_int_equal(channel->info.scalar, scalar);
    assert_int_equal(channel->info.components, components);
    for (uint32_t i = 0; i < 3 * components; i++)
        if (hewn_channel_number(channel, i / components, i % components) != expected[i])
            fail_msg("%s: %g instead of %g", name, hewn_channel_number(channel, i / components, i % components),
                     expected[i]);
}

#define ACCESSOR(type, form, more)                                                                                     \
    "{\"bufferView\":1,\"componentType\":" type ",\"count\":3,\"type\":\"" form "\"" more "}"

/* The same bytes 0, 1, 2, ... as colours and users' attributes of several types. */
static void test_attributes(void **state)
{
    (void)state;
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    blob data = {.length = 0};
    put_floats(&data, positions, 9);
    for (uint32_t i = 0; i < 48; i++)
        put_words(&data, &i, 1, 1);
    hewn_model model = read_glb(
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":48,"
        "\"byteStride\":16}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "" ACCESSOR("5121", "VEC4", ",\"normalized\":true") "," ACCESSOR("5123", "SCALAR", "") "," //
        ACCESSOR("5122", "VEC2", ",\"normalized\":true") "," ACCESSOR(
            "5125", "SCALAR", "") "]," //
                                  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"COLOR_0\":1,\"_"
                                  "label\":2,\"_S\":3,\"_L\":4,"
                                  "\"_uv\":1,\"__uv\":2,\"_\":2,\"JOINTS_0\":1,\"TEXCOORD_1\":99}}]}]",
        &data);
    check_values(&model, "color", HEWN_SCALAR_UINT8, 4, (const double[]){0, 1, 2, 3, 16, 17, 18, 19, 32, 33, 34, 35});
    check_values(&model, "label", HEWN_SCALAR_INT32, 1, (const double[]){256, 4368, 8480});
    const double s[] = {(double)(float)(256.0 / 32767),  (double)(float)(770.0 / 32767),
                        (double)(float)(4368.0 / 32767), (double)(float)(4882.0 / 32767),
                        (double)(float)(8480.0 / 32767), (double)(float)(8994.0 / 32767)};
    check_values(&model, "S", HEWN_SCALAR_FLOAT, 2, s);
    check_values(&model, "L", HEWN_SCALAR_DOUBLE, 1, (const double[]){50462976, 319951120, 589439264});
    assert_non_null(hewn_model_find_channel(&model, HEWN_DOMAIN_VERT, "_uv"));
    assert_non_null(hewn_model_find_channel(&model, HEWN_DOMAIN_VERT, "_"));
    assert_int_equal(model.channel_count, 6);
    assert_faces(model, 3, 1, one);
}

static void test_colours(void **state)
{
    (void)state;
    blob data = {.length = 0};
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, floats[] = {0, 0.5f, 1, 2, 0, 0, 0, 0, 0.25f};
    put_floats(&data, positions, 9);
    put_floats(&data, floats, 9);
    static const char form[] =
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":36}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"VEC4\"}],\"meshes\":[{\"primitives\":["
        "{\"attributes\":{\"POSITION\":0,\"COLOR_0\":%s}}%s]}]";
    char json[1024];
    snprintf(json, sizeof json, form, "1", "");
    hewn_model model = read_glb(json, &data);
    const double expected[] = {0, 0.5, 1, 2, 0, 0, 0, 0, 0.25};
    check_values(&model, "color", HEWN_SCALAR_FLOAT, 3, expected);
    hewn_model_destroy(&model);
    snprintf(json, sizeof json, form, "2", "");
    model = read_glb(json, &data);
    double colour[16];
    get_numbers(&model, "color", 0, colour);
    assert_true(colour[3] == (double)(float)(0x3f00 / 65535.0));
    hewn_model_destroy(&model);
    /* A part without colours is white, and three components become four where others have them. */
    snprintf(json, sizeof json, form, "1",
             ",{\"attributes\":{\"POSITION\":0}},{\"attributes\":{\"POSITION\":0,\"COLOR_0\":2}}");
    model = read_glb(json, &data);
    get_numbers(&model, "color", 0, colour);
    assert_true(colour[1] == 0.5 && colour[3] == 1);
    get_numbers(&model, "color", 3, colour);
    assert_true(colour[0] == 1 && colour[3] == 1);
    assert_int_equal(model.vertex_count, 3);
    hewn_model_destroy(&model);
}

static void check_names(const hewn_model *model, const char *channel_name, const char *const *expected)
{
    const hewn_channel *channel = hewn_model_find_channel(model, HEWN_DOMAIN_FACE, channel_name);
    assert_non_null(channel);
    for (uint64_t face = 0; channel && face < model->face_count; face++) {
        int32_t value = ((const int32_t *)channel->values)[face];
        assert_true(value < (int32_t)channel->name_count);
        if (!expected[face])
            assert_int_equal(value, -1);
        else
            assert_string_equal(channel->names[value], expected[face]);
    }
}

static void test_names(void **state)
{
    (void)state;
    hewn_model model = read_text(
        hewn_gltf_read,
        "{" DATA VIEWS "\"materials\":[{},{\"name\":\"red\"},{\"name\":\"red\"}],"
        "\"meshes\":[{\"name\":\"a\",\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":2},"
        "{\"attributes\":{\"POSITION\":0},\"material\":0},{\"attributes\":{\"POSITION\":0}}]},"
        "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":1}]}],"
        "\"nodes\":[{\"mesh\":0},{\"mesh\":1,\"name\":\"b\"},{\"mesh\":1},{\"mesh\":1,\"name\":\"a\"}]," ASSET "}");
    assert_int_equal(model.face_count, 6);
    static const char *const materials[] = {"red", "unnamed 1", NULL, "red.2", "red.2", "red.2"};
    static const char *const objects[] = {"a", "a", "a", "b", "unnamed 3", "a.4"};
    check_names(&model, "material", materials);
    check_names(&model, "object", objects);
    hewn_model_destroy(&model);
    model = read_text(hewn_gltf_read, "{" DATA VIEWS "\"materials\":[{}],\"meshes\":[{\"primitives\":[{\"attributes\":"
                                      "{\"POSITION\":0},\"material\":0}]}]," ASSET "}");
    assert_int_equal(model.channel_count, 0); /* one object, no names */
    hewn_model_destroy(&model);
}

/* A mirrored, stretched instance: normals stay at right angles to the surface, and point outward. */
static void test_normals_are_turned(void **state)
{
    (void)state;
    blob data = {.length = 0};
    static const float positions[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    float third = (float)(1 / sqrt(3));
    put_floats(&data, positions, 9);
    for (int i = 0; i < 9; i++)
        put_floats(&data, &third, 1);
    hewn_model model = read_glb(
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":36}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":"
        "[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1}}]}],\"nodes\":[{\"mesh\":0,\"scale\":[2,-3,4]}]",
        &data);
    double normal[16], along = 0;
    get_numbers(&model, "normal", 0, normal);
    for (int k = 1; k < 3; k++) {
        double dot = 0;
        for (int axis = 0; axis < 3; axis++)
            dot += normal[axis] *
                   (model.positions[3 * model.corners[k] + axis] - model.positions[3 * model.corners[0] + axis]);
        assert_true(fabs(dot) < 1e-6);
    }
    for (int axis = 0; axis < 3; axis++)
        along += normal[axis] * model.positions[3 * model.corners[0] + axis];
    assert_true(along > 0);
    assert_true(fabs(hypot(hypot(normal[0], normal[1]), normal[2]) - 1) < 1e-6);
    hewn_model_destroy(&model);
}

/* --- errors ------------------------------------------------------------------------------------------------------- */

static void test_errors(void **state)
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
        {"{" ASSET ",\"extensionsRequired\":[\"EXT_meshopt_compression\"]}", "EXT_meshopt_compression"},
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
        {"{" DATA VIEWS "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":1}}]}]," ASSET "}",
         "three numbers"},
        {"{" DATA VIEWS "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1}}]}]," ASSET "}",
         "NORMAL"},
        {"{" DATA VIEWS "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0}]}]," ASSET "}",
         "material"},
        {"{" DATA VIEWS "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":7}]}]," ASSET "}",
         "mode"},
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
        {"{" DATA "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
         "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":1}},{\"bufferView\":0,"
         "\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}]," MESH ASSET "}",
         "sparse"},
        {"{" DATA "\"bufferViews\":[{\"buffer\":0,\"byteLength\":40}],\"accessors\":[{\"bufferView\":0,"
         "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":0,\"componentType\":5121,"
         "\"byteOffset\":30,\"count\":3,\"type\":\"SCALAR\"}]," MESH ASSET "}",
         "vertex"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_bad_text(hewn_gltf_read, cases[i].text, 0, cases[i].part);
}

static void test_numbers_are_finite(void **state)
{
    (void)state;
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, NAN, 0, 0, 1, 0, 0, INFINITY};
    blob data = {.length = 0};
    put_floats(&data, positions, 18);
    static const char form[] =
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":72}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
        "\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":0,\"byteOffset\":36,\"componentType\":5126,\"count\":3,"
        "\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{%s}}]}]";
    char json[1024];
    snprintf(json, sizeof json, form, "\"POSITION\":1");
    assert_bad_glb(json, &data, "position of vertex 0");
    snprintf(json, sizeof json, form, "\"POSITION\":0,\"_X\":1");
    assert_bad_glb(json, &data, "_X of vertex 0");
}

/* Meshes that stand in the scene again and again must not fill the memory. */
static void test_instances_have_a_limit(void **state)
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
    hewn_model model;
    hewn_error error = {0};
    assert_int_equal(read_exact(hewn_gltf_read, text, used, &model, &error), HEWN_LIMIT);
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
    hewn_model model;
    assert_int_equal(read_exact(hewn_gltf_read, text, used + 2 * depth + 1, &model, NULL), HEWN_OK);
    hewn_model_destroy(&model);
    hewn_free(text);
}

static void write_bytes(const char *path, const void *bytes, size_t length)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

/* Buffers in files of their own, which may not lead out of the folder. */
static void test_files_beside(void **state)
{
    (void)state;
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const struct {
        const char *uri;
        hewn_result result;
    } cases[] = {
        {"a%20b.bin", HEWN_OK}, {"../a.bin", HEWN_BAD_INPUT}, {"none.bin", HEWN_IO}, {"/etc/passwd", HEWN_BAD_INPUT}};
    char folder[64], path[96], beside[96], text[1024];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/x.gltf", folder);
    snprintf(beside, sizeof beside, "%s/a b.bin", folder);
    write_bytes(beside, positions, sizeof positions);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int length =
            snprintf(text, sizeof text,
                     "{\"buffers\":[{\"byteLength\":36,\"uri\":\"%s\"}],\"bufferViews\":[{\"buffer\":0,"
                     "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"
                     "\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," ASSET "}",
                     cases[i].uri);
        write_bytes(path, text, (size_t)length);
        hewn_model model;
        assert_int_equal(hewn_model_read(path, NULL, &model, NULL), cases[i].result);
        if (cases[i].result == HEWN_OK)
            assert_faces(model, 3, 1, one);
    }
    assert_int_equal(unlink(beside), 0);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

static bool stop(void *user, const char *stage, double fraction)
{
    assert_string_equal(stage, "load");
    assert_true(fraction >= 0 && fraction <= 1);
    return --*(int *)user > 0;
}

static void test_reading_can_be_cancelled(void **state)
{
    (void)state;
    hewn_model ring = make_ring_model(200, 200, 1);
    char folder[64], path[96];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/x.glb", folder);
    write_model(&ring, path, NULL);
    int calls = 0;
    for (int allowed = 1; allowed < 1000; allowed++) {
        int left = allowed;
        hewn_progress progress = {stop, &left};
        hewn_model model;
        hewn_result result = hewn_model_read(path, &(hewn_read_desc){.progress = &progress}, &model, NULL);
        hewn_model_destroy(&model);
        if (result == HEWN_OK)
            break;
        assert_int_equal(result, HEWN_CANCELLED);
        calls++;
    }
    assert_true(calls > 3);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
    hewn_model_destroy(&ring);
}

/* --- files of the test data --------------------------------------------------------------------------------------- */

static void test_known_files(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        hewn_result result;
        uint64_t vertices, faces; /* after welding */
        bool manifold;
    } known[] = {
        {"gltf/BoxInterleaved.glb", HEWN_OK, 8, 12, true},
        {"gltf/boolean.glb", HEWN_OK, 2020, 3936, true},
        {"gltf/boxExtMeshManifold.glb", HEWN_OK, 8, 12, true},
        {"gltf/cube.glb", HEWN_OK, 8, 12, true},
        {"gltf/monkey.glb", HEWN_OK, 505, 968, false},
        {"gltf/moon.glb", HEWN_OK, 2502, 5000, true},
        {"gltf/simple_pole.glb", HEWN_OK, 312, 580, true},
        {"malformed/BoxBadNormals.glb", HEWN_OK, 8, 12, true},
        {"malformed/BoxTextured.glb", HEWN_OK, 8, 12, true},
        {"malformed/IndexOutOfRange.gltf", HEWN_IO, 0, 0, false},
        {"malformed/badArray.gltf", HEWN_BAD_INPUT, 0, 0, false},
        {"malformed/invalid-primitive-indices.gltf", HEWN_BAD_INPUT, 0, 0, false},
        {"malformed/glb/bom.glb", HEWN_OK, 0, 0, true},
        {"malformed/glb/chunk_too_big.glb", HEWN_BAD_INPUT, 0, 0, false},
        {"malformed/glb/invalid_magic.glb", HEWN_BAD_INPUT, 0, 0, false},
        {"malformed/glb/length_mismatch.glb", HEWN_BAD_INPUT, 0, 0, false},
        {"malformed/glb/only_header.glb", HEWN_BAD_INPUT, 0, 0, false},
        {"malformed/glb/truncated_chunk_header.glb", HEWN_BAD_INPUT, 0, 0, false},
        {"malformed/glb/two_bin_chunks.glb", HEWN_BAD_INPUT, 0, 0, false},
        {"malformed/glb/valid.glb", HEWN_OK, 0, 0, true},
        {"malformed/glb/valid_buffer.glb", HEWN_OK, 0, 0, true},
    };
    char data[4096], path[4200];
    if (!data_folder(data))
        skip();
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        snprintf(path, sizeof path, "%s/%s", data, known[i].file);
        hewn_model model;
        hewn_error error = {0};
        hewn_result result = hewn_model_read(path, NULL, &model, &error);
        if (result != known[i].result || model.vertex_count != known[i].vertices || model.face_count != known[i].faces)
            fail_msg("%s: %d %s, %llu vertices, %llu faces", known[i].file, result, error.message,
                     (unsigned long long)model.vertex_count, (unsigned long long)model.face_count);
        hewn_mesh *mesh = NULL;
        if (result == HEWN_OK)
            assert_true((hewn_mesh_from_model(&model, NULL, &mesh, NULL, NULL) == HEWN_OK) == known[i].manifold);
        hewn_mesh_destroy(&mesh);
        hewn_model_destroy(&model);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_transforms),
        cmocka_unit_test(test_strips_and_fans),
        cmocka_unit_test(test_sparse),
        cmocka_unit_test(test_zeros_have_a_limit),
        cmocka_unit_test(test_quantization),
        cmocka_unit_test(test_seams_are_welded),
        cmocka_unit_test(test_manifold_extension),
        cmocka_unit_test(test_attributes),
        cmocka_unit_test(test_colours),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_normals_are_turned),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_numbers_are_finite),
        cmocka_unit_test(test_instances_have_a_limit),
        cmocka_unit_test(test_deep_json),
        cmocka_unit_test(test_files_beside),
        cmocka_unit_test(test_reading_can_be_cancelled),
        cmocka_unit_test(test_known_files),
    };
    return cmocka_run_group_tests_name("gltf", tests, NULL, NULL);
}
