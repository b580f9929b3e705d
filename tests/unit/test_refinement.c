/* View-dependent refinement: a camera flies, and every frame is a sound mesh that is fine where it is seen. */
#include "hewn/check.h"
#include "hewn/refinement.h"
#include "test_smooth_support.h"

static hewn_check *check_of(const hewn_model *model)
{
    hewn_check *check;
    const hewn_polygons polygons = hewn_model_polygons(model);
    assert_int_equal(hewn_check_polygons(&polygons, &(hewn_check_desc){.skip_self_intersections = true}, &check, NULL),
                     HEWN_OK);
    return check;
}

static hewn_model model_of_refinement(const hewn_refinement *from)
{
    hewn_model model;
    assert_int_equal(hewn_refinement_model(from, &model, NULL), HEWN_OK);
    assert_int_equal(hewn_model_check(&model, NULL), HEWN_OK);
    return model;
}

static hewn_refinement *refine(const hewn_progressive *from)
{
    hewn_refinement *made;
    assert_int_equal(hewn_refinement_create(from, &made, NULL), HEWN_OK);
    return made;
}

static hewn_model make_shape(int shape, random_state *random)
{
    hewn_model model = shape == 0   ? make_sphere(36, 1)
                       : shape == 1 ? make_ring_model(80, 60, 3)
                                    : model_of(join_meshes(make_torus(60, 40), make_torus(40, 24), 20));
    add_noise(&model, 2e-3, random);
    return model;
}

/* A camera on a path around and through the shape, looking at a point on it; a pyramid of four planes. */
static hewn_refinement_view view_at(double time, int kind)
{
    hewn_refinement_view view = {.pixels = 1000, .tolerance = 1 + 4 * fabs(sin(3 * time))};
    const double eye[3] = {3 * cos(time), 3 * sin(1.7 * time), 2 * sin(time)};
    const double at[3] = {sin(2 * time), cos(time), 0.3};
    double ahead[3], right[3], up[3], length = 0;
    for (int k = 0; k < 3; k++) {
        view.eye[k] = eye[k];
        ahead[k] = at[k] - eye[k];
        length += ahead[k] * ahead[k];
    }
    for (int k = 0; k < 3; k++)
        ahead[k] /= sqrt(length);
    const double across = hypot(ahead[0], ahead[1]);
    right[0] = ahead[1] / across;
    right[1] = -ahead[0] / across;
    right[2] = 0;
    up[0] = right[1] * ahead[2];
    up[1] = -right[0] * ahead[2];
    up[2] = right[0] * ahead[1] - right[1] * ahead[0];
    for (int p = 0; kind > 0 && p < 4; p++) {
        const double *side = p < 2 ? right : up;
        for (int k = 0; k < 3; k++) {
            view.planes[p][k] = sin(0.4) * ahead[k] + (p % 2 ? cos(0.4) : -cos(0.4)) * side[k];
            view.planes[p][3] -= view.planes[p][k] * eye[k];
        }
        view.plane_count = 4;
    }
    view.outside = kind > 0 ? 50 : 0;
    view.back = kind > 0 ? 8 : 0;
    view.silhouette = kind > 1 ? 0.25 : 0;
    return view;
}

/* --- the flight --------------------------------------------------------------------------------------------------- */

static void assert_sound(const hewn_refinement *from, const hewn_check *whole)
{
    hewn_model model = model_of_refinement(from);
    hewn_check *check = check_of(&model);
    uint64_t count;
    hewn_refinement_triangles(from, &count);
    assert_int_equal(count, model.face_count);
    assert_true(check->certificate.closed && check->certificate.manifold && check->certificate.oriented);
    assert_int_equal(check->euler, whole->euler);
    assert_int_equal(check->certificate.components, whole->certificate.components);
    assert_int_equal(check->duplicate_faces, 0);
    hewn_check_destroy(&check);
    hewn_model_destroy(&model);
}

