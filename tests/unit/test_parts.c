/* Mesh files that are read in parts: put together, these are what the reader of the whole file makes. */
#include "base/text.h"
#include "io/parts.h"
#include "io_support.h"

/* Parts put together. */
typedef struct whole_model {
    hewn_model model;
    uint64_t corner_count;
    int parts;
} whole_model;

static void *append(void *items, size_t before, const void *more, size_t bytes)
{
    items = hewn_realloc(items, before + bytes, 1);
    assert_non_null(items);
    if (bytes > 0)
        memcpy((char *)items + before, more, bytes);
    return items;
}

/* Values of a part whose names have other numbers get those of the whole. */
static void append_channels(hewn_model *whole, hewn_model *part, const uint64_t before[3])
{
    for (uint32_t i = 0; i < part->channel_count; i++) {
        hewn_channel *from = &part->channels[i];
        hewn_error error = {0};
        hewn_channel *to = hewn_model_find_channel(whole, from->info.domain, from->info.name);
        const size_t size = from->info.components * hewn_scalar_size(from->info.scalar);
        if (!to) {
            assert_int_equal(before[from->info.domain], 0);
            assert_int_equal(hewn_model_add_channel(whole, &from->info, &to, &error), HEWN_OK);
        }
        assert_int_equal(to->info.scalar, from->info.scalar);
        assert_int_equal(to->info.components, from->info.components);
        for (uint64_t k = 0; from->name_count > 0 && k < hewn_model_domain_count(part, from->info.domain); k++) {
            int32_t *value = (int32_t *)from->values + k;
            if (*value >= 0 && (uint32_t)*value < from->name_count)
                assert_int_equal(hewn_channel_value(to, from->names[*value], value, &error), HEWN_OK);
        }
        to->values = append(to->values, before[from->info.domain] * size, from->values, channel_bytes(part, from));
    }
}

static hewn_result take(void *user, hewn_model *part, hewn_error *error)
{
    whole_model *whole = user;
    hewn_model *model = &whole->model;
    const uint64_t corners = hewn_model_corner_count(part);
    const uint64_t before[3] = {[HEWN_DOMAIN_VERT] = model->vertex_count,
                                [HEWN_DOMAIN_CORNER] = whole->corner_count,
                                [HEWN_DOMAIN_FACE] = model->face_count};
    (void)error;
    append_channels(model, part, before);
    model->positions = append(model->positions, 24 * model->vertex_count, part->positions, 24 * part->vertex_count);
    model->corners = append(model->corners, 4 * whole->corner_count, part->corners, 4 * corners);
    model->first = append(model->first, 8 * model->face_count, NULL, 0);
    model->first = hewn_realloc(model->first, model->face_count + part->face_count + 1, sizeof *model->first);
    assert_non_null(model->first);
    for (uint64_t f = 0; f <= part->face_count; f++)
        model->first[model->face_count + f] = whole->corner_count + first_of(part, f);
    model->vertex_count += part->vertex_count;
    model->face_count += part->face_count;
    whole->corner_count += corners;
    whole->parts++;
    return HEWN_OK;
}

static void write_file(const char *path, const void *bytes, size_t length)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    fclose(file);
}

