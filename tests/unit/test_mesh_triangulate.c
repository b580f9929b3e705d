/* Cutting polygons into triangles: areas add up, concave faces come out right, nothing hangs, no edge is doubled. */
#include "test_mesh_half.h"

static hewn_mesh *one_polygon(const double *positions, uint32_t count)
{
    uint32_t *corners = malloc(count * sizeof *corners);
    const uint64_t first[2] = {0, count};
    for (uint32_t i = 0; i < count; i++)
        corners[i] = i;
    hewn_mesh *mesh = mesh_of(positions, count, first, corners, 1);
    free(corners);
    return mesh;
}

static void area_vector(const hewn_mesh *mesh, hewn_face f, double out[3])
{
    hewn_half first = hewn_face_half(mesh, f), h = first;
    out[0] = out[1] = out[2] = 0;
    do {
        const double *a = hewn_vert_position(mesh, hewn_half_tail(mesh, h));
        const double *b = hewn_vert_position(mesh, hewn_half_head(mesh, h));
        for (int k = 0; k < 3; k++)
            out[k] += 0.5 * (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
        h = hewn_half_next(mesh, h);
    } while (h.id != first.id);
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Cuts a flat, proper polygon: every triangle looks the same way, and their areas add up to the whole. */
static void assert_cut_right(const double *positions, uint32_t count)
{
    hewn_mesh *mesh = one_polygon(positions, count);
    double whole[3], sum = 0;
    area_vector(mesh, (hewn_face){0}, whole);
    double size = sqrt(dot(whole, whole));
    add_values(mesh);
    assert_works(hewn_mesh_triangulate(mesh, error));
    assert_valid(mesh);
    assert_values(mesh, 0);
    assert_int_equal(hewn_mesh_face_count(mesh), count - 2);
    assert_int_equal(euler_number(mesh), 1);
    for (uint32_t f = 0; f < hewn_mesh_face_count(mesh); f++) {
        double part[3];
        assert_int_equal(hewn_face_degree(mesh, (hewn_face){f}), 3);
        area_vector(mesh, (hewn_face){f}, part);
        if (dot(part, whole) / size < -1e-9 * size)
            fail_msg("triangle %u of a polygon of %u is turned over", f, count);
        sum += sqrt(dot(part, part));
    }
    if (fabs(sum - size) > 1e-9 * size)
        fail_msg("the triangles of a polygon of %u have the area %.17g, it has %.17g", count, sum, size);
    hewn_mesh_destroy(&mesh);
}

/* Turned into some plane of space. */
static void place(const double *plane, uint32_t count, random_state *random, double *out)
{
    double u[3], v[3], origin[3];
    for (int k = 0; k < 3; k++) {
        u[k] = random_unit(random) - 0.5;
        v[k] = random_unit(random) - 0.5;
        origin[k] = 10 * random_unit(random);
    }
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            out[3 * i + (uint32_t)k] = origin[k] + plane[2 * i] * u[k] + plane[2 * i + 1] * v[k];
}

static void test_stars(void **state)
{
    (void)state;
    random_state random = {5};
    double plane[120], positions[180];
    for (int run = 0; run < 500; run++) {
        uint32_t count = 4 + random_below(&random, 56);
        for (uint32_t i = 0; i < count; i++) {
            double radius = 0.1 + random_unit(&random), angle = 2 * M_PI * i / count;
            plane[2 * i] = radius * cos(angle);
            plane[2 * i + 1] = radius * sin(angle);
        }
        place(plane, count, &random, positions);
        assert_cut_right(positions, count);
    }
}

/* A comb: as many reflex corners as teeth, and exactly straight runs. */
static void test_combs(void **state)
{
    (void)state;
    for (uint32_t teeth = 1; teeth <= 30; teeth++) {
        double positions[3 * 128] = {0};
        uint32_t count = 0;
        for (uint32_t i = 0; i <= 2 * teeth; i++, count++)
            positions[3 * count] = i;
        for (uint32_t i = 2 * teeth + 1; i-- > 0; count++) {
            positions[3 * count] = i;
            positions[3 * count + 1] = i % 2 == 0 ? 5 : 1;
        }
        assert_cut_right(positions, count);
    }
}

static void test_spiral(void **state)
{
    (void)state;
    enum { TURN = 60 };
    double positions[3 * 2 * TURN] = {0};
    for (uint32_t i = 0; i < TURN; i++) {
        double angle = 0.3 * i, radius = 1 + 0.1 * i;
        double *outer = positions + 3 * i, *inner = positions + 3 * (2 * TURN - 1 - i);
        outer[1] = (radius + 0.5) * cos(angle);
        outer[2] = (radius + 0.5) * sin(angle);
        inner[1] = radius * cos(angle);
        inner[2] = radius * sin(angle);
    }
    assert_cut_right(positions, 2 * TURN);
}

/* Polygons that are none: cut somehow, quickly, into a valid mesh. */
static void test_degenerate(void **state)
{
    (void)state;
    random_state random = {9};
    for (int run = 0; run < 100; run++) {
        enum { MOST = 50 };
        double positions[3 * MOST];
        uint32_t count = 4 + random_below(&random, MOST - 3);
        for (uint32_t i = 0; i < 3 * count; i++)
            switch (run % 5) {
            case 0: positions[i] = 1; break;
            case 1: positions[i] = i % 3 == 0 ? random_unit(&random) : 0; break;
            case 2: positions[i] = random_unit(&random); break;
            case 3: positions[i] = random_below(&random, 3); break;
            default: positions[i] = (random_unit(&random) - 0.5) * (run % 2 ? 1e-320 : 1e307); break;
            }
        hewn_mesh *mesh = one_polygon(positions, count);
        assert_works(hewn_mesh_triangulate_face(mesh, (hewn_face){0}, error));
        assert_valid(mesh);
        assert_int_equal(hewn_mesh_face_count(mesh), count - 2);
        hewn_mesh_destroy(&mesh);
    }
}

/* A quadrilateral over two triangles that have its one diagonal: it must be cut along the other. */
static void test_taken_diagonal(void **state)
{
    (void)state;
    const double positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const uint64_t first[] = {0, 4, 7, 10};
    const uint32_t either[2][10] = {{0, 1, 2, 3, 2, 1, 0, 3, 2, 0}, {0, 1, 2, 3, 3, 1, 0, 3, 2, 1}};
    for (int way = 0; way < 2; way++) {
        hewn_mesh *mesh = mesh_of(positions, 4, first, either[way], 3);
        assert_works(hewn_mesh_triangulate(mesh, error));
        assert_valid(mesh);
        assert_int_equal(hewn_mesh_face_count(mesh), 4);
        hewn_mesh_destroy(&mesh);
    }
}

/* Both diagonals of face 1 are edges of other faces (a surface of higher genus: on a sphere they would cross). Nothing
 * may change, face 0, which could be cut, included. */
static void test_refusal_changes_nothing(void **state)
{
    (void)state;
    const uint64_t first[] = {0, 4, 8, 11, 14, 17, 20, 23, 26, 29, 32};
    const uint32_t corners[] = {8, 9, 10, 11, 0, 1, 2, 3, 0, 3, 4, 0, 4, 2, 2, 1,
                                5, 2, 5,  0,  1, 0, 6, 1, 6, 3, 3, 2, 7, 3, 7, 1};
    double positions[36];
    random_state random = {3};
    for (int i = 0; i < 36; i++)
        positions[i] = random_unit(&random);
    hewn_mesh *mesh = mesh_of(positions, 12, first, corners, 10);
    add_values(mesh);
    uint32_t edges = hewn_mesh_edge_count(mesh);
    for (int whole = 0; whole < 2; whole++) {
        if (whole)
            assert_refused(hewn_mesh_triangulate(mesh, error), HEWN_INVALID_ARGUMENT, "face 1 cannot be cut");
        else
            assert_refused(hewn_mesh_triangulate_face(mesh, (hewn_face){1}, error), HEWN_INVALID_ARGUMENT,
                           "face 1 cannot be cut");
        assert_valid(mesh);
        assert_values(mesh, 0);
        assert_int_equal(hewn_mesh_edge_count(mesh), edges);
        assert_int_equal(hewn_mesh_face_count(mesh), 10);
        for (uint32_t f = 0; f < 10; f++) {
            hewn_half h = hewn_face_half(mesh, (hewn_face){f});
            for (uint64_t i = first[f]; i < first[f + 1]; i++, h = hewn_half_next(mesh, h))
                assert_int_equal(hewn_half_head(mesh, h).id, corners[i]);
        }
    }
    hewn_mesh_destroy(&mesh);
}

static void test_cube(void **state)
{
    (void)state;
    hewn_mesh *mesh = quad_cube();
    hewn_triangles triangles;
    hewn_certificate certificate;
    assert_works(hewn_mesh_to_triangles(mesh, &triangles, error));
    assert_works(hewn_certify(&triangles, NULL, &certificate, error));
    assert_true(certificate.closed && certificate.manifold && certificate.oriented);
    assert_true(fabs(certificate.volume - 1) < 1e-12);
    assert_true(fabs(certificate.area - 6) < 1e-12);
    assert_int_equal(hewn_mesh_face_count(mesh), 6);
    hewn_triangles_destroy(&triangles);
    hewn_mesh_destroy(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stars),          cmocka_unit_test(test_combs),
        cmocka_unit_test(test_spiral),         cmocka_unit_test(test_degenerate),
        cmocka_unit_test(test_taken_diagonal), cmocka_unit_test(test_refusal_changes_nothing),
        cmocka_unit_test(test_cube),
    };
    return cmocka_run_group_tests_name("mesh_triangulate", tests, NULL, NULL);
}
