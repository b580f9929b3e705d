/* Subdivision against OpenSubdiv: random sheets with boundaries, holes, creases and corners, by every rule. */
#include <unistd.h>

#include "osd_peer.h"
#include "pipeline/tag_file.h"
#include "subdivide/seams.h"
#include "test_subdivide_support.h"

static void assert_near_all(const char *what, const double *is, const double *wanted, size_t count, double bound,
                            const hewn_subdivide_desc *desc)
{
    for (size_t i = 0; i < count; i++)
        if (!(fabs(is[i] - wanted[i]) <= bound))
            fail_msg("%s %zu: %.9g instead of %.9g (%s, %u levels, %s, %s)", what, i, is[i], wanted[i],
                     hewn_scheme_name(desc->scheme), desc->levels, hewn_subdivide_boundary_name(desc->boundary),
                     hewn_creasing_name(desc->creasing));
}

/* Sharp for ever or not at all: then OpenSubdiv's limit is that of the surface. */
static void compare(const hewn_model *model, const hewn_subdivide_desc *desc, bool limit)
{
    hewn_subdivide_desc with = *desc;
    hewn_polygons polygons = hewn_model_polygons(model);
    with.limit = limit;
    hewn_subdivision *sub = subdivide(model, &with);
    size_t verts = hewn_subdivision_vert_count(sub);
    double *own = hewn_alloc(verts, 3 * sizeof *own), *theirs = hewn_alloc(verts, 9 * sizeof *theirs);
    assert_true(own && theirs);
    osd_request request = {&polygons, desc, sub, model->positions, NULL};
    double *limits = theirs + 3 * verts, *normals = limits + 3 * verts;
    assert_true(osd_refine(&request, theirs, limit ? limits : NULL, limit ? normals : NULL, NULL));
    assert_int_equal(hewn_subdivision_refine(sub, model->positions, 3, own, NULL), HEWN_OK);
    assert_near_all("point", own, theirs, 3 * verts, 1e-5, desc);
    if (limit) {
        assert_int_equal(hewn_subdivision_limit(sub, model->positions, own, NULL, NULL, NULL, NULL), HEWN_OK);
        assert_near_all("limit", own, limits, 3 * verts, 1e-6, desc);
        assert_int_equal(hewn_subdivision_limit(sub, model->positions, NULL, NULL, NULL, own, NULL), HEWN_OK);
        for (size_t v = 0; v < verts && desc->scheme != HEWN_SCHEME_BILINEAR; v++) {
            double dot = 0, length = 0;
            for (size_t i = 0; i < 3; i++) {
                dot += own[3 * v + i] * normals[3 * v + i];
                length += normals[3 * v + i] * normals[3 * v + i];
            }
            /* Beside Loop's creases of other than three faces OpenSubdiv takes tangents that are near ones. */
            bool exact = desc->scheme != HEWN_SCHEME_LOOP || !sub->levels[sub->count].edge_sharp;
            if (length > 0.5 && !(dot > (exact ? 1 - 1e-6 : 0.9)))
                fail_msg("normal %zu of %s is off: cosine %g", v, hewn_scheme_name(desc->scheme), dot);
        }
    }
    hewn_free(own);
    hewn_free(theirs);
    hewn_subdivision_destroy(&sub);
}

static hewn_model make_control(hewn_scheme scheme, random_state *random)
{
    uint32_t kind = random_below(random, 4);
    hewn_model model;
    if (kind == 0 && scheme != HEWN_SCHEME_LOOP)
        model = make_ring_model(3 + random_below(random, 5), 3 + random_below(random, 5), random_below(random, 3));
    else
        model = make_sheet(3 + random_below(random, 4), scheme != HEWN_SCHEME_LOOP, scheme == HEWN_SCHEME_LOOP, random);
    drop_isolated(&model);
    return model;
}

