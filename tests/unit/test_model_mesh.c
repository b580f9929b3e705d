/* Models to half-edge meshes and back, with all that hangs on them. */
#include "test_model_support.h"

static hewn_mesh *build(const hewn_model *model, const hewn_repair_desc *repair, hewn_repair_report *report)
{
    hewn_mesh *mesh = NULL;
    hewn_error error = {0};
    if (hewn_mesh_from_model(model, repair, &mesh, report, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    if (hewn_mesh_validate(mesh, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return mesh;
}

static hewn_model back(const hewn_mesh *mesh)
{
    hewn_model model;
    hewn_error error = {0};
    if (hewn_model_from_mesh(mesh, &model, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    assert_int_equal(hewn_model_check(&model, NULL), HEWN_OK);
    return model;
}

static void assert_same_channels(const hewn_model *a, const hewn_model *b)
{
    assert_int_equal(a->channel_count, b->channel_count);
    for (uint32_t i = 0; i < a->channel_count; i++) {
        const hewn_channel *one = &a->channels[i], *two = &b->channels[i];
        assert_string_equal(one->info.name, two->info.name);
        assert_int_equal(one->info.domain, two->info.domain);
        assert_int_equal(one->info.scalar, two->info.scalar);
        assert_int_equal(one->info.components, two->info.components);
        assert_memory_equal(one->values, two->values, channel_bytes(a, one));
        assert_int_equal(one->name_count, two->name_count);
        for (uint32_t name = 0; name < one->name_count; name++)
            assert_string_equal(one->names[name], two->names[name]);
    }
}

static void assert_same_model(const hewn_model *a, const hewn_model *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->face_count, b->face_count);
    assert_memory_equal(a->positions, b->positions, a->vertex_count * 3 * sizeof *a->positions);
    for (uint64_t f = 0; f <= a->face_count; f++)
        assert_int_equal(a->first ? a->first[f] : 3 * f, b->first ? b->first[f] : 3 * f);
    assert_memory_equal(a->corners, b->corners, hewn_model_corner_count(a) * sizeof *a->corners);
    assert_same_channels(a, b);
}

static void test_round_trips(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 12; seed++) {
        random_state random = {seed};
        hewn_model model =
            make_ring_model(3 + random_below(&random, 9), 3 + random_below(&random, 9), random_below(&random, 4));
        add_every_channel(&model, &random);
        hewn_mesh *mesh = build(&model, NULL, NULL);
        hewn_model again = back(mesh);
        assert_same_model(&model, &again);
        assert_null(again.unit);
        assert_false(again.up_known);
        /* Nothing is wrong with it, so repair finds nothing to do. */
        hewn_repair_desc repair = hewn_repair_desc_default();
        hewn_repair_report report, nothing = {0};
        hewn_mesh *repaired = build(&model, &repair, &report);
        hewn_model after = back(repaired);
        assert_memory_equal(&report, &nothing, sizeof report);
        assert_same_model(&model, &after);
        hewn_model_destroy(&after);
        hewn_model_destroy(&again);
        hewn_mesh_destroy(&repaired);
        hewn_mesh_destroy(&mesh);
        hewn_model_destroy(&model);
    }
}

static void test_empty(void **state)
{
    (void)state;
    hewn_model model = {0};
    hewn_mesh *mesh = build(&model, NULL, NULL);
    hewn_model again = back(mesh);
    hewn_triangles triangles;
    assert_int_equal(again.vertex_count + again.face_count, 0);
    assert_int_equal(hewn_triangles_from_model(&model, &triangles, NULL), HEWN_OK);
    assert_int_equal(triangles.triangle_count, 0);
    hewn_triangles_destroy(&triangles);
    hewn_model_destroy(&again);
    hewn_mesh_destroy(&mesh);
}

static void test_strict_refuses(void **state)
{
    (void)state;
    hewn_model model = make_model(5, 3, 9, false);
    static const uint32_t corners[] = {0, 1, 2, 1, 0, 3, 0, 1, 4}; /* three faces at an edge */
    memcpy(model.corners, corners, sizeof corners);
    for (int v = 0; v < 5; v++)
        model.positions[3 * v + v % 3] = v + 1;
    hewn_mesh *mesh = (hewn_mesh *)&model;
    hewn_error error = {0};
    assert_int_equal(hewn_mesh_from_model(&model, NULL, &mesh, NULL, &error), HEWN_BAD_INPUT);
    assert_null(mesh);
    hewn_repair_desc strict = {.strict = true};
    hewn_repair_report report;
    assert_int_equal(hewn_mesh_from_model(&model, &strict, &mesh, &report, &error), HEWN_BAD_INPUT);
    assert_null(mesh);
    model.corners[0] = 9;
    assert_int_equal(hewn_mesh_from_model(&model, &(hewn_repair_desc){0}, &mesh, &report, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "vertex 9"));
    hewn_triangles triangles;
    assert_int_equal(hewn_triangles_from_model(&model, &triangles, &error), HEWN_BAD_INPUT);
    hewn_model_destroy(&model);
}

/* --- names of values ---------------------------------------------------------------------------------------------- */

static uint32_t find_attribute(const hewn_mesh *mesh, hewn_domain domain, const char *name)
{
    uint32_t at = 0;
    assert_true(hewn_mesh_find_attribute(mesh, domain, name, &at));
    return at;
}

/* A triangle with a face channel "group" that has these names and this value. */
static hewn_mesh *named_triangle(const char *const *names, uint32_t count, int32_t value)
{
    hewn_model model = make_model(3, 1, 3, false);
    model.positions[3] = model.positions[7] = 1;
    model.corners[1] = 1;
    model.corners[2] = 2;
    hewn_channel *channel = add_channel(&model, "group", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1);
    int32_t number;
    for (uint32_t i = 0; i < count; i++)
        assert_int_equal(hewn_channel_value(channel, names[i], &number, NULL), HEWN_OK);
    *(int32_t *)channel->values = value;
    hewn_mesh *mesh = build(&model, NULL, NULL);
    hewn_model_destroy(&model);
    return mesh;
}

static const char *group_of(const hewn_mesh *mesh, uint32_t face)
{
    uint32_t at = find_attribute(mesh, HEWN_DOMAIN_FACE, "group");
    return hewn_mesh_value_name(mesh, at, *(const int32_t *)hewn_mesh_attribute_read(mesh, at, face));
}

static void test_names(void **state)
{
    (void)state;
    static const char *const one[] = {"wood", "iron"}, *const two[] = {"iron", "wood", "glass"};
    hewn_mesh *mesh = named_triangle(one, 2, 1), *other = named_triangle(two, 3, 1), *third = named_triangle(two, 3, 2);
    hewn_mesh *copy = NULL;
    uint32_t at = find_attribute(mesh, HEWN_DOMAIN_FACE, "group");
    assert_string_equal(group_of(mesh, 0), "iron");
    assert_null(hewn_mesh_value_name(mesh, at, 2));
    assert_null(hewn_mesh_value_name(mesh, at, -1));
    assert_int_equal(hewn_mesh_append(mesh, other, NULL), HEWN_OK);
    assert_int_equal(hewn_mesh_append(mesh, third, NULL), HEWN_OK);
    assert_int_equal(hewn_mesh_append(mesh, mesh, NULL), HEWN_OK);
    static const char *const expected[] = {"iron", "wood", "glass", "iron", "wood", "glass"};
    for (uint32_t f = 0; f < 6; f++)
        assert_string_equal(group_of(mesh, f), expected[f]);
    assert_int_equal(hewn_mesh_value_name_count(mesh, at), 3);
    assert_int_equal(hewn_mesh_duplicate(mesh, &copy, NULL), HEWN_OK);
    hewn_model a = back(mesh), b = back(copy);
    assert_same_model(&a, &b);
    size_t bytes = hewn_mesh_bytes(copy);
    assert_int_equal(hewn_mesh_name_values(copy, at, NULL, 0, NULL), HEWN_OK);
    assert_true(hewn_mesh_bytes(copy) < bytes);
    assert_null(group_of(copy, 0));
    hewn_attribute_info real = {"real", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 1};
    uint32_t other_at;
    assert_int_equal(hewn_mesh_add_attribute(copy, &real, &other_at, NULL), HEWN_OK);
    assert_int_equal(hewn_mesh_name_values(copy, other_at, one, 2, NULL), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_mesh_name_values(copy, 99, one, 2, NULL), HEWN_INVALID_ARGUMENT);
    hewn_model_destroy(&a);
    hewn_model_destroy(&b);
    hewn_mesh_destroy(&copy);
    hewn_mesh_destroy(&third);
    hewn_mesh_destroy(&other);
    hewn_mesh_destroy(&mesh);
}

/* --- holes in the numbering --------------------------------------------------------------------------------------- */

/* Vertices and corners still stand where their values say; faces have a number of their own. */
static void assert_tell_tales(const hewn_model *model)
{
    const double *verts = hewn_model_find_channel(model, HEWN_DOMAIN_VERT, "where")->values;
    const double *corners = hewn_model_find_channel(model, HEWN_DOMAIN_CORNER, "where")->values;
    assert_memory_equal(verts, model->positions, model->vertex_count * 3 * sizeof *verts);
    for (uint64_t c = 0; c < hewn_model_corner_count(model); c++)
        assert_memory_equal(corners + 3 * c, model->positions + 3 * (size_t)model->corners[c], 3 * sizeof(double));
}

static void test_deleted_elements(void **state)
{
    (void)state;
    random_state random = {7};
    hewn_model model = make_ring_model(8, 7, 3);
    add_tell_tales(&model);
    hewn_mesh *mesh = build(&model, NULL, NULL);
    for (int i = 0; i < 6; i++)
        (void)hewn_mesh_delete_vert(mesh, (hewn_vert){random_below(&random, 56)}, NULL);
    hewn_model after = back(mesh);
    assert_int_equal(after.vertex_count, hewn_mesh_vert_count(mesh));
    assert_int_equal(after.face_count, hewn_mesh_face_count(mesh));
    assert_true(after.face_count < model.face_count);
    assert_tell_tales(&after);
    const int32_t *which = hewn_model_find_channel(&after, HEWN_DOMAIN_FACE, "which")->values;
    for (uint64_t f = 1; f < after.face_count; f++)
        assert_true(which[f] > which[f - 1]);
    assert_int_equal(hewn_mesh_compact(mesh, NULL), HEWN_OK);
    hewn_model compact = back(mesh);
    assert_same_model(&after, &compact);
    hewn_model_destroy(&compact);
    hewn_model_destroy(&after);
    hewn_mesh_destroy(&mesh);
    hewn_model_destroy(&model);
}

/* --- repair ------------------------------------------------------------------------------------------------------- */

/* Every face gets vertices of its own, and some run the other way. */
static hewn_model shatter(const hewn_model *whole, random_state *random, uint64_t *turned)
{
    uint64_t corners = hewn_model_corner_count(whole);
    hewn_model model = make_model(corners, whole->face_count, corners, true);
    *turned = 0;
    for (uint64_t f = 0; f < whole->face_count; f++) {
        uint64_t begin = whole->first[f], end = whole->first[f + 1];
        bool turn = random_below(random, 3) == 0;
        *turned += turn;
        model.first[f + 1] = end;
        for (uint64_t c = begin; c < end; c++) {
            uint64_t from = turn ? end - 1 - (c - begin) : c;
            memcpy(model.positions + 3 * c, whole->positions + 3 * (size_t)whole->corners[from], 3 * sizeof(double));
            model.corners[c] = (uint32_t)c;
        }
    }
    return model;
}

/* Welded and oriented again, each value is still where it was, whichever way its face runs now. */
static void test_values_follow_repair(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 10; seed++) {
        random_state random = {seed};
        uint64_t turned;
        hewn_model whole =
            make_ring_model(4 + random_below(&random, 6), 4 + random_below(&random, 6), random_below(&random, 4));
        hewn_model soup = shatter(&whole, &random, &turned);
        add_tell_tales(&soup);
        add_every_channel(&soup, &random);
        hewn_repair_desc repair = {.weld = true};
        hewn_repair_report report;
        hewn_mesh *mesh = build(&soup, &repair, &report);
        hewn_model after = back(mesh);
        assert_int_equal(after.vertex_count, whole.vertex_count);
        assert_int_equal(after.face_count, whole.face_count);
        assert_int_equal(report.turned_faces, turned < whole.face_count - turned ? turned : whole.face_count - turned);
        assert_tell_tales(&after);
        const int32_t *which = hewn_model_find_channel(&after, HEWN_DOMAIN_FACE, "which")->values;
        for (uint64_t f = 0; f < after.face_count; f++)
            assert_int_equal(which[f], f);
        hewn_model_destroy(&after);
        hewn_mesh_destroy(&mesh);
        hewn_model_destroy(&soup);
        hewn_model_destroy(&whole);
    }
}

/* The ring without a patch of a × a faces, labelled by sides: group "low" or "high" by where the face lies. */
static hewn_model torn_ring(uint32_t n, uint32_t a)
{
    hewn_model whole = make_ring_model(n, n, 0);
    uint64_t kept = 0;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            if (i < a && j < a)
                continue;
            memmove(whole.corners + 4 * kept, whole.corners + 4 * ((size_t)i * n + j), 4 * sizeof(uint32_t));
            kept++;
        }
    whole.face_count = kept;
    hewn_channel *group = add_channel(&whole, "group", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1);
    int32_t low, high;
    assert_int_equal(hewn_channel_value(group, "low", &low, NULL), HEWN_OK);
    assert_int_equal(hewn_channel_value(group, "high", &high, NULL), HEWN_OK);
    int32_t *values = group->values;
    for (uint64_t f = 0; f < kept; f++)
        values[f] = whole.positions[3 * (size_t)whole.corners[4 * f]] < 0 ? low : high;
    return whole;
}

static void fill_colours_and_normals(hewn_model *model)
{
    for (int domain = 0; domain < 2; domain++) {
        uint64_t count = hewn_model_domain_count(model, (hewn_domain)domain);
        uint8_t *color = add_channel(model, "color", (hewn_domain)domain, HEWN_SCALAR_UINT8, 3)->values;
        float *normal = add_channel(model, "normal", (hewn_domain)domain, HEWN_SCALAR_FLOAT, 3)->values;
        for (uint64_t i = 0; i < count; i++) {
            color[3 * i] = 200;
            color[3 * i + 1] = 100;
            normal[3 * i + 2] = 1;
        }
    }
}

static void test_filling_has_values(void **state)
{
    (void)state;
    hewn_model model = torn_ring(24, 5);
    fill_colours_and_normals(&model);
    hewn_repair_desc repair = {.fill_edges = 100};
    hewn_repair_report report;
    hewn_mesh *mesh = build(&model, &repair, &report);
    assert_int_equal(report.filled_holes, 1);
    assert_true(report.added_vertices > 0);
    hewn_model after = back(mesh);
    uint64_t old_faces = after.face_count - report.added_faces, old_verts = after.vertex_count - report.added_vertices;
    const int32_t *group = hewn_model_find_channel(&after, HEWN_DOMAIN_FACE, "group")->values;
    for (uint64_t f = old_faces; f < after.face_count; f++)
        assert_string_equal(hewn_model_find_channel(&after, HEWN_DOMAIN_FACE, "group")->names[group[f]], "high");
    for (int domain = 0; domain < 2; domain++) {
        uint64_t count = hewn_model_domain_count(&after, (hewn_domain)domain);
        const uint8_t *color = hewn_model_find_channel(&after, (hewn_domain)domain, "color")->values;
        const float *normal = hewn_model_find_channel(&after, (hewn_domain)domain, "normal")->values;
        uint64_t begin = domain == 0 ? old_verts : after.first ? after.first[old_faces] : 3 * old_faces;
        for (uint64_t i = 0; i < count; i++) {
            double n[3] = {(double)normal[3 * i], (double)normal[3 * i + 1], (double)normal[3 * i + 2]};
            assert_true(color[3 * i] == 200 && color[3 * i + 1] == 100 && color[3 * i + 2] == 0);
            assert_true(fabs(sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) - 1) < 1e-6);
            /* The patch lies outside at positive x: its own normals point there, not along z. */
            assert_true(i < begin ? n[2] == 1 : n[2] < 0.9999 && n[0] + n[1] + n[2] > 0.3);
        }
    }
    hewn_model_destroy(&after);
    hewn_mesh_destroy(&mesh);
    hewn_model_destroy(&model);
}

/* Inside out with normals that agree: both come right together. Normals that were right stay. */
static void test_normals_turn_with_faces(void **state)
{
    (void)state;
    for (int right = 0; right < 2; right++) {
        hewn_model model = make_ring_model(9, 8, 0);
        for (uint64_t f = 0; f < model.face_count; f++) {
            uint32_t *corner = model.corners + 4 * f, kept = corner[1];
            corner[1] = corner[3];
            corner[3] = kept;
        }
        double *verts = add_channel(&model, "normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_DOUBLE, 3)->values;
        for (uint32_t i = 0; i < 9; i++)
            for (uint32_t j = 0; j < 8; j++) {
                double u = 2 * M_PI * i / 9, v = 2 * M_PI * j / 8, sign = right ? 1 : -1;
                double normal[3] = {sign * cos(v) * cos(u), sign * cos(v) * sin(u), sign * sin(v)};
                memcpy(verts + 3 * ((size_t)i * 8 + j), normal, sizeof normal);
            }
        float *corners = add_channel(&model, "normal", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 3)->values;
        verts = hewn_model_find_channel(&model, HEWN_DOMAIN_VERT, "normal")->values;
        for (uint64_t i = 0; i < 3 * hewn_model_corner_count(&model); i++)
            corners[i] = (float)verts[3 * (size_t)model.corners[i / 3] + i % 3];
        hewn_repair_desc repair = {.outward = HEWN_OUTWARD_ALWAYS};
        hewn_repair_report report;
        hewn_mesh *mesh = build(&model, &repair, &report);
        assert_int_equal(report.turned_components, 1);
        hewn_model after = back(mesh);
        const double *turned = hewn_model_find_channel(&after, HEWN_DOMAIN_VERT, "normal")->values;
        const float *at_corners = hewn_model_find_channel(&after, HEWN_DOMAIN_CORNER, "normal")->values;
        for (uint64_t i = 0; i < 3 * model.vertex_count; i++)
            assert_true(turned[i] == (right ? verts[i] : -verts[i]));
        for (uint64_t i = 0; i < 3 * hewn_model_corner_count(&after); i++)
            assert_true(at_corners[i] == (float)turned[3 * (size_t)after.corners[i / 3] + i % 3]);
        hewn_model_destroy(&after);
        hewn_mesh_destroy(&mesh);
        hewn_model_destroy(&model);
    }
}

/* --- triangles ---------------------------------------------------------------------------------------------------- */

static double area_of(const hewn_triangles *triangles)
{
    double sum = 0;
    for (uint64_t t = 0; t < triangles->triangle_count; t++) {
        const float *a = triangles->positions + 3 * (size_t)triangles->indices[3 * t];
        const float *b = triangles->positions + 3 * (size_t)triangles->indices[3 * t + 1];
        const float *c = triangles->positions + 3 * (size_t)triangles->indices[3 * t + 2];
        double area = (double)(b[0] - a[0]) * (double)(c[1] - a[1]) - (double)(b[1] - a[1]) * (double)(c[0] - a[0]);
        assert_true(area > 0);
        sum += area / 2;
    }
    return sum;
}

/* An arrow head, whose fan from the first corner would fold over. */
static void test_concave_face(void **state)
{
    (void)state;
    static const double points[] = {0, 0, 0, 4, -3, 0, 1, 0, 0, 4, 3, 0};
    for (uint32_t turn = 0; turn < 4; turn++) {
        hewn_model model = make_model(4, 1, 4, true);
        model.first[1] = 4;
        memcpy(model.positions, points, sizeof points);
        for (uint32_t c = 0; c < 4; c++)
            model.corners[c] = (c + turn) % 4;
        hewn_triangles triangles;
        assert_int_equal(hewn_triangles_from_model(&model, &triangles, NULL), HEWN_OK);
        assert_int_equal(triangles.triangle_count, 2);
        assert_true(fabs(area_of(&triangles) - 3) < 1e-6);
        hewn_triangles_destroy(&triangles);
        hewn_model_destroy(&model);
    }
}

static void test_floats(void **state)
{
    (void)state;
    hewn_model model = make_model(3, 1, 3, false);
    model.corners[1] = 1;
    model.corners[2] = 2;
    model.positions[0] = 0.1;
    model.positions[3] = 1 + 0x1p-25;
    model.positions[7] = -0.0;
    double *normal = add_channel(&model, "normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_DOUBLE, 3)->values;
    normal[8] = 0.3;
    hewn_triangles triangles;
    assert_int_equal(hewn_triangles_from_model(&model, &triangles, NULL), HEWN_OK);
    assert_true(triangles.positions[0] == 0.1f && triangles.positions[3] == 1 && signbit(triangles.positions[7]));
    assert_true(triangles.normals && triangles.normals[8] == 0.3f);
    hewn_triangles_destroy(&triangles);
    model.positions[4] = 1e39;
    hewn_error error = {0};
    assert_int_equal(hewn_triangles_from_model(&model, &triangles, &error), HEWN_LIMIT);
    assert_non_null(strstr(error.message, "vertex 1"));
    assert_int_equal(triangles.triangle_count, 0);
    assert_null(triangles.positions);
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trips),        cmocka_unit_test(test_empty),
        cmocka_unit_test(test_strict_refuses),     cmocka_unit_test(test_names),
        cmocka_unit_test(test_deleted_elements),   cmocka_unit_test(test_values_follow_repair),
        cmocka_unit_test(test_filling_has_values), cmocka_unit_test(test_normals_turn_with_faces),
        cmocka_unit_test(test_concave_face),       cmocka_unit_test(test_floats),
    };
    return cmocka_run_group_tests_name("model_mesh", tests, NULL, NULL);
}
