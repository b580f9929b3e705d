/* Reading PLY: its forms, the channels that properties make, broken files, and files of the test data. */
#include <sys/resource.h>

#include "base/text.h"
#include "io_support.h"

static const uint32_t quad[] = {0, 1, 2, 3};

static void assert_faces(hewn_model model, uint64_t vertices, uint64_t faces, uint64_t corner_count,
                         const uint32_t *corners)
{
    assert_int_equal(model.vertex_count, vertices);
    assert_int_equal(model.face_count, faces);
    assert_int_equal(hewn_model_corner_count(&model), corner_count);
    if (corner_count > 0)
        assert_memory_equal(model.corners, corners, corner_count * sizeof *corners);
    hewn_model_destroy(&model);
}

static void assert_channel(const hewn_model *model, hewn_domain domain, const char *name, hewn_scalar scalar,
                           uint32_t components)
{
    const hewn_channel *channel = hewn_model_find_channel(model, domain, name);
    if (!channel)
        fail_msg("no channel \"%s\"", name);
    if (channel->info.scalar != scalar || channel->info.components != components)
        fail_msg("channel \"%s\" has %u of scalar %d", name, channel->info.components, channel->info.scalar);
}

static double number_of(const hewn_model *model, hewn_domain domain, const char *name, uint64_t index, uint32_t k)
{
    const hewn_channel *channel = hewn_model_find_channel(model, domain, name);
    if (!channel)
        fail_msg("no channel \"%s\"", name);
    return hewn_channel_number(channel, index, k);
}

/* --- forms -------------------------------------------------------------------------------------------------------- */

#define HEAD(form, vertices, faces)                                                                                    \
    "ply\nformat " form " 1.0\ncomment x\nobj_info y\nelement vertex " vertices                                        \
    "\nproperty float x\nproperty double y\nproperty short z\nproperty list uchar int extra\nelement mystery 2\n"      \
    "property char a\nelement face " faces                                                                             \
    "\nproperty uchar flag\nproperty list ushort int vertex_indices\nproperty float after\nend_header\n"

static void test_text(void **state)
{
    (void)state;
    hewn_model model = read_text(hewn_ply_read, HEAD("ascii", "4", "3") "0 0 0 0\n1 0 0 1 9\n1 0.1 0 2 9 9\n0 1 0 0\n"
                                                                        "7\n-7\n1 2 0 1 7\n255 4 0 1 2 3 0.5\n2 0 8\n");
    assert_true(model.positions[7] == 0.1); /* a double stays one */
    assert_int_equal(model.channel_count, 2);
    assert_channel(&model, HEWN_DOMAIN_FACE, "flag", HEWN_SCALAR_UINT8, 1);
    assert_channel(&model, HEWN_DOMAIN_FACE, "after", HEWN_SCALAR_FLOAT, 1);
    assert_true(number_of(&model, HEWN_DOMAIN_FACE, "flag", 0, 0) ==
                255); /* faces of 2 corners and none are left out */
    assert_true(number_of(&model, HEWN_DOMAIN_FACE, "after", 0, 0) == 0.5);
    assert_faces(model, 4, 1, 4, quad);
    assert_faces(read_text(hewn_ply_read, "ply\r\nformat ascii 1.0\r\nelement vertex 0\r\nelement face 0\r\n"
                                          "end_header\r\n"),
                 0, 0, 0, NULL);
    assert_faces(read_text(hewn_ply_read, "ply\nformat ascii 1.0\nend_header\n"), 0, 0, 0, NULL);
    model = read_text(hewn_ply_read, "ply\nformat ascii 1.0\nelement vertex 1\nproperty float nz\n"
                                     "property float ny\nproperty float nx\nproperty float z\n"
                                     "property float y\nproperty float x\nend_header\n6 5 4 3 2 1");
    assert_true(model.positions[0] == 1 && model.positions[1] == 2 && model.positions[2] == 3);
    for (uint32_t k = 0; k < 3; k++)
        assert_true(number_of(&model, HEWN_DOMAIN_VERT, "normal", 0, k) == 4 + k);
    hewn_model_destroy(&model);
}

