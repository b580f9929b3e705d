/* Simplification: what stays true of a mesh, targets, promises, locks, and input of every kind. */
#include <omp.h>

#include "hewn/check.h"
#include "hewn/distance.h"
#include "hewn/simplify.h"
#include "test_smooth_support.h"

/* --- calls and what must hold ------------------------------------------------------------------------------------- */

static hewn_model simplify(const hewn_model *model, const hewn_simplify_desc *desc, hewn_simplify_report *report)
{
    hewn_error error = {0};
    hewn_simplified out;
    const hewn_polygons polygons = hewn_model_polygons(model);
    if (hewn_polygons_simplify(&polygons, desc, &out, report, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    hewn_model made = {.vertex_count = out.vertex_count,
                       .face_count = out.face_count,
                       .positions = out.positions,
                       .corners = out.corners};
    for (uint64_t v = 0; v < out.vertex_count; v++)
        assert_true(out.vertex_origins[v] < model->vertex_count);
    for (uint64_t f = 0; f < out.face_count; f++)
        assert_true(out.face_origins[f] < model->face_count);
    hewn_free(out.vertex_origins);
    hewn_free(out.face_origins);
    return made;
}

static hewn_check *check_of(const hewn_model *model, bool crossings)
{
    hewn_error error = {0};
    hewn_check *check;
    const hewn_polygons polygons = hewn_model_polygons(model);
    if (hewn_check_polygons(&polygons, &(hewn_check_desc){.skip_self_intersections = !crossings}, &check, &error) !=
        HEWN_OK)
        fail_msg("%s", error.message);
    return check;
}

/* Topology stays, nothing degenerate is made, and no vertex is left over. */
static void assert_sound(const hewn_model *before, const hewn_model *after)
{
    hewn_check *a = check_of(before, false), *b = check_of(after, false);
    assert_int_equal(a->certificate.closed, b->certificate.closed);
    assert_true(b->certificate.manifold);
    assert_true(b->certificate.oriented);
    assert_int_equal(a->euler, b->euler);
    assert_int_equal(a->certificate.components, b->certificate.components);
    assert_int_equal(a->boundary_loops, b->boundary_loops);
    assert_int_equal(b->certificate.degenerate_faces, 0);
    assert_int_equal(b->duplicate_faces, 0);
    assert_int_equal(b->isolated_vertices, 0);
    hewn_check_destroy(&a);
    hewn_check_destroy(&b);
}

static double distance_between(const hewn_model *a, const hewn_model *b)
{
    hewn_error error = {0};
    hewn_distance out;
    const hewn_polygons one = hewn_model_polygons(a), two = hewn_model_polygons(b);
    if (hewn_polygons_distance(&one, &two, NULL, &out, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    assert_true(out.low <= out.high);
    return out.high;
}

/* A square of n × n cells in z = height × (a bump), open. */
static hewn_model make_sheet(uint32_t n, double height)
{
    hewn_model model = make_model((n + 1ull) * (n + 1), 2ull * n * n, 6ull * n * n, false);
    for (uint32_t j = 0; j <= n; j++)
        for (uint32_t i = 0; i <= n; i++) {
            double *at = model.positions + 3 * (size_t)(j * (n + 1) + i);
            at[0] = (double)i / n;
            at[1] = (double)j / n;
            at[2] = height * sin(M_PI * at[0]) * sin(2 * M_PI * at[1]);
        }
    for (uint32_t j = 0, c = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++, c += 6) {
            uint32_t a = j * (n + 1) + i, b = a + 1, d = a + n + 1, e = d + 1, corners[] = {a, b, e, a, e, d};
            memcpy(model.corners + c, corners, sizeof corners);
        }
    return model;
}

/* --- shapes ------------------------------------------------------------------------------------------------------- */

static void test_shapes_keep_their_topology(void **state)
{
    (void)state;
    static const double ratios[] = {1, 0.5, 0.1, 0.02};
    random_state random = {3};
    for (int shape = 0; shape < 4; shape++)
        for (int r = 0; r < 4; r++) {
            hewn_model model = shape == 0   ? make_sphere(30, 2)
                               : shape == 1 ? make_ring_model(60, 40, 3)
                               : shape == 2 ? make_sheet(50, 0.1)
                                            : model_of(join_meshes(make_torus(50, 30), make_torus(40, 20), 20));
            if (shape != 2)
                add_noise(&model, 1e-3, &random);
            hewn_simplify_report report;
            hewn_model out = simplify(&model, &(hewn_simplify_desc){.ratio = ratios[r]}, &report);
            assert_sound(&model, &out);
            assert_true(report.reached);
            assert_int_equal(report.triangles, out.face_count);
            assert_true((double)out.face_count <= ratios[r] * (double)report.triangles_before);
            assert_true((double)out.face_count > ratios[r] * (double)report.triangles_before - 3);
            hewn_model_destroy(&model);
            hewn_model_destroy(&out);
        }
}

/* On a sphere, every normal must point away from the centre, however few triangles are left. */
static void test_no_face_is_flipped(void **state)
{
    (void)state;
    random_state random = {4};
    for (uint64_t faces = 8; faces < 20000; faces *= 5) {
        hewn_model model = make_sphere(60, 1);
        add_noise(&model, 2e-3, &random);
        hewn_model out = simplify(&model, &(hewn_simplify_desc){.faces = faces}, NULL);
        assert_sound(&model, &out);
        assert_true(out.face_count <= faces);
        for (uint64_t f = 0; f < out.face_count; f++) {
            const double *p[3];
            for (size_t k = 0; k < 3; k++)
                p[k] = out.positions + 3 * (size_t)out.corners[3 * f + k];
            double volume = p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
                            p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
                            p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
            assert_true(volume > 0);
        }
        hewn_model_destroy(&model);
        hewn_model_destroy(&out);
    }
}

/* A flat sheet loses nothing by becoming two triangles, and neither does a cube by becoming twelve. */
static void test_flat_parts_cost_nothing(void **state)
{
    (void)state;
    hewn_model model = make_sheet(40, 0);
    hewn_model out = simplify(&model, &(hewn_simplify_desc){.faces = 2}, NULL);
    assert_int_equal(out.face_count, 2);
    assert_sound(&model, &out);
    assert_true(distance_between(&model, &out) < 1e-5);
    hewn_model_destroy(&model);
    hewn_model_destroy(&out);
}

/* Enough vertices for several parts, which run at the same time. */
static void test_same_bytes_for_any_threads(void **state)
{
    (void)state;
    random_state random = {5};
    const int threads = omp_get_max_threads();
    hewn_model model = make_sphere(130, 1);
    add_noise(&model, 5e-4, &random);
    assert_true(model.vertex_count > 50000);
    const hewn_simplify_desc descs[] = {{.ratio = 0.2}, {.ratio = 0.01}, {.relative_error = 0.01}};
    for (int i = 0; i < 3; i++) {
        omp_set_num_threads(1);
        hewn_simplify_report report, again;
        hewn_model one = simplify(&model, &descs[i], &report);
        assert_sound(&model, &one);
        for (int count = 2; count <= 5; count += 3) {
            omp_set_num_threads(count);
            hewn_model other = simplify(&model, &descs[i], &again);
            assert_int_equal(one.vertex_count, other.vertex_count);
            assert_int_equal(one.face_count, other.face_count);
            assert_memory_equal(one.positions, other.positions, one.vertex_count * 3 * sizeof(double));
            assert_memory_equal(one.corners, other.corners, one.face_count * 3 * sizeof(uint32_t));
            assert_true(report.distance == again.distance);
            hewn_model_destroy(&other);
        }
        hewn_model_destroy(&one);
    }
    omp_set_num_threads(threads);
    hewn_model_destroy(&model);
}

/* --- promises ----------------------------------------------------------------------------------------------------- */

static void test_errors_are_kept(void **state)
{
    (void)state;
    random_state random = {6};
    static const double errors[] = {0.1, 0.01, 0.002};
    for (int shape = 0; shape < 3; shape++) {
        uint64_t before = 0;
        for (int e = 0; e < 3; e++) {
            hewn_model model = shape == 0   ? make_sphere(40, 1)
                               : shape == 1 ? make_sheet(50, 0.2)
                                            : make_ring_model(60, 40, 3);
            if (shape != 1)
                add_noise(&model, 1e-3, &random);
            hewn_simplify_report report;
            hewn_model out = simplify(&model, &(hewn_simplify_desc){.error = errors[e]}, &report);
            assert_sound(&model, &out);
            assert_true(report.measured);
            assert_true(report.distance <= errors[e]);
            assert_true(report.error_allowed == errors[e]);
            assert_true(distance_between(&model, &out) <= errors[e] * 1.02);
            assert_true(out.face_count > before);                  /* a smaller error needs more triangles, */
            assert_true(out.face_count < report.triangles_before); /* but not all */
            before = out.face_count;
            hewn_model_destroy(&model);
            hewn_model_destroy(&out);
        }
    }
}

/* An error below what coordinates can tell cannot be promised. */
static void test_a_tiny_error_is_refused_or_kept(void **state)
{
    (void)state;
    random_state random = {7};
    hewn_model model = make_sphere(10, 1);
    add_noise(&model, 1e-2, &random);
    const hewn_polygons polygons = hewn_model_polygons(&model);
    for (double length = 1e-4; length > 1e-20; length /= 100) {
        hewn_error error = {0};
        hewn_simplified out;
        hewn_simplify_report report;
        hewn_result result =
            hewn_polygons_simplify(&polygons, &(hewn_simplify_desc){.error = length}, &out, &report, &error);
        assert_true(result == HEWN_OK ? report.distance <= length : result == HEWN_LIMIT);
        assert_true(result == HEWN_OK || length < 1e-10);
        hewn_simplified_destroy(&out);
    }
    hewn_model_destroy(&model);
}

/* Two sheets so close that simplifying each by itself would push one through the other. */
static void test_no_new_self_intersections(void **state)
{
    (void)state;
    const uint32_t n = 40;
    hewn_model sheet = make_sheet(n, 0.15);
    const uint64_t verts = sheet.vertex_count, faces = sheet.face_count;
    hewn_model both = make_model(2 * verts, 2 * faces, 6 * faces, false);
    for (uint64_t i = 0; i < 3 * verts; i++) {
        both.positions[i] = sheet.positions[i];
        both.positions[3 * verts + i] = sheet.positions[i] + (i % 3 == 2 ? 0.002 : 0);
    }
    for (uint64_t c = 0; c < 3 * faces; c++) {
        both.corners[c] = sheet.corners[c];
        both.corners[3 * faces + c] = sheet.corners[c] + (uint32_t)verts;
    }
    hewn_check *check = check_of(&both, true);
    assert_int_equal(check->self_intersections, 0);
    hewn_check_destroy(&check);
    hewn_model plain = simplify(&both, &(hewn_simplify_desc){.ratio = 0.05}, NULL);
    check = check_of(&plain, true);
    assert_true(check->self_intersections > 0); /* else this proves nothing */
    hewn_check_destroy(&check);
    hewn_simplify_report report;
    hewn_model out = simplify(&both, &(hewn_simplify_desc){.ratio = 0.05, .no_self_intersections = true}, &report);
    check = check_of(&out, true);
    assert_int_equal(check->self_intersections, 0);
    assert_true(report.runs > 1);
    assert_true(out.face_count < both.face_count);
    hewn_check_destroy(&check);
    assert_sound(&both, &out);
    hewn_model_destroy(&sheet);
    hewn_model_destroy(&both);
    hewn_model_destroy(&plain);
    hewn_model_destroy(&out);
}

/* --- what stays --------------------------------------------------------------------------------------------------- */

static bool has_vertex(const hewn_model *model, const double at[3])
{
    for (uint64_t v = 0; v < model->vertex_count; v++)
        if (memcmp(model->positions + 3 * v, at, 3 * sizeof *at) == 0)
            return true;
    return false;
}

static void test_locks(void **state)
{
    (void)state;
    const uint32_t n = 30;
    hewn_model model = make_sheet(n, 0.2);
    int32_t *labels = hewn_alloc_zero(model.face_count, sizeof *labels);
    for (uint64_t f = 0; f < model.face_count; f++)
        labels[f] = f / 2 % n >= n / 2;
    for (int lock = 0; lock < 3; lock++) {
        hewn_simplify_desc desc = {.ratio = 0.1, .labels = labels};
        desc.lock_boundary = lock == 1;
        desc.lock_labels = lock == 2;
        hewn_simplify_report report;
        hewn_model out = simplify(&model, &desc, &report);
        assert_sound(&model, &out);
        int boundary = 0, border = 0;
        for (uint32_t j = 0; j <= n; j++)
            for (uint32_t i = 0; i <= n; i++) {
                const bool there = has_vertex(&out, model.positions + 3 * (size_t)(j * (n + 1) + i));
                boundary += there && (i == 0 || i == n || j == 0 || j == n);
                border += there && i == n / 2;
            }
        assert_true(lock == 1 ? boundary == 4 * n : boundary < 4 * (int)n);
        assert_true(lock == 2 ? border == n + 1 : border < (int)n + 1);
        assert_int_equal(report.locked_vertices, lock == 1 ? 4 * n : lock == 2 ? n + 1 : 0);
        hewn_model_destroy(&out);
    }
    hewn_free(labels);
    hewn_model_destroy(&model);
}

/* A border between labels that is straight stays straight, and both sides keep their area. */
static void test_label_borders_stay_lines(void **state)
{
    (void)state;
    const uint32_t n = 40;
    hewn_model model = make_sheet(n, 0.05);
    int32_t *labels = hewn_alloc_zero(model.face_count, sizeof *labels);
    for (uint64_t f = 0; f < model.face_count; f++)
        labels[f] = f / 2 % n >= n / 2;
    hewn_simplified out;
    const hewn_polygons polygons = hewn_model_polygons(&model);
    assert_int_equal(
        hewn_polygons_simplify(&polygons, &(hewn_simplify_desc){.faces = 100, .labels = labels}, &out, NULL, NULL),
        HEWN_OK);
    assert_true(out.face_count <= 100);
    double area[2] = {0, 0};
    for (uint64_t f = 0; f < out.face_count; f++) { /* projected: the sheet is a height field */
        const double *a = out.positions + 3 * (size_t)out.corners[3 * f],
                     *b = out.positions + 3 * (size_t)out.corners[3 * f + 1],
                     *c = out.positions + 3 * (size_t)out.corners[3 * f + 2];
        area[labels[out.face_origins[f]]] += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    assert_true(fabs(area[0] - 0.5) < 1e-4);
    assert_true(fabs(area[1] - 0.5) < 1e-4);
    hewn_simplified_destroy(&out);
    hewn_free(labels);
    hewn_model_destroy(&model);
}

static void test_sharp_edges_are_locked(void **state)
{
    (void)state;
    hewn_model model = model_of(make_cube());
    hewn_simplify_report report;
    hewn_model out = simplify(&model, &(hewn_simplify_desc){.faces = 4, .lock_angle = 60}, &report);
    assert_int_equal(out.face_count, 12);
    assert_false(report.reached);
    assert_int_equal(report.locked_vertices, 8);
    hewn_model_destroy(&out);
    hewn_model_destroy(&model);
}

/* --- input of every kind ------------------------------------------------------------------------------------------ */

/* On a grid of 2^-20, moved by 2^20: every difference is exact, so the same is done. */
static void test_far_from_the_origin(void **state)
{
    (void)state;
    const double grid = 0x1p-20, far = 0x1p20;
    random_state random = {8};
    hewn_model model = make_sphere(60, 1), moved;
    add_noise(&model, 1e-3, &random);
    moved = make_model(model.vertex_count, model.face_count, 3 * model.face_count, false);
    memcpy(moved.corners, model.corners, 3 * model.face_count * sizeof *model.corners);
    for (uint64_t i = 0; i < 3 * model.vertex_count; i++) {
        model.positions[i] = round(model.positions[i] / grid) * grid;
        moved.positions[i] = model.positions[i] + far;
    }
    hewn_model one = simplify(&model, &(hewn_simplify_desc){.ratio = 0.05}, NULL);
    hewn_model two = simplify(&moved, &(hewn_simplify_desc){.ratio = 0.05}, NULL);
    assert_int_equal(one.face_count, two.face_count);
    assert_memory_equal(one.corners, two.corners, 3 * one.face_count * sizeof *one.corners);
    for (uint64_t i = 0; i < 3 * one.vertex_count; i++)
        assert_true(fabs(one.positions[i] + far - two.positions[i]) <= 0x1p-30);
    hewn_model_destroy(&model);
    hewn_model_destroy(&moved);
    hewn_model_destroy(&one);
    hewn_model_destroy(&two);
}

/* Anything at all: no crash, no index out of range, never a new non-manifold edge. */
static void test_soups(void **state)
{
    (void)state;
    random_state random = {9};
    for (int i = 0; i < 3000; i++) {
        hewn_model model = make_soup(&random);
        hewn_error error = {0};
        hewn_simplified out;
        hewn_simplify_report report;
        const hewn_polygons polygons = hewn_model_polygons(&model);
        const hewn_simplify_desc desc = {.faces = 1 + random_below(&random, 20),
                                         .no_self_intersections = random_below(&random, 4) == 0};
        hewn_result result = hewn_polygons_simplify(&polygons, &desc, &out, &report, &error);
        assert_true(result == HEWN_OK || (result == HEWN_BAD_INPUT && model.face_count == 0));
        if (result == HEWN_OK) {
            hewn_model made = {.vertex_count = out.vertex_count,
                               .face_count = out.face_count,
                               .positions = out.positions,
                               .corners = out.corners};
            hewn_check *before = check_of(&model, false), *after = check_of(&made, false);
            assert_true(after->certificate.non_manifold_edges <= before->certificate.non_manifold_edges);
            assert_true(after->certificate.non_manifold_vertices <= before->certificate.non_manifold_vertices);
            assert_int_equal(before->euler, after->euler);
            hewn_check_destroy(&before);
            hewn_check_destroy(&after);
        }
        hewn_simplified_destroy(&out);
        hewn_model_destroy(&model);
    }
}

/* Vertices at one place, and triangles without area, in a mesh that is otherwise good. */
static void test_triangles_without_area(void **state)
{
    (void)state;
    random_state random = {10};
    hewn_model model = make_sphere(30, 1);
    for (int i = 0; i < 300; i++) {
        uint64_t c = 3 * (uint64_t)random_below(&random, (uint32_t)model.face_count);
        memcpy(model.positions + 3 * (size_t)model.corners[c], model.positions + 3 * (size_t)model.corners[c + 1],
               3 * sizeof(double));
    }
    hewn_model out = simplify(&model, &(hewn_simplify_desc){.ratio = 0.1}, NULL);
    hewn_check *check = check_of(&out, false);
    assert_true(check->certificate.closed);
    assert_true(check->certificate.manifold);
    assert_int_equal(check->euler, 2);
    assert_int_equal(check->certificate.degenerate_faces, 0);
    assert_true(out.face_count <= model.face_count / 10);
    assert_true(fabs(check->certificate.volume - 4.0 / 3 * M_PI) < 0.1);
    hewn_check_destroy(&check);
    hewn_model_destroy(&out);
    hewn_model_destroy(&model);
}

static void refuse(hewn_result code, const char *says, const hewn_simplify_desc *desc, const hewn_model *model)
{
    hewn_error error = {0};
    hewn_simplified out;
    const hewn_polygons polygons = hewn_model_polygons(model);
    assert_int_equal(hewn_polygons_simplify(&polygons, desc, &out, NULL, &error), code);
    if (!strstr(error.message, says))
        fail_msg("'%s' is missing in: %s", says, error.message);
    assert_null(out.positions);
    assert_int_equal(out.face_count, 0);
}

static void test_bad_input(void **state)
{
    (void)state;
    hewn_model cube = model_of(make_cube()), none = {0};
    refuse(HEWN_INVALID_ARGUMENT, "needs a number of faces", &(hewn_simplify_desc){0}, &cube);
    refuse(HEWN_INVALID_ARGUMENT, "ratio", &(hewn_simplify_desc){.ratio = 1.5}, &cube);
    refuse(HEWN_INVALID_ARGUMENT, "ratio", &(hewn_simplify_desc){.ratio = -0.5}, &cube);
    refuse(HEWN_INVALID_ARGUMENT, "ratio", &(hewn_simplify_desc){.ratio = NAN}, &cube);
    refuse(HEWN_INVALID_ARGUMENT, "error", &(hewn_simplify_desc){.error = NAN}, &cube);
    refuse(HEWN_INVALID_ARGUMENT, "error", &(hewn_simplify_desc){.error = -1}, &cube);
    refuse(HEWN_INVALID_ARGUMENT, "error", &(hewn_simplify_desc){.relative_error = INFINITY}, &cube);
    refuse(HEWN_INVALID_ARGUMENT, "angle", &(hewn_simplify_desc){.faces = 4, .lock_angle = NAN}, &cube);
    refuse(HEWN_INVALID_ARGUMENT, "labels", &(hewn_simplify_desc){.faces = 4, .lock_labels = true}, &cube);
    refuse(HEWN_BAD_INPUT, "no faces", &(hewn_simplify_desc){.faces = 4}, &none);
    cube.positions[4] = NAN;
    refuse(HEWN_BAD_INPUT, "vertex 1", &(hewn_simplify_desc){.faces = 4}, &cube);
    cube.positions[4] = 0;
    cube.corners[5] = 8;
    refuse(HEWN_BAD_INPUT, "face 1 names vertex 8", &(hewn_simplify_desc){.faces = 4}, &cube);
    hewn_model_destroy(&cube);
}

static bool stop(void *user, const char *stage, double fraction)
{
    (void)stage;
    (void)fraction;
    return --*(int *)user > 0;
}

static void test_cancel(void **state)
{
    (void)state;
    hewn_model model = make_sphere(60, 1);
    for (int after = 1; after < 3; after++) {
        int left = after;
        const hewn_progress progress = {.report = stop, .user = &left};
        refuse(HEWN_CANCELLED, "cancelled", &(hewn_simplify_desc){.error = 0.01, .progress = &progress}, &model);
    }
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes_keep_their_topology),
        cmocka_unit_test(test_no_face_is_flipped),
        cmocka_unit_test(test_flat_parts_cost_nothing),
        cmocka_unit_test(test_same_bytes_for_any_threads),
        cmocka_unit_test(test_errors_are_kept),
        cmocka_unit_test(test_a_tiny_error_is_refused_or_kept),
        cmocka_unit_test(test_no_new_self_intersections),
        cmocka_unit_test(test_locks),
        cmocka_unit_test(test_label_borders_stay_lines),
        cmocka_unit_test(test_sharp_edges_are_locked),
        cmocka_unit_test(test_far_from_the_origin),
        cmocka_unit_test(test_soups),
        cmocka_unit_test(test_triangles_without_area),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_cancel),
    };
    return cmocka_run_group_tests_name("simplify", tests, NULL, NULL);
}
