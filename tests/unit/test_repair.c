/* Soup into mesh: random soups against what every mesh must be, and hand-made faults against their counts. */
#include "test_repair_support.h"

/* --- random soups ------------------------------------------------------------------------------------------------- */

static uint32_t rounds(uint32_t count)
{
    return getenv("HEWN_LONG") ? 50 * count : count;
}

/* Few vertices and many faces give every way in which a soup can fail to be a mesh. */
static builder random_soup(random_state *random, bool polygons)
{
    uint32_t vertices = 4 + random_below(random, 9), faces = 1 + random_below(random, 40);
    builder soup = make_builder(vertices, faces, 8 * (size_t)faces);
    uint32_t steps = random_below(random, 2) ? 3 : 1000000;
    for (uint32_t v = 0; v < vertices; v++)
        add_vertex(&soup, random_below(random, steps), random_below(random, steps), random_below(random, steps));
    for (uint32_t f = 0; f < faces; f++) {
        uint32_t corners[8], count = polygons ? random_below(random, 8) : 3;
        for (uint32_t k = 0; k < count; k++)
            corners[k] = random_below(random, vertices);
        add_face(&soup, count, corners);
    }
    return soup;
}

static hewn_repair_desc random_desc(random_state *random)
{
    return (hewn_repair_desc){.opposite = random_below(random, HEWN_OPPOSITE_COUNT),
                              .outward = random_below(random, HEWN_OUTWARD_COUNT),
                              .keep_directions = random_below(random, 4) == 0,
                              .least_faces = random_below(random, 3) ? 0 : random_below(random, 5),
                              .fill_edges = random_below(random, 2) ? 0 : random_below(random, 14),
                              .fill_flat = random_below(random, 2) == 0,
                              .keep_isolated = random_below(random, 4) == 0};
}

static void test_random_triangles(void **state)
{
    (void)state;
    random_state random = {1};
    for (uint32_t round = 0; round < rounds(600); round++) {
        hewn_repair_desc desc = random_desc(&random);
        builder soup = random_soup(&random, false);
        repaired result = repair(&soup.polygons, &desc);
        check_idempotent(&result, &desc);
        free_repaired(&result);
        free_builder(&soup);
    }
}

static void test_random_polygons(void **state)
{
    (void)state;
    random_state random = {2};
    for (uint32_t round = 0; round < rounds(500); round++) {
        hewn_repair_desc desc = random_desc(&random);
        builder soup = random_soup(&random, true);
        repaired result = repair(&soup.polygons, &desc);
        check_idempotent(&result, &desc);
        free_repaired(&result);
        free_builder(&soup);
    }
}

static void test_same_bytes(void **state)
{
    (void)state;
    random_state random = {3};
    for (uint32_t round = 0; round < rounds(60); round++) {
        hewn_repair_desc desc = random_desc(&random);
        builder soup = random_soup(&random, true);
        repaired a = repair(&soup.polygons, &desc), b = repair(&soup.polygons, &desc);
        double *p, *q;
        hewn_polygons left = polygons_of(&a, &p), right = polygons_of(&b, &q);
        assert_memory_equal(&a.report, &b.report, sizeof a.report);
        assert_int_equal(left.vertex_count, right.vertex_count);
        assert_int_equal(left.face_count, right.face_count);
        assert_memory_equal(p, q, 3 * sizeof(double) * left.vertex_count);
        assert_memory_equal(left.corners, right.corners, sizeof(uint32_t) * left.first[left.face_count]);
        hewn_free(p);
        hewn_free(q);
        free_repaired(&a);
        free_repaired(&b);
        free_builder(&soup);
    }
}

/* --- hand-made faults --------------------------------------------------------------------------------------------- */

static void test_good_mesh_stays(void **state)
{
    (void)state;
    builder soup = make_builder(32, 32, 128);
    add_cube(&soup, 0, 0, 0, 6);
    repaired result = repair(&soup.polygons, NULL);
    hewn_repair_report none = {0};
    assert_memory_equal(&result.report, &none, sizeof none);
    assert_memory_equal(result.origins.corners, soup.corners, 24 * sizeof(uint32_t));
    assert_true(result.certificate.closed && result.certificate.volume == 1);
    free_repaired(&result);
    free_builder(&soup);
}

