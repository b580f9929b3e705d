/* Subdivision: regression shapes of OpenSubdiv, limits, attributes, adaptive levels, refusals. */
#include <omp.h>

#include "hewn/check.h"
#include "test_subdivide_support.h"

static hewn_error *const error = &(hewn_error){0};

/* --- regression shapes -------------------------------------------------------------------------------------------- */

static bool read_level(const char *shape, int level, hewn_model *out)
{
    char folder[4096], path[4096 + 256];
    if (!data_folder(folder))
        return false;
    snprintf(path, sizeof path, "%s/subdiv-baseline/%s_level%d.obj", folder, shape, level);
    if (hewn_model_read(path, NULL, out, error) != HEWN_OK)
        fail_msg("%s", error->message);
    return true;
}

/* The points of both agree, whatever their order: each has one within 1e-5, and no two the same. */
static void assert_same_points(const char *shape, const double *a, const hewn_model *b)
{
    uint8_t *taken = calloc(b->vertex_count, 1);
    assert_non_null(taken);
    for (uint64_t v = 0; v < b->vertex_count; v++) {
        uint64_t found = b->vertex_count;
        for (uint64_t w = 0; w < b->vertex_count && found == b->vertex_count; w++) {
            double apart = 0;
            for (uint64_t i = 0; i < 3; i++)
                apart = fmax(apart, fabs(a[3 * v + i] - b->positions[3 * w + i]));
            if (apart <= 1e-5 && !taken[w])
                found = w;
        }
        if (found == b->vertex_count)
            fail_msg("%s: vertex %llu is not there", shape, (unsigned long long)v);
        taken[found] = 1;
    }
    free(taken);
}

static void test_regression_shapes(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        hewn_scheme scheme;
    } shapes[] = {{"catmark_cube", HEWN_SCHEME_CATMULL_CLARK},
                  {"loop_cube", HEWN_SCHEME_LOOP},
                  {"loop_icosahedron", HEWN_SCHEME_LOOP},
                  {"bilinear_cube", HEWN_SCHEME_BILINEAR},
                  {"catmark_pyramid", HEWN_SCHEME_CATMULL_CLARK}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (int level = 0; level < 3; level++) {
            hewn_model from, to;
            if (!read_level(shapes[i].name, level, &from))
                skip();
            assert_true(read_level(shapes[i].name, level + 1, &to));
            hewn_subdivide_desc desc = {.scheme = shapes[i].scheme};
            hewn_subdivision *sub = subdivide(&from, &desc);
            assert_int_equal(hewn_subdivision_vert_count(sub), to.vertex_count);
            assert_int_equal(hewn_subdivision_face_count(sub), to.face_count);
            double *points = evaluate(sub, from.positions);
            assert_same_points(shapes[i].name, points, &to);
            hewn_free(points);
            hewn_subdivision_destroy(&sub);
            hewn_model_destroy(&from);
            hewn_model_destroy(&to);
        }
}

/* --- limits ------------------------------------------------------------------------------------------------------- */

/* Where exactly one sharp edge ends, the limit of the smooth rule is taken, as OpenSubdiv does; it is not exact there.
 */
static bool is_dart(const hewn_subdivide_desc *desc, uint32_t v)
{
    uint32_t count = 0;
    for (uint64_t i = 0; i < desc->crease_count; i++)
        count += desc->creases[i].verts[0] == v || desc->creases[i].verts[1] == v;
    return count == 1;
}

