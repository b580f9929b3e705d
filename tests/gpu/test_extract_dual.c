/* Extraction with vertices in cells, on the device: vertices, quads and their order around edges are those of a serial
 * twin that traces the same signs; closed manifolds of whatever field, or open ones that end on the bounds. */
#include "../oracle/dual.h"
#include "eval/code.h"
#include "gpu_test_device.h"
#include "iso/extractor.h"
#include "random_fields.h"

typedef struct subject {
    hewn_field *field;
    hewn_node root;
    hewn_extractor *extractor;
} subject;

static subject make_subject(maker *make, uint32_t seed)
{
    subject made = {0};
    GPU_TEST_TRY(hewn_field_create(&made.field, &error));
    made.root = make(made.field, seed);
    GPU_TEST_TRY(hewn_field_status(made.field, &error));
    GPU_TEST_TRY(hewn_extractor_create(device, made.field, made.root, &made.extractor, &error));
    return made;
}

static void free_subject(subject *made)
{
    hewn_extractor_destroy(&made->extractor);
    hewn_field_destroy(&made->field);
}

static hewn_triangles extract(const subject *made, const hewn_extract_desc *desc, hewn_extract_stats *stats)
{
    hewn_triangles mesh;
    hewn_extract_stats own;
    GPU_TEST_TRY(hewn_extract(made->extractor, desc, &mesh, &own, &error));
    assert_true(mesh.paired == (own.fans == 0) && (own.fans == 0 || !desc->quads));
    if (stats)
        *stats = own;
    return mesh;
}

static hewn_certificate certify(const hewn_triangles *mesh)
{
    hewn_certificate certificate;
    GPU_TEST_TRY(hewn_certify(mesh, NULL, &certificate, &error));
    return certificate;
}

static struct hewn_grid lay(const hewn_extract_desc *desc)
{
    struct hewn_grid grid;
    hewn_box grown;
    GPU_TEST_TRY(hewn_grid_lay(desc, &grid, &grown, &error));
    return grid;
}

/* Sample i of an axis; the layer of no thickness doubles the outermost ones. */
static float coordinate(const struct hewn_grid *grid, uint32_t axis, uint32_t i)
{
    uint32_t place = i < grid->rim ? 0 : i - grid->rim;
    float offset = grid->cell * (float)place;
    return i + grid->rim >= grid->cells[axis] ? grid->far[axis] : grid->origin[axis] + offset;
}

static bool *sample_signs(const subject *made, const struct hewn_grid *grid)
{
    size_t side[3] = {grid->cells[0] + 1, grid->cells[1] + 1, grid->cells[2] + 1}, count = side[0] * side[1] * side[2];
    float *points = malloc(count * 3 * sizeof *points), *values = malloc(count * sizeof *values);
    bool *inside = malloc(count * sizeof *inside);
    for (size_t i = 0; i < count; i++) {
        uint32_t at[3] = {(uint32_t)(i % side[0]), (uint32_t)(i / side[0] % side[1]),
                          (uint32_t)(i / side[0] / side[1])};
        for (uint32_t axis = 0; axis < 3; axis++)
            points[3 * i + axis] = coordinate(grid, axis, at[axis]);
    }
    hewn_code *code;
    GPU_TEST_TRY(hewn_code_create(device, made->field, made->root, &code, &error));
    GPU_TEST_TRY(hewn_code_eval_points(device, code, points, count, values, &error));
    hewn_code_destroy(device, &code);
    for (size_t i = 0; i < count; i++) {
        size_t at[3] = {i % side[0], i / side[0] % side[1], i / side[0] / side[1]};
        bool bound = false;
        for (int axis = 0; axis < 3; axis++)
            bound |= at[axis] == 0 || at[axis] == grid->cells[axis];
        inside[i] = values[i] < 0 && (grid->open || !bound);
    }
    free(points);
    free(values);
    return inside;
}

/* --- surfaces by name --------------------------------------------------------------------------------------------- */

