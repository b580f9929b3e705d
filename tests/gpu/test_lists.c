/* Fields in lists: pruned or not, walked over or compiled straight, a field gives the same mesh byte for byte; and what
 * the samples of a grid say of its signs is all in the mesh. */
#include "gpu_test.h"

#include <math.h>

#include "eval/listing.h"
#include "hewn/hewn.h"
#include "iso/extractor.h"

typedef struct shrub {
    hewn_field *field;
    hewn_node root;
} shrub;

static double between(uint64_t *random, double lo, double hi)
{
    return lo + (hi - lo) * ((double)gpu_test_random(random) / 4294967296.0);
}

/* --- trees ------------------------------------------------------------------------------------------------------- */

enum { POOL = 6 };

/* Shapes at random, and subtrees that are used again. */
typedef struct grower {
    hewn_field *field;
    uint64_t *random;
    double size;
    hewn_node pool[POOL];
    uint32_t pooled;
} grower;

static hewn_node grow_leaf(grower *own)
{
    hewn_field *field = own->field;
    uint64_t *random = own->random;
    double size = own->size * between(random, 0.6, 1.6);
    hewn_node shape;
    switch (gpu_test_random(random) % 3) {
    case 0: shape = hewn_sphere(field, 0.5 * size); break;
    case 1: shape = hewn_box_shape(field, size, size * between(random, 0.3, 1), size * between(random, 0.3, 1)); break;
    default: shape = hewn_torus(field, 0.5 * size, 0.15 * size);
    }
    shape = hewn_rotate(field, shape, between(random, 0.1, 1), between(random, 0.1, 1), between(random, 0.1, 1),
                        between(random, 0.2, 1.2));
    return hewn_translate(field, shape, between(random, -0.9, 0.9), between(random, -0.9, 0.9),
                          between(random, -0.9, 0.9));
}

static hewn_node combine(grower *own, hewn_node a, hewn_node b)
{
    hewn_field *field = own->field;
    double size = own->size * between(own->random, 0.05, 0.5);
    switch (gpu_test_random(own->random) % 10) {
    case 0: return hewn_difference(field, a, b);
    case 1: return hewn_smooth_difference(field, a, b, HEWN_BLEND_QUADRATIC, size);
    case 2: return hewn_smooth_union(field, a, b, HEWN_BLEND_CUBIC, size);
    case 3: return hewn_smooth_union(field, a, b, HEWN_BLEND_CIRCULAR, size);
    case 4: return hewn_smooth_union(field, a, b, HEWN_BLEND_EXPONENTIAL, 10 / size);
    case 5: return hewn_add(field, hewn_union(field, a, b), hewn_constant(field, 0.1 * size));
    case 6:
    case 7: return hewn_smooth_union(field, a, b, HEWN_BLEND_QUADRATIC, size);
    default: return hewn_union(field, a, b);
    }
}

static hewn_node grow(grower *own, uint32_t leaves)
{
    if (own->pooled >= POOL && gpu_test_random(own->random) % 16 == 0)
        return own->pool[gpu_test_random(own->random) % POOL];
    if (leaves <= 1)
        return grow_leaf(own);
    uint32_t left = 1 + gpu_test_random(own->random) % (leaves - 1);
    hewn_node a = grow(own, left);
    hewn_node made = combine(own, a, grow(own, leaves - left));
    own->pool[own->pooled++ % POOL] = made;
    return made;
}

static shrub make_shrub(uint64_t seed, uint32_t leaves)
{
    shrub made;
    uint64_t random = seed * 0x9e3779b97f4a7c15u + 1;
    GPU_TEST_TRY(hewn_field_create(&made.field, &error));
    grower own = {.field = made.field, .random = &random, .size = 1.6 / cbrt((double)leaves)};
    made.root = grow(&own, leaves);
    GPU_TEST_TRY(hewn_field_status(made.field, &error));
    return made;
}

/* --- meshes ------------------------------------------------------------------------------------------------------ */

/* All of the trees, or with many cells a bar through them, which has several levels of culling. */
static hewn_box bounds_for(uint32_t resolution)
{
    const hewn_box all = {{-1.1, -1, -1.05}, {1, 1.1, 1.05}}, bar = {{-1.1, -0.2, -0.13}, {1.05, 0.15, 0.2}};
    return resolution > 128 ? bar : all;
}