static void test_strips(void **state)
{
    (void)state;
    static const uint32_t expected[] = {0, 1, 2, 2, 1, 3, 1, 2, 3}, joined[] = {0, 1, 2, 1, 3, 2};
    assert_faces(read_text(hewn_ply_read,
                           "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                           "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                           "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 1 2 3\n"),
                 4, 3, 9, expected);
    /* strips before faces: the values of faces stay with them */
    hewn_model model = read_text(
        hewn_ply_read, "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                       "element tristrips 1\nproperty list int int vertex_indices\nelement face 1\n"
                       "property list uchar float texcoord\nproperty list uchar int vertex_indices\nproperty int id\n"
                       "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n6 1 2 3 4 5 6 3 1 3 2 7\n");
    assert_true(number_of(&model, HEWN_DOMAIN_FACE, "id", 0, 0) == 0);
    assert_true(number_of(&model, HEWN_DOMAIN_FACE, "id", 1, 0) == 7);
    for (uint32_t corner = 0; corner < 6; corner++)
        for (uint32_t k = 0; k < 2; k++)
            assert_true(number_of(&model, HEWN_DOMAIN_CORNER, "uv", corner, k) ==
                        (corner < 3 ? 0 : 2 * (corner - 3) + k + 1));
    assert_faces(model, 4, 2, 6, joined);
}

static size_t put_bytes(char *to, uint64_t bits, size_t size, bool big)
{
    for (size_t i = 0; i < size; i++)
        to[i] = (char)(bits >> 8 * (big ? size - 1 - i : i) & 0xff);
    return size;
}

/* The same mesh in both orders. */
static void test_binary(void **state)
{
    (void)state;
    for (int big = 0; big <= 1; big++) {
        char file[1024];
        const char *head = big ? HEAD("binary_big_endian", "4", "1") : HEAD("binary_little_endian", "4", "1");
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
        length += put_bytes(file + length, 0x3f000000, 4, big);
        hewn_model model = read_bytes(hewn_ply_read, file, length);
        assert_true(model.positions[6] == 1 && model.positions[7] == 1 && model.positions[8] == -2);
        assert_true(number_of(&model, HEWN_DOMAIN_FACE, "after", 0, 0) == 0.5);
        assert_faces(model, 4, 1, 4, quad);
        for (size_t cut = strlen(head); cut < length; cut++) { /* every shorter file is refused */
            hewn_error error;
            assert_int_equal(read_exact(hewn_ply_read, file, cut, &model, &error), HEWN_BAD_INPUT);
        }
    }
}

/* --- any properties, in any form ---------------------------------------------------------------------------------- */

enum { PLY_TYPES = 8, MOST_PROPERTIES = 24 };

static const char *const type_names[PLY_TYPES][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                                     {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                                     {"float", "float32"}, {"double", "float64"}};
static const size_t type_sizes[PLY_TYPES] = {1, 1, 2, 2, 4, 4, 4, 8};

/* A random value of a type, as a double and as bits. */
static double random_value(random_state *random, int type, uint64_t *bits)
{
    static const uint64_t masks[] = {0xff, 0xffff, 0xffffffff};
    float single;
    double real;
    if (type == 6) {
        single = random_float(random);
        uint32_t half;
        memcpy(&half, &single, sizeof half);
        *bits = half;
        return (double)single;
    }
    if (type == 7) {
        real = (double)random_float(random) * (1 + random_unit(random));
        memcpy(bits, &real, sizeof real);
        return real;
    }
    *bits = random_bits(random) & masks[type / 2];
    if (type % 2)
        return (double)*bits;
    return type == 0 ? (double)(int8_t)*bits : type == 2 ? (double)(int16_t)*bits : (double)(int32_t)*bits;
}

/* One file in three forms. */
typedef struct triple {
    hewn_text forms[3];
} triple;

static void put_text(triple *files, const char *text)
{
    for (int form = 0; form < 3; form++)
        hewn_text_append(&files->forms[form], text);
}

static void put_value(triple *files, int type, double value, uint64_t bits)
{
    char word[64], bytes[8];
    snprintf(word, sizeof word, type == 7 ? "%.17g " : type == 6 ? "%.9g " : "%.0f ", value);
    hewn_text_append(&files->forms[0], word);
    for (int big = 0; big <= 1; big++)
        hewn_text_append_bytes(&files->forms[1 + big], bytes, put_bytes(bytes, bits, type_sizes[type], big));
}

static double put_random(triple *files, random_state *random, int type)
{
    uint64_t bits;
    double value = random_value(random, type, &bits);
    put_value(files, type, value, bits);
    return value;
}

static void put_property(triple *files, random_state *random, int type, int count_type, const char *name)
{
    char line[160];
    const char *type_name = type_names[type][random_below(random, 2)];
    if (count_type < 0)
        snprintf(line, sizeof line, "property %s %s\n", type_name, name);
    else
        snprintf(line, sizeof line, "property list %s %s %s\n", type_names[count_type][random_below(random, 2)],
                 type_name, name);
    put_text(files, line);
}

typedef struct random_property {
    int type, count_type; /* below 0: a single value */
    char name[16];
} random_property;

static void random_properties(random_state *random, random_property *properties, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        properties[i].type = (int)random_below(random, PLY_TYPES);
        properties[i].count_type = random_below(random, 6) ? -1 : (int)random_below(random, 6);
        snprintf(properties[i].name, sizeof properties[i].name, "p%u", i);
    }
}

