/* Filling holes: what comes out is closed, has the volume that was missing, and looks like its surroundings. */
#include "test_repair_support.h"

static void test_cube_without_a_side(void **state)
{
    (void)state;
    for (int side = 0; side < 6; side++) {
        builder soup = make_builder(16, 8, 32);
        add_cube(&soup, 2, 3, 4, side);
        assert_refused(&soup.polygons, &(hewn_repair_desc){.strict = true, .fill_edges = 4}, HEWN_BAD_INPUT,
                       "a hole of 4 edges");
        repaired small = repair(&soup.polygons, &(hewn_repair_desc){.fill_edges = 3});
        assert_int_equal(small.report.filled_holes + small.report.kept_holes, 0);
        free_repaired(&small);
        repaired result = take(soup, &(hewn_repair_desc){.fill_edges = 4});
        assert_true(result.certificate.closed);
        assert_true(result.certificate.volume == 1);
        assert_int_equal(result.report.filled_holes, 1);
        assert_int_equal(result.report.filled_edges, 4);
        assert_int_equal(result.report.added_faces, 2);
        assert_int_equal(result.report.added_vertices, 0);
        free_repaired(&result);
    }
}

/* A sphere of rings and sectors without what lies above `top`. */
static builder open_sphere(uint32_t rings, uint32_t sectors, uint32_t top, const double centre[3], double radius)
{
    builder soup = make_builder((size_t)rings * sectors + 1, (size_t)rings * sectors, 4 * (size_t)rings * sectors);
    uint32_t pole = add_vertex(&soup, centre[0], centre[1], centre[2] - radius);
    for (uint32_t r = 1; r < top; r++)
        for (uint32_t s = 0; s < sectors; s++) {
            double v = M_PI * r / rings, u = 2 * M_PI * s / sectors;
            add_vertex(&soup, centre[0] + radius * sin(v) * cos(u), centre[1] + radius * sin(v) * sin(u),
                       centre[2] - radius * cos(v));
        }
    for (uint32_t s = 0; s < sectors; s++) {
        uint32_t next = (s + 1) % sectors;
        add_triangle(&soup, pole, 1 + next, 1 + s);
        for (uint32_t r = 0; r + 2 < top; r++) {
            uint32_t a = 1 + r * sectors, b = a + sectors;
            add_face(&soup, 4, (uint32_t[]){a + s, a + next, b + next, b + s});
        }
    }
    return soup;
}

static void test_sphere_without_a_cap(void **state)
{
    (void)state;
    const double centre[3] = {10, -20, 30};
    for (uint32_t top = 40; top >= 34; top -= 3) {
        builder soup = open_sphere(44, 48, top, centre, 5);
        repaired flat = repair(&soup.polygons, &(hewn_repair_desc){.fill_edges = 48, .fill_flat = true});
        repaired fair = repair(&soup.polygons, &(hewn_repair_desc){.fill_edges = 48});
        check_idempotent(&fair, &(hewn_repair_desc){.fill_edges = 48});
        free_builder(&soup);
        double whole = 4 * M_PI / 3 * 125, worst = 0;
        assert_true(flat.certificate.closed && fair.certificate.closed);
        assert_int_equal(flat.report.added_vertices, 0);
        assert_int_equal(flat.report.added_faces, 46);
        assert_true(fair.report.added_vertices > 30 && fair.report.added_vertices < 2000);
        double missing = whole - flat.certificate.volume, left = whole - fair.certificate.volume;
        assert_true(missing > 0);
        for (uint32_t v = 0; v < fair.origins.vertex_count; v++) {
            const double *p = hewn_vert_position(fair.mesh, (hewn_vert){v});
            double radius = sqrt(pow(p[0] - centre[0], 2) + pow(p[1] - centre[1], 2) + pow(p[2] - centre[2], 2));
            worst = fmax(worst, fabs(radius - 5));
        }
        assert_true(fabs(left) < 0.01 * whole && worst < 0.2);
        free_repaired(&flat);
        free_repaired(&fair);
    }
}

/* A plate with a hole, all in a plane: what is filled in lies in the plane too. */
static void test_plane_stays_plane(void **state)
{
    (void)state;
    enum { N = 24 };
    builder soup = make_builder(N * N, N * N, 4 * N * N);
    for (uint32_t i = 0; i < N * N; i++)
        add_vertex(&soup, i % N, i / N, 0.25 * (i % N)); /* tilted */
    for (uint32_t y = 0; y + 1 < N; y++)
        for (uint32_t x = 0; x + 1 < N; x++) {
            uint32_t a = y * N + x;
            bool hole = x >= 8 && x < 15 && y >= 6 && y < 16;
            if (!hole)
                add_face(&soup, 4, (uint32_t[]){a, a + 1, a + N + 1, a + N});
        }
    repaired result = take(soup, &(hewn_repair_desc){.fill_edges = 34});
    assert_int_equal(result.report.filled_holes, 1);
    assert_int_equal(result.report.filled_edges, 34);
    assert_int_equal(result.certificate.boundary_edges, 4 * (N - 1));
    for (uint32_t v = 0; v < result.origins.vertex_count; v++) {
        const double *p = hewn_vert_position(result.mesh, (hewn_vert){v});
        assert_true(fabs(p[2] - 0.25 * p[0]) < 1e-9);
    }
    assert_true(fabs(result.certificate.area - (N - 1) * (N - 1) * sqrt(1 + 0.0625)) < 1e-3);
    free_repaired(&result);
}

