/* Writing GLB: nothing is lost on the way there and back but what glTF cannot hold, and the file says what was done. */
#include <math.h>

#include "gltf_support.h"

/* --- there and back ----------------------------------------------------------------------------------------------- */

/* Random triangles over random vertices, some at the same place, or a closed ring; positions are floats. */
static hewn_model make_random_model(random_state *random)
{
    bool closed = random_below(random, 3) == 0;
    hewn_model model = {0};
    if (closed) {
        model = make_ring_model(3 + random_below(random, 20), 3 + random_below(random, 20), 1);
        hewn_free(model.first);
        model.first = NULL;
    } else {
        model = make_model(1 + random_below(random, 60), 1 + random_below(random, 100), 300, false);
        for (uint64_t c = 0; c < 3 * model.face_count; c++)
            model.corners[c] = random_below(random, (uint32_t)model.vertex_count);
    }
    for (uint64_t i = 0; i < 3 * model.vertex_count; i++)
        model.positions[i] = closed                    ? (double)(float)model.positions[i]
                             : random_below(random, 8) ? (double)random_float(random)
                                                       : -0.0;
    for (uint64_t v = 1; v < model.vertex_count && random_below(random, 2); v += 1 + random_below(random, 9))
        memcpy(model.positions + 3 * v, model.positions, 3 * sizeof(double));
    return model;
}

/* Values of few kinds, so that some corners of a vertex agree. Those of normals have length 1. */
static void fill_channel(hewn_model *model, hewn_channel *channel, random_state *random)
{
    uint32_t components = channel->info.components;
    uint64_t count = hewn_model_domain_count(model, channel->info.domain);
    for (uint64_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < components; k++) {
            double value = random_below(random, 3) / 4.0;
            if (strcmp(channel->info.name, "normal") == 0)
                value = k == i % 3 ? 1 : 0;
            switch (channel->info.scalar) {
            case HEWN_SCALAR_FLOAT: ((float *)channel->values)[components * i + k] = (float)value; break;
            case HEWN_SCALAR_DOUBLE: ((double *)channel->values)[components * i + k] = value; break;
            case HEWN_SCALAR_UINT8: ((uint8_t *)channel->values)[components * i + k] = (uint8_t)(200 * value); break;
            case HEWN_SCALAR_INT32:
                ((int32_t *)channel->values)[components * i + k] = (int32_t)random_below(random, 3) - 1;
                break;
            }
        }
}

