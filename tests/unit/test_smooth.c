/* Smoothing: what each method must do to shapes whose smoothing is known. */
#include <omp.h>

#include "test_smooth_support.h"

static hewn_error *const error = &(hewn_error){0};

/* --- eigenvectors ------------------------------------------------------------------------------------------------- */

/* Jacobi's method: the symmetric n × n matrix becomes diagonal, `vectors` its eigenvectors as columns. */
static void diagonalise(double *matrix, double *vectors, uint32_t n)
{
    for (uint32_t i = 0; i < n * n; i++)
        vectors[i] = i / n == i % n;
    for (int sweep = 0; sweep < 30; sweep++)
        for (uint32_t p = 0; p < n; p++)
            for (uint32_t q = p + 1; q < n; q++) {
                double off = matrix[p * n + q];
                if (fabs(off) < 1e-300)
                    continue;
                double theta = (matrix[q * n + q] - matrix[p * n + p]) / (2 * off);
                double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
                double c = 1 / sqrt(t * t + 1), s = t * c;
                for (uint32_t i = 0; i < n; i++) {
                    double a = matrix[i * n + p], b = matrix[i * n + q];
                    matrix[i * n + p] = c * a - s * b;
                    matrix[i * n + q] = s * a + c * b;
                }
                for (uint32_t i = 0; i < n; i++) {
                    double a = matrix[p * n + i], b = matrix[q * n + i];
                    matrix[p * n + i] = c * a - s * b;
                    matrix[q * n + i] = s * a + c * b;
                    a = vectors[i * n + p], b = vectors[i * n + q];
                    vectors[i * n + p] = c * a - s * b;
                    vectors[i * n + q] = s * a + c * b;
                }
            }
}

/* The eigenvalues of I - D^-1 A, and its eigenvectors as columns: D^-1/2 those of I - D^-1/2 A D^-1/2. */
static void find_spectrum(const hewn_model *model, double *values, double *vectors)
{
    uint32_t n = (uint32_t)model->vertex_count;
    double *matrix = calloc((size_t)n * n, sizeof *matrix), *degree = calloc(n, sizeof *degree);
    assert_non_null(matrix);
    assert_non_null(degree);
    for (uint64_t c = 0; c < 3 * model->face_count; c++)
        matrix[model->corners[c] * n + model->corners[c % 3 == 2 ? c - 2 : c + 1]] = -1;
    for (uint32_t i = 0; i < n * n; i++)
        degree[i / n] -= matrix[i];
    for (uint32_t i = 0; i < n * n; i++)
        matrix[i] = i / n == i % n ? 1 : matrix[i] / sqrt(degree[i / n] * degree[i % n]);
    diagonalise(matrix, vectors, n);
    for (uint32_t i = 0; i < n * n; i++)
        vectors[i] /= sqrt(degree[i / n]);
    for (uint32_t i = 0; i < n; i++)
        values[i] = matrix[i * n + i];
    free(matrix);
    free(degree);
}

/* Positions made of three eigenvectors: each coordinate is scaled by its own factor. */
static void assert_scaled(hewn_model *model, const hewn_smooth_desc *desc, const double *values, const double *vectors)
{
    uint32_t n = (uint32_t)model->vertex_count;
    double lambda = desc->strength, mu = desc->method == HEWN_SMOOTH_TAUBIN ? 1 / (1 / lambda - desc->passband) : 0;
    double *positions = make_positions(model);
    for (uint32_t k = 0; k < n; k += 3) {
        uint32_t which[3] = {k, k + 1 < n ? k + 1 : k, k + 2 < n ? k + 2 : k};
        for (uint32_t i = 0; i < 3 * n; i++)
            model->positions[i] = vectors[i / 3 * n + which[i % 3]];
        smooth(model, desc, positions, NULL);
        for (uint32_t i = 0; i < 3 * n; i++) {
            double value = values[which[i % 3]], factor = (1 - lambda * value) * (1 + mu * value);
            double wanted = pow(factor, desc->iterations) * model->positions[i];
            if (!(fabs(positions[i] - wanted) <= 1e-9))
                fail_msg("eigenvalue %g: %.12g instead of %.12g", value, positions[i], wanted);
        }
    }
    hewn_free(positions);
}