static void put_head(triple *files, random_state *random, random_property *vertex, uint32_t vertex_properties,
                     random_property *face, uint32_t face_properties, uint32_t vertices, uint32_t faces)
{
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    char line[80];
    for (int form = 0; form < 3; form++)
        hewn_text_print(&files->forms[form], "ply\nformat %s 1.0\n", formats[form]);
    snprintf(line, sizeof line, "element vertex %u\n", vertices);
    put_text(files, line);
    for (uint32_t i = 0; i < vertex_properties; i++)
        put_property(files, random, vertex[i].type, vertex[i].count_type, vertex[i].name);
    put_text(files, "element between 3\nproperty short here\nproperty list char double there\n");
    snprintf(line, sizeof line, "element face %u\n", faces);
    put_text(files, line);
    for (uint32_t i = 0; i < face_properties; i++)
        put_property(files, random, face[i].type, face[i].count_type, face[i].name);
    put_text(files, "end_header\n");
}

/* What must come out: one double a value, by property and item. */
typedef struct expectation {
    double *values[2][MOST_PROPERTIES];
    uint64_t *first;
    double *corners, *uv;
} expectation;

static void put_list(triple *files, random_state *random, int count_type, int type, uint32_t length, double *out)
{
    put_value(files, count_type, length, length);
    for (uint32_t i = 0; i < length; i++) {
        double value = put_random(files, random, type);
        if (out)
            out[i] = value;
    }
}

static void put_face(triple *files, random_state *random, const random_property *face, uint32_t face_properties,
                     uint32_t vertices, uint32_t f, expectation *expected)
{
    uint32_t corners = 3 + random_below(random, 4);
    uint64_t begin = expected->first[f];
    for (uint32_t i = 0; i < face_properties; i++) {
        if (strcmp(face[i].name, "vertex_indices") == 0) {
            put_value(files, face[i].count_type, corners, corners);
            for (uint32_t k = 0; k < corners; k++) {
                uint32_t vertex = random_below(random, vertices);
                put_value(files, face[i].type, vertex, vertex);
                expected->corners[begin + k] = vertex;
            }
        } else if (strcmp(face[i].name, "texcoord") == 0) {
            put_list(files, random, face[i].count_type, face[i].type, 2 * corners, expected->uv + 2 * begin);
        } else if (face[i].count_type >= 0) {
            put_list(files, random, face[i].count_type, face[i].type, random_below(random, 4), NULL);
        } else {
            expected->values[1][i][f] = put_random(files, random, face[i].type);
        }
    }
    expected->first[f + 1] = begin + corners;
}

static void check_property(const hewn_model *model, hewn_domain domain, const random_property *property,
                           const double *values)
{
    static const hewn_scalar scalars[] = {HEWN_SCALAR_INT32, HEWN_SCALAR_UINT8, HEWN_SCALAR_INT32, HEWN_SCALAR_INT32,
                                          HEWN_SCALAR_INT32, HEWN_SCALAR_INT32, HEWN_SCALAR_FLOAT, HEWN_SCALAR_DOUBLE};
    uint64_t count = hewn_model_domain_count(model, domain);
    bool wide = false;
    for (uint64_t i = 0; i < count; i++)
        wide = wide || (property->type == 5 && values[i] > INT32_MAX);
    assert_channel(model, domain, property->name, wide ? HEWN_SCALAR_DOUBLE : scalars[property->type], 1);
    for (uint64_t i = 0; i < count; i++) {
        double value = number_of(model, domain, property->name, i, 0);
        assert_memory_equal(&value, &values[i], sizeof value);
    }
}