static const hewn_attribute_info attributes[] = {
    {"normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3}, {"uv", HEWN_DOMAIN_VERT, HEWN_SCALAR_DOUBLE, 2},
    {"color", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 4},  {"tint", HEWN_DOMAIN_VERT, HEWN_SCALAR_UINT8, 3},
    {"label", HEWN_DOMAIN_VERT, HEWN_SCALAR_INT32, 1},  {"frame", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 9},
};

static void add_random_channels(hewn_model *model, random_state *random)
{
    for (size_t i = 0; i < sizeof attributes / sizeof *attributes; i++) {
        if (random_below(random, 2))
            continue;
        hewn_domain domain = random_below(random, 2) ? HEWN_DOMAIN_CORNER : HEWN_DOMAIN_VERT;
        fill_channel(model,
                     add_channel(model, attributes[i].name, domain, attributes[i].scalar, attributes[i].components),
                     random);
    }
}

/* Every corner has the same numbers before and after, whether they are said of corners or of vertices. */
static void assert_same_corners(const hewn_model *before, const hewn_model *after, const hewn_channel *channel)
{
    const char *name = channel->info.name;
    const hewn_channel *read = hewn_model_find_channel(after, HEWN_DOMAIN_CORNER, name);
    if (!read)
        read = hewn_model_find_channel(after, HEWN_DOMAIN_VERT, name);
    assert_non_null(read);
    assert_true(read && read->info.scalar == channel->info.scalar && read->info.components == channel->info.components);
    for (uint64_t c = 0; c < hewn_model_corner_count(before); c++) {
        double given[16] = {0}, found[16] = {0};
        get_numbers(before, name, c, given);
        get_numbers(after, name, c, found);
        assert_memory_equal(given, found, sizeof given);
    }
    for (uint64_t v = 0; channel->info.domain == HEWN_DOMAIN_VERT && v < before->vertex_count; v++)
        for (uint32_t k = 0; k < channel->info.components; k++)
            assert_true(hewn_channel_number(channel, v, k) == hewn_channel_number(read, v, k));
}

static void test_random_models_survive(void **state)
{
    (void)state;
    random_state random = {77};
    int rounds = getenv("HEWN_LONG") ? 3000 : 300;
    for (int round = 0; round < rounds; round++) {
        hewn_model model = make_random_model(&random);
        add_random_channels(&model, &random);
        hewn_model read = through_file(&model, "glb");
        assert_int_equal(model.vertex_count, read.vertex_count);
        assert_int_equal(model.face_count, read.face_count);
        assert_int_equal(model.channel_count, read.channel_count);
        assert_memory_equal(model.positions, read.positions, 3 * model.vertex_count * sizeof(double));
        assert_memory_equal(model.corners, read.corners, 3 * model.face_count * sizeof(uint32_t));
        for (uint32_t i = 0; i < model.channel_count; i++)
            assert_same_corners(&model, &read, &model.channels[i]);
        hewn_model_destroy(&read);
        hewn_model_destroy(&model);
    }
}

/* Triangles are grouped by their material, in the order in which materials come; within a group nothing moves. */
static void test_materials_survive(void **state)
{
    (void)state;
    static const char *const names[] = {"red", "", "g\"r\xc3\xbcn"};
    hewn_model model = make_ring_model(6, 5, 2);
    hewn_channel *channel = add_channel(&model, "material", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1);
    for (int i = 0; i < 3; i++) {
        int32_t value;
        assert_int_equal(hewn_channel_value(channel, names[i], &value, NULL), HEWN_OK);
    }
    for (uint64_t f = 0; f < model.face_count; f++)
        ((int32_t *)channel->values)[f] = (int32_t)(f % 4) - 1;
    hewn_model read = through_file(&model, "glb");
    assert_int_equal(read.face_count, 60);
    const hewn_channel *found = hewn_model_find_channel(&read, HEWN_DOMAIN_FACE, "material");
    assert_non_null(found);
    const int32_t *values = found->values;
    assert_int_equal(found->name_count, 3);
    assert_string_equal(found->names[0], "red");
    assert_string_equal(found->names[1], "unnamed 2");
    assert_string_equal(found->names[2], names[2]);
    assert_int_equal(values[0], -1);
    int changes = 0;
    for (uint64_t f = 1; f < read.face_count; f++)
        changes += values[f] != values[f - 1];
    assert_int_equal(changes, 3);
    hewn_model again = through_file(&read, "glb");
    assert_same_model(&read, &again);
    hewn_mesh *mesh = NULL;
    assert_int_equal(hewn_mesh_from_model(&again, NULL, &mesh, NULL, NULL), HEWN_OK);
    hewn_mesh_destroy(&mesh);
    hewn_model_destroy(&again);
    hewn_model_destroy(&read);
    hewn_model_destroy(&model);
}

/* --- what is written ---------------------------------------------------------------------------------------------- */

static uint32_t word_at(const char *bytes, size_t at)
{
    uint32_t word;
    memcpy(&word, bytes + at, 4);
    return word;
}

/* The container's parts fit each other; returns the JSON, with a NUL after it, to be freed with `*bytes`. */
static const char *json_of(const hewn_model *model, const char *name, char **bytes)
{
    char folder[64], path[96];
    size_t length;
    make_folder(folder);
    snprintf(path, sizeof path, "%s/model.glb", folder);
    write_model(model, path, &(hewn_write_desc){.name = name});
    assert_int_equal(hewn_file_read(path, SIZE_MAX / 4, bytes, &length, NULL), HEWN_OK);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
    assert_memory_equal(*bytes, "glTF", 4);
    assert_int_equal(word_at(*bytes, 4), 2);
    assert_int_equal(word_at(*bytes, 8), length);
    size_t json = word_at(*bytes, 12);
    assert_int_equal(json % 4, 0);
    assert_memory_equal(*bytes + 16, "JSON", 4);
    if (20 + json < length) {
        size_t binary = word_at(*bytes, 20 + json);
        assert_int_equal(binary % 4, 0);
        assert_memory_equal(*bytes + 24 + json, "BIN\0", 4);
        assert_int_equal(28 + json + binary, length);
        (*bytes)[20 + json] = '\0';
    }
    return *bytes + 20;
}

static void test_container(void **state)
{
    (void)state;
    random_state random = {8};
    for (uint32_t faces = 1; faces < 6; faces++) { /* odd numbers of short indices need padding */
        hewn_model model = make_model(7, faces, 3ull * faces, false);
        for (uint32_t i = 0; i < 21; i++)
            model.positions[i] = i;
        for (uint32_t c = 0; c < 3 * faces; c++)
            model.corners[c] = random_below(&random, 7);
        char *bytes;
        const char *json = json_of(&model, "a \"name\" \xff\n", &bytes);
        assert_non_null(strstr(json, "\"generator\":\"Hewn "));
        assert_non_null(strstr(json, "\"name\":\"a \\\"name\\\" \xef\xbf\xbd \""));
        assert_null(strstr(json, "extension"));
        assert_null(strstr(json, "extras"));
        assert_null(strstr(json, "sparse"));
        hewn_free(bytes);
        hewn_model_destroy(&model);
    }
}

/* Which record of topology is written, if any. */
static void test_topology_is_recorded_where_needed(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(5, 5, 1);
    char *bytes;
    assert_null(strstr(json_of(&model, NULL, &bytes), "manifoldPrimitive"));
    hewn_free(bytes);
    fill_channel(&model, add_channel(&model, "uv", HEWN_DOMAIN_CORNER, HEWN_SCALAR_DOUBLE, 2), &(random_state){1});
    const char *json = json_of(&model, NULL, &bytes);
    assert_non_null(strstr(json, "\"extensionsUsed\":[\"EXT_mesh_manifold\"]"));
    assert_non_null(strstr(json, "mergeIndices"));
    assert_null(strstr(json, "extensionsRequired"));
    assert_null(strstr(json, "hewn_topology"));
    hewn_free(bytes);
    model.face_count--; /* open: EXT_mesh_manifold has no place for that */
    json = json_of(&model, NULL, &bytes);
    assert_null(strstr(json, "EXT_mesh_manifold"));
    assert_non_null(strstr(json, "hewn_topology"));
    hewn_free(bytes);
    hewn_model_destroy(&model);
    model = make_ring_model(5, 5, 1);
    memcpy(model.positions, model.positions + 3, 3 * sizeof(double)); /* two vertices in one place */
    json = json_of(&model, NULL, &bytes);
    assert_non_null(strstr(json, "EXT_mesh_manifold"));
    assert_null(strstr(json, "mergeIndices"));
    hewn_free(bytes);
    hewn_model_destroy(&model);
}

/* What was done to unit and axes is said exactly, and is what was done. */
static void test_conversion_is_recorded(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(5, 5, 1);
    model.unit = hewn_unit_find("in");
    model.up = HEWN_AXIS_PLUS_Z;
    model.up_known = true;
    char *bytes;
    const char *json = json_of(&model, NULL, &bytes);
    assert_non_null(strstr(json, "\"asset\":{\"extras\":{\"conversion\":{\"from\":{\"unit\":\"in\",\"up\":\"+Z\"},"
                                 "\"rotation\":[1,0,0,0,0,1,0,-1,0],\"scale\":[127,5000],"
                                 "\"to\":{\"unit\":\"m\",\"up\":\"+Y\"}}}"));
    hewn_free(bytes);
    hewn_model read = through_file(&model, "glb");
    for (uint64_t v = 0; v < model.vertex_count; v++) {
        const double *p = model.positions + 3 * v, *q = read.positions + 3 * v;
        assert_true(q[0] == (double)(float)(p[0] * 127 / 5000));
        assert_true(q[1] == (double)(float)(p[2] * 127 / 5000));
        assert_true(q[2] == (double)(float)(-p[1] * 127 / 5000));
    }
    hewn_model_destroy(&read);
    hewn_model_destroy(&model);
}

/* The numbers of the JSON array after `key`. */
static void numbers_after(const char *json, const char *key, double out[3])
{
    const char *at = strstr(json, key);
    assert_non_null(at);
    at = at ? strchr(at, '[') : NULL;
    assert_non_null(at);
    for (int axis = 0; at && axis < 3; axis++) {
        char *end;
        out[axis] = strtod(at + 1, &end);
        at = end;
    }
}

/* The model's up axis becomes +Y by a rotation, in metres: up stays up, the volume its sign, and the angle between
 * position and normal what it is. The bounds are those of the floats that are written. */
static void test_units_and_axes(void **state)
{
    (void)state;
    static const int up_of[] = {[HEWN_AXIS_PLUS_Y] = 1, [HEWN_AXIS_PLUS_Z] = 2, [HEWN_AXIS_PLUS_X] = 0};
    for (int up = HEWN_AXIS_PLUS_Y; up <= HEWN_AXIS_PLUS_X; up++) {
        hewn_model model = make_ring_model(11, 13, 1);
        double *normals = add_channel(&model, "normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_DOUBLE, 3)->values;
        for (uint64_t v = 0; v < model.vertex_count; v++) {
            const double *p = model.positions + 3 * v;
            double length = hypot(hypot(p[0], p[1]), p[2]);
            for (int axis = 0; axis < 3; axis++)
                normals[3 * v + axis] = p[axis] / length;
        }
        model.unit = hewn_unit_find("cm");
        model.up = (hewn_axis)up;
        model.up_known = true;
        hewn_model read = through_file(&model, "glb");
        char *bytes;
        const char *json = json_of(&model, NULL, &bytes);
        double lo[3], hi[3], least[3], most[3];
        numbers_after(json, "\"min\":", lo);
        numbers_after(json, "\"max\":", hi);
        for (uint64_t v = 0; v < read.vertex_count; v++) {
            const double *p = read.positions + 3 * v;
            double n[16], dot = 0;
            assert_true(p[1] == (double)(float)(model.positions[3 * v + up_of[up]] / 100));
            const hewn_channel *channel = hewn_model_find_channel(&read, HEWN_DOMAIN_VERT, "normal");
            for (uint32_t axis = 0; axis < 3; axis++) {
                n[axis] = hewn_channel_number(channel, v, axis);
                dot += n[axis] * p[axis];
                least[axis] = v == 0 ? p[axis] : fmin(least[axis], p[axis]);
                most[axis] = v == 0 ? p[axis] : fmax(most[axis], p[axis]);
            }
            assert_true(fabs(dot - hypot(hypot(p[0], p[1]), p[2])) < 1e-8);
        }
        for (int axis = 0; axis < 3; axis++)
            assert_true(lo[axis] == least[axis] && hi[axis] == most[axis]);
        hewn_triangles before, after;
        hewn_certificate a, b;
        assert_int_equal(hewn_triangles_from_model(&model, &before, NULL), HEWN_OK);
        assert_int_equal(hewn_triangles_from_model(&read, &after, NULL), HEWN_OK);
        assert_int_equal(hewn_certify(&before, NULL, &a, NULL), HEWN_OK);
        assert_int_equal(hewn_certify(&after, NULL, &b, NULL), HEWN_OK);
        assert_true(fabs(b.volume - a.volume * 1e-6) < 1e-12);
        hewn_triangles_destroy(&before);
        hewn_triangles_destroy(&after);
        hewn_free(bytes);
        hewn_model_destroy(&read);
        hewn_model_destroy(&model);
    }
}

static void test_written_normals_have_length_one(void **state)
{
    (void)state;
    for (int domain = HEWN_DOMAIN_VERT; domain <= HEWN_DOMAIN_CORNER; domain++) {
        hewn_model model = make_ring_model(8, 8, 1);
        hewn_channel *channel = add_channel(&model, "normal", (hewn_domain)domain, HEWN_SCALAR_DOUBLE, 3);
        uint64_t count = hewn_model_domain_count(&model, (hewn_domain)domain);
        for (uint64_t i = 3; i < 3 * count; i++)
            ((double *)channel->values)[i] = i % 3 == 0 ? 1e-30 : i % 5 == 0 ? 17 : 0.5;
        hewn_model read = through_file(&model, "glb");
        for (uint64_t c = 0; c < hewn_model_corner_count(&read); c++) {
            double n[16];
            get_numbers(&read, "normal", c, n);
            assert_true(fabs(hypot(hypot(n[0], n[1]), n[2]) - 1) < 1e-6);
        }
        hewn_model_destroy(&read);
        hewn_model_destroy(&model);
    }
}

/* Copies that seams make can need longer indices than the model itself. */
static void test_seams_lengthen_indices(void **state)
{
    (void)state;
    for (uint32_t extra = 0; extra <= 2; extra++) {
        uint32_t faces = 40000;
        hewn_model model = make_model(65534, faces, 3ull * faces, false);
        for (uint64_t i = 0; i < 3 * model.vertex_count; i++)
            model.positions[i] = (double)i;
        for (uint32_t c = 0; c < 3 * faces; c++)
            model.corners[c] = c % 65534;
        float *color = add_channel(&model, "color", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 3)->values;
        for (uint32_t i = 0; i < extra; i++)
            color[3 * (65534 + i)] = 1;
        char *bytes;
        const char *json = json_of(&model, NULL, &bytes);
        assert_true((strstr(json, "\"componentType\":5123") != NULL) == (extra < 2));
        hewn_free(bytes);
        hewn_model read = through_file(&model, "glb");
        assert_int_equal(read.vertex_count, 65534);
        assert_memory_equal(model.corners, read.corners, 3ull * faces * sizeof(uint32_t));
        hewn_model_destroy(&read);
        hewn_model_destroy(&model);
    }
}

/* What glTF has no type for is left out, and nothing else suffers. */
static void test_what_cannot_be_written_is_left_out(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(4, 4, 1);
    int32_t *far = add_channel(&model, "far", HEWN_DOMAIN_VERT, HEWN_SCALAR_INT32, 1)->values;
    far[3] = INT32_MAX;
    add_channel(&model, "five", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 5);
    add_channel(&model, "bytes", HEWN_DOMAIN_VERT, HEWN_SCALAR_UINT8, 9);
    add_channel(&model, "uv", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3);
    add_channel(&model, "of faces", HEWN_DOMAIN_FACE, HEWN_SCALAR_FLOAT, 1);
    int32_t *near = add_channel(&model, "near", HEWN_DOMAIN_VERT, HEWN_SCALAR_INT32, 1)->values;
    near[3] = 1 << 24;
    double *huge = add_channel(&model, "huge", HEWN_DOMAIN_VERT, HEWN_SCALAR_DOUBLE, 1)->values;
    huge[1] = 1e300;
    float *color = add_channel(&model, "color", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3)->values;
    color[0] = 2;
    color[1] = -1;
    hewn_model read = through_file(&model, "glb");
    assert_int_equal(read.channel_count, 3);
    const hewn_channel *shown = hewn_model_find_channel(&read, HEWN_DOMAIN_VERT, "color");
    assert_true(shown && ((const float *)shown->values)[0] == 1 && ((const float *)shown->values)[1] == 0);
    const hewn_channel *channel = hewn_model_find_channel(&read, HEWN_DOMAIN_VERT, "near");
    assert_true(channel && ((const float *)channel->values)[3] == 1 << 24);
    assert_non_null(hewn_model_find_channel(&read, HEWN_DOMAIN_VERT, "huge"));
    hewn_model_destroy(&read);
    hewn_model_destroy(&model);
}

/* --- files of the test data --------------------------------------------------------------------------------------- */

/* Faces as another program counted them, and what is written reads back with the same vertices and faces. */
static void check_counted(const char *path, const char *statistics)
{
    hewn_model model = read_model(path);
    assert_int_equal(3 * model.face_count, statistic(statistics, "idx="));
    assert_true(model.vertex_count <= (uint64_t)statistic(statistics, "V="));
    hewn_model once = through_file(&model, "glb"), twice = through_file(&once, "glb");
    assert_int_equal(model.vertex_count, once.vertex_count);
    assert_memory_equal(model.corners, once.corners, 3 * model.face_count * sizeof(uint32_t));
    assert_same_model(&once, &twice);
    hewn_model_destroy(&model);
    hewn_model_destroy(&once);
    hewn_model_destroy(&twice);
}

static void test_data_survives(void **state)
{
    (void)state;
    static const char *const folders[] = {"gltf"};
    int checked = for_each_statistic(folders, 1, "glb", check_counted);
    if (checked < 0)
        skip();
    assert_int_equal(checked, 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_models_survive),
        cmocka_unit_test(test_materials_survive),
        cmocka_unit_test(test_container),
        cmocka_unit_test(test_topology_is_recorded_where_needed),
        cmocka_unit_test(test_conversion_is_recorded),
        cmocka_unit_test(test_units_and_axes),
        cmocka_unit_test(test_written_normals_have_length_one),
        cmocka_unit_test(test_seams_lengthen_indices),
        cmocka_unit_test(test_what_cannot_be_written_is_left_out),
        cmocka_unit_test(test_data_survives),
    };
    return cmocka_run_group_tests_name("gltf_write", tests, NULL, NULL);
}