static void test_eigenvectors_are_scaled(void **state)
{
    (void)state;
    random_state random = {1};
    hewn_model models[] = {model_of(make_torus(7, 5)), model_of(make_bipyramid(9)), make_sphere(3, 1)};
    for (size_t m = 0; m < sizeof models / sizeof *models; m++) {
        size_t n = models[m].vertex_count;
        double *values = malloc((n + n * n) * sizeof *values);
        assert_non_null(values);
        find_spectrum(&models[m], values, values + n);
        for (int i = 0; i < 10; i++) {
            hewn_smooth_desc desc = {.method = i % 2 ? HEWN_SMOOTH_TAUBIN : HEWN_SMOOTH_LAPLACIAN,
                                     .volume = HEWN_SMOOTH_VOLUME_FREE};
            desc.iterations = 1 + random_below(&random, 4);
            desc.strength = 0.05 + 0.9 * random_unit(&random);
            desc.passband = 0.01 + 0.5 * random_unit(&random);
            assert_scaled(&models[m], &desc, values, values + n);
        }
        free(values);
        hewn_model_destroy(&models[m]);
    }
}

/* --- curvature ---------------------------------------------------------------------------------------------------- */

static void test_curvature_of_a_sphere(void **state)
{
    (void)state;
    const double radius = 3.5;
    hewn_model model = make_sphere(24, radius);
    hewn_polygons polygons = hewn_model_polygons(&model);
    double *curvature = make_positions(&model);
    assert_int_equal(hewn_mean_curvature(&polygons, curvature, NULL, error), HEWN_OK);
    for (uint64_t v = 0; v < model.vertex_count; v++) {
        const double *x = model.positions + 3 * v, *h = curvature + 3 * v;
        double length = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
        double inward = -(h[0] * x[0] + h[1] * x[1] + h[2] * x[2]) / radius;
        assert_true(fabs(length * radius / 2 - 1) < 0.01);
        assert_true(inward > 0.999 * length);
    }
    hewn_free(curvature);
    hewn_model_destroy(&model);
}

static double area_of(const hewn_model *model)
{
    double sum = 0;
    for (uint64_t t = 0; t < model->face_count; t++) {
        const double *p[3];
        for (uint64_t k = 0; k < 3; k++)
            p[k] = model->positions + 3 * (size_t)model->corners[3 * t + k];
        double u[3], v[3];
        for (int i = 0; i < 3; i++) {
            u[i] = p[1][i] - p[0][i];
            v[i] = p[2][i] - p[0][i];
        }
        double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
        sum += sqrt(x * x + y * y + z * z) / 2;
    }
    return sum;
}

/* Obtuse triangles and slivers among them. */
static void test_areas_sum_to_the_area(void **state)
{
    (void)state;
    random_state random = {2};
    for (int i = 0; i < 400; i++) {
        hewn_model model = make_soup(&random);
        double *areas = hewn_alloc(model.vertex_count, sizeof *areas), sum = 0, whole = area_of(&model);
        hewn_polygons polygons = hewn_model_polygons(&model);
        assert_int_equal(hewn_mean_curvature(&polygons, NULL, areas, error), HEWN_OK);
        for (uint64_t v = 0; v < model.vertex_count; v++) {
            assert_true(areas[v] >= 0);
            sum += areas[v];
        }
        assert_true(fabs(sum - whole) <= 1e-12 * whole);
        hewn_free(areas);
        hewn_model_destroy(&model);
    }
}

/* --- implicit ----------------------------------------------------------------------------------------------------- */

/* A sphere under mean curvature flow: dR/dt = -2 / R, so R^2 falls by 4 t. */
static void test_flow_of_a_sphere(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        hewn_model model = make_sphere(16, 1);
        hewn_smooth_desc desc = {.method = i ? HEWN_SMOOTH_IMPLICIT : HEWN_SMOOTH_COTAN, .iterations = 10};
        desc.step = 0.04; /* a time of 0.0008 a step */
        hewn_smooth_report report;
        double *positions = make_positions(&model);
        smooth(&model, &desc, positions, &report);
        assert_int_equal(report.clamped_vertices, 0);
        double mean = 0;
        for (uint64_t v = 0; v < model.vertex_count; v++)
            mean += sqrt(positions[3 * v] * positions[3 * v] + positions[3 * v + 1] * positions[3 * v + 1] +
                         positions[3 * v + 2] * positions[3 * v + 2]) /
                    (double)model.vertex_count;
        assert_true(fabs(mean - sqrt(1 - 4 * 0.008)) < 3e-4);
        hewn_free(positions);
        hewn_model_destroy(&model);
    }
}

