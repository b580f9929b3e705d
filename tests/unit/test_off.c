/* OFF: the forms that files come in, text and binary, broken ones, what is written, and round trips. */
#include <sys/resource.h>

#include "io_support.h"

#define SQUARE "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
#define TWO "3 0 1 2\n4 0 1 2 3\n"

static const hewn_channel *channel_of(const hewn_model *model, hewn_domain domain, const char *name)
{
    const hewn_channel *channel = hewn_model_find_channel(model, domain, name);
    if (!channel)
        fail_msg("no channel \"%s\"", name);
    return channel;
}

static void assert_values(const hewn_model *model, hewn_domain domain, const char *name, hewn_scalar scalar,
                          uint32_t components, const double *expected)
{
    const hewn_channel *channel = channel_of(model, domain, name);
    assert_int_equal(channel->info.scalar, scalar);
    assert_int_equal(channel->info.components, components);
    uint64_t count = hewn_model_domain_count(model, domain);
    for (uint64_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < components; k++)
            if (hewn_channel_number(channel, i, k) != (double)(float)expected[i * components + k])
                fail_msg("%s %llu: %g, not %g", name, (unsigned long long)i, hewn_channel_number(channel, i, k),
                         expected[i * components + k]);
}

/* --- reading ------------------------------------------------------------------------------------------------------ */

/* All of these are the same four vertices, triangle and square. */
static void test_forms(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t channels;
    } forms[] = {
        {"OFF\n4 2 5\n" SQUARE TWO, 0},
        {"OFF\n4 2\n" SQUARE TWO, 0},
        {"OFF\n4 2 # no edges\n" SQUARE TWO, 0},
        {"OFF 4 2 0\n" SQUARE TWO, 0},
        {"OFF4 2 0\n" SQUARE TWO, 0},
        {"\xef\xbb\xbf off# glued\n4\n2\n0\n" SQUARE TWO, 0},
        {"# first\n \n\tOFF # a\n#b\n4 #c\n2 5\n" SQUARE "#d\n" TWO, 0},
        {"OFF 4 2 0 0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2\n4 0 1\n2 3", 0},
        {"OFF\n4 2 0\n\n0 0 0 1\n0 0 1 1\n0 0 1 0\n" TWO "more\n", 0},
        {"OFF\n4 4 0\n" SQUARE "2 0 1 9 9 9\n3 0 1 2\n1 3\n4 0 1 2 3\n", 0},
        {"OFF\n4 2 0\n" SQUARE "3 0 1 2 7\n4 0 1 2 3 9 9\n", 0},
        {"NOFF\n4 2 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n" TWO, 1},
        {"COFF\n4 2 0\n0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n" TWO, 0},
    };
    static const double positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    static const uint32_t corners[] = {0, 1, 2, 0, 1, 2, 3};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        hewn_model model = read_text(hewn_off_read, forms[i].text);
        assert_int_equal(model.vertex_count, 4);
        assert_int_equal(model.face_count, 2);
        assert_int_equal(first_of(&model, 1), 3);
        assert_int_equal(first_of(&model, 2), 7);
        assert_memory_equal(model.positions, positions, sizeof positions);
        assert_memory_equal(model.corners, corners, sizeof corners);
        if (model.channel_count != forms[i].channels)
            fail_msg("%u channels in \"%s\"", model.channel_count, forms[i].text);
        hewn_model_destroy(&model);
    }
}

static void test_points(void **state)
{
    (void)state;
    hewn_model model = read_text(hewn_off_read, "OFF\n2 0 0\n0.1 1e-320 -0\n1 2 3\n");
    static const double positions[] = {0.1, 1e-320, -0.0, 1, 2, 3};
    assert_memory_equal(model.positions, positions, sizeof positions);
    assert_int_equal(model.face_count, 0);
    hewn_model_destroy(&model);
    model = read_text(hewn_off_read, "OFF\n0 0 0");
    assert_int_equal(model.vertex_count, 0);
    hewn_model_destroy(&model);
}