static int compare_triangles(const void *a, const void *b)
{
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* Triangles for drawing, in an order that does not depend on the way; the caller's. */
static uint32_t *sorted_triangles(const hewn_refinement *from, uint64_t *count)
{
    const uint32_t *triangles = hewn_refinement_triangles(from, count);
    uint32_t *copy = hewn_alloc(*count, 3 * sizeof *copy);
    memcpy(copy, triangles, *count * 3 * sizeof *copy);
    qsort(copy, *count, 3 * sizeof *copy, compare_triangles);
    return copy;
}

/* Every frame is closed and manifold, also where the work of a view is spread over frames; and once settled it is the
 * mesh that comes of going there at once. */
static void test_a_flight(void **state)
{
    (void)state;
    random_state random = {31};
    for (int shape = 0; shape < 3; shape++) {
        hewn_model model = make_shape(shape, &random);
        hewn_progressive *made;
        assert_int_equal(hewn_progressive_make(&model, NULL, &made, NULL), HEWN_OK);
        hewn_check *whole = check_of(&model);
        hewn_refinement *flying = refine(made);
        const uint64_t all = hewn_progressive_about(made).splits;
        uint64_t moved = 0, most = 0, least = UINT64_MAX;
        for (int frame = 0; frame < 60; frame++) {
            const hewn_refinement_view view = view_at(0.05 * frame, shape);
            hewn_refinement_stats stats;
            for (int part = 0; part < 3; part++) {
                const uint64_t budget = part < 2 ? 40 : 0;
                assert_int_equal(hewn_refinement_update(flying, &view, budget, &stats, NULL), HEWN_OK);
                assert_true(budget == 0 || stats.splits + stats.folds < budget + all / 4);
                assert_true(stats.settled || budget > 0);
                moved += frame > 0 ? stats.splits + stats.folds : 0;
                if (frame % 4 == 0 || part == 2)
                    assert_sound(flying, whole);
            }
            assert_int_equal(hewn_refinement_update(flying, &view, 0, &stats, NULL), HEWN_OK);
            assert_int_equal(stats.splits + stats.folds, 0);
            if (frame % 10 == 0) {
                hewn_refinement *fresh = refine(made);
                uint64_t a_count, b_count;
                assert_int_equal(hewn_refinement_update(fresh, &view, 0, NULL, NULL), HEWN_OK);
                uint32_t *a = sorted_triangles(flying, &a_count), *b = sorted_triangles(fresh, &b_count);
                assert_int_equal(a_count, b_count);
                assert_memory_equal(a, b, a_count * 3 * sizeof *a);
                hewn_free(a);
                hewn_free(b);
                hewn_refinement_destroy(&fresh);
            }
            uint64_t count;
            hewn_refinement_triangles(flying, &count);
            most = count > most ? count : most;
            least = count < least ? count : least;
        }
        assert_true(moved > 100 && moved < 60 * all / 2); /* frames have much in common */
        assert_true(most < 2 * all && least > hewn_progressive_about(made).base_triangles);
        hewn_refinement_destroy(&flying);
        hewn_check_destroy(&whole);
        hewn_progressive_destroy(&made);
        hewn_model_destroy(&model);
    }
}

/* --- where it is fine --------------------------------------------------------------------------------------------- */

static void test_ends(void **state)
{
    (void)state;
    random_state random = {32};
    hewn_model model = make_shape(1, &random);
    hewn_progressive *made;
    assert_int_equal(hewn_progressive_make(&model, NULL, &made, NULL), HEWN_OK);
    const hewn_progressive_info info = hewn_progressive_about(made);
    hewn_refinement *refinement = refine(made);
    hewn_refinement_view view = {.eye = {5, 0, 0}, .pixels = 1000};
    uint64_t count;
    hewn_refinement_triangles(refinement, &count);
    assert_int_equal(count, info.base_triangles);
    assert_int_equal(hewn_refinement_update(refinement, &view, 0, NULL, NULL), HEWN_OK);
    hewn_refinement_triangles(refinement, &count);
    assert_int_equal(count, info.triangles);
    view.tolerance = INFINITY;
    assert_int_equal(hewn_refinement_update(refinement, &view, 0, NULL, NULL), HEWN_OK);
    hewn_model base = model_of_refinement(refinement), same;
    assert_int_equal(hewn_progressive_model(made, 0, &same, NULL), HEWN_OK);
    assert_int_equal(base.face_count, same.face_count);
    assert_memory_equal(base.corners, same.corners, 3 * base.face_count * sizeof *base.corners);
    assert_memory_equal(base.positions, same.positions, 3 * base.vertex_count * sizeof *base.positions);
    const hewn_refinement_view bad[] = {{.pixels = 0},
                                        {.pixels = 1, .tolerance = -1},
                                        {.pixels = 1, .tolerance = NAN},
                                        {.pixels = 1, .eye = {NAN, 0, 0}},
                                        {.pixels = 1, .silhouette = 2},
                                        {.pixels = 1, .back = 0.5},
                                        {.pixels = 1, .back = 3, .outside = 2},
                                        {.pixels = 1, .plane_count = 7}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(hewn_refinement_update(refinement, &bad[i], 0, NULL, NULL), HEWN_INVALID_ARGUMENT);
    hewn_model_destroy(&base);
    hewn_model_destroy(&same);
    hewn_refinement_destroy(&refinement);
    hewn_progressive_destroy(&made);
    hewn_model_destroy(&model);
}

/* The part of the triangles whose middle is on a side of x = 0. */
static uint64_t count_side(const hewn_model *model, double side)
{
    uint64_t count = 0;
    for (uint64_t t = 0; t < model->face_count; t++) {
        double x = 0;
        for (size_t k = 0; k < 3; k++)
            x += model->positions[3 * (size_t)model->corners[3 * t + k]];
        count += x * side > 0;
    }
    return count;
}

/* More triangles near the eye than away from it; more inside the picture than outside; more along outlines. */
static void test_detail_goes_where_it_is_seen(void **state)
{
    (void)state;
    random_state random = {33};
    hewn_model model = make_sphere(60, 1);
    add_noise(&model, 1e-3, &random);
    hewn_progressive *made;
    assert_int_equal(hewn_progressive_make(&model, NULL, &made, NULL), HEWN_OK);
    hewn_refinement *refinement = refine(made);
    const hewn_refinement_view near = {.eye = {1.5, 0, 0}, .pixels = 1000, .tolerance = 20};
    assert_int_equal(hewn_refinement_update(refinement, &near, 0, NULL, NULL), HEWN_OK);
    hewn_model seen = model_of_refinement(refinement);
    assert_true(count_side(&seen, 1) > 2 * count_side(&seen, -1));
    hewn_model_destroy(&seen);
    const hewn_refinement_view half = {.eye = {0, -4, 0},
                                       .pixels = 1000,
                                       .tolerance = 2,
                                       .planes = {{1, 0, 0, 0}},
                                       .plane_count = 1,
                                       .outside = INFINITY};
    assert_int_equal(hewn_refinement_update(refinement, &half, 0, NULL, NULL), HEWN_OK);
    seen = model_of_refinement(refinement);
    assert_true(count_side(&seen, 1) > 2 * count_side(&seen, -1));
    hewn_model_destroy(&seen);
    hewn_refinement_view outline = {.eye = {0, -4, 0}, .pixels = 1000, .tolerance = 8};
    uint64_t plain, sharp;
    assert_int_equal(hewn_refinement_update(refinement, &outline, 0, NULL, NULL), HEWN_OK);
    hewn_refinement_triangles(refinement, &plain);
    outline.silhouette = 0.2;
    assert_int_equal(hewn_refinement_update(refinement, &outline, 0, NULL, NULL), HEWN_OK);
    hewn_refinement_triangles(refinement, &sharp);
    assert_true(sharp > plain + plain / 4);
    hewn_refinement_destroy(&refinement);
    hewn_progressive_destroy(&made);
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_flight),
        cmocka_unit_test(test_ends),
        cmocka_unit_test(test_detail_goes_where_it_is_seen),
    };
    return cmocka_run_group_tests_name("refinement", tests, NULL, NULL);
}
