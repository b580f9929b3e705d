/* Simplification out of memory: lists and pages on disk, regions, and what must hold of meshes that were taken apart.
 */
#include <omp.h>
#include <unistd.h>

#include "hewn/check.h"
#include "hewn/distance.h"
#include "outcore/assemble.h"
#include "outcore/facets.h"
#include "outcore/outcore.h"
#include "outcore/pass.h"
#include "test_smooth_support.h"

enum { USUAL = HEWN_PRESERVE_UV | HEWN_PRESERVE_COLOR | HEWN_PRESERVE_LABEL };

#define MUST(call)                                                                                                     \
    do {                                                                                                               \
        hewn_error must_error = {0};                                                                                   \
        hewn_error *error = &must_error;                                                                               \
        if ((call) != HEWN_OK)                                                                                         \
            fail_msg("%s", must_error.message);                                                                        \
    } while (0)

/* --- on disk ------------------------------------------------------------------------------------------------------ */

static void test_pages_remember(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    random_state random = {1};
    uint32_t(*known)[7] = calloc(COUNT, sizeof *known), record[7];
    hewn_pages *pages;
    uint64_t end = 0;
    MUST(hewn_pages_create("-", sizeof *known, 1 << 16, &pages, error)); /* a tenth of it */
    for (int i = 0; i < 200000; i++) {
        const uint32_t at = random_below(&random, COUNT);
        if (random_below(&random, 2)) {
            for (int k = 0; k < 7; k++)
                known[at][k] = random_below(&random, 1 << 30);
            MUST(hewn_pages_put(pages, at, known[at], error));
            end = at + 1 > end ? at + 1 : end;
        } else if (at < end) {
            MUST(hewn_pages_get(pages, at, record, error));
            assert_memory_equal(record, known[at], sizeof record);
        }
    }
    hewn_pages_destroy(&pages);
    free(known);
}

typedef struct expected_numbers {
    uint64_t next, step;
} expected_numbers;

static hewn_result expect_number(void *user, const void *record, hewn_error *error)
{
    expected_numbers *expected = user;
    uint64_t number;
    (void)error;
    memcpy(&number, record, sizeof number);
    assert_int_equal(number, expected->next);
    expected->next += expected->step;
    return HEWN_OK;
}

/* Lists that grow together keep apart, come in order, and leave their room to others. */
static void test_chains_keep_order_and_room(void **state)
{
    (void)state;
    enum { LISTS = 5, COUNT = 100003 };
    hewn_chains chains;
    hewn_chain lists[LISTS] = {0};
    uint64_t most = 0;
    MUST(hewn_chains_open("-", sizeof(uint64_t), &chains, error));
    for (int turn = 0; turn < 3; turn++) {
        for (uint64_t i = 0; i < COUNT; i++)
            MUST(hewn_chain_add(&chains, &lists[i % LISTS], &i, error));
        for (uint64_t l = 0; l < LISTS; l++) {
            expected_numbers expected = {l, LISTS};
            MUST(hewn_chain_settle(&chains, &lists[l], error));
            MUST(hewn_chain_read(&chains, &lists[l], false, expect_number, &expected, error));
            expected.next = l;
            MUST(hewn_chain_read(&chains, &lists[l], true, expect_number, &expected, error));
            assert_true(expected.next >= COUNT);
            assert_int_equal(lists[l].count, 0);
        }
        if (turn == 0)
            most = hewn_chains_file_bytes(&chains);
        assert_int_equal(hewn_chains_file_bytes(&chains), most);
    }
    assert_true(most < (COUNT + LISTS * 4096) * sizeof(uint64_t));
    hewn_chains_close(&chains);
}