static void test_vertex_channels(void **state)
{
    (void)state;
    static const double normals[] = {0, 0, 1, 0, 0.6, 0.8, 0, 0, 0}, uvs[] = {0.25, 1, 0, 0, 2, 3};
    static const char *const headers[] = {"STCNOFF", "NCSTOFF", "CNSTOFF"};
    for (int i = 0; i < 3; i++) {
        char text[256];
        snprintf(text, sizeof text, "%s\n3 0 0\n1 2 3  0 0 1  255 0 9 8  0.25 1\n4 5 6  0 .6 .8  1 2 3 4  0 0\n%s",
                 headers[i], "7 8 9  nan 0 inf  0 0 0 0  2 3\n");
        hewn_model model = read_text(hewn_off_read, text);
        assert_int_equal(model.channel_count, 3);
        assert_true(model.positions[3] == 4 && model.positions[8] == 9);
        assert_values(&model, HEWN_DOMAIN_VERT, "normal", HEWN_SCALAR_FLOAT, 3, normals);
        assert_values(&model, HEWN_DOMAIN_VERT, "uv", HEWN_SCALAR_FLOAT, 2, uvs);
        assert_values(&model, HEWN_DOMAIN_VERT, "color", HEWN_SCALAR_UINT8, 4,
                      (const double[]){255, 0, 9, 8, 1, 2, 3, 4, 0, 0, 0, 0});
        hewn_model_destroy(&model);
    }
}

/* Bytes or fractions: the whole file tells. */
static void test_color_kinds(void **state)
{
    (void)state;
    static const struct {
        const char *a, *b;
        hewn_scalar scalar;
        uint32_t components;
        double values[8];
    } cases[] = {
        {"0 10 255", "1 1 1", HEWN_SCALAR_UINT8, 3, {0, 10, 255, 1, 1, 1}},
        {"0 0 0", "0 0 0", HEWN_SCALAR_UINT8, 3, {0}},
        {"0 1 0", "1 1 1", HEWN_SCALAR_FLOAT, 3, {0, 1, 0, 1, 1, 1}},
        {"0 1 0.5", "1 1 1", HEWN_SCALAR_FLOAT, 3, {0, 1, 0.5, 1, 1, 1}},
        {"0 1 1e0", "9 1 1", HEWN_SCALAR_FLOAT, 3, {0, 1, 1, 9, 1, 1}},
        {"0 256 0", "1 1 1", HEWN_SCALAR_FLOAT, 3, {0, 256, 0, 1, 1, 1}},
        {"0 -6 0", "1 1 1", HEWN_SCALAR_FLOAT, 3, {0, -6, 0, 1, 1, 1}},
        {"1 2 3 4", "5 6 7 8", HEWN_SCALAR_UINT8, 4, {1, 2, 3, 4, 5, 6, 7, 8}},
        {"0.1 2 3 4", "nan 6 7 8", HEWN_SCALAR_FLOAT, 4, {0.1, 2, 3, 4, 0, 6, 7, 8}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text, "COFF\n2 0 0\n0 0 0 %s\n1 1 1 %s # end\n", cases[i].a, cases[i].b);
        hewn_model model = read_text(hewn_off_read, text);
        assert_values(&model, HEWN_DOMAIN_VERT, "color", cases[i].scalar, cases[i].components, cases[i].values);
        hewn_model_destroy(&model);
        snprintf(text, sizeof text, "OFF\n4 2 0\n" SQUARE "3 0 1 2 %s\n4 0 1 2 3 %s # end\n", cases[i].a, cases[i].b);
        model = read_text(hewn_off_read, text);
        assert_values(&model, HEWN_DOMAIN_FACE, "color", cases[i].scalar, cases[i].components, cases[i].values);
        hewn_model_destroy(&model);
    }
}

