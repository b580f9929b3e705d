/* Features thinner than a cell against a serial twin: cells beyond the neighbourhood of the surface by brute force, the
 * CPU's intervals and dense samples. What dense samples find is marked; what the CPU's intervals exclude is not. */
#include <math.h>
#include <string.h>

#include "../oracle/remote.h"
#include "gpu_test_device.h"
#include "hewn/hewn.h"
#include "iso/extractor.h"

typedef struct subject {
    hewn_field *field;
    hewn_node root;
    hewn_extractor *extractor;
} subject;

static subject begin_subject(void)
{
    subject made = {0};
    GPU_TEST_TRY(hewn_field_create(&made.field, &error));
    return made;
}

static void compile(subject *made, hewn_node root)
{
    made->root = root;
    GPU_TEST_TRY(hewn_field_status(made->field, &error));
    GPU_TEST_TRY(hewn_extractor_create(device, made->field, root, &made->extractor, &error));
}

static void free_subject(subject *made)
{
    hewn_extractor_destroy(&made->extractor);
    hewn_field_destroy(&made->field);
}

/* --- what the device says ----------------------------------------------------------------------------------------- */

typedef struct answer {
    struct hewn_grid grid;
    hewn_box grown;
    size_t cell_count;
    bool *inside;  /* samples */
    bool *remote;  /* cells, by the twin */
    bool *suspect; /* cells, by the device */
    hewn_suspects suspects;
    bool surface; /* there is some */
} answer;

static size_t cell_index(const struct hewn_grid *grid, const uint32_t at[3])
{
    return at[0] + (size_t)grid->cells[0] * (at[1] + (size_t)grid->cells[1] * at[2]);
}

static void place_of(const struct hewn_grid *grid, size_t index, uint32_t at[3])
{
    at[0] = (uint32_t)(index % grid->cells[0]);
    at[1] = (uint32_t)(index / grid->cells[0] % grid->cells[1]);
    at[2] = (uint32_t)(index / grid->cells[0] / grid->cells[1]);
}

static void read_marks(const hewn_bricks *bricks, hewn_workspace *workspace, answer *out)
{
    hewn_buffer *list, *marks;
    uint64_t list_bytes = (uint64_t)4 * bricks->count, mark_bytes = HEWN_BRICK_WORDS * list_bytes;
    GPU_TEST_TRY(hewn_workspace_take(workspace, "list", list_bytes, HEWN_BUFFER_READBACK, &list, &error));
    GPU_TEST_TRY(hewn_workspace_take(workspace, "marks", mark_bytes, HEWN_BUFFER_READBACK, &marks, &error));
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(device, &commands, &error));
    hewn_commands_copy(commands, bricks->list, 0, list, 0, list_bytes);
    hewn_commands_copy(commands, out->suspects.marks, 0, marks, 0, mark_bytes);
    GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
    const uint32_t *packed = list->mapped, *words = marks->mapped;
    for (uint64_t bit = 0; bit < (uint64_t)512 * bricks->count; bit++) {
        if (!(words[bit / 32] >> bit % 32 & 1u))
            continue;
        uint32_t brick = packed[bit / 512], block = (uint32_t)(bit / 64 % 8), number = (uint32_t)(bit % 64), at[3];
        for (uint32_t axis = 0; axis < 3; axis++) {
            uint32_t in_block = (number >> axis & 1u) + 2 * (number >> (axis + 3) & 1u);
            at[axis] = 8 * (brick >> 10 * axis & 1023u) + 4 * (block >> axis & 1u) + in_block;
            assert_true(at[axis] < out->grid.cells[axis]);
        }
        out->suspect[cell_index(&out->grid, at)] = true;
    }
}

static float sample_at(const struct hewn_grid *grid, int axis, uint32_t i)
{
    float offset = grid->cell * (float)(i > grid->rim ? i - grid->rim : 0);
    return i + grid->rim >= grid->cells[axis] ? grid->far[axis] : grid->origin[axis] + offset;
}

/* The rim of an open dual grid has no thickness, and nothing to look for. */
static void leave_rim_out(answer *out)
{
    for (size_t i = 0; i < out->cell_count; i++) {
        uint32_t at[3];
        place_of(&out->grid, i, at);
        for (int axis = 0; axis < 3; axis++)
            if (at[axis] < out->grid.rim || at[axis] + out->grid.rim >= out->grid.cells[axis])
                out->remote[i] = false;
    }
}