/* Regions are about as full as each other for points of any kind, and other planes are other planes. */
static void test_regions_are_even(void **state)
{
    (void)state;
    enum { COUNT = 300000, REGIONS = 23 };
    static double points[COUNT][3];
    for (int kind = 0; kind < 3; kind++) {
        random_state random = {2 + (uint64_t)kind};
        hewn_sample sample = {0};
        for (uint64_t i = 0; i < COUNT; i++) {
            for (int axis = 0; axis < 3; axis++)
                points[i][axis] = kind == 1 && axis == 1 ? 7 : random_unit(&random);
            if (kind == 2) /* most are in one small place, one is far away */
                for (int axis = 0; axis < 3; axis++)
                    points[i][axis] = i == 5 ? 1e9 : pow(points[i][axis], 9);
            MUST(hewn_sample_add(&sample, i, points[i], error));
        }
        uint32_t before[64] = {0};
        for (int shifted = 0; shifted < 2; shifted++) {
            hewn_regions regions;
            uint64_t counts[REGIONS] = {0};
            MUST(hewn_regions_make(&sample, REGIONS, shifted ? 0.2 : 0, &regions, error));
            assert_int_equal(regions.count, REGIONS);
            uint32_t changed = 0;
            for (uint64_t i = 0; i < COUNT; i++) {
                const uint32_t region = hewn_region_of(&regions, points[i]);
                assert_true(region < REGIONS);
                counts[region]++;
                if (i < 64)
                    changed += before[i] != region;
                if (i < 64)
                    before[i] = region;
            }
            for (int r = 0; r < REGIONS; r++)
                assert_true(counts[r] > COUNT / REGIONS / 2 && counts[r] < 2 * COUNT / REGIONS);
            assert_true(!shifted || changed > 0);
            hewn_regions_free(&regions);
        }
        hewn_sample_free(&sample);
    }
}

/* Points that are all the same, or on few places, are no trouble. */
static void test_points_without_extent(void **state)
{
    (void)state;
    for (int places = 1; places <= 3; places++) {
        hewn_sample sample = {0};
        hewn_regions regions;
        for (uint64_t i = 0; i < 100; i++)
            MUST(hewn_sample_add(&sample, i, (double[3]){(double)(i % (uint64_t)places), 1, 2}, error));
        MUST(hewn_regions_make(&sample, 10, 0, &regions, error));
        assert_int_equal(regions.count, places);
        hewn_regions_free(&regions);
        hewn_sample_free(&sample);
    }
}

/* --- meshes ------------------------------------------------------------------------------------------------------- */

/* A store with all of a model, which stays. */
static hewn_store store_of(const hewn_model *model, uint32_t preserve)
{
    hewn_store store;
    hewn_model copy;
    hewn_store_begin("-", preserve, 1 << 16, &store);
    MUST(hewn_model_copy(model, &copy, error));
    MUST(hewn_store_add(&store, &copy, error));
    hewn_model_destroy(&copy);
    MUST(hewn_store_finish(&store, error));
    return store;
}

/* Within memory for `room` triangles. */
static hewn_model simplify(const hewn_model *model, const hewn_simplify_desc *desc, uint64_t room,
                           hewn_simplify_report *report, hewn_outcore_report *more)
{
    hewn_store store = store_of(model, desc->preserve ? desc->preserve : USUAL);
    hewn_model out;
    MUST(hewn_outcore_simplify(&store, desc, hewn_outcore_bytes(&store.schema, room), &out, report, more, error));
    hewn_store_free(&store);
    hewn_error error = {0};
    assert_int_equal(hewn_model_check(&out, &error), HEWN_OK);
    assert_int_equal(report->triangles, out.face_count);
    return out;
}

static hewn_check *check_of(const hewn_model *model)
{
    hewn_check *check;
    const hewn_polygons polygons = hewn_model_polygons(model);
    MUST(hewn_check_polygons(&polygons, &(hewn_check_desc){.skip_self_intersections = true}, &check, error));
    return check;
}