/* Some faces have three numbers, some four, some none or an index. */
static void test_mixed_face_colors(void **state)
{
    (void)state;
    hewn_model model = read_text(hewn_off_read, "OFF\n4 5 0\n" SQUARE "3 0 1 2\n3 0 1 2 9 8 7\n2 0 1 1 1 1\n"
                                                "3 0 1 2 6 5 4 3\n3 0 1 2 77\n");
    assert_int_equal(model.face_count, 4);
    assert_values(&model, HEWN_DOMAIN_FACE, "color", HEWN_SCALAR_UINT8, 4,
                  (const double[]){0, 0, 0, 0, 9, 8, 7, 255, 6, 5, 4, 3, 0, 0, 0, 0});
    hewn_model_destroy(&model);
}

static size_t put_word(char *to, uint32_t word)
{
    for (int i = 0; i < 4; i++)
        to[i] = (char)(word >> (24 - 8 * i) & 0xff);
    return 4;
}

static size_t put_float(char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put_word(to, bits);
}

static void test_binary(void **state)
{
    (void)state;
    char file[1024];
    static const char head[] = "STCNOFF BINARY\r\n";
    size_t length = sizeof head - 1;
    memcpy(file, head, length);
    length += put_word(file + length, 4);
    length += put_word(file + length, 3);
    length += put_word(file + length, 0xffffffff);
    for (int v = 0; v < 4; v++)
        for (int k = 0; k < 12; k++)
            length += put_float(file + length, (float)v + (float)k / 4);
    static const uint32_t faces[] = {3, 0, 1, 2, 0, 2, 1, 0, 1, 77, 4, 0, 1, 2, 3, 3};
    for (size_t i = 0; i < sizeof faces / sizeof *faces; i++)
        length += put_word(file + length, faces[i]);
    for (int k = 0; k < 3; k++)
        length += put_float(file + length, (float)k);
    hewn_model model = read_bytes(hewn_off_read, file, length);
    assert_int_equal(model.face_count, 2);
    assert_int_equal(first_of(&model, 2), 7);
    assert_true(model.positions[3] == 1 && model.positions[5] == 1.5);
    assert_values(&model, HEWN_DOMAIN_FACE, "color", HEWN_SCALAR_FLOAT, 3, (const double[]){0, 0, 0, 0, 1, 2});
    double normals[12], colors[16], uvs[8];
    for (int v = 0; v < 4; v++) {
        for (int k = 0; k < 3; k++)
            normals[3 * v + k] = v + (k + 3) / 4.0;
        for (int k = 0; k < 4; k++)
            colors[4 * v + k] = v + (k + 6) / 4.0;
        for (int k = 0; k < 2; k++)
            uvs[2 * v + k] = v + (k + 10) / 4.0;
    }
    assert_values(&model, HEWN_DOMAIN_VERT, "normal", HEWN_SCALAR_FLOAT, 3, normals);
    assert_values(&model, HEWN_DOMAIN_VERT, "color", HEWN_SCALAR_FLOAT, 4, colors);
    assert_values(&model, HEWN_DOMAIN_VERT, "uv", HEWN_SCALAR_FLOAT, 2, uvs);
    hewn_model_destroy(&model);
    for (size_t cut = 0; cut < length; cut++) { /* every shorter file is refused */
        hewn_error error;
        assert_int_equal(read_exact(hewn_off_read, file, cut, &model, &error), HEWN_BAD_INPUT);
    }
    put_float(file + sizeof head - 1 + 12, NAN);
    assert_bad(hewn_off_read, file, length, 0, "not finite");
    put_word(file + sizeof head - 1, 0xffffffff);
    assert_bad(hewn_off_read, file, length, 0, "4294967295");
}