/* HEWN_BAD_INPUT (no surface in the grid) gives an empty mesh. */
static hewn_triangles mesh_with(hewn_extractor *extractor, uint32_t resolution, hewn_method method)
{
    const hewn_extract_desc desc = {.bounds = bounds_for(resolution), .resolution = resolution, .method = method};
    hewn_triangles triangles;
    hewn_error error = {0};
    if (hewn_extract(extractor, &desc, &triangles, NULL, &error) != HEWN_OK && error.code != HEWN_BAD_INPUT)
        fail_msg("%s", error.message);
    return triangles;
}

static bool same_mesh(const hewn_triangles *a, const hewn_triangles *b)
{
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           (a->vertex_count == 0 || (memcmp(a->positions, b->positions, 12 * a->vertex_count) == 0 &&
                                     memcmp(a->normals, b->normals, 12 * a->vertex_count) == 0 &&
                                     memcmp(a->indices, b->indices, 12 * a->triangle_count) == 0));
}

static hewn_extractor *make_extractor(hewn_device *device, const shrub *from, hewn_evaluation evaluation, bool whole)
{
    hewn_extractor *extractor;
    const hewn_code_desc desc = {.evaluation = evaluation, .whole = whole};
    GPU_TEST_TRY(hewn_extractor_create_as(device, from->field, from->root, &desc, &extractor, &error));
    return extractor;
}

/* How many grid edges have ends of different signs, from dense samples of the whole field; a closed grid's outermost
 * samples are outside. */
static uint64_t count_crossings(hewn_extractor *extractor, uint32_t resolution)
{
    struct hewn_grid grid;
    hewn_box grown;
    const hewn_extract_desc desc = {.bounds = bounds_for(resolution), .resolution = resolution};
    GPU_TEST_TRY(hewn_grid_lay(&desc, &grid, &grown, &error));
    size_t side[3] = {grid.cells[0] + 1, grid.cells[1] + 1, grid.cells[2] + 1}, count = side[0] * side[1] * side[2];
    float *points = malloc(count * 3 * sizeof *points), *values = malloc(count * sizeof *values);
    assert_true(points && values);
    for (size_t i = 0; i < count; i++) {
        size_t at[3] = {i % side[0], i / side[0] % side[1], i / side[0] / side[1]};
        for (int axis = 0; axis < 3; axis++) {
            float offset = grid.cell * (float)at[axis];
            points[3 * i + (size_t)axis] = at[axis] == grid.cells[axis] ? grid.far[axis] : grid.origin[axis] + offset;
        }
    }
    GPU_TEST_TRY(hewn_code_eval_points(extractor->device, extractor->code, points, count, values, &error));
    uint64_t crossings = 0;
    const size_t step[3] = {1, side[0], side[0] * side[1]};
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++)
            if (i / step[axis] % side[axis] + 1 < side[axis]) {
                bool inside[2];
                for (int end = 0; end < 2; end++) {
                    size_t at = i + (end ? step[axis] : 0);
                    inside[end] = values[at] < 0;
                    for (int a = 0; a < 3; a++)
                        if (at / step[a] % side[a] == 0 || at / step[a] % side[a] == grid.cells[a])
                            inside[end] = false;
                }
                crossings += inside[0] != inside[1];
            }
    free(points);
    free(values);
    return crossings;
}

/* --- tests ------------------------------------------------------------------------------------------------------- */

/* One code serves all trees of its kinds, so that nothing is compiled on the way: a large tree has nearly all kinds. By
 * dual contouring places beyond bricks are asked about too. */
