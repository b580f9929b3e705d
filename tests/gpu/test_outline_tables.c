/* Outlines of many sides are read from tables of cells: values, gradients and bounds have the bits that walking over
 * all sides gives, and meshes have the same bytes. */
#include "../unit/test_field_support.h"
#include "gpu_test.h"

#include "eval/internal.h"
#include "hewn/hewn.h"
#include "iso/extractor.h"

enum { POINTS = 6000, BOXES = 600 };

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
    random_state random;
} fixture;

static double between(fixture *state, double lo, double hi)
{
    return random_between(&state->random, lo, hi);
}

/* Contours around a point, of sides long and short; some corners are level with others, or hardly not. */
static hewn_node random_contours(fixture *state, hewn_field *field, double x, double y, double size)
{
    static double points[2 * 400];
    size_t counts[2] = {40 + random_below(&state->random, 150), 24 + random_below(&state->random, 40)};
    for (size_t contour = 0, at = 0; contour < 2; contour++)
        for (size_t i = 0; i < counts[contour]; i++, at++) {
            double angle = 6.283185307179586 * (double)i / (double)counts[contour];
            double radius = contour ? 0.3 * size : size * between(state, 0.5, 1);
            points[2 * at] = x + radius * cos(angle);
            points[2 * at + 1] = y + radius * sin(angle);
            if (i > 0 && random_below(&state->random, 4) == 0)
                points[2 * at + 1] = points[2 * at - 1] * (random_below(&state->random, 2) ? 1 : 1 + 1e-7);
        }
    return hewn_contours(field, points, counts, 2);
}

/* Round 0: sides all as far from the middle as others; 1: several outlines apart; 2: the same, turned with others of
 * their own; then one. */
static hewn_node make(fixture *state, hewn_field *field, int round, double *size)
{
    *size = pow(10, between(state, -2, 2));
    if (round == 0)
        return hewn_regular_polygon(field, 180, *size);
    if (round > 2)
        return random_contours(state, field, between(state, -1, 1) * *size, between(state, -1, 1) * *size, *size);
    hewn_node all = random_contours(state, field, 0, 0, *size);
    for (int i = 1; i < 5; i++)
        all = hewn_union(field, all, random_contours(state, field, 2.1 * i * *size, (i % 2) * *size, *size));
    if (round == 2)
        all = hewn_union(field, all, hewn_rotate(field, all, 0, 0, 1, 1));
    return all;
}

/* Near the outline, at heights of its corners, and far away. */
static void pick_points(fixture *state, const hewn_field *field, double size, float *points)
{
    static double corners[2 * 4096];
    size_t count = 0;
    for (uint32_t id = 0; id < hewn_field_node_count(field) && count < 4096; id++) {
        const hewn_node_data *node = hewn_field_node(field, id);
        if (node->op != HEWN_OP_EDGE)
            continue;
        corners[2 * count] = node->parameter[0];
        corners[2 * count++ + 1] = node->parameter[1];
    }
    for (int i = 0; i < POINTS; i++) {
        const double *corner = corners + 2 * (size_t)random_below(&state->random, (uint32_t)count);
        double reach = size * pow(10, between(state, -6, i % 8 ? 0.3 : 3.4));
        points[3 * i] = (float)(corner[0] + between(state, -reach, reach));
        points[3 * i + 1] = i % 3 ? (float)(corner[1] + between(state, -reach, reach)) : (float)corner[1];
        points[3 * i + 2] = 0;
    }
}