/* Reads the file both ways; the caller destroys both. */
static void read_both(const char *path, hewn_model *parts, hewn_model *all, int least_parts)
{
    hewn_error error = {0};
    whole_model whole = {0};
    hewn_model about;
    const hewn_part_taker taker = {.take = take, .user = &whole, .memory = UINT64_MAX};
    if (hewn_model_read_parts(path, &(hewn_read_desc){0}, &taker, &about, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    if (hewn_model_read(path, NULL, all, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    assert_true(whole.parts >= least_parts);
    assert_ptr_equal(about.unit, all->unit);
    assert_int_equal(about.up_known, all->up_known);
    whole.model.unit = about.unit;
    whole.model.up = about.up;
    whole.model.up_known = about.up_known;
    *parts = whole.model;
}

/* Polygons, positions and channels, whatever the domain of corners' values. */
static void assert_same_polygons(const hewn_model *a, const hewn_model *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->face_count, b->face_count);
    assert_memory_equal(a->positions, b->positions, 24 * a->vertex_count);
    for (uint64_t f = 0; f <= a->face_count; f++)
        assert_int_equal(first_of(a, f), first_of(b, f));
    assert_memory_equal(a->corners, b->corners, 4 * hewn_model_corner_count(a));
    assert_int_equal(a->channel_count, b->channel_count);
    for (uint32_t i = 0; i < a->channel_count; i++)
        assert_same_channel(a, &a->channels[i], b);
}

/* A ring of quadrilaterals and triangles with values in every domain. */
static hewn_model make_ring(void)
{
    hewn_model model = make_ring_model(200, 100, 3);
    random_state random = {4};
    hewn_channel *color = add_channel(&model, "color", HEWN_DOMAIN_VERT, HEWN_SCALAR_UINT8, 3);
    for (uint64_t i = 0; i < 3 * model.vertex_count; i++)
        ((uint8_t *)color->values)[i] = (uint8_t)random_below(&random, 256);
    hewn_channel *uv = add_channel(&model, "uv", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 2);
    for (uint64_t i = 0; i < 2 * hewn_model_corner_count(&model); i++)
        ((float *)uv->values)[i] = (float)random_unit(&random);
    hewn_channel *material = add_channel(&model, "material", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1);
    for (uint64_t f = 0; f < model.face_count; f++) {
        static const char *const names[] = {"wood", "iron", "old gold"};
        hewn_error error = {0};
        const uint64_t which = f < 9000 ? f / 1000 % 2 : f / 5000 % 3;
        assert_int_equal(hewn_channel_value(material, names[which], (int32_t *)material->values + f, &error), HEWN_OK);
    }
    model.unit = hewn_unit_find("mm");
    model.up = HEWN_AXIS_PLUS_Z;
    model.up_known = true;
    return model;
}

static void test_ply_and_obj(void **state)
{
    (void)state;
    static const char *const names[] = {"ring.ply", "ring.obj"};
    char folder[64], path[128];
    make_folder(folder);
    hewn_model ring = make_ring();
    for (int i = 0; i < 2; i++) {
        hewn_model parts, all;
        hewn_error error = {0};
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        if (hewn_model_write(&ring, path, NULL, &error) != HEWN_OK)
            fail_msg("%s", error.message);
        read_both(path, &parts, &all, 4);
        assert_true(parts.channel_count >= 3);
        assert_same_polygons(&parts, &all);
        hewn_model_destroy(&parts);
        hewn_model_destroy(&all);
        unlink(path);
    }
    hewn_model_destroy(&ring);
    rmdir(folder);
}

/* Numbers counted from the end, vertices that come later, labels that go on, and statements of several lines. */
static void test_obj_of_every_kind(void **state)
{
    (void)state;
    char folder[64], path[128];
    hewn_text text = {0};
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.obj", folder);
    hewn_text_append(&text, "# 1 unit = 0.001 m, +Z up\no first thing\n");
    for (int i = 0; i < 20000; i++) {
        hewn_text_print(&text, "v %d.5 %d %d\n", i, i % 7, i % 11);
        if (i % 1000 == 5)
            hewn_text_print(&text, "g part %d\ns %d\n", i % 3000, i % 2000 == 5);
        if (i == 15000)
            hewn_text_append(&text, "usemtl gold\n");
        if (i >= 3 && i % 2)
            hewn_text_append(&text, "f -1 -2 \\\n -3\n");
        else if (i >= 3)
            hewn_text_print(&text, "f %d %d %d %d\n", i + 1, i, i - 1, i == 40 ? 20000 : i - 2);
    }
    assert_int_equal(hewn_text_status(&text, NULL), HEWN_OK);
    write_file(path, text.bytes, text.length);
    hewn_model parts, all;
    read_both(path, &parts, &all, 3);
    assert_same_polygons(&parts, &all);
    assert_non_null(hewn_model_find_channel(&parts, HEWN_DOMAIN_FACE, "material"));
    hewn_model_destroy(&parts);
    hewn_model_destroy(&all);
    hewn_text_clear(&text);
    unlink(path);
    rmdir(folder);
}

/* Facets come with corners of their own. */
static void test_stl(void **state)
{
    (void)state;
    char folder[64], path[128];
    hewn_error error = {0};
    hewn_model parts, all, ring = make_ring();
    make_folder(folder);
    snprintf(path, sizeof path, "%s/ring.stl", folder);
    assert_int_equal(hewn_model_write(&ring, path, NULL, &error), HEWN_OK);
    read_both(path, &parts, &all, 2);
    assert_int_equal(parts.face_count, all.face_count);
    assert_int_equal(parts.vertex_count, 3 * all.face_count);
    for (uint64_t c = 0; c < parts.vertex_count; c++)
        for (int axis = 0; axis < 3; axis++)
            assert_true(parts.positions[3 * c + axis] == all.positions[3 * (size_t)all.corners[c] + axis]);
    hewn_model_destroy(&ring);
    hewn_model_destroy(&parts);
    hewn_model_destroy(&all);
    unlink(path);
    rmdir(folder);
}

/* Files that lie say so as always; what cannot be read in parts is refused. */
static void test_bad_files(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text;
        hewn_result result;
    } cases[] = {
        {"a.ply", "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nend_header\n1\n", HEWN_BAD_INPUT},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
         "end_header\n1 2 x\n",
         HEWN_BAD_INPUT},
        {"a.obj", "v 0 0 0\nf 1 2 3\n", HEWN_BAD_INPUT},
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/3 3/1\nvt 1 1\n", HEWN_LIMIT},
        {"a.obj", "v 0 0 nan\n", HEWN_BAD_INPUT},
        {"a.stl", "solid x\nendsolid x\n", HEWN_LIMIT},
        {"b.stl", "this is neither text of this format nor long enough", HEWN_BAD_INPUT},
        {"a.off", "OFF\n0 0 0\n", HEWN_LIMIT},
        {"a.ply", "\x1f\x8b\x08", HEWN_LIMIT},
        {"a.ply", "", HEWN_BAD_INPUT},
    };
    char folder[64], path[128];
    make_folder(folder);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hewn_error error = {0};
        whole_model whole = {0};
        hewn_model about;
        const hewn_part_taker taker = {.take = take, .user = &whole, .memory = UINT64_MAX};
        snprintf(path, sizeof path, "%s/%s", folder, cases[i].name);
        write_file(path, cases[i].text, strlen(cases[i].text));
        hewn_result result = hewn_model_read_parts(path, &(hewn_read_desc){0}, &taker, &about, &error);
        if (result != cases[i].result || !error.message[0])
            fail_msg("case %zu: result %d, \"%s\"", i, result, error.message);
        hewn_model_destroy(&whole.model);
        unlink(path);
        assert_int_equal(hewn_model_read_parts(path, &(hewn_read_desc){0}, &taker, &about, &error),
                         i == 7 ? HEWN_LIMIT : HEWN_BAD_INPUT); /* it is not there */
    }
    rmdir(folder);
}