static void check_model(const hewn_model *model, const random_property *vertex, uint32_t vertex_properties,
                        const random_property *face, uint32_t face_properties, const expectation *expected)
{
    uint32_t channels = 0;
    for (uint64_t f = 0; f <= model->face_count; f++)
        assert_int_equal(first_of(model, f), expected->first[f]);
    for (uint64_t c = 0; c < hewn_model_corner_count(model); c++)
        assert_true(model->corners[c] == expected->corners[c]);
    for (uint32_t i = 0; i < vertex_properties; i++) {
        const char *axis = strchr("xyz", vertex[i].name[0]);
        for (uint64_t v = 0; axis && v < model->vertex_count; v++)
            assert_memory_equal(&model->positions[3 * v + (size_t)(vertex[i].name[0] - 'x')],
                                &expected->values[0][i][v], sizeof(double));
        if (!axis && vertex[i].count_type < 0) {
            check_property(model, HEWN_DOMAIN_VERT, &vertex[i], expected->values[0][i]);
            channels++;
        }
    }
    for (uint32_t i = 0; i < face_properties; i++) {
        bool uv = strcmp(face[i].name, "texcoord") == 0;
        for (uint64_t k = 0; uv && k < 2 * hewn_model_corner_count(model); k++)
            assert_true(number_of(model, HEWN_DOMAIN_CORNER, "uv", k / 2, k % 2) == expected->uv[k]);
        if (face[i].count_type < 0)
            check_property(model, HEWN_DOMAIN_FACE, &face[i], expected->values[1][i]);
        channels += uv || face[i].count_type < 0;
    }
    assert_int_equal(model->channel_count, channels);
}

static void swap_properties(random_state *random, random_property *properties, uint32_t count)
{
    for (uint32_t i = 1; i < count; i++) {
        uint32_t other = random_below(random, i + 1);
        random_property held = properties[i];
        properties[i] = properties[other];
        properties[other] = held;
    }
}

static void check_random_file(random_state *random)
{
    random_property vertex[MOST_PROPERTIES], face[MOST_PROPERTIES];
    uint32_t vertices = 1 + random_below(random, random_below(random, 8) ? 40 : 1500), faces = random_below(random, 40);
    uint32_t vertex_properties = 3 + random_below(random, 8), face_properties = 2 + random_below(random, 6);
    random_properties(random, vertex, vertex_properties);
    random_properties(random, face, face_properties);
    for (uint32_t i = 0; i < 3; i++) {
        vertex[i].count_type = -1;
        snprintf(vertex[i].name, sizeof vertex[i].name, "%c", 'x' + i);
    }
    if (random_below(random, 2)) /* all of one size */
        for (uint32_t i = 3; i < vertex_properties; i++)
            vertex[i].count_type = -1;
    face[0] = (random_property){2 + (int)random_below(random, 4), (int)random_below(random, 6), "vertex_indices"};
    if (random_below(random, 2))
        face[1] = (random_property){6 + (int)random_below(random, 2), (int)random_below(random, 6), "texcoord"};
    swap_properties(random, vertex, vertex_properties);
    swap_properties(random, face, face_properties);
    triple files = {0};
    expectation expected = {.first = hewn_alloc_zero(faces + 1, sizeof(uint64_t)),
                            .corners = hewn_alloc(6 * (size_t)faces, sizeof(double)),
                            .uv = hewn_alloc(12 * (size_t)faces, sizeof(double))};
    for (int i = 0; i < MOST_PROPERTIES; i++) {
        expected.values[0][i] = hewn_alloc(vertices, sizeof(double));
        expected.values[1][i] = hewn_alloc(faces, sizeof(double));
    }
    put_head(&files, random, vertex, vertex_properties, face, face_properties, vertices, faces);
    for (uint32_t v = 0; v < vertices; v++) {
        for (uint32_t i = 0; i < vertex_properties; i++)
            if (vertex[i].count_type < 0)
                expected.values[0][i][v] = put_random(&files, random, vertex[i].type);
            else
                put_list(&files, random, vertex[i].count_type, vertex[i].type, random_below(random, 4), NULL);
        hewn_text_append(&files.forms[0], "\n");
    }
    for (int i = 0; i < 3; i++) {
        put_random(&files, random, 2);
        put_list(&files, random, 0, 7, random_below(random, 3), NULL);
    }
    for (uint32_t f = 0; f < faces; f++)
        put_face(&files, random, face, face_properties, vertices, f, &expected);
    for (int form = 0; form < 3; form++) {
        hewn_model model = read_bytes(hewn_ply_read, files.forms[form].bytes, files.forms[form].length);
        assert_int_equal(model.vertex_count, vertices);
        assert_int_equal(model.face_count, faces);
        check_model(&model, vertex, vertex_properties, face, face_properties, &expected);
        hewn_model_destroy(&model);
        hewn_text_clear(&files.forms[form]);
    }
    for (int i = 0; i < MOST_PROPERTIES; i++) {
        hewn_free(expected.values[0][i]);
        hewn_free(expected.values[1][i]);
    }
    hewn_free(expected.first);
    hewn_free(expected.corners);
    hewn_free(expected.uv);
}