static void test_errors(void **state)
{
    (void)state;
    assert_bad_text(hewn_off_read, "", 1, "\"OFF\"");
    assert_bad_text(hewn_off_read, "OF\n", 1, "\"OF\"");
    assert_bad_text(hewn_off_read, "4 2 0\n", 1, "\"4\"");
    assert_bad_text(hewn_off_read, "COFFX 4 2 0\n", 1, "\"COFFX\"");
    assert_bad_text(hewn_off_read, "CCOFF 4 2 0\n", 1, "\"CCOFF\"");
    assert_bad_text(hewn_off_read, "4OFF\n4 2 0\n", 1, "four");
    assert_bad_text(hewn_off_read, "CnOFF 5\n4 2 0\n", 1, "any number of");
    assert_bad_text(hewn_off_read, "OFF\n-4 2 0\n", 2, "\"-4\"");
    assert_bad_text(hewn_off_read, "OFF\n4\n", 3, "the file ends");
    assert_bad_text(hewn_off_read, "OFF\n4 x 0\n", 2, "\"x\"");
    assert_bad_text(hewn_off_read, "OFF\n4 2 0\n" SQUARE "3 0 1 4\n" TWO, 7, "vertex 4");
    assert_bad_text(hewn_off_read, "OFF\n4 2 0\n" SQUARE "3 0 1 -1\n" TWO, 7, "vertex -1");
    assert_bad_text(hewn_off_read, "OFF\n4 2 0\n" SQUARE "2 0 4\n" TWO, 7, "vertex 4");
    assert_bad_text(hewn_off_read, "OFF\n4 2 0\n" SQUARE "3 0 1 0.5\n" TWO, 7, "\"0.5\"");
    assert_bad_text(hewn_off_read, "OFF\n4 2 0\n" SQUARE "0\n" TWO, 7, "0 corners");
    assert_bad_text(hewn_off_read, "OFF\n4 2 0\n" SQUARE "-3 0 1 2\n" TWO, 7, "-3 corners");
    assert_bad_text(hewn_off_read, "OFF\n4 2 0\n" SQUARE "3 0 1 2\n4 0 1 2", 8, "the file ends");
    assert_bad_text(hewn_off_read, "OFF\n4 2 0\n" SQUARE "3 0 1 2\n4294967295 0 1 2", 8, "the file ends");
    assert_bad_text(hewn_off_read, "OFF\n1 1 0\n0 0 x\n1 0 0\n", 3, "\"x\"");
    assert_bad_text(hewn_off_read, "OFF\n1 1 0\n0 nan 0\n1 0 0\n", 3, "not finite");
    assert_bad_text(hewn_off_read, "OFF\r1 1 0\r\r0 1e309 0\r1 0 0\r", 4, "not finite");
    assert_bad_text(hewn_off_read, "OFF\n353535235358 6 0\n0 0 0\n", 0, "353535235358");
    assert_bad_text(hewn_off_read, "OFF\n1 9223372036854775807 0\n0 0 0\n", 0, "9223372036854775807");
    assert_bad_text(hewn_off_read, "OFF\n1 99999999999999999999 0\n0 0 0\n", 2, "99999999999999999999");
    assert_bad(hewn_off_read, "\xff\xfeO\0F\0F\0", 8, 1, "UTF-16");
}

/* --- writing ------------------------------------------------------------------------------------------------------ */

static void test_written_text(void **state)
{
    (void)state;
    hewn_model model = read_text(hewn_off_read, "STCNOFF\n4 2 0\n0.1 0 0 0 0 1 0 1 0.5 0 0\n1 0 0 0 0 1 1 1 1 1e30 0\n"
                                                "1 1 0 0 0 1 0 0 0 1 1\n0 1 0 0 0 1 1 1 1 1 1\n"
                                                "3 0 1 2 255 9 8\n4 3 2 1 0 1 2 3 4\n");
    char *text = written_text(&model, "off"), expected[512];
    snprintf(expected, sizeof expected,
             "STCNOFF\n# Hewn %s\n# 1 unit = ? m, ? up\n4 2 0\n0.1 0 0 0 0 1 0.0 1.0 0.5 0 0\n"
             "1 0 0 0 0 1 1.0 1.0 1.0 1e+30 0\n1 1 0 0 0 1 0.0 0.0 0.0 1 1\n0 1 0 0 0 1 1.0 1.0 1.0 1 1\n"
             "3 0 1 2 255 9 8 255\n4 3 2 1 0 1 2 3 4\n",
             hewn_version());
    assert_string_equal(text, expected);
    hewn_free(text);
    hewn_model_destroy(&model);
}

