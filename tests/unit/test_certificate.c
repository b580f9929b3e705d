/* The certificate: known meshes, and random soups against a twin that counts the slow and obvious way. */
#include <omp.h>

#include "hewn/check.h"
#include "test_mesh_support.h"

static hewn_certificate certify(hewn_triangles *mesh)
{
    hewn_certificate certificate;
    hewn_error error = {0};
    if (hewn_certify(mesh, NULL, &certificate, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return certificate;
}

/* Certifies and destroys. */
static hewn_certificate take(hewn_triangles mesh)
{
    hewn_certificate certificate = certify(&mesh);
    hewn_triangles_destroy(&mesh);
    return certificate;
}

static void assert_solid(const hewn_certificate *c, uint64_t components, int64_t genus)
{
    assert_true(c->closed && c->manifold && c->oriented);
    assert_int_equal(c->components, components);
    assert_int_equal(c->genus, genus);
    assert_int_equal(c->boundary_edges, 0);
    assert_int_equal(c->non_manifold_edges, 0);
    assert_int_equal(c->non_manifold_vertices, 0);
}

static void test_tetrahedron(void **state)
{
    (void)state;
    static const float positions[] = {0, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0, 3};
    static const uint32_t indices[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    hewn_certificate c = take(make_from(positions, 4, indices, 4));
    assert_solid(&c, 1, 0);
    assert_true(c.volume == 4.5);
    assert_true(fabs(c.area - (13.5 + 4.5 * sqrt(3))) < 1e-14);
    assert_true(isnan(c.max_residual));
    for (int axis = 0; axis < 3; axis++)
        assert_true(c.bounds.lo[axis] == 0 && c.bounds.hi[axis] == 3);
}

static void test_cube(void **state)
{
    (void)state;
    hewn_certificate c = take(make_cube());
    assert_solid(&c, 1, 0);
    assert_true(c.volume == 1);
    assert_true(c.area == 6);
    assert_int_equal(c.degenerate_faces, 0);
}

static void test_cube_inside_out_has_negative_volume(void **state)
{
    (void)state;
    hewn_triangles mesh = make_cube();
    for (uint64_t t = 0; t < mesh.triangle_count; t++)
        set_triangle(&mesh, t, mesh.indices[3 * t], mesh.indices[3 * t + 2], mesh.indices[3 * t + 1]);
    hewn_certificate c = take(mesh);
    assert_solid(&c, 1, 0);
    assert_true(c.volume == -1);
}

static void test_torus(void **state)
{
    (void)state;
    hewn_certificate c = take(make_torus(300, 200));
    assert_solid(&c, 1, 1);
    assert_true(fabs(c.volume - 2 * M_PI * M_PI * 0.09) < 1e-3);
    assert_true(fabs(c.area - 4 * M_PI * M_PI * 0.3) < 3e-3);
}

static void test_components_and_genus_add_up(void **state)
{
    (void)state;
    hewn_triangles mesh = join_meshes(make_torus(8, 7), make_torus(5, 9), 10);
    mesh = join_meshes(mesh, make_cube(), 20);
    mesh = join_meshes(mesh, make_bipyramid(5), 30);
    random_state random = {7};
    shuffle_mesh(&mesh, &random);
    hewn_certificate c = take(mesh);
    assert_solid(&c, 4, 2);
}

static void test_long_rows(void **state)
{
    (void)state;
    for (uint32_t n = 3; n < 100000; n = n * 5 / 2 + 1) {
        hewn_triangles mesh = make_bipyramid(n);
        random_state random = {n};
        shuffle_mesh(&mesh, &random);
        hewn_certificate c = take(mesh);
        assert_solid(&c, 1, 0);
        assert_true(fabs(c.volume - n * sin(2 * M_PI / n) / 3) < 1e-5);
    }
}

static void test_open(void **state)
{
    (void)state;
    hewn_triangles mesh = make_cube();
    mesh.triangle_count--;
    hewn_certificate c = take(mesh);
    assert_false(c.closed);
    assert_true(c.manifold && c.oriented);
    assert_int_equal(c.boundary_edges, 3);
    assert_int_equal(c.genus, -1);
}

static void test_flipped_face(void **state)
{
    (void)state;
    hewn_triangles mesh = make_cube();
    set_triangle(&mesh, 5, mesh.indices[15], mesh.indices[17], mesh.indices[16]);
    hewn_certificate c = take(mesh);
    assert_true(c.closed && c.manifold);
    assert_false(c.oriented);
    assert_int_equal(c.genus, -1);
}

static void test_non_manifold_edge(void **state)
{
    (void)state;
    static const float positions[] = {0, 0, 0, 0, 0, 1, 1, 0, 0, -1, 1, 0, -1, -1, 0};
    static const uint32_t indices[] = {0, 1, 2, 0, 1, 3, 1, 0, 4};
    hewn_certificate c = take(make_from(positions, 5, indices, 3));
    assert_false(c.closed);
    assert_false(c.manifold);
    assert_false(c.oriented);
    assert_int_equal(c.non_manifold_edges, 1);
    assert_int_equal(c.non_manifold_vertices, 2);
    assert_int_equal(c.boundary_edges, 6);
}

static void test_bow_tie(void **state)
{
    (void)state;
    /* Two tetrahedra that share a corner. */
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0, 0, 0, -1};
    static const uint32_t indices[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 4, 5, 0, 6, 4, 0, 5, 6, 4, 6, 5};
    hewn_certificate c = take(make_from(positions, 7, indices, 8));
    assert_true(c.closed && c.oriented);
    assert_false(c.manifold);
    assert_int_equal(c.non_manifold_edges, 0);
    assert_int_equal(c.non_manifold_vertices, 1);
    assert_int_equal(c.components, 1);
    assert_int_equal(c.genus, -1);
}

static void test_duplicate_faces(void **state)
{
    (void)state;
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t same[] = {0, 1, 2, 1, 2, 0}, opposite[] = {0, 1, 2, 0, 2, 1};
    hewn_certificate c = take(make_from(positions, 3, same, 2));
    assert_true(c.closed && c.manifold);
    assert_false(c.oriented);
    c = take(make_from(positions, 3, opposite, 2)); /* a closed pillow without inside */
    assert_solid(&c, 1, 0);
    assert_true(c.volume == 0);
}

static void test_degenerate_faces(void **state)
{
    (void)state;
    /* A face with two equal corners, and one on a straight line. Only the second has edges. */
    static const float positions[] = {0, 0, 0, 1, 1, 1, 2, 2, 2, 5, 0, 0};
    static const uint32_t indices[] = {0, 0, 3, 0, 1, 2};
    hewn_certificate c = take(make_from(positions, 4, indices, 2));
    assert_int_equal(c.degenerate_faces, 2);
    assert_int_equal(c.boundary_edges, 3);
    assert_int_equal(c.components, 1);
    assert_true(c.area == 0);
    assert_true(c.bounds.hi[0] == 5);
}

static void test_isolated_vertices(void **state)
{
    (void)state;
    hewn_triangles cube = make_cube();
    hewn_certificate c = take(join_meshes(cube, make_mesh(5, 0), 100));
    assert_solid(&c, 1, 0);
    assert_true(c.bounds.hi[0] == 1);
}

static void test_empty(void **state)
{
    (void)state;
    hewn_triangles empty = {0};
    hewn_certificate c = certify(&empty);
    assert_solid(&c, 0, 0);
    assert_true(c.volume == 0 && c.area == 0 && c.bounds.lo[0] == 0 && c.bounds.hi[2] == 0);
    empty.vertex_count = 3;
    empty.positions = (float[9]){0};
    c = certify(&empty);
    assert_solid(&c, 0, 0);
}

static void test_bad_input_names_the_first(void **state)
{
    (void)state;
    hewn_triangles mesh = make_torus(20, 20);
    hewn_certificate c;
    hewn_error error;
    mesh.indices[3 * 70 + 1] = 400;
    mesh.indices[3 * 71 + 1] = 4000000000u;
    assert_int_equal(hewn_certify(&mesh, NULL, &c, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "triangle 70 "));
    assert_int_equal(c.components, 0);
    mesh.indices[3 * 70 + 1] = mesh.indices[3 * 71 + 1] = 0;
    mesh.positions[3 * 33 + 2] = NAN;
    mesh.positions[3 * 34] = INFINITY;
    assert_int_equal(hewn_certify(&mesh, NULL, &c, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "vertex 33 "));
    assert_int_equal(hewn_certify(&mesh, NULL, &c, NULL), HEWN_BAD_INPUT);
    hewn_triangles_destroy(&mesh);
    mesh.triangle_count = 1;
    assert_int_equal(hewn_certify(&mesh, NULL, &c, &error), HEWN_INVALID_ARGUMENT);
    mesh = (hewn_triangles){.triangle_count = UINT32_MAX, .indices = (uint32_t[3]){0}};
    assert_int_equal(hewn_certify(&mesh, NULL, &c, &error), HEWN_LIMIT);
}

static bool count_down(void *user, const char *stage, double fraction)
{
    assert_string_equal(stage, "certify");
    assert_true(fraction >= 0 && fraction <= 1);
    return (*(int *)user)-- > 0;
}

static void test_cancels_at_every_report(void **state)
{
    (void)state;
    hewn_triangles mesh = make_torus(30, 30);
    for (int allowed = 0;; allowed++) {
        int left = allowed;
        hewn_progress progress = {count_down, &left};
        hewn_certificate c;
        hewn_error error;
        hewn_result result = hewn_certify(&mesh, &progress, &c, &error);
        if (result == HEWN_OK) {
            assert_true(allowed >= 3);
            break;
        }
        assert_int_equal(result, HEWN_CANCELLED);
        assert_true(c.area == 0);
    }
    hewn_triangles_destroy(&mesh);
}

static void test_same_bits_for_any_number_of_threads(void **state)
{
    (void)state;
    hewn_triangles mesh = make_torus(301, 211); /* several blocks */
    random_state random = {3};
    shuffle_mesh(&mesh, &random);
    int usual = omp_get_max_threads();
    hewn_certificate first = {0};
    for (int threads = 1; threads <= 9; threads++) {
        omp_set_num_threads(threads);
        hewn_certificate c = certify(&mesh);
        c.max_residual = 0;
        if (threads == 1)
            first = c;
        assert_true(c.volume == first.volume && c.area == first.area);
        assert_memory_equal(&c.bounds, &first.bounds, sizeof c.bounds);
        assert_int_equal(c.genus, 1);
    }
    omp_set_num_threads(usual);
    hewn_triangles_destroy(&mesh);
}

/* Some faces taken away, turned over, doubled and collapsed, and one vertex that very many faces meet at. */
static void damage(hewn_triangles *mesh, random_state *random)
{
    enum { FAN = 1000 };
    const uint32_t faces = (uint32_t)mesh->triangle_count, hub = random_below(random, (uint32_t)mesh->vertex_count);
    for (int i = 0; i < 400; i++) {
        uint32_t *face = mesh->indices + 3 * (uint64_t)random_below(random, faces), first = face[0];
        if (i % 4 == 0)
            memcpy(face, mesh->indices + 3 * (uint64_t)random_below(random, faces), 3 * sizeof *face);
        else if (i % 4 == 1)
            face[0] = face[1];
        else
            face[0] = face[i % 4 - 1], face[i % 4 - 1] = first;
    }
    for (uint32_t i = 0; i < FAN; i++)
        set_triangle(mesh, faces / 2 + i, hub, (hub + 2 + i) % (uint32_t)mesh->vertex_count,
                     (hub + 3 + i) % (uint32_t)mesh->vertex_count);
}

/* Stars are examined range by range of the vertices, or all at once where faces are in no order. The check has them all
 * at once always. */
static void test_many_ranges_against_the_check(void **state)
{
    (void)state;
    random_state random = {5};
    for (int round = 0; round < 3; round++) {
        hewn_triangles mesh = make_torus(700, 400); /* nine ranges */
        hewn_check *check;
        if (round > 0)
            damage(&mesh, &random);
        if (round > 1)
            shuffle_mesh(&mesh, &random);
        assert_int_equal(hewn_check_triangles(&mesh, NULL, &check, NULL), HEWN_OK);
        const hewn_certificate c = take(mesh), *other = &check->certificate;
        assert_int_equal(c.manifold, round == 0);
        assert_int_equal(c.manifold, other->manifold);
        assert_int_equal(c.closed, other->closed);
        assert_int_equal(c.oriented, other->oriented);
        assert_int_equal(c.components, other->components);
        assert_int_equal(c.genus, other->genus);
        assert_int_equal(c.boundary_edges, other->boundary_edges);
        assert_int_equal(c.non_manifold_edges, other->non_manifold_edges);
        assert_int_equal(c.non_manifold_vertices, other->non_manifold_vertices);
        hewn_check_destroy(&check);
    }
}

/* One face alone, with more threads than faces: nothing of an idle thread may show. */
static void test_one_face(void **state)
{
    (void)state;
    static const float positions[] = {1, 2, 3, 2, 2, 3, 1, 3, 3};
    static const uint32_t indices[] = {0, 1, 2};
    int usual = omp_get_max_threads();
    omp_set_num_threads(8);
    hewn_certificate c = take(make_from(positions, 3, indices, 1));
    omp_set_num_threads(usual);
    assert_true(c.bounds.lo[2] == 3 && c.bounds.hi[0] == 2);
    assert_true(c.area == 0.5 && c.volume == 0);
}

static void test_volume_far_from_the_origin(void **state)
{
    (void)state;
    hewn_triangles mesh = make_cube();
    for (uint64_t v = 0; v < 8; v++)
        mesh.positions[3 * v] += 1e7f;
    hewn_certificate c = take(mesh);
    assert_true(c.volume == 1);
}

/* --- the twin
 * ---------------------------------------------------------------------------------------------------------- */

enum { MOST = 12 };

static bool is_collapsed(const uint32_t *f)
{
    return f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
}

static bool face_has(const uint32_t *f, uint32_t v)
{
    return f[0] == v || f[1] == v || f[2] == v;
}

/* Groups of faces, where two belong together if they share `around` and another vertex (or, with none given, any). */
static uint64_t count_groups(const hewn_triangles *mesh, uint32_t around)
{
    bool seen[64] = {0};
    uint64_t groups = 0;
    for (uint64_t start = 0; start < mesh->triangle_count; start++) {
        const uint32_t *first = mesh->indices + 3 * start;
        if (seen[start] || is_collapsed(first) || (around < MOST && !face_has(first, around)))
            continue;
        groups++;
        seen[start] = true;
        for (bool grew = true; grew;) {
            grew = false;
            for (uint64_t a = 0; a < mesh->triangle_count; a++)
                for (uint64_t b = 0; seen[a] && b < mesh->triangle_count; b++) {
                    const uint32_t *f = mesh->indices + 3 * a, *g = mesh->indices + 3 * b;
                    if (seen[b] || is_collapsed(g) || (around < MOST && !(face_has(f, around) && face_has(g, around))))
                        continue;
                    bool shared = false;
                    for (int k = 0; k < 3; k++)
                        shared = shared || (f[k] != around && face_has(g, f[k]));
                    seen[b] = shared;
                    grew = grew || shared;
                }
        }
    }
    return groups;
}

static hewn_certificate count_slowly(const hewn_triangles *mesh)
{
    uint32_t runs[MOST][MOST] = {{0}};
    bool used[MOST] = {0}, crowded[MOST] = {0};
    uint64_t faces = 0, vertices = 0, edges = 0, astray = 0;
    hewn_certificate c = {0};
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *f = mesh->indices + 3 * t;
        if (is_collapsed(f))
            continue;
        faces++;
        for (int k = 0; k < 3; k++) {
            used[f[k]] = true;
            runs[f[k]][f[(k + 1) % 3]]++;
        }
    }
    for (uint32_t v = 0; v < MOST; v++)
        for (uint32_t w = v + 1; w < MOST; w++) {
            uint32_t uses = runs[v][w] + runs[w][v];
            edges += uses > 0;
            c.boundary_edges += uses == 1;
            c.non_manifold_edges += uses > 2;
            astray += uses > 1 && runs[v][w] != runs[w][v];
            crowded[v] = crowded[v] || uses > 2;
            crowded[w] = crowded[w] || uses > 2;
        }
    for (uint32_t v = 0; v < MOST; v++) {
        vertices += used[v];
        c.non_manifold_vertices += used[v] && (crowded[v] || count_groups(mesh, v) > 1);
    }
    c.components = count_groups(mesh, MOST);
    c.closed = c.boundary_edges == 0;
    c.manifold = c.non_manifold_edges + c.non_manifold_vertices == 0;
    c.oriented = astray == 0;
    int64_t euler = (int64_t)vertices - (int64_t)edges + (int64_t)faces;
    c.genus = c.closed && c.manifold && c.oriented ? (2 * (int64_t)c.components - euler) / 2 : -1;
    return c;
}

static void compare_with_twin(const hewn_triangles *mesh)
{
    hewn_certificate c, twin = count_slowly(mesh);
    assert_int_equal(hewn_certify(mesh, NULL, &c, NULL), HEWN_OK);
    assert_int_equal(c.closed, twin.closed);
    assert_int_equal(c.manifold, twin.manifold);
    assert_int_equal(c.oriented, twin.oriented);
    assert_int_equal(c.components, twin.components);
    assert_int_equal(c.genus, twin.genus);
    assert_int_equal(c.boundary_edges, twin.boundary_edges);
    assert_int_equal(c.non_manifold_edges, twin.non_manifold_edges);
    assert_int_equal(c.non_manifold_vertices, twin.non_manifold_vertices);
}

static void test_random_soups_against_the_twin(void **state)
{
    (void)state;
    random_state random = {1};
    int rounds = getenv("HEWN_LONG") ? 50000 : 2000;
    for (int round = 0; round < rounds; round++) {
        uint32_t vertices = 3 + random_below(&random, MOST - 2), triangles = 1 + random_below(&random, 24);
        hewn_triangles mesh = make_mesh(vertices, triangles);
        for (uint32_t t = 0; t < triangles; t++)
            set_triangle(&mesh, t, random_below(&random, vertices), random_below(&random, vertices),
                         random_below(&random, vertices));
        compare_with_twin(&mesh);
        hewn_triangles_destroy(&mesh);
    }
}

/* Closed soups: the four faces of random tetrahedra, each turned one way or the other. Many are manifold, some meet in
 * edges and corners. */
static void test_random_closed_soups_against_the_twin(void **state)
{
    (void)state;
    random_state random = {2};
    int rounds = getenv("HEWN_LONG") ? 50000 : 2000;
    for (int round = 0; round < rounds; round++) {
        uint32_t solids = 1 + random_below(&random, 4);
        hewn_triangles mesh = make_mesh(MOST, 4ull * solids);
        for (uint32_t s = 0; s < solids; s++) {
            uint32_t v[4];
            for (int k = 0; k < 4; k++)
                v[k] = random_below(&random, MOST);
            set_triangle(&mesh, 4ull * s, v[0], v[2], v[1]);
            set_triangle(&mesh, 4ull * s + 1, v[0], v[1], v[3]);
            set_triangle(&mesh, 4ull * s + 2, v[0], v[3], v[2]);
            set_triangle(&mesh, 4ull * s + 3, v[1], v[2], v[3]);
        }
        compare_with_twin(&mesh);
        hewn_triangles_destroy(&mesh);
    }
}

static void release_owner(void *owner)
{
    ++*(int *)owner;
}

static void test_destroy(void **state)
{
    (void)state;
    hewn_triangles_destroy(NULL);
    hewn_triangles mesh = {0};
    hewn_triangles_destroy(&mesh);
    int released = 0;
    float foreign[3] = {0};
    mesh = (hewn_triangles){.vertex_count = 1, .positions = foreign, .release = release_owner, .owner = &released};
    hewn_triangles_destroy(&mesh);
    assert_int_equal(released, 1);
    assert_null(mesh.positions);
    assert_null(mesh.release);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tetrahedron),
        cmocka_unit_test(test_cube),
        cmocka_unit_test(test_cube_inside_out_has_negative_volume),
        cmocka_unit_test(test_torus),
        cmocka_unit_test(test_components_and_genus_add_up),
        cmocka_unit_test(test_long_rows),
        cmocka_unit_test(test_open),
        cmocka_unit_test(test_flipped_face),
        cmocka_unit_test(test_non_manifold_edge),
        cmocka_unit_test(test_bow_tie),
        cmocka_unit_test(test_duplicate_faces),
        cmocka_unit_test(test_degenerate_faces),
        cmocka_unit_test(test_isolated_vertices),
        cmocka_unit_test(test_empty),
        cmocka_unit_test(test_bad_input_names_the_first),
        cmocka_unit_test(test_cancels_at_every_report),
        cmocka_unit_test(test_same_bits_for_any_number_of_threads),
        cmocka_unit_test(test_many_ranges_against_the_check),
        cmocka_unit_test(test_one_face),
        cmocka_unit_test(test_volume_far_from_the_origin),
        cmocka_unit_test(test_random_soups_against_the_twin),
        cmocka_unit_test(test_random_closed_soups_against_the_twin),
        cmocka_unit_test(test_destroy),
    };
    return cmocka_run_group_tests_name("certificate", tests, NULL, NULL);
}
