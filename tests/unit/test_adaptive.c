/* Adaptive collapse of dual surfaces that the serial twin makes: closed manifolds of the same topology, within the
 * error that was asked for, with sharp corners where they were, the same for any number of threads. HEWN_LONG asks for
 * finer grids and more of them. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../oracle/dual.h"
#include "../oracle/random_grid.h"
#include "geom/bvh.h"
#include "geom/near_triangle.h"
#include "hewn/check.h"
#include "iso/adaptive.h"

static void must(hewn_result result, const hewn_error *error)
{
    if (result != HEWN_OK)
        fail_msg("%s", error->message);
}

/* --- fields -------------------------------------------------------------------------------------------------------- */

typedef hewn_node maker(hewn_field *field, uint64_t seed);

static hewn_node make_sphere(hewn_field *field, uint64_t seed)
{
    (void)seed;
    return hewn_translate(field, hewn_sphere(field, 0.8), 0.01, -0.02, 0.013);
}

static hewn_node make_box(hewn_field *field, uint64_t seed)
{
    (void)seed;
    return hewn_translate(field, hewn_box_shape(field, 1.313, 1.171, 1.457), 0.0123, 0.0321, -0.0217);
}

static hewn_node make_turned_box(hewn_field *field, uint64_t seed)
{
    return hewn_rotate(field, hewn_box_shape(field, 1, 0.8, 1.1), 1, 2, 0.5, 0.3 + 0.1 * (double)seed);
}

static hewn_node make_csg(hewn_field *field, uint64_t seed)
{
    (void)seed;
    hewn_node body = hewn_intersection(field, hewn_box_shape(field, 1.4, 1.4, 1.4), hewn_sphere(field, 0.93));
    hewn_node bore = hewn_cylinder(field, 0.4, 3);
    hewn_node bores = hewn_union(field, bore, hewn_rotate(field, bore, 1, 0, 0, 1.5707963));
    return hewn_difference(field, body, hewn_union(field, bores, hewn_rotate(field, bore, 0, 0, 1, 1.5707963)));
}

static double random_between(uint64_t *random, double low, double high)
{
    return low + (high - low) * (random_below(random, 1 << 20) / (double)(1 << 20));
}

/* Balls and boxes, added and taken away: thin walls, edges, pieces of all sizes. */
static hewn_node make_random(hewn_field *field, uint64_t seed)
{
    uint64_t random = seed * 2654435761u + 99;
    hewn_node all = hewn_sphere(field, 0.5);
    for (int i = 0; i < 12; i++) {
        double size = random_between(&random, 0.1, 0.5);
        hewn_node one = random_below(&random, 2) ? hewn_sphere(field, size)
                                                 : hewn_box_shape(field, 2 * size, size, 1.5 * size);
        one = hewn_rotate(field, one, 1, random_between(&random, -2, 2), 0.4, random_between(&random, 0, 6));
        one = hewn_translate(field, one, random_between(&random, -0.6, 0.6), random_between(&random, -0.6, 0.6),
                             random_between(&random, -0.6, 0.6));
        all = random_below(&random, 3) ? hewn_union(field, all, one) : hewn_difference(field, all, one);
    }
    return all;
}

/* Signs that jump from sample to sample: many loops a cell, and faces joined the other way. */
static hewn_node make_noise(hewn_field *field, uint64_t seed)
{
    hewn_node x = hewn_x(field), y = hewn_y(field), z = hewn_z(field);
    hewn_node sum = hewn_add(field, hewn_mul(field, x, hewn_constant(field, 127.1 + (double)seed)),
                             hewn_add(field, hewn_mul(field, y, hewn_constant(field, 311.7)),
                                      hewn_mul(field, z, hewn_constant(field, 74.7))));
    return hewn_add(field, hewn_sin(field, hewn_mul(field, sum, hewn_constant(field, 3.3))),
                    hewn_constant(field, -0.3));
}

static hewn_dual_surface make_surface(maker *make, uint64_t seed, uint32_t resolution, bool open)
{
    hewn_error error = {0};
    hewn_field *field;
    must(hewn_field_create(&field, &error), &error);
    hewn_node root = make(field, seed);
    must(hewn_field_status(field, &error), &error);
    hewn_extract_desc desc = {.bounds = {{-1, -1, -1}, {1, 1, 1}}, .resolution = resolution, .open = open};
    if (open)
        desc.bounds = (hewn_box){{-0.6, -0.7, -0.5}, {0.6, 0.7, 0.5}};
    hewn_dual_surface surface = oracle_dual_surface(field, root, &desc, false);
    hewn_field_destroy(&field);
    return surface;
}

/* --- distances ----------------------------------------------------------------------------------------------------- */

static double distance_to(const hewn_triangles *mesh, const hewn_bvh *bvh, const double at[3], double reach)
{
    double least = INFINITY;
    for (; !(least <= reach * reach); reach *= 2) {
        float lo[3], hi[3];
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = (float)(at[axis] - reach);
            hi[axis] = (float)(at[axis] + reach);
        }
        hewn_bvh_walk walk = hewn_bvh_walk_begin(bvh, lo, hi, 0);
        for (uint64_t block; hewn_bvh_walk_next(&walk, &block);)
            for (uint64_t slot = 4 * block; slot < 4 * block + 4; slot++) {
                double p[9];
                for (int k = 0; k < 9; k++)
                    p[k] = (double)
                               mesh->positions[3 * mesh->indices[3 * (size_t)bvh->order[slot] + (size_t)(k / 3)] +
                                               (uint32_t)(k % 3)];
                least = fmin(least, hewn_triangle_distance_squared(at, p, p + 3, p + 6));
            }
    }
    return sqrt(least);
}