typedef struct named_quad {
    uint64_t corner[4];
} named_quad;

static int by_name(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(named_quad));
}

/* A vertex is called by its cell, and by how many vertices of that cell come before it. */
static uint64_t *name_vertices(const struct hewn_grid *grid, const uint32_t *cells, uint64_t count)
{
    uint64_t *names = malloc(count * sizeof *names + 1);
    for (uint64_t i = 0; i < count; i++) {
        const uint32_t *at = cells + 3 * i;
        names[i] = 4 * (at[0] + (uint64_t)grid->cells[0] * (at[1] + (uint64_t)grid->cells[1] * at[2]));
        for (uint64_t k = i; k > 0 && memcmp(cells + 3 * (k - 1), at, 12) == 0; k--)
            names[i]++;
    }
    return names;
}

static named_quad *name_quads(const uint64_t *names, const uint32_t *quads, uint64_t count)
{
    named_quad *out = malloc(count * sizeof *out + 1);
    for (uint64_t i = 0; i < count; i++) {
        uint32_t least = 0;
        for (uint32_t k = 1; k < 4; k++)
            least = names[quads[4 * i + k]] < names[quads[4 * i + least]] ? k : least;
        for (uint32_t k = 0; k < 4; k++)
            out[i].corner[k] = names[quads[4 * i + (least + k) % 4]];
    }
    qsort(out, count, sizeof *out, by_name);
    return out;
}

static void compare_surfaces(const struct hewn_grid *grid, const hewn_dual_surface *mine, const oracle_dual *twin)
{
    assert_int_equal(mine->vertex_count, twin->vertex_count);
    assert_int_equal(mine->quad_count, twin->quad_count);
    uint64_t *names = name_vertices(grid, mine->cells, mine->vertex_count);
    uint64_t *twins = name_vertices(grid, twin->cells, twin->vertex_count);
    named_quad *quads = name_quads(names, mine->quads, mine->quad_count);
    named_quad *others = name_quads(twins, twin->quads, twin->quad_count);
    assert_memory_equal(quads, others, mine->quad_count * sizeof *quads);
    free(names);
    free(twins);
    free(quads);
    free(others);
}

/* --- one extraction beside its twin ------------------------------------------------------------------------------- */

/* The stages of an extraction one by one, down to the surface with what it was made of. */
typedef struct staged {
    hewn_workspace workspace;
    hewn_buffer buffers[3];
    hewn_dual_reading reading;
} staged;

static staged run_stages(const subject *made, const hewn_extract_desc *desc, const struct hewn_grid *grid)
{
    staged run = {.workspace.device = device};
    hewn_bricks bricks = {0};
    hewn_surface surface = {0};
    hewn_dual_hermite kept;
    hewn_emission emission;
    const hewn_extractor *extractor = made->extractor;
    GPU_TEST_TRY(hewn_dual_prepare(made->extractor, desc->method, &error));
    GPU_TEST_TRY(hewn_bricks_cull(extractor, grid, &run.workspace, &bricks, &error));
    GPU_TEST_TRY(hewn_dual_classify(extractor, grid, &bricks, &run.workspace, &surface, &error));
    uint64_t items[3] = {surface.vertex_count, surface.vertex_count, surface.triangle_count};
    for (int i = 0; i < 3; i++)
        GPU_TEST_TRY(hewn_buffer_create(device, "mesh", 12 * items[i], HEWN_BUFFER_DEVICE, &run.buffers[i], &error));
    GPU_TEST_TRY(hewn_dual_emit(extractor, grid, &bricks, &surface, desc->method, run.buffers, &run.workspace,
                                HEWN_KEEP_ALL, &kept, &emission, &error));
    GPU_TEST_TRY(
        hewn_dual_read(extractor, grid, &bricks, &surface, &kept, run.buffers, &run.workspace, &run.reading, &error));
    return run;
}