static void take_samples(const subject *made, answer *out)
{
    const struct hewn_grid *grid = &out->grid;
    size_t side[3] = {grid->cells[0] + 1, grid->cells[1] + 1, grid->cells[2] + 1}, count = side[0] * side[1] * side[2];
    float *points = malloc(count * 3 * sizeof *points), *values = malloc(count * sizeof *values);
    out->inside = malloc(count * sizeof *out->inside);
    bool *bound = calloc(count, sizeof *bound);
    for (size_t i = 0; i < count; i++) {
        uint32_t at[3] = {(uint32_t)(i % side[0]), (uint32_t)(i / side[0] % side[1]),
                          (uint32_t)(i / side[0] / side[1])};
        for (int axis = 0; axis < 3; axis++) {
            points[3 * i + (size_t)axis] = sample_at(grid, axis, at[axis]);
            bound[i] |= !grid->open && (at[axis] == 0 || at[axis] == grid->cells[axis]);
        }
    }
    GPU_TEST_TRY(hewn_code_eval_points(device, made->extractor->code, points, count, values, &error));
    for (size_t i = 0; i < count; i++)
        out->inside[i] = values[i] < 0 && !bound[i];
    free(points);
    free(values);
    free(bound);
}

static answer ask(const subject *made, const hewn_extract_desc *desc)
{
    answer out = {0};
    hewn_workspace workspace = {.device = device};
    hewn_bricks bricks = {0};
    hewn_surface surface = {0};
    GPU_TEST_TRY(hewn_grid_lay(desc, &out.grid, &out.grown, &error));
    out.cell_count = (size_t)out.grid.cells[0] * out.grid.cells[1] * out.grid.cells[2];
    out.remote = calloc(out.cell_count, sizeof *out.remote);
    out.suspect = calloc(out.cell_count, sizeof *out.suspect);
    GPU_TEST_TRY(hewn_bricks_cull(made->extractor, &out.grid, &workspace, &bricks, &error));
    if (bricks.count > 0) {
        GPU_TEST_TRY(hewn_surface_classify(made->extractor, &out.grid, &bricks, &workspace, &surface, &error));
        GPU_TEST_TRY(
            hewn_suspects_find(made->extractor, &out.grid, &bricks, &surface, &workspace, &out.suspects, &error));
        read_marks(&bricks, &workspace, &out);
    }
    out.surface = surface.vertex_count > 0;
    hewn_workspace_clear(&workspace);
    take_samples(made, &out);
    oracle_remote(out.grid.cells, out.inside, out.remote);
    leave_rim_out(&out);
    return out;
}

static void free_answer(answer *out)
{
    free(out->inside);
    free(out->remote);
    free(out->suspect);
}

/* --- what is true ------------------------------------------------------------------------------------------------- */

static hewn_box part_of(const answer *got, const uint32_t at[3], uint32_t part, uint32_t parts)
{
    uint32_t place[3] = {part % parts, part / parts % parts, part / parts / parts};
    hewn_box box;
    for (int axis = 0; axis < 3; axis++) {
        double lo = (double)sample_at(&got->grid, axis, at[axis]),
               hi = (double)sample_at(&got->grid, axis, at[axis] + 1);
        box.lo[axis] = lo + (hi - lo) * place[axis] / parts;
        box.hi[axis] = lo + (hi - lo) * (place[axis] + 1) / parts;
    }
    return box;
}

static bool sample_inside(const answer *got, const uint32_t at[3])
{
    const uint32_t *cells = got->grid.cells;
    return got->inside[at[0] + (size_t)(cells[0] + 1) * (at[1] + (size_t)(cells[1] + 1) * at[2])];
}

/* Whether an interval says that the cell's sign goes through all of the box, with room for float's rounding. */
static bool excludes(const subject *made, const hewn_box *box, bool inside, double slack)
{
    hewn_interval range;
    GPU_TEST_TRY(hewn_field_bound(made->field, made->root, box, &range, &error));
    return !range.maybe_nan && (inside ? range.hi < -slack : range.lo >= slack);
}