/* Texture coordinates that come long after the faces that name them cannot be put together with these in parts. */
static void test_values_that_come_later(void **state)
{
    (void)state;
    char folder[64], path[128];
    hewn_text text = {0};
    hewn_error error = {0};
    whole_model whole = {0};
    hewn_model about;
    const hewn_part_taker taker = {.take = take, .user = &whole, .memory = UINT64_MAX};
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.obj", folder);
    hewn_text_append(&text, "vt 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/2 3/1\n");
    for (int i = 0; i < 20000; i++)
        hewn_text_append(&text, "v 1 2 3\n");
    hewn_text_append(&text, "vt 1 1\n");
    write_file(path, text.bytes, text.length);
    assert_int_equal(hewn_model_read_parts(path, &(hewn_read_desc){0}, &taker, &about, &error), HEWN_LIMIT);
    assert_int_equal(error.line, 5);
    hewn_model_destroy(&whole.model);
    hewn_text_clear(&text);
    unlink(path);
    rmdir(folder);
}

/* Texture coordinates are kept for faces to come, and must fit. */
static void test_memory_for_values(void **state)
{
    (void)state;
    char folder[64], path[128];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.obj", folder);
    const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 1\nf 1/1 2/2 3/1\n";
    write_file(path, text, strlen(text));
    for (int skip = 0; skip < 2; skip++) {
        hewn_error error = {0};
        whole_model whole = {0};
        hewn_model about;
        const hewn_part_taker taker = {.take = take, .user = &whole, .memory = 10, .no_uvs = skip == 1};
        assert_int_equal(hewn_model_read_parts(path, &(hewn_read_desc){0}, &taker, &about, &error),
                         skip ? HEWN_OK : HEWN_OUT_OF_MEMORY);
        hewn_model_destroy(&whole.model);
    }
    unlink(path);
    rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ply_and_obj),
        cmocka_unit_test(test_obj_of_every_kind),
        cmocka_unit_test(test_stl),
        cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_values_that_come_later),
        cmocka_unit_test(test_memory_for_values),
    };
    return cmocka_run_group_tests_name("parts", tests, NULL, NULL);
}
