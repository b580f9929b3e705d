/* Wavefront OBJ: the forms that files come in, broken ones, what is written, and round trips. */
#include "io_support.h"

#define FOUR "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static const hewn_channel *channel_of(const hewn_model *model, hewn_domain domain, const char *name)
{
    const hewn_channel *channel = hewn_model_find_channel(model, domain, name);
    if (!channel)
        fail_msg("no channel \"%s\"", name);
    return channel;
}

static void assert_floats(const hewn_channel *channel, const float *expected, size_t count)
{
    assert_int_equal(channel->info.scalar, HEWN_SCALAR_FLOAT);
    assert_memory_equal(channel->values, expected, count * sizeof(float));
}

static void assert_labels(const hewn_model *model, const char *name, const char *const *expected, size_t count)
{
    const hewn_channel *channel = channel_of(model, HEWN_DOMAIN_FACE, name);
    assert_int_equal(model->face_count, count);
    for (size_t i = 0; i < count; i++) {
        int32_t value = ((const int32_t *)channel->values)[i];
        if (!expected[i]) {
            assert_int_equal(value, -1);
            continue;
        }
        assert_in_range(value, 0, channel->name_count - 1);
        assert_string_equal(channel->names[value], expected[i]);
    }
}

/* --- reading ------------------------------------------------------------------------------------------------------ */

/* All of these are one square of four vertices; some have a normal for each vertex. */
static void test_forms(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t channels;
        bool normals;
    } forms[] = {
        {FOUR "f 1 2 3 4\n", 0, false},
        {FOUR "f 1 2 3 4", 0, false},
        {FOUR "fo 1 2 3 4", 0, false},
        {FOUR "f -4 -3 -2 -1 # square\n", 0, false},
        {FOUR "f +1 2 3 4#square\n", 0, false},
        {FOUR "vt 0\nf 1/1 2/1 3/1 4/1\n", 1, false},
        {FOUR "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/-1\n", 2, true},
        {FOUR "vn 0 0 1\nf 1//1 2//1 3//1 4//1\n", 1, true},
        {FOUR "vn 0 0 1\nvn 0 0 1\nf 1//1 2//1 3//2 4//-1\n", 1, true},
        {FOUR "f 1// 2/ 3/7/ 4//\n", 0, false},
        {FOUR "f 1//9 2/8 3/7/6 4//5\n", 0, false},
        {FOUR "vn 0 0 1\nf 1 2 3 4\n", 0, false},
        {"f 1 2 3 4\n" FOUR, 0, false},
        {"v 0 0 0\r\nv 1 0 0 1.0\r\nv 1 1 0 0.5 0.5\r\n\tv\t0\t1\t0\r\nf 1 2 \\\r\n 3 4\r\n", 0, false},
        {"v 0 0 0 # a\nv 1 0 0 1 0 x\nv 1 1 0 1.#IND 0 0\nv \\\n 0 1 0\nf 1 2\\\n3 4\n", 0, false},
        {"\xef\xbb\xbf# text\nmtllib x.mtl\n" FOUR "l 1 2\np 1\ns off\nvp 0 1\nusemtl \n\nf 1 2 3 4\n", 0, false},
        {"\n\\\n" FOUR "f 1 2 3 4\n", 0, false},
        {FOUR "# C:\\path\\\nf 1 2 3 4\ncurv 0 1 \\\nf 1 2 \\\n f\n", 0, false},
    };
    static const double positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    static const float up[] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    static const uint32_t corners[] = {0, 1, 2, 3};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        hewn_model model = read_text(hewn_obj_read, forms[i].text);
        assert_int_equal(model.vertex_count, 4);
        assert_int_equal(model.face_count, 1);
        assert_int_equal(first_of(&model, 1), 4);
        assert_memory_equal(model.positions, positions, sizeof positions);
        assert_memory_equal(model.corners, corners, sizeof corners);
        if (model.channel_count != forms[i].channels)
            fail_msg("%u channels in \"%s\"", model.channel_count, forms[i].text);
        if (forms[i].normals)
            assert_floats(channel_of(&model, HEWN_DOMAIN_VERT, "normal"), up, 12);
        hewn_model_destroy(&model);
    }
    hewn_model model = read_text(hewn_obj_read, "");
    assert_int_equal(model.vertex_count + model.face_count, 0);
    hewn_model_destroy(&model);
}