static bool all_parts_exclude(const subject *made, const answer *got, const uint32_t at[3], double slack)
{
    for (uint32_t part = 0; part < 64; part++) {
        hewn_box box = part_of(got, at, part, 4);
        if (!excludes(made, &box, sample_inside(got, at), slack))
            return false;
    }
    return true;
}

enum { DENSE = 10 };

static bool samples_differ(const subject *made, const answer *got, const uint32_t at[3], double slack)
{
    double points[DENSE * DENSE * DENSE][3], values[DENSE * DENSE * DENSE];
    for (uint32_t i = 0; i < DENSE * DENSE * DENSE; i++) {
        hewn_box box = part_of(got, at, i, DENSE);
        for (int axis = 0; axis < 3; axis++)
            points[i][axis] = (box.lo[axis] + box.hi[axis]) / 2;
    }
    GPU_TEST_TRY(hewn_field_eval(made->field, made->root, points[0], DENSE * DENSE * DENSE, values, &error));
    for (uint32_t i = 0; i < DENSE * DENSE * DENSE; i++)
        if (sample_inside(got, at) ? values[i] > slack : values[i] < -slack)
            return true;
    return false;
}

/* Holds an answer against what is true; returns how many cells dense samples found. `slack` is for rounding. */
static size_t check_answer(const subject *made, const answer *got, double slack)
{
    size_t count = 0, found = 0, first = got->cell_count;
    for (size_t i = 0; i < got->cell_count; i++) {
        uint32_t at[3];
        place_of(&got->grid, i, at);
        count += got->suspect[i];
        first = got->suspect[i] && first == got->cell_count ? i : first;
        if (!got->remote[i]) {
            assert_false(got->suspect[i]);
            continue;
        }
        hewn_box box = part_of(got, at, 0, 1);
        if (excludes(made, &box, sample_inside(got, at), slack)) {
            if (got->suspect[i])
                fail_msg("the cell at (%u, %u, %u) is no suspect", at[0], at[1], at[2]);
        } else if (samples_differ(made, got, at, slack)) {
            found++;
            if (!got->suspect[i])
                fail_msg("the cell at (%u, %u, %u) holds surface and is not marked", at[0], at[1], at[2]);
        } else if (got->suspect[i] && all_parts_exclude(made, got, at, slack)) {
            fail_msg("no part of the cell at (%u, %u, %u) holds surface", at[0], at[1], at[2]);
        }
    }
    assert_int_equal(count, got->suspects.cells);
    if (count > 0) {
        const uint32_t *at = got->suspects.first, rim = got->grid.rim;
        assert_int_equal(cell_index(&got->grid, (uint32_t[3]){at[0] + rim, at[1] + rim, at[2] + rim}), first);
    }
    return found;
}

static const hewn_box unit_cube = {{-1, -1, -1}, {1, 1, 1}};
static const double slack = 2e-6;

/* Every cell through which the segment from `a` to `b` goes, and that is remote, must be marked: it lies inside the
 * feature, however thin that is. */
static size_t check_segment(const answer *got, const double a[3], const double b[3])
{
    size_t marked = 0;
    for (int step = 0; step <= 4000; step++) {
        uint32_t at[3];
        for (int axis = 0; axis < 3; axis++) {
            double place = a[axis] + (b[axis] - a[axis]) * step / 4000;
            double cell = (place - (double)got->grid.origin[axis]) / (double)got->grid.cell;
            at[axis] = (uint32_t)floor(cell) + got->grid.rim;
        }
        size_t index = cell_index(&got->grid, at);
        if (got->remote[index] && !got->suspect[index])
            fail_msg("the cell at (%u, %u, %u) is passed and not marked", at[0], at[1], at[2]);
        marked += got->remote[index];
    }
    return marked;
}

/* --- cases -------------------------------------------------------------------------------------------------------- */

typedef hewn_node maker(hewn_field *field);

static hewn_node body(hewn_field *field)
{
    return hewn_translate(field, hewn_sphere(field, 0.25), -0.6, -0.6, -0.6);
}

static hewn_node make_plate(hewn_field *field)
{
    return hewn_union(field, body(field),
                      hewn_translate(field, hewn_box_shape(field, 0.9, 0.002, 0.9), 0.2, 0.234, 0.1));
}

static hewn_node make_tilted_plate(hewn_field *field)
{
    hewn_node plate = hewn_rotate(field, hewn_box_shape(field, 0.9, 0.0003, 0.9), 1, 0.3, 0.7, 0.4);
    return hewn_union(field, body(field), hewn_translate(field, plate, 0.2, 0.23, 0.1));
}