/* A small explicit step goes along the mean curvature vector; around few corners, many, and more than a batch holds,
 * and where faces are cut first. */
static void test_small_steps_follow_the_curvature(void **state)
{
    (void)state;
    random_state random = {11};
    hewn_model models[] = {model_of(make_torus(24, 10)), model_of(make_bipyramid(20)), model_of(make_bipyramid(600)),
                           make_ring_model(18, 9, 4)};
    for (size_t m = 0; m < sizeof models / sizeof *models; m++) {
        hewn_model *model = models + m;
        add_noise(model, 0.001, &random);
        double *positions = make_positions(model), *curvature = make_positions(model), most = 0;
        hewn_polygons polygons = hewn_model_polygons(model);
        hewn_smooth_report report;
        const double step = 1e-5;
        assert_int_equal(hewn_mean_curvature(&polygons, curvature, NULL, error), HEWN_OK);
        smooth(model, &(hewn_smooth_desc){.method = HEWN_SMOOTH_COTAN, .iterations = 1, .step = step}, positions,
               &report);
        assert_int_equal(report.clamped_vertices, 0);
        for (uint64_t i = 0; i < 3 * model->vertex_count; i++)
            most = fmax(most, fabs(curvature[i]));
        uint64_t moved = 0;
        for (uint64_t i = 0; i < 3 * model->vertex_count; i++) {
            const double move = (positions[i] - model->positions[i]) * 2 / (step * step);
            moved += fabs(move - curvature[i]) < 1e-4 * most;
        }
        assert_int_equal(moved, 3 * model->vertex_count);
        hewn_free(positions);
        hewn_free(curvature);
        hewn_model_destroy(model);
    }
}

/* Far along, weights that are kept make a sphere shrink as e^(-2 t), since its area stays what it was; those measured
 * anew as its curvature grows. */
static void test_weights_are_kept_or_not(void **state)
{
    (void)state;
    const double time = 0.15, results[] = {exp(-2 * time), sqrt(1 - 4 * time)};
    for (uint32_t i = 0; i < 4; i++) {
        hewn_model model = make_sphere(8, 1);
        const uint32_t again = i / 2, steps = i % 2 ? 60 : 200;
        hewn_smooth_desc desc = {.method = i % 2 ? HEWN_SMOOTH_IMPLICIT : HEWN_SMOOTH_COTAN,
                                 .iterations = steps,
                                 .step = sqrt(2 * time / steps),
                                 .remeasure = again};
        double *positions = make_positions(&model), mean = 0;
        smooth(&model, &desc, positions, NULL);
        for (uint64_t v = 0; v < model.vertex_count; v++)
            mean += sqrt(positions[3 * v] * positions[3 * v] + positions[3 * v + 1] * positions[3 * v + 1] +
                         positions[3 * v + 2] * positions[3 * v + 2]) /
                    (double)model.vertex_count;
        assert_true(fabs(mean / results[again] - 1) < 0.015);
        hewn_free(positions);
        hewn_model_destroy(&model);
    }
}

/* Any step is stable: nothing grows, and a huge one gathers each component at one place. */
static void test_any_step_is_stable(void **state)
{
    (void)state;
    random_state random = {3};
    for (double step = 1e-6; step < 1e9; step *= 10) {
        hewn_model model = model_of(make_torus(30, 12));
        add_noise(&model, 0.02, &random);
        double *positions = make_positions(&model);
        hewn_smooth_report report;
        smooth(&model, &(hewn_smooth_desc){.method = HEWN_SMOOTH_IMPLICIT, .step = step, .iterations = 3}, positions,
               &report);
        for (uint64_t i = 0; i < 3 * model.vertex_count; i++)
            assert_true(fabs(positions[i]) < 1.5);
        assert_true(report.area_after <= report.area_before * (1 + 1e-12));
        if (step > 1e5)
            assert_true(distance(positions, positions + 300) < 1e-6);
        hewn_free(positions);
        hewn_model_destroy(&model);
    }
}

