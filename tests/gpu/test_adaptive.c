/* What adaptive collapse is for, on a machine part: the same distance from the true surface with a fraction of the
 * triangles. The distance is measured both ways: from area-uniform points of a mesh to the field, and from points of
 * the surface (vertices of marching cubes on a finer grid, solved on the field) to the mesh. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "eval/code.h"
#include "geom/bvh.h"
#include "geom/near_triangle.h"
#include "hewn/hewn.h"

static hewn_device *device;
static hewn_scene *scene;
static hewn_extractor *extractor;
static hewn_code *code;
static hewn_box bounds;
static hewn_triangles truth;

static void must(hewn_result result, const hewn_error *error)
{
    if (result != HEWN_OK)
        fail_msg("%s", error->message);
}

static hewn_triangles extract(hewn_method method, uint32_t resolution, double adaptive, hewn_extract_stats *stats)
{
    hewn_error error = {0};
    hewn_triangles out;
    hewn_extract_desc desc = {.bounds = bounds, .resolution = resolution, .method = method, .adaptive = adaptive};
    must(hewn_extract(extractor, &desc, &out, stats, &error), &error);
    return out;
}

enum { RESOLUTION = 128 };

static int open_all(void **state)
{
    (void)state;
    hewn_error error = {0};
    hewn_device_desc desc = {.validation = true};
    const char *folder = getenv("HEWN_SOURCE");
    char path[4096];
    snprintf(path, sizeof path, "%s/assets/scenes/bracket.lua", folder ? folder : ".");
    hewn_scene_desc from = {.path = path};
    if (hewn_device_create(&desc, &device, &error) != HEWN_OK || hewn_scene_load(&from, &scene, &error) != HEWN_OK) {
        print_error("%s\n", error.message);
        return -1;
    }
    const hewn_field *field = hewn_scene_field(scene);
    if (!hewn_scene_bounds(scene, &bounds) ||
        hewn_extractor_create(device, field, hewn_field_root(field), &extractor, &error) != HEWN_OK ||
        hewn_code_create(device, field, hewn_field_root(field), &code, &error) != HEWN_OK) {
        print_error("%s\n", error.message);
        return -1;
    }
    truth = extract(HEWN_METHOD_MARCHING_CUBES, 2 * RESOLUTION + 31, 0, NULL);
    return 0;
}

static int close_all(void **state)
{
    (void)state;
    hewn_triangles_destroy(&truth);
    hewn_code_destroy(device, &code);
    hewn_extractor_destroy(&extractor);
    hewn_scene_destroy(&scene);
    uint64_t messages = hewn_device_message_count(device);
    hewn_device_destroy(&device);
    return messages == 0 ? 0 : -1;
}

/* --- distances -----------------------------------------------------------------------------------------------------
 */

static void corners_of(const hewn_triangles *mesh, uint64_t triangle, double out[9])
{
    for (uint64_t k = 0; k < 9; k++)
        out[k] = (double)mesh->positions[3 * (uint64_t)mesh->indices[3 * triangle + k / 3] + k % 3];
}

static double area_of(const double p[9])
{
    double u[3] = {p[3] - p[0], p[4] - p[1], p[5] - p[2]}, v[3] = {p[6] - p[0], p[7] - p[1], p[8] - p[2]};
    return hypot(hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2]), u[0] * v[1] - u[1] * v[0]) / 2;
}

/* A sequence that fills the unit interval evenly (the golden ratio's multiples). */
static double spread(uint64_t i, double step)
{
    double at = (double)i * step;
    return at - floor(at);
}

/* Largest |f| / |grad f| over points spread evenly over the area. */
static double off_the_field(const hewn_triangles *mesh)
{
    enum { POINTS = 300000 };
    hewn_error error = {0};
    float *points = malloc(3 * POINTS * sizeof *points), *values = malloc(4 * POINTS * sizeof *values);
    assert_non_null(points);
    assert_non_null(values);
    double area = 0, before = 0, p[9], most = 0;
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        corners_of(mesh, t, p);
        area += area_of(p);
    }
    uint64_t t = 0;
    corners_of(mesh, 0, p);
    for (uint64_t i = 0; i < POINTS; i++) {
        while (before + area_of(p) < area * ((double)i + 0.5) / POINTS && t + 1 < mesh->triangle_count) {
            before += area_of(p);
            corners_of(mesh, ++t, p);
        }
        double u = spread(i, 0.7548776662466927), v = spread(i, 0.5698402909980532);
        bool fold = u + v > 1;
        u = fold ? 1 - u : u;
        v = fold ? 1 - v : v;
        for (size_t axis = 0; axis < 3; axis++)
            points[3 * i + axis] = (float)(p[axis] + u * (p[3 + axis] - p[axis]) + v * (p[6 + axis] - p[axis]));
    }
    must(hewn_code_eval_gradients(device, code, points, POINTS, values, &error), &error);
    for (size_t i = 0; i < POINTS; i++) {
        const float *g = values + 4 * i;
        double off = fabs((double)g[0]) / hypot(hypot((double)g[1], (double)g[2]), (double)g[3]);
        most = isfinite(off) ? fmax(most, off) : most;
    }
    free(points);
    free(values);
    return most;
}

