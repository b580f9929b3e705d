/* Building a half-edge mesh from indexed faces: against a slow judge, against damage, for any number of threads. */
#include "test_mesh_half.h"

#include <omp.h>

/* --- a slow judge ------------------------------------------------------------------------------------------------- */

/* Whether the triangles are a 2-manifold with boundary, found by comparing all pairs and by flooding around vertices.
 */
static bool edge_runs(const uint32_t *corner, uint32_t a, uint32_t b)
{
    return (corner[0] == a && corner[1] == b) || (corner[1] == a && corner[2] == b) ||
           (corner[2] == a && corner[0] == b);
}

static bool share_edge_at(const uint32_t *s, const uint32_t *t, uint32_t v)
{
    for (int i = 0; i < 3; i++)
        if (s[i] != v && (edge_runs(s, v, s[i]) ? edge_runs(t, s[i], v) : edge_runs(t, v, s[i])))
            return true;
    return false;
}

static bool one_fan(const uint32_t *corners, uint32_t count, uint32_t v)
{
    uint32_t around[16], around_count = 0, reached = 1;
    for (uint32_t t = 0; t < count; t++)
        for (uint32_t i = 0; i < 3; i++)
            if (corners[3 * t + i] == v)
                around[around_count++] = t;
    for (bool more = true; more;) {
        more = false;
        for (uint32_t a = 0; a < around_count; a++)
            for (uint32_t b = 0; b < around_count; b++)
                if (reached >> a & 1 && !(reached >> b & 1) &&
                    share_edge_at(corners + 3 * around[a], corners + 3 * around[b], v)) {
                    reached |= 1u << b;
                    more = true;
                }
    }
    return around_count == 0 || reached == (1u << around_count) - 1;
}

static bool judge(const uint32_t *corners, uint32_t count, uint32_t verts)
{
    for (uint32_t t = 0; t < count; t++) {
        const uint32_t *at = corners + 3 * t;
        if (at[0] == at[1] || at[1] == at[2] || at[2] == at[0])
            return false;
        for (uint32_t s = 0; s < t; s++)
            for (uint32_t i = 0; i < 3; i++)
                if (edge_runs(corners + 3 * s, at[i], at[(i + 1) % 3]))
                    return false;
    }
    for (uint32_t v = 0; v < verts; v++)
        if (!one_fan(corners, count, v))
            return false;
    return true;
}

static void test_small_soups(void **state)
{
    (void)state;
    random_state random = {7};
    double positions[24] = {0};
    uint32_t good = 0, runs = getenv("HEWN_LONG") ? 2000000 : 100000;
    for (uint32_t run = 0; run < runs; run++) {
        uint32_t verts = 3 + random_below(&random, 5), count = 1 + random_below(&random, 6), corners[18];
        for (uint32_t i = 0; i < 3 * count; i++)
            corners[i] = random_below(&random, verts);
        const hewn_polygons polygons = {verts, positions, count, NULL, corners};
        hewn_mesh *mesh;
        hewn_error error;
        hewn_result result = hewn_mesh_from_polygons(&polygons, &mesh, &error);
        bool expected = judge(corners, count, verts);
        if (result != (expected ? HEWN_OK : HEWN_BAD_INPUT))
            fail_msg("run %u: the builder says %s", run, result == HEWN_OK ? "fine" : error.message);
        assert_true((mesh != NULL) == expected);
        if (!mesh)
            continue;
        good++;
        assert_valid(mesh);
        for (uint32_t t = 0; t < count; t++) {
            hewn_half h = hewn_face_half(mesh, (hewn_face){t});
            for (uint32_t i = 0; i < 3; i++, h = hewn_half_next(mesh, h)) {
                assert_int_equal(hewn_half_head(mesh, h).id, corners[3 * t + i]);
                assert_int_equal(hewn_half_face(mesh, h).id, t);
            }
        }
        hewn_mesh_destroy(&mesh);
    }
    assert_true(good > runs / 50);
}

/* --- what is refused ---------------------------------------------------------------------------------------------- */

static void refuse(const uint64_t *first, const uint32_t *corners, uint64_t faces, uint64_t verts, const char *text)
{
    static const double positions[60] = {0};
    const hewn_polygons polygons = {verts, positions, faces, first, corners};
    hewn_mesh *mesh = (hewn_mesh *)(uintptr_t)1;
    assert_refused(hewn_mesh_from_polygons(&polygons, &mesh, error), HEWN_BAD_INPUT, text);
    assert_null(mesh);
}