static void pruned_trees_are_whole_ones(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    shrub pattern = make_shrub(7, 600);
    hewn_extractor *pruned = make_extractor(device, &pattern, HEWN_EVALUATION_LISTED, false);
    hewn_extractor *whole = make_extractor(device, &pattern, HEWN_EVALUATION_LISTED, true);
    assert_true(hewn_code_is_listed(pruned->code));
    const char *from = getenv("HEWN_SEED"); /* the first of them */
    uint32_t first = from ? (uint32_t)strtoul(from, NULL, 10) : 1;
    uint32_t trees = gpu_test_long() ? 10000 : 40, compared = 0;
    uint64_t vertices = 0;
    for (uint32_t i = first; i < first + trees; i++) {
        uint64_t random = i;
        shrub made = make_shrub(1000 + i, 2 + gpu_test_random(&random) % 100); /* up to about 200 nodes combine them */
        uint32_t resolution = i % 5 == 0 ? 150 : i % 5 == 1 ? 41 : 20;
        bool taken[2] = {false, false};
        GPU_TEST_TRY(hewn_extractor_renumber(pruned, made.field, made.root, &taken[0], &error));
        GPU_TEST_TRY(hewn_extractor_renumber(whole, made.field, made.root, &taken[1], &error));
        assert_int_equal(taken[0], taken[1]);
        if (taken[0]) {
            hewn_method method = i % 3 == 0 ? HEWN_METHOD_DC : HEWN_METHOD_MARCHING_CUBES;
            hewn_triangles a = mesh_with(pruned, resolution, method);
            hewn_triangles b = mesh_with(whole, resolution, method);
            if (!same_mesh(&a, &b))
                fail_msg("tree %u by %s is another one when pruned", i, hewn_method_name(method));
            if (i % 25 < 2 && i % 3 != 0 && count_crossings(pruned, resolution) != a.vertex_count)
                fail_msg("tree %u lost crossings", i);
            vertices += a.vertex_count;
            compared++;
            hewn_triangles_destroy(&a);
            hewn_triangles_destroy(&b);
        }
        hewn_field_destroy(&made.field);
        if (i % 500 == 0)
            print_message("# %u trees so far, up to tree %u\n", compared, i);
    }
    print_message("# %u of %u trees compared, %llu vertices\n", compared, trees, (unsigned long long)vertices);
    assert_true(compared > trees * 4 / 5);
    hewn_extractor_destroy(&pruned);
    hewn_extractor_destroy(&whole);
    hewn_field_destroy(&pattern.field);
    gpu_test_close(&device, &messages);
}

static void check_against_straight(hewn_device *device, const shrub *made, uint32_t resolution, hewn_method second,
                                   const char *what)
{
    hewn_extractor *listed = make_extractor(device, made, HEWN_EVALUATION_LISTED, false);
    hewn_extractor *straight = make_extractor(device, made, HEWN_EVALUATION_STRAIGHT, false);
    assert_true(hewn_code_is_listed(listed->code) && !hewn_code_is_listed(straight->code));
    const hewn_method methods[] = {HEWN_METHOD_MARCHING_CUBES, second, HEWN_METHOD_NETS};
    for (int i = 0; i < (gpu_test_long() ? 3 : 2); i++) {
        hewn_triangles a = mesh_with(listed, resolution, methods[i]);
        hewn_triangles b = mesh_with(straight, resolution, methods[i]);
        if (!same_mesh(&a, &b))
            fail_msg("%s by %s differs in lists: %llu vertices and %llu", what, hewn_method_name(methods[i]),
                     (unsigned long long)a.vertex_count, (unsigned long long)b.vertex_count);
        hewn_triangles_destroy(&a);
        hewn_triangles_destroy(&b);
    }
    hewn_extractor_destroy(&listed);
    hewn_extractor_destroy(&straight);
}

static void lists_are_straight_code(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    for (uint32_t i = 0; i < (gpu_test_long() ? 60u : 3u); i++) {
        char what[32];
        shrub made = make_shrub(50 + i, 3 + 9 * (i % 3));
        snprintf(what, sizeof what, "tree %u", i);
        check_against_straight(device, &made, 40, HEWN_METHOD_DC, what);
        hewn_field_destroy(&made.field);
    }
    gpu_test_close(&device, &messages);
}

