/* Cutting soups of polygons into triangles: each face becomes a disk of n - 2 triangles, concave ones come out right,
 * manifold soups stay manifold, and nothing makes it fail or hang. */
#include "mesh/cut.h"
#include "test_check_support.h"

typedef struct cut {
    uint32_t *corners;
    uint64_t count;
} cut;

static cut cut_soup(const hewn_polygons *polygons)
{
    cut made = {0};
    hewn_error error = {0};
    if (hewn_cut_polygons(polygons, &made.corners, &made.count, NULL, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return made;
}

/* --- every face becomes a disk ------------------------------------------------------------------------------------ */

/* The triangles of one face, by its corners 0 to length - 1: each side is used once the way the face runs, and each
 * diagonal once each way. */
static void assert_disk(const uint32_t *triangles, uint64_t begin, uint32_t length)
{
    uint8_t *uses = calloc((size_t)length * length, 1);
    assert_non_null(uses);
    for (uint32_t t = 0; t + 2 < length; t++)
        for (uint32_t k = 0; k < 3; k++) {
            uint64_t a = triangles[3 * t + k] - begin, b = triangles[3 * t + (k + 1) % 3] - begin;
            assert_true(a < length && b < length && a != b);
            uses[a * length + b]++;
        }
    for (uint32_t a = 0; a < length; a++)
        for (uint32_t b = 0; b < length; b++) {
            bool side = b == (a + 1) % length, back = a == (b + 1) % length;
            unsigned there = uses[a * length + b], here = uses[b * length + a];
            assert_true(side ? there == 1 : back ? there == 0 : there == here && there <= 1);
        }
    free(uses);
}

static void assert_disks(const hewn_polygons *polygons)
{
    cut made = cut_soup(polygons);
    uint64_t at = 0;
    for (uint64_t f = 0; f < polygons->face_count; f++) {
        uint64_t begin = polygons->first ? polygons->first[f] : 3 * f;
        uint32_t length = polygons->first ? (uint32_t)(polygons->first[f + 1] - begin) : 3;
        if (length < 3)
            continue;
        assert_true(at + length - 2 <= made.count);
        assert_disk(made.corners + 3 * at, begin, length);
        if (length == 3)
            for (uint64_t k = 0; k < 3; k++)
                assert_int_equal(made.corners[3 * at + k], begin + k);
        at += length - 2;
    }
    assert_int_equal(at, made.count);
    hewn_free(made.corners);
}

static void test_any_soup(void **state)
{
    (void)state;
    random_state random = {1};
    for (int run = 0; run < (getenv("HEWN_LONG") ? 20000 : 1000); run++) {
        soup *s = make_soup();
        uint32_t vertices = 1 + random_below(&random, 30), faces = random_below(&random, 12);
        for (uint32_t v = 0; v < vertices; v++) {
            double p[3];
            for (int k = 0; k < 3; k++)
                switch (run % 6) {
                case 0: p[k] = random_below(&random, 3); break;
                case 1: p[k] = random_unit(&random); break;
                case 2: p[k] = (random_unit(&random) - 0.5) * 1e-320; break;
                case 3: p[k] = (random_unit(&random) - 0.5) * 1.7e308; break;
                case 4: p[k] = random_below(&random, 9) == 0 ? (double)NAN : random_unit(&random); break;
                default: p[k] = k == 2 ? 0 : random_unit(&random); break;
                }
            add_point(s, p[0], p[1], p[2]);
        }
        for (uint32_t f = 0; f < faces; f++) {
            uint32_t corners[100], count = random_below(&random, f % 4 == 0 ? 100 : 7);
            for (uint32_t i = 0; i < count; i++)
                corners[i] = random_below(&random, vertices);
            add_polygon(s, corners, count);
        }
        hewn_polygons polygons = polygons_of(s);
        assert_disks(&polygons);
        free(s);
    }
}

static void test_triangles_stay(void **state)
{
    (void)state;
    const double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t corners[] = {0, 1, 2, 2, 1, 0, 1, 1, 1};
    const hewn_polygons polygons = {3, positions, 3, NULL, corners};
    assert_disks(&polygons);
}

/* --- concave faces ------------------------------------------------------------------------------------------------ */

static void area_of(const double *positions, const uint32_t *corners, uint32_t count, double out[3])
{
    out[0] = out[1] = out[2] = 0;
    for (uint32_t i = 1; i + 1 < count; i++) {
        const double *a = positions + 3 * (size_t)corners[0], *b = positions + 3 * (size_t)corners[i];
        const double *c = positions + 3 * (size_t)corners[i + 1];
        for (int k = 0; k < 3; k++) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            out[k] += 0.5 * ((b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]));
        }
    }
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* One flat proper polygon: all triangles look its way and their areas add up. */
static void assert_cut_right(const double *positions, uint32_t count)
{
    uint32_t *corners = malloc(count * sizeof *corners);
    assert_non_null(corners);
    for (uint32_t i = 0; i < count; i++)
        corners[i] = i;
    const uint64_t first[2] = {0, count};
    const hewn_polygons polygons = {count, positions, 1, first, corners};
    double whole[3], part[3], sum = 0;
    area_of(positions, corners, count, whole);
    double size = sqrt(dot(whole, whole));
    cut made = cut_soup(&polygons);
    assert_int_equal(made.count, count - 2);
    for (uint64_t t = 0; t < made.count; t++) {
        area_of(positions, made.corners + 3 * t, 3, part);
        if (dot(part, whole) < -1e-9 * size * size)
            fail_msg("triangle %llu of a polygon of %u is turned over", (unsigned long long)t, count);
        sum += sqrt(dot(part, part));
    }
    if (!(fabs(sum - size) <= 1e-9 * size))
        fail_msg("the triangles of a polygon of %u have the area %.17g, it has %.17g", count, sum, size);
    hewn_free(made.corners);
    free(corners);
}

/* Arrow heads, from each of their corners on, in all planes and sizes. */
static void test_concave_quads(void **state)
{
    (void)state;
    random_state random = {2};
    for (int run = 0; run < 2000; run++) {
        double depth = run % 3 == 0 ? 0.0 : 0.45 * random_unit(&random); /* 0: a straight corner */
        const double plane[4][2] = {{-1, 0}, {0, depth}, {1, 0}, {random_unit(&random), 1 + random_unit(&random)}};
        double positions[12], u[3], v[3], size = ldexp(1, (int)random_below(&random, 200) - 100);
        for (int k = 0; k < 3; k++) {
            u[k] = random_below(&random, 5) - 2.0;
            v[k] = random_below(&random, 5) - 2.0;
        }
        if (fabs(u[0] * v[1] - u[1] * v[0]) + fabs(u[1] * v[2] - u[2] * v[1]) + fabs(u[2] * v[0] - u[0] * v[2]) == 0)
            continue;
        uint32_t turn = random_below(&random, 4);
        for (uint32_t i = 0; i < 4; i++)
            for (uint32_t k = 0; k < 3; k++) {
                const double *p = plane[(i + turn) % 4];
                positions[3 * i + k] = size * (p[0] * u[k] + p[1] * v[k] + k);
            }
        assert_cut_right(positions, 4);
    }
}

static void test_the_better_diagonal(void **state)
{
    (void)state;
    const double positions[] = {0, 0, 0, 1, -0.1, 0, 2, 0, 0, 1, 0.1, 0};
    const uint64_t first[] = {0, 4};
    for (uint32_t turn = 0; turn < 4; turn++) {
        const uint32_t corners[] = {turn, (turn + 1) % 4, (turn + 2) % 4, (turn + 3) % 4};
        const hewn_polygons polygons = {4, positions, 1, first, corners};
        cut made = cut_soup(&polygons);
        for (uint64_t t = 0; t < 2; t++) { /* no triangle goes from end to end */
            bool ends[2] = {false, false};
            for (uint64_t k = 0; k < 3; k++) {
                uint32_t v = corners[made.corners[3 * t + k]];
                ends[v / 2] = ends[v / 2] || v % 2 == 0;
            }
            assert_false(ends[0] && ends[1]);
        }
        hewn_free(made.corners);
    }
}

/* --- large polygons ----------------------------------------------------------------------------------------------- */

typedef double (*radius_of)(double share, random_state *random);

static double round_shape(double share, random_state *random)
{
    (void)share;
    (void)random;
    return 1;
}

static double coast(double share, random_state *random)
{
    return 1 + 0.05 * sin(250 * share) + 0.0001 * random_unit(random);
}

static double burst(double share, random_state *random)
{
    (void)share;
    return 0.1 + random_unit(random);
}

static void test_large_polygons(void **state)
{
    (void)state;
    static const struct {
        radius_of radius;
        uint32_t count;
    } shapes[] = {{round_shape, 60000}, {coast, 60000}, {burst, 3000}};
    random_state random = {4};
    for (size_t k = 0; k < sizeof shapes / sizeof shapes[0]; k++) {
        uint32_t count = shapes[k].count;
        double *positions = malloc(3 * sizeof *positions * count);
        assert_non_null(positions);
        for (uint32_t i = 0; i < count; i++) {
            double share = (double)i / count, radius = shapes[k].radius(share, &random);
            positions[3 * (size_t)i] = radius * cos(2 * M_PI * share);
            positions[3 * (size_t)i + 1] = 0.5 * radius * cos(2 * M_PI * share) + 3;
            positions[3 * (size_t)i + 2] = radius * sin(2 * M_PI * share);
        }
        assert_cut_right(positions, count);
        free(positions);
    }
}

/* Polygons that fold over themselves at every corner would take the square of their size: they do not. */
static void test_hostile_polygons(void **state)
{
    (void)state;
    enum { COUNT = 30000 };
    random_state random = {5};
    double *positions = malloc(3 * sizeof *positions * COUNT);
    uint32_t *corners = malloc(sizeof *corners * COUNT);
    assert_true(positions && corners);
    for (int kind = 0; kind < 4; kind++) {
        for (uint32_t i = 0; i < 3 * COUNT; i++)
            switch (kind) {
            case 0: positions[i] = random_unit(&random); break;
            case 1: positions[i] = random_below(&random, 3); break;
            case 2: positions[i] = i / 3 % 2 + 0.1 * random_unit(&random); break;
            default: positions[i] = 7; break;
            }
        for (uint32_t i = 0; i < COUNT; i++)
            corners[i] = i;
        const uint64_t first[2] = {0, COUNT};
        const hewn_polygons polygons = {COUNT, positions, 1, first, corners};
        cut made = cut_soup(&polygons);
        assert_int_equal(made.count, COUNT - 2);
        hewn_free(made.corners);
    }
    free(positions);
    free(corners);
}

/* --- manifold stays manifold -------------------------------------------------------------------------------------- */

static hewn_check *check_cut(const soup *s)
{
    hewn_polygons polygons = polygons_of(s);
    cut made = cut_soup(&polygons);
    for (uint64_t i = 0; i < 3 * made.count; i++)
        made.corners[i] = s->corners[made.corners[i]];
    hewn_polygons triangles = {s->vertices, s->positions, made.count, NULL, made.corners};
    hewn_check *check = NULL;
    assert_int_equal(hewn_check_polygons(&triangles, &(hewn_check_desc){.skip_self_intersections = true}, &check, NULL),
                     HEWN_OK);
    hewn_free(made.corners);
    return check;
}

static void assert_stays_manifold(soup *s)
{
    hewn_check *whole = check_soup(s, NULL), *parts = check_cut(s);
    assert_true(whole->certificate.manifold);
    if (!parts->certificate.manifold)
        fail_msg("%llu faces of %llu vertices, cut: %llu edges and %llu vertices are not manifold",
                 (unsigned long long)s->faces, (unsigned long long)s->vertices,
                 (unsigned long long)parts->certificate.non_manifold_edges,
                 (unsigned long long)parts->certificate.non_manifold_vertices);
    assert_int_equal(whole->euler, parts->euler);
    assert_int_equal(whole->certificate.closed, parts->certificate.closed);
    assert_int_equal(whole->certificate.boundary_edges, parts->certificate.boundary_edges);
    assert_true(whole->certificate.area == parts->certificate.area);
    hewn_check_destroy(&whole);
    hewn_check_destroy(&parts);
    free(s);
}

static void test_pillows(void **state)
{
    (void)state;
    for (uint32_t n = 4; n <= 40; n++) { /* two polygons back to back: the second must avoid the first one's cuts */
        soup *s = make_soup();
        uint32_t front[40], back[40];
        for (uint32_t i = 0; i < n; i++) {
            front[i] = add_point(s, cos(2 * M_PI * i / n), sin(2 * M_PI * i / n), 0);
            back[n - 1 - i] = front[i];
        }
        add_polygon(s, front, n);
        add_polygon(s, back, n);
        assert_stays_manifold(s);
    }
}

static void test_small_quad_tori(void **state)
{
    (void)state;
    for (uint32_t n = 3; n <= 8; n++)
        for (uint32_t m = 3; m <= 8; m++)
            for (int klein = 0; klein < 2 && (n > 3 || m > 3); klein++) {
                soup *s = make_soup();
                add_torus(s, n, m, 0, klein);
                assert_stays_manifold(s);
            }
}

/* Both diagonals of face 1 are edges of other faces. Export cuts it all the same, the half-edge mesh refuses. */
static void test_no_way_out(void **state)
{
    (void)state;
    const uint64_t first[] = {0, 4, 8, 11, 14, 17, 20, 23, 26, 29, 32};
    const uint32_t corners[] = {8, 9, 10, 11, 0, 1, 2, 3, 0, 3, 4, 0, 4, 2, 2, 1,
                                5, 2, 5,  0,  1, 0, 6, 1, 6, 3, 3, 2, 7, 3, 7, 1};
    double positions[36];
    random_state random = {3};
    for (int i = 0; i < 36; i++)
        positions[i] = random_unit(&random);
    const hewn_polygons polygons = {12, positions, 10, first, corners};
    assert_disks(&polygons);
    hewn_mesh *mesh = NULL;
    hewn_triangles triangles;
    assert_int_equal(hewn_mesh_from_polygons(&polygons, &mesh, NULL), HEWN_OK);
    assert_int_equal(hewn_mesh_triangulate(mesh, NULL), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_mesh_to_triangles(mesh, &triangles, NULL), HEWN_OK);
    assert_int_equal(triangles.triangle_count, 12);
    hewn_triangles_destroy(&triangles);
    hewn_mesh_destroy(&mesh);
}

/* The half-edge mesh chooses the same cuts. */
static void test_agrees_with_the_mesh(void **state)
{
    (void)state;
    random_state random = {6};
    for (int run = 0; run < 50; run++) {
        soup *s = make_soup();
        add_torus(s, 4 + random_below(&random, 9), 4 + random_below(&random, 9), 0, false);
        for (uint64_t i = 0; i < 3 * s->vertices; i++)
            s->positions[i] += 0.3 * random_unit(&random);
        hewn_polygons polygons = polygons_of(s);
        hewn_mesh *mesh = NULL;
        hewn_triangles triangles;
        assert_int_equal(hewn_mesh_from_polygons(&polygons, &mesh, NULL), HEWN_OK);
        assert_int_equal(hewn_mesh_to_triangles(mesh, &triangles, NULL), HEWN_OK);
        assert_int_equal(hewn_mesh_triangulate(mesh, NULL), HEWN_OK);
        assert_int_equal(hewn_mesh_face_count(mesh), triangles.triangle_count);
        for (uint64_t t = 0; t < triangles.triangle_count; t++)
            for (uint32_t k = 0; k < 3; k++) {
                hewn_vert a = {triangles.indices[3 * t + k]}, b = {triangles.indices[3 * t + (k + 1) % 3]};
                assert_true(hewn_mesh_find_half(mesh, a, b).id != HEWN_NONE);
            }
        hewn_triangles_destroy(&triangles);
        hewn_mesh_destroy(&mesh);
        free(s);
    }
}

/* --- failures ----------------------------------------------------------------------------------------------------- */

static bool count_down(void *user, const char *stage, double fraction)
{
    assert_string_equal(stage, "triangulate");
    assert_true(fraction >= 0 && fraction <= 1);
    return (*(int *)user)-- > 0;
}

static void test_failures(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_cube(s, 0, 0, 0, 1);
    hewn_polygons polygons = polygons_of(s);
    uint32_t *corners = s->corners;
    uint64_t count = 7;
    hewn_error error = {0};
    int none = 0;
    const hewn_progress progress = {count_down, &none};
    assert_int_equal(hewn_cut_polygons(&polygons, &corners, &count, &progress, &error), HEWN_CANCELLED);
    assert_null(corners);
    assert_int_equal(count, 0);
    s->corners[5] = 8;
    assert_int_equal(hewn_cut_polygons(&polygons, &corners, &count, NULL, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "vertex 8"));
    s->corners[5] = 0;
    s->first[3] = 2;
    assert_int_equal(hewn_cut_polygons(&polygons, &corners, &count, NULL, &error), HEWN_BAD_INPUT);
    polygons = (hewn_polygons){0};
    assert_int_equal(hewn_cut_polygons(&polygons, &corners, &count, NULL, &error), HEWN_OK);
    assert_int_equal(count, 0);
    hewn_free(corners);
    polygons.face_count = 1ull << 32;
    polygons.corners = s->corners;
    assert_int_equal(hewn_cut_polygons(&polygons, &corners, &count, NULL, &error), HEWN_LIMIT);
    free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_soup),       cmocka_unit_test(test_triangles_stay),
        cmocka_unit_test(test_concave_quads),  cmocka_unit_test(test_the_better_diagonal),
        cmocka_unit_test(test_large_polygons), cmocka_unit_test(test_hostile_polygons),
        cmocka_unit_test(test_pillows),        cmocka_unit_test(test_small_quad_tori),
        cmocka_unit_test(test_no_way_out),     cmocka_unit_test(test_agrees_with_the_mesh),
        cmocka_unit_test(test_failures),
    };
    return cmocka_run_group_tests_name("mesh_cut", tests, NULL, NULL);
}
