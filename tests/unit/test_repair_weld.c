/* Welding against a twin that compares every pair, whatever the order of the vertices. */
#include <time.h>

#include "test_repair_support.h"

static uint32_t find(uint32_t *parent, uint32_t v)
{
    while (parent[v] != v)
        v = parent[v];
    return v;
}

/* The lowest vertex that a chain of steps of at most `distance` leads to. */
static void weld_slowly(const hewn_polygons *soup, double distance, uint32_t *parent)
{
    uint32_t count = (uint32_t)soup->vertex_count;
    for (uint32_t v = 0; v < count; v++)
        parent[v] = v;
    for (uint32_t a = 0; a < count; a++)
        for (uint32_t b = 0; b < a; b++) {
            const double *p = soup->positions + 3 * (size_t)a, *q = soup->positions + 3 * (size_t)b;
            double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
            bool near = distance > 0 ? x * x + y * y + z * z <= distance * distance : x == 0 && y == 0 && z == 0;
            uint32_t one = find(parent, a), other = find(parent, b);
            if (near && one != other)
                parent[one > other ? one : other] = one > other ? other : one;
        }
}

static repaired weld(const hewn_polygons *soup, double distance)
{
    return repair(soup, &(hewn_repair_desc){.weld = true, .weld_distance = distance, .keep_isolated = true});
}

static builder random_points(random_state *random, uint32_t count, double spread)
{
    builder soup = make_builder(count, 1, 1);
    double far = random_below(random, 2) ? 1e9 : 0;
    for (uint32_t v = 0; v < count; v++) {
        double x = random_unit(random) * spread, y = random_unit(random) * spread, z = random_unit(random) * spread;
        switch (random_below(random, 4)) {
        case 0: add_vertex(&soup, far + floor(x), floor(y), floor(z)); break; /* on corners of the grid */
        case 1: add_vertex(&soup, far - floor(x), -floor(y), -floor(z)); break;
        case 2: add_vertex(&soup, far + x, -y, 0); break;
        default: add_vertex(&soup, far + x, y, z);
        }
    }
    return soup;
}

static void test_against_all_pairs(void **state)
{
    (void)state;
    random_state random = {1};
    for (int round = 0; round < (getenv("HEWN_LONG") ? 5000 : 200); round++) {
        uint32_t count = 1 + random_below(&random, 200), *parent = hewn_alloc(count, sizeof *parent), roots = 0;
        builder soup = random_points(&random, count, pow(10, random_unit(&random) * 4 - 1));
        static const double distances[] = {0, 0.25, 1, 2, 16};
        double distance = distances[random_below(&random, 5)];
        weld_slowly(&soup.polygons, distance, parent);
        repaired result = weld(&soup.polygons, distance);
        for (uint32_t v = 0; v < count; v++)
            if (parent[v] == v)
                assert_int_equal(result.origins.vertex_origins[roots++], v);
        assert_int_equal(result.origins.vertex_count, roots);
        assert_int_equal(result.report.welded_vertices, count - roots);
        free_repaired(&result);
        hewn_free(parent);
        free_builder(&soup);
    }
}

static void test_order_does_not_matter(void **state)
{
    (void)state;
    random_state random = {2};
    for (int round = 0; round < 50; round++) {
        uint32_t count = 500, *number = hewn_alloc(count, sizeof *number);
        builder soup = random_points(&random, count, 12), turned = make_builder(count, 1, 1);
        for (uint32_t v = 0; v < count; v++) {
            uint32_t other = random_below(&random, v + 1);
            number[v] = number[other];
            number[other] = v;
        }
        for (uint32_t v = 0; v < count; v++) {
            const double *p = soup.positions + 3 * (size_t)number[v];
            add_vertex(&turned, p[0], p[1], p[2]);
        }
        repaired a = weld(&soup.polygons, 1), b = weld(&turned.polygons, 1);
        assert_int_equal(a.report.welded_vertices, b.report.welded_vertices);
        free_repaired(&a);
        free_repaired(&b);
        free_builder(&soup);
        free_builder(&turned);
        hewn_free(number);
    }
}

