/* Clusters with levels of detail: sizes, errors that rise, and cuts without cracks. */
#include <omp.h>

#include "hewn/check.h"
#include "hewn/clusters.h"
#include "hewn/distance.h"
#include "test_smooth_support.h"

static hewn_clusters make_clusters(const hewn_model *model, const hewn_clusters_desc *desc)
{
    hewn_error error = {0};
    hewn_clusters out;
    if (hewn_clusters_make(model, desc, &out, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return out;
}

static hewn_check *check_of(const hewn_model *model)
{
    hewn_check *check;
    const hewn_polygons polygons = hewn_model_polygons(model);
    assert_int_equal(hewn_check_polygons(&polygons, &(hewn_check_desc){.skip_self_intersections = true}, &check, NULL),
                     HEWN_OK);
    return check;
}

/* The triangles of a cut, over the vertices of the model that it names. `*error` becomes the greatest of the clusters'
 * errors. */
static hewn_model cut_of(const hewn_model *model, const hewn_clusters *from, const hewn_cluster_view *view,
                         double *error)
{
    hewn_model out = {0};
    uint32_t *numbers = hewn_alloc(model->vertex_count, sizeof *numbers);
    memset(numbers, 0xff, model->vertex_count * sizeof *numbers);
    out.positions = hewn_alloc(model->vertex_count, 3 * sizeof *out.positions);
    out.corners = hewn_alloc(from->triangle_count, 3 * sizeof *out.corners);
    *error = 0;
    for (uint32_t i = 0; i < from->count; i++) {
        const hewn_cluster *cluster = &from->clusters[i];
        if (!hewn_cluster_drawn(cluster, view))
            continue;
        *error = fmax(*error, (double)cluster->self.error);
        for (uint32_t c = 0; c < 3 * cluster->triangle_count; c++) {
            const uint8_t corner = from->corners[3 * (size_t)cluster->first_triangle + c];
            const uint32_t v = from->vertex_origins[from->vertices[cluster->first_vertex + corner]];
            if (numbers[v] == HEWN_NONE) {
                memcpy(out.positions + 3 * out.vertex_count, model->positions + 3 * (size_t)v, 3 * sizeof(double));
                numbers[v] = (uint32_t)out.vertex_count++;
            }
            out.corners[3 * out.face_count + c] = numbers[v];
        }
        out.face_count += cluster->triangle_count;
    }
    hewn_free(numbers);
    return out;
}

static hewn_model make_shape(int shape, random_state *random)
{
    hewn_model model = shape == 0   ? make_sphere(36, 2)
                       : shape == 1 ? make_ring_model(90, 60, 3)
                                    : model_of(join_meshes(make_torus(70, 50), make_torus(50, 30), 20));
    add_noise(&model, 2e-3, random);
    return model;
}

/* --- what is promised of each cluster ----------------------------------------------------------------------------- */

static void assert_inside(const hewn_cluster_bound *inner, const hewn_cluster_bound *outer)
{
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double d = (double)inner->center[axis] - (double)outer->center[axis];
        square += d * d;
    }
    assert_true(sqrt(square) + (double)inner->radius <= (double)outer->radius);
    assert_true(inner->error <= outer->error);
}

static void test_clusters_are_as_they_should_be(void **state)
{
    (void)state;
    random_state random = {21};
    for (int shape = 0; shape < 3; shape++) {
        hewn_model model = make_shape(shape, &random);
        const uint32_t sizes[][2] = {{64, 124}, {32, 20}, {255, 512}};
        hewn_clusters made =
            make_clusters(&model, &(hewn_clusters_desc){.vertices = sizes[shape][0], .triangles = sizes[shape][1]});
        uint64_t input = 0, roots = 0, parents = 0;
        for (uint32_t i = 0; i < made.count; i++) {
            const hewn_cluster *cluster = &made.clusters[i];
            assert_true(cluster->vertex_count >= 3 && cluster->vertex_count <= sizes[shape][0]);
            assert_true(cluster->triangle_count >= 1 && cluster->triangle_count <= sizes[shape][1]);
            for (uint32_t c = 0; c < 3 * cluster->triangle_count; c++)
                assert_true(made.corners[3 * (size_t)cluster->first_triangle + c] < cluster->vertex_count);
            for (uint32_t v = 0; v < cluster->vertex_count; v++) {
                const uint32_t unique = made.vertices[cluster->first_vertex + v];
                assert_true(unique < made.unique_count);
                const double *p = model.positions + 3 * (size_t)made.vertex_origins[unique];
                const double at[3] = {(double)cluster->center[0], (double)cluster->center[1],
                                      (double)cluster->center[2]};
                assert_true(distance(p, at) <= (double)cluster->radius);
            }
            assert_true(cluster->level > 0 || cluster->self.error == 0);
            input += cluster->level == 0 ? cluster->triangle_count : 0;
            roots += isinf(cluster->parent.error) ? cluster->triangle_count : 0;
            parents += !isinf(cluster->parent.error);
            if (!isinf(cluster->parent.error))
                assert_inside(&cluster->self, &cluster->parent);
        }
        uint64_t triangles = hewn_model_corner_count(&model) - 2 * model.face_count;
        assert_int_equal(input, triangles);
        assert_true(parents > made.count / 2);
        assert_true(roots < triangles / 8);
        hewn_clusters_destroy(&made);
        hewn_model_destroy(&model);
    }
}

/* --- cuts --------------------------------------------------------------------------------------------------------- */

/* From anywhere and for any tolerance the cut is a closed manifold of the same topology, and as near as it says. */
static void test_cuts_have_no_cracks(void **state)
{
    (void)state;
    random_state random = {22};
    static const struct {
        int shape;
        hewn_clusters_desc desc;
    } cases[] = {{0, {.vertices = 64}},
                 {1, {.vertices = 24, .triangles = 32}},
                 {2, {.group = 4}},
                 {1, {.vertices = 20, .triangles = 24, .group = 2}},
                 {2, {.vertices = 16, .triangles = 16, .group = 4}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hewn_model model = make_shape(cases[i].shape, &random);
        hewn_clusters made = make_clusters(&model, &cases[i].desc);
        hewn_check *whole = check_of(&model);
        uint64_t least = UINT64_MAX, most = 0, mixed = 0;
        for (int round = 0; round < 60; round++) {
            hewn_cluster_view view = {.pixels = 1000};
            double error;
            for (int axis = 0; axis < 3; axis++)
                view.eye[axis] = (6 * random_unit(&random) - 3) * (round % 3 == 2 ? 12 : 1);
            view.tolerance = round == 0 ? 0 : pow(10, 4 * random_unit(&random) - 2);
            hewn_model cut = cut_of(&model, &made, &view, &error);
            hewn_check *check = check_of(&cut);
            assert_true(check->certificate.closed && check->certificate.manifold && check->certificate.oriented);
            assert_int_equal(check->euler, whole->euler);
            assert_int_equal(check->certificate.components, whole->certificate.components);
            assert_int_equal(check->duplicate_faces, 0);
            least = cut.face_count < least ? cut.face_count : least;
            most = cut.face_count > most ? cut.face_count : most;
            mixed += round > 0 && cut.face_count < model.face_count / 2 && cut.face_count > model.face_count / 16;
            if (round % 8 == 1) {
                hewn_distance distance;
                const hewn_polygons one = hewn_model_polygons(&cut), two = hewn_model_polygons(&model);
                assert_int_equal(hewn_polygons_distance(&one, &two, NULL, &distance, NULL), HEWN_OK);
                assert_true(distance.low <= error);
            }
            hewn_check_destroy(&check);
            hewn_model_destroy(&cut);
        }
        assert_true(least < most / (i < 3 ? 8 : 3));
        assert_true(mixed > 0);
        hewn_check_destroy(&whole);
        hewn_clusters_destroy(&made);
        hewn_model_destroy(&model);
    }
}

/* --- attributes, odd input, threads ------------------------------------------------------------------------------- */

/* A corner's values are those of a corner of the input at the same vertex, and labels keep their sides. */
static void test_attributes_stay_with_their_vertices(void **state)
{
    (void)state;
    hewn_model model = make_sphere(24, 1);
    float *uv = add_channel(&model, "uv", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 2)->values;
    int32_t *label = add_channel(&model, "label", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1)->values;
    for (uint64_t f = 0; f < model.face_count; f++) {
        label[f] = f < model.face_count / 2;
        for (uint64_t c = 3 * f; c < 3 * f + 3; c++)
            uv[2 * c] = (float)model.positions[3 * (size_t)model.corners[c]] + (float)(10 * label[f]);
    }
    hewn_clusters made = make_clusters(&model, NULL);
    for (uint32_t i = 0; i < made.count; i++)
        for (uint32_t c = 0; c < 3 * made.clusters[i].triangle_count; c++) {
            const hewn_cluster *cluster = &made.clusters[i];
            const size_t at = 3 * (size_t)cluster->first_triangle + c;
            const uint32_t unique = made.vertices[cluster->first_vertex + made.corners[at]];
            const uint32_t corner = made.corner_origins[unique];
            assert_int_equal(model.corners[corner], made.vertex_origins[unique]);
            assert_int_equal(label[corner / 3], label[made.faces[at / 3]]);
        }
    assert_true(made.level_count >= 4);
    hewn_clusters_destroy(&made);
    hewn_model_destroy(&model);
}

static void test_odd_input(void **state)
{
    (void)state;
    random_state random = {23};
    for (int round = 0; round < 30; round++) {
        hewn_model soup = make_soup(&random);
        hewn_clusters made = make_clusters(&soup, &(hewn_clusters_desc){.vertices = 8, .triangles = 6});
        uint64_t input = 0;
        for (uint32_t i = 0; i < made.count; i++)
            input += made.clusters[i].level == 0 ? made.clusters[i].triangle_count : 0;
        assert_int_equal(input, hewn_model_corner_count(&soup) - 2 * soup.face_count);
        hewn_clusters_destroy(&made);
        hewn_model_destroy(&soup);
    }
    hewn_model none = {0};
    hewn_clusters made = make_clusters(&none, NULL);
    assert_int_equal(made.count, 0);
    hewn_clusters_destroy(&made);
    const hewn_clusters_desc bad[] = {
        {.vertices = 2}, {.vertices = 256}, {.triangles = 513}, {.group = 1}, {.group = 33}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(hewn_clusters_make(&none, &bad[i], &made, NULL), HEWN_INVALID_ARGUMENT);
}

static void test_threads_change_nothing(void **state)
{
    (void)state;
    random_state random = {24};
    hewn_model model = make_shape(1, &random);
    hewn_clusters first = make_clusters(&model, NULL);
    const int threads = omp_get_max_threads();
    for (int count = 1; count <= 5; count += 2) {
        omp_set_num_threads(count);
        hewn_clusters other = make_clusters(&model, NULL);
        assert_int_equal(first.count, other.count);
        assert_int_equal(first.vertex_count, other.vertex_count);
        assert_memory_equal(first.clusters, other.clusters, first.count * sizeof *first.clusters);
        assert_memory_equal(first.vertices, other.vertices, first.vertex_count * sizeof *first.vertices);
        assert_memory_equal(first.corners, other.corners, first.triangle_count * 3);
        hewn_clusters_destroy(&other);
    }
    omp_set_num_threads(threads);
    hewn_clusters_destroy(&first);
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_clusters_are_as_they_should_be),
        cmocka_unit_test(test_cuts_have_no_cracks),
        cmocka_unit_test(test_attributes_stay_with_their_vertices),
        cmocka_unit_test(test_odd_input),
        cmocka_unit_test(test_threads_change_nothing),
    };
    return cmocka_run_group_tests_name("clusters", tests, NULL, NULL);
}