/* The limit of a control vertex does not depend on the level that it is computed from. */
static void test_limits_from_any_level(void **state)
{
    (void)state;
    random_state random = {1};
    for (int i = 0; i < 60; i++) {
        static tags all;
        bool loop = i % 2;
        hewn_model model = make_sheet(3 + random_below(&random, 4), false, loop, &random);
        drop_isolated(&model);
        hewn_subdivide_desc desc = {.scheme = loop ? HEWN_SCHEME_LOOP : HEWN_SCHEME_CATMULL_CLARK, .limit = true};
        desc.boundary = (hewn_subdivide_boundary)random_below(&random, 2);
        make_tags(&model, 8, &all, &random);
        for (uint64_t k = 0; k < all.crease_count; k++)
            all.creases[k].sharpness = 10;
        desc.creases = all.creases;
        desc.crease_count = i % 3 ? all.crease_count : 0;
        desc.levels = HEWN_LEVELS_NONE;
        hewn_subdivision *none = subdivide(&model, &desc);
        desc.levels = 3;
        hewn_subdivision *three = subdivide(&model, &desc);
        double *a = evaluate(none, model.positions), *b = evaluate(three, model.positions);
        for (uint64_t k = 0; k < 3 * model.vertex_count; k++)
            if (!is_dart(&desc, (uint32_t)(k / 3)) && !(fabs(a[k] - b[k]) < 1e-6))
                fail_msg("run %d: %.9g from level 0, %.9g from level 3", i, a[k], b[k]);
        hewn_free(a);
        hewn_free(b);
        hewn_subdivision_destroy(&none);
        hewn_subdivision_destroy(&three);
        hewn_model_destroy(&model);
    }
}

/* Normals at the limit are those of ever smaller faces. */
static void test_normals_against_a_deep_level(void **state)
{
    (void)state;
    random_state random = {2};
    for (int i = 0; i < 8; i++) {
        bool loop = i % 2;
        hewn_model model = make_sheet(3, false, loop, &random);
        drop_isolated(&model);
        hewn_subdivide_desc desc = {.scheme = loop ? HEWN_SCHEME_LOOP : HEWN_SCHEME_CATMULL_CLARK, .limit = true};
        desc.boundary = HEWN_BOUNDARY_EDGE_ONLY;
        desc.levels = HEWN_LEVELS_NONE;
        hewn_subdivision *none = subdivide(&model, &desc);
        desc.levels = 7;
        hewn_subdivision *deep = subdivide(&model, &desc);
        double *normals = hewn_alloc(model.vertex_count, 3 * sizeof *normals),
               *points = evaluate(deep, model.positions);
        double *sums = calloc(model.vertex_count, 3 * sizeof *sums);
        assert_true(normals && sums);
        assert_int_equal(hewn_subdivision_limit(none, model.positions, NULL, NULL, NULL, normals, NULL), HEWN_OK);
        hewn_polygons fine = hewn_subdivision_polygons(deep);
        for (uint64_t f = 0; f < fine.face_count; f++) {
            uint32_t sides = loop ? 3 : 4;
            for (uint32_t k = 0; k < sides; k++) {
                uint32_t v = fine.corners[sides * f + k];
                if (v >= model.vertex_count)
                    continue;
                const double *p = points + 3 * (size_t)v;
                const double *a = points + 3 * (size_t)fine.corners[sides * f + (k + 1) % sides];
                const double *b = points + 3 * (size_t)fine.corners[sides * f + (k + sides - 1) % sides];
                for (size_t x = 0; x < 3; x++) {
                    size_t y = (x + 1) % 3, z = (x + 2) % 3;
                    sums[3 * (size_t)v + x] += (a[y] - p[y]) * (b[z] - p[z]) - (a[z] - p[z]) * (b[y] - p[y]);
                }
            }
        }
        for (size_t v = 0; v < model.vertex_count; v++) {
            const double *s = sums + 3 * v, *n = normals + 3 * v;
            double length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
            double cosine = (s[0] * n[0] + s[1] * n[1] + s[2] * n[2]) / length;
            /* Faces converge slowly around interior vertices of high valence, whose tangents OpenSubdiv shares. */
            bool rim = v % 4 == 0 || v % 4 == 3 || v < 4 || v >= 12;
            if (!(cosine > (rim ? 0.999 : 0.95)))
                fail_msg("run %d, vertex %zu: cosine %g", i, v, cosine);
        }
        free(sums);
        hewn_free(normals);
        hewn_free(points);
        hewn_subdivision_destroy(&none);
        hewn_subdivision_destroy(&deep);
        hewn_model_destroy(&model);
    }
}