/* Topology stays, nothing degenerate is made, and no vertex is left over. */
static void assert_sound(const hewn_model *before, const hewn_model *after)
{
    hewn_check *a = check_of(before), *b = check_of(after);
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

static hewn_model make_shape(int shape)
{
    random_state random = {3};
    hewn_model model = shape == 0   ? make_sphere(40, 2)
                       : shape == 1 ? make_ring_model(90, 60, 3) /* of quadrilaterals, too */
                       : shape == 2 ? make_sheet(80, 0.1)
                                    : model_of(join_meshes(make_torus(80, 40), make_torus(70, 40), 20));
    if (shape != 2)
        add_noise(&model, 1e-3, &random);
    return model;
}

static uint64_t triangles_of(const hewn_model *model)
{
    return hewn_model_corner_count(model) - 2 * model->face_count;
}

/* Whether what is left fits (and is done at once), or does not (and passes go on to the end). */
static void test_shapes_keep_their_topology(void **state)
{
    (void)state;
    static const double ratios[] = {0.6, 0.1};
    for (int shape = 0; shape < 4; shape++)
        for (int r = 0; r < 2; r++) {
            hewn_model model = make_shape(shape);
            hewn_simplify_report report;
            hewn_outcore_report more;
            hewn_model out = simplify(&model, &(hewn_simplify_desc){.ratio = ratios[r]}, 2500, &report, &more);
            assert_sound(&model, &out);
            assert_true(more.passes > 1 && more.regions > 3);
            assert_int_equal(report.triangles_before, triangles_of(&model));
            assert_true((double)out.face_count < 1.01 * ratios[r] * (double)report.triangles_before);
            assert_true(report.reached == (report.triangles <= report.target));
            assert_true(r == 0 || report.reached);
            hewn_model_destroy(&model);
            hewn_model_destroy(&out);
        }
}

/* What fits is done as always. */
static void test_what_fits_is_the_same(void **state)
{
    (void)state;
    hewn_model model = make_shape(3), other, out;
    hewn_simplify_report report, known;
    hewn_outcore_report more;
    const hewn_simplify_desc desc = {.ratio = 0.1, .lock_angle = 20};
    add_channel(&model, "normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3);
    add_channel(&model, "uv", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 2);
    MUST(hewn_model_copy(&model, &other, error));
    MUST(hewn_model_simplify(&other, &desc, &known, error));
    out = simplify(&model, &desc, 100000, &report, &more);
    assert_int_equal(more.passes, 0);
    assert_int_equal(out.vertex_count, other.vertex_count);
    assert_memory_equal(out.positions, other.positions, 3 * out.vertex_count * sizeof(double));
    assert_memory_equal(out.corners, other.corners, 3 * out.face_count * sizeof(uint32_t));
    assert_int_equal(report.locked_vertices, known.locked_vertices);
    assert_int_equal(out.channel_count, other.channel_count);
    for (uint32_t i = 0; i < out.channel_count; i++)
        assert_memory_equal(out.channels[i].values, other.channels[i].values, channel_bytes(&out, &out.channels[i]));
    hewn_model_destroy(&model);
    hewn_model_destroy(&other);
    hewn_model_destroy(&out);
}

static void test_the_same_bytes_with_any_threads(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 5};
    hewn_model model = make_shape(3), outs[3];
    const int usual = omp_get_max_threads();
    for (int i = 0; i < 3; i++) {
        hewn_simplify_report report;
        hewn_outcore_report more;
        omp_set_num_threads(threads[i]);
        outs[i] = simplify(&model, &(hewn_simplify_desc){.ratio = 0.2}, 2500, &report, &more);
        assert_int_equal(outs[i].face_count, outs[0].face_count);
        assert_memory_equal(outs[i].positions, outs[0].positions, 3 * outs[0].vertex_count * sizeof(double));
        assert_memory_equal(outs[i].corners, outs[0].corners, 3 * outs[0].face_count * sizeof(uint32_t));
    }
    omp_set_num_threads(usual);
    for (int i = 0; i < 3; i++)
        hewn_model_destroy(&outs[i]);
    hewn_model_destroy(&model);
}

/* The distances of passes add up: what is told is never too little, and never more than what was allowed. */
static void test_errors_are_kept(void **state)
{
    (void)state;
    static const double allowed[] = {0.02, 0.08};
    hewn_model model = make_sphere(36, 1);
    uint64_t before = UINT64_MAX;
    for (int i = 0; i < 2; i++) {
        hewn_simplify_report report;
        hewn_outcore_report more;
        hewn_distance known;
        hewn_model out = simplify(&model, &(hewn_simplify_desc){.error = allowed[i]}, 2500, &report, &more);
        const hewn_polygons one = hewn_model_polygons(&model), two = hewn_model_polygons(&out);
        MUST(hewn_polygons_distance(&one, &two, NULL, &known, error));
        assert_sound(&model, &out);
        assert_true(more.passes > 0);
        assert_true(report.measured && report.error_allowed == allowed[i]);
        assert_true(report.distance <= allowed[i]);
        assert_true(known.low <= report.distance && report.distance_low <= known.high);
        assert_true(out.face_count < model.face_count / 3 && out.face_count < before);
        before = out.face_count;
        hewn_model_destroy(&out);
    }
    hewn_model_destroy(&model);
}

/* --- what stays --------------------------------------------------------------------------------------------------- */

static int compare_points(const void *a, const void *b)
{
    return memcmp(a, b, 3 * sizeof(double));
}

static void test_locked_boundaries_stay(void **state)
{
    (void)state;
    const uint32_t n = 80;
    hewn_model model = make_sheet(n, 0.1);
    hewn_simplify_report report;
    hewn_outcore_report more;
    hewn_model out = simplify(&model, &(hewn_simplify_desc){.ratio = 0.1, .lock_boundary = true}, 2500, &report, &more);
    assert_true(more.passes > 0);
    assert_int_equal(report.locked_vertices, 4 * n);
    qsort(out.positions, out.vertex_count, 3 * sizeof(double), compare_points);
    for (uint64_t v = 0; v < model.vertex_count; v++) {
        const double *at = model.positions + 3 * v;
        const bool border = v % (n + 1) == 0 || v % (n + 1) == n || v / (n + 1) == 0 || v / (n + 1) == n;
        if (border)
            assert_non_null(bsearch(at, out.positions, out.vertex_count, 3 * sizeof(double), compare_points));
    }
    hewn_model_destroy(&model);
    hewn_model_destroy(&out);
}

/* Edges of a roof, which only bend in the input's triangles by so much. */
static void test_locked_features_stay(void **state)
{
    (void)state;
    const uint32_t n = 80;
    hewn_model model = make_sheet(n, 0);
    for (uint64_t v = 0; v < model.vertex_count; v++)
        model.positions[3 * v + 2] = fabs(model.positions[3 * v] - 0.5);
    hewn_simplify_report report;
    hewn_outcore_report more;
    hewn_model out = simplify(&model, &(hewn_simplify_desc){.ratio = 0.1, .lock_angle = 30}, 2500, &report, &more);
    uint64_t ridge = 0;
    for (uint64_t v = 0; v < out.vertex_count; v++)
        ridge += out.positions[3 * v] == 0.5 && out.positions[3 * v + 2] == 0;
    assert_true(more.passes > 0);
    assert_int_equal(report.locked_vertices, n + 1);
    assert_int_equal(ridge, n + 1);
    hewn_model_destroy(&model);
    hewn_model_destroy(&out);
}

/* Two charts that meet at x = 1/2, each an affine map of the plane; labels with names; a step of colour. */
static hewn_model make_dressed_sheet(uint32_t n)
{
    hewn_model model = make_sheet(n, 0.05);
    hewn_channel *uv = add_channel(&model, "uv", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 2);
    for (uint64_t c = 0; c < 3 * model.face_count; c++) {
        const double *at = model.positions + 3 * (size_t)model.corners[c];
        const bool right = c / 6 % n >= n / 2;
        ((float *)uv->values)[2 * c] = (float)(right ? 0.6 + 0.3 * at[1] : 0.4 * at[0]);
        ((float *)uv->values)[2 * c + 1] = (float)(right ? 0.9 - 0.5 * at[0] : 0.5 * at[1]);
    }
    hewn_channel *color = add_channel(&model, "color", HEWN_DOMAIN_VERT, HEWN_SCALAR_UINT8, 3);
    for (uint64_t v = 0; v < model.vertex_count; v++)
        ((uint8_t *)color->values)[3 * v] = model.positions[3 * v + 1] > 0.52 ? 255 : 0;
    hewn_channel *label = add_channel(&model, "material", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1);
    int32_t values[2];
    MUST(hewn_channel_value(label, "wood", &values[0], error));
    MUST(hewn_channel_value(label, "iron", &values[1], error));
    for (uint64_t f = 0; f < model.face_count; f++)
        ((int32_t *)label->values)[f] = values[f / 2 % n < n / 4];
    return model;
}

static void test_attributes_survive(void **state)
{
    (void)state;
    hewn_model model = make_dressed_sheet(96);
    hewn_simplify_report report;
    hewn_outcore_report more;
    hewn_model out = simplify(&model, &(hewn_simplify_desc){.ratio = 0.1}, 4000, &report, &more);
    const hewn_channel *uv = hewn_model_find_channel(&out, HEWN_DOMAIN_CORNER, "uv");
    const hewn_channel *color = hewn_model_find_channel(&out, HEWN_DOMAIN_VERT, "color");
    const hewn_channel *label = hewn_model_find_channel(&out, HEWN_DOMAIN_FACE, "material");
    assert_true(more.passes > 0 && report.reached);
    assert_int_equal(out.channel_count, 3);
    assert_non_null(uv);
    assert_non_null(color);
    assert_non_null(label);
    assert_int_equal(label->name_count, 2);
    assert_string_equal(label->names[1], "iron");
    for (uint64_t f = 0; f < out.face_count; f++) {
        double middle = 0;
        for (uint64_t k = 0; k < 3; k++)
            middle += out.positions[3 * (size_t)out.corners[3 * f + k]] / 3;
        assert_int_equal(((const int32_t *)label->values)[f], middle < 0.25);
        for (uint64_t c = 3 * f; c < 3 * f + 3; c++) {
            const double *at = out.positions + 3 * (size_t)out.corners[c];
            const double u = middle > 0.5 ? 0.6 + 0.3 * at[1] : 0.4 * at[0];
            const double v = middle > 0.5 ? 0.9 - 0.5 * at[0] : 0.5 * at[1];
            assert_true(fabs(u - (double)((const float *)uv->values)[2 * c]) < 0.01);
            assert_true(fabs(v - (double)((const float *)uv->values)[2 * c + 1]) < 0.01);
        }
    }
    for (uint64_t v = 0; v < out.vertex_count; v++) {
        const uint8_t red = ((const uint8_t *)color->values)[3 * v];
        const double y = out.positions[3 * v + 1];
        assert_true(y > 0.54 ? red > 250 : y < 0.5 ? red < 5 : true);
    }
    hewn_model_destroy(&model);
    hewn_model_destroy(&out);
}

/* Labels that are locked keep every vertex of their border; what is not preserved goes, normals are made anew. */
static void test_borders_and_what_is_not_kept(void **state)
{
    (void)state;
    const uint32_t n = 96;
    hewn_model model = make_dressed_sheet(n);
    hewn_simplify_report report;
    hewn_outcore_report more;
    add_channel(&model, "normal", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 3);
    hewn_model out =
        simplify(&model, &(hewn_simplify_desc){.ratio = 0.1, .lock_labels = true, .preserve = HEWN_PRESERVE_NONE}, 4000,
                 &report, &more);
    uint64_t border = 0;
    for (uint64_t v = 0; v < out.vertex_count; v++)
        border += out.positions[3 * v] == 0.25;
    assert_true(border >= n + 1);
    assert_int_equal(report.locked_vertices, n + 1);
    assert_null(hewn_model_find_channel(&out, HEWN_DOMAIN_CORNER, "uv"));
    const hewn_channel *normal = hewn_model_find_channel(&out, HEWN_DOMAIN_CORNER, "normal");
    assert_non_null(normal);
    for (uint64_t c = 0; c < 3 * out.face_count; c++)
        assert_true(((const float *)normal->values)[3 * c + 2] > 0.8F);
    hewn_model_destroy(&model);
    hewn_model_destroy(&out);
}

/* --- input of every kind ------------------------------------------------------------------------------------------ */

/* Passes over anything at all: never a new non-manifold edge or vertex, and the Euler number stays. */
static void test_soups(void **state)
{
    (void)state;
    random_state random = {9};
    for (int i = 0; i < 600; i++) {
        hewn_model model = make_soup(&random), out;
        if (model.face_count == 0) {
            hewn_model_destroy(&model);
            continue;
        }
        hewn_store store = store_of(&model, USUAL);
        const hewn_simplify_desc desc = {.faces = 1 + random_below(&random, 20)};
        hewn_check *before = check_of(&model);
        for (uint32_t k = 0; k < 3 && store.triangles.count > 0; k++) {
            const hewn_pass pass = {.store = &store,
                                    .desc = &desc,
                                    .first = k == 0,
                                    .shift = 0.2 * k,
                                    .capacity = 60,
                                    .list_memory = 1 << 20,
                                    .aim = 1};
            hewn_pass_report report;
            MUST(hewn_pass_run(&pass, &report, error));
        }
        uint8_t *frozen;
        MUST(hewn_store_assemble(&store, &out, &frozen, error));
        hewn_check *after = check_of(&out);
        assert_true(after->certificate.non_manifold_edges <= before->certificate.non_manifold_edges);
        assert_true(after->certificate.non_manifold_vertices <= before->certificate.non_manifold_vertices);
        assert_int_equal(before->euler, after->euler);
        hewn_check_destroy(&before);
        hewn_check_destroy(&after);
        hewn_free(frozen);
        hewn_store_free(&store);
        hewn_model_destroy(&model);
        hewn_model_destroy(&out);
    }
}

/* Facets of a closed mesh in random order, with values, become that mesh. */
static void test_facets_are_welded(void **state)
{
    (void)state;
    hewn_model model = make_sphere(60, 1), part, out;
    const uint64_t count = model.face_count;
    part = make_model(3 * count, count, 3 * count, false);
    hewn_channel *value = add_channel(&part, "attribute", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1);
    for (uint64_t c = 0; c < 3 * count; c++) {
        const uint64_t from = (c / 3 * 7919 % count) * 3 + c % 3;
        memcpy(part.positions + 3 * c, model.positions + 3 * (size_t)model.corners[from], 3 * sizeof(double));
        for (int axis = 0; axis < 3; axis++) /* zeroes of both signs */
            if (part.positions[3 * c + axis] == 0 && c % 2)
                part.positions[3 * c + axis] = -0.0;
        part.corners[c] = (uint32_t)c;
        ((int32_t *)value->values)[c / 3] = (int32_t)(from / 3);
    }
    hewn_facets facets;
    hewn_store store;
    uint8_t *frozen;
    hewn_facets_begin("-", &facets);
    hewn_store_begin("-", USUAL, 1 << 16, &store);
    MUST(hewn_facets_add(&facets, &part, error));
    MUST(hewn_facets_weld(&facets, 2 << 20, &store, error));
    MUST(hewn_store_finish(&store, error));
    assert_int_equal(store.vertex_count, model.vertex_count);
    MUST(hewn_store_assemble(&store, &out, &frozen, error));
    assert_sound(&model, &out);
    value = hewn_model_find_channel(&out, HEWN_DOMAIN_FACE, "attribute");
    for (uint64_t c = 0; c < 3 * count; c++) {
        const uint64_t from = 3 * (uint64_t)((int32_t *)value->values)[c / 3] + c % 3;
        const double *a = out.positions + 3 * (size_t)out.corners[c];
        assert_true(distance(a, model.positions + 3 * (size_t)model.corners[from]) == 0);
    }
    hewn_free(frozen);
    hewn_facets_free(&facets);
    hewn_store_free(&store);
    hewn_model_destroy(&model);
    hewn_model_destroy(&part);
    hewn_model_destroy(&out);
}

/* Equal positions cannot be parted: more of them than fit are refused. */
static void test_facets_in_one_place(void **state)
{
    (void)state;
    const uint64_t count = 20000;
    hewn_model part = make_model(3 * count, count, 3 * count, false);
    for (uint64_t c = 0; c < 3 * count; c++) {
        part.corners[c] = (uint32_t)c;
        part.positions[3 * c] = c < 30 ? (double)c : 1;
    }
    hewn_facets facets;
    hewn_store store;
    hewn_error refusal = {0};
    hewn_facets_begin("-", &facets);
    hewn_store_begin("-", USUAL, 1 << 16, &store);
    MUST(hewn_facets_add(&facets, &part, error));
    assert_int_equal(hewn_facets_weld(&facets, 2 << 20, &store, &refusal), HEWN_OUT_OF_MEMORY);
    assert_non_null(strstr(refusal.message, "in one place"));
    hewn_facets_free(&facets);
    hewn_store_free(&store);
    hewn_model_destroy(&part);
}

static void test_what_is_refused(void **state)
{
    (void)state;
    hewn_model model = make_sheet(40, 0.1), out;
    hewn_simplify_report report;
    hewn_outcore_report more;
    static const struct {
        hewn_simplify_desc desc;
        uint64_t room;
        hewn_result result;
    } cases[] = {{{.ratio = 2}, 1000, HEWN_INVALID_ARGUMENT},
                 {{.ratio = 0.1, .no_self_intersections = true}, 1000, HEWN_INVALID_ARGUMENT},
                 {{.ratio = 0.1}, 10, HEWN_OUT_OF_MEMORY},
                 {{.error = 1e-30}, 1000, HEWN_LIMIT}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hewn_store store = store_of(&model, USUAL);
        hewn_error reason = {0};
        const uint64_t memory = hewn_outcore_bytes(&store.schema, cases[i].room);
        const hewn_result result = hewn_outcore_simplify(&store, &cases[i].desc, memory, &out, &report, &more, &reason);
        if (result != cases[i].result)
            fail_msg("case %zu: result %d: %s", i, result, reason.message);
        assert_null(out.positions);
        hewn_store_free(&store);
    }
    hewn_store store;
    hewn_error reason = {0};
    model.corners[7] = (uint32_t)model.vertex_count; /* one too many */
    hewn_store_begin("-", USUAL, 1 << 16, &store);
    MUST(hewn_store_add(&store, &model, error));
    MUST(hewn_store_finish(&store, error));
    assert_int_equal(
        hewn_outcore_simplify(&store, &(hewn_simplify_desc){.ratio = 0.1}, 1 << 20, &out, &report, &more, &reason),
        HEWN_BAD_INPUT);
    hewn_store_free(&store);
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pages_remember),
        cmocka_unit_test(test_chains_keep_order_and_room),
        cmocka_unit_test(test_regions_are_even),
        cmocka_unit_test(test_points_without_extent),
        cmocka_unit_test(test_shapes_keep_their_topology),
        cmocka_unit_test(test_what_fits_is_the_same),
        cmocka_unit_test(test_the_same_bytes_with_any_threads),
        cmocka_unit_test(test_errors_are_kept),
        cmocka_unit_test(test_locked_boundaries_stay),
        cmocka_unit_test(test_locked_features_stay),
        cmocka_unit_test(test_attributes_survive),
        cmocka_unit_test(test_borders_and_what_is_not_kept),
        cmocka_unit_test(test_soups),
        cmocka_unit_test(test_facets_are_welded),
        cmocka_unit_test(test_facets_in_one_place),
        cmocka_unit_test(test_what_is_refused),
    };
    return cmocka_run_group_tests_name("outcore", tests, NULL, NULL);
}