static hewn_node make_wire(hewn_field *field)
{
    return hewn_union(field, body(field), hewn_translate(field, hewn_capsule(field, 1e-3, 1.2), 0.31, 0, 0.317));
}

static hewn_node make_needle(hewn_field *field)
{
    return hewn_union(field, body(field), hewn_translate(field, hewn_cone(field, 0.06, 0, 1.2), 0.31, 0, 0.317));
}

static hewn_node make_dust(hewn_field *field)
{
    return hewn_union(field, body(field), hewn_translate(field, hewn_sphere(field, 1e-4), 0.311, 0.13, 0.217));
}

/* A fin of which most is too thin for the grid starts at the body. */
static hewn_node make_fin(hewn_field *field)
{
    return hewn_union(field, body(field),
                      hewn_translate(field, hewn_box_shape(field, 1.4, 0.001, 0.2), 0.1, -0.587, -0.6));
}

/* A crack inside a solid: cells inside that are not. */
static hewn_node make_crack(hewn_field *field)
{
    return hewn_difference(field, hewn_box_shape(field, 1.8, 1.8, 1.8),
                           hewn_translate(field, hewn_box_shape(field, 0.9, 0.002, 0.9), 0.04, 0.234, 0.1));
}

static const struct {
    const char *name;
    maker *make;
    double a[3], b[3]; /* a line through the feature */
} cases[] = {
    {"plate", make_plate, {-0.2, 0.234, -0.3}, {0.6, 0.234, 0.5}},
    {"tilted plate", make_tilted_plate, {0.2, 0.23, 0.1}, {0.2, 0.23, 0.1}},
    {"wire", make_wire, {0.31, -0.6, 0.317}, {0.31, 0.6, 0.317}},
    {"needle", make_needle, {0.31, -0.5, 0.317}, {0.31, 0.599, 0.317}},
    {"dust", make_dust, {0.311, 0.13, 0.217}, {0.311, 0.13, 0.217}},
    {"fin", make_fin, {-0.5, -0.587, -0.6}, {0.79, -0.587, -0.6}},
    {"crack", make_crack, {-0.3, 0.234, -0.3}, {0.4, 0.234, 0.5}},
};

static void test_thin_features_are_marked(void **state)
{
    (void)state;
    static const uint32_t resolutions[] = {31, 40};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        subject made = begin_subject();
        compile(&made, cases[i].make(made.field));
        for (size_t r = 0; r < sizeof resolutions / sizeof *resolutions; r++)
            for (int open = 0; open < 2; open++) {
                hewn_extract_desc desc = {.bounds = unit_cube, .resolution = resolutions[r], .open = open};
                answer got = ask(&made, &desc);
                size_t found = check_answer(&made, &got, slack);
                size_t passed = check_segment(&got, cases[i].a, cases[i].b);
                if (passed + found == 0 || got.suspects.cells < found)
                    fail_msg("%s at %u: %zu on the line, %zu found", cases[i].name, resolutions[r], passed, found);
                free_answer(&got);
            }
        free_subject(&made);
    }
}

static void test_what_is_thick_is_not(void **state)
{
    (void)state;
    subject made = begin_subject();
    hewn_node ring = hewn_rotate(made.field, hewn_torus(made.field, 0.6, 0.17), 1, 2, 0.5, 0.7);
    hewn_node peg = hewn_rotate(made.field, hewn_capsule(made.field, 0.2, 0.9), 0, 0, 1, 1.1);
    hewn_node both = hewn_smooth_union(made.field, ring, peg, HEWN_BLEND_QUADRATIC, 0.2);
    compile(&made,
            hewn_difference(made.field, both, hewn_translate(made.field, hewn_sphere(made.field, 0.3), 0.1, 0.3, 0.4)));
    for (uint32_t resolution = 30; resolution <= 150; resolution += 40) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = resolution};
        hewn_triangles mesh;
        hewn_extract_stats stats;
        GPU_TEST_TRY(hewn_extract(made.extractor, &desc, &mesh, &stats, &error));
        assert_int_equal(stats.suspect_cells, 0);
        assert_int_equal(stats.undefined_cells, 0);
        hewn_triangles_destroy(&mesh);
    }
    free_subject(&made);
}