static void test_offenders_are_named(void **state)
{
    (void)state;
    refuse(NULL, (const uint32_t[]){0, 1, 2, 0, 2, 9, 7, 7, 7}, 3, 5,
           "face 1 names the vertex 9, but there are only 5");
    refuse(NULL, (const uint32_t[]){0, 1, 2, 3, 4, 3, 9, 9, 9}, 3, 5, "face 1 has the vertex 3 twice");
    refuse((const uint64_t[]){0, 3, 5}, (const uint32_t[]){0, 1, 2, 0, 2}, 2, 5, "face 1 has fewer than three corners");
    refuse((const uint64_t[]){0, 4, 2, 8}, (const uint32_t[]){0, 1, 2, 3, 4, 5, 6, 7}, 3, 9, "face 1 has fewer");
    refuse((const uint64_t[]){0, 5}, (const uint32_t[]){0, 1, 2, 3, 1}, 1, 5, "face 0 has the vertex 1 twice");
    refuse(NULL, (const uint32_t[]){0, 1, 2, 0, 1, 3}, 2, 4,
           "the faces 0 and 1 run along the edge from vertex 0 to vertex 1 the same way");
    refuse(NULL, (const uint32_t[]){2, 1, 0, 3, 1, 0}, 2, 4,
           "run along the edge from vertex 1 to vertex 0 the same way");
    refuse(NULL, (const uint32_t[]){4, 2, 3, 2, 4, 5, 4, 2, 6}, 3, 7,
           "the edge between the vertices 2 and 4 has 3 faces");
    refuse(NULL, (const uint32_t[]){0, 1, 2, 2, 3, 4}, 2, 5, "the faces around vertex 2 form more than one fan");
    /* Two tetrahedra that touch in vertex 0. */
    refuse(NULL, (const uint32_t[]){0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 5, 4, 0, 4, 6, 0, 6, 5, 4, 5, 6}, 8, 7,
           "the faces around vertex 0 form more than one fan");
    /* The first of several. */
    refuse(NULL, (const uint32_t[]){5, 6, 7, 7, 8, 9, 0, 1, 2, 2, 3, 4}, 4, 10, "around vertex 2 form");
    refuse(NULL, (const uint32_t[]){5, 6, 7, 5, 6, 8, 1, 2, 3, 1, 2, 4, 0, 0, 1}, 4, 10, "from vertex 1 to vertex 2");
}

static void test_arguments(void **state)
{
    (void)state;
    const uint32_t corners[] = {0, 1, 2};
    double positions[] = {0, 0, 0, 1, 0, 0, 0, NAN, 0};
    hewn_mesh *mesh;
    hewn_polygons polygons = {3, positions, 1, NULL, corners};
    assert_refused(hewn_mesh_from_polygons(&polygons, &mesh, error), HEWN_BAD_INPUT, "vertex 2 is not finite");
    polygons.positions = NULL;
    assert_refused(hewn_mesh_from_polygons(&polygons, &mesh, error), HEWN_INVALID_ARGUMENT, "without positions");
    positions[7] = 1;
    polygons = (hewn_polygons){3, positions, 1ull << 40, NULL, corners};
    assert_refused(hewn_mesh_from_polygons(&polygons, &mesh, error), HEWN_LIMIT, "more than there are ids");
    polygons = (hewn_polygons){1ull << 33, positions, 1, NULL, corners};
    assert_refused(hewn_mesh_from_polygons(&polygons, &mesh, error), HEWN_LIMIT, "more than there are ids");
    polygons = (hewn_polygons){3, positions, 1, (const uint64_t[]){1, 4}, corners};
    assert_refused(hewn_mesh_from_polygons(&polygons, &mesh, error), HEWN_INVALID_ARGUMENT, "begin at 0");
    polygons = (hewn_polygons){0};
    assert_works(hewn_mesh_from_polygons(&polygons, &mesh, error));
    assert_valid(mesh);
    assert_int_equal(hewn_mesh_vert_bound(mesh), 0);
    hewn_mesh_destroy(&mesh);
    polygons = (hewn_polygons){3, positions, 0, NULL, NULL};
    assert_works(hewn_mesh_from_polygons(&polygons, &mesh, error));
    assert_valid(mesh);
    assert_int_equal(hewn_vert_half(mesh, (hewn_vert){1}).id, HEWN_NONE);
    hewn_mesh_destroy(&mesh);
    assert_null(mesh);
    hewn_mesh_destroy(&mesh);
}

/* --- larger meshes ------------------------------------------------------------------------------------------------ */

static void assert_same_mesh(const hewn_mesh *a, const hewn_mesh *b)
{
    assert_int_equal(hewn_mesh_half_bound(a), hewn_mesh_half_bound(b));
    assert_int_equal(hewn_mesh_vert_bound(a), hewn_mesh_vert_bound(b));
    for (uint32_t i = 0; i < hewn_mesh_half_bound(a); i++) {
        hewn_half h = {i};
        assert_true(
            hewn_half_next(a, h).id == hewn_half_next(b, h).id && hewn_half_prev(a, h).id == hewn_half_prev(b, h).id &&
            hewn_half_head(a, h).id == hewn_half_head(b, h).id && hewn_half_face(a, h).id == hewn_half_face(b, h).id);
    }
    for (uint32_t v = 0; v < hewn_mesh_vert_bound(a); v++)
        assert_int_equal(hewn_vert_half(a, (hewn_vert){v}).id, hewn_vert_half(b, (hewn_vert){v}).id);
}

