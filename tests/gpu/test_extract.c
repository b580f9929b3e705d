/* Extraction on the device against a serial twin fed with the field's dense samples: the same crossings, the same cuts
 * on every face, the same number of triangles; and what the mesh promises: closed, manifold, on the surface, the same
 * bytes each time. */
#include <math.h>

#include "../oracle/cuts.h"
#include "eval/code.h"
#include "gpu_test_device.h"
#include "hewn/hewn.h"
#include "iso/grid.h"

static void must(hewn_result result, const hewn_error *error)
{
    if (result != HEWN_OK)
        fail_msg("%s", error->message);
}

/* --- fields ------------------------------------------------------------------------------------------------------ */

typedef hewn_node maker(hewn_field *field);

static hewn_node make_sphere(hewn_field *field)
{
    return hewn_sphere(field, 0.8);
}

static hewn_node make_off_centre(hewn_field *field)
{
    return hewn_union(field, hewn_translate(field, hewn_sphere(field, 0.31), 0.45, -0.3, 0.21),
                      hewn_translate(field, hewn_box_shape(field, 0.5, 0.37, 0.91), -0.3, 0.33, 0.05));
}

/* Surface exactly on samples, for every even resolution. */
static hewn_node make_aligned_box(hewn_field *field)
{
    return hewn_box_shape(field, 1, 1, 1);
}

static hewn_node make_gyroid(hewn_field *field)
{
    hewn_node x = hewn_x(field), y = hewn_y(field), z = hewn_z(field), k = hewn_constant(field, 9);
    hewn_node a = hewn_mul(field, hewn_sin(field, hewn_mul(field, k, x)), hewn_cos(field, hewn_mul(field, k, y)));
    hewn_node b = hewn_mul(field, hewn_sin(field, hewn_mul(field, k, y)), hewn_cos(field, hewn_mul(field, k, z)));
    hewn_node c = hewn_mul(field, hewn_sin(field, hewn_mul(field, k, z)), hewn_cos(field, hewn_mul(field, k, x)));
    hewn_node gyroid = hewn_add(field, hewn_add(field, a, b), c);
    return hewn_sub(field, hewn_abs(field, gyroid), hewn_constant(field, 0.4));
}

static hewn_node make_melted(hewn_field *field)
{
    hewn_node ring = hewn_rotate(field, hewn_torus(field, 0.6, 0.17), 1, 2, 0.5, 0.7);
    hewn_node peg = hewn_rotate(field, hewn_capsule(field, 0.2, 0.9), 0, 0, 1, 1.1);
    hewn_node both = hewn_smooth_union(field, ring, peg, HEWN_BLEND_QUADRATIC, 0.2);
    return hewn_difference(field, both, hewn_translate(field, hewn_sphere(field, 0.3), 0.1, 0.3, 0.4));
}

/* Nearly every cell is cut, many of them ambiguously: the value jumps from sample to sample. */
static hewn_node make_noise(hewn_field *field)
{
    hewn_node x = hewn_x(field), y = hewn_y(field), z = hewn_z(field);
    hewn_node sum = hewn_add(field, hewn_mul(field, x, hewn_constant(field, 127.1)),
                             hewn_add(field, hewn_mul(field, y, hewn_constant(field, 311.7)),
                                      hewn_mul(field, z, hewn_constant(field, 74.7))));
    return hewn_sin(field, hewn_mul(field, sum, hewn_constant(field, 3.3)));
}

static hewn_node make_half_space(hewn_field *field)
{
    return hewn_plane(field, 0.3, 1, 0.2, 0.1);
}

/* --- one extraction beside its twin ------------------------------------------------------------------------------- */

typedef struct subject {
    hewn_field *field;
    hewn_node root;
    hewn_extractor *extractor;
} subject;

static subject make_subject(maker *make)
{
    hewn_error error = {0};
    subject made = {0};
    must(hewn_field_create(&made.field, &error), &error);
    made.root = make(made.field);
    must(hewn_field_status(made.field, &error), &error);
    must(hewn_extractor_create(device, made.field, made.root, &made.extractor, &error), &error);
    return made;
}

static void free_subject(subject *made)
{
    hewn_extractor_destroy(&made->extractor);
    hewn_field_destroy(&made->field);
}

