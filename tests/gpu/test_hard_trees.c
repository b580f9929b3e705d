/* Culling stays proven where fields are no distances: trees of up to about 200 nodes with space twisted, bent, tapered,
 * stretched and warped, noise, exponential blends and periodic surfaces, extracted with culling, have a vertex for
 * every grid edge that dense samples of the whole field say is crossed. */
#include "gpu_test.h"

#include <math.h>

#include "eval/instructions.h"
#include "hewn/hewn.h"
#include "iso/extractor.h"

/* Two streams: what decides how a tree is built, and what decides its numbers. */
typedef struct grower {
    hewn_field *field;
    uint64_t *build, *numbers;
} grower;

static double number(grower *own, double lo, double hi)
{
    return lo + (hi - lo) * ((double)gpu_test_random(own->numbers) / 4294967296.0);
}

static uint32_t choice(grower *own, uint32_t count)
{
    return gpu_test_random(own->build) % count;
}

static uint32_t seed_of(grower *own)
{
    return gpu_test_random(own->numbers) >> 8;
}

static hewn_node grow_leaf(grower *own)
{
    hewn_field *f = own->field;
    double size = number(own, 0.25, 0.6);
    hewn_node out;
    switch (choice(own, 10)) {
    case 0: out = hewn_sphere(f, size); break;
    case 1: out = hewn_box_shape(f, size, 1.5 * size, 0.7 * size); break;
    case 2: out = hewn_torus(f, size, 0.3 * size); break;
    case 3: out = hewn_extrude(f, hewn_star(f, 5, size, 0.5 * size), size); break;
    case 4: out = hewn_helix(f, size, 0.8 * size, 3 * size, 0.2 * size); break;
    case 5: out = hewn_ellipsoid(f, size, 0.5 * size, 0.8 * size); break;
    case 6: out = hewn_round_cone(f, 0.6 * size, 0.3 * size, 1.3 * size); break;
    case 7: out = hewn_intersection(f, hewn_gyroid(f, size, 0.1 * size), hewn_sphere(f, 1.5 * size)); break;
    case 8: out = hewn_box_frame(f, 2 * size, size, size, 0.15 * size); break;
    default: out = hewn_loft(f, hewn_circle(f, size), hewn_rectangle(f, size, 0.5 * size), 1.5 * size);
    }
    out = hewn_rotate(f, out, number(own, 0.1, 1), number(own, 0.1, 1), number(own, 0.1, 1), number(own, 0.2, 1.2));
    return hewn_translate(f, out, number(own, -0.7, 0.7), number(own, -0.7, 0.7), number(own, -0.7, 0.7));
}

static hewn_node change(grower *own, hewn_node a)
{
    hewn_field *f = own->field;
    const hewn_octaves octaves = {
        .kind = (hewn_noise_kind)choice(own, 4), .size = number(own, 0.4, 1), .octaves = 2, .seed = seed_of(own)};
    switch (choice(own, 11)) {
    case 0: return hewn_twist(f, a, number(own, -2, 2));
    case 1: return hewn_bend(f, a, number(own, 0.2, 1));
    case 2: return hewn_taper(f, a, number(own, 0.4, 1.5), number(own, 0.4, 1.5), number(own, 0.5, 1.5));
    case 3: return hewn_stretch(f, a, number(own, 0.5, 1.5), number(own, 0.5, 1.5), number(own, 0.5, 1.5));
    case 4: return hewn_warp(f, a, number(own, 0.05, 0.2), number(own, 0.3, 1), seed_of(own));
    case 5: return hewn_displace(f, a, hewn_mul(f, hewn_fbm(f, &octaves), hewn_constant(f, number(own, 0.05, 0.2))));
    case 6: return hewn_displace(f, a, hewn_mul(f, hewn_ridged(f, &octaves), hewn_constant(f, number(own, 0.05, 0.2))));
    case 7: return hewn_shell(f, a, number(own, 0.05, 0.2));
    case 8: return hewn_symmetric(f, a, (int)choice(own, 3));
    case 9: return hewn_mirror_tile(f, a, number(own, 1.2, 2), 0, number(own, 1.2, 2));
    default: return hewn_elongate(f, a, number(own, 0.1, 0.4), number(own, 0.1, 0.4), number(own, 0.1, 0.4));
    }
}