static void free_stages(staged *run)
{
    hewn_dual_reading_clear(&run->reading);
    hewn_workspace_clear(&run->workspace);
    for (int i = 0; i < 3; i++)
        hewn_buffer_destroy(device, &run->buffers[i]);
}

/* Vertices lie in their cells; where those have no thickness, on the bounds. Dual contouring may put a corner that no
 * cell's crossings tell of into the next cell. */
static void check_places(const struct hewn_grid *grid, const hewn_dual_surface *surface, hewn_method method)
{
    uint64_t strayed = 0;
    for (uint64_t i = 0; i < 3 * surface->vertex_count; i++) {
        uint32_t axis = (uint32_t)(i % 3), cell = surface->cells[i];
        float lo = coordinate(grid, axis, cell), hi = coordinate(grid, axis, cell + 1), at = surface->positions[i];
        bool low_bound = !grid->open && cell == 0, high_bound = !grid->open && cell + 1 == grid->cells[axis];
        bool beyond_low = low_bound ? at < lo : at <= lo, beyond_high = high_bound ? at > hi : at >= hi;
        bool strays = lo == hi ? at != lo : beyond_low || beyond_high;
        bool may = method == HEWN_METHOD_DC && lo != hi && at > lo - grid->cell && at < hi + grid->cell;
        strayed += strays;
        if (strays && !may)
            fail_msg("vertex %llu is at %.9g along %c, outside its cell from %.9g to %.9g", (unsigned long long)(i / 3),
                     (double)at, "xyz"[axis], (double)lo, (double)hi);
    }
    assert_true(strayed * 1000 <= surface->vertex_count);
}

/* The crossing of each quad is on the grid edge that its four cells have in common. */
static void check_crossings(const struct hewn_grid *grid, const hewn_dual_surface *surface)
{
    for (uint64_t i = 0; i < surface->quad_count; i++) {
        const float *point = surface->points + 3 * i, *normal = surface->gradients + 3 * i;
        float length = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
        assert_true(fabsf(length - 1) < 1e-5f);
        for (uint32_t corner = 0; corner < 4; corner++) {
            const uint32_t *cell = surface->cells + 3 * (size_t)surface->quads[4 * i + corner];
            for (uint32_t axis = 0; axis < 3; axis++) {
                float slack = 2e-3f * grid->cell; /* crossings are moved onto their tangent plane's zero */
                assert_true(point[axis] >= coordinate(grid, axis, cell[axis]) - slack);
                assert_true(point[axis] <= coordinate(grid, axis, cell[axis] + 1) + slack);
            }
        }
    }
}

/* Returns how many faces the twin turned. */
static uint32_t check_twin(const subject *made, hewn_method method, const uint32_t cells[3], bool open)
{
    hewn_extract_desc desc = {
        .bounds = {{0, 0, 0}, {cells[0], cells[1], cells[2]}}, .cell = 1, .method = method, .open = open};
    struct hewn_grid grid = lay(&desc);
    bool *inside = sample_signs(made, &grid);
    oracle_dual twin = oracle_dual_trace(grid.cells, inside, true);
    staged run = run_stages(made, &desc, &grid);
    compare_surfaces(&grid, &run.reading.surface, &twin);
    check_places(&grid, &run.reading.surface, method);
    check_crossings(&grid, &run.reading.surface);
    for (int quads = 0; quads < 2; quads++) { /* with fans and without */
        hewn_extract_stats stats;
        desc.quads = quads;
        hewn_triangles mesh = extract(made, &desc, &stats);
        assert_int_equal(mesh.vertex_count, twin.vertex_count + stats.fans);
        assert_int_equal(mesh.triangle_count, 2 * (twin.quad_count + stats.fans));
        assert_memory_equal(mesh.positions, run.reading.surface.positions, 12 * twin.vertex_count);
        hewn_certificate certificate = certify(&mesh);
        assert_true(certificate.manifold && certificate.oriented);
        assert_true(open || (certificate.closed && certificate.volume > 0));
        hewn_triangles_destroy(&mesh);
    }
    uint32_t flips = twin.flips;
    free_stages(&run);
    oracle_dual_free(&twin);
    free(inside);
    return flips;
}