static double distance_to(const hewn_triangles *mesh, const hewn_bvh *bvh, const float at[3], double reach)
{
    double least = INFINITY, from[3] = {(double)at[0], (double)at[1], (double)at[2]};
    for (; !(least <= reach * reach); reach *= 2) {
        float lo[3], hi[3];
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = (float)(from[axis] - reach);
            hi[axis] = (float)(from[axis] + reach);
        }
        hewn_bvh_walk walk = hewn_bvh_walk_begin(bvh, lo, hi, 0);
        for (uint64_t block; hewn_bvh_walk_next(&walk, &block);)
            for (uint64_t slot = 4 * block; slot < 4 * block + 4; slot++) {
                double p[9];
                corners_of(mesh, bvh->order[slot], p);
                least = fmin(least, hewn_triangle_distance_squared(from, p, p + 3, p + 6));
            }
    }
    return sqrt(least);
}

static double off_the_mesh(const hewn_triangles *mesh, double cell)
{
    hewn_error error = {0};
    hewn_triangle_view view = {mesh->vertex_count, mesh->triangle_count, NULL, mesh->positions, mesh->indices};
    hewn_bvh bvh;
    double most = 0;
    must(hewn_bvh_build(&view, &bvh, &error), &error);
    for (uint64_t i = 0; i < truth.vertex_count; i++)
        most = fmax(most, distance_to(mesh, &bvh, &truth.positions[3 * i], cell / 4));
    hewn_bvh_free(&bvh);
    return most;
}

static double deviation(const hewn_triangles *mesh, double cell)
{
    return fmax(off_the_field(mesh), off_the_mesh(mesh, cell));
}

/* --- the number ----------------------------------------------------------------------------------------------------
 */

static void check_mesh(const hewn_triangles *mesh)
{
    hewn_error error = {0};
    hewn_certificate certificate;
    uint64_t crossings;
    must(hewn_certify(mesh, NULL, &certificate, &error), &error);
    assert_true(certificate.closed && certificate.manifold && certificate.oriented);
    assert_int_equal(certificate.genus, 11);
    assert_int_equal(certificate.components, 1);
    must(hewn_triangles_count_self_intersections(mesh, 0, NULL, NULL, &crossings, &error), &error);
    assert_int_equal(crossings, 0);
}

/* A uniform mesh with ten times the triangles is farther from the surface. (The goal was five times.) */
static void test_bracket(void **state)
{
    (void)state;
    hewn_extract_stats stats;
    double error = 0.05; /* millimetres: about a twentieth of a cell */
    hewn_triangles adaptive = extract(HEWN_METHOD_DC, RESOLUTION, error, &stats);
    check_mesh(&adaptive);
    double off = deviation(&adaptive, stats.cell);
    hewn_triangles uniform = extract(HEWN_METHOD_DC, RESOLUTION, 0, &stats);
    double share = (double)uniform.triangle_count / (double)adaptive.triangle_count;
    print_message("# %u cells: %llu triangles, %g off; adaptive %g: %llu triangles, %g off\n", (unsigned)RESOLUTION,
                  (unsigned long long)uniform.triangle_count, deviation(&uniform, stats.cell), error,
                  (unsigned long long)adaptive.triangle_count, off);
    hewn_triangles_destroy(&uniform);
    assert_true(share > 10);
    hewn_triangles coarse = extract(HEWN_METHOD_DC, (uint32_t)(RESOLUTION * sqrt(10 / share)), 0, &stats);
    double coarse_off = deviation(&coarse, stats.cell);
    print_message("# %llu uniform triangles: %g off\n", (unsigned long long)coarse.triangle_count, coarse_off);
    assert_true(coarse_off > off);
    hewn_triangles_destroy(&coarse);
    hewn_triangles_destroy(&adaptive);
}

/* The surface stays within the error of where a uniform mesh has it. */
static void test_error_is_kept(void **state)
{
    (void)state;
    hewn_extract_stats stats;
    hewn_triangles uniform = extract(HEWN_METHOD_DC, RESOLUTION, 0, &stats);
    double off = deviation(&uniform, stats.cell);
    hewn_triangles_destroy(&uniform);
    for (double error = 0.1; error < 1; error *= 4) {
        hewn_triangles mesh = extract(HEWN_METHOD_DC, RESOLUTION, error, &stats);
        double now = deviation(&mesh, stats.cell);
        print_message("# error %g: %llu triangles, %g off; uniform %g\n", error,
                      (unsigned long long)mesh.triangle_count, now, off);
        assert_true(now <= 1.25 * error + off);
        check_mesh(&mesh);
        hewn_triangles_destroy(&mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bracket),
        cmocka_unit_test(test_error_is_kept),
    };
    return cmocka_run_group_tests_name("adaptive", tests, open_all, close_all);
}
