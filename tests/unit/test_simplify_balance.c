/* Simplification: what the last collapses do for the greatest distance, for the mean one, and for what faces away. */
#include <omp.h>

#include "hewn/check.h"
#include "hewn/distance.h"
#include "hewn/simplify.h"
#include "test_smooth_support.h"

#include "geom/nearest.h"

static hewn_model simplify(const hewn_model *model, uint64_t faces)
{
    hewn_error error = {0};
    hewn_simplified out;
    const hewn_polygons polygons = hewn_model_polygons(model);
    if (hewn_polygons_simplify(&polygons, &(hewn_simplify_desc){.faces = faces}, &out, NULL, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    hewn_free(out.vertex_origins);
    hewn_free(out.face_origins);
    return (hewn_model){.vertex_count = out.vertex_count,
                        .face_count = out.face_count,
                        .positions = out.positions,
                        .corners = out.corners};
}

static double distance_between(const hewn_model *a, const hewn_model *b)
{
    hewn_error error = {0};
    hewn_distance out;
    const hewn_polygons one = hewn_model_polygons(a), two = hewn_model_polygons(b);
    if (hewn_polygons_distance(&one, &two, NULL, &out, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return out.high;
}

static void find_normal(const hewn_model *model, uint64_t f, double normal[3], double middle[3])
{
    const double *a = model->positions + 3 * (size_t)model->corners[3 * f],
                 *b = model->positions + 3 * (size_t)model->corners[3 * f + 1],
                 *c = model->positions + 3 * (size_t)model->corners[3 * f + 2];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
        middle[i] = (a[i] + b[i] + c[i]) / 3;
    }
}

/* Triangles that face away from the input's nearest to their middle, of all. */
static int count_turned(const hewn_model *input, const hewn_model *made)
{
    int turned = 0;
    for (uint64_t f = 0; f < made->face_count; f++) {
        double n[3], m[3], at[3], unused[3], least = INFINITY;
        uint64_t near = 0;
        find_normal(made, f, n, at);
        for (uint64_t t = 0; t < input->face_count; t++) {
            const uint32_t *corner = input->corners + 3 * t;
            const double found =
                hewn_triangle_reach(at, input->positions + 3 * (size_t)corner[0],
                                    input->positions + 3 * (size_t)corner[1], input->positions + 3 * (size_t)corner[2]);
            near = found < least ? t : near;
            least = found < least ? found : least;
        }
        find_normal(input, near, m, unused);
        turned += n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < 0;
    }
    return turned;
}

/* From the input's vertices to the result. */
static double mean_distance(const hewn_model *input, const hewn_model *made)
{
    double sum = 0;
    for (uint64_t v = 0; v < input->vertex_count; v++) {
        double least = INFINITY;
        for (uint64_t t = 0; t < made->face_count; t++) {
            const uint32_t *corner = made->corners + 3 * t;
            least = fmin(least, hewn_triangle_reach(input->positions + 3 * v, made->positions + 3 * (size_t)corner[0],
                                                    made->positions + 3 * (size_t)corner[1],
                                                    made->positions + 3 * (size_t)corner[2]));
        }
        sum += least;
    }
    return sum / (double)input->vertex_count;
}

/* --- shapes ------------------------------------------------------------------------------------------------------- */

static hewn_model make_bumpy(uint32_t n, double height, double often)
{
    hewn_model model = make_sphere(n, 1);
    for (uint64_t v = 0; v < model.vertex_count; v++) {
        double *at = model.positions + 3 * v;
        const double bump = 1 + height * sin(often * at[0]) * sin(often * at[1]) * sin(often * at[2]);
        for (int axis = 0; axis < 3; axis++)
            at[axis] *= bump;
    }
    return model;
}

/* A ball's skin: the same once more within, turned inside out. */
static hewn_model make_skin(uint32_t n, double thickness)
{
    hewn_model ball = make_bumpy(n, 0.2, 3);
    const uint64_t verts = ball.vertex_count, faces = ball.face_count;
    hewn_model both = make_model(2 * verts, 2 * faces, 6 * faces, false);
    for (uint64_t i = 0; i < 3 * verts; i++) {
        both.positions[i] = ball.positions[i];
        both.positions[3 * verts + i] = ball.positions[i] * (1 - thickness);
    }
    for (uint64_t c = 0; c < 3 * faces; c++) {
        both.corners[c] = ball.corners[c];
        both.corners[3 * faces + c] = ball.corners[c - c % 3 + (3 - c % 3) % 3] + (uint32_t)verts;
    }
    hewn_model_destroy(&ball);
    return both;
}

/* An octahedron of many triangles, tilted. */
static hewn_model make_tilted(uint32_t n)
{
    static const double turn[3][3] = {
        {2.0 / 3, -1.0 / 3, 2.0 / 3}, {2.0 / 3, 2.0 / 3, -1.0 / 3}, {-1.0 / 3, 2.0 / 3, 2.0 / 3}};
    hewn_model model = make_sphere(n, 1);
    for (uint64_t v = 0; v < model.vertex_count; v++) {
        double *at = model.positions + 3 * v, flat[3];
        const double sum = fabs(at[0]) + fabs(at[1]) + fabs(at[2]);
        for (int axis = 0; axis < 3; axis++)
            flat[axis] = at[axis] / sum;
        for (int axis = 0; axis < 3; axis++)
            at[axis] = turn[axis][0] * flat[0] + turn[axis][1] * flat[1] + turn[axis][2] * flat[2];
    }
    return model;
}

/* Without the triangles around some vertices, far from each other. */
static hewn_model make_pierced(uint32_t n, uint32_t holes)
{
    hewn_model ball = make_bumpy(n, 0.2, 3), out;
    uint64_t faces = 0;
    const uint64_t step = ball.vertex_count / holes;
    out = make_model(ball.vertex_count, ball.face_count, 3 * ball.face_count, false);
    memcpy(out.positions, ball.positions, 3 * ball.vertex_count * sizeof *out.positions);
    for (uint64_t f = 0; f < ball.face_count; f++) {
        const uint32_t *corner = ball.corners + 3 * f;
        if (corner[0] % step == step / 2 || corner[1] % step == step / 2 || corner[2] % step == step / 2)
            continue;
        memcpy(out.corners + 3 * faces++, corner, 3 * sizeof *corner);
    }
    out.face_count = faces;
    hewn_model_destroy(&ball);
    return out;
}

/* --- tests -------------------------------------------------------------------------------------------------------- */

/* Walls thinner than triangles stand off: what is nearest is often the other side. Collapses alone leave three to ten
 * times as many as were left when there was one way where triangles are many: 8, 3 and 3 of the last. */
static void test_thin_walls_face_their_own_side(void **state)
{
    (void)state;
    static const struct {
        double thickness;
        uint64_t faces;
    } cases[] = {{0.03, 300}, {0.02, 450}, {0.015, 600}, {0.01, 1000}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hewn_model skin = make_skin(30, cases[i].thickness);
        hewn_model out = simplify(&skin, cases[i].faces);
        assert_true(out.face_count <= cases[i].faces);
        assert_int_equal(count_turned(&skin, &out), 0);
        hewn_model_destroy(&skin);
        hewn_model_destroy(&out);
    }
}

/* Bumps to 5 %. By quadrics alone the greatest distances, which are proven, are 0.0086, 0.0187 and 0.0257, and the sum
 * of the mean ones 0.0066; without vertices being fitted it is 0.0068, without edges being swapped 0.0062. */
static void test_no_place_is_left_far_away(void **state)
{
    (void)state;
    static const double most[] = {0.007, 0.0145, 0.0235};
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        hewn_model ball = make_bumpy(50, 0.15, 4 + 2 * i);
        hewn_model out = simplify(&ball, ball.face_count / 20);
        assert_true(distance_between(&ball, &out) < most[i]);
        assert_int_equal(count_turned(&ball, &out), 0);
        sum += mean_distance(&ball, &out);
        hewn_model_destroy(&ball);
        hewn_model_destroy(&out);
    }
    assert_true(sum < 0.00611);
}

/* Neither swaps nor moves leave a plane, whichever way it lies. */
static void test_tilted_planes_stay(void **state)
{
    (void)state;
    hewn_model model = make_tilted(30);
    for (uint64_t faces = 8; faces < 1000; faces *= 5) {
        hewn_model out = simplify(&model, faces);
        assert_true(out.face_count <= faces);
        assert_true(distance_between(&model, &out) < 1e-5);
        assert_int_equal(count_turned(&model, &out), 0);
        hewn_model_destroy(&out);
    }
    hewn_model_destroy(&model);
}

/* Few triangles are tried for in several ways at a time. */
static void test_same_bytes_of_attempts(void **state)
{
    (void)state;
    const int threads = omp_get_max_threads();
    hewn_model model = make_skin(20, 0.03);
    for (uint64_t faces = 40; faces < 1000; faces *= 4) {
        omp_set_num_threads(1);
        hewn_model one = simplify(&model, faces);
        for (int count = 2; count <= 5; count += 3) {
            omp_set_num_threads(count);
            hewn_model other = simplify(&model, faces);
            assert_int_equal(one.face_count, other.face_count);
            assert_int_equal(one.vertex_count, other.vertex_count);
            assert_memory_equal(one.positions, other.positions, 3 * one.vertex_count * sizeof(double));
            assert_memory_equal(one.corners, other.corners, 3 * one.face_count * sizeof(uint32_t));
            hewn_model_destroy(&other);
        }
        hewn_model_destroy(&one);
    }
    omp_set_num_threads(threads);
    hewn_model_destroy(&model);
}

/* Few triangles go where they are needed. When none were exchanged and distances back to the input did not count, the
 * sum of the mean distances was 0.339, that of the greatest 1.73. */
static void test_few_triangles_are_where_they_are_needed(void **state)
{
    (void)state;
    double mean = 0, most = 0;
    for (uint64_t faces = 90; faces <= 135; faces += 45)
        for (int i = 0; i < 6; i++) {
            hewn_model ball = make_bumpy(40, 0.15 + 0.05 * i, 3 + i);
            hewn_model out = simplify(&ball, faces);
            assert_true(out.face_count <= faces);
            mean += mean_distance(&ball, &out);
            most += distance_between(&ball, &out);
            hewn_model_destroy(&ball);
            hewn_model_destroy(&out);
        }
    assert_true(mean < 0.3345);
    assert_true(most < 1.70);
}

static void assert_same_topology(const hewn_model *a, const hewn_model *b)
{
    const hewn_model *both[2] = {a, b};
    hewn_check *found[2];
    for (int i = 0; i < 2; i++) {
        hewn_error error = {0};
        const hewn_polygons polygons = hewn_model_polygons(both[i]);
        if (hewn_check_polygons(&polygons, &(hewn_check_desc){.skip_self_intersections = true}, &found[i], &error) !=
            HEWN_OK)
            fail_msg("%s", error.message);
        assert_true(found[i]->certificate.manifold && found[i]->certificate.oriented);
    }
    assert_int_equal(found[0]->component_count, found[1]->component_count);
    assert_int_equal(found[0]->boundary_loops, found[1]->boundary_loops);
    assert_int_equal(found[0]->euler, found[1]->euler);
    hewn_check_destroy(&found[0]);
    hewn_check_destroy(&found[1]);
}

/* Holes take more triangles than are asked for: what is left keeps the shape. When samples were looked at from four
 * times the number that was asked for on, the sum of the mean distances was 0.67, that of the greatest 2.1. */
static void test_more_topology_than_triangles(void **state)
{
    (void)state;
    double mean = 0, most = 0;
    for (uint32_t holes = 5; holes < 40; holes *= 2) {
        hewn_model ball = make_pierced(30, holes);
        hewn_model out = simplify(&ball, holes);
        assert_true(out.face_count <= 7 * holes);
        assert_int_equal(count_turned(&ball, &out), 0);
        assert_same_topology(&ball, &out);
        mean += mean_distance(&ball, &out);
        most += distance_between(&ball, &out);
        hewn_model_destroy(&ball);
        hewn_model_destroy(&out);
    }
    assert_true(mean < 0.4);
    assert_true(most < 1.6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_thin_walls_face_their_own_side),
        cmocka_unit_test(test_no_place_is_left_far_away),
        cmocka_unit_test(test_tilted_planes_stay),
        cmocka_unit_test(test_few_triangles_are_where_they_are_needed),
        cmocka_unit_test(test_more_topology_than_triangles),
        cmocka_unit_test(test_same_bytes_of_attempts),
    };
    return cmocka_run_group_tests_name("simplify balance", tests, NULL, NULL);
}