static void test_zeros_are_equal(void **state)
{
    (void)state;
    builder soup = make_builder(8, 2, 6);
    add_vertex(&soup, 0.0, 1, 2);
    add_vertex(&soup, -0.0, 1, 2);
    add_vertex(&soup, 1, 0, -0.0);
    add_vertex(&soup, 1, -0.0, 0);
    add_vertex(&soup, 0, 0, 0);
    add_vertex(&soup, -0.0, -0.0, -0.0);
    add_triangle(&soup, 0, 2, 4);
    add_triangle(&soup, 1, 5, 3);
    repaired result = take(soup, &(hewn_repair_desc){.weld = true});
    assert_int_equal(result.report.welded_vertices, 3);
    assert_int_equal(result.report.duplicate_faces, 1);
    assert_true(signbit(hewn_vert_position(result.mesh, (hewn_vert){0})[0]) == 0);
    free_repaired(&result);
}

/* Triangles with vertices of their own, as STL has them. */
static void test_torn_torus(void **state)
{
    (void)state;
    random_state random = {4};
    hewn_triangles torus = make_torus(40, 30);
    builder soup = make_builder(3 * torus.triangle_count, torus.triangle_count, 3 * torus.triangle_count);
    for (uint64_t c = 0; c < 3 * torus.triangle_count; c++) {
        const float *p = torus.positions + 3 * (size_t)torus.indices[c];
        double shift[3];
        for (int k = 0; k < 3; k++)
            shift[k] = (double)p[k] + 1e-6 * random_unit(&random);
        add_vertex(&soup, shift[0], shift[1], shift[2]);
    }
    for (uint32_t t = 0; t < torus.triangle_count; t++)
        add_triangle(&soup, 3 * t, 3 * t + 1, 3 * t + 2);
    repaired torn = repair(&soup.polygons, NULL);
    assert_int_equal(torn.certificate.components, torus.triangle_count);
    free_repaired(&torn);
    repaired result = take(soup, &(hewn_repair_desc){.weld = true, .weld_distance = 1e-5});
    assert_true(result.certificate.closed);
    assert_int_equal(result.certificate.genus, 1);
    assert_int_equal(result.origins.vertex_count, torus.vertex_count);
    free_repaired(&result);
    hewn_triangles_destroy(&torus);
}

/* Clouds that would cost the square of their number if cells were compared point by point: all equal, dense in one
 * cell, and two shells that are nowhere quite near enough. */
static void test_dense_clouds_take_no_time(void **state)
{
    (void)state;
    random_state random = {6};
    enum { COUNT = 40000 };
    for (int kind = 0; kind < 3; kind++) {
        builder soup = make_builder(COUNT, 1, 1);
        for (uint32_t v = 0; v < COUNT; v++) {
            double x = random_unit(&random), y = random_unit(&random), z = random_unit(&random);
            double u = 2 * M_PI * x, w = acos(2 * y - 1), r = v % 2 ? 1.0 : 2.001;
            if (kind == 0)
                add_vertex(&soup, 1, 2, 3);
            else if (kind == 1)
                add_vertex(&soup, 4 * x, 4 * y, 4 * z);
            else
                add_vertex(&soup, 9 + r * sin(w) * cos(u), 9 + r * sin(w) * sin(u), 9 + r * cos(w));
        }
        clock_t begin = clock();
        repaired result = weld(&soup.polygons, 1);
        assert_int_equal(result.origins.vertex_count, kind == 2 ? 2 : 1);
        assert_true((double)(clock() - begin) / CLOCKS_PER_SEC < 30);
        free_repaired(&result);
        free_builder(&soup);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_all_pairs),         cmocka_unit_test(test_order_does_not_matter),
        cmocka_unit_test(test_zeros_are_equal),           cmocka_unit_test(test_torn_torus),
        cmocka_unit_test(test_dense_clouds_take_no_time),
    };
    return cmocka_run_group_tests_name("repair_weld", tests, NULL, NULL);
}