/* Turns corner lists and numbers around, so that no order helps. */
static void shuffle(hewn_triangles *mesh, uint64_t seed)
{
    random_state random = {seed};
    uint32_t *number = malloc(mesh->vertex_count * sizeof *number);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t other = random_below(&random, v + 1);
        number[v] = number[other];
        number[other] = v;
    }
    for (uint64_t i = 0; i < 3 * mesh->triangle_count; i++)
        mesh->indices[i] = number[mesh->indices[i]];
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t other = random_below(&random, t + 1), keep[3];
        memcpy(keep, mesh->indices + 3 * t, sizeof keep);
        memcpy(mesh->indices + 3 * t, mesh->indices + 3 * other, sizeof keep);
        memcpy(mesh->indices + 3 * other, keep, sizeof keep);
    }
    free(number);
}

static void test_threads_agree(void **state)
{
    (void)state;
    int before = omp_get_max_threads();
    for (int variant = 0; variant < 3; variant++) {
        hewn_triangles triangles = variant == 2 ? make_bipyramid(20000) : make_torus(120, 150);
        if (variant > 0)
            shuffle(&triangles, 3);
        if (variant == 1)
            triangles.triangle_count -= 5000; /* with boundaries; vertices with two fans are refused alike */
        hewn_mesh *first = NULL;
        for (int threads = 1; threads <= 5; threads += 2) {
            hewn_mesh *mesh;
            hewn_error error = {0};
            static hewn_error first_error;
            omp_set_num_threads(threads);
            hewn_result result = hewn_mesh_from_triangles(&triangles, &mesh, &error);
            assert_int_equal(result, variant == 1 ? HEWN_BAD_INPUT : HEWN_OK);
            if (threads == 1) {
                first = mesh;
                first_error = error;
                continue;
            }
            if (result != HEWN_OK) {
                assert_string_equal(error.message, first_error.message);
                continue;
            }
            assert_valid(mesh);
            assert_same_mesh(mesh, first);
            hewn_mesh_destroy(&mesh);
        }
        hewn_mesh_destroy(&first);
        hewn_triangles_destroy(&triangles);
    }
    omp_set_num_threads(before);
}

static void test_triangles_there_and_back(void **state)
{
    (void)state;
    hewn_triangles triangles = make_torus(9, 8), back;
    hewn_mesh *mesh;
    assert_works(hewn_mesh_from_triangles(&triangles, &mesh, error));
    assert_int_equal(hewn_mesh_attribute_count(mesh), 1);
    assert_works(hewn_mesh_to_triangles(mesh, &back, error));
    assert_int_equal(back.vertex_count, triangles.vertex_count);
    assert_int_equal(back.triangle_count, triangles.triangle_count);
    assert_memory_equal(back.positions, triangles.positions, back.vertex_count * 3 * sizeof(float));
    assert_memory_equal(back.normals, triangles.normals, back.vertex_count * 3 * sizeof(float));
    assert_memory_equal(back.indices, triangles.indices, back.triangle_count * 3 * sizeof(uint32_t));
    hewn_triangles_destroy(&back);
    const double far[3] = {1e300, 0, 0};
    hewn_vert_set_position(mesh, (hewn_vert){3}, far);
    assert_refused(hewn_mesh_to_triangles(mesh, &back, error), HEWN_LIMIT, "vertex 3 does not fit");
    assert_null(back.positions);
    hewn_mesh_destroy(&mesh);
    hewn_triangles_destroy(&triangles);
}

static void test_numbering(void **state)
{
    (void)state;
    hewn_mesh *mesh = flat_grid(4, true);
    uint32_t last = 0;
    for (uint32_t h = 0; h < hewn_mesh_half_bound(mesh); h += 2) {
        uint32_t tail = hewn_half_tail(mesh, (hewn_half){h}).id, head = hewn_half_head(mesh, (hewn_half){h}).id;
        assert_true(tail < head);
        assert_true(tail >= last);
        last = tail;
    }
    assert_int_equal(euler_number(mesh), 1);
    assert_true(hewn_vert_on_boundary(mesh, (hewn_vert){0}));
    assert_false(hewn_vert_on_boundary(mesh, (hewn_vert){6}));
    assert_int_equal(hewn_vert_valence(mesh, (hewn_vert){6}), 6);
    hewn_mesh_destroy(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_small_soups), cmocka_unit_test(test_offenders_are_named),
        cmocka_unit_test(test_arguments),   cmocka_unit_test(test_threads_agree),
        cmocka_unit_test(test_numbering),   cmocka_unit_test(test_triangles_there_and_back),
    };
    return cmocka_run_group_tests_name("mesh_build", tests, NULL, NULL);
}
