/* What is written as PLY reads back as it was; and the files of the test data do so too. */
#include "io_support.h"

/* --- models -------------------------------------------------------------------------------------------------- */

static hewn_model random_polygons(random_state *random, bool floats)
{
    uint32_t vertices = 1 + random_below(random, 200), faces = random_below(random, 100), corners = 0;
    bool triangles = random_below(random, 3) == 0;
    uint32_t most = random_below(random, 5) == 0 ? 400 : 7; /* more than a byte can count */
    uint32_t *degrees = hewn_alloc(faces, sizeof *degrees);
    for (uint32_t f = 0; f < faces; f++)
        corners += degrees[f] = triangles ? 3 : 3 + random_below(random, most - 2);
    hewn_model model = make_model(vertices, faces, corners, !triangles);
    for (uint32_t f = 0; !triangles && f < faces; f++)
        model.first[f + 1] = model.first[f] + degrees[f];
    for (uint32_t c = 0; c < corners; c++)
        model.corners[c] = random_below(random, vertices);
    for (uint64_t i = 0; i < 3ull * vertices; i++)
        model.positions[i] = (double)random_float(random) * (floats ? 1 : 1 + random_unit(random));
    hewn_free(degrees);
    return model;
}

static void fill_channel(const hewn_model *model, hewn_channel *channel, random_state *random)
{
    uint64_t count = hewn_model_domain_count(model, channel->info.domain) * channel->info.components;
    for (uint64_t i = 0; i < count; i++)
        switch (channel->info.scalar) {
        case HEWN_SCALAR_FLOAT: ((float *)channel->values)[i] = random_float(random); break;
        case HEWN_SCALAR_DOUBLE: ((double *)channel->values)[i] = (double)random_float(random) * 1.1; break;
        case HEWN_SCALAR_INT32: ((int32_t *)channel->values)[i] = (int32_t)random_bits(random); break;
        case HEWN_SCALAR_UINT8: ((uint8_t *)channel->values)[i] = (uint8_t)random_bits(random); break;
        }
}

static void add_random_channels(hewn_model *model, random_state *random)
{
    static const char *const names[] = {"normal", "uv",       "color",          "label",    "object",  "velocity", "x",
                                        "face",   "corner_x", "vertex_indices", "texcoord", "quality", "red"};
    for (uint32_t i = random_below(random, 8); i > 0; i--) {
        hewn_attribute_info info = {.name = names[random_below(random, sizeof names / sizeof *names)],
                                    .domain = (hewn_domain)random_below(random, 3),
                                    .scalar = (hewn_scalar)random_below(random, 4),
                                    .components = 1 + random_below(random, random_below(random, 2) ? 4 : 16)};
        if (hewn_model_find_channel(model, info.domain, info.name))
            continue;
        hewn_channel *channel = add_channel(model, info.name, info.domain, info.scalar, info.components);
        fill_channel(model, channel, random);
        int32_t value;
        for (uint32_t k = random_below(random, 4); k > 0 && info.scalar == HEWN_SCALAR_INT32; k--)
            assert_int_equal(hewn_channel_value(channel, names[k], &value, NULL), HEWN_OK);
    }
}

/* The channel that one has become: names that a PLY file has for something else get a "_". */
static const hewn_channel *find_again(const hewn_model *model, const hewn_attribute_info *info)
{
    char name[64];
    snprintf(name, sizeof name, "%s", info->name);
    for (int i = 0; i < 4; i++) {
        const hewn_channel *found = hewn_model_find_channel(model, info->domain, name);
        if (found && found->info.scalar == info->scalar && found->info.components == info->components)
            return found;
        strncat(name, "_", sizeof name - strlen(name) - 1);
    }
    fail_msg("no channel \"%s\" of %u and scalar %d in domain %d", info->name, info->components, info->scalar,
             info->domain);
    return NULL;
}

