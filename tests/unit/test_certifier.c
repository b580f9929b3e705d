/* The certificate of a mesh in parts is that of the whole, bit by bit, however it is cut. */
#include <math.h>

#include "test_mesh_support.h"

enum { MOST_PARTS = 16, MOST_RUNS = 4096 };

/* Where a mesh is cut: part i has the vertices and triangles from those numbers on, up to the next part's. */
typedef struct cutting {
    uint32_t parts;
    uint64_t vertices[MOST_PARTS + 1], triangles[MOST_PARTS + 1];
} cutting;

static int compare_numbers(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static cutting cut_at_random(const hewn_triangles *mesh, random_state *random)
{
    cutting cut = {.parts = 1 + random_below(random, MOST_PARTS)};
    for (uint32_t i = 1; i < cut.parts; i++) {
        cut.vertices[i] = random_below(random, (uint32_t)mesh->vertex_count + 1);
        cut.triangles[i] = random_below(random, (uint32_t)mesh->triangle_count + 1);
    }
    cut.vertices[cut.parts] = mesh->vertex_count;
    cut.triangles[cut.parts] = mesh->triangle_count;
    qsort(cut.vertices, cut.parts + 1, sizeof *cut.vertices, compare_numbers);
    qsort(cut.triangles, cut.parts + 1, sizeof *cut.triangles, compare_numbers);
    return cut;
}

/* Vertices are open that are still to come or that later triangles name. */
static uint64_t find_open(const hewn_triangles *mesh, const cutting *cut, uint32_t part, hewn_number_run *open)
{
    uint64_t count = 0;
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        bool is_open = v >= cut->vertices[part + 1];
        for (uint64_t c = 3 * cut->triangles[part + 1]; c < 3 * mesh->triangle_count && !is_open; c++)
            is_open = mesh->indices[c] == v;
        if (is_open && count > 0 && open[count - 1].first + open[count - 1].count == v)
            open[count - 1].count++;
        else if (is_open)
            open[count++] = (hewn_number_run){v, 1};
    }
    assert_true(count <= MOST_RUNS);
    return count;
}

static hewn_mesh_part part_of(const hewn_triangles *mesh, const cutting *cut, uint32_t i, hewn_number_run *open)
{
    uint64_t v = cut->vertices[i], t = cut->triangles[i];
    uint64_t vertices = cut->vertices[i + 1] - v, triangles = cut->triangles[i + 1] - t;
    uint64_t first = vertices / 3 * (i % 4), later = triangles / 3 * (i / 2 % 4); /* into two runs, one may be empty */
    hewn_mesh_part part = {.vertices = {{v, first, mesh->positions + 3 * v, NULL},
                                        {v + first, vertices - first, mesh->positions + 3 * (v + first), NULL}},
                           .triangles = {{t + later, triangles - later, mesh->indices + 3 * (t + later)},
                                         {t, later, mesh->indices + 3 * t}},
                           .open = open};
    part.open_count = find_open(mesh, cut, i, open);
    return part;
}