/* The hole of a lone triangle would only take the same triangle again. */
static void test_no_pillows(void **state)
{
    (void)state;
    builder soup = make_builder(8, 8, 32);
    add_vertex(&soup, 0, 0, 0);
    add_vertex(&soup, 1, 0, 0);
    add_vertex(&soup, 0, 1, 0);
    add_triangle(&soup, 0, 1, 2);
    repaired result = take(soup, &(hewn_repair_desc){.fill_edges = 10});
    assert_int_equal(result.report.kept_holes, 1);
    assert_int_equal(result.report.filled_holes, 0);
    free_repaired(&result);
}

/* The plane way across the hole of this roof is taken: one edge of the quad exists beneath it. */
static void test_existing_edges_are_kept_clear(void **state)
{
    (void)state;
    builder soup = make_builder(8, 8, 32);
    add_vertex(&soup, 0, 0, 0);
    add_vertex(&soup, 1, 0, 0);
    add_vertex(&soup, 1, 1, 0);
    add_vertex(&soup, 0, 1, 0);
    add_triangle(&soup, 0, 1, 2);
    add_triangle(&soup, 0, 2, 3);
    repaired result = take(soup, &(hewn_repair_desc){.fill_edges = 4});
    assert_true(result.certificate.closed);
    assert_int_equal(result.report.filled_holes, 1);
    assert_true(hewn_mesh_find_half(result.mesh, (hewn_vert){1}, (hewn_vert){3}).id != HEWN_NONE);
    free_repaired(&result);
}

/* The largest rim allowed, crooked; time and memory stay in bounds. */
static void test_large_crooked_hole(void **state)
{
    (void)state;
    uint32_t n = getenv("HEWN_LONG") ? HEWN_FILL_LIMIT : 128;
    random_state random = {7};
    builder soup = make_builder(2 * (size_t)n, n, 4 * (size_t)n);
    for (uint32_t i = 0; i < n; i++) {
        double u = 2 * M_PI * i / n, r = 1 + 0.3 * random_unit(&random);
        add_vertex(&soup, r * cos(u), r * sin(u), random_unit(&random));
        add_vertex(&soup, 1.5 * r * cos(u), 1.5 * r * sin(u), random_unit(&random) - 1);
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
        add_face(&soup, 4, (uint32_t[]){a, a + 1, b + 1, b});
    }
    repaired result = take(soup, &(hewn_repair_desc){.fill_edges = n});
    assert_int_equal(result.report.filled_holes, 2);
    assert_true(result.certificate.closed);
    free_repaired(&result);
}

/* Meshes of torus type with some triangles missing: every hole closes, far apart or not. */
static void test_random_holes(void **state)
{
    (void)state;
    random_state random = {9};
    for (int round = 0; round < (getenv("HEWN_LONG") ? 500 : 25); round++) {
        hewn_triangles torus = make_torus(16 + random_below(&random, 30), 8 + random_below(&random, 20));
        uint64_t whole = torus.triangle_count, kept = 0;
        for (uint64_t t = 0; t < whole; t++)
            if (random_below(&random, 10 + 10 * (uint32_t)round) != 0)
                memmove(torus.indices + 3 * kept++, torus.indices + 3 * t, 3 * sizeof(uint32_t));
        torus.triangle_count = kept;
        builder soup = copy_triangles(&torus);
        hewn_triangles_destroy(&torus);
        hewn_repair_desc desc = {.fill_edges = HEWN_FILL_LIMIT, .least_faces = 2};
        repaired result = repair(&soup.polygons, &desc);
        check_idempotent(&result, &desc);
        assert_int_equal(result.report.kept_holes, 0);
        assert_true(result.certificate.closed);
        free_repaired(&result);
        free_builder(&soup);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cube_without_a_side),
        cmocka_unit_test(test_sphere_without_a_cap),
        cmocka_unit_test(test_plane_stays_plane),
        cmocka_unit_test(test_no_pillows),
        cmocka_unit_test(test_existing_edges_are_kept_clear),
        cmocka_unit_test(test_large_crooked_hole),
        cmocka_unit_test(test_random_holes),
    };
    return cmocka_run_group_tests_name("repair_fill", tests, NULL, NULL);
}
