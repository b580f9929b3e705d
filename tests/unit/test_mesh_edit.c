/* The operations one by one: what they do, what they refuse, and what becomes of attributes. */
#include "test_mesh_half.h"

static hewn_half find(const hewn_mesh *mesh, uint32_t from, uint32_t to)
{
    return hewn_mesh_find_half(mesh, (hewn_vert){from}, (hewn_vert){to});
}

static void test_attributes(void **state)
{
    (void)state;
    hewn_mesh *mesh = quad_cube();
    char name[] = "weight";
    uint32_t at, other;
    const hewn_attribute_info weight = {name, HEWN_DOMAIN_VERT, HEWN_SCALAR_UINT8, 2};
    assert_works(hewn_mesh_add_attribute(mesh, &weight, &at, error));
    name[0] = 'x';
    assert_string_equal(hewn_mesh_attribute(mesh, at)->name, "weight");
    name[0] = 'w';
    assert_refused(hewn_mesh_add_attribute(mesh, &weight, &other, error), HEWN_INVALID_ARGUMENT, "already");
    const hewn_attribute_info bad[] = {
        {"", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 1},  {NULL, HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 1},
        {"a", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 0}, {"a", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 17},
        {"a", (hewn_domain)7, HEWN_SCALAR_FLOAT, 1},   {"a", HEWN_DOMAIN_VERT, (hewn_scalar)9, 1}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_refused(hewn_mesh_add_attribute(mesh, &bad[i], NULL, error), HEWN_INVALID_ARGUMENT, "attribute");
    const hewn_attribute_info corner = {"weight", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 1};
    assert_works(hewn_mesh_add_attribute(mesh, &corner, &other, error));
    assert_int_equal(other, 1);
    assert_int_equal(*(const uint8_t *)hewn_mesh_attribute_read(mesh, at, 7), 0);
    assert_null(hewn_mesh_attribute_read(mesh, at, 8));
    assert_null(hewn_mesh_attribute_read(mesh, 5, 0));
    hewn_mesh_remove_attribute(mesh, at);
    assert_true(hewn_mesh_find_attribute(mesh, HEWN_DOMAIN_CORNER, "weight", &other));
    assert_int_equal(other, 0);
    assert_false(hewn_mesh_find_attribute(mesh, HEWN_DOMAIN_VERT, "weight", &other));
    hewn_mesh_destroy(&mesh);
}

/* Colours are blended and rounded, labels taken from the nearer end, normals kept at unit length. */
static void test_blending(void **state)
{
    (void)state;
    hewn_mesh *mesh = tetrahedron();
    const hewn_attribute_info infos[] = {{"color", HEWN_DOMAIN_VERT, HEWN_SCALAR_UINT8, 3},
                                         {"label", HEWN_DOMAIN_VERT, HEWN_SCALAR_INT32, 1},
                                         {"normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3}};
    for (int i = 0; i < 3; i++)
        assert_works(hewn_mesh_add_attribute(mesh, &infos[i], NULL, error));
    for (uint32_t v = 0; v < 4; v++) {
        float *normal = hewn_mesh_attribute_at(mesh, 2, v);
        memset(hewn_mesh_attribute_at(mesh, 0, v), v == 0 ? 0 : 255, 3);
        *(int32_t *)hewn_mesh_attribute_at(mesh, 1, v) = (int32_t)v + 10;
        normal[0] = v == 0;
        normal[1] = v != 0;
    }
    hewn_vert v;
    assert_works(hewn_mesh_split(mesh, find(mesh, 0, 1), 0.6, &v, error));
    assert_int_equal(*(const uint8_t *)hewn_mesh_attribute_read(mesh, 0, v.id), 153);
    assert_int_equal(*(const int32_t *)hewn_mesh_attribute_read(mesh, 1, v.id), 11);
    const float *normal = hewn_mesh_attribute_read(mesh, 2, v.id);
    assert_true(fabs((double)(normal[0] * normal[0] + normal[1] * normal[1]) - 1) < 1e-6);
    assert_true(fabs((double)(normal[1] / normal[0]) - 1.5) < 1e-5);
    hewn_mesh_destroy(&mesh);
}

/* Two faces beside the collapsed edge with different corner values: each side keeps its own. */
static void test_collapse_keeps_seams(void **state)
{
    (void)state;
    hewn_mesh *mesh = flat_grid(4, true);
    const hewn_attribute_info side = {"side", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 2};
    assert_works(hewn_mesh_add_attribute(mesh, &side, NULL, error));
    /* The seam is the column x = 2; the second number is y. */
    for (uint32_t h = 0; h < hewn_mesh_half_bound(mesh); h++) {
        hewn_half k = {h};
        if (hewn_half_face(mesh, k).id == HEWN_NONE)
            continue;
        double x = 0;
        for (int i = 0; i < 3; i++, k = hewn_half_next(mesh, k))
            x += hewn_vert_position(mesh, hewn_half_head(mesh, k))[0] / 3;
        float *value = hewn_mesh_attribute_at(mesh, 0, h);
        value[0] = x > 2;
        value[1] = (float)hewn_vert_position(mesh, hewn_half_head(mesh, (hewn_half){h}))[1];
    }
    hewn_half h = find(mesh, 12, 13);
    assert_true(hewn_mesh_can_collapse(mesh, h));
    hewn_mesh_collapse(mesh, h);
    assert_valid(mesh);
    for (uint32_t k = 0; k < hewn_mesh_half_bound(mesh); k++) {
        hewn_half at = {k};
        if (hewn_half_face(mesh, at).id == HEWN_NONE)
            continue;
        const float *value = hewn_mesh_attribute_read(mesh, 0, k);
        double x = 0;
        for (int i = 0; i < 3; i++, at = hewn_half_next(mesh, at))
            x += hewn_vert_position(mesh, hewn_half_head(mesh, at))[0] / 3;
        assert_true((value[0] != 0) == (x > 2));
        assert_true((double)value[1] == hewn_vert_position(mesh, hewn_half_head(mesh, (hewn_half){k}))[1]);
    }
    hewn_mesh_destroy(&mesh);
}

static void test_refused_collapses(void **state)
{
    (void)state;
    hewn_mesh *mesh = tetrahedron();
    for (uint32_t h = 0; h < 12; h++) {
        assert_false(hewn_mesh_can_collapse(mesh, (hewn_half){h}));
        hewn_mesh_collapse(mesh, (hewn_half){h});
        assert_false(hewn_mesh_can_flip(mesh, (hewn_half){h}));
        hewn_mesh_flip(mesh, (hewn_half){h});
    }
    assert_int_equal(hewn_mesh_face_count(mesh), 4);
    assert_false(hewn_mesh_can_collapse(mesh, HEWN_HALF_NONE));
    assert_false(hewn_mesh_can_flip(mesh, HEWN_HALF_NONE));
    hewn_mesh_destroy(&mesh);
    /* One triangle; two triangles: their inner edge joins two boundaries, the outer ones may go. */
    mesh = flat_grid(1, true);
    assert_false(hewn_mesh_can_collapse(mesh, find(mesh, 0, 3)));
    assert_true(hewn_mesh_can_collapse(mesh, find(mesh, 0, 2)));
    hewn_mesh_collapse(mesh, find(mesh, 0, 2));
    assert_valid(mesh);
    assert_int_equal(hewn_mesh_face_count(mesh), 1);
    for (uint32_t h = 0; h < hewn_mesh_half_bound(mesh); h++)
        assert_false(hewn_mesh_can_collapse(mesh, (hewn_half){h}));
    hewn_mesh_destroy(&mesh);
    /* A tube of three around: the rings must not shrink. */
    mesh = torus(3, 5);
    assert_false(hewn_mesh_can_collapse(mesh, find(mesh, 0, 5)));
    assert_true(hewn_mesh_can_collapse(mesh, find(mesh, 0, 1)));
    hewn_mesh_destroy(&mesh);
    /* Quadrilaterals: any edge of the cube. */
    mesh = quad_cube();
    hewn_mesh_collapse(mesh, find(mesh, 0, 1));
    assert_valid(mesh);
    assert_int_equal(hewn_mesh_face_count(mesh), 6);
    assert_int_equal(hewn_mesh_vert_count(mesh), 7);
    hewn_mesh_destroy(&mesh);
}

/* All triangulated spheres shrink to a tetrahedron, and no further. */
static void test_collapse_to_the_end(void **state)
{
    (void)state;
    hewn_mesh *mesh = tetrahedron();
    random_state random = {11};
    const double position[3] = {0, 0, 0};
    for (int i = 0; i < 200; i++)
        assert_works(hewn_mesh_poke(mesh, (hewn_face){random_below(&random, hewn_mesh_face_bound(mesh))}, position,
                                    NULL, error));
    for (bool more = true; more;) {
        more = false;
        for (uint32_t h = 0; h < hewn_mesh_half_bound(mesh); h++)
            if (hewn_mesh_can_collapse(mesh, (hewn_half){h})) {
                hewn_mesh_collapse(mesh, (hewn_half){h});
                more = true;
            }
        assert_valid(mesh);
    }
    assert_int_equal(hewn_mesh_face_count(mesh), 4);
    assert_int_equal(hewn_mesh_edge_count(mesh), 6);
    hewn_mesh_destroy(&mesh);
}

static void test_refused_arguments(void **state)
{
    (void)state;
    hewn_mesh *mesh = flat_grid(2, true);
    const double good[3] = {0, 0, 0}, bad[3] = {0, INFINITY, 0};
    hewn_vert v, corners[3] = {{0}, {1}, {9}};
    hewn_face f;
    assert_refused(hewn_mesh_add_vert(mesh, bad, &v, error), HEWN_INVALID_ARGUMENT, "finite");
    assert_int_equal(v.id, HEWN_NONE);
    assert_refused(hewn_mesh_add_face(mesh, corners, 3, &f, error), HEWN_INVALID_ARGUMENT, "no vertex 9");
    assert_refused(hewn_mesh_add_face(mesh, corners, 2, &f, error), HEWN_INVALID_ARGUMENT, "three corners");
    corners[2].id = 0;
    assert_refused(hewn_mesh_add_face(mesh, corners, 3, &f, error), HEWN_INVALID_ARGUMENT, "vertex 0 twice");
    hewn_vert taken[3] = {{0}, {3}, {8}};
    assert_refused(hewn_mesh_add_face(mesh, taken, 3, &f, error), HEWN_INVALID_ARGUMENT, "has a face there already");
    hewn_vert fan[3] = {{0}, {2}, {8}};
    assert_refused(hewn_mesh_add_face(mesh, fan, 3, &f, error), HEWN_INVALID_ARGUMENT, "more than one fan");
    assert_refused(hewn_mesh_delete_face(mesh, (hewn_face){8}, error), HEWN_INVALID_ARGUMENT, "no face 8");
    assert_refused(hewn_mesh_delete_vert(mesh, (hewn_vert){9}, error), HEWN_INVALID_ARGUMENT, "no vertex 9");
    assert_refused(hewn_mesh_split(mesh, HEWN_HALF_NONE, 0.5, &v, error), HEWN_INVALID_ARGUMENT, "no half-edge");
    assert_refused(hewn_mesh_split(mesh, (hewn_half){0}, 1.5, &v, error), HEWN_INVALID_ARGUMENT, "not at 1.5");
    assert_refused(hewn_mesh_split(mesh, (hewn_half){0}, NAN, &v, error), HEWN_INVALID_ARGUMENT, "split");
    assert_refused(hewn_mesh_poke(mesh, HEWN_FACE_NONE, good, &v, error), HEWN_INVALID_ARGUMENT, "no face");
    assert_refused(hewn_mesh_poke(mesh, (hewn_face){0}, bad, &v, error), HEWN_INVALID_ARGUMENT, "finite");
    assert_refused(hewn_mesh_triangulate_face(mesh, (hewn_face){99}, error), HEWN_INVALID_ARGUMENT, "no face");
    hewn_vert_set_position(mesh, (hewn_vert){0}, bad);
    assert_valid(mesh);
    assert_int_equal(hewn_mesh_face_count(mesh), 8);
    assert_int_equal(hewn_mesh_half_bound(mesh), 2 * hewn_mesh_edge_count(mesh));
    hewn_mesh_destroy(&mesh);
}

static void test_nothing_is_there(void **state)
{
    (void)state;
    hewn_mesh *mesh;
    hewn_half h;
    assert_works(hewn_mesh_create(&mesh, error));
    assert_valid(mesh);
    hewn_ring ring = hewn_vert_ring(mesh, (hewn_vert){0});
    assert_false(hewn_ring_next(mesh, &ring, &h));
    assert_int_equal(hewn_half_next(mesh, HEWN_HALF_NONE).id, HEWN_NONE);
    assert_int_equal(hewn_half_tail(mesh, (hewn_half){3}).id, HEWN_NONE);
    assert_int_equal(hewn_vert_valence(mesh, HEWN_VERT_NONE), 0);
    assert_int_equal(hewn_face_degree(mesh, HEWN_FACE_NONE), 0);
    assert_null(hewn_vert_position(mesh, (hewn_vert){0}));
    assert_works(hewn_mesh_compact(mesh, error));
    assert_works(hewn_mesh_append(mesh, mesh, error));
    assert_works(hewn_mesh_triangulate(mesh, error));
    hewn_mesh_reverse(mesh);
    assert_valid(mesh);
    hewn_mesh_destroy(&mesh);
}

/* A mesh made face by face: the cube, closed at the end. */
static void test_by_hand(void **state)
{
    (void)state;
    static const uint32_t sides[6][4] = {{0, 2, 3, 1}, {0, 1, 5, 4}, {0, 4, 6, 2},
                                         {1, 3, 7, 5}, {2, 6, 7, 3}, {4, 5, 7, 6}};
    hewn_mesh *mesh;
    assert_works(hewn_mesh_create(&mesh, error));
    for (uint32_t v = 0; v < 8; v++) {
        const double position[3] = {v & 1, v >> 1 & 1, v >> 2 & 1};
        assert_works(hewn_mesh_add_vert(mesh, position, NULL, error));
    }
    for (int i = 0; i < 6; i++) {
        hewn_vert corners[4];
        hewn_face f;
        for (int k = 0; k < 4; k++)
            corners[k].id = sides[i][k];
        assert_works(hewn_mesh_add_face(mesh, corners, 4, &f, error));
        assert_int_equal(hewn_half_head(mesh, hewn_face_half(mesh, f)).id, sides[i][0]);
        assert_valid(mesh);
    }
    assert_int_equal(euler_number(mesh), 2);
    /* Two opposite faces of a vertex go: it is split. */
    assert_works(hewn_mesh_delete_vert(mesh, (hewn_vert){0}, error));
    assert_valid(mesh);
    assert_int_equal(hewn_mesh_face_count(mesh), 3);
    hewn_mesh_destroy(&mesh);

    mesh = flat_grid(2, false);
    assert_works(hewn_mesh_delete_face(mesh, (hewn_face){0}, error));
    assert_works(hewn_mesh_delete_face(mesh, (hewn_face){3}, error));
    assert_valid(mesh);
    assert_int_equal(hewn_mesh_vert_count(mesh), 10);
    assert_int_equal(hewn_mesh_vert_bound(mesh), 10);
    assert_memory_equal(hewn_vert_position(mesh, (hewn_vert){9}), hewn_vert_position(mesh, (hewn_vert){4}),
                        3 * sizeof(double));
    hewn_mesh_destroy(&mesh);
}

static void test_append(void **state)
{
    (void)state;
    hewn_mesh *mesh = quad_cube(), *other = flat_grid(2, true);
    add_values(mesh);
    add_values(other);
    const hewn_attribute_info extra = {"extra", HEWN_DOMAIN_FACE, HEWN_SCALAR_UINT8, 1};
    const hewn_attribute_info clash = {"place", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3};
    assert_works(hewn_mesh_delete_face(other, (hewn_face){0}, error));
    assert_works(hewn_mesh_add_attribute(other, &extra, NULL, error));
    *(uint8_t *)hewn_mesh_attribute_at(other, 4, 5) = 77;
    assert_works(hewn_mesh_append(mesh, other, error));
    assert_valid(mesh);
    assert_values(mesh, 0);
    assert_int_equal(hewn_mesh_attribute_count(mesh), 5);
    assert_int_equal(*(const uint8_t *)hewn_mesh_attribute_read(mesh, 4, 11), 77);
    assert_int_equal(*(const uint8_t *)hewn_mesh_attribute_read(mesh, 4, 5), 0);
    assert_int_equal(hewn_mesh_face_count(mesh), 13);
    assert_false(hewn_mesh_has_face(mesh, (hewn_face){6}));
    assert_works(hewn_mesh_append(mesh, mesh, error));
    assert_valid(mesh);
    assert_values(mesh, 0);
    assert_int_equal(hewn_mesh_face_count(mesh), 26);
    hewn_mesh *third = tetrahedron();
    assert_works(hewn_mesh_add_attribute(third, &extra, NULL, error));
    assert_works(hewn_mesh_add_attribute(third, &clash, NULL, error));
    assert_refused(hewn_mesh_append(third, mesh, error), HEWN_INVALID_ARGUMENT, "\"place\"");
    assert_int_equal(hewn_mesh_attribute_count(third), 2);
    assert_int_equal(hewn_mesh_face_count(third), 4);
    assert_valid(third);
    hewn_mesh_destroy(&third);
    hewn_mesh_destroy(&mesh);
    hewn_mesh_destroy(&other);
}

static void test_compact_keeps_order(void **state)
{
    (void)state;
    hewn_mesh *mesh = flat_grid(6, true);
    add_values(mesh);
    for (uint32_t f = 0; f < 72; f += 5)
        assert_works(hewn_mesh_delete_face(mesh, (hewn_face){f}, error));
    assert_works(hewn_mesh_delete_vert(mesh, (hewn_vert){24}, error));
    int32_t labels[72];
    uint32_t count = 0, label = attribute_named(mesh, HEWN_DOMAIN_FACE, "label");
    for (uint32_t f = 0; f < hewn_mesh_face_bound(mesh); f++)
        if (hewn_mesh_has_face(mesh, (hewn_face){f}))
            labels[count++] = *(const int32_t *)hewn_mesh_attribute_read(mesh, label, f);
    size_t bytes = hewn_mesh_bytes(mesh);
    assert_works(hewn_mesh_compact(mesh, error));
    assert_valid(mesh);
    assert_values(mesh, 0);
    assert_true(hewn_mesh_bytes(mesh) < bytes);
    assert_int_equal(hewn_mesh_face_bound(mesh), count);
    for (uint32_t f = 0; f < count; f++)
        assert_int_equal(*(const int32_t *)hewn_mesh_attribute_read(mesh, label, f), labels[f]);
    hewn_mesh_destroy(&mesh);
}

static double signed_volume(const hewn_mesh *mesh)
{
    hewn_triangles triangles;
    hewn_certificate certificate;
    assert_works(hewn_mesh_to_triangles(mesh, &triangles, error));
    assert_works(hewn_certify(&triangles, NULL, &certificate, error));
    assert_true(certificate.oriented);
    hewn_triangles_destroy(&triangles);
    return certificate.volume;
}

static void test_transform(void **state)
{
    (void)state;
    hewn_mesh *mesh = torus(16, 12);
    const double stretch[12] = {2, 0, 0, 1, 0, -3, 0, 2, 0, 0, 0.5, 3}; /* mirrors y */
    double volume = signed_volume(mesh);
    uint32_t first = hewn_half_head(mesh, hewn_face_half(mesh, (hewn_face){7})).id;
    const float *normal = hewn_mesh_attribute_read(mesh, 0, 5);
    double wanted[3] = {(double)normal[0] / 2, (double)normal[1] / -3, (double)normal[2] / 0.5}, length = 0;
    for (int k = 0; k < 3; k++)
        length += wanted[k] * wanted[k];
    assert_works(hewn_mesh_transform(mesh, stretch, error));
    assert_valid(mesh);
    assert_true(fabs(signed_volume(mesh) / (3 * volume) - 1) < 1e-5);
    assert_int_equal(hewn_half_head(mesh, hewn_face_half(mesh, (hewn_face){7})).id, first);
    normal = hewn_mesh_attribute_read(mesh, 0, 5);
    for (int k = 0; k < 3; k++)
        assert_true(fabs((double)normal[k] - wanted[k] / sqrt(length)) < 1e-6);
    hewn_mesh_reverse(mesh);
    assert_true(fabs(signed_volume(mesh) / (-3 * volume) - 1) < 1e-5);
    const double flat[12] = {1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0},
                 wild[12] = {1e308, 1e308, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    double bad[12] = {1, 0, 0, NAN, 0, 1, 0, 0, 0, 0, 1, 0};
    assert_refused(hewn_mesh_transform(mesh, flat, error), HEWN_INVALID_ARGUMENT, "singular");
    assert_refused(hewn_mesh_transform(mesh, bad, error), HEWN_INVALID_ARGUMENT, "not finite");
    assert_refused(hewn_mesh_transform(mesh, wild, error), HEWN_INVALID_ARGUMENT, "out of the numbers");
    hewn_mesh_destroy(&mesh);
}

/* Poking a flat polygon anywhere inside, even a concave one, keeps linear functions. */
static void test_poke_is_linear(void **state)
{
    (void)state;
    random_state random = {21};
    for (int run = 0; run < 200; run++) {
        double positions[36];
        uint32_t count = 3 + random_below(&random, 9), corners[12];
        const uint64_t first[2] = {0, count};
        for (uint32_t i = 0; i < count; i++) {
            double radius = 0.3 + random_unit(&random), angle = 2 * M_PI * i / count;
            double x = radius * cos(angle), y = radius * sin(angle);
            positions[3 * i] = x + 2;
            positions[3 * i + 1] = x - y;
            positions[3 * i + 2] = 0.5 * y + 0.25 * x;
            corners[i] = i;
        }
        hewn_mesh *mesh = mesh_of(positions, count, first, corners, 1);
        add_values(mesh);
        const double centre[3] = {2, 0, 0};
        assert_works(hewn_mesh_poke(mesh, (hewn_face){0}, run % 4 == 0 ? positions + 3 : centre, NULL, error));
        assert_valid(mesh);
        assert_values(mesh, 1e-12);
        assert_int_equal(hewn_mesh_face_count(mesh), count);
        hewn_mesh_destroy(&mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_attributes),
        cmocka_unit_test(test_blending),
        cmocka_unit_test(test_refused_collapses),
        cmocka_unit_test(test_collapse_keeps_seams),
        cmocka_unit_test(test_collapse_to_the_end),
        cmocka_unit_test(test_refused_arguments),
        cmocka_unit_test(test_nothing_is_there),
        cmocka_unit_test(test_by_hand),
        cmocka_unit_test(test_append),
        cmocka_unit_test(test_compact_keeps_order),
        cmocka_unit_test(test_transform),
        cmocka_unit_test(test_poke_is_linear),
    };
    return cmocka_run_group_tests_name("mesh_edit", tests, NULL, NULL);
}