/* Bodies, plates, wires and dust at random places, sizes and turns, added and taken away. */
static hewn_node random_shape(hewn_field *field, uint64_t *seed)
{
    double u[9];
    for (int i = 0; i < 9; i++)
        u[i] = gpu_test_random(seed) / 4294967296.0;
    double thin = 0.03 * pow(10, -3 * u[0]), size = 0.2 + 0.8 * u[1];
    hewn_node shape = HEWN_NODE_NONE;
    switch (gpu_test_random(seed) % 5) {
    case 0: shape = hewn_box_shape(field, size, thin, 0.5 * size); break;
    case 1: shape = hewn_capsule(field, thin, size); break;
    case 2: shape = hewn_cone(field, 0.2 * size, 0, size); break;
    case 3: shape = hewn_sphere(field, thin); break;
    default: shape = hewn_rounded_box(field, 0.5 * size, 0.4 * size, 0.3 * size, 0.05 * size); break;
    }
    shape = hewn_rotate(field, shape, u[2] - 0.5, u[3] - 0.5, u[4] + 0.01, 6 * u[5]);
    return hewn_translate(field, shape, 1.6 * u[6] - 0.8, 1.6 * u[7] - 0.8, 1.6 * u[8] - 0.8);
}

static void check_random(uint64_t *seed)
{
    subject made = begin_subject();
    hewn_node root = hewn_box_shape(made.field, 0.6, 0.6, 0.6);
    uint32_t count = 2 + gpu_test_random(seed) % 5;
    for (uint32_t i = 0; i < count; i++) {
        hewn_node shape = random_shape(made.field, seed);
        root = gpu_test_random(seed) % 3 == 0 ? hewn_difference(made.field, root, shape)
                                              : hewn_union(made.field, root, shape);
    }
    compile(&made, root);
    hewn_extract_desc desc = {.bounds = {{-1, -0.8, -0.7}, {1, 0.6, 0.9}},
                              .resolution = 12 + gpu_test_random(seed) % 28,
                              .open = gpu_test_random(seed) % 2};
    answer got = ask(&made, &desc);
    check_answer(&made, &got, slack);
    free_answer(&got);
    free_subject(&made);
}

static void test_random_scenes(void **state)
{
    (void)state;
    uint64_t seed = 2024;
    uint32_t scenes = gpu_test_long() ? 400 : 12;
    for (uint32_t i = 0; i < scenes; i++)
        check_random(&seed);
}

/* --- bounds, NaN, no surface -------------------------------------------------------------------------------------- */

/* Closed, the outermost samples are outside: what lies between them and the next ones inside the bounds is lost. */
static void test_slivers_at_the_bounds(void **state)
{
    (void)state;
    subject made = begin_subject();
    hewn_node floor_at = hewn_plane(made.field, 0, 0, 1, -0.99);
    compile(&made, hewn_union(made.field, body(made.field), floor_at));
    for (int open = 0; open < 2; open++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 32, .open = open};
        answer got = ask(&made, &desc);
        check_answer(&made, &got, slack);
        assert_true(open ? got.suspects.cells == 0 : got.suspects.cells > 500);
        assert_true(open || got.suspects.first[2] == 0);
        free_answer(&got);
    }
    free_subject(&made);
}

static void test_undefined_cells_are_told_apart(void **state)
{
    (void)state;
    subject made = begin_subject();
    hewn_node root = hewn_sqrt(made.field, hewn_add(made.field, hewn_x(made.field), hewn_constant(made.field, 0.5)));
    root = hewn_sub(made.field, root, hewn_constant(made.field, 0.9)); /* NaN up to -0.5, inside up to 0.31 */
    compile(&made, root);
    const hewn_method methods[] = {HEWN_METHOD_MARCHING_CUBES, HEWN_METHOD_DC}; /* the second has a rim */
    for (uint32_t i = 0; i < 2; i++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 32, .open = true, .method = methods[i]};
        answer got = ask(&made, &desc);
        uint64_t expected = 0;
        for (size_t cell = 0; cell < got.cell_count; cell++) {
            uint32_t at[3];
            place_of(&got.grid, cell, at);
            expected += got.remote[cell] && at[0] < 8 + got.grid.rim;
        }
        assert_int_equal(got.suspects.cells, 0);
        assert_int_equal(got.grid.rim, i);
        assert_true(expected == (4 + i) * 32 * 32); /* blocks are counted from the rim */
        assert_int_equal(got.suspects.undefined, expected);
        free_answer(&got);
    }
    free_subject(&made);
}