/* --- models ------------------------------------------------------------------------------------------------------- */

/* What is linear in position stays so through schemes that reproduce it, and every domain is carried. */
static void test_attributes(void **state)
{
    (void)state;
    random_state random = {3};
    for (int i = 0; i < 12; i++) {
        hewn_model model = make_ring_model(6, 5, 3);
        add_tell_tales(&model);
        hewn_subdivide_desc desc = {.levels = 1 + random_below(&random, 3), .limit = i % 2};
        desc.scheme = i % 3 ? HEWN_SCHEME_CATMULL_CLARK : HEWN_SCHEME_BILINEAR;
        desc.uv = HEWN_UV_NONE;
        uint64_t faces = model.face_count;
        hewn_subdivide_report report;
        assert_int_equal(hewn_model_subdivide(&model, &desc, i % 4 == 3 ? 0.02 : 0, &report, error), HEWN_OK);
        assert_int_equal(hewn_model_check(&model, error), HEWN_OK);
        const double *verts = hewn_model_find_channel(&model, HEWN_DOMAIN_VERT, "where")->values;
        const double *corners = hewn_model_find_channel(&model, HEWN_DOMAIN_CORNER, "where")->values;
        const int32_t *which = hewn_model_find_channel(&model, HEWN_DOMAIN_FACE, "which")->values;
        for (uint64_t k = 0; k < 3 * model.vertex_count; k++)
            assert_true(fabs(verts[k] - model.positions[k]) < 1e-12);
        for (uint64_t c = 0; c < hewn_model_corner_count(&model); c++)
            for (uint64_t k = 0; k < 3; k++)
                assert_true(fabs(corners[3 * c + k] - model.positions[3 * (size_t)model.corners[c] + k]) < 1e-12);
        for (uint64_t f = 1; f < model.face_count; f++)
            assert_true(which[f] == which[f - 1] || which[f] == which[f - 1] + 1);
        assert_true(which[0] == 0 && which[model.face_count - 1] == (int32_t)faces - 1);
        hewn_model_destroy(&model);
    }
}

/* Adaptive meshes are closed and manifold, whatever the shape and bound. */
static void test_adaptive_levels_do_not_crack(void **state)
{
    (void)state;
    for (double bound = 0.3; bound > 1e-3; bound /= 2)
        for (int loop = 0; loop < 2; loop++) {
            hewn_model model = make_ring_model(7, 5, loop ? 1 : 0);
            hewn_subdivide_desc desc = {.levels = 5, .limit = true};
            desc.scheme = loop ? HEWN_SCHEME_LOOP : HEWN_SCHEME_CATMULL_CLARK;
            assert_int_equal(hewn_model_subdivide(&model, &desc, bound, NULL, error), HEWN_OK);
            hewn_polygons polygons = hewn_model_polygons(&model);
            hewn_check *check;
            hewn_check_desc quick = {.skip_self_intersections = true};
            assert_int_equal(hewn_check_polygons(&polygons, &quick, &check, error), HEWN_OK);
            assert_true(check->certificate.closed && check->certificate.manifold && check->certificate.oriented);
            assert_int_equal(check->certificate.genus, 1);
            assert_int_equal(check->isolated_vertices, 0);
            hewn_check_destroy(&check);
            hewn_model_destroy(&model);
        }
}