static void test_same_as_the_twin(void **state)
{
    (void)state;
    static const uint32_t cells[][3] = {{24, 20, 17}, {8, 8, 8}, {33, 9, 16}, {1, 5, 30}};
    static maker *const makers[] = {make_waves, make_integers};
    uint32_t turned = 0;
    for (uint32_t m = 0; m < 2; m++) {
        subject made = make_subject(makers[m], m);
        const bool on_host = made.extractor->on_host;
        for (uint32_t i = 0; i < sizeof cells / sizeof *cells; i++)
            for (int open = cells[i][0] == 1; open < 2; open++) /* of one cell, all samples are on the bounds */
                for (hewn_method method = HEWN_METHOD_NETS; method <= HEWN_METHOD_DC; method++) {
                    made.extractor->on_host = on_host && i % 2 == 0; /* else all by the device's kernels */
                    turned += check_twin(&made, method, cells[i], open);
                }
        free_subject(&made);
    }
    assert_true(turned > 400);
}

/* --- meshes ------------------------------------------------------------------------------------------------------- */

static const hewn_box unit_cube = {{-1, -1, -1}, {1, 1, 1}};

/* Where an edge has one triangle only, both its ends lie on the bounds. */
static void check_border(const hewn_triangles *mesh)
{
    uint64_t on_bounds = 0;
    for (uint64_t i = 0; i < mesh->vertex_count; i++) {
        const float *at = mesh->positions + 3 * i;
        on_bounds += fabsf(at[0]) == 1 || fabsf(at[1]) == 1 || fabsf(at[2]) == 1;
    }
    hewn_certificate certificate = certify(mesh);
    assert_true(certificate.manifold && certificate.oriented);
    assert_int_equal(certificate.boundary_edges, on_bounds); /* loops have as many edges as vertices */
}

static void test_random_trees_are_manifolds(void **state)
{
    (void)state;
    uint32_t trees = gpu_test_long() ? 100 : 3;
    for (uint32_t seed = 0; seed < trees; seed++) {
        subject made = make_subject(make_tree, seed);
        for (uint32_t i = 0; i < 6; i++) {
            hewn_extract_desc desc = {.bounds = unit_cube,
                                      .resolution = 9 + 24 * (i / 2),
                                      .method = i % 2 ? HEWN_METHOD_DC : HEWN_METHOD_NETS};
            hewn_triangles mesh = extract(&made, &desc, NULL);
            hewn_certificate certificate = certify(&mesh);
            assert_true(certificate.closed && certificate.manifold && certificate.oriented && certificate.volume > 0);
            hewn_triangles_destroy(&mesh);
            desc.open = desc.quads = true; /* the middle of a fan may lie on the bounds too */
            mesh = extract(&made, &desc, NULL);
            check_border(&mesh);
            hewn_triangles_destroy(&mesh);
        }
        free_subject(&made);
    }
}

static hewn_node make_half_space(hewn_field *field, uint32_t seed)
{
    (void)seed;
    return hewn_plane(field, 0.3, 1, 0.2, 0.1);
}

/* Cut by its bounds, a half-space is a solid with a cap; left open it is one sheet whose rim lies on them. */
static void test_bounds_cut_or_leave_open(void **state)
{
    (void)state;
    subject made = make_subject(make_half_space, 0);
    for (hewn_method method = HEWN_METHOD_NETS; method <= HEWN_METHOD_DC; method++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 20, .method = method};
        hewn_extract_stats stats;
        hewn_triangles mesh = extract(&made, &desc, &stats);
        hewn_certificate certificate = certify(&mesh);
        assert_true(certificate.closed && certificate.genus == 0 && certificate.components == 1);
        assert_true(stats.left_bounds && stats.cap_vertices > 0 && stats.cap_vertices < mesh.vertex_count);
        assert_true(certificate.bounds.lo[0] == -1 && certificate.bounds.lo[1] == -1);
        hewn_triangles_destroy(&mesh);
        desc.open = desc.quads = true;
        mesh = extract(&made, &desc, &stats);
        certificate = certify(&mesh);
        assert_true(stats.left_bounds && stats.cap_vertices == 0 && stats.cells[0] == 20 && stats.cell == 0.1);
        assert_true(!certificate.closed && certificate.components == 1 && certificate.bounds.hi[0] == 1);
        check_border(&mesh);
        hewn_triangles_destroy(&mesh);
    }
    free_subject(&made);
}