/* Steps use one matrix: three at once are not three calls, but for the first they are the same. */
static void test_implicit_solves_its_equation(void **state)
{
    (void)state;
    hewn_model model = make_sphere(8, 2);
    random_state random = {4};
    add_noise(&model, 0.05, &random);
    hewn_polygons polygons = hewn_model_polygons(&model);
    hewn_smooth_desc desc = {.method = HEWN_SMOOTH_IMPLICIT, .step = 0.3, .iterations = 1};
    double *after = make_positions(&model), *areas = make_positions(&model), *pull = make_positions(&model);
    smooth(&model, &desc, after, NULL);
    assert_int_equal(hewn_mean_curvature(&polygons, pull, areas, error), HEWN_OK);
    /* M x' = M x + t L x' with L of the start: its sum over all vertices vanishes, so M keeps the centre of mass. */
    for (int axis = 0; axis < 3; axis++) {
        double before_sum = 0, after_sum = 0;
        for (uint64_t v = 0; v < model.vertex_count; v++) {
            before_sum += areas[v] * model.positions[3 * v + (uint64_t)axis];
            after_sum += areas[v] * after[3 * v + (uint64_t)axis];
        }
        assert_true(fabs(before_sum - after_sum) < 1e-10);
    }
    /* With a tiny step it is the explicit one. */
    desc.step = 1e-4;
    smooth(&model, &desc, after, NULL);
    double largest = 0;
    for (uint64_t i = 0; i < 3 * model.vertex_count; i++) {
        double wanted = 0.5e-8 * pull[i];
        largest = fmax(largest, fabs(wanted));
        assert_true(fabs(after[i] - model.positions[i] - wanted) < 1e-4 * fabs(wanted) + 1e-11);
    }
    assert_true(largest > 1e-9);
    hewn_free(after);
    hewn_free(areas);
    hewn_free(pull);
    hewn_model_destroy(&model);
}

/* --- what all methods share --------------------------------------------------------------------------------------- */

static void test_same_bytes_for_any_threads(void **state)
{
    (void)state;
    int threads = omp_get_max_threads();
    random_state random = {5};
    hewn_model model = model_of(make_torus(160, 60));
    add_noise(&model, 0.003, &random);
    for (size_t m = 0; m < sizeof all_methods / sizeof *all_methods; m++) {
        double *first = make_positions(&model), *other = make_positions(&model);
        hewn_smooth_desc desc = {.method = all_methods[m],
                                 .iterations = 4,
                                 .volume = m % 2 == 0 ? HEWN_SMOOTH_VOLUME_KEPT : HEWN_SMOOTH_VOLUME_FREE};
        omp_set_num_threads(1);
        smooth(&model, &desc, first, NULL);
        for (int count = 2; count <= 7; count += 1 + count / 3) {
            omp_set_num_threads(count);
            smooth(&model, &desc, other, NULL);
            assert_memory_equal(first, other, model.vertex_count * 3 * sizeof *first);
        }
        hewn_free(first);
        hewn_free(other);
    }
    omp_set_num_threads(threads);
    hewn_model_destroy(&model);
}

static void test_soups_stay_finite(void **state)
{
    (void)state;
    random_state random = {6};
    for (int i = 0; i < 1500; i++) {
        hewn_model model = make_soup(&random);
        hewn_smooth_desc desc = {.method = all_methods[i % 6], .iterations = 1 + random_below(&random, 5)};
        desc.volume = (hewn_smooth_volume)random_below(&random, 3);
        desc.lock_boundary = random_below(&random, 2);
        desc.lock_angle = random_below(&random, 2) ? 40 : 0;
        double *positions = make_positions(&model);
        hewn_smooth_report report;
        smooth(&model, &desc, positions, &report);
        for (uint64_t k = 0; k < 3 * model.vertex_count; k++)
            assert_true(isfinite(positions[k]));
        assert_true(isfinite(report.area_after) && isfinite(report.volume_after) && isfinite(report.mean_move));
        hewn_free(positions);
        hewn_model_destroy(&model);
    }
}