static bool *dense_signs(const subject *made, const struct hewn_grid *grid)
{
    hewn_error error = {0};
    size_t side[3] = {grid->cells[0] + 1, grid->cells[1] + 1, grid->cells[2] + 1}, count = side[0] * side[1] * side[2];
    float *points = malloc(count * 3 * sizeof *points), *values = malloc(count * sizeof *values);
    bool *inside = malloc(count * sizeof *inside);
    hewn_code *code;
    must(hewn_code_create(device, made->field, made->root, &code, &error), &error);
    for (size_t i = 0; i < count; i++) {
        size_t at[3] = {i % side[0], i / side[0] % side[1], i / side[0] / side[1]};
        for (int axis = 0; axis < 3; axis++) {
            float offset = grid->cell * (float)at[axis];
            points[3 * i + (size_t)axis] =
                at[axis] == grid->cells[axis] ? grid->far[axis] : grid->origin[axis] + offset;
        }
    }
    must(hewn_code_eval_points(device, code, points, count, values, &error), &error);
    for (size_t i = 0; i < count; i++) {
        size_t at[3] = {i % side[0], i / side[0] % side[1], i / side[0] / side[1]};
        bool bound = false;
        for (int axis = 0; axis < 3; axis++)
            bound |= at[axis] == 0 || at[axis] == grid->cells[axis];
        inside[i] = values[i] < 0 && (grid->open || !bound);
    }
    hewn_code_destroy(device, &code);
    free(points);
    free(values);
    return inside;
}

/* The grid edge that a vertex lies on. */
static uint64_t vertex_edge(const struct hewn_grid *grid, const float at[3])
{
    uint32_t cell[3], axis = 3;
    double most = 0;
    for (uint32_t a = 0; a < 3; a++) {
        double place = ((double)at[a] - (double)grid->origin[a]) / (double)grid->cell,
               off = fabs(place - nearbyint(place));
        bool cap = !grid->open && (at[a] == grid->origin[a] || at[a] == grid->far[a]);
        off = cap ? 1 : off;
        if (off > most) {
            most = off;
            axis = a;
        }
        cell[a] = (uint32_t)nearbyint(place);
    }
    assert_true(axis < 3);
    bool low_cap = at[axis] == grid->origin[axis], high_cap = at[axis] == grid->far[axis];
    double place = ((double)at[axis] - (double)grid->origin[axis]) / (double)grid->cell;
    cell[axis] = low_cap ? 0 : high_cap ? grid->cells[axis] - 1 : (uint32_t)floor(place);
    return 3 * (cell[0] + (uint64_t)(grid->cells[0] + 1) * (cell[1] + (uint64_t)(grid->cells[1] + 1) * cell[2])) + axis;
}

static bool share_a_face(const struct hewn_grid *grid, uint64_t a, uint64_t b)
{
    /* Two edges share a cell face if, in doubled coordinates of their middles, some axis holds the same even number and
     * the others differ by at most 2. */
    int64_t middle[2][3];
    uint64_t name[2] = {a, b};
    for (int i = 0; i < 2; i++) {
        uint64_t at = name[i] / 3;
        middle[i][0] = (int64_t)(2 * (at % (grid->cells[0] + 1)));
        middle[i][1] = (int64_t)(2 * (at / (grid->cells[0] + 1) % (grid->cells[1] + 1)));
        middle[i][2] = (int64_t)(2 * (at / (grid->cells[0] + 1) / (grid->cells[1] + 1)));
        middle[i][name[i] % 3] += 1;
    }
    for (int axis = 0; axis < 3; axis++)
        if (middle[0][axis] == middle[1][axis] && middle[0][axis] % 2 == 0) {
            int u = (axis + 1) % 3, v = (axis + 2) % 3;
            if (llabs(middle[0][u] - middle[1][u]) <= 2 && llabs(middle[0][v] - middle[1][v]) <= 2)
                return true;
        }
    return false;
}