static hewn_node combine(grower *own, hewn_node a, hewn_node b)
{
    hewn_field *f = own->field;
    double size = number(own, 0.05, 0.25);
    switch (choice(own, 10)) {
    case 0:
    case 1: return hewn_smooth_union(f, a, b, HEWN_BLEND_EXPONENTIAL, 5 / size);
    case 2: return hewn_smooth_difference(f, a, b, HEWN_BLEND_CUBIC, size);
    case 3: return hewn_xor(f, a, b);
    case 4: return hewn_chamfer_union(f, a, b, size);
    case 5: return hewn_stairs_difference(f, a, b, size, 3);
    case 6: return hewn_round_union(f, a, b, size);
    case 7: return hewn_morph(f, a, b, hewn_constant(f, number(own, 0.2, 0.8)));
    case 8: return hewn_difference(f, a, b);
    default: return hewn_union(f, a, b);
    }
}

static hewn_node grow(grower *own, uint32_t leaves)
{
    enum { MOST = 160 };
    hewn_node made;
    if (leaves <= 1) {
        made = grow_leaf(own);
    } else {
        uint32_t left = 1 + choice(own, leaves - 1);
        hewn_node a = grow(own, left);
        made = combine(own, a, grow(own, leaves - left));
    }
    while (choice(own, 5) < 3) {
        hewn_node changed = change(own, made);
        if (hewn_field_size(own->field, changed) > MOST)
            break;
        made = changed;
    }
    return made;
}

static hewn_node make_tree(hewn_field *field, uint32_t build, uint32_t numbers)
{
    uint64_t streams[2] = {build * 0x9e3779b97f4a7c15u + 1, numbers * 0xd1b54a32d192ed03u + 1};
    grower own = {field, &streams[0], &streams[1]};
    uint32_t leaves = 1 + choice(&own, 5);
    hewn_node root = grow(&own, leaves);
    GPU_TEST_TRY(hewn_field_status(field, &error));
    return root;
}

/* --- cells ---------------------------------------------------------------------------------------------------------
 */

static const hewn_box bounds = {{-1.6, -1.5, -1.55}, {1.5, 1.6, 1.55}};

/* How many grid edges have ends of different signs, from dense samples of the whole field; a closed grid's outermost
 * samples are outside. */
static uint64_t count_crossings(hewn_extractor *extractor, const hewn_extract_desc *desc)
{
    struct hewn_grid grid;
    hewn_box grown;
    GPU_TEST_TRY(hewn_grid_lay(desc, &grid, &grown, &error));
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
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            size_t at = i / (axis == 0 ? 1 : axis == 1 ? side[0] : side[0] * side[1]) % side[axis];
            if (at == 0 || at == grid.cells[axis])
                values[i] = 1;
        }
    uint64_t crossings = 0;
    const size_t step[3] = {1, side[0], side[0] * side[1]};
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++)
            if (i / step[axis] % side[axis] + 1 < side[axis])
                crossings += (values[i] < 0) != (values[i + step[axis]] < 0);
    free(points);
    free(values);
    return crossings;
}

/* Extracts by marching cubes, which makes a vertex of every crossed edge that culling left; adds how many. False where
 * the device would take too many turns, which is told and nothing else. */
static bool check_cells(hewn_extractor *extractor, uint32_t tree, uint64_t *vertices)
{
    const hewn_extract_desc desc = {.bounds = bounds,
                                    .resolution = tree % 16 == 0  ? 60
                                                  : tree % 4 == 1 ? 33
                                                                  : 20,
                                    .method = HEWN_METHOD_MARCHING_CUBES};
    hewn_triangles triangles;
    hewn_error error = {0};
    hewn_result result = hewn_extract(extractor, &desc, &triangles, NULL, &error);
    if (result == HEWN_LIMIT)
        return false;
    if (result != HEWN_OK && result != HEWN_BAD_INPUT)
        fail_msg("tree %u: %s", tree, error.message);
    uint64_t crossings = count_crossings(extractor, &desc);
    if (crossings != triangles.vertex_count)
        fail_msg("tree %u: %llu edges are crossed, %llu were found", tree, (unsigned long long)crossings,
                 (unsigned long long)triangles.vertex_count);
    *vertices += triangles.vertex_count;
    hewn_triangles_destroy(&triangles);
    return true;
}

/* Each in code of its own, of which the compilation takes nearly all of the time. */
static void hard_trees_keep_their_cells(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    uint32_t trees = gpu_test_long() ? 100 : 5;
    uint64_t vertices = 0;
    for (uint32_t tree = 1; tree <= trees; tree++) {
        hewn_field *field;
        hewn_extractor *extractor;
        GPU_TEST_TRY(hewn_field_create(&field, &error));
        hewn_node root = make_tree(field, tree, 0);
        GPU_TEST_TRY(hewn_extractor_create(device, field, root, &extractor, &error));
        assert_true(check_cells(extractor, tree, &vertices));
        hewn_extractor_destroy(&extractor);
        hewn_field_destroy(&field);
    }
    print_message("# %u trees compared, %llu vertices\n", trees, (unsigned long long)vertices);
    assert_true(vertices > 200 * (uint64_t)trees);
    gpu_test_close(&device, &messages);
}