/* Faces that have no area at all, and vertices that have no face. */
static void test_flat_and_isolated(void **state)
{
    (void)state;
    for (size_t m = 0; m < 6; m++) {
        hewn_model model = make_model(9, 4, 12, false);
        for (uint32_t i = 0; i < 9; i++)
            model.positions[3 * (size_t)i] = i < 6 ? (double)(i / 2) : 7;
        static const uint32_t corners[] = {0, 2, 4, 0, 1, 2, 3, 3, 3, 2, 3, 4};
        memcpy(model.corners, corners, sizeof corners);
        double *positions = make_positions(&model);
        smooth(&model, &(hewn_smooth_desc){.method = all_methods[m], .volume = HEWN_SMOOTH_VOLUME_KEPT}, positions,
               NULL);
        for (uint64_t i = 0; i < 27; i++)
            assert_true(isfinite(positions[i]));
        assert_memory_equal(positions + 18, model.positions + 18, 9 * sizeof(double));
        hewn_free(positions);
        hewn_model_destroy(&model);
    }
}

static void test_locks(void **state)
{
    (void)state;
    random_state random = {7};
    for (size_t m = 0; m < 6; m++) {
        hewn_model model = model_of(make_torus(20, 10));
        model.face_count -= 37; /* an open mesh */
        add_noise(&model, 0.02, &random);
        double *freedom = calloc(model.vertex_count, sizeof *freedom);
        int32_t *labels = calloc(model.face_count, sizeof *labels);
        uint8_t *stays = calloc(model.vertex_count, 1);
        assert_true(freedom && labels && stays);
        for (uint64_t v = 0; v < model.vertex_count; v++) {
            freedom[v] = random_below(&random, 4) ? random_unit(&random) : 0;
            stays[v] = freedom[v] == 0;
        }
        for (uint64_t f = 0; f < model.face_count; f++)
            labels[f] = f < 150;
        for (uint64_t f = 0; f < 3 * model.face_count; f++) /* an edge has its other face among all */
            for (uint64_t g = 0; g < 3 * model.face_count; g++)
                if (model.corners[f] == model.corners[g % 3 == 2 ? g - 2 : g + 1] &&
                    model.corners[g] == model.corners[f % 3 == 2 ? f - 2 : f + 1] && labels[f / 3] != labels[g / 3])
                    stays[model.corners[f]] = stays[model.corners[g]] = 1;
        double *positions = make_positions(&model);
        hewn_smooth_desc desc = {.method = all_methods[m],
                                 .freedom = freedom,
                                 .labels = labels,
                                 .lock_boundary = true,
                                 .volume = HEWN_SMOOTH_VOLUME_KEPT};
        hewn_smooth_report report;
        smooth(&model, &desc, positions, &report);
        uint64_t moved = 0, used = 0;
        uint8_t *seen = calloc(model.vertex_count, 1);
        assert_non_null(seen);
        for (uint64_t c = 0; c < 3 * model.face_count; c++) {
            used += !seen[model.corners[c]];
            seen[model.corners[c]] = 1;
        }
        free(seen);
        for (uint64_t v = 0; v < model.vertex_count; v++) {
            bool same = memcmp(positions + 3 * v, model.positions + 3 * v, 3 * sizeof(double)) == 0;
            assert_true(same || !stays[v]);
            moved += !same;
        }
        assert_true(moved > 50);
        assert_true(report.locked_vertices + moved == used);
        free(freedom);
        free(labels);
        free(stays);
        hewn_free(positions);
        hewn_model_destroy(&model);
    }
}

static void test_features_are_locked(void **state)
{
    (void)state;
    hewn_model model = model_of(make_cube());
    double *positions = make_positions(&model);
    hewn_smooth_desc desc = {.lock_angle = 89};
    smooth(&model, &desc, positions, NULL);
    assert_memory_equal(positions, model.positions, 24 * sizeof(double));
    desc.lock_angle = 91;
    smooth(&model, &desc, positions, NULL);
    assert_true(distance(positions, model.positions) > 0.01);
    hewn_free(positions);
    hewn_model_destroy(&model);
}

