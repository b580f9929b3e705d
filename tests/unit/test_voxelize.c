/* Meshes and fields into samplings: winding numbers against the sum of all solid angles, distances against the shapes
 * themselves, signs on meshes that have holes, overlap or are inside out, and the same bytes for any number of threads.
 */
#include "test_field_support.h"

#include <omp.h>

#include "field/sampling.h"
#include "geom/nearest.h"
#include "geom/winding.h"
#include "hewn/voxelize.h"

/* --- meshes ---------------------------------------------------------------------------------------------------------
 */

enum { RINGS = 48, SECTORS = 64, MOST = 4 };

typedef struct test_mesh {
    double positions[MOST * (RINGS + 1) * SECTORS * 3];
    uint32_t corners[MOST * RINGS * SECTORS * 6];
    hewn_polygons polygons;
} test_mesh;

/* A torus about z through (x, 0, 0). */
static void add_torus(test_mesh *mesh, double x, double major, double minor, bool turned)
{
    uint32_t base = (uint32_t)mesh->polygons.vertex_count;
    const double turn = 2 * acos(-1);
    for (uint32_t i = 0; i < SECTORS; i++)
        for (uint32_t j = 0; j < RINGS; j++) {
            double *p = mesh->positions + 3 * mesh->polygons.vertex_count++;
            double u = turn * i / SECTORS, v = turn * j / RINGS, r = major + minor * cos(v);
            p[0] = x + r * cos(u);
            p[1] = r * sin(u);
            p[2] = minor * sin(v);
        }
    for (uint32_t i = 0; i < SECTORS; i++)
        for (uint32_t j = 0; j < RINGS; j++) {
            uint32_t a = base + i * RINGS + j, b = base + (i + 1) % SECTORS * RINGS + j;
            uint32_t c = base + (i + 1) % SECTORS * RINGS + (j + 1) % RINGS, d = base + i * RINGS + (j + 1) % RINGS;
            const uint32_t six[6] = {a, turned ? c : b, turned ? b : c, a, turned ? d : c, turned ? c : d};
            memcpy(mesh->corners + 3 * mesh->polygons.face_count, six, sizeof six);
            mesh->polygons.face_count += 2;
        }
    mesh->polygons.positions = mesh->positions;
    mesh->polygons.corners = mesh->corners;
}

static double torus(const double at[3], double x, double major, double minor)
{
    return hypot(hypot(at[0] - x, at[1]) - major, at[2]) - minor;
}

