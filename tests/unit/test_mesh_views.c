/* The corner table and the winged edge: there and back, the same topology and ids. */
#include "test_mesh_half.h"

#include "hewn/mesh_views.h"

static double *positions_of(const hewn_mesh *mesh)
{
    double *positions = malloc((hewn_mesh_vert_bound(mesh) + 1u) * 3 * sizeof *positions);
    for (uint32_t v = 0; v < hewn_mesh_vert_bound(mesh); v++)
        memcpy(positions + 3 * v, hewn_vert_position(mesh, (hewn_vert){v}), 3 * sizeof *positions);
    return positions;
}

/* Vertices, faces and corners; half-edges too where `halves`. */
static void assert_same(const hewn_mesh *a, const hewn_mesh *b, bool halves)
{
    assert_int_equal(hewn_mesh_vert_count(a), hewn_mesh_vert_count(b));
    assert_int_equal(hewn_mesh_edge_count(a), hewn_mesh_edge_count(b));
    assert_int_equal(hewn_mesh_face_count(a), hewn_mesh_face_count(b));
    for (uint32_t f = 0; f < hewn_mesh_face_count(a); f++) {
        hewn_half h = hewn_face_half(a, (hewn_face){f}), k = hewn_face_half(b, (hewn_face){f});
        uint32_t degree = hewn_face_degree(a, (hewn_face){f});
        assert_int_equal(degree, hewn_face_degree(b, (hewn_face){f}));
        for (uint32_t i = 0; i < degree; i++, h = hewn_half_next(a, h), k = hewn_half_next(b, k)) {
            assert_int_equal(hewn_half_head(a, h).id, hewn_half_head(b, k).id);
            assert_int_equal(hewn_half_face(a, hewn_half_twin(h)).id, hewn_half_face(b, hewn_half_twin(k)).id);
        }
    }
    for (uint32_t i = 0; halves && i < hewn_mesh_half_bound(a); i++) {
        hewn_half h = {i};
        assert_int_equal(hewn_half_next(a, h).id, hewn_half_next(b, h).id);
        assert_int_equal(hewn_half_prev(a, h).id, hewn_half_prev(b, h).id);
        assert_int_equal(hewn_half_head(a, h).id, hewn_half_head(b, h).id);
        assert_int_equal(hewn_half_face(a, h).id, hewn_half_face(b, h).id);
    }
    for (uint32_t v = 0; halves && v < hewn_mesh_vert_bound(a); v++)
        assert_int_equal(hewn_vert_half(a, (hewn_vert){v}).id, hewn_vert_half(b, (hewn_vert){v}).id);
}

/* In both tables: O is its own inverse, and the corners across a side see the same two vertices. */
static void assert_table(const hewn_corner_table *table)
{
    for (uint32_t c = 0; c < 3 * table->triangle_count; c++) {
        uint32_t o = table->opposites[c], t = c / 3 * 3;
        if (o == HEWN_NONE)
            continue;
        uint32_t s = o / 3 * 3;
        assert_int_equal(table->opposites[o], c);
        assert_int_equal(table->vertices[t + (c - t + 1) % 3], table->vertices[s + (o - s + 2) % 3]);
        assert_int_equal(table->vertices[t + (c - t + 2) % 3], table->vertices[s + (o - s + 1) % 3]);
    }
}

/* Edited, so that ids are not those of the builder. */
static hewn_mesh *edited(hewn_mesh *mesh, uint64_t seed, bool triangles)
{
    random_state random = {seed};
    for (int i = 0; i < 200; i++) {
        hewn_half h = {random_below(&random, hewn_mesh_half_bound(mesh))};
        hewn_mesh_flip(mesh, h);
        if (i % 5 == 0 && hewn_mesh_has_half(mesh, h))
            assert_works(hewn_mesh_split(mesh, h, 0.4, NULL, error));
        if (i % 7 == 0)
            hewn_mesh_collapse(mesh, (hewn_half){random_below(&random, hewn_mesh_half_bound(mesh))});
    }
    if (triangles)
        assert_works(hewn_mesh_triangulate(mesh, error));
    assert_works(hewn_mesh_compact(mesh, error));
    assert_valid(mesh);
    return mesh;
}

