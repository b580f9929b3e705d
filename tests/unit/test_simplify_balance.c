/* Simplification: what the last collapses do for the greatest distance, for the mean one, and for what faces away. */
#include <omp.h>

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

/* --- tests -------------------------------------------------------------------------------------------------------- */

/* Walls thinner than triangles stand off: what is nearest is often the other side. Collapses alone leave three to ten
 * times as many. */
static void test_thin_walls_face_their_own_side(void **state)
{
    (void)state;
    static const struct {
        double thickness;
        uint64_t faces;
        int most;
    } cases[] = {{0.03, 300, 0}, {0.02, 450, 12}, {0.015, 600, 8}, {0.01, 1000, 6}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hewn_model skin = make_skin(30, cases[i].thickness);
        hewn_model out = simplify(&skin, cases[i].faces);
        assert_true(out.face_count <= cases[i].faces);
        assert_true(count_turned(&skin, &out) <= cases[i].most);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_thin_walls_face_their_own_side),
        cmocka_unit_test(test_no_place_is_left_far_away),
        cmocka_unit_test(test_tilted_planes_stay),
        cmocka_unit_test(test_same_bytes_of_attempts),
    };
    return cmocka_run_group_tests_name("simplify balance", tests, NULL, NULL);
}