static void replace_vertex(builder *soup, uint32_t from, uint32_t to)
{
    for (uint64_t c = 0; c < soup->first[soup->polygons.face_count]; c++)
        if (soup->corners[c] == from)
            soup->corners[c] = to;
}

static void test_cubes_sharing_an_edge(void **state)
{
    (void)state;
    builder soup = make_builder(32, 32, 128);
    add_cube(&soup, 0, 0, 0, 6);
    add_cube(&soup, 1, 1, 0, 6);
    replace_vertex(&soup, 8, 3);
    replace_vertex(&soup, 12, 7);
    assert_refused(&soup.polygons, &(hewn_repair_desc){.strict = true}, HEWN_BAD_INPUT, "the edge 3, 7 has 4 faces");
    repaired result = take(soup, NULL);
    assert_true(result.certificate.closed);
    assert_int_equal(result.certificate.components, 2);
    assert_true(result.certificate.volume == 2);
    assert_int_equal(result.report.non_manifold_edges, 1);
    assert_int_equal(result.report.non_manifold_vertices, 2);
    assert_int_equal(result.report.vertex_copies, 2);
    assert_int_equal(result.report.isolated_vertices, 2);
    free_repaired(&result);
}

static void test_cubes_sharing_a_vertex(void **state)
{
    (void)state;
    builder soup = make_builder(32, 32, 128);
    add_cube(&soup, 0, 0, 0, 6);
    add_cube(&soup, 1, 1, 1, 6);
    replace_vertex(&soup, 8, 7);
    assert_refused(&soup.polygons, &(hewn_repair_desc){.strict = true}, HEWN_BAD_INPUT, "the faces at vertex 7 form");
    repaired result = take(soup, NULL);
    assert_true(result.certificate.closed);
    assert_int_equal(result.certificate.components, 2);
    assert_int_equal(result.report.non_manifold_edges, 0);
    assert_int_equal(result.report.non_manifold_vertices, 1);
    assert_int_equal(result.report.vertex_copies, 1);
    free_repaired(&result);
}

/* Both cubes have the wall between them. */
static builder cubes_with_wall(void)
{
    builder soup = make_builder(32, 32, 128);
    add_cube(&soup, 0, 0, 0, 6);
    add_cube(&soup, 1, 0, 0, 6);
    for (uint32_t k = 0; k < 4; k++)
        replace_vertex(&soup, 8 + 2 * k, 1 + 2 * k);
    return soup;
}

/* Two closed sheets of the same corners would also be closed and have no volume; here each face has four neighbours. */
static void assert_no_face_meets_another_twice(const hewn_mesh *mesh)
{
    for (uint32_t f = 0; f < hewn_mesh_face_count(mesh); f++) {
        hewn_half h = hewn_face_half(mesh, (hewn_face){f});
        for (int k = 0; k < 4; k++, h = hewn_half_next(mesh, h)) {
            hewn_half next = hewn_half_next(mesh, h);
            assert_int_not_equal(hewn_half_face(mesh, hewn_half_twin(h)).id,
                                 hewn_half_face(mesh, hewn_half_twin(next)).id);
        }
    }
}

static void test_wall_between_cubes(void **state)
{
    (void)state;
    repaired kept = take(cubes_with_wall(), &(hewn_repair_desc){.opposite = HEWN_OPPOSITE_KEEP});
    assert_true(kept.certificate.closed);
    assert_int_equal(kept.certificate.components, 2);
    assert_true(kept.certificate.volume == 2);
    assert_int_equal(kept.report.non_manifold_edges, 4);
    assert_int_equal(kept.report.duplicate_faces, 0);
    assert_no_face_meets_another_twice(kept.mesh);
    free_repaired(&kept);
    repaired merged = take(cubes_with_wall(), &(hewn_repair_desc){.opposite = HEWN_OPPOSITE_CANCEL});
    assert_true(merged.certificate.closed);
    assert_int_equal(merged.certificate.components, 1);
    assert_true(merged.certificate.volume == 2);
    assert_int_equal(merged.report.non_manifold_edges, 0);
    assert_int_equal(merged.report.duplicate_faces, 2);
    free_repaired(&merged);
    repaired one = take(cubes_with_wall(), &(hewn_repair_desc){.fill_edges = 4});
    assert_true(one.certificate.closed);
    assert_true(one.certificate.volume == 2);
    assert_int_equal(one.report.duplicate_faces, 1);
    assert_int_equal(one.report.filled_holes, 1);
    free_repaired(&one);
}