/* Every operation there is: bodies of all kinds, slots that three operands come from, NaN and infinities on the way. */
static void odd_fields_are_straight_code(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    for (int which = 0; which < 4; which++) {
        shrub made;
        GPU_TEST_TRY(hewn_field_create(&made.field, &error));
        hewn_field *f = made.field;
        hewn_node x = hewn_x(f), y = hewn_y(f), z = hewn_z(f), k = hewn_constant(f, 7);
        hewn_node wave = hewn_mul(f, hewn_sin(f, hewn_mul(f, k, x)), hewn_cos(f, hewn_mul(f, k, y)));
        hewn_node far = hewn_sqrt(f, hewn_add(f, hewn_square(f, x), hewn_add(f, hewn_square(f, y), hewn_square(f, z))));
        hewn_node ball = hewn_sub(f, far, hewn_constant(f, 0.8));
        hewn_node bent = hewn_min(f, hewn_abs(f, x), hewn_max(f, y, z));
        switch (which) {
        case 0: made.root = hewn_max(f, hewn_sub(f, hewn_abs(f, wave), hewn_constant(f, 0.3)), ball); break;
        case 1: /* a shape whose coordinates all come from slots */
            made.root = hewn_min(
                f, hewn_remap(f, hewn_box_shape(f, 0.5, 0.6, 0.7), bent, hewn_max(f, x, bent), hewn_min(f, wave, z)),
                hewn_max(f, ball, x));
            break;
        case 2: /* the root of what is negative in places */
            made.root =
                hewn_min(f, hewn_sub(f, hewn_sqrt(f, x), hewn_constant(f, 0.5)), hewn_max(f, ball, hewn_ln(f, y)));
            break;
        default: /* a value used thrice, once beneath what drops it */
            made.root = hewn_max(f, hewn_min(f, bent, hewn_add(f, ball, bent)),
                                 hewn_sub(f, hewn_min(f, ball, bent), hewn_constant(f, 0.2)));
        }
        GPU_TEST_TRY(hewn_field_status(f, &error));
        char what[32];
        snprintf(what, sizeof what, "odd field %d", which);
        check_against_straight(device, &made, 50, HEWN_METHOD_MC33, what);
        hewn_field_destroy(&made.field);
    }
    gpu_test_close(&device, &messages);
}

/* The distance of a coordinate to the nearest of some planes, and a wave of it. */
static hewn_node comb(hewn_field *f, hewn_node t, int teeth)
{
    hewn_node nearest = hewn_abs(f, t);
    for (int i = 1; i < teeth; i++)
        nearest = hewn_min(f, nearest, hewn_abs(f, hewn_sub(f, t, hewn_constant(f, 0.31 * i - 0.8))));
    return nearest;
}

/* Straight code shares what depends on one coordinate along an edge, lists do not. One part is y's alone. */
static void axes_that_share_parts_are_straight_code(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    for (int which = 0; which < 2; which++) {
        shrub made;
        hewn_listing listing;
        GPU_TEST_TRY(hewn_field_create(&made.field, &error));
        hewn_field *f = made.field;
        hewn_node at[3] = {hewn_x(f), hewn_y(f), hewn_z(f)}, combs[3], sines[3], sizes[3];
        for (int k = 0; k < 3; k++) {
            combs[k] = comb(f, at[k], 9);
            sines[k] = hewn_sin(f, hewn_mul(f, at[k], hewn_constant(f, 5)));
            sizes[k] = hewn_abs(f, at[k]);
        }
        hewn_node bars = hewn_min(f, hewn_max(f, combs[0], combs[1]),
                                  hewn_min(f, hewn_max(f, combs[1], combs[2]), hewn_max(f, combs[2], combs[0])));
        hewn_node waves = hewn_add(f, hewn_mul(f, sines[0], sines[1]), hewn_mul(f, sines[1], sines[2]));
        hewn_node cube = hewn_sub(f, hewn_max(f, sizes[0], hewn_max(f, sizes[1], sizes[2])), hewn_constant(f, 0.93));
        hewn_node own = hewn_mul(f, hewn_exp(f, at[1]), hewn_constant(f, 0.01));
        made.root = hewn_max(f, cube, hewn_sub(f, hewn_add(f, bars, which == 0 ? own : waves), hewn_constant(f, 0.07)));
        GPU_TEST_TRY(hewn_field_status(f, &error));
        GPU_TEST_TRY(hewn_listing_create(&listing, f, made.root, false, &error));
        assert_true(listing.parted);
        hewn_listing_destroy(&listing);
        check_against_straight(device, &made, 40, HEWN_METHOD_DC, which == 0 ? "bars" : "waves");
        hewn_field_destroy(&made.field);
    }
    gpu_test_close(&device, &messages);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pruned_trees_are_whole_ones),
        cmocka_unit_test(lists_are_straight_code),
        cmocka_unit_test(odd_fields_are_straight_code),
        cmocka_unit_test(axes_that_share_parts_are_straight_code),
    };
    return cmocka_run_group_tests_name("lists", tests, NULL, NULL);
}