static void compare_with_twin(const subject *made, const hewn_extract_desc *desc, const hewn_triangles *mesh)
{
    hewn_error error = {0};
    struct hewn_grid grid;
    hewn_box grown;
    must(hewn_grid_lay(desc, &grid, &grown, &error), &error);
    bool *inside = dense_signs(made, &grid);
    oracle_surface twin = oracle_trace(grid.cells, inside);
    assert_int_equal(mesh->vertex_count, twin.vertex_count);
    assert_int_equal(mesh->triangle_count, twin.triangle_count);
    uint64_t *edges = malloc(mesh->vertex_count * sizeof *edges + 1);
    oracle_cut *cuts = malloc(3 * mesh->triangle_count * sizeof *cuts + 1);
    size_t count = 0;
    for (uint64_t i = 0; i < mesh->vertex_count; i++)
        edges[i] = vertex_edge(&grid, mesh->positions + 3 * i);
    for (uint64_t t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            uint64_t from = edges[mesh->indices[3 * t + (uint64_t)c]],
                     to = edges[mesh->indices[3 * t + (uint64_t)((c + 1) % 3)]];
            if (share_a_face(&grid, from, to))
                cuts[count++] = (oracle_cut){from, to};
        }
    oracle_sort(cuts, count);
    assert_int_equal(count, twin.cut_count);
    assert_memory_equal(cuts, twin.cuts, count * sizeof *cuts);
    free(edges);
    free(cuts);
    free(twin.cuts);
    free(inside);
}

static hewn_triangles extract(const subject *made, const hewn_extract_desc *desc, hewn_extract_stats *stats)
{
    hewn_error error = {0};
    hewn_triangles mesh;
    must(hewn_extract(made->extractor, desc, &mesh, stats, &error), &error);
    return mesh;
}

static hewn_certificate certify(const hewn_triangles *mesh)
{
    hewn_error error = {0};
    hewn_certificate certificate;
    must(hewn_certify(mesh, NULL, &certificate, &error), &error);
    return certificate;
}

static const hewn_box unit_cube = {{-1, -1, -1}, {1, 1, 1}};

static void check_field(maker *make, uint32_t resolution, bool open)
{
    subject made = make_subject(make);
    hewn_extract_desc desc = {
        .bounds = unit_cube, .resolution = resolution, .open = open, .method = HEWN_METHOD_MARCHING_CUBES};
    hewn_extract_stats stats;
    hewn_triangles mesh = extract(&made, &desc, &stats);
    hewn_certificate certificate = certify(&mesh);
    assert_true(certificate.manifold && certificate.oriented);
    if (!open)
        assert_true(certificate.closed && certificate.volume > 0);
    compare_with_twin(&made, &desc, &mesh);
    hewn_triangles_destroy(&mesh);
    free_subject(&made);
}

static void test_same_as_the_twin(void **state)
{
    (void)state;
    static maker *const makers[] = {make_sphere, make_off_centre, make_aligned_box,
                                    make_gyroid, make_melted,     make_half_space};
    static const uint32_t resolutions[] = {6, 8, 17, 48};
    for (size_t i = 0; i < sizeof makers / sizeof *makers; i++)
        for (size_t r = 0; r < sizeof resolutions / sizeof *resolutions; r++)
            for (int open = 0; open < 2; open++)
                check_field(makers[i], resolutions[r], open);
}

static void test_noise_is_a_closed_manifold(void **state)
{
    (void)state;
    check_field(make_noise, 40, false);
    check_field(make_noise, 33, true);
}

static void test_several_levels_of_culling(void **state)
{
    (void)state;
    subject made = make_subject(make_melted);
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 150, .method = HEWN_METHOD_MARCHING_CUBES};
    hewn_extract_stats stats;
    hewn_triangles mesh = extract(&made, &desc, &stats);
    compare_with_twin(&made, &desc, &mesh);
    hewn_triangles_destroy(&mesh);
    free_subject(&made);
}

/* --- what vertices promise ---------------------------------------------------------------------------------------- */

static void check_vertices(maker *make, uint32_t resolution, double residual)
{
    subject made = make_subject(make);
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = resolution, .method = HEWN_METHOD_MARCHING_CUBES};
    hewn_extract_stats stats;
    hewn_triangles mesh = extract(&made, &desc, &stats);
    if (!((double)stats.max_residual <= residual))
        fail_msg("residual %g is more than %g", (double)stats.max_residual, residual);
    uint64_t caps = 0;
    for (uint64_t i = 0; i < mesh.vertex_count; i++) {
        const float *at = mesh.positions + 3 * i, *normal = mesh.normals + 3 * i;
        double length = 0, off_grid = 0;
        bool cap = false;
        for (int axis = 0; axis < 3; axis++) {
            double place = ((double)at[axis] + 1) * resolution / 2;
            length += (double)normal[axis] * (double)normal[axis];
            off_grid = fmax(off_grid, fabs(place - nearbyint(place)));
            cap |= at[axis] == -1.0f || at[axis] == 1.0f;
        }
        caps += cap;
        assert_true(fabs(length - 1) < 1e-5);
        assert_true(cap || off_grid >= 1.0 / 4096);
    }
    assert_int_equal(caps, stats.cap_vertices);
    hewn_triangles_destroy(&mesh);
    free_subject(&made);
}