static void test_three_faces_at_an_edge(void **state)
{
    (void)state;
    builder soup = make_builder(8, 8, 32);
    add_vertex(&soup, 0, 0, 0);
    add_vertex(&soup, 0, 0, 1);
    add_vertex(&soup, 1, 0, 0);
    add_vertex(&soup, -1, 0, 0);
    add_vertex(&soup, 0, 1, 0);
    add_triangle(&soup, 0, 1, 2);
    add_triangle(&soup, 1, 0, 3);
    add_triangle(&soup, 1, 0, 4);
    repaired result = take(soup, NULL);
    assert_int_equal(result.report.non_manifold_edges, 1);
    assert_int_equal(result.report.non_manifold_vertices, 2);
    assert_int_equal(result.certificate.components, 2);
    assert_int_equal(result.certificate.boundary_edges, 7);
    assert_int_equal(result.origins.vertex_count, 7);
    free_repaired(&result);
}

/* A closed ring of quads, half-turned or not. */
static builder band(uint32_t count, bool moebius)
{
    builder soup = make_builder(2 * (size_t)count, count, 4 * (size_t)count);
    for (uint32_t i = 0; i < count; i++) {
        double u = 2 * M_PI * i / count, v = moebius ? u / 2 : 0;
        for (int side = -1; side <= 1; side += 2)
            add_vertex(&soup, (3 + side * cos(v)) * cos(u), (3 + side * cos(v)) * sin(u),
                       side * sin(v) + side * !moebius);
    }
    for (uint32_t i = 0; i < count; i++) {
        bool twist = moebius && i + 1 == count;
        uint32_t a = 2 * i, b = 2 * ((i + 1) % count);
        add_face(&soup, 4, (uint32_t[]){a, b + twist, b + 1 - twist, a + 1});
    }
    return soup;
}

static void test_moebius_band_is_cut_once(void **state)
{
    (void)state;
    builder soup = band(20, true);
    assert_refused(&soup.polygons, &(hewn_repair_desc){.strict = true}, HEWN_BAD_INPUT, "disagree in direction");
    repaired result = take(soup, NULL);
    assert_int_equal(result.report.one_sided_cuts, 1);
    assert_int_equal(result.report.vertex_copies, 2);
    assert_int_equal(result.certificate.components, 1);
    assert_int_equal(result.certificate.boundary_edges, 42);
    free_repaired(&result);
    result = take(band(20, false), NULL);
    assert_int_equal(result.report.one_sided_cuts + result.report.turned_faces, 0);
    free_repaired(&result);
}

static void test_turned_faces(void **state)
{
    (void)state;
    for (unsigned mask = 0; mask < 64; mask++) {
        builder soup = make_builder(32, 32, 128);
        unsigned count = (unsigned)__builtin_popcount(mask);
        add_cube(&soup, 0, 0, 0, 6);
        for (unsigned f = 0; f < 6; f++)
            if (mask >> f & 1)
                turn_face(&soup, f);
        repaired result = take(soup, NULL);
        bool all = mask == 63; /* inside out, but consistent: it may be a cavity */
        assert_true(result.certificate.closed);
        assert_true(result.certificate.volume == (all ? -1 : 1));
        assert_int_equal(result.report.turned_faces, all ? 0 : count);
        free_repaired(&result);
    }
}

static void test_outward(void **state)
{
    (void)state;
    for (int rule = 0; rule < HEWN_OUTWARD_COUNT; rule++) {
        builder soup = make_builder(32, 32, 128);
        add_cube(&soup, 0, 0, 0, 6);
        add_cube(&soup, 5, 0, 0, 6);
        for (uint64_t f = 0; f < 11; f++)
            turn_face(&soup, f); /* the first cube inside out, the second but for one face */
        repaired result = take(soup, &(hewn_repair_desc){.outward = (hewn_outward)rule});
        double expected = rule == HEWN_OUTWARD_NEVER ? -2 : rule == HEWN_OUTWARD_ALWAYS ? 2 : 0;
        assert_true(result.certificate.volume == expected);
        assert_int_equal(result.report.turned_components, rule == HEWN_OUTWARD_NEVER    ? 0
                                                          : rule == HEWN_OUTWARD_ALWAYS ? 2
                                                                                        : 1);
        free_repaired(&result);
    }
}