static void test_the_place_where_all_is_lost(void **state)
{
    (void)state;
    subject made = begin_subject();
    compile(&made, hewn_translate(made.field, hewn_sphere(made.field, 1e-3), 0.311, 0.13, 0.217));
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 32};
    hewn_triangles mesh;
    hewn_error error = {0};
    assert_int_equal(hewn_extract(made.extractor, &desc, &mesh, NULL, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "something thinner than a cell may be near (0.28125, 0.15625, 0.21875)"));
    free_subject(&made);
}

/* --- the same wherever it stands ---------------------------------------------------------------------------------- */

/* Moved by whole blocks of two cells against the bricks, the same cells are marked. */
static void test_bricks_have_no_say(void **state)
{
    (void)state;
    uint64_t counts[5];
    for (uint32_t shift = 0; shift < 5; shift++) {
        subject made = begin_subject();
        hewn_node plate = hewn_rotate(made.field, hewn_box_shape(made.field, 0.9, 1.0 / 4096, 0.9), 1, 0, 0, 0.4);
        compile(&made, hewn_union(made.field, body(made.field), hewn_translate(made.field, plate, 0.2, 0.25, 0.1)));
        double start = -1 - shift / 8.0; /* two cells of 1/16 */
        hewn_extract_desc desc = {.bounds = {{start, start, start}, {1, 1, 1}}, .cell = 1.0 / 16};
        answer got = ask(&made, &desc);
        counts[shift] = got.suspects.cells;
        check_answer(&made, &got, slack);
        free_answer(&got);
        free_subject(&made);
    }
    assert_true(counts[0] > 20);
    for (uint32_t shift = 1; shift < 5; shift++)
        assert_int_equal(counts[shift], counts[0]);
}

static void test_the_same_each_time(void **state)
{
    (void)state;
    subject made = begin_subject();
    compile(&made, make_tilted_plate(made.field));
    hewn_extract_stats stats[3];
    for (int i = 0; i < 3; i++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 64};
        hewn_triangles mesh;
        GPU_TEST_TRY(hewn_extract(made.extractor, &desc, &mesh, &stats[i], &error));
        hewn_triangles_destroy(&mesh);
        assert_true(stats[i].suspect_cells > 0);
        assert_int_equal(stats[i].suspect_cells, stats[0].suspect_cells);
        assert_memory_equal(&stats[i].first_suspect, &stats[0].first_suspect, sizeof stats[0].first_suspect);
    }
    free_subject(&made);
}

/* Where every cell straddles and no part of any does: work has a bound, and the search ends. */
static void test_hostile_fields_end(void **state)
{
    (void)state;
    subject made = begin_subject();
    hewn_node x = hewn_x(made.field), y = hewn_y(made.field), z = hewn_z(made.field);
    hewn_node k = hewn_constant(made.field, 40);
    hewn_node a = hewn_sin(made.field, hewn_mul(made.field, k, hewn_add(made.field, x, hewn_add(made.field, y, z))));
    /* a + 1.001 - a + tiny body: its intervals are as wide as sine's are. */
    hewn_node loose = hewn_sub(made.field, hewn_add(made.field, a, hewn_constant(made.field, 1.001)), a);
    compile(&made, hewn_union(made.field, loose, body(made.field)));
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 24};
    answer got = ask(&made, &desc);
    check_answer(&made, &got, slack);
    free_answer(&got);
    free_subject(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_thin_features_are_marked),
        cmocka_unit_test(test_what_is_thick_is_not),
        cmocka_unit_test(test_random_scenes),
        cmocka_unit_test(test_slivers_at_the_bounds),
        cmocka_unit_test(test_undefined_cells_are_told_apart),
        cmocka_unit_test(test_the_place_where_all_is_lost),
        cmocka_unit_test(test_bricks_have_no_say),
        cmocka_unit_test(test_the_same_each_time),
        cmocka_unit_test(test_hostile_fields_end),
    };
    return cmocka_run_group_tests_name("suspects", tests, open_device, close_device);
}