static void check_round_trip(const hewn_model *model)
{
    hewn_model read = through_file(model, "ply");
    uint32_t lost = 0;
    assert_int_equal(read.vertex_count, model->vertex_count);
    assert_int_equal(read.face_count, model->face_count);
    assert_memory_equal(read.positions, model->positions, 3 * sizeof(double) * model->vertex_count);
    for (uint64_t f = 0; f <= model->face_count; f++)
        assert_int_equal(first_of(&read, f), first_of(model, f));
    if (model->face_count > 0)
        assert_memory_equal(read.corners, model->corners, sizeof(uint32_t) * hewn_model_corner_count(model));
    for (uint32_t i = 0; i < model->channel_count; i++) {
        const hewn_channel *channel = &model->channels[i];
        if (channel->info.domain == HEWN_DOMAIN_CORNER && model->face_count == 0) {
            lost++; /* nothing says how many components there would be */
            continue;
        }
        const hewn_channel *again = find_again(&read, &channel->info);
        if (channel_bytes(model, channel) > 0)
            assert_memory_equal(channel->values, again->values, channel_bytes(model, channel));
        assert_int_equal(channel->name_count, again->name_count);
        for (uint32_t k = 0; k < channel->name_count; k++)
            assert_string_equal(channel->names[k], again->names[k]);
    }
    if (model->face_count > 0)
        assert_int_equal(read.channel_count + lost, model->channel_count);
    hewn_model_destroy(&read);
}

static void test_random_models_keep_every_bit(void **state)
{
    (void)state;
    random_state random = {41};
    int rounds = getenv("HEWN_LONG") ? 5000 : 200;
    for (int round = 0; round < rounds; round++) {
        hewn_model model = random_polygons(&random, round % 2 == 0);
        add_random_channels(&model, &random);
        check_round_trip(&model);
        hewn_model_destroy(&model);
    }
}

static void test_positions_are_as_narrow_as_they_can_be(void **state)
{
    (void)state;
    random_state random = {7};
    for (int floats = 0; floats <= 1; floats++) {
        hewn_model model = random_polygons(&random, floats != 0);
        char *text = written_text(&model, "ply");
        assert_true((strstr(text, "property float x\n") != NULL) == (floats != 0));
        assert_true((strstr(text, "property double x\n") != NULL) == (floats == 0));
        hewn_free(text);
        hewn_model_destroy(&model);
    }
}

static void test_names_become_words(void **state)
{
    (void)state;
    static const char *const names[] = {"two words", "two_words", "line\nend", "back\\", "x", "\xc3\xa9"};
    static const char *const expected[] = {"two_words", "two_words_", "line_end", "back_", "x_", "\xc3\xa9"};
    hewn_model model = make_ring_model(4, 3, 0);
    for (uint32_t i = 0; i < 6; i++)
        ((int32_t *)add_channel(&model, names[i], HEWN_DOMAIN_VERT, HEWN_SCALAR_INT32, 1)->values)[2] = (int32_t)i + 1;
    int32_t value;
    assert_int_equal(hewn_channel_value(&model.channels[0], " a = b\\", &value, NULL), HEWN_OK);
    assert_int_equal(hewn_channel_value(&model.channels[0], "", &value, NULL), HEWN_OK);
    assert_int_equal(hewn_channel_value(&model.channels[0], "c\nd", &value, NULL), HEWN_OK);
    hewn_model read = through_file(&model, "ply");
    assert_int_equal(read.channel_count, 6);
    for (uint32_t i = 0; i < 6; i++) {
        assert_string_equal(read.channels[i].info.name, expected[i]);
        assert_int_equal(((int32_t *)read.channels[i].values)[2], i + 1);
    }
    assert_int_equal(read.channels[0].name_count, 3);
    assert_string_equal(read.channels[0].names[0], " a = b\\");
    assert_string_equal(read.channels[0].names[1], "");
    assert_string_equal(read.channels[0].names[2], "c d");
    hewn_model_destroy(&read);
    hewn_model_destroy(&model);
}