static void test_any_properties_in_any_form(void **state)
{
    (void)state;
    random_state random = {31};
    int rounds = getenv("HEWN_LONG") ? 5000 : 150;
    for (int round = 0; round < rounds; round++)
        check_random_file(&random);
}

/* --- names -------------------------------------------------------------------------------------------------------- */

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define POINT(properties, values)                                                                                      \
    "ply\nformat ascii 1.0\nelement vertex 1\n" XYZ properties "end_header\n0 0 0 " values "\n"

static void test_groups(void **state)
{
    (void)state;
    static const struct {
        const char *text, *name;
        hewn_scalar scalar;
        uint32_t components, channels;
    } cases[] = {
        {POINT("property double ny\nproperty double nz\nproperty double nx\n", "2 3 1"), "normal", HEWN_SCALAR_DOUBLE,
         3, 1},
        {POINT("property uchar blue\nproperty uchar red\nproperty uchar green\n", "3 1 2"), "color", HEWN_SCALAR_UINT8,
         3, 1},
        {POINT("property uchar r\nproperty uchar g\nproperty uchar b\nproperty uchar a\n", "1 2 3 4"), "color",
         HEWN_SCALAR_UINT8, 4, 1},
        {POINT("property float diffuse_red\nproperty float diffuse_green\nproperty float diffuse_blue\n", "1 2 3"),
         "color", HEWN_SCALAR_FLOAT, 3, 1},
        {POINT("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float alpha\n", "1 2 3 4"),
         "color", HEWN_SCALAR_UINT8, 3, 2},
        {POINT("property float t\nproperty float s\n", "2 1"), "uv", HEWN_SCALAR_FLOAT, 2, 1},
        {POINT("property float u\nproperty float v\n", "1 2"), "uv", HEWN_SCALAR_FLOAT, 2, 1},
        {POINT("property float texture_u\nproperty float texture_v\nproperty float s\n", "1 2 9"), "uv",
         HEWN_SCALAR_FLOAT, 2, 2},
        {POINT("property int scale_0\nproperty int scale_1\nproperty int scale_2\n", "1 2 3"), "scale",
         HEWN_SCALAR_INT32, 3, 1},
        {POINT("property int scale_0\nproperty int scale_1\nproperty uint scale_2\n", "1 2 3"), "scale",
         HEWN_SCALAR_INT32, 2, 2},
        {POINT("property int scale_0\n", "1"), "scale_0", HEWN_SCALAR_INT32, 1, 1},
        {POINT("property short red\nproperty short green\nproperty short blue\n", "1 2 3"), "red", HEWN_SCALAR_INT32, 1,
         3},
        {POINT("property float s\n", "1"), "s", HEWN_SCALAR_FLOAT, 1, 1},
        {POINT("property uint n\n", "1"), "n", HEWN_SCALAR_INT32, 1, 1},
        {POINT("property uint n\nproperty uint n\n", "1 7"), "n", HEWN_SCALAR_INT32, 1, 1},
        {POINT("property double quality\n", "1"), "quality", HEWN_SCALAR_DOUBLE, 1, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hewn_model model = read_text(hewn_ply_read, cases[i].text);
        assert_channel(&model, HEWN_DOMAIN_VERT, cases[i].name, cases[i].scalar, cases[i].components);
        for (uint32_t k = 0; k < cases[i].components; k++)
            assert_true(number_of(&model, HEWN_DOMAIN_VERT, cases[i].name, 0, k) == k + 1);
        assert_int_equal(model.channel_count, cases[i].channels);
        hewn_model_destroy(&model);
    }
}

#define CORNERS(properties, faces)                                                                                     \
    "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ                                                                    \
    "element face 3\nproperty list uchar int vertex_indices\n" properties                                              \
    "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" faces

static void test_corner_lists(void **state)
{
    (void)state;
    hewn_model model =
        read_text(hewn_ply_read, CORNERS("property list uchar float texcoord\nproperty list int uchar corner_mark\n"
                                         "property list uchar float bounds\nproperty uchar red\nproperty uchar green\n"
                                         "property uchar blue\n",
                                         "3 0 1 2 0 0 1 5 1 2 3\n2 0 1 3 7 7 7 1 1 0 1 1 1\n"
                                         "4 0 1 2 3 8 1 2 3 4 5 6 7 8 8 1 2 3 4 5 6 7 8 0 4 5 6\n"));
    assert_int_equal(model.face_count, 2);
    assert_channel(&model, HEWN_DOMAIN_CORNER, "uv", HEWN_SCALAR_FLOAT, 2);
    assert_channel(&model, HEWN_DOMAIN_CORNER, "mark", HEWN_SCALAR_UINT8, 2);
    assert_channel(&model, HEWN_DOMAIN_FACE, "color", HEWN_SCALAR_UINT8, 3);
    assert_int_equal(model.channel_count, 3);
    for (uint32_t c = 0; c < 7; c++)
        for (uint32_t k = 0; k < 2; k++) {
            double expected = c < 3 ? 0 : 2 * (c - 3) + k + 1;
            assert_true(number_of(&model, HEWN_DOMAIN_CORNER, "uv", c, k) == expected);
            assert_true(number_of(&model, HEWN_DOMAIN_CORNER, "mark", c, k) == expected);
        }
    assert_true(number_of(&model, HEWN_DOMAIN_FACE, "color", 1, 2) == 6);
    hewn_model_destroy(&model);
    assert_bad_text(hewn_ply_read,
                    CORNERS("property list uchar float texcoord\n", "3 0 1 2 5 1 2 3 4 5\n3 0 1 2 0\n3 0 1 2 0\n"), 15,
                    "\"uv\"");
    assert_bad_text(
        hewn_ply_read,
        CORNERS("property list uchar float corner_x\n", "3 0 1 2 0\n3 0 1 2 3 1 2 3\n3 0 1 2 6 1 2 3 4 5 6\n"), 17,
        "\"x\"");
}

/* --- broken files ------------------------------------------------------------------------------------------------- */

#define PLAIN(vertices, faces, list)                                                                                   \
    "ply\nformat ascii 1.0\nelement vertex " vertices                                                                  \
    "\nproperty float x\nproperty float y\nproperty float z\nelement face " faces "\nproperty list " list              \
    " vertex_indices\nend_header\n"

static void test_errors(void **state)
{
    (void)state;
    static const char triangle[] = "0 0 0\n1 0 0\n0 1 0\n";
    char text[512];
    static const struct {
        const char *head, *tail;
        uint32_t line;
        const char *part;
    } cases[] = {
        {PLAIN("3", "1", "uchar int"), "3 0 1 3\n", 0, "vertex 3"},
        {PLAIN("3", "1", "uchar int"), "3 0 1 -1\n", 13, "-1"},
        {PLAIN("3", "1", "uchar int"), "3 0 1\n", 14, "the file ends"},
        {PLAIN("3", "1", "uchar int"), "-3 0 1 2\n", 13, "-3"},
        {PLAIN("3", "1", "uchar int"), "300 0 1 2\n", 13, "300"},
        {PLAIN("3", "1", "uint int"), "4000000000 0 1 2\n", 13, "4000000000"},
        {PLAIN("3", "1", "uchar float"), "3 0 1 0.5\n", 13, "0.5"},
        {PLAIN("3", "1", "uchar int"), "3 0 1 x\n", 13, "\"x\""},
        {PLAIN("3", "1", "float int"), "3 0 1 2\n", 8, "whole number"},
        {PLAIN("3", "1", "uchar wide"), "3 0 1 2\n", 8, "\"wide\""},
        {PLAIN("353535235358", "1", "uchar int"), "", 0, "353535235358"},
        {PLAIN("3", "353535235358", "uchar int"), "3 0 1 2\n", 0, "353535235358"},
        {PLAIN("9223372036854775807", "1", "uchar int"), "", 0, "9223372036854775807"},
        {PLAIN("-1", "1", "uchar int"), "", 3, "\"-1\""},
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

static void test_headers_have_a_limit(void **state)
{
    (void)state;
    hewn_text text = {0};
    hewn_text_append(&text, "ply\nformat ascii 1.0\nelement vertex 0\n");
    for (int i = 0; i < 1001; i++)
        hewn_text_print(&text, "property float p%d\n", i);
    assert_bad_text(hewn_ply_read, text.bytes, 1004, "1000 properties");
    hewn_text_clear(&text);
    hewn_text_append(&text, "ply\nformat ascii 1.0\n");
    for (int i = 0; i < 1001; i++)
        hewn_text_print(&text, "element e%d 0\n", i);
    assert_bad_text(hewn_ply_read, text.bytes, 1003, "1000 elements");
    hewn_text_clear(&text);
}

/* --- files of the test data --------------------------------------------------------------------------------------- */

static void test_data_channels(void **state)
{
    (void)state;
    char data[4096], path[4200];
    if (!data_folder(data))
        skip();
    static const struct {
        const char *file, *name;
        hewn_domain domain;
        hewn_scalar scalar;
        uint32_t components;
        uint64_t index;
        double first, second;
    } known[] = {
        {"malformed/multi.ply", "uv", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 2, 3, 0, 1},
        {"malformed/multi.ply", "color", HEWN_DOMAIN_VERT, HEWN_SCALAR_UINT8, 3, 1, 0, 255},
        {"malformed/metadata.ply", "face_type", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1, 1, 90, 0},
        {"malformed/Wuson.ply", "uv", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 2, 0, 0.681180, 0.275678},
        {"malformed/Wuson.ply", "normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3, 0, 0.241919, -0.961129},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        snprintf(path, sizeof path, "%s/%s", data, known[i].file);
        hewn_model model = read_model(path);
        assert_channel(&model, known[i].domain, known[i].name, known[i].scalar, known[i].components);
        const double expected[] = {known[i].first, known[i].second};
        for (uint32_t k = 0; k < 2 && k < known[i].components; k++)
            assert_true(fabs(number_of(&model, known[i].domain, known[i].name, known[i].index, k) - expected[k]) <
                        1e-7);
        hewn_model_destroy(&model);
    }
    snprintf(path, sizeof path, "%s/malformed/points_emptyface.ply", data);
    hewn_model model = read_model(path);
    assert_faces(model, 1024, 0, 0, NULL);
    hewn_error error = {0};
    snprintf(path, sizeof path, "%s/malformed/issue623.ply", data); /* its header lacks the faces */
    assert_int_equal(hewn_model_read(path, NULL, &model, &error), HEWN_BAD_INPUT);
    assert_int_equal(error.line, 14);
}

/* Promises cost nothing: no array is made for more than the file can hold. */
static void test_promises_cost_no_memory(void **state)
{
    (void)state;
    struct rusage before, after;
    getrusage(RUSAGE_SELF, &before);
    static const char *const forms[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    for (int form = 0; form < 3; form++)
        for (int element = 0; element < 4; element++) {
            char text[512];
            snprintf(text, sizeof text,
                     "ply\nformat %s 1.0\nelement vertex %s\n" XYZ "element face %s\nproperty list %s vertex_indices\n"
                     "element other %s\nproperty char a\nend_header\n%s",
                     forms[form], element == 0 ? "353535235358" : "0", element == 1 ? "353535235358" : "1",
                     element == 2 ? "uint int" : "uchar int", element == 3 ? "353535235358" : "0",
                     element == 2 ? "4000000000 " : "");
            assert_bad_text(hewn_ply_read, text, 0, "");
        }
    getrusage(RUSAGE_SELF, &after);
    assert_true(after.ru_maxrss - before.ru_maxrss < 16 * 1024);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_strips),
        cmocka_unit_test(test_binary),
        cmocka_unit_test(test_any_properties_in_any_form),
        cmocka_unit_test(test_groups),
        cmocka_unit_test(test_corner_lists),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_headers_have_a_limit),
        cmocka_unit_test(test_promises_cost_no_memory),
        cmocka_unit_test(test_data_channels),
    };
    return cmocka_run_group_tests_name("ply", tests, NULL, NULL);
}