static void test_same_bytes_every_time(void **state)
{
    (void)state;
    subject made = make_subject(make_waves, 3);
    for (hewn_method method = HEWN_METHOD_NETS; method <= HEWN_METHOD_DC; method++) {
        hewn_extract_desc desc = {.bounds = {{0, 0, 0}, {30, 30, 30}}, .cell = 1, .method = method};
        hewn_triangles first = extract(&made, &desc, NULL);
        for (int i = 0; i < 3; i++) {
            hewn_triangles again = extract(&made, &desc, NULL);
            assert_int_equal(again.vertex_count, first.vertex_count);
            assert_int_equal(again.triangle_count, first.triangle_count);
            assert_memory_equal(again.positions, first.positions, 12 * first.vertex_count);
            assert_memory_equal(again.normals, first.normals, 12 * first.vertex_count);
            assert_memory_equal(again.indices, first.indices, 12 * first.triangle_count);
            hewn_triangles_destroy(&again);
        }
        for (uint64_t i = 0; i < first.vertex_count; i++) {
            const float *n = first.normals + 3 * i;
            assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f);
        }
        hewn_triangles_destroy(&first);
    }
    free_subject(&made);
}

static void test_pairs_are_quads(void **state)
{
    (void)state;
    subject made = make_subject(make_tree, 4);
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 40, .quads = true}; /* the default is dual */
    hewn_extract_stats stats;
    hewn_triangles mesh = extract(&made, &desc, &stats);
    assert_int_equal(stats.method, HEWN_METHOD_DC);
    assert_true(mesh.triangle_count > 0 && mesh.triangle_count % 2 == 0);
    for (uint64_t i = 0; i < mesh.triangle_count; i += 2) {
        const uint32_t *one = mesh.indices + 3 * i, *other = one + 3;
        assert_true(one[0] == other[0] && one[2] == other[1] && one[1] != other[2]);
    }
    hewn_triangles_destroy(&mesh);
    desc.method = HEWN_METHOD_MC33;
    hewn_error error = {0};
    assert_int_equal(hewn_extract(made.extractor, &desc, &mesh, NULL, &error), HEWN_INVALID_ARGUMENT);
    assert_non_null(strstr(error.message, "mc33"));
    free_subject(&made);
}

/* --- awkward fields ----------------------------------------------------------------------------------------------- */

/* Faces, edges and corners of the box are on grid planes, lines and points, where the field is exactly 0. */
static hewn_node make_aligned_box(hewn_field *field, uint32_t seed)
{
    (void)seed;
    return hewn_box_shape(field, 1, 1, 1);
}

/* Not a number wherever x < 0.13; what is beyond counts as outside. */
static hewn_node make_half_nan(hewn_field *field, uint32_t seed)
{
    (void)seed;
    hewn_node root = hewn_sqrt(field, hewn_sub(field, hewn_x(field), hewn_constant(field, 0.13)));
    return hewn_max(field, hewn_sphere(field, 0.8), hewn_sub(field, root, hewn_constant(field, 2)));
}

/* Two walls with a gap, each much thinner than a cell; where a sample meets one, there is surface on both sides of it.
 */