static void round_trip(hewn_mesh *mesh, bool triangles)
{
    double *positions = positions_of(mesh);
    hewn_mesh *back;
    hewn_winged_edges edges;
    assert_works(hewn_winged_edges_from_mesh(mesh, &edges, error));
    assert_works(hewn_winged_edges_to_mesh(&edges, positions, &back, error));
    assert_same(mesh, back, true);
    hewn_mesh_destroy(&back);
    hewn_winged_edges_destroy(&edges);
    assert_null(edges.edges);
    if (triangles) {
        hewn_corner_table table;
        assert_works(hewn_corner_table_from_mesh(mesh, &table, error));
        assert_table(&table);
        assert_works(hewn_corner_table_to_mesh(&table, positions, &back, error));
        assert_valid(back);
        assert_same(mesh, back, false);
        hewn_mesh_destroy(&back);
        hewn_corner_table_destroy(&table);
    }
    free(positions);
    hewn_mesh_destroy(&mesh);
}

static void test_round_trips(void **state)
{
    (void)state;
    round_trip(tetrahedron(), true);
    round_trip(flat_grid(5, true), true);
    round_trip(flat_grid(5, false), false);
    round_trip(quad_cube(), false);
    for (uint64_t seed = 1; seed < 40; seed++) {
        round_trip(edited(torus(8, 6), seed, true), true);
        round_trip(edited(flat_grid(6, true), seed, true), true);
        round_trip(edited(flat_grid(6, false), seed, false), false);
    }
}

static void test_refusals(void **state)
{
    (void)state;
    hewn_mesh *mesh = flat_grid(3, true), *back;
    double *positions = positions_of(mesh);
    hewn_corner_table table;
    hewn_winged_edges edges;
    random_state random = {1};
    assert_works(hewn_corner_table_from_mesh(mesh, &table, error));
    table.opposites[4] ^= 1;
    assert_refused(hewn_corner_table_to_mesh(&table, positions, &back, error), HEWN_BAD_INPUT, "corner 4");
    assert_null(back);
    hewn_corner_table_destroy(&table);
    /* Any one number of the records changed: refused. */
    assert_works(hewn_winged_edges_from_mesh(mesh, &edges, error));
    for (int run = 0; run < 3000; run++) {
        uint32_t *words = (uint32_t *)edges.edges, at = random_below(&random, 8 * edges.edge_count), keep = words[at];
        words[at] = random_below(&random, 50) == 0 ? HEWN_NONE : random_below(&random, edges.edge_count + 2);
        if (words[at] != keep && hewn_winged_edges_to_mesh(&edges, positions, &back, NULL) != HEWN_BAD_INPUT)
            fail_msg("number %u of edge %u may be %u instead of %u", at % 8, at / 8, words[at], keep);
        words[at] = keep;
    }
    for (uint32_t e = 0; e < edges.edge_count; e++)
        if (edges.edges[e].left != 2 && edges.edges[e].right != 2)
            edges.face_edges[2] = e;
    assert_refused(hewn_winged_edges_to_mesh(&edges, positions, &back, error), HEWN_BAD_INPUT, "face 2");
    hewn_winged_edges_destroy(&edges);
    assert_works(hewn_mesh_delete_face(mesh, (hewn_face){3}, error));
    assert_refused(hewn_corner_table_from_mesh(mesh, &table, error), HEWN_INVALID_ARGUMENT, "holes");
    assert_refused(hewn_winged_edges_from_mesh(mesh, &edges, error), HEWN_INVALID_ARGUMENT, "holes");
    hewn_mesh_destroy(&mesh);
    mesh = quad_cube();
    assert_refused(hewn_corner_table_from_mesh(mesh, &table, error), HEWN_INVALID_ARGUMENT, "face 0 is not a triangle");
    hewn_mesh_destroy(&mesh);
    free(positions);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trips),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests_name("mesh_views", tests, NULL, NULL);
}