static void test_volume_is_kept(void **state)
{
    (void)state;
    random_state random = {8};
    for (size_t m = 0; m < 6; m++) {
        hewn_model model = model_of(join_meshes(make_torus(40, 16), make_bipyramid(20), 5));
        add_noise(&model, 0.01, &random);
        hewn_smooth_desc desc = {.method = all_methods[m], .iterations = 5, .volume = HEWN_SMOOTH_VOLUME_KEPT};
        double *positions = make_positions(&model);
        hewn_smooth_report report;
        smooth(&model, &desc, positions, &report);
        assert_int_equal(report.closed_components, 2);
        assert_true(fabs(report.volume_after - report.volume_before) <= 1e-9 * fabs(report.volume_before));
        desc.volume = HEWN_SMOOTH_VOLUME_FREE;
        smooth(&model, &desc, positions, &report);
        assert_true(fabs(report.volume_after - report.volume_before) > 1e-6 * fabs(report.volume_before));
        hewn_free(positions);
        hewn_model_destroy(&model);
    }
}

/* A mesh far from the origin, or of another size, is smoothed alike. */
static void test_place_and_size_do_not_matter(void **state)
{
    (void)state;
    random_state random = {9};
    hewn_model model = model_of(make_torus(20, 10));
    add_noise(&model, 0.02, &random);
    double *near = make_positions(&model), *far = make_positions(&model), *start = make_positions(&model);
    for (size_t m = 0; m < 6; m++) {
        hewn_smooth_desc desc = {.method = all_methods[m]};
        memcpy(model.positions, start, model.vertex_count * 3 * sizeof *start);
        smooth(&model, &desc, near, NULL);
        for (uint64_t i = 0; i < 3 * model.vertex_count; i++)
            model.positions[i] = start[i] * 0x1p40 + 0x1p55;
        smooth(&model, &desc, far, NULL);
        for (uint64_t i = 0; i < 3 * model.vertex_count; i++)
            assert_true(fabs((far[i] - 0x1p55) * 0x1p-40 - near[i]) < 1e-9);
    }
    hewn_free(near);
    hewn_free(far);
    hewn_free(start);
    hewn_model_destroy(&model);
}

static void expect(hewn_result code, const char *says, const hewn_model *model, hewn_smooth_desc desc)
{
    hewn_polygons polygons = hewn_model_polygons(model);
    double *positions = make_positions(model);
    hewn_error reason = {0};
    assert_int_equal(hewn_polygons_smooth(&polygons, &desc, positions, NULL, &reason), code);
    if (!strstr(reason.message, says))
        fail_msg("'%s' is missing in '%s'", says, reason.message);
    assert_memory_equal(positions, model->positions, model->vertex_count * 3 * sizeof *positions);
    hewn_free(positions);
}

static bool stop(void *user, const char *stage, double fraction)
{
    assert_string_equal(stage, "smooth");
    (void)user;
    (void)fraction;
    return false;
}

static void test_refusals(void **state)
{
    (void)state;
    hewn_model model = model_of(make_cube());
    expect(HEWN_INVALID_ARGUMENT, "strength", &model, (hewn_smooth_desc){.strength = 1.5});
    expect(HEWN_INVALID_ARGUMENT, "strength", &model, (hewn_smooth_desc){.strength = NAN});
    expect(HEWN_INVALID_ARGUMENT, "passband", &model, (hewn_smooth_desc){.passband = -1});
    expect(HEWN_INVALID_ARGUMENT, "passband", &model, (hewn_smooth_desc){.strength = 0.9, .passband = 1.2});
    expect(HEWN_INVALID_ARGUMENT, "step", &model, (hewn_smooth_desc){.method = HEWN_SMOOTH_COTAN, .step = -1});
    expect(HEWN_INVALID_ARGUMENT, "angle", &model, (hewn_smooth_desc){.method = HEWN_SMOOTH_BILATERAL, .angle = 200});
    expect(HEWN_INVALID_ARGUMENT, "hc", &model, (hewn_smooth_desc){.method = HEWN_SMOOTH_HC, .push = 2});
    expect(HEWN_INVALID_ARGUMENT, "method", &model, (hewn_smooth_desc){.method = HEWN_SMOOTH_COUNT});
    double freedom[8] = {1, 1, 1, 2, 1, 1, 1, 1};
    expect(HEWN_BAD_INPUT, "vertex 3", &model, (hewn_smooth_desc){.freedom = freedom});
    hewn_progress progress = {stop, NULL};
    for (size_t m = 0; m < 6; m++)
        expect(HEWN_CANCELLED, "smooth", &model, (hewn_smooth_desc){.method = all_methods[m], .progress = &progress});
    model.corners[16] = 8;
    expect(HEWN_BAD_INPUT, "face 5 names vertex 8", &model, (hewn_smooth_desc){0});
    model.corners[16] = 0;
    model.positions[3 * 6 + 1] = NAN;
    expect(HEWN_BAD_INPUT, "vertex 6", &model, (hewn_smooth_desc){0});
    hewn_model_destroy(&model);
}