static void test_duplicates(void **state)
{
    (void)state;
    builder soup = make_builder(32, 32, 128);
    add_cube(&soup, 0, 0, 0, 6);
    add_face(&soup, 4, (uint32_t[]){6, 2, 0, 4}); /* the first side, begun elsewhere */
    add_face(&soup, 4, (uint32_t[]){2, 6, 4, 0}); /* and the other way around */
    assert_refused(&soup.polygons, &(hewn_repair_desc){.strict = true}, HEWN_BAD_INPUT, "face 6 has the same corners");
    for (int rule = 0; rule < HEWN_OPPOSITE_COUNT; rule++) {
        repaired result = repair(&soup.polygons, &(hewn_repair_desc){.opposite = (hewn_opposite)rule});
        assert_int_equal(result.report.duplicate_faces, rule == HEWN_OPPOSITE_KEEP ? 1 : 2);
        assert_int_equal(result.origins.face_count, rule == HEWN_OPPOSITE_KEEP ? 7 : 6);
        assert_true(rule == HEWN_OPPOSITE_KEEP || result.certificate.closed);
        free_repaired(&result);
    }
    free_builder(&soup);
}

static void test_degenerate_faces(void **state)
{
    (void)state;
    builder soup = make_builder(32, 32, 128);
    for (uint32_t v = 0; v < 7; v++)
        add_vertex(&soup, v, v * v, 0);
    add_face(&soup, 0, NULL);
    add_face(&soup, 2, (uint32_t[]){0, 1});
    add_triangle(&soup, 2, 2, 2);
    add_face(&soup, 4, (uint32_t[]){0, 1, 0, 1});
    add_face(&soup, 5, (uint32_t[]){0, 1, 1, 2, 0});          /* a triangle */
    add_face(&soup, 6, (uint32_t[]){3, 4, 5, 3, 6, 2});       /* two triangles at vertex 3 */
    add_face(&soup, 8, (uint32_t[]){0, 3, 0, 4, 4, 6, 5, 4}); /* a spike and a triangle */
    assert_refused(&soup.polygons, &(hewn_repair_desc){.strict = true}, HEWN_BAD_INPUT, "face 0 has only 0 corners");
    repaired result = take(soup, NULL);
    assert_int_equal(result.report.degenerate_faces, 4);
    assert_int_equal(result.report.cleaned_faces, 3);
    assert_int_equal(result.origins.face_count, 4);
    assert_int_equal(result.origins.face_origins[0], 4);
    assert_int_equal(result.origins.face_origins[1], 5);
    assert_int_equal(result.origins.face_origins[2], 5);
    assert_int_equal(result.origins.face_origins[3], 6);
    free_repaired(&result);
}

static void test_flat_faces(void **state)
{
    (void)state;
    for (int drop = 0; drop < 2; drop++) {
        builder soup = make_builder(8, 8, 32);
        for (uint32_t v = 0; v < 4; v++)
            add_vertex(&soup, v, 0, v == 3);
        add_triangle(&soup, 0, 1, 2);
        add_triangle(&soup, 1, 0, 3);
        repaired result = take(soup, &(hewn_repair_desc){.drop_flat = drop});
        assert_int_equal(result.report.flat_faces, drop);
        assert_int_equal(result.origins.face_count, 2 - drop);
        assert_int_equal(result.report.isolated_vertices, drop);
        free_repaired(&result);
    }
}