static void compare(const hewn_triangles *mesh, const cutting *cut)
{
    static hewn_number_run open[MOST_RUNS];
    hewn_certifier *certifier;
    hewn_certificate whole, parts;
    hewn_error error = {0};
    assert_int_equal(hewn_certify(mesh, NULL, &whole, NULL), HEWN_OK);
    assert_int_equal(hewn_certifier_create(&certifier, NULL), HEWN_OK);
    for (uint32_t i = 0; i < cut->parts; i++) {
        hewn_mesh_part part = part_of(mesh, cut, i, open);
        if (hewn_certifier_take(certifier, &part, &error) != HEWN_OK)
            fail_msg("part %u: %s", i, error.message);
    }
    if (hewn_certifier_finish(certifier, &parts, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    hewn_certifier_destroy(&certifier);
    assert_null(certifier);
    assert_true(whole.closed == parts.closed && whole.manifold == parts.manifold && whole.oriented == parts.oriented);
    assert_int_equal(whole.components, parts.components);
    assert_int_equal(whole.genus, parts.genus);
    assert_int_equal(whole.boundary_edges, parts.boundary_edges);
    assert_int_equal(whole.non_manifold_edges, parts.non_manifold_edges);
    assert_int_equal(whole.non_manifold_vertices, parts.non_manifold_vertices);
    assert_int_equal(whole.degenerate_faces, parts.degenerate_faces);
    assert_memory_equal(&whole.volume, &parts.volume, sizeof whole.volume);
    assert_memory_equal(&whole.area, &parts.area, sizeof whole.area);
    assert_memory_equal(&whole.bounds, &parts.bounds, sizeof whole.bounds);
    assert_true(isnan(parts.max_residual));
}

static void test_solids(void **state)
{
    (void)state;
    random_state random = {1};
    for (int round = 0; round < 200; round++) {
        hewn_triangles meshes[] = {make_cube(), make_torus(3 + random_below(&random, 30), 3 + random_below(&random, 9)),
                                   make_bipyramid(3 + random_below(&random, 300))};
        for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
            cutting cut = cut_at_random(&meshes[i], &random);
            compare(&meshes[i], &cut);
            hewn_triangles_destroy(&meshes[i]);
        }
    }
}

/* Few vertices and many faces: collapsed ones, edges and vertices that are not manifold, islands, unused vertices. */
static void test_soups(void **state)
{
    (void)state;
    random_state random = {2};
    int rounds = getenv("HEWN_LONG") ? 100000 : 5000;
    for (int round = 0; round < rounds; round++) {
        uint32_t vertices = 3 + random_below(&random, 40), triangles = 1 + random_below(&random, 50);
        hewn_triangles mesh = make_mesh(vertices, triangles);
        for (uint64_t i = 0; i < 3ull * vertices; i++)
            mesh.positions[i] = (float)random_below(&random, 5) / 3;
        for (uint32_t t = 0; t < triangles; t++) {
            uint32_t near = random_below(&random, vertices), reach = 1 + random_below(&random, vertices);
            set_triangle(&mesh, t, near, (near + random_below(&random, reach)) % vertices,
                         (near + random_below(&random, reach)) % vertices);
        }
        mesh.indices[3ull * random_below(&random, triangles)] = 0; /* the one that has to be named */
        cutting cut = cut_at_random(&mesh, &random);
        compare(&mesh, &cut);
        hewn_triangles_destroy(&mesh);
    }
}

/* Vertices that arrive long after the faces that name them, and faces long after their vertices. */
static void test_far_apart(void **state)
{
    (void)state;
    hewn_triangles mesh = make_torus(20, 9);
    cutting late = {.parts = 3, .vertices = {0, 1, 1, mesh.vertex_count}};
    late.triangles[1] = late.triangles[2] = late.triangles[3] = mesh.triangle_count;
    compare(&mesh, &late);
    cutting early = {.parts = 3, .vertices = {0, mesh.vertex_count, mesh.vertex_count, mesh.vertex_count}};
    early.triangles[3] = mesh.triangle_count;
    compare(&mesh, &early);
    hewn_triangles_destroy(&mesh);
}

static void test_empty(void **state)
{
    (void)state;
    hewn_certifier *certifier;
    hewn_certificate whole, parts;
    assert_int_equal(hewn_certify(&(hewn_triangles){0}, NULL, &whole, NULL), HEWN_OK);
    assert_int_equal(hewn_certifier_create(&certifier, NULL), HEWN_OK);
    assert_int_equal(hewn_certifier_take(certifier, &(hewn_mesh_part){0}, NULL), HEWN_OK);
    assert_int_equal(hewn_certifier_finish(certifier, &parts, NULL), HEWN_OK);
    assert_true(parts.closed == whole.closed && parts.genus == whole.genus && parts.components == 0);
    assert_memory_equal(&whole.bounds, &parts.bounds, sizeof whole.bounds);
    hewn_certifier_destroy(&certifier);
    hewn_certifier_destroy(&certifier);
}

/* --- what breaks the agreement ------------------------------------------------------------------------------------ */

static const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const uint32_t faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

/* Takes the tetrahedron's vertices and first faces in parts, until one fails. */
static hewn_result take_all(const hewn_mesh_part *parts, size_t count, const char *reason)
{
    hewn_certifier *certifier;
    hewn_certificate certificate;
    hewn_error error = {0};
    hewn_result result = hewn_certifier_create(&certifier, NULL);
    for (size_t i = 0; i < count && result == HEWN_OK; i++)
        result = hewn_certifier_take(certifier, &parts[i], &error);
    if (result == HEWN_OK)
        result = hewn_certifier_finish(certifier, &certificate, &error);
    if (result != HEWN_OK && !strstr(error.message, reason))
        fail_msg("'%s' does not say '%s'", error.message, reason);
    hewn_certifier_destroy(&certifier);
    return result;
}

static void test_broken_agreements(void **state)
{
    (void)state;
    const hewn_number_run all = {0, 4}, last = {3, 1};
    const hewn_vertex_run vertices = {0, 4, corners, NULL}, three = {0, 3, corners, NULL}, none = {0};
    const hewn_triangle_run triangles = {0, 4, faces}, first = {0, 1, faces}, rest = {1, 3, faces + 3};
    const hewn_mesh_part good[] = {{{three, none}, {triangles}, &last, 1},
                                   {{{3, 1, corners + 9, NULL}}, {{0}}, NULL, 0}};
    assert_int_equal(take_all(good, 2, ""), HEWN_OK);
    const hewn_mesh_part closed[] = {{{vertices}, {first}, NULL, 0}, {{none}, {rest}, NULL, 0}};
    assert_int_equal(take_all(closed, 2, "is not open"), HEWN_INVALID_ARGUMENT);
    const hewn_mesh_part missing[] = {{{three}, {triangles}, &last, 1}};
    assert_int_equal(take_all(missing, 1, "not complete"), HEWN_INVALID_ARGUMENT);
    const hewn_mesh_part unknown[] = {{{three}, {triangles}, NULL, 0}};
    assert_int_equal(take_all(unknown, 1, "is not open"), HEWN_INVALID_ARGUMENT);
    const hewn_mesh_part twice[] = {{{vertices}, {triangles}, &all, 1}, {{vertices}, {{0}}, NULL, 0}};
    assert_int_equal(take_all(twice, 2, "comes twice"), HEWN_INVALID_ARGUMENT);
    const hewn_mesh_part late[] = {{{{1, 3, corners + 3, NULL}}, {triangles}, &all, 1}};
    assert_int_equal(take_all(late, 1, "before vertex 0"), HEWN_INVALID_ARGUMENT);
    const hewn_mesh_part unnamed[] = {{{vertices}, {{0, 1, faces + 9}}, NULL, 0}};
    assert_int_equal(take_all(unnamed, 1, "names vertex 0"), HEWN_INVALID_ARGUMENT);
    const float bad[] = {0, 0, 0, 1, 0, 0, 0, NAN, 0, 0, 0, 1};
    const hewn_mesh_part not_finite[] = {{{{0, 4, bad, NULL}}, {triangles}, NULL, 0}};
    assert_int_equal(take_all(not_finite, 1, "not finite"), HEWN_BAD_INPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solids),
        cmocka_unit_test(test_soups),
        cmocka_unit_test(test_far_apart),
        cmocka_unit_test(test_empty),
        cmocka_unit_test(test_broken_agreements),
    };
    return cmocka_run_group_tests_name("certifier", tests, NULL, NULL);
}