static void test_vertices_lie_on_the_surface(void **state)
{
    (void)state;
    /* Vertices are kept 1.25 / 4096 of a cell away from grid points, and may be that much off the surface there. */
    const double kept_away = 1.25 / 4096 + 2e-5;
    check_vertices(make_sphere, 64, kept_away);
    check_vertices(make_melted, 64, kept_away);
    check_vertices(make_aligned_box, 64, kept_away);
    check_vertices(make_gyroid, 64, 1e-3); /* |g| bends to a point where it is 0: the gradient there says little */
}

static void test_crossings_are_solved_not_interpolated(void **state)
{
    (void)state;
    subject made = make_subject(make_sphere);
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 12, .method = HEWN_METHOD_MARCHING_CUBES};
    hewn_triangles mesh = extract(&made, &desc, NULL);
    for (uint64_t i = 0; i < mesh.vertex_count; i++) {
        const float *at = mesh.positions + 3 * i;
        double radius =
            sqrt((double)at[0] * (double)at[0] + (double)at[1] * (double)at[1] + (double)at[2] * (double)at[2]);
        double place = 0;
        for (int axis = 0; axis < 3; axis++) {
            double cells = ((double)at[axis] + 1) * 6;
            place = fmax(place, fabs(cells - nearbyint(cells)));
        }
        if (place > 2.0 / 4096)
            assert_true(fabs(radius - 0.8) < 3e-5 / 6);
    }
    hewn_triangles_destroy(&mesh);
    free_subject(&made);
}

static void test_normals_are_gradients(void **state)
{
    (void)state;
    subject made = make_subject(make_sphere);
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 64, .method = HEWN_METHOD_MARCHING_CUBES};
    hewn_triangles mesh = extract(&made, &desc, NULL);
    for (uint64_t i = 0; i < 3 * mesh.vertex_count; i++)
        assert_true(fabsf(mesh.normals[i] - mesh.positions[i] / 0.8f) < 1e-4f);
    hewn_triangles_destroy(&mesh);
    free_subject(&made);
}

static void test_volume_converges_by_the_square(void **state)
{
    (void)state;
    double exact = 4.0 / 3.0 * 3.14159265358979323846 * 0.8 * 0.8 * 0.8, error[3];
    subject made = make_subject(make_sphere);
    for (uint32_t i = 0; i < 3; i++) {
        hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 32u << i, .method = HEWN_METHOD_MARCHING_CUBES};
        hewn_triangles mesh = extract(&made, &desc, NULL);
        hewn_certificate certificate = certify(&mesh);
        assert_true(certificate.closed && certificate.genus == 0 && certificate.components == 1);
        error[i] = fabs(certificate.volume - exact);
        hewn_triangles_destroy(&mesh);
    }
    assert_true(fabs(error[0] / error[1] - 4) < 0.3);
    assert_true(fabs(error[1] / error[2] - 4) < 0.3);
    free_subject(&made);
}

static void test_caps_lie_on_grown_bounds(void **state)
{
    (void)state;
    subject made = make_subject(make_half_space);
    hewn_extract_desc desc = {
        .bounds = {{-1, -0.5, -0.33}, {1, 0.51, 0.4}}, .resolution = 20, .method = HEWN_METHOD_MARCHING_CUBES};
    hewn_extract_stats stats;
    hewn_triangles mesh = extract(&made, &desc, &stats);
    assert_true(stats.left_bounds);
    assert_true(stats.cells[0] == 20 && stats.cells[1] == 11 && stats.cells[2] == 8);
    assert_true(fabs(stats.bounds.lo[1] + 0.545) < 1e-12 && fabs(stats.bounds.hi[1] - 0.555) < 1e-12);
    hewn_certificate certificate = certify(&mesh);
    assert_true(certificate.closed && certificate.manifold && certificate.oriented && certificate.genus == 0);
    for (int axis = 0; axis < 3; axis++)
        assert_true(certificate.bounds.lo[axis] >= (double)(float)stats.bounds.lo[axis] &&
                    certificate.bounds.hi[axis] <= (double)(float)stats.bounds.hi[axis]);
    assert_true(certificate.bounds.lo[1] == (double)(float)stats.bounds.lo[1]);
    hewn_triangles_destroy(&mesh);
    free_subject(&made);
}