static void test_islands_and_isolated(void **state)
{
    (void)state;
    builder soup = make_builder(64, 64, 256);
    add_cube(&soup, 0, 0, 0, 6);
    add_vertex(&soup, 100, 100, 100);
    uint32_t a = add_vertex(&soup, 3, 0, 0);
    add_vertex(&soup, 3.1, 0, 0);
    add_vertex(&soup, 3, 0.1, 0);
    add_triangle(&soup, a, a + 1, a + 2);
    repaired few = repair(&soup.polygons, &(hewn_repair_desc){.least_faces = 2});
    repaired small = repair(&soup.polygons, &(hewn_repair_desc){.least_share = 0.1, .keep_isolated = true});
    repaired neither = repair(&soup.polygons, &(hewn_repair_desc){.least_faces = 1, .least_share = 0.01});
    assert_refused(&soup.polygons, &(hewn_repair_desc){.strict = true, .least_faces = 2}, HEWN_BAD_INPUT,
                   "the component of vertex 9 is too small");
    free_builder(&soup);
    assert_int_equal(few.report.removed_components, 1);
    assert_int_equal(few.report.removed_faces, 1);
    assert_int_equal(few.report.isolated_vertices, 4);
    assert_int_equal(few.origins.vertex_count, 8);
    assert_int_equal(small.report.removed_components, 1);
    assert_int_equal(small.origins.vertex_count, 12);
    assert_int_equal(neither.report.removed_components, 0);
    assert_int_equal(neither.origins.vertex_count, 11);
    free_repaired(&few);
    free_repaired(&small);
    free_repaired(&neither);
}

/* --- bad input ---------------------------------------------------------------------------------------------------- */

static void test_refuses_nonsense(void **state)
{
    (void)state;
    double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t corners[6] = {0, 1, 2, 2, 1, 0};
    uint64_t first[3] = {0, 3, 6};
    hewn_polygons good = {3, positions, 2, first, corners}, soup = good;
    positions[4] = NAN;
    assert_refused(&soup, NULL, HEWN_BAD_INPUT, "vertex 1 lies at");
    positions[4] = -INFINITY;
    assert_refused(&soup, NULL, HEWN_BAD_INPUT, "vertex 1 lies at");
    positions[4] = 0;
    corners[5] = 3;
    assert_refused(&soup, NULL, HEWN_BAD_INPUT, "face 1 has the corner 3");
    corners[5] = UINT32_MAX;
    assert_refused(&soup, NULL, HEWN_BAD_INPUT, "face 1 has the corner 4294967295");
    corners[5] = 0;
    first[1] = 7;
    assert_refused(&soup, NULL, HEWN_BAD_INPUT, "face 1 ends before");
    first[1] = 3;
    first[2] = 1ull << 40;
    assert_refused(&soup, NULL, HEWN_LIMIT, "corners");
    first[2] = 6;
    first[0] = 1;
    assert_refused(&soup, NULL, HEWN_BAD_INPUT, "face 0 begins");
    first[0] = 0;
    soup.face_count = UINT64_MAX;
    assert_refused(&soup, NULL, HEWN_LIMIT, "faces");
    soup.first = NULL;
    assert_refused(&soup, NULL, HEWN_LIMIT, "faces");
    soup = good;
    soup.vertex_count = UINT64_MAX;
    assert_refused(&soup, NULL, HEWN_LIMIT, "vertices");
    soup = good;
    soup.positions = NULL;
    assert_refused(&soup, NULL, HEWN_INVALID_ARGUMENT, "without");
    assert_refused(&good, &(hewn_repair_desc){.weld_distance = NAN}, HEWN_INVALID_ARGUMENT, "weld");
    assert_refused(&good, &(hewn_repair_desc){.weld_distance = -1}, HEWN_INVALID_ARGUMENT, "weld");
    assert_refused(&good, &(hewn_repair_desc){.least_share = 2}, HEWN_INVALID_ARGUMENT, "share");
    assert_refused(&good, &(hewn_repair_desc){.fill_edges = HEWN_FILL_LIMIT + 1}, HEWN_INVALID_ARGUMENT, "512");
    assert_refused(&good, &(hewn_repair_desc){.opposite = HEWN_OPPOSITE_COUNT}, HEWN_INVALID_ARGUMENT, "rule");
    soup = (hewn_polygons){0};
    repaired empty =
        repair(&soup, &(hewn_repair_desc){.weld = true, .weld_distance = 1, .fill_edges = 9, .least_faces = 1});
    assert_int_equal(empty.origins.face_count, 0);
    free_repaired(&empty);
}

static bool stop(void *user, const char *stage, double fraction)
{
    double *limit = user;
    assert_string_equal(stage, "repair");
    return fraction < *limit;
}