static void test_numbers_are_the_nearest_doubles(void **state)
{
    (void)state;
    hewn_model model = read_text(hewn_obj_read, "v 0.1 -.7e+2 16777217.0000001\nv 1e-320 +1.E2 -0\nv 1. 2 3e300\n");
    static const double expected[] = {0.1, -70, 16777217.0000001, 1e-320, 100, -0.0, 1, 2, 3e300};
    assert_memory_equal(model.positions, expected, sizeof expected);
    assert_int_equal(model.face_count, 0);
    hewn_model_destroy(&model);
}

static void test_values_of_vertices_and_corners(void **state)
{
    (void)state;
    /* Numbered like the vertices, one vertex unused: as it stands, also for that one. */
    hewn_model model = read_text(hewn_obj_read, FOUR "vt 1 2\nvt 3 4\nvt 5 6\nvt 7 8 9\nf 1/1 2/2 3/3\n");
    assert_floats(channel_of(&model, HEWN_DOMAIN_VERT, "uv"), (const float[]){1, 2, 3, 4, 5, 6, 7, 8}, 8);
    hewn_model_destroy(&model);
    /* One value a vertex, numbered otherwise; what is missing is zero. */
    model = read_text(hewn_obj_read, FOUR "vt 1 2\nvt 3 4\nf 1/2 2/1 3\nf 3 2/1 1/2\n");
    assert_floats(channel_of(&model, HEWN_DOMAIN_VERT, "uv"), (const float[]){3, 4, 1, 2, 0, 0, 0, 0}, 8);
    hewn_model_destroy(&model);
    /* Two values at vertex 2, and a corner without one. */
    model = read_text(hewn_obj_read, FOUR "vt 1 2\nvt 3 nan\nf 1/1 2/1 3/2\nf 1/1 2/2 4\n");
    assert_floats(channel_of(&model, HEWN_DOMAIN_CORNER, "uv"), (const float[]){1, 2, 1, 2, 3, 0, 1, 2, 3, 0, 0, 0},
                  12);
    hewn_model_destroy(&model);
    /* Corners that come before the first with a normal. */
    model = read_text(hewn_obj_read, FOUR "vn 0 0 1\nf 1 2 3\nf 1//1 3//1 4//1\n");
    const hewn_channel *normals = channel_of(&model, HEWN_DOMAIN_CORNER, "normal");
    assert_floats(normals, (const float[18]){[11] = 1, [14] = 1, [17] = 1}, 18);
    hewn_model_destroy(&model);
    /* Points with normals. */
    model = read_text(hewn_obj_read, "vn 0 0 1\nv 0 0 0\nvn 1 0 0\nv 1 2 3\n");
    assert_floats(channel_of(&model, HEWN_DOMAIN_VERT, "normal"), (const float[]){0, 0, 1, 1, 0, 0}, 6);
    hewn_model_destroy(&model);
}

static void test_colors(void **state)
{
    (void)state;
    hewn_model model =
        read_text(hewn_obj_read, "v 0 0 0\nv 0 0 0 0.1 0.2 300\nv 0 0 0 nan -1 inf\nv 0 0 0 1 1 1 1\nv 0 0 0\n");
    assert_floats(channel_of(&model, HEWN_DOMAIN_VERT, "color"),
                  (const float[]){0, 0, 0, 0.1f, 0.2f, 300, 0, -1, 0, 1, 1, 1, 0, 0, 0}, 15);
    hewn_model_destroy(&model);
}

static void test_labels(void **state)
{
    (void)state;
    hewn_model model =
        read_text(hewn_obj_read, FOUR "f 1 2 3\no first thing \ng a  b\nusemtl never\nusemtl red #2\t\n"
                                      "f 1 2 3\nf 1 2 4\ng\ns 3\ns 4294967295\nf 1 2 3\n"
                                      "usemtl C:\\x\\\ng a\x01\x62\no first thing\ns off\nf 1 2 3\ng z\n");
    assert_labels(&model, "object", (const char *[]){NULL, "first thing", "first thing", "first thing", "first thing"},
                  5);
    assert_labels(&model, "group", (const char *[]){NULL, "a  b", "a  b", NULL, NULL}, 5);
    assert_labels(&model, "material", (const char *[]){NULL, "red #2", "red #2", "red #2", "C:\\x"}, 5);
    assert_int_equal(channel_of(&model, HEWN_DOMAIN_FACE, "material")->name_count, 2);
    assert_memory_equal(channel_of(&model, HEWN_DOMAIN_FACE, "smooth")->values, ((const int32_t[]){0, 0, 0, -1, 0}),
                        5 * sizeof(int32_t));
    hewn_model_destroy(&model);
    model = read_text(hewn_obj_read, "o only\ng only\ns 0\n" FOUR);
    assert_int_equal(model.channel_count, 0);
    hewn_model_destroy(&model);
}