static void test_boundary_none_leaves_faces_out(void **state)
{
    (void)state;
    random_state random = {4};
    hewn_model model = make_sheet(6, false, false, &random);
    drop_isolated(&model);
    uint64_t faces = model.face_count;
    hewn_subdivide_report report;
    hewn_subdivide_desc desc = {.boundary = HEWN_BOUNDARY_NONE, .levels = 2};
    assert_int_equal(hewn_model_subdivide(&model, &desc, 0, &report, error), HEWN_OK);
    assert_true(report.dropped_faces >= 20);
    assert_int_equal(model.face_count, 16 * (faces - report.dropped_faces));
    hewn_model_destroy(&model);
}

static void test_same_bytes_for_any_threads(void **state)
{
    (void)state;
    int threads = omp_get_max_threads();
    hewn_model model = make_ring_model(40, 30, 4);
    hewn_subdivide_desc desc = {.levels = 3, .limit = true};
    double *first = NULL;
    for (int count = 1; count < 6; count += 2) {
        omp_set_num_threads(count);
        hewn_subdivision *sub = subdivide(&model, &desc);
        double *points = evaluate(sub, model.positions);
        if (first)
            assert_memory_equal(first, points, hewn_subdivision_vert_count(sub) * 3ull * sizeof *points);
        hewn_free(first);
        first = points;
        hewn_subdivision_destroy(&sub);
    }
    hewn_free(first);
    omp_set_num_threads(threads);
    hewn_model_destroy(&model);
}

static void expect(hewn_result code, const char *says, const hewn_model *model, hewn_subdivide_desc desc)
{
    hewn_polygons polygons = hewn_model_polygons(model);
    hewn_subdivision *sub;
    hewn_error reason = {0};
    assert_int_equal(hewn_subdivision_create(&polygons, &desc, &sub, &reason), code);
    assert_null(sub);
    if (!strstr(reason.message, says))
        fail_msg("'%s' is missing in '%s'", says, reason.message);
}

static bool stop(void *user, const char *stage, double fraction)
{
    (void)user;
    (void)fraction;
    return strcmp(stage, "subdivide") != 0;
}

static void test_refusals(void **state)
{
    (void)state;
    hewn_model model = cube_of_quads();
    hewn_crease crease = {{0, 7}, 1};
    hewn_corner_tag corner = {8, 1};
    hewn_progress progress = {stop, NULL};
    expect(HEWN_BAD_INPUT, "face 0 has 4 corners", &model, (hewn_subdivide_desc){.scheme = HEWN_SCHEME_LOOP});
    expect(HEWN_INVALID_ARGUMENT, "levels", &model, (hewn_subdivide_desc){.levels = 17});
    expect(HEWN_LIMIT, "more than there are numbers", &model,
           (hewn_subdivide_desc){.levels = 16, .max_memory = UINT64_MAX});
    expect(HEWN_OUT_OF_MEMORY, "more than the 1 MiB that may be used", &model,
           (hewn_subdivide_desc){.levels = 9, .max_memory = 1 << 20});
    expect(HEWN_INVALID_ARGUMENT, "angle", &model, (hewn_subdivide_desc){.crease_angle = NAN});
    expect(HEWN_BAD_INPUT, "no edge from vertex 0 to 7", &model,
           (hewn_subdivide_desc){.creases = &crease, .crease_count = 1});
    expect(HEWN_BAD_INPUT, "vertex 8", &model, (hewn_subdivide_desc){.corners = &corner, .corner_count = 1});
    expect(HEWN_CANCELLED, "subdivide", &model, (hewn_subdivide_desc){.progress = &progress});
    model.corners[0] = 1;
    expect(HEWN_BAD_INPUT, "face", &model, (hewn_subdivide_desc){0});
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_regression_shapes),
        cmocka_unit_test(test_limits_from_any_level),
        cmocka_unit_test(test_normals_against_a_deep_level),
        cmocka_unit_test(test_attributes),
        cmocka_unit_test(test_adaptive_levels_do_not_crack),
        cmocka_unit_test(test_boundary_none_leaves_faces_out),
        cmocka_unit_test(test_same_bytes_for_any_threads),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests_name("subdivide", tests, NULL, NULL);
}