static void test_cancel(void **state)
{
    (void)state;
    builder soup = make_builder(32, 32, 128);
    add_cube(&soup, 0, 0, 0, 0);
    for (double limit = 0; limit <= 1; limit += 0.125) {
        hewn_progress progress = {stop, &limit};
        assert_refused(&soup.polygons, &(hewn_repair_desc){.fill_edges = 9, .progress = &progress}, HEWN_CANCELLED,
                       "repair");
    }
    free_builder(&soup);
}

/* Long faces, and a great many faces at one edge. */
static void test_hostile_faces(void **state)
{
    (void)state;
    enum { LONG = 1000000, MANY = 100000 };
    builder soup = make_builder(LONG + 2, 8, 4 * (size_t)LONG);
    uint32_t *corners = hewn_alloc(LONG, sizeof *corners);
    for (uint32_t v = 0; v < LONG; v++)
        corners[v] = add_vertex(&soup, cos(v * 1e-5), sin(v * 1e-5), v);
    add_face(&soup, LONG, corners);
    add_face(&soup, LONG, corners);
    for (uint32_t v = 0; v < LONG; v++)
        corners[v] = v % 2 ? 7 : v / 2;
    add_face(&soup, LONG, corners);
    hewn_mesh *mesh;
    hewn_repair_report report;
    assert_int_equal(hewn_mesh_from_soup(&soup.polygons, NULL, &mesh, &report, NULL, NULL), HEWN_OK);
    assert_int_equal(hewn_mesh_face_count(mesh), 1);
    assert_int_equal(report.duplicate_faces, 1);
    assert_int_equal(report.degenerate_faces, 1);
    hewn_mesh_destroy(&mesh);
    hewn_free(corners);
    free_builder(&soup);
    soup = make_builder(MANY + 2, MANY, 3 * (size_t)MANY);
    add_vertex(&soup, 0, 0, 0);
    add_vertex(&soup, 0, 0, 1);
    for (uint32_t f = 0; f < MANY; f++)
        add_triangle(&soup, f % 3 == 0, f % 3 != 0, add_vertex(&soup, f % 1000, f / 1000.0, 0));
    repaired result = take(soup, NULL);
    assert_int_equal(result.report.non_manifold_edges, 1);
    assert_int_equal(result.origins.face_count, MANY);
    free_repaired(&result);
}

static void test_extreme_positions(void **state)
{
    (void)state;
    random_state random = {5};
    for (uint32_t round = 0; round < rounds(300); round++) {
        builder soup = random_soup(&random, false);
        for (uint64_t i = 0; i < 3 * soup.polygons.vertex_count; i++) {
            uint64_t bits = random_bits(&random);
            memcpy(soup.positions + i, &bits, sizeof bits);
            if (!isfinite(soup.positions[i]))
                soup.positions[i] = random_below(&random, 2) ? 1.7e308 : -5e-324;
        }
        hewn_repair_desc desc = {.weld = true, .fill_edges = 20, .drop_flat = true, .least_share = 0.1};
        desc.weld_distance = round % 3 == 0 ? 0 : round % 3 == 1 ? 1e300 : 5e-324;
        hewn_mesh *mesh;
        hewn_error error = {0};
        if (hewn_mesh_from_soup(&soup.polygons, &desc, &mesh, NULL, NULL, &error) != HEWN_OK)
            fail_msg("%s", error.message);
        hewn_mesh_destroy(&mesh);
        free_builder(&soup);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_triangles),
        cmocka_unit_test(test_random_polygons),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_good_mesh_stays),
        cmocka_unit_test(test_cubes_sharing_an_edge),
        cmocka_unit_test(test_cubes_sharing_a_vertex),
        cmocka_unit_test(test_wall_between_cubes),
        cmocka_unit_test(test_three_faces_at_an_edge),
        cmocka_unit_test(test_moebius_band_is_cut_once),
        cmocka_unit_test(test_turned_faces),
        cmocka_unit_test(test_outward),
        cmocka_unit_test(test_duplicates),
        cmocka_unit_test(test_degenerate_faces),
        cmocka_unit_test(test_flat_faces),
        cmocka_unit_test(test_islands_and_isolated),
        cmocka_unit_test(test_refuses_nonsense),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_hostile_faces),
        cmocka_unit_test(test_extreme_positions),
    };
    return cmocka_run_group_tests_name("repair", tests, NULL, NULL);
}