static void test_triangles_are_written_as_floats(void **state)
{
    (void)state;
    char folder[64], path[96], *bytes = NULL;
    size_t length = 0;
    float positions[] = {0, 0, 0, 1, 0, 0, 0.1f, 1e-7f, -3.5f};
    uint32_t indices[] = {0, 1, 2};
    const hewn_triangles triangles = {
        .vertex_count = 3, .triangle_count = 1, .positions = positions, .indices = indices};
    const hewn_write_desc desc = {.unit = hewn_unit_find("mm"), .up = HEWN_AXIS_PLUS_Z};
    make_folder(folder);
    snprintf(path, sizeof path, "%s/part.off", folder);
    assert_int_equal(hewn_triangles_write(&triangles, path, &desc, NULL), HEWN_OK);
    assert_int_equal(hewn_file_read(path, SIZE_MAX / 4, &bytes, &length, NULL), HEWN_OK);
    assert_non_null(strstr(bytes, "\n# 1 unit = 0.001 m, +Z up\n3 1 0\n0 0 0\n1 0 0\n0.1 1e-07 -3.5\n3 0 1 2\n"));
    hewn_free(bytes);
    hewn_model read = read_model(path);
    assert_string_equal(read.unit->name, "mm");
    assert_true(read.up_known && read.up == HEWN_AXIS_PLUS_Z);
    hewn_model_destroy(&read);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

/* --- round trips -------------------------------------------------------------------------------------------------- */

static double random_double(random_state *random)
{
    for (;;) {
        uint64_t bits = random_bits(random);
        double value;
        memcpy(&value, &bits, sizeof value);
        if (isfinite(value))
            return value;
    }
}

static void add_random_channel(hewn_model *model, const char *name, hewn_domain domain, hewn_scalar scalar,
                               uint32_t components, random_state *random)
{
    const hewn_channel *channel = add_channel(model, name, domain, scalar, components);
    float *floats = channel->values;
    uint8_t *bytes = channel->values;
    for (size_t i = 0; i < channel_bytes(model, channel) / hewn_scalar_size(scalar); i++)
        if (scalar == HEWN_SCALAR_FLOAT)
            floats[i] = random_below(random, 3) ? random_float(random) : (float)random_below(random, 2);
        else
            bytes[i] = (uint8_t)random_bits(random);
}

/* Any polygons, any numbers, and any of the channels that OFF holds, as its reader would give them. */
static hewn_model random_model(random_state *random)
{
    uint32_t vertices = 1 + random_below(random, 40), faces = 1 + random_below(random, 40), corners = 0;
    uint32_t degrees[64];
    bool polygons = random_below(random, 2);
    for (uint32_t face = 0; face < faces; face++)
        corners += degrees[face] = polygons ? 3 + random_below(random, 5) : 3;
    hewn_model model = make_model(vertices, faces, corners, polygons);
    for (uint32_t face = 0; face < faces && polygons; face++)
        model.first[face + 1] = model.first[face] + degrees[face];
    for (uint32_t i = 0; i < corners; i++)
        model.corners[i] = random_below(random, vertices);
    for (uint32_t i = 0; i < 3 * vertices; i++)
        model.positions[i] = random_below(random, 8) ? random_double(random) : -0.0;
    hewn_scalar scalars[] = {HEWN_SCALAR_FLOAT, HEWN_SCALAR_UINT8};
    if (random_below(random, 2))
        add_random_channel(&model, "normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3, random);
    if (random_below(random, 2))
        add_random_channel(&model, "uv", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 2, random);
    if (random_below(random, 2))
        add_random_channel(&model, "color", HEWN_DOMAIN_VERT, scalars[random_below(random, 2)],
                           3 + random_below(random, 2), random);
    if (random_below(random, 2))
        add_random_channel(&model, "color", HEWN_DOMAIN_FACE, scalars[random_below(random, 2)],
                           3 + random_below(random, 2), random);
    return model;
}

static void test_random_models_keep_every_bit(void **state)
{
    (void)state;
    random_state random = {6};
    int rounds = getenv("HEWN_LONG") ? 20000 : 400;
    for (int round = 0; round < rounds; round++) {
        hewn_model model = random_model(&random);
        model.unit = hewn_unit_at(random_below(&random, 8)); /* past the last one: unknown */
        model.up_known = random_below(&random, 2);
        model.up = model.up_known ? (hewn_axis)random_below(&random, 3) : HEWN_AXIS_PLUS_Y;
        hewn_model read = through_file(&model, "off");
        assert_same_model(&model, &read);
        hewn_model_destroy(&read);
        hewn_model_destroy(&model);
    }
}

static void check_file_of_data(const char *path, const char *statistics)
{
    hewn_model model = read_model(path);
    if ((long long)model.vertex_count != statistic(statistics, "V=") ||
        (long long)model.face_count != statistic(statistics, "F="))
        fail_msg("%s: %llu vertices, %llu faces, but %s", path, (unsigned long long)model.vertex_count,
                 (unsigned long long)model.face_count, statistics);
    hewn_model read = through_file(&model, "off");
    assert_same_model(&model, &read);
    hewn_model_destroy(&read);
    read = through_file(&model, "obj"); /* which holds the rest, but other colours */
    assert_memory_equal(model.positions, read.positions, model.vertex_count * 3 * sizeof(double));
    assert_memory_equal(model.corners, read.corners, hewn_model_corner_count(&model) * sizeof(uint32_t));
    hewn_model_destroy(&read);
    hewn_model_destroy(&model);
}

static void test_data_goes_through_unchanged(void **state)
{
    (void)state;
    static const char *const folders[] = {"mesh-scan", "mesh-control", "mesh-misc", "mesh-open",
                                          "mesh-cad",  "boolean",      "mesh-nasty"};
    int checked = for_each_statistic(folders, sizeof folders / sizeof *folders, "off", check_file_of_data);
    if (checked < 0)
        skip();
    assert_true(checked >= 45);
}

/* Each file of the broken ones is right or clearly refused, and a promise of many vertices costs no memory. */
static void test_data_malformed(void **state)
{
    (void)state;
    static const struct {
        const char *file, *part; /* NULL: it is right */
        uint32_t line;
        uint64_t vertices, faces;
        uint32_t channels;
    } known[] = {
        {"OutOfMemory.off", "353535235358", 0, 0, 0, 0},
        {"Wuson.off", NULL, 0, 3205, 3732, 0},
        {"invalid.off", "0 corners", 6, 0, 0, 0},
        {"whitespace.off", NULL, 0, 8, 6, 1},
    };
    char data[4096], path[4200];
    if (!data_folder(data))
        skip();
    struct rusage before, after;
    getrusage(RUSAGE_SELF, &before);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        hewn_model model;
        hewn_error error = {0};
        snprintf(path, sizeof path, "%s/malformed/%s", data, known[i].file);
        hewn_result result = hewn_model_read(path, NULL, &model, &error);
        bool same = known[i].part ? result == HEWN_BAD_INPUT && error.line == known[i].line &&
                                        strstr(error.message, known[i].part)
                                  : result == HEWN_OK && model.vertex_count == known[i].vertices &&
                                        model.face_count == known[i].faces && model.channel_count == known[i].channels;
        if (!same)
            fail_msg("%s: %d, line %u: %s; %llu vertices, %llu faces, %u channels", known[i].file, result, error.line,
                     error.message, (unsigned long long)model.vertex_count, (unsigned long long)model.face_count,
                     model.channel_count);
        hewn_model_destroy(&model);
    }
    getrusage(RUSAGE_SELF, &after);
    assert_true(after.ru_maxrss - before.ru_maxrss < 64 * 1024);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_vertex_channels),
        cmocka_unit_test(test_color_kinds),
        cmocka_unit_test(test_mixed_face_colors),
        cmocka_unit_test(test_binary),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_written_text),
        cmocka_unit_test(test_triangles_are_written_as_floats),
        cmocka_unit_test(test_random_models_keep_every_bit),
        cmocka_unit_test(test_data_goes_through_unchanged),
        cmocka_unit_test(test_data_malformed),
    };
    return cmocka_run_group_tests_name("off", tests, NULL, NULL);
}