static char *with_line_ends(const char *text, const char *end)
{
    char *out = calloc(2 * strlen(text) + 1, 1), *to = out;
    assert_non_null(out);
    for (; *text; text++) {
        if (*text == '\n')
            to = stpcpy(to, end);
        else
            *to++ = *text;
    }
    return out;
}

static void test_line_ends(void **state)
{
    (void)state;
    static const char text[] =
        "# one\n# 1 unit = 0.001 m, +Z up\n\n" FOUR "vt 1 2\ng a \\\n b\nusemtl c\nf 1/1 2/1 \\\n"
        "3/1 4/1\ns 1\n\nf 4 3 2 # end\nf 1 2 \\\n 3";
    hewn_model expected = read_text(hewn_obj_read, text);
    assert_string_equal(expected.unit->name, "mm");
    assert_true(expected.up_known && expected.up == HEWN_AXIS_PLUS_Z);
    assert_int_equal(expected.face_count, 3);
    static const char *const ends[] = {"\r", "\r\n"};
    for (int i = 0; i < 2; i++) {
        char *other = with_line_ends(text, ends[i]);
        hewn_model model = read_text(hewn_obj_read, other);
        assert_same_model(&expected, &model);
        assert_ptr_equal(expected.unit, model.unit);
        hewn_model_destroy(&model);
        free(other);
        other = with_line_ends(FOUR "\nf 1 2 x\n", ends[i]);
        assert_bad_text(hewn_obj_read, other, 6, "\"x\"");
        free(other);
    }
    hewn_model_destroy(&expected);
}

static void test_errors(void **state)
{
    (void)state;
    assert_bad_text(hewn_obj_read, FOUR "\nf 1 2 5\nf 1 2 3\n", 6, "vertex 5");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 0\n", 5, "\"0\"");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 -5\n", 5, "\"-5\"");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 3x\n", 5, "\"3x\"");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 3/1/1/1\n", 5, "\"3/1/1/1\"");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 3/+\n", 5, "\"3/+\"");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 99999999999999999999\n", 5, "corner");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2 4294967296\n", 5, "corner");
    assert_bad_text(hewn_obj_read, FOUR "f 1 2\n", 5, "three corners");
    assert_bad_text(hewn_obj_read, FOUR "f\n", 5, "three corners");
    assert_bad_text(hewn_obj_read, FOUR "vn 0 0 1\nf 1//1 2//2 3//1\n", 6, "normal 2");
    assert_bad_text(hewn_obj_read, FOUR "vt 0\nf 1/1 2/3 3/1\n", 6, "texture coordinate 3");
    assert_bad_text(hewn_obj_read, FOUR "vt 0\nf 1/1 2/-2 3/1\n", 6, "\"2/-2\"");
    assert_bad_text(hewn_obj_read, "v 0 0\n", 1, "the line ends");
    assert_bad_text(hewn_obj_read, "v 0 0", 1, "the file ends");
    assert_bad_text(hewn_obj_read, "vn 0 0\n", 1, "the line ends");
    assert_bad_text(hewn_obj_read, "vt\n", 1, "the line ends");
    assert_bad_text(hewn_obj_read, "v 0 0 nan\n", 1, "not finite");
    assert_bad_text(hewn_obj_read, "v 0 0 1e309\n", 1, "not finite");
    assert_bad_text(hewn_obj_read, "v 0 0 \x01\x80\n", 1, "\"\?\?\"");
    assert_bad(hewn_obj_read, "\xff\xfe#\0", 4, 1, "UTF-16");
    assert_bad(hewn_obj_read, "v 0\0 0", 6, 1, "not text");
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
    enum { LINES = 400000 };
    char *text = malloc(6 * LINES);
    assert_non_null(text);
    for (size_t i = 0; i < LINES; i++)
        memcpy(text + 6 * i, "#####\n", 6);
    int left = 2;
    hewn_progress progress = {stop, &left};
    const hewn_source source = {.bytes = text, .length = 6 * LINES, .name = "given", .progress = &progress};
    hewn_model model;
    assert_int_equal(hewn_obj_read(&source, &model, NULL), HEWN_CANCELLED);
    assert_null(model.positions);
    free(text);
}