/* The largest distance of points of one mesh, not farther apart than `step`, from another. */
static double deviation(const hewn_triangles *from, const hewn_triangles *to, double step)
{
    hewn_triangle_view view = {to->vertex_count, to->triangle_count, NULL, to->positions, to->indices};
    hewn_bvh bvh;
    hewn_error error = {0};
    double most = 0;
    must(hewn_bvh_build(&view, &bvh, &error), &error);
    for (uint64_t t = 0; t < from->triangle_count; t++) {
        const float *p[3];
        double longest = 0;
        for (int k = 0; k < 3; k++)
            p[k] = &from->positions[3 * (size_t)from->indices[3 * t + (uint64_t)k]];
        for (int k = 0; k < 3; k++)
            longest = fmax(longest, hypot(hypot(p[k][0] - p[(k + 1) % 3][0], p[k][1] - p[(k + 1) % 3][1]),
                                          p[k][2] - p[(k + 1) % 3][2]));
        int parts = (int)fmin(60, ceil(longest / step) + 1);
        for (int i = 0; i <= parts; i++)
            for (int j = 0; i + j <= parts; j++) {
                double at[3], u = (double)i / parts, v = (double)j / parts;
                for (int axis = 0; axis < 3; axis++)
                    at[axis] = p[0][axis] + u * (p[1][axis] - p[0][axis]) + v * (p[2][axis] - p[0][axis]);
                most = fmax(most, distance_to(to, &bvh, at, step / 4));
            }
    }
    hewn_bvh_free(&bvh);
    return most;
}

/* --- what must be true --------------------------------------------------------------------------------------------- */

typedef struct outcome {
    hewn_triangles mesh;
    hewn_adaptive_stats stats;
    hewn_certificate before, after;
    double deviation; /* both ways; only where asked for */
} outcome;

static int64_t euler_of(const hewn_triangles *mesh, const hewn_certificate *certificate)
{
    bool *used = calloc(mesh->vertex_count + 1, 1);
    int64_t vertices = 0;
    for (uint64_t i = 0; i < 3 * mesh->triangle_count; i++) {
        vertices += !used[mesh->indices[i]];
        used[mesh->indices[i]] = true;
    }
    free(used);
    int64_t edges = (int64_t)(3 * mesh->triangle_count + certificate->boundary_edges) / 2;
    return vertices - edges + (int64_t)mesh->triangle_count;
}

static outcome collapse(const hewn_dual_surface *surface, double length, bool measured, const char *what)
{
    outcome out = {0};
    hewn_error error = {0};
    hewn_triangles uniform = oracle_dual_triangles(surface);
    must(hewn_adaptive_collapse(surface, length, NULL, &out.mesh, &out.stats, &error), &error);
    must(hewn_certify(&uniform, NULL, &out.before, &error), &error);
    must(hewn_certify(&out.mesh, NULL, &out.after, &error), &error);
    bool same = out.before.closed == out.after.closed && out.before.components == out.after.components &&
                euler_of(&uniform, &out.before) == euler_of(&out.mesh, &out.after);
    if (!out.after.manifold || !out.after.oriented || !same || !out.before.manifold)
        fail_msg("%s, error %g: manifold %d, oriented %d, closed %d (%d), Euler number %lld (%lld), components %llu "
                 "(%llu)",
                 what, length, out.after.manifold, out.after.oriented, out.after.closed, out.before.closed,
                 (long long)euler_of(&out.mesh, &out.after), (long long)euler_of(&uniform, &out.before),
                 (unsigned long long)out.after.components, (unsigned long long)out.before.components);
    if (measured) {
        double step = (double)surface->grid.cell / 2;
        out.deviation = fmax(deviation(&uniform, &out.mesh, step), deviation(&out.mesh, &uniform, step));
    }
    print_message("%s, error %.4g cells: %llu to %llu triangles (%llu after the octree), deviation %.3f of it; "
                  "refused %llu %llu %llu %llu, centres %llu\n",
                  what, length / (double)surface->grid.cell, (unsigned long long)uniform.triangle_count,
                  (unsigned long long)out.mesh.triangle_count, 2 * (unsigned long long)out.stats.octree_vertices,
                  out.deviation / (length + 1e-9), (unsigned long long)out.stats.refused[0],
                  (unsigned long long)out.stats.refused[1], (unsigned long long)out.stats.refused[2],
                  (unsigned long long)out.stats.refused[3], (unsigned long long)out.stats.centres);
    hewn_triangles_destroy(&uniform);
    return out;
}

static void test_shapes(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        maker *make;
        uint32_t resolution;
    } shapes[] = {{"sphere", make_sphere, 48},   {"box", make_box, 40},       {"turned box", make_turned_box, 48},
                  {"csg", make_csg, 48},         {"random", make_random, 48}, {"noise", make_noise, 12}};
    static const double errors[] = {0, 0.01, 0.1, 0.5, 2};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        hewn_dual_surface surface = make_surface(shapes[i].make, 1, shapes[i].resolution, false);
        for (size_t k = 0; k < sizeof errors / sizeof *errors; k++) {
            outcome out = collapse(&surface, errors[k] * (double)surface.grid.cell, true, shapes[i].name);
            hewn_triangles_destroy(&out.mesh);
        }
        oracle_dual_surface_free(&surface);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes),
    };
    return cmocka_run_group_tests_name("adaptive", tests, NULL, NULL);
}
