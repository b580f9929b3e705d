/* Simplification of models: seams, steps of colour, labels, normals, and attributes of every kind. */
#include "hewn/check.h"
#include "hewn/simplify.h"
#include "test_smooth_support.h"

static hewn_simplify_report simplify(hewn_model *model, const hewn_simplify_desc *desc)
{
    hewn_error error = {0};
    hewn_simplify_report report;
    if (hewn_model_simplify(model, desc, &report, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    assert_int_equal(hewn_model_check(model, &error), HEWN_OK);
    assert_null(model->first);
    assert_int_equal(report.triangles, model->face_count);
    return report;
}

/* A square of n × n cells from 0,0 to 1,1, a little bent. */
static hewn_model make_sheet(uint32_t n, double height)
{
    hewn_model model = make_model((n + 1ull) * (n + 1), 2ull * n * n, 6ull * n * n, false);
    for (uint32_t j = 0; j <= n; j++)
        for (uint32_t i = 0; i <= n; i++) {
            double *at = model.positions + 3 * (size_t)(j * (n + 1) + i);
            at[0] = (double)i / n;
            at[1] = (double)j / n;
            at[2] = height * sin(3 * at[0]) * cos(2 * at[1]);
        }
    for (uint32_t j = 0, c = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++, c += 6) {
            uint32_t a = j * (n + 1) + i, b = a + 1, d = a + n + 1, e = d + 1, corners[] = {a, b, e, a, e, d};
            memcpy(model.corners + c, corners, sizeof corners);
        }
    return model;
}

/* --- seams -------------------------------------------------------------------------------------------------------- */

/* Two charts that meet at x = 1/2, each an affine map of the plane, so every corner can be checked by its position. */
static void chart(const double at[3], bool right, double out[2])
{
    out[0] = right ? 0.6 + 0.3 * at[1] : 0.4 * at[0];
    out[1] = right ? 0.9 - 0.5 * at[0] : 0.5 * at[1];
}

static void test_uv_seams_survive(void **state)
{
    (void)state;
    const uint32_t n = 40;
    for (int scalar = HEWN_SCALAR_FLOAT; scalar <= HEWN_SCALAR_DOUBLE; scalar++) {
        hewn_model model = make_sheet(n, 0.05);
        hewn_channel *uv = add_channel(&model, "uv", HEWN_DOMAIN_CORNER, (hewn_scalar)scalar, 2);
        for (uint64_t c = 0; c < 3 * model.face_count; c++) {
            double value[2];
            chart(model.positions + 3 * (size_t)model.corners[c], c / 6 % n >= n / 2, value);
            for (uint64_t k = 0; k < 2; k++)
                if (scalar == HEWN_SCALAR_FLOAT)
                    ((float *)uv->values)[2 * c + k] = (float)value[k];
                else
                    ((double *)uv->values)[2 * c + k] = value[k];
        }
        simplify(&model, &(hewn_simplify_desc){.faces = 120});
        assert_true(model.face_count <= 120 && model.face_count > 100);
        uv = hewn_model_find_channel(&model, HEWN_DOMAIN_CORNER, "uv");
        assert_non_null(uv);
        uint64_t right_faces = 0;
        for (uint64_t f = 0; f < model.face_count; f++) {
            double middle = 0;
            for (uint64_t k = 0; k < 3; k++)
                middle += model.positions[3 * (size_t)model.corners[3 * f + k]] / 3;
            const bool right = middle > 0.5;
            right_faces += right;
            for (uint64_t c = 3 * f; c < 3 * f + 3; c++) {
                double value[2];
                chart(model.positions + 3 * (size_t)model.corners[c], right, value);
                for (uint64_t k = 0; k < 2; k++) {
                    const double got = scalar == HEWN_SCALAR_FLOAT ? (double)((const float *)uv->values)[2 * c + k]
                                                                   : ((const double *)uv->values)[2 * c + k];
                    assert_true(fabs(got - value[k]) < 0.01);
                }
            }
        }
        assert_true(right_faces > 20 && right_faces < 100);
        hewn_model_destroy(&model);
    }
}

/* Without their seams texture coordinates mean nothing, so they are not kept at all. */
static void test_what_is_not_preserved_is_dropped(void **state)
{
    (void)state;
    hewn_model model = make_sheet(10, 0.1);
    add_channel(&model, "uv", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 2);
    simplify(&model, &(hewn_simplify_desc){.ratio = 0.5, .preserve = HEWN_PRESERVE_COLOR});
    assert_int_equal(model.channel_count, 0);
    hewn_model_destroy(&model);
}

/* --- colours ------------------------------------------------------------------------------------------------------ */

static bool is_red(const double *at)
{
    return at[0] + 0.3 * at[1] < 0.6;
}

/* The share of the square where the colour is not what it was, by its corners' blends at many points. */
static double wrong_share(const hewn_model *model)
{
    const hewn_channel *color = hewn_model_find_channel(model, HEWN_DOMAIN_VERT, "color");
    const uint8_t *values = color->values;
    double wrong = 0, whole = 0;
    for (uint64_t f = 0; f < model->face_count; f++) {
        const uint32_t *corner = model->corners + 3 * f;
        const double *p[3];
        for (int k = 0; k < 3; k++)
            p[k] = model->positions + 3 * (size_t)corner[k];
        double area = fabs((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]));
        for (int i = 0; i < 10; i++)
            for (int j = 0; j + i < 10; j++) {
                double s = (i + 1 / 3.0) / 10, t = (j + 1 / 3.0) / 10, red = 0, at[3];
                for (int axis = 0; axis < 3; axis++)
                    at[axis] = (1 - s - t) * p[0][axis] + s * p[1][axis] + t * p[2][axis];
                red = (1 - s - t) * values[3 * (size_t)corner[0]] + s * values[3 * (size_t)corner[1]] +
                      t * values[3 * (size_t)corner[2]];
                wrong += area * fabs(red / 255 - is_red(at));
                whole += area;
            }
    }
    return wrong / whole;
}

static void test_steps_of_colour_survive(void **state)
{
    (void)state;
    double wrong[2];
    for (int preserve = 0; preserve < 2; preserve++) {
        hewn_model model = make_sheet(60, 0.05);
        uint8_t *color = add_channel(&model, "color", HEWN_DOMAIN_VERT, HEWN_SCALAR_UINT8, 3)->values;
        for (uint64_t v = 0; v < model.vertex_count; v++)
            color[3 * v] = is_red(model.positions + 3 * v) ? 255 : 0;
        const double before = wrong_share(&model);
        simplify(&model,
                 &(hewn_simplify_desc){.faces = 400, .preserve = preserve ? HEWN_PRESERVE_COLOR : HEWN_PRESERVE_NONE});
        wrong[preserve] = wrong_share(&model);
        print_message("# wrong colour: %.4f before, %.4f after\n", before, wrong[preserve]);
        hewn_model_destroy(&model);
    }
    assert_true(wrong[1] < 0.012);
    assert_true(wrong[1] < 0.5 * wrong[0]);
}

/* What is linear over a plane is found again wherever vertices end up. */
static void test_linear_values_stay_exact(void **state)
{
    (void)state;
    hewn_model model = make_sheet(30, 0);
    double *color = add_channel(&model, "color", HEWN_DOMAIN_VERT, HEWN_SCALAR_DOUBLE, 3)->values;
    for (uint64_t v = 0; v < model.vertex_count; v++)
        for (uint64_t k = 0; k < 3; k++)
            color[3 * v + k] = 0.1 + 0.5 * model.positions[3 * v] - (double)k * 0.2 * model.positions[3 * v + 1];
    simplify(&model, &(hewn_simplify_desc){.faces = 40});
    color = hewn_model_find_channel(&model, HEWN_DOMAIN_VERT, "color")->values;
    for (uint64_t v = 0; v < model.vertex_count; v++)
        for (uint64_t k = 0; k < 3; k++)
            assert_true(fabs(color[3 * v + k] - (0.1 + 0.5 * model.positions[3 * v] -
                                                 (double)k * 0.2 * model.positions[3 * v + 1])) < 1e-6);
    hewn_model_destroy(&model);
}

/* --- labels ------------------------------------------------------------------------------------------------------- */

static void test_materials_keep_their_borders(void **state)
{
    (void)state;
    const uint32_t n = 40;
    hewn_model model = make_sheet(n, 0.05);
    hewn_channel *material = add_channel(&model, "material", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1);
    int32_t value;
    assert_int_equal(hewn_channel_value(material, "wood", &value, NULL), HEWN_OK);
    assert_int_equal(hewn_channel_value(material, "steel", &value, NULL), HEWN_OK);
    for (uint64_t f = 0; f < model.face_count; f++)
        ((int32_t *)material->values)[f] = f / 2 % n >= n / 4 && f / 2 / n < n / 2; /* a corner in the middle */
    simplify(&model, &(hewn_simplify_desc){.faces = 100});
    material = hewn_model_find_channel(&model, HEWN_DOMAIN_FACE, "material");
    assert_int_equal(material->name_count, 2);
    assert_string_equal(material->names[1], "steel");
    double area = 0;
    for (uint64_t f = 0; f < model.face_count; f++) {
        const double *a = model.positions + 3 * (size_t)model.corners[3 * f],
                     *b = model.positions + 3 * (size_t)model.corners[3 * f + 1],
                     *c = model.positions + 3 * (size_t)model.corners[3 * f + 2];
        area += ((const int32_t *)material->values)[f] *
                ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    assert_true(fabs(area - 0.375) < 1e-3);
    hewn_model_destroy(&model);
}

/* --- normals ------------------------------------------------------------------------------------------------------ */

static void test_normals_are_made_anew(void **state)
{
    (void)state;
    for (int domain = HEWN_DOMAIN_VERT; domain <= HEWN_DOMAIN_CORNER; domain++) {
        hewn_model model = make_sphere(30, 2);
        add_channel(&model, "normal", (hewn_domain)domain, HEWN_SCALAR_FLOAT, 3); /* all zero */
        simplify(&model, &(hewn_simplify_desc){.ratio = 0.2});
        const float *n = hewn_model_find_channel(&model, (hewn_domain)domain, "normal")->values;
        const uint64_t count = domain == HEWN_DOMAIN_VERT ? model.vertex_count : 3 * model.face_count;
        for (uint64_t i = 0; i < count; i++) {
            const double *at = model.positions + 3 * (size_t)(domain == HEWN_DOMAIN_VERT ? i : model.corners[i]);
            double dot = 0, square = 0;
            for (uint64_t k = 0; k < 3; k++) {
                dot += at[k] / 2 * (double)n[3 * i + k];
                square += (double)n[3 * i + k] * (double)n[3 * i + k];
            }
            assert_true(fabs(square - 1) < 1e-5);
            assert_true(dot > 0.97);
        }
        hewn_model_destroy(&model);
    }
}

/* The corners of a cube's finely cut faces keep the normals of their faces. */
static void test_sharp_edges_stay_sharp(void **state)
{
    (void)state;
    hewn_model model = model_of(make_cube());
    add_channel(&model, "normal", HEWN_DOMAIN_CORNER, HEWN_SCALAR_DOUBLE, 3);
    simplify(&model, &(hewn_simplify_desc){.faces = 12});
    assert_int_equal(model.face_count, 12);
    const double *n = hewn_model_find_channel(&model, HEWN_DOMAIN_CORNER, "normal")->values;
    for (uint64_t c = 0; c < 36; c++)
        for (uint64_t k = 0; k < 3; k++)
            assert_true(fabs(fabs(n[3 * c + k]) - 1) < 1e-12 || fabs(n[3 * c + k]) < 1e-12);
    hewn_model_destroy(&model);
}

/* --- everything --------------------------------------------------------------------------------------------------- */

/* Polygons, with attributes of every kind, of meshes and of soups: whole numbers are never blended, and values are
 * never outside of what was there. */
static void test_every_channel(void **state)
{
    (void)state;
    random_state random = {12};
    for (int i = 0; i < 400; i++) {
        hewn_model model = i % 3 ? make_soup(&random) : make_ring_model(12, 9, 3);
        if (model.face_count == 0) {
            hewn_model_destroy(&model);
            continue;
        }
        int32_t *mark = add_channel(&model, "mark", HEWN_DOMAIN_VERT, HEWN_SCALAR_INT32, 1)->values;
        for (uint64_t v = 0; v < model.vertex_count; v++)
            mark[v] = (int32_t)(1000 * v);
        float *share = add_channel(&model, "color", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 1)->values;
        const uint64_t corners = hewn_model_corner_count(&model);
        for (uint64_t c = 0; c < corners; c++)
            share[c] = 3 + (float)random_below(&random, 3);
        if (i % 2)
            add_every_channel(&model, &random);
        const uint32_t channels = model.channel_count;
        const uint64_t verts = model.vertex_count;
        model.up = HEWN_AXIS_PLUS_Z;
        model.up_known = true;
        model.unit = hewn_unit_find("mm");
        simplify(&model, &(hewn_simplify_desc){.ratio = 0.4, .preserve = 1 + random_below(&random, 15)});
        assert_int_equal(model.channel_count, channels);
        assert_true(model.up_known && model.up == HEWN_AXIS_PLUS_Z && model.unit == hewn_unit_find("mm"));
        mark = hewn_model_find_channel(&model, HEWN_DOMAIN_VERT, "mark")->values;
        for (uint64_t v = 0; v < model.vertex_count; v++)
            assert_true(mark[v] % 1000 == 0 && mark[v] >= 0 && (uint64_t)mark[v] < 1000 * verts);
        share = hewn_model_find_channel(&model, HEWN_DOMAIN_CORNER, "color")->values;
        for (uint64_t c = 0; c < 3 * model.face_count; c++)
            assert_true(share[c] >= 3 && share[c] <= 5);
        hewn_model_destroy(&model);
    }
}

static void test_the_extractions_triangles(void **state)
{
    (void)state;
    hewn_triangles torus = make_torus(60, 40);
    hewn_simplify_report report;
    hewn_error error = {0};
    const hewn_simplify_desc desc = {.relative_error = 0.005};
    if (hewn_triangles_simplify(&torus, &desc, &report, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    hewn_certificate certificate;
    assert_int_equal(hewn_certify(&torus, NULL, &certificate, &error), HEWN_OK);
    assert_true(certificate.closed && certificate.manifold && certificate.oriented);
    assert_int_equal(certificate.genus, 1);
    assert_int_equal(torus.triangle_count, report.triangles);
    assert_true(report.triangles < report.triangles_before / 2);
    assert_true(report.distance <= report.error_allowed);
    hewn_triangles_destroy(&torus);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_uv_seams_survive),
        cmocka_unit_test(test_what_is_not_preserved_is_dropped),
        cmocka_unit_test(test_steps_of_colour_survive),
        cmocka_unit_test(test_linear_values_stay_exact),
        cmocka_unit_test(test_materials_keep_their_borders),
        cmocka_unit_test(test_normals_are_made_anew),
        cmocka_unit_test(test_sharp_edges_stay_sharp),
        cmocka_unit_test(test_every_channel),
        cmocka_unit_test(test_the_extractions_triangles),
    };
    return cmocka_run_group_tests_name("simplify_model", tests, NULL, NULL);
}