static hewn_sampling *sample(const test_mesh *mesh, double cell, bool dense, hewn_sampling_place *place,
                             hewn_mesh_sampling_report *report)
{
    hewn_sampling *made;
    hewn_error error = {0};
    const hewn_mesh_sampling_desc desc = {.cell = cell, .dense = dense};
    if (hewn_sampling_from_mesh(&mesh->polygons, &desc, &made, place, report, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return made;
}

static double distance_at(const hewn_sampling *s, const hewn_sampling_place *place, const double at[3])
{
    double cells[3];
    for (int i = 0; i < 3; i++)
        cells[i] = (at[i] - place->origin[i]) / place->cell - 0.5 * s->cells[i];
    return place->cell * hewn_sampling_value(s, cells, NULL);
}

/* --- winding numbers ------------------------------------------------------------------------------------------------
 */

static void winding_numbers_are_sums_of_solid_angles(void **state)
{
    (void)state;
    static test_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    add_torus(&mesh, 0, 1, 0.4, false);
    add_torus(&mesh, 0.5, 0.8, 0.3, false);
    mesh.polygons.face_count -= 700; /* a hole */
    const hewn_triangle_view view = {.vertex_count = mesh.polygons.vertex_count,
                                     .triangle_count = mesh.polygons.face_count,
                                     .doubles = mesh.positions,
                                     .corners = mesh.corners};
    hewn_bvh bvh;
    hewn_winding winding;
    hewn_error error = {0};
    random_state random = {71};
    assert_int_equal(hewn_bvh_build(&view, &bvh, &error), HEWN_OK);
    assert_int_equal(hewn_winding_build(&bvh, &view, &winding, &error), HEWN_OK);
    double worst = 0, total = 0;
    for (int i = 0; i < 800; i++) {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = random_between(&random, -2, 2);
        double exact = hewn_winding_number_exactly(&view, at), fast = hewn_winding_number(&winding, at);
        worst = fmax(worst, fabs(fast - exact));
        total += fabs(fast - exact);
    }
    assert_true(worst < 0.02);
    assert_true(total / 800 < 0.002);
    hewn_winding_free(&winding);
    hewn_bvh_free(&bvh);
}

/* --- meshes sampled -------------------------------------------------------------------------------------------------
 */

/* Chords of the rings are this far from the torus. */
static const double facets = 0.01;

static void check_torus(const hewn_sampling *s, const hewn_sampling_place *place, uint64_t seed)
{
    random_state random = {seed};
    for (int i = 0; i < 20000; i++) {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = random_between(&random, -1.6, 1.6);
        double expected = torus(at, 0, 1, 0.4), value = distance_at(s, place, at);
        if (fabs(expected) > facets && (value < 0) != (expected < 0))
            fail_msg("(%g, %g, %g): %g instead of %g", at[0], at[1], at[2], value, expected);
        if (fabs(expected) < 2 * place->cell)
            assert_true(fabs(value - expected) < facets + 0.2 * place->cell);
    }
}

static void distances_are_those_to_the_mesh(void **state)
{
    (void)state;
    static test_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    add_torus(&mesh, 0, 1, 0.4, false);
    hewn_sampling_place place;
    hewn_mesh_sampling_report report;
    hewn_sampling *band = sample(&mesh, 0.04, false, &place, &report);
    assert_true(report.confidence > 0.9995 && report.doubtful < 1e-3);
    check_torus(band, &place, 72);
    uint64_t size = hewn_sampling_size(band);
    hewn_sampling_destroy(&band);
    hewn_sampling *dense = sample(&mesh, 0.04, true, &place, NULL);
    check_torus(dense, &place, 73);
    assert_true(hewn_sampling_size(dense) > size);
    for (uint32_t k = 0; k < 500; k++) { /* at samples: the distance to the mesh itself */
        random_state random = {k};
        double at[3], least = INFINITY;
        for (int i = 0; i < 3; i++)
            at[i] = place.origin[i] + place.cell * random_below(&random, dense->cells[i] + 1);
        for (uint64_t t = 0; t < mesh.polygons.face_count; t++) {
            const uint32_t *c = mesh.corners + 3 * t;
            least = fmin(least, hewn_triangle_reach(at, mesh.positions + 3 * c[0], mesh.positions + 3 * c[1],
                                                    mesh.positions + 3 * c[2]));
        }
        assert_true(fabs(fabs(distance_at(dense, &place, at)) - least) < 1e-5);
    }
    hewn_sampling_destroy(&dense);
}

/* A mesh turned inside out has the same inside; where two overlap both are inside; a hole closes with a membrane. */
static void bad_meshes_have_right_signs(void **state)
{
    (void)state;
    static test_mesh mesh;
    hewn_sampling_place place;
    hewn_mesh_sampling_report report;
    memset(&mesh, 0, sizeof mesh);
    add_torus(&mesh, 0, 1, 0.4, true);
    hewn_sampling *s = sample(&mesh, 0.05, false, &place, &report);
    check_torus(s, &place, 74);
    hewn_sampling_destroy(&s);

    memset(&mesh, 0, sizeof mesh);
    add_torus(&mesh, -0.3, 1, 0.4, false);
    add_torus(&mesh, 0.4, 1, 0.35, false);
    s = sample(&mesh, 0.05, false, &place, &report);
    random_state random = {75};
    for (int i = 0; i < 20000; i++) {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = random_between(&random, -2, 2);
        double expected = fmin(torus(at, -0.3, 1, 0.4), torus(at, 0.4, 1, 0.35));
        if (fabs(expected) > facets + 0.05)
            assert_true((distance_at(s, &place, at) < 0) == (expected < 0));
    }
    hewn_sampling_destroy(&s);

    memset(&mesh, 0, sizeof mesh);
    add_torus(&mesh, 0, 1, 0.4, false);
    uint64_t kept = 0; /* a window in the outer wall */
    for (uint64_t t = 0; t < mesh.polygons.face_count; t++) {
        const double *p = mesh.positions + 3 * (uint64_t)mesh.corners[3 * t];
        if (p[0] > 1.3 && fabs(p[1]) < 0.15 && fabs(p[2]) < 0.15)
            continue;
        memmove(mesh.corners + 3 * kept++, mesh.corners + 3 * t, 3 * sizeof *mesh.corners);
    }
    assert_true(kept < mesh.polygons.face_count);
    mesh.polygons.face_count = kept;
    s = sample(&mesh, 0.05, false, &place, &report);
    assert_true(report.confidence < 0.999 && report.confidence > 0.9);
    for (int i = 0; i < 20000; i++) {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = random_between(&random, -1.6, 1.6);
        double expected = torus(at, 0, 1, 0.4);
        bool window = at[0] > 1.1 && fabs(at[1]) < 0.4 && fabs(at[2]) < 0.4;
        if (!window && fabs(expected) > facets + 0.05)
            assert_true((distance_at(s, &place, at) < 0) == (expected < 0));
    }
    hewn_sampling_destroy(&s);
}

static void bad_requests_are_refused(void **state)
{
    (void)state;
    static test_mesh mesh;
    hewn_sampling *s;
    hewn_sampling_place place;
    hewn_error error = {0};
    memset(&mesh, 0, sizeof mesh);
    add_torus(&mesh, 0, 1, 0.4, false);
    const hewn_mesh_sampling_desc small = {.cell = 1e-3, .memory_limit = 1 << 20}, many = {.cell = 1e-7},
                                  negative = {.cell = -1};
    assert_int_equal(hewn_sampling_from_mesh(&mesh.polygons, &small, &s, &place, NULL, &error), HEWN_LIMIT);
    assert_null(s);
    double would_do;
    const char *told = strstr(error.message, "a cell of about ");
    assert_non_null(told);
    assert_int_equal(sscanf(told, "a cell of about %lf", &would_do), 1);
    const hewn_mesh_sampling_desc again = {.cell = would_do, .memory_limit = 1 << 20};
    hewn_result result = hewn_sampling_from_mesh(&mesh.polygons, &again, &s, &place, NULL, &error);
    for (int i = 0; i < 4 && result == HEWN_LIMIT; i++) { /* the band is not known before; soon what is told does */
        assert_int_equal(sscanf(strstr(error.message, "a cell of about "), "a cell of about %lf", &would_do), 1);
        const hewn_mesh_sampling_desc more = {.cell = would_do, .memory_limit = 1 << 20};
        result = hewn_sampling_from_mesh(&mesh.polygons, &more, &s, &place, NULL, &error);
    }
    assert_int_equal(result, HEWN_OK);
    hewn_sampling_destroy(&s);
    assert_int_equal(hewn_sampling_from_mesh(&mesh.polygons, &many, &s, &place, NULL, &error), HEWN_LIMIT);
    assert_int_equal(hewn_sampling_from_mesh(&mesh.polygons, &negative, &s, &place, NULL, &error),
                     HEWN_INVALID_ARGUMENT);
    mesh.polygons.face_count = 0;
    assert_int_equal(hewn_sampling_from_mesh(&mesh.polygons, NULL, &s, &place, NULL, &error), HEWN_BAD_INPUT);
    assert_null(s);
}

static bool stop_early(void *user, const char *stage, double fraction)
{
    (void)user;
    assert_string_equal(stage, "sample");
    return fraction < 0.5;
}

static void threads_change_nothing_and_work_stops(void **state)
{
    (void)state;
    static test_mesh mesh;
    hewn_sampling_place place;
    hewn_mesh_sampling_report one_report, other_report;
    hewn_error error = {0};
    memset(&mesh, 0, sizeof mesh);
    add_torus(&mesh, 0, 1, 0.4, false);
    mesh.polygons.face_count -= 100;
    int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    hewn_sampling *one = sample(&mesh, 0.08, false, &place, &one_report);
    omp_set_num_threads(3);
    hewn_sampling *other = sample(&mesh, 0.08, false, &place, &other_report);
    omp_set_num_threads(threads);
    assert_int_equal(one->word_count, other->word_count);
    assert_memory_equal(one->words, other->words, one->word_count * sizeof *one->words);
    assert_true(one_report.confidence == other_report.confidence);
    hewn_sampling_destroy(&one);
    hewn_sampling_destroy(&other);
    const hewn_progress progress = {.report = stop_early};
    const hewn_mesh_sampling_desc desc = {.cell = 0.08, .progress = &progress};
    assert_int_equal(hewn_sampling_from_mesh(&mesh.polygons, &desc, &one, &place, NULL, &error), HEWN_CANCELLED);
    assert_null(one);
}

/* --- fields sampled -------------------------------------------------------------------------------------------------
 */

static void fields_become_samples(void **state)
{
    (void)state;
    hewn_field *f;
    hewn_error error = {0};
    hewn_sampling *s;
    hewn_sampling_place place;
    assert_int_equal(hewn_field_create(&f, &error), HEWN_OK);
    hewn_node shape = hewn_difference(f, hewn_sphere(f, 1), hewn_translate(f, hewn_box_shape(f, 1, 1, 3), 0.6, 0, 0));
    shape = hewn_smooth_union(f, shape, hewn_translate(f, hewn_torus(f, 0.5, 0.2), -1, 0, 0), HEWN_BLEND_CUBIC, 0.2);
    assert_int_equal(hewn_field_set_root(f, shape, &error), HEWN_OK);
    for (int dense = 0; dense < 2; dense++) {
        hewn_field_sampling_desc desc = {.cell = 0.02, .dense = dense != 0};
        assert_int_equal(hewn_field_find_box(f, shape, &desc.bounds, &error), HEWN_OK);
        if (hewn_sampling_from_field(f, &desc, &s, &place, &error) != HEWN_OK)
            fail_msg("%s", error.message);
        assert_true(s->enclosed);
        uint64_t bricks = (uint64_t)s->bricks[0] * s->bricks[1] * s->bricks[2];
        assert_true(dense ? s->fine_count == bricks : 4 * s->fine_count < 3 * bricks);
        random_state random = {81};
        for (int i = 0; i < 5000; i++) { /* at samples, exactly but for their rounding */
            double at[3], expected;
            for (int k = 0; k < 3; k++)
                at[k] = place.origin[k] + place.cell * random_below(&random, s->cells[k] + 1);
            assert_int_equal(hewn_field_eval(f, shape, at, 1, &expected, &error), HEWN_OK);
            double value = distance_at(s, &place, at);
            if (fabs(expected) < 2.5 * place.cell || dense)
                assert_true(fabs(value - expected) < 1e-5);
            assert_true((value < 0) == (expected < 0) || fabs(expected) < 1e-5);
        }
        hewn_sampling_destroy(&s);
    }
    hewn_node bad = hewn_sqrt(f, shape);
    assert_int_equal(hewn_field_set_root(f, bad, &error), HEWN_OK);
    const hewn_field_sampling_desc desc = {.bounds = {{-1, -1, -1}, {1, 1, 1}}, .cell = 0.1};
    assert_int_equal(hewn_sampling_from_field(f, &desc, &s, &place, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "no finite value at"));
    assert_null(s);
    hewn_field_destroy(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(winding_numbers_are_sums_of_solid_angles),
        cmocka_unit_test(distances_are_those_to_the_mesh),
        cmocka_unit_test(bad_meshes_have_right_signs),
        cmocka_unit_test(bad_requests_are_refused),
        cmocka_unit_test(threads_change_nothing_and_work_stops),
        cmocka_unit_test(fields_become_samples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