/* --- models ------------------------------------------------------------------------------------------------------- */

static void test_attributes_stay_and_normals_follow(void **state)
{
    (void)state;
    random_state random = {10};
    hewn_model model = make_ring_model(24, 12, 5);
    add_every_channel(&model, &random);
    uint32_t channels = model.channel_count;
    unsigned char *before[12];
    for (uint32_t i = 0; i < channels; i++) {
        before[i] = malloc(channel_bytes(&model, &model.channels[i]));
        assert_non_null(before[i]);
        memcpy(before[i], model.channels[i].values, channel_bytes(&model, &model.channels[i]));
    }
    float *normals = add_channel(&model, "normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3)->values;
    double *corners = add_channel(&model, "normal", HEWN_DOMAIN_CORNER, HEWN_SCALAR_DOUBLE, 3)->values;
    for (uint64_t c = 0; c < hewn_model_corner_count(&model); c++)
        corners[3 * c] = 1; /* all of a vertex have one */
    assert_int_equal(hewn_model_smooth(&model, NULL, NULL, error), HEWN_OK);
    for (uint32_t i = 0; i < channels; i++) {
        assert_memory_equal(before[i], model.channels[i].values, channel_bytes(&model, &model.channels[i]));
        free(before[i]);
    }
    for (uint64_t c = 0; c < hewn_model_corner_count(&model); c++) {
        uint32_t v = model.corners[c];
        const double *x = model.positions + 3 * (size_t)v;
        double ring = sqrt(x[0] * x[0] + x[1] * x[1]);
        double out[3] = {x[0] - x[0] / ring, x[1] - x[1] / ring, x[2]}, length = 0, along = 0;
        for (uint64_t k = 0; k < 3; k++) {
            assert_true(fabs(corners[3 * c + k] - (double)normals[3 * (size_t)v + k]) < 1e-6);
            length += out[k] * out[k];
            along += out[k] * corners[3 * c + k];
        }
        assert_true(along > 0.98 * sqrt(length));
    }
    hewn_model_destroy(&model);
}

static void test_meshes_as_models(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(12, 8, 3);
    hewn_mesh *mesh;
    assert_int_equal(hewn_mesh_from_model(&model, NULL, &mesh, NULL, error), HEWN_OK);
    assert_int_equal(hewn_model_smooth(&model, NULL, NULL, error), HEWN_OK);
    assert_int_equal(hewn_mesh_smooth(mesh, NULL, NULL, error), HEWN_OK);
    for (uint32_t v = 0; v < model.vertex_count; v++)
        assert_memory_equal(model.positions + 3 * (size_t)v, hewn_vert_position(mesh, (hewn_vert){v}), 24);
    hewn_mesh_destroy(&mesh);
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_eigenvectors_are_scaled),
        cmocka_unit_test(test_curvature_of_a_sphere),
        cmocka_unit_test(test_areas_sum_to_the_area),
        cmocka_unit_test(test_flow_of_a_sphere),
        cmocka_unit_test(test_small_steps_follow_the_curvature),
        cmocka_unit_test(test_weights_are_kept_or_not),
        cmocka_unit_test(test_any_step_is_stable),
        cmocka_unit_test(test_implicit_solves_its_equation),
        cmocka_unit_test(test_same_bytes_for_any_threads),
        cmocka_unit_test(test_soups_stay_finite),
        cmocka_unit_test(test_flat_and_isolated),
        cmocka_unit_test(test_locks),
        cmocka_unit_test(test_features_are_locked),
        cmocka_unit_test(test_volume_is_kept),
        cmocka_unit_test(test_place_and_size_do_not_matter),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_attributes_stay_and_normals_follow),
        cmocka_unit_test(test_meshes_as_models),
    };
    return cmocka_run_group_tests_name("smooth", tests, NULL, NULL);
}