/* Around the length from which the numbers of bricks no longer fit the short form of a vertex's record: a plane along
 * each axis has a vertex at every sample of it, and nowhere else. */
static void test_long_grids(void **state)
{
    (void)state;
    static const hewn_method methods[] = {HEWN_METHOD_MARCHING_CUBES, HEWN_METHOD_MC33};
    hewn_error error = {0};
    for (int axis = 0; axis < 3; axis++) {
        hewn_field *field;
        hewn_extractor *extractor;
        must(hewn_field_create(&field, &error), &error);
        hewn_node root = hewn_plane(field, axis == 1, axis == 2, axis == 0, 1.75);
        must(hewn_extractor_create(device, field, root, &extractor, &error), &error);
        for (uint32_t variant = 0; variant < 12; variant++) {
            const uint32_t length = 1023 + variant / 4;
            hewn_extract_desc desc = {
                .bounds = {{0, 0, 0}, {4, 4, 4}}, .cell = 1, .open = variant & 1, .method = methods[variant / 2 % 2]};
            hewn_triangles mesh;
            uint32_t counts[1026] = {0};
            desc.bounds.hi[axis] = length;
            must(hewn_extract(extractor, &desc, &mesh, NULL, &error), &error);
            for (uint64_t v = 0; v < mesh.vertex_count; v++) {
                const double at = (double)mesh.positions[3 * v + (size_t)axis];
                assert_true(at >= 0 && at <= length);
                counts[(uint32_t)(at + 0.5)]++;
            }
            for (uint32_t n = 0; n <= length; n++)
                if (desc.open ? counts[n] != 5 : counts[n] == 0)
                    fail_msg("%u vertices at %u of %u, axis %d, variant %u", counts[n], n, length, axis, variant);
            if (desc.open)
                assert_int_equal(mesh.triangle_count, 8 * length);
            hewn_triangles_destroy(&mesh);
        }
        hewn_extractor_destroy(&extractor);
        hewn_field_destroy(&field);
    }
}

static void test_same_bytes_every_time(void **state)
{
    (void)state;
    subject made = make_subject(make_melted), again = make_subject(make_melted);
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 60, .method = HEWN_METHOD_MARCHING_CUBES};
    hewn_triangles first = extract(&made, &desc, NULL);
    for (int i = 0; i < 3; i++) {
        hewn_triangles next = extract(i == 2 ? &again : &made, &desc, NULL);
        assert_int_equal(first.vertex_count, next.vertex_count);
        assert_int_equal(first.triangle_count, next.triangle_count);
        assert_memory_equal(first.positions, next.positions, first.vertex_count * 12);
        assert_memory_equal(first.normals, next.normals, first.vertex_count * 12);
        assert_memory_equal(first.indices, next.indices, first.triangle_count * 12);
        hewn_triangles_destroy(&next);
    }
    hewn_triangles_destroy(&first);
    free_subject(&made);
    free_subject(&again);
}

/* --- refusals ----------------------------------------------------------------------------------------------------- */

static hewn_node make_nan(hewn_field *field)
{
    return hewn_sqrt(field, hewn_sub(field, hewn_constant(field, -1), hewn_square(field, hewn_x(field))));
}

static hewn_node make_nothing(hewn_field *field)
{
    return hewn_add(field, hewn_square(field, hewn_x(field)), hewn_constant(field, 1));
}

static hewn_node make_everything(hewn_field *field)
{
    return hewn_neg(field, make_nothing(field));
}

static void expect_refusal(maker *make, const hewn_extract_desc *desc, hewn_result code, const char *word)
{
    subject made = make_subject(make);
    hewn_error error = {0};
    hewn_triangles mesh;
    assert_int_equal(hewn_extract(made.extractor, desc, &mesh, NULL, &error), code);
    assert_int_equal(error.code, code);
    assert_non_null(strstr(error.message, word));
    assert_null(mesh.positions);
    free_subject(&made);
}