static void test_random_control_meshes(void **state)
{
    (void)state;
    if (!osd_is_there())
        skip();
    random_state random = {1};
    for (int i = 0; i < 400; i++) {
        static tags all;
        hewn_subdivide_desc desc = {.scheme = (hewn_scheme)(i % 3), .levels = 1 + random_below(&random, 4)};
        desc.boundary = (hewn_subdivide_boundary)random_below(&random, 2);
        desc.creasing = (hewn_creasing)random_below(&random, 2);
        hewn_model model = make_control(desc.scheme, &random);
        make_tags(&model, 2 + random_below(&random, 20), &all, &random);
        desc.creases = all.creases;
        desc.crease_count = i % 4 ? all.crease_count : 0;
        desc.corners = all.corners;
        desc.corner_count = i % 4 ? all.corner_count : 0;
        compare(&model, &desc, i % 4 == 0);
        hewn_model_destroy(&model);
    }
}

/* Limits and normals beside creases that last for ever. */
static void test_limits_at_lasting_creases(void **state)
{
    (void)state;
    if (!osd_is_there())
        skip();
    random_state random = {2};
    for (int i = 0; i < 100; i++) {
        static tags all;
        hewn_subdivide_desc desc = {.scheme = (hewn_scheme)(i % 2), .levels = 1 + random_below(&random, 3)};
        hewn_model model = make_control(desc.scheme, &random);
        make_tags(&model, 6, &all, &random);
        for (uint64_t k = 0; k < all.crease_count; k++)
            all.creases[k].sharpness = 10;
        desc.creases = all.creases;
        desc.crease_count = all.crease_count;
        hewn_polygons polygons = hewn_model_polygons(&model);
        desc.limit = true;
        hewn_subdivision *sub = subdivide(&model, &desc);
        size_t verts = hewn_subdivision_vert_count(sub);
        double *own = evaluate(sub, model.positions), *theirs = hewn_alloc(verts, 9 * sizeof *theirs);
        osd_request request = {&polygons, &desc, sub, model.positions, NULL};
        assert_true(osd_refine(&request, theirs, theirs + 3 * verts, theirs + 6 * verts, NULL));
        assert_near_all("limit", own, theirs + 3 * verts, 3 * verts, 1e-6, &desc);
        hewn_free(own);
        hewn_free(theirs);
        hewn_subdivision_destroy(&sub);
        hewn_model_destroy(&model);
    }
}

/* Whether two fans around a vertex have one value: to Hewn these are two, what OpenSubdiv does is its own affair. */
static bool has_twins(const hewn_subdivision *sub, const hewn_subdivision *seams, const uint32_t *sources,
                      const double *uv)
{
    const sub_level *base = &sub->levels[0];
    for (uint32_t a = 0; a < seams->levels[0].verts; a++)
        for (uint32_t b = 0; b < a; b++)
            if (base->corner_verts[sources[a]] == base->corner_verts[sources[b]] &&
                memcmp(uv + 2 * sources[a], uv + 2 * sources[b], 2 * sizeof *uv) == 0)
                return true;
    return false;
}