static void test_unit_and_axes(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(5, 4, 2);
    const hewn_unit *unit;
    for (size_t i = 0; (unit = hewn_unit_at(i)); i++)
        for (int up = HEWN_AXIS_PLUS_Y; up <= HEWN_AXIS_PLUS_X; up++) {
            model.unit = unit;
            model.up = (hewn_axis)up;
            model.up_known = true;
            hewn_model read = through_file(&model, "ply");
            assert_ptr_equal(read.unit, unit);
            assert_int_equal(read.up, up);
            assert_true(read.up_known);
            hewn_model_destroy(&read);
        }
    for (int known = 0; known < 4; known++) { /* what is not known stays so */
        model.unit = known & 1 ? hewn_unit_find("in") : NULL;
        model.up = known & 2 ? HEWN_AXIS_PLUS_X : HEWN_AXIS_PLUS_Y;
        model.up_known = (known & 2) != 0;
        hewn_model read = through_file(&model, "ply");
        assert_ptr_equal(read.unit, model.unit);
        assert_int_equal(read.up, model.up);
        assert_int_equal(read.up_known, model.up_known);
        hewn_model_destroy(&read);
    }
    hewn_model_destroy(&model);
    static const char *const others[] = {"comment 1 unit = 0.002 m, +Z up\n",
                                         "comment 1 unit = 0.001 m, -Z up\n",
                                         "comment 1 unit = 0.001 m, +Z\n",
                                         "comment 1 unit = x m, +Z up\n",
                                         "comment 1 unit = 0.001",
                                         "obj_info 1 unit = 1e999 m, +Z up\n"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        char text[256];
        snprintf(text, sizeof text, "ply\nformat ascii 1.0\n%s\nend_header\n", others[i]);
        model = read_text(hewn_ply_read, text);
        assert_null(model.unit);
        assert_false(model.up_known);
        hewn_model_destroy(&model);
    }
}

static bool count_down(void *user, const char *stage, double fraction)
{
    assert_true(strcmp(stage, "load") == 0 || strcmp(stage, "write") == 0);
    assert_true(fraction >= 0 && fraction <= 1 + 1e-12);
    return (*(int *)user)-- > 0;
}

static void test_cancelling(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(300, 100, 0), read;
    char folder[64], path[96];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/mesh.ply", folder);
    write_model(&model, path, NULL);
    for (int allowed = 0;; allowed++) {
        int left = allowed;
        hewn_progress progress = {count_down, &left};
        hewn_result result = hewn_model_read(path, &(hewn_read_desc){.progress = &progress}, &read, NULL);
        if (result == HEWN_OK) {
            assert_true(allowed > 6);
            assert_same_model(&model, &read);
            break;
        }
        assert_int_equal(result, HEWN_CANCELLED);
        assert_null(read.positions);
    }
    unlink(path);
    rmdir(folder);
    hewn_model_destroy(&read);
    hewn_model_destroy(&model);
}

/* --- files of the test data --------------------------------------------------------------------------------------- */

static void check_data_file(const char *path, const char *statistics)
{
    hewn_model model = read_model(path);
    bool same = (long long)model.vertex_count == statistic(statistics, "V=") &&
                (long long)model.face_count == statistic(statistics, "F=");
    if (!same)
        fail_msg("%s: %llu vertices, %llu faces; %s", path, (unsigned long long)model.vertex_count,
                 (unsigned long long)model.face_count, statistics);
    assert_true((hewn_model_find_channel(&model, HEWN_DOMAIN_VERT, "normal") != NULL) ==
                (statistic(statistics, "normals=") == 1));
    hewn_model again = through_file(&model, "ply");
    assert_same_model(&model, &again);
    hewn_model_destroy(&again);
    hewn_model_destroy(&model);
}

static void test_data_round_trips(void **state)
{
    (void)state;
    static const char *const folders[] = {"mesh-scan", "mesh-misc", "malformed"};
    int checked = for_each_statistic(folders, 3, "ply", check_data_file);
    if (checked < 0)
        skip();
    assert_true(checked >= 14);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_models_keep_every_bit),
        cmocka_unit_test(test_positions_are_as_narrow_as_they_can_be),
        cmocka_unit_test(test_names_become_words),
        cmocka_unit_test(test_unit_and_axes),
        cmocka_unit_test(test_cancelling),
        cmocka_unit_test(test_data_round_trips),
    };
    return cmocka_run_group_tests_name("ply_write", tests, NULL, NULL);
}