static void test_refusals_say_why(void **state)
{
    (void)state;
    hewn_extract_desc good = {.bounds = unit_cube, .resolution = 16};
    expect_refusal(make_nan, &good, HEWN_BAD_INPUT, "NaN");
    expect_refusal(make_nothing, &good, HEWN_BAD_INPUT, "nowhere negative");
    expect_refusal(make_everything, &good, HEWN_BAD_INPUT, "negative everywhere");
    hewn_extract_desc open = {.bounds = unit_cube, .resolution = 16, .open = true};
    expect_refusal(make_everything, &open, HEWN_BAD_INPUT, "negative everywhere");
    hewn_extract_desc fine = {.bounds = unit_cube, .resolution = 100000};
    expect_refusal(make_sphere, &fine, HEWN_INVALID_ARGUMENT, "100000");
    hewn_extract_desc far = {.bounds = {{1e6, 0, 0}, {1e6 + 1, 1, 1}}, .resolution = 64};
    expect_refusal(make_sphere, &far, HEWN_INVALID_ARGUMENT, "too far");
    hewn_extract_desc reversed = {.bounds = {{1, 0, 0}, {0, 1, 1}}, .resolution = 64};
    expect_refusal(make_sphere, &reversed, HEWN_INVALID_ARGUMENT, "bounds");
    hewn_extract_desc nan = {.bounds = {{(double)NAN, 0, 0}, {0, 1, 1}}, .resolution = 64};
    expect_refusal(make_sphere, &nan, HEWN_INVALID_ARGUMENT, "bounds");
}

/* NaN where both squares overflow, and a number elsewhere. */
static hewn_node make_saddle(hewn_field *field)
{
    hewn_node saddle = hewn_sub(field, hewn_square(field, hewn_x(field)), hewn_square(field, hewn_y(field)));
    return hewn_union(field, hewn_z(field), saddle);
}

/* Kernels take on trust that a sum of squares is a number only as far out as it is. */
static void test_far_out(void **state)
{
    (void)state;
    subject made = make_subject(make_saddle);
    hewn_extract_desc near = {.bounds = unit_cube, .resolution = 24, .method = HEWN_METHOD_MARCHING_CUBES};
    hewn_extract_desc far = {.bounds = {{1e24, 1e24, -1e24}, {2e25, 2e25, 1e24}}, .resolution = 24};
    hewn_triangles before, mesh, after;
    hewn_error error = {0};
    must(hewn_extract(made.extractor, &near, &before, NULL, &error), &error);
    assert_int_equal(hewn_extract(made.extractor, &far, &mesh, NULL, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "NaN"));
    must(hewn_extract(made.extractor, &near, &after, NULL, &error), &error);
    assert_true(before.triangle_count > 0);
    assert_int_equal(before.triangle_count, after.triangle_count);
    assert_memory_equal(before.positions, after.positions, 12 * before.vertex_count);
    assert_memory_equal(before.indices, after.indices, 12 * before.triangle_count);
    hewn_triangles_destroy(&before);
    hewn_triangles_destroy(&after);
    free_subject(&made);
}

typedef struct countdown {
    int left;
} countdown;

static bool count_down(void *user, const char *name, double share)
{
    (void)name;
    (void)share;
    countdown *counter = user;
    return counter->left-- > 0;
}

static void test_cancel_at_every_stage(void **state)
{
    (void)state;
    subject made = make_subject(make_sphere);
    for (int stages = 0; stages < 5; stages++) {
        countdown counter = {stages};
        hewn_progress progress = {count_down, &counter};
        hewn_extract_desc desc = {
            .bounds = unit_cube, .resolution = 32, .progress = &progress, .method = HEWN_METHOD_MARCHING_CUBES};
        hewn_error error = {0};
        hewn_triangles mesh;
        assert_int_equal(hewn_extract(made.extractor, &desc, &mesh, NULL, &error), HEWN_CANCELLED);
        assert_null(mesh.positions);
    }
    free_subject(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_as_the_twin),
        cmocka_unit_test(test_noise_is_a_closed_manifold),
        cmocka_unit_test(test_several_levels_of_culling),
        cmocka_unit_test(test_vertices_lie_on_the_surface),
        cmocka_unit_test(test_crossings_are_solved_not_interpolated),
        cmocka_unit_test(test_normals_are_gradients),
        cmocka_unit_test(test_volume_converges_by_the_square),
        cmocka_unit_test(test_caps_lie_on_grown_bounds),
        cmocka_unit_test(test_long_grids),
        cmocka_unit_test(test_same_bytes_every_time),
        cmocka_unit_test(test_refusals_say_why),
        cmocka_unit_test(test_far_out),
        cmocka_unit_test(test_cancel_at_every_stage),
    };
    return cmocka_run_group_tests_name("extract", tests, open_device, close_device);
}