/* Trees of a few hard leaves, each of which always has the same operators, so that one code lists all such trees. */
enum { LEAVES = 2 };

static hewn_node grow_hard_leaf(grower *own, uint32_t grove, uint32_t which)
{
    uint64_t build = (grove * LEAVES + which) * 0x9e3779b97f4a7c15u + 1;
    grower leaf = {own->field, &build, own->numbers};
    hewn_node made = change(&leaf, grow_leaf(&leaf));
    return choice(&leaf, 2) ? change(&leaf, made) : made;
}

static hewn_node grow_hard_tree(grower *own, uint32_t grove, uint32_t leaves)
{
    if (leaves <= 1)
        return grow_hard_leaf(own, grove, choice(own, LEAVES));
    uint32_t left = 1 + choice(own, leaves - 1);
    hewn_node a = grow_hard_tree(own, grove, left);
    return combine(own, a, grow_hard_tree(own, grove, leaves - left));
}

/* Whether a tree of all operators that the grove's trees have is not too much for a list. */
static bool fits_lists(const hewn_field *field, hewn_node root)
{
    hewn_listing listing;
    hewn_instructions made;
    bool fits;
    GPU_TEST_TRY(hewn_listing_create(&listing, field, root, false, &error));
    GPU_TEST_TRY(hewn_instructions_create(&made, &listing, NULL, &fits, &error));
    if (fits)
        hewn_instructions_destroy(&made);
    hewn_listing_destroy(&listing);
    return fits;
}

static hewn_extractor *plant(hewn_device *device, uint32_t grove)
{
    const hewn_code_desc listed = {.evaluation = HEWN_EVALUATION_LISTED};
    hewn_field *field;
    hewn_extractor *out = NULL;
    uint64_t streams[2] = {grove, 1};
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    grower own = {field, &streams[0], &streams[1]};
    hewn_node root = grow_hard_tree(&own, grove, 120);
    if (fits_lists(field, root))
        GPU_TEST_TRY(hewn_extractor_create_as(device, field, root, &listed, &out, &error));
    hewn_field_destroy(&field);
    return out;
}

static bool check_listed(hewn_extractor *extractor, uint32_t grove, uint32_t tree, uint64_t *vertices)
{
    uint64_t streams[2] = {grove * 0x9e3779b97f4a7c15u + tree, tree * 0xd1b54a32d192ed03u + grove};
    hewn_field *field;
    bool taken;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    grower own = {field, &streams[0], &streams[1]};
    hewn_node root = grow_hard_tree(&own, grove, 1 + choice(&own, 12));
    GPU_TEST_TRY(hewn_extractor_renumber(extractor, field, root, &taken, &error));
    bool compared = taken && check_cells(extractor, tree, vertices);
    hewn_field_destroy(&field);
    return compared;
}

/* From grove HEWN_SEED (1) on. Of a grove's trees some have lists of another form, when a number is zero or equals
 * another one. */
static void hard_trees_keep_their_cells_in_lists(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    const char *from = getenv("HEWN_SEED");
    uint32_t grove = from ? (uint32_t)strtoul(from, NULL, 10) : 1;
    const uint32_t wanted = gpu_test_long() ? 10000 : 10, each = gpu_test_long() ? 400 : 16;
    uint32_t compared = 0;
    uint64_t vertices = 0;
    for (; compared < wanted; grove++) {
        hewn_extractor *extractor = plant(device, grove);
        for (uint32_t tree = 1; extractor && tree <= each && compared < wanted; tree++)
            compared += check_listed(extractor, grove, tree, &vertices);
        hewn_extractor_destroy(&extractor);
        if (gpu_test_long())
            print_message("# %u trees so far, up to grove %u\n", compared, grove);
    }
    print_message("# %u trees compared, %llu vertices\n", compared, (unsigned long long)vertices);
    assert_true(vertices > 100 * (uint64_t)compared);
    gpu_test_close(&device, &messages);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hard_trees_keep_their_cells),
        cmocka_unit_test(hard_trees_keep_their_cells_in_lists),
    };
    return cmocka_run_group_tests_name("hard_trees", tests, NULL, NULL);
}