/* Boxes of two points each contain these points' values; where one outline alone has a table, bounds are the same. */
static void compare(fixture *state, const hewn_code *const codes[2], const float *points, bool alone)
{
    static float values[2][POINTS], gradients[2][4 * POINTS], boxes[6 * BOXES], bounds[2][2 * BOXES];
    for (int i = 0; i < BOXES; i++)
        for (int axis = 0; axis < 3; axis++) {
            float a = points[3 * i + axis], b = points[3 * (i + BOXES) + axis];
            boxes[6 * i + axis] = fminf(a, b);
            boxes[6 * i + 3 + axis] = fmaxf(a, b);
        }
    for (int k = 0; k < 2; k++) {
        GPU_TEST_TRY(hewn_code_eval_points(state->device, codes[k], points, POINTS, values[k], &error));
        GPU_TEST_TRY(hewn_code_eval_gradients(state->device, codes[k], points, POINTS, gradients[k], &error));
        GPU_TEST_TRY(hewn_code_eval_boxes(state->device, codes[k], boxes, BOXES, bounds[k], &error));
    }
    for (int i = 0; i < POINTS; i++)
        if (memcmp(&values[0][i], &values[1][i], 4) != 0)
            fail_msg("at (%.9g, %.9g): %.9g by the table, %.9g by all sides", (double)points[3 * i],
                     (double)points[3 * i + 1], (double)values[0][i], (double)values[1][i]);
    for (int i = 0; i < 4 * POINTS; i++) /* but for signs of zeros */
        if (!(gradients[0][i] == gradients[1][i]))
            fail_msg("at (%.9g, %.9g), number %d of the gradient: %.9g by the table, %.9g by all sides",
                     (double)points[3 * (i / 4)], (double)points[3 * (i / 4) + 1], i % 4, (double)gradients[0][i],
                     (double)gradients[1][i]);
    for (int i = 0; i < BOXES; i++)
        for (int end = 0; end < 2; end++) {
            float value = values[1][i + end * BOXES];
            assert_true(bounds[0][2 * i] <= value && value <= bounds[0][2 * i + 1]);
        }
    if (alone)
        assert_memory_equal(bounds[0], bounds[1], sizeof bounds[0]);
}

static void tables_give_the_bits_of_all_sides(void **state)
{
    fixture *own = *state;
    static float points[3 * POINTS];
    const int rounds = getenv("HEWN_LONG") ? 200 : 6;
    for (int round = 0; round < rounds; round++) {
        hewn_field *field;
        double size;
        GPU_TEST_TRY(hewn_field_create(&field, &error));
        hewn_node root = make(own, field, round, &size);
        GPU_TEST_TRY(hewn_field_status(field, &error));
        hewn_code *codes[2];
        for (int k = 0; k < 2; k++) {
            const hewn_code_desc how = {.chained = k == 1};
            GPU_TEST_TRY(hewn_code_create_as(own->device, field, root, &how, &codes[k], &error));
            assert_true(codes[k]->listing.table_count == (k ? 0 : round == 2 ? 2 : 1));
        }
        pick_points(own, field, size, points);
        compare(own, (const hewn_code *const *)codes, points, round == 0 || round > 2);
        for (int k = 0; k < 2; k++)
            hewn_code_destroy(own->device, &codes[k]);
        hewn_field_destroy(&field);
    }
}

/* Farther out than tables tell exactly, where all of an outline is about as far away: within rounding, and outside. */
static void far_away_is_outside(void **state)
{
    fixture *own = *state;
    hewn_field *field;
    hewn_code *code;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    hewn_node root = random_contours(own, field, 0.2, -0.3, 1);
    GPU_TEST_TRY(hewn_code_create_as(own->device, field, root, &(hewn_code_desc){0}, &code, &error));
    enum { COUNT = 600 };
    static float points[3 * COUNT], values[COUNT];
    static double exact[3 * COUNT], expected[COUNT];
    for (int i = 0; i < COUNT; i++) {
        double angle = 6.283185307179586 * i / COUNT, far = pow(10, between(own, 3, 6));
        points[3 * i] = (float)(far * cos(angle));
        points[3 * i + 1] = i % 2 ? (float)(far * sin(angle)) : (float)between(own, -1.2, 1.2);
        for (int axis = 0; axis < 3; axis++)
            exact[3 * i + axis] = (double)points[3 * i + axis];
    }
    GPU_TEST_TRY(hewn_code_eval_points(own->device, code, points, COUNT, values, &error));
    GPU_TEST_TRY(hewn_field_eval(field, root, exact, COUNT, expected, &error));
    for (int i = 0; i < COUNT; i++)
        if (!(fabs((double)values[i] - expected[i]) <= 0x1p-20 * fabs(expected[i])))
            fail_msg("at (%.9g, %.9g): %.9g instead of %.9g", exact[3 * i], exact[3 * i + 1], (double)values[i],
                     expected[i]);
    hewn_code_destroy(own->device, &code);
    hewn_field_destroy(&field);
}

