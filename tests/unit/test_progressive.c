/* Progressive meshes: every mesh on the way is sound, the last one is the input bit for bit, files survive anything. */
#include "hewn/check.h"
#include "hewn/distance.h"
#include "hewn/progressive.h"
#include "test_smooth_support.h"

/* --- calls and what must hold ------------------------------------------------------------------------------------- */

static hewn_progressive *make_progressive(const hewn_model *model, const hewn_progressive_desc *desc)
{
    hewn_error error = {0};
    hewn_progressive *made;
    if (hewn_progressive_make(model, desc, &made, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return made;
}

static hewn_model model_at(const hewn_progressive *from, uint64_t splits)
{
    hewn_error error = {0};
    hewn_model model;
    if (hewn_progressive_model(from, splits, &model, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    if (hewn_model_check(&model, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return model;
}

static hewn_check *check_of(const hewn_model *model)
{
    hewn_check *check;
    const hewn_polygons polygons = hewn_model_polygons(model);
    assert_int_equal(hewn_check_polygons(&polygons, &(hewn_check_desc){.skip_self_intersections = true}, &check, NULL),
                     HEWN_OK);
    return check;
}

static void assert_same_models(const hewn_model *a, const hewn_model *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->face_count, b->face_count);
    assert_int_equal(a->channel_count, b->channel_count);
    assert_true(!a->first == !b->first && a->unit == b->unit && a->up == b->up && a->up_known == b->up_known);
    if (a->first)
        assert_memory_equal(a->first, b->first, (a->face_count + 1) * sizeof *a->first);
    if (a->vertex_count > 0)
        assert_memory_equal(a->positions, b->positions, a->vertex_count * 3 * sizeof *a->positions);
    if (hewn_model_corner_count(a) > 0)
        assert_memory_equal(a->corners, b->corners, hewn_model_corner_count(a) * sizeof *a->corners);
    for (uint32_t i = 0; i < a->channel_count; i++) {
        const hewn_channel *mine = &a->channels[i], *other = &b->channels[i];
        assert_string_equal(mine->info.name, other->info.name);
        assert_true(mine->info.domain == other->info.domain && mine->info.scalar == other->info.scalar);
        assert_int_equal(mine->info.components, other->info.components);
        assert_int_equal(mine->name_count, other->name_count);
        for (uint32_t n = 0; n < mine->name_count; n++)
            assert_string_equal(mine->names[n], other->names[n]);
        if (channel_bytes(a, mine) > 0)
            assert_memory_equal(mine->values, other->values, channel_bytes(a, mine));
    }
}

typedef struct bytes {
    char *at;
    size_t length;
} bytes;

static bytes encode(const hewn_progressive *from)
{
    bytes out;
    assert_int_equal(hewn_progressive_encode(from, &out.at, &out.length, NULL), HEWN_OK);
    return out;
}

static hewn_progressive *decode(const char *at, size_t length, bool partial)
{
    hewn_error error = {0};
    hewn_progressive *made;
    if (hewn_progressive_decode(at, length, "test", partial, &made, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return made;
}

/* In memory and through a file, all splits give the model; returns the one that was read, of the other's bytes. */
static hewn_progressive *assert_comes_back(const hewn_model *model, hewn_progressive *made)
{
    hewn_model all = model_at(made, hewn_progressive_about(made).splits);
    assert_same_models(model, &all);
    hewn_model_destroy(&all);
    bytes file = encode(made);
    hewn_progressive *read = decode(file.at, file.length, false);
    bytes again = encode(read);
    assert_int_equal(file.length, again.length);
    assert_memory_equal(file.at, again.at, file.length);
    all = model_at(read, hewn_progressive_about(read).splits);
    assert_same_models(model, &all);
    hewn_model_destroy(&all);
    hewn_progressive_bytes_free(file.at);
    hewn_progressive_bytes_free(again.at);
    return read;
}

/* --- shapes ------------------------------------------------------------------------------------------------------- */

/* A square of n × n cells in z = a bump, open. */
static hewn_model make_sheet(uint32_t n)
{
    hewn_model model = make_model((n + 1ull) * (n + 1), 2ull * n * n, 6ull * n * n, false);
    for (uint32_t v = 0; v < (n + 1) * (n + 1); v++) {
        double *at = model.positions + 3 * (size_t)v;
        at[0] = (double)(v % (n + 1)) / n;
        at[1] = (double)(v / (n + 1)) / n;
        at[2] = 0.1 * sin(M_PI * at[0]) * sin(2 * M_PI * at[1]);
    }
    for (uint32_t j = 0, c = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++, c += 6) {
            uint32_t a = j * (n + 1) + i, b = a + 1, d = a + n + 1, e = d + 1, corners[] = {a, b, e, a, e, d};
            memcpy(model.corners + c, corners, sizeof corners);
        }
    return model;
}

static hewn_model make_shape(int shape, random_state *random)
{
    hewn_model model = shape == 0   ? make_sphere(24, 2)
                       : shape == 1 ? make_ring_model(40, 30, 3)
                       : shape == 2 ? make_sheet(30)
                                    : model_of(join_meshes(make_torus(30, 20), make_torus(24, 12), 20));
    if (shape != 2)
        add_noise(&model, 1e-3, random);
    return model;
}

/* On the way, topology is that of the input, and so are triangles' counts what was announced. */
static void test_every_mesh_on_the_way_is_sound(void **state)
{
    (void)state;
    random_state random = {11};
    for (int shape = 0; shape < 4; shape++) {
        hewn_model model = make_shape(shape, &random);
        hewn_progressive *made = make_progressive(&model, NULL);
        hewn_progressive *read = assert_comes_back(&model, made);
        const hewn_progressive_info info = hewn_progressive_about(read);
        assert_true(info.complete && info.splits_there == info.splits);
        assert_true(info.base_triangles < info.triangles / 10);
        hewn_check *whole = check_of(&model);
        const uint64_t step = info.splits / 40 + 1;
        for (uint64_t splits = 0; splits <= info.splits; splits += splits < 30 ? 1 : step) {
            hewn_model part = model_at(read, splits);
            hewn_check *check = check_of(&part);
            assert_int_equal(part.face_count,
                             splits < info.splits ? hewn_progressive_triangles_at(read, splits) : info.faces);
            assert_true(check->certificate.manifold && check->certificate.oriented);
            assert_int_equal(check->certificate.closed, whole->certificate.closed);
            assert_int_equal(check->euler, whole->euler);
            assert_int_equal(check->certificate.components, whole->certificate.components);
            assert_int_equal(check->boundary_loops, whole->boundary_loops);
            assert_int_equal(check->duplicate_faces, 0);
            assert_int_equal(check->isolated_vertices, 0);
            hewn_check_destroy(&check);
            hewn_model_destroy(&part);
        }
        hewn_check_destroy(&whole);
        hewn_progressive_destroy(&made);
        hewn_progressive_destroy(&read);
        hewn_model_destroy(&model);
    }
}

/* --- attributes --------------------------------------------------------------------------------------------------- */

/* Random bits at every corner leave nothing to fold; values that are of vertices, of parts and of faces do. */
static void test_attributes_come_back(void **state)
{
    (void)state;
    random_state random = {12};
    for (int kind = 0; kind < 4; kind++) {
        hewn_model model = kind % 2 ? make_ring_model(20, 16, 3) : make_sphere(12, 1);
        model.unit = kind < 2 ? hewn_unit_find("mm") : NULL;
        model.up = HEWN_AXIS_PLUS_Z;
        model.up_known = kind == 1;
        if (kind >= 2) {
            add_every_channel(&model, &random);
        } else {
            float *uv = add_channel(&model, "uv", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 2)->values;
            uint8_t *color = add_channel(&model, "color", HEWN_DOMAIN_VERT, HEWN_SCALAR_UINT8, 3)->values;
            int32_t *label = add_channel(&model, "label", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1)->values;
            for (uint64_t f = 0, c = 0; f < model.face_count; f++) {
                label[f] = f < model.face_count / 2;
                for (; c < (model.first ? model.first[f + 1] : 3 * (f + 1)); c++) { /* a seam between the labels */
                    uv[2 * c] = (float)model.positions[3 * (size_t)model.corners[c]] + (float)(10 * label[f]);
                    uv[2 * c + 1] = (float)model.positions[3 * (size_t)model.corners[c] + 1];
                }
            }
            for (uint64_t i = 0; i < 3 * model.vertex_count; i++)
                color[i] = (uint8_t)random_bits(&random);
        }
        hewn_progressive *made = make_progressive(&model, NULL), *read = assert_comes_back(&model, made);
        const hewn_progressive_info info = hewn_progressive_about(read);
        assert_true(kind >= 2 || info.base_triangles < info.triangles / 2);
        for (uint64_t splits = 0; splits <= info.splits; splits += info.splits / 7 + 1) {
            hewn_model part = model_at(read, splits);
            const hewn_channel *uv = hewn_model_find_channel(&part, HEWN_DOMAIN_CORNER, "uv");
            const hewn_channel *label = hewn_model_find_channel(&part, HEWN_DOMAIN_FACE, "label");
            for (uint64_t c = 0; uv && !part.first && c < 3 * part.face_count; c++) { /* values are where they were */
                const float *at = (const float *)uv->values + 2 * c;
                const double *p = part.positions + 3 * (size_t)part.corners[c];
                assert_true(at[0] == (float)p[0] + (float)(10 * ((const int32_t *)label->values)[c / 3]));
                assert_true(at[1] == (float)p[1]);
            }
            hewn_model_destroy(&part);
        }
        hewn_progressive_destroy(&made);
        hewn_progressive_destroy(&read);
        hewn_model_destroy(&model);
    }
}

/* Two halves of a sheet with labels of their own: neither goes, and the line between them stays one line. */
static void test_labels_stay(void **state)
{
    (void)state;
    hewn_model model = make_sheet(20);
    int32_t *label = add_channel(&model, "label", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1)->values;
    for (uint64_t f = 0; f < model.face_count; f++)
        label[f] = f < model.face_count / 2 ? 5 : 7;
    hewn_progressive *made = make_progressive(&model, NULL);
    const uint64_t splits = hewn_progressive_about(made).splits;
    assert_true(hewn_progressive_about(made).base_triangles < 20);
    for (uint64_t i = 0; i <= splits; i += i < 20 ? 1 : 17) {
        hewn_model part = model_at(made, i), half = part;
        const hewn_channel *channel = hewn_model_find_channel(&part, HEWN_DOMAIN_FACE, "label");
        for (int side = 0; side < 2; side++) {
            uint32_t *corners = hewn_alloc(3 * part.face_count, sizeof *corners);
            half.corners = corners;
            half.face_count = 0;
            for (uint64_t f = 0; f < part.face_count; f++)
                if (((const int32_t *)channel->values)[f] == 5 + 2 * side)
                    memcpy(corners + 3 * half.face_count++, part.corners + 3 * f, 3 * sizeof *corners);
            assert_true(half.face_count > 0);
            hewn_check *check = check_of(&half);
            assert_int_equal(check->certificate.components, 1);
            assert_int_equal(check->boundary_loops, 1);
            assert_true(check->certificate.manifold);
            hewn_check_destroy(&check);
            hewn_free(corners);
        }
        hewn_model_destroy(&part);
    }
    hewn_progressive_destroy(&made);
    hewn_model_destroy(&model);
}

/* --- soups -------------------------------------------------------------------------------------------------------- */

/* What is not manifold, names a vertex twice or has no face comes back all the same. */
static void test_soups_come_back(void **state)
{
    (void)state;
    random_state random = {13};
    for (int round = 0; round < 60; round++) {
        const bool polygons = round % 2;
        const uint64_t vertices = 1 + random_below(&random, 30), faces = random_below(&random, 60);
        hewn_model model = make_model(vertices, faces, 6 * faces, polygons);
        for (uint64_t i = 0; i < 3 * vertices; i++)
            model.positions[i] = (double)random_below(&random, 4);
        for (uint64_t f = 0, c = 0; f < faces; f++) {
            for (uint64_t end = c + (polygons ? random_below(&random, 7) : 3); c < end; c++)
                model.corners[c] = random_below(&random, (uint32_t)vertices);
            if (polygons)
                model.first[f + 1] = c;
        }
        if (round % 5 == 0)
            add_every_channel(&model, &random);
        hewn_progressive *made = make_progressive(&model, NULL), *read = assert_comes_back(&model, made);
        for (uint64_t splits = 0; splits <= hewn_progressive_about(read).splits; splits++) {
            hewn_model part = model_at(read, splits);
            hewn_model_destroy(&part);
        }
        hewn_progressive_destroy(&made);
        hewn_progressive_destroy(&read);
        hewn_model_destroy(&model);
    }
}

/* --- targets, marks, geomorphs ------------------------------------------------------------------------------------ */

static void test_targets_and_marks(void **state)
{
    (void)state;
    random_state random = {14};
    hewn_model model = make_shape(0, &random);
    hewn_progressive *made = make_progressive(&model, &(hewn_progressive_desc){.faces = 500, .measure = true});
    const hewn_progressive_info info = hewn_progressive_about(made);
    assert_true(info.base_triangles <= 500 && info.base_triangles > 490);
    for (uint64_t triangles = 0; triangles < info.triangles + 100; triangles += 97) {
        const uint64_t splits = hewn_progressive_splits_for(made, triangles);
        assert_true(splits == 0 || hewn_progressive_triangles_at(made, splits) <= triangles);
        assert_true(splits == info.splits || hewn_progressive_triangles_at(made, splits + 1) > triangles);
    }
    assert_true(info.mark_count >= 3);
    assert_true(info.marks[info.mark_count - 1].error == 0);
    for (uint32_t i = 0; i < info.mark_count; i++) {
        hewn_model part = model_at(made, info.marks[i].splits);
        hewn_distance distance;
        const hewn_polygons one = hewn_model_polygons(&part), two = hewn_model_polygons(&model);
        assert_int_equal(hewn_polygons_distance(&one, &two, NULL, &distance, NULL), HEWN_OK);
        assert_true(distance.low <= info.marks[i].error && info.marks[i].error_low <= distance.high);
        assert_true(hewn_progressive_splits_within(made, info.marks[i].error) <= info.marks[i].splits);
        hewn_model_destroy(&part);
    }
    assert_int_equal(hewn_progressive_splits_within(made, 0), info.splits);
    hewn_model none;
    assert_int_equal(hewn_progressive_model(made, info.splits + 1, &none, NULL), HEWN_INVALID_ARGUMENT);
    hewn_progressive_destroy(&made);
    hewn_model_destroy(&model);
}

/* Moved to its ancestors the fine mesh has the coarse one's triangles, and others without area. */
static void test_geomorphs(void **state)
{
    (void)state;
    random_state random = {15};
    hewn_model model = make_shape(3, &random);
    hewn_progressive *made = make_progressive(&model, NULL);
    const uint64_t all = hewn_progressive_about(made).splits;
    for (int step = 0; step < 6; step++) {
        const uint64_t coarse = all * (uint64_t)step / 8, fine = step == 5 ? all : coarse + all / 10;
        hewn_model low = model_at(made, coarse), high;
        uint32_t *ancestors;
        assert_int_equal(hewn_progressive_geomorph(made, coarse, fine, &high, &ancestors, NULL), HEWN_OK);
        uint64_t left = 0;
        for (uint64_t t = 0; t < high.face_count; t++) {
            uint32_t v[3];
            for (size_t k = 0; k < 3; k++)
                v[k] = ancestors[high.corners[3 * t + k]];
            const bool flat = v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
            assert_int_equal(flat, t >= low.face_count);
            if (!flat)
                assert_memory_equal(v, low.corners + 3 * t, sizeof v);
            left += !flat;
        }
        assert_int_equal(left, low.face_count);
        assert_memory_equal(high.positions, low.positions, low.vertex_count * 3 * sizeof(double));
        hewn_progressive_ancestors_free(ancestors);
        hewn_model_destroy(&low);
        hewn_model_destroy(&high);
    }
    hewn_progressive_destroy(&made);
    hewn_model_destroy(&model);
}

/* --- files -------------------------------------------------------------------------------------------------------- */

/* However much of a file is there, what was whole can be had, and it is what the whole has at that point. */
static void test_files_that_are_cut_off(void **state)
{
    (void)state;
    random_state random = {16};
    hewn_model model = make_shape(0, &random);
    hewn_progressive *made = make_progressive(&model, NULL), *read;
    bytes file = encode(made);
    uint64_t last = 0;
    bool based = false;
    for (size_t length = 0; length < file.length; length += 1 + file.length / 60) {
        hewn_error error = {0};
        assert_int_equal(hewn_progressive_decode(file.at, length, "test", false, &read, &error), HEWN_BAD_INPUT);
        assert_null(read);
        assert_string_equal(error.file, "test");
        if (hewn_progressive_decode(file.at, length, "test", true, &read, &error) != HEWN_OK) {
            assert_false(based);
            continue;
        }
        based = true;
        const hewn_progressive_info info = hewn_progressive_about(read);
        assert_false(info.complete);
        assert_true(info.splits_there >= last && info.splits_there <= info.splits);
        last = info.splits_there;
        hewn_model part = model_at(read, last);
        if (last < info.splits) {
            hewn_model same = model_at(made, last);
            assert_same_models(&same, &part);
            hewn_model_destroy(&same);
        }
        hewn_model_destroy(&part);
        hewn_progressive_destroy(&read);
    }
    assert_true(based && last > 0);
    hewn_progressive_bytes_free(file.at);
    hewn_progressive_destroy(&made);
    hewn_model_destroy(&model);
}

static void test_damage_is_noticed(void **state)
{
    (void)state;
    random_state random = {17};
    hewn_model model = make_sphere(6, 1);
    hewn_progressive *made = make_progressive(&model, NULL), *read;
    bytes file = encode(made);
    for (size_t at = 0; at < file.length; at++) {
        hewn_error error = {0};
        const char was = file.at[at];
        file.at[at] = (char)(was ^ (1 << random_below(&random, 8)));
        assert_int_equal(hewn_progressive_decode(file.at, file.length, "test", false, &read, &error), HEWN_BAD_INPUT);
        assert_null(read);
        assert_true(error.message[0] != '\0');
        file.at[at] = was;
    }
    hewn_progressive_bytes_free(file.at);
    hewn_progressive_destroy(&made);
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_mesh_on_the_way_is_sound),
        cmocka_unit_test(test_attributes_come_back),
        cmocka_unit_test(test_labels_stay),
        cmocka_unit_test(test_soups_come_back),
        cmocka_unit_test(test_targets_and_marks),
        cmocka_unit_test(test_geomorphs),
        cmocka_unit_test(test_files_that_are_cut_off),
        cmocka_unit_test(test_damage_is_noticed),
    };
    return cmocka_run_group_tests_name("progressive", tests, NULL, NULL);
}