/* --- writing ------------------------------------------------------------------------------------------------------ */

static void test_triangles_keep_their_bytes(void **state)
{
    (void)state;
    char folder[64], path[96], expected[512], *bytes = NULL;
    size_t length = 0;
    float positions[] = {0, 0, 0, 1, 0, 0, 0.1f, 1e-7f, -3.5f}, normals[] = {0, 0, 1, 0, 0.6f, 0.8f, -0.0f, 1, 0};
    uint32_t indices[] = {0, 1, 2};
    const hewn_triangles triangles = {
        .vertex_count = 3, .triangle_count = 1, .positions = positions, .normals = normals, .indices = indices};
    make_folder(folder);
    snprintf(path, sizeof path, "%s/part.obj", folder);
    assert_int_equal(hewn_triangles_write(&triangles, path, NULL, NULL), HEWN_OK);
    assert_int_equal(hewn_file_read(path, SIZE_MAX / 4, &bytes, &length, NULL), HEWN_OK);
    snprintf(expected, sizeof expected,
             "# Hewn %s\n# 1 unit = 1 m, +Y up\no part\nv 0 0 0\nv 1 0 0\nv 0.1 1e-07 -3.5\nvn 0 0 1\nvn 0 0.6 0.8\n"
             "vn -0 1 0\nf 1//1 2//2 3//3\n",
             hewn_version());
    assert_string_equal(bytes, expected);
    hewn_free(bytes);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

static void test_written_text(void **state)
{
    (void)state;
    hewn_model model = read_text(
        hewn_obj_read, "v 0.1 0 0 1 0 0.5\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0.5\nvt 1 0.5\nvn 0 0 1\nf 1 2 3\n"
                       "o a b\ng x\ns 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1 4/1/1\ng\nf 1/2/1 3/2/1 4/2/1\n");
    char *text = written_text(&model, "obj");
    assert_non_null(strstr(text,
                           "# 1 unit = ? m, ? up\nv 0.1 0 0 1 0 0.5\nv 1 0 0 0 0 0\nv 1 1 0 0 0 0\nv 0 1 0 0 0 0\n"
                           "vt 0 0\nvt 1 0.5\nvn 0 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n"
                           "o a b\ng x\nusemtl m\ns 1\nf 1/1/2 2/2/2 3/2/2 4/1/2\ng\nf 1/2/2 3/2/2 4/2/2\n"));
    hewn_free(text);
    hewn_model_destroy(&model);
}

/* Names that cannot stand in a line, and values without a name. */
static void test_written_labels(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(3, 3, 0);
    hewn_channel *groups = add_channel(&model, "group", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1);
    static const char *const names[] = {"a\nf 1 2 3", "ends with\\", "plain"};
    int32_t values[] = {2, 2, 1, 1, 0, 7, -1, -5, 2}, value;
    for (size_t i = 0; i < 3; i++)
        assert_int_equal(hewn_channel_value(groups, names[i], &value, NULL), HEWN_OK);
    memcpy(groups->values, values, sizeof values);
    add_channel(&model, "material", HEWN_DOMAIN_FACE, HEWN_SCALAR_FLOAT, 1); /* no labels: left out */
    hewn_model read = through_file(&model, "obj");
    assert_int_equal(read.channel_count, 1);
    assert_labels(&read, "group",
                  (const char *[]){"plain", "plain", "ends with_", "ends with_", "a f 1 2 3", "7", NULL, NULL, "plain"},
                  9);
    hewn_model_destroy(&read);
    hewn_model_destroy(&model);
}

static void test_colors_of_other_kinds_are_written(void **state)
{
    (void)state;
    hewn_model model = read_text(hewn_obj_read, FOUR "f 1 2 3 4\n");
    uint8_t *bytes = add_channel(&model, "color", HEWN_DOMAIN_VERT, HEWN_SCALAR_UINT8, 4)->values;
    memcpy(bytes, ((const uint8_t[]){255, 0, 51, 9, 1, 2, 3, 4}), 8);
    hewn_model read = through_file(&model, "obj");
    assert_floats(channel_of(&read, HEWN_DOMAIN_VERT, "color"),
                  (const float[12]){1, 0, 0.2f, (float)(1 / 255.0), (float)(2 / 255.0), (float)(3 / 255.0)}, 12);
    hewn_model_destroy(&read);
    hewn_model_destroy(&model);
}

/* --- round trips -------------------------------------------------------------------------------------------------- */

static double random_double(random_state *random)
{
    for (;;) {
        uint64_t bits = random_bits(random);
        double value;
        memcpy(&value, &bits, sizeof value);
        if (isfinite(value))
            return random_below(random, 8) ? value : (double)(float)random_unit(random);
    }
}

static void add_random_floats(hewn_model *model, const char *name, hewn_domain domain, uint32_t components,
                              random_state *random)
{
    const hewn_channel *channel = add_channel(model, name, domain, HEWN_SCALAR_FLOAT, components);
    float *values = channel->values;
    for (size_t i = 0; i < channel_bytes(model, channel) / sizeof(float); i++)
        values[i] = random_below(random, 3) ? random_float(random) : 0.5f * (float)random_below(random, 3);
}

static void add_random_labels(hewn_model *model, const char *name, random_state *random)
{
    static const char *const names[] = {"a", "b b", "#c", "d/\\e", "\xc3\xa4"};
    hewn_channel *channel = add_channel(model, name, HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1);
    int32_t *values = channel->values, value = -1;
    for (uint64_t face = 0; face < model->face_count; face++) {
        if (random_below(random, 4) == 0 || face + 1 == model->face_count)
            assert_int_equal(hewn_channel_value(channel, names[random_below(random, 5)], &value, NULL), HEWN_OK);
        else if (random_below(random, 9) == 0)
            value = -1;
        values[face] = value;
    }
}

/* Any polygons, any numbers, and any of the channels that OBJ holds, as its reader would give them. */
static hewn_model random_model(random_state *random)
{
    uint32_t vertices = 1 + random_below(random, 40), faces = vertices + random_below(random, 40), corners = 0;
    uint32_t *degrees = calloc(faces, sizeof *degrees);
    assert_non_null(degrees);
    bool polygons = random_below(random, 2);
    for (uint32_t face = 0; face < faces; face++)
        corners += degrees[face] = polygons ? 3 + random_below(random, 5) : 3;
    hewn_model model = make_model(vertices, faces, corners, polygons);
    for (uint32_t face = 0; face < faces && polygons; face++)
        model.first[face + 1] = model.first[face] + degrees[face];
    free(degrees);
    for (uint32_t i = 0; i < corners; i++)
        model.corners[i] = random_below(random, vertices);
    for (uint32_t i = 0; i < 3 * vertices; i++)
        model.positions[i] = random_double(random);
    hewn_domain domains[] = {HEWN_DOMAIN_VERT, HEWN_DOMAIN_CORNER};
    if (random_below(random, 2))
        add_random_floats(&model, "color", HEWN_DOMAIN_VERT, 3, random);
    if (random_below(random, 3))
        add_random_floats(&model, "uv", domains[random_below(random, 2)], 2, random);
    if (random_below(random, 3))
        add_random_floats(&model, "normal", domains[random_below(random, 2)], 3, random);
    static const char *const labels[] = {"object", "group", "material"};
    for (int i = 0; i < 3; i++)
        if (random_below(random, 2))
            add_random_labels(&model, labels[i], random);
    if (random_below(random, 2)) {
        int32_t *smooth = add_channel(&model, "smooth", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1)->values;
        for (uint32_t face = 0; face < faces; face++)
            smooth[face] = face + 1 < faces ? (int32_t)random_below(random, 3) - 1 : 1;
    }
    return model;
}

static void test_random_models_keep_every_bit(void **state)
{
    (void)state;
    random_state random = {5};
    int rounds = getenv("HEWN_LONG") ? 20000 : 400;
    for (int round = 0; round < rounds; round++) {
        hewn_model model = random_model(&random);
        model.unit = hewn_unit_at(random_below(&random, 8)); /* past the last one: unknown */
        model.up_known = random_below(&random, 2);
        model.up = model.up_known ? (hewn_axis)random_below(&random, 3) : HEWN_AXIS_PLUS_Y;
        hewn_model read = through_file(&model, "obj");
        assert_same_model(&model, &read);
        hewn_model_destroy(&read);
        hewn_model_destroy(&model);
    }
}

static void check_file_of_data(const char *path, const char *statistics)
{
    hewn_model model = read_model(path);
    long long triangles = 0, quads = 0;
    for (uint64_t face = 0; face < model.face_count; face++) {
        uint64_t degree = first_of(&model, face + 1) - first_of(&model, face);
        triangles += degree == 3;
        quads += degree == 4;
    }
    if ((long long)model.vertex_count != statistic(statistics, "V=") ||
        (long long)model.face_count != statistic(statistics, "F=") || triangles != statistic(statistics, "tri=") ||
        quads != statistic(statistics, "quad="))
        fail_msg("%s: %llu vertices, %llu faces, %lld triangles, %lld quads, but %s", path,
                 (unsigned long long)model.vertex_count, (unsigned long long)model.face_count, triangles, quads,
                 statistics);
    hewn_model read = through_file(&model, "obj");
    assert_same_model(&model, &read);
    hewn_model_destroy(&read);
    hewn_model_destroy(&model);
}

static void test_data_goes_through_unchanged(void **state)
{
    (void)state;
    static const char *const folders[] = {"mesh-scan", "mesh-control", "mesh-misc",       "mesh-open",
                                          "mesh-cad",  "boolean",      "subdiv-baseline", "mesh-nasty"};
    int checked = for_each_statistic(folders, sizeof folders / sizeof *folders, "obj", check_file_of_data);
    if (checked < 0)
        skip();
    assert_true(checked >= 80);
}

/* Each file of the broken ones is right or clearly refused. */
static void test_data_malformed(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        uint32_t line; /* 0: it is right */
        const char *part;
        uint64_t vertices, faces;
        uint32_t channels;
    } known[] = {
        {"box_UTF16BE.obj", 1, "UTF-16", 0, 0, 0},
        {"catmark_torus_creases0.obj", 0, NULL, 32, 32, 1},
        {"concave_polygon.obj", 0, NULL, 64, 1, 5},
        {"cornell_box.obj", 0, NULL, 76, 18, 2},
        {"invalid-face-definition.obj", 15, "three corners", 0, 0, 0},
        {"issue-161-inconsistent-f.obj", 0, NULL, 8, 12, 5},
        {"leading-decimal-dot-issue-201.obj", 0, NULL, 3, 1, 2},
        {"malformed.obj", 28, "\"0\"", 0, 0, 0},
        {"nancolor.obj", 0, NULL, 8, 12, 1},
        {"negative_indices.obj", 0, NULL, 8, 6, 2},
        {"notenoughindices.obj", 9, "three corners", 0, 0, 0},
        {"number_formats.obj", 11, "3.1+e2", 0, 0, 0},
        {"point_cloud.obj", 0, NULL, 3, 0, 1},
        {"polygonfaces.obj", 0, NULL, 5, 1, 3},
        {"singlevn.obj", 0, NULL, 4, 2, 5},
        {"test-nan.obj", 12, "not finite", 0, 0, 0},
        {"testmixed.obj", 0, NULL, 8, 6, 1},
        {"wallhole.obj", 0, NULL, 92, 13, 2},
    };
    char data[4096], path[4200];
    if (!data_folder(data))
        skip();
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        hewn_model model;
        hewn_error error = {0};
        snprintf(path, sizeof path, "%s/malformed/%s", data, known[i].file);
        hewn_result result = hewn_model_read(path, NULL, &model, &error);
        bool same = known[i].line ? result == HEWN_BAD_INPUT && error.line == known[i].line &&
                                        strstr(error.message, known[i].part)
                                  : result == HEWN_OK && model.vertex_count == known[i].vertices &&
                                        model.face_count == known[i].faces && model.channel_count == known[i].channels;
        if (!same)
            fail_msg("%s: %d, line %u: %s; %llu vertices, %llu faces, %u channels", known[i].file, result, error.line,
                     error.message, (unsigned long long)model.vertex_count, (unsigned long long)model.face_count,
                     model.channel_count);
        hewn_model_destroy(&model);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_numbers_are_the_nearest_doubles),
        cmocka_unit_test(test_values_of_vertices_and_corners),
        cmocka_unit_test(test_colors),
        cmocka_unit_test(test_labels),
        cmocka_unit_test(test_line_ends),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_reading_can_be_cancelled),
        cmocka_unit_test(test_triangles_keep_their_bytes),
        cmocka_unit_test(test_written_text),
        cmocka_unit_test(test_written_labels),
        cmocka_unit_test(test_colors_of_other_kinds_are_written),
        cmocka_unit_test(test_random_models_keep_every_bit),
        cmocka_unit_test(test_data_goes_through_unchanged),
        cmocka_unit_test(test_data_malformed),
    };
    return cmocka_run_group_tests_name("obj", tests, NULL, NULL);
}