/* A wheel with more sides around its middle than a loop may have is walked over as before. */
static void crowded_outlines_have_no_table(void **state)
{
    fixture *own = *state;
    hewn_field *field;
    hewn_code *code;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    hewn_node root = hewn_regular_polygon(field, 1000, 1);
    GPU_TEST_TRY(hewn_code_create_as(own->device, field, root, &(hewn_code_desc){0}, &code, &error));
    assert_true(code->listing.table_count == 0 && code->listing.count > 1000);
    hewn_code_destroy(own->device, &code);
    hewn_field_destroy(&field);
}

static int set_up(void **state)
{
    static fixture own;
    own.device = gpu_test_open(&own.messages);
    own.random = (random_state){19};
    *state = &own;
    return 0;
}

static int tear_down(void **state)
{
    fixture *own = *state;
    gpu_test_close(&own->device, &own->messages);
    return 0;
}

static hewn_triangles mesh_of(fixture *state, hewn_field *field, hewn_node root, const hewn_code_desc *how)
{
    const hewn_extract_desc desc = {
        .bounds = {{-1.6, -1.5, -1.55}, {1.5, 1.6, 1.55}}, .resolution = 50, .method = HEWN_METHOD_DC};
    bool listed = how->chained && how->evaluation != HEWN_EVALUATION_STRAIGHT;
    hewn_extractor *extractor;
    hewn_triangles mesh;
    GPU_TEST_TRY(hewn_extractor_create_as(state->device, field, root, how, &extractor, &error));
    assert_true(hewn_code_is_listed(extractor->code) == listed);
    GPU_TEST_TRY(hewn_extract(extractor, &desc, &mesh, NULL, &error));
    hewn_extractor_destroy(&extractor);
    return mesh;
}

/* As read from a table, and from a chain of sides that lists walk over or, for `ways` of 3, that is written out too. */
static void check_meshes(fixture *state, hewn_field *field, hewn_node root, int ways)
{
    const hewn_code_desc hows[] = {{0}, {.chained = true}, {.chained = true, .evaluation = HEWN_EVALUATION_STRAIGHT}};
    hewn_triangles whole = mesh_of(state, field, root, &hows[0]);
    assert_true(whole.vertex_count > 1000);
    for (int i = 1; i < ways; i++) {
        hewn_triangles mesh = mesh_of(state, field, root, &hows[i]);
        assert_true(mesh.vertex_count == whole.vertex_count && mesh.triangle_count == whole.triangle_count);
        assert_memory_equal(mesh.positions, whole.positions, 12 * whole.vertex_count);
        assert_memory_equal(mesh.normals, whole.normals, 12 * whole.vertex_count);
        assert_memory_equal(mesh.indices, whole.indices, 12 * whole.triangle_count);
        hewn_triangles_destroy(&mesh);
    }
    hewn_triangles_destroy(&whole);
}

static void meshes_have_the_same_bytes(void **test_state)
{
    fixture *state = *test_state;
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    hewn_node wheel = hewn_extrude(field, hewn_star(field, 40, 1.2, 0.9), 0.5);
    hewn_node root = hewn_difference(field, wheel, hewn_extrude(field, hewn_regular_polygon(field, 6, 0.5), 1));
    GPU_TEST_TRY(hewn_field_status(field, &error));
    check_meshes(state, field, root, 3);
    hewn_field_destroy(&field);
}

static void letters_have_the_same_bytes(void **test_state)
{
    fixture *state = *test_state;
    const char *source = getenv("HEWN_SOURCE");
    char path[4096];
    hewn_font *font;
    hewn_field *field;
    snprintf(path, sizeof path, "%s/assets/scenes/fonts/DejaVuSerif-Bold.ttf", source ? source : ".");
    GPU_TEST_TRY(hewn_font_open(path, 0, &font, &error));
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    const hewn_text_desc desc = {.size = 0.9, .anchor = HEWN_TEXT_MIDDLE, .align = HEWN_ALIGN_CENTER};
    hewn_node letters = hewn_extrude(field, hewn_font_text(field, font, "Rg&8", &desc), 0.4);
    GPU_TEST_TRY(hewn_field_status(field, &error));
    check_meshes(state, field, letters, 2);
    hewn_field_destroy(&field);
    hewn_font_destroy(&font);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_give_the_bits_of_all_sides), cmocka_unit_test(far_away_is_outside),
        cmocka_unit_test(crowded_outlines_have_no_table), cmocka_unit_test(meshes_have_the_same_bytes),
        cmocka_unit_test(letters_have_the_same_bytes)};
    return cmocka_run_group_tests_name("outline_tables", tests, set_up, tear_down);
}