/* Values of corners: some seams, some vertices cut, all six rules. */
static void test_uv_rules(void **state)
{
    (void)state;
    if (!osd_is_there())
        skip();
    random_state random = {3};
    int compared = 0;
    for (int i = 0; i < 900; i++) {
        hewn_subdivide_desc desc = {.scheme = (hewn_scheme)(i % 3), .levels = 1 + random_below(&random, 3)};
        desc.uv = (hewn_uv_rule)(i / 3 % HEWN_UV_COUNT);
        desc.boundary = (hewn_subdivide_boundary)random_below(&random, 2);
        hewn_model model = make_control(desc.scheme, &random);
        uint64_t corners = hewn_model_corner_count(&model);
        uint32_t regions = 1 + random_below(&random, 3), width = 1 + random_below(&random, 4);
        double *uv = malloc(corners * 2 * sizeof *uv);
        assert_non_null(uv);
        for (uint64_t f = 0; f < model.face_count; f++) { /* strips of faces are moved apart */
            uint64_t begin = model.first ? model.first[f] : 3 * f, end = model.first ? model.first[f + 1] : 3 * f + 3;
            double shift = (double)(f / width % regions + (i % 5 == 0 ? 0 : f % 7 / 4));
            for (uint64_t c = begin; c < end; c++)
                for (uint64_t k = 0; k < 2; k++)
                    uv[2 * c + k] = model.positions[3 * (size_t)model.corners[c] + k] + 10 * shift;
        }
        hewn_polygons polygons = hewn_model_polygons(&model);
        hewn_subdivision *sub = subdivide(&model, &desc), *seams;
        uint32_t *sources;
        assert_int_equal(hewn_sub_seams(sub, uv, 2 * sizeof *uv, desc.uv, &seams, &sources, NULL), HEWN_OK);
        const sub_level *last = &seams->levels[seams->count];
        double *control = malloc(seams->levels[0].verts * 2 * sizeof *control);
        double *own = malloc(last->verts * 2 * sizeof *own), *theirs = malloc(last->corners * 2 * sizeof *theirs);
        double *points = malloc(hewn_subdivision_vert_count(sub) * 3 * sizeof *points);
        assert_true(control && own && theirs && points);
        for (uint32_t v = 0; v < seams->levels[0].verts; v++)
            memcpy(control + 2 * v, uv + 2 * sources[v], 2 * sizeof *uv);
        assert_int_equal(hewn_subdivision_refine(seams, control, 2, own, NULL), HEWN_OK);
        osd_request request = {&polygons, &desc, sub, model.positions, uv};
        assert_true(osd_refine(&request, points, NULL, NULL, theirs));
        bool clear = !has_twins(sub, seams, sources, uv);
        compared += clear;
        for (uint32_t c = 0; clear && c < last->corners; c++)
            for (uint32_t k = 0; k < 2; k++) {
                double is = own[2 * last->corner_verts[c] + k], wanted = theirs[2 * c + k];
                if (!(fabs(is - wanted) < 1e-5))
                    fail_msg("run %d, %s, %s, %s: corner %u is %g instead of %g", i, hewn_scheme_name(desc.scheme),
                             hewn_uv_rule_name(desc.uv), hewn_subdivide_boundary_name(desc.boundary), c, is, wanted);
            }
        free(control);
        free(own);
        free(theirs);
        free(points);
        free(uv);
        hewn_free(sources);
        hewn_subdivision_destroy(&sub);
        hewn_subdivision_destroy(&seams);
        hewn_model_destroy(&model);
    }
    print_message("# %d meshes compared\n", compared);
    assert_true(compared > 100);
}

static bool differs_untagged(const hewn_model *model, const hewn_subdivide_desc *desc)
{
    hewn_subdivide_desc smooth = *desc;
    smooth.crease_count = 0;
    hewn_subdivision *tagged = subdivide(model, desc), *plain = subdivide(model, &smooth);
    double *with = evaluate(tagged, model->positions), *without = evaluate(plain, model->positions);
    bool differs = memcmp(with, without, hewn_subdivision_vert_count(tagged) * 3 * sizeof *with) != 0;
    hewn_free(with);
    hewn_free(without);
    hewn_subdivision_destroy(&tagged);
    hewn_subdivision_destroy(&plain);
    return differs;
}

/* A control mesh with tags in its own file, as OpenSubdiv's regression shapes have them: half-sharp rings on a torus.
 */
static void test_tagged_file(void **state)
{
    (void)state;
    char folder[4096], path[4200];
    if (!osd_is_there() || !data_folder(folder))
        skip();
    snprintf(path, sizeof path, "%s/malformed/catmark_torus_creases0.obj", folder);
    if (access(path, R_OK) != 0)
        skip();
    hewn_model model;
    hewn_tags tagged = {0};
    assert_int_equal(hewn_model_read(path, NULL, &model, NULL), HEWN_OK);
    assert_int_equal(hewn_tags_read(path, &tagged, NULL), HEWN_OK);
    assert_true(tagged.crease_count > 0);
    for (size_t i = 0; i < tagged.crease_count; i++)
        assert_true(tagged.creases[i].sharpness > 0);
    for (int i = 0; i < 10; i++) {
        hewn_subdivide_desc desc = {.levels = 1 + (uint32_t)i / 2, .creasing = (hewn_creasing)(i % 2)};
        desc.creases = tagged.creases;
        desc.crease_count = tagged.crease_count;
        compare(&model, &desc, false);
        assert_true(differs_untagged(&model, &desc));
    }
    hewn_tags_free(&tagged);
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_control_meshes),
        cmocka_unit_test(test_limits_at_lasting_creases),
        cmocka_unit_test(test_uv_rules),
        cmocka_unit_test(test_tagged_file),
    };
    return cmocka_run_group_tests_name("subdivide_osd", tests, NULL, NULL);
}