static hewn_node make_thin_walls(hewn_field *field, uint32_t seed)
{
    (void)seed;
    hewn_node slope = hewn_add(field, hewn_x(field), scaled(field, hewn_y(field), 0.021));
    hewn_node one = hewn_sub(field, hewn_abs(field, slope), hewn_constant(field, 0.004));
    hewn_node shifted = hewn_sub(field, slope, hewn_constant(field, 0.02));
    hewn_node other = hewn_sub(field, hewn_abs(field, shifted), hewn_constant(field, 0.004));
    return hewn_max(field, hewn_min(field, one, other), hewn_sphere(field, 0.9));
}

static void test_awkward_fields(void **state)
{
    (void)state;
    static maker *const makers[] = {make_aligned_box, make_half_nan, make_thin_walls};
    for (uint32_t m = 0; m < sizeof makers / sizeof *makers; m++) {
        subject made = make_subject(makers[m], 0);
        for (int i = 0; i < 8; i++) {
            hewn_extract_desc desc = {.bounds = {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}},
                                      .resolution = i / 4 ? 48 : 30,
                                      .method = i % 2 ? HEWN_METHOD_DC : HEWN_METHOD_NETS,
                                      .open = i / 2 % 2};
            hewn_triangles mesh = extract(&made, &desc, NULL); /* certify refuses what is not finite */
            hewn_certificate certificate = certify(&mesh);
            assert_true(certificate.closed && certificate.manifold && certificate.oriented && certificate.volume > 0);
            for (uint64_t k = 0; k < 3 * mesh.vertex_count; k++)
                assert_true(fabsf(mesh.normals[k]) <= 1.0001f);
            hewn_triangles_destroy(&mesh);
        }
        free_subject(&made);
    }
}

/* --- cancelling --------------------------------------------------------------------------------------------------- */

static bool count_down(void *user, const char *name, double share)
{
    (void)name;
    (void)share;
    int *left = user;
    return (*left)-- > 0;
}

static void test_cancel_at_every_stage(void **state)
{
    (void)state;
    subject made = make_subject(make_aligned_box, 0);
    for (int adaptive = 0; adaptive < 2; adaptive++)
        for (int stages = 0; stages < 5 + 3 * adaptive; stages++) { /* collapsing asks several times */
            int left = stages;
            hewn_progress progress = {count_down, &left};
            hewn_extract_desc desc = {.bounds = {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}},
                                      .resolution = 32,
                                      .adaptive = adaptive * 0.01,
                                      .progress = &progress};
            hewn_error error = {0};
            hewn_triangles mesh;
            assert_int_equal(hewn_extract(made.extractor, &desc, &mesh, NULL, &error), HEWN_CANCELLED);
            assert_null(mesh.positions);
        }
    free_subject(&made);
}

/* --- names -------------------------------------------------------------------------------------------------------- */

static void test_names(void **state)
{
    (void)state;
    hewn_method method;
    for (int i = HEWN_METHOD_DEFAULT + 1; hewn_method_name((hewn_method)i); i++) {
        assert_true(hewn_method_named(hewn_method_name((hewn_method)i), &method));
        assert_int_equal(method, i);
    }
    assert_string_equal(hewn_method_name(HEWN_METHOD_DEFAULT), "dc");
    assert_false(hewn_method_named("magic", &method));
    assert_null(hewn_method_name((hewn_method)99));
    assert_true(hewn_method_is_dual(HEWN_METHOD_DEFAULT) && hewn_method_is_dual(HEWN_METHOD_NETS));
    assert_false(hewn_method_is_dual(HEWN_METHOD_MC33) || hewn_method_is_dual((hewn_method)99));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_as_the_twin),         cmocka_unit_test(test_random_trees_are_manifolds),
        cmocka_unit_test(test_bounds_cut_or_leave_open), cmocka_unit_test(test_same_bytes_every_time),
        cmocka_unit_test(test_pairs_are_quads),          cmocka_unit_test(test_awkward_fields),
        cmocka_unit_test(test_cancel_at_every_stage),    cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests_name("extract_dual", tests, open_device, close_device);
}
