/* What the tests of dual meshes' geometry share: fields with numbers to turn, meshes by cell, distances to a surface.
 */
#ifndef HEWN_TESTS_TEST_DUAL_SUPPORT_H
#define HEWN_TESTS_TEST_DUAL_SUPPORT_H

#include <math.h>

#include "gpu_test.h"

#include "hewn/hewn.h"
#include "iso/cube.h"
#include "iso/extractor.h"

typedef struct dual_fixture {
    hewn_device *device;
    unsigned messages;
} dual_fixture;

static inline int dual_open(void **state)
{
    static dual_fixture shared;
    shared.device = gpu_test_open(&shared.messages);
    *state = &shared;
    return 0;
}

static inline int dual_close(void **state)
{
    dual_fixture *f = *state;
    gpu_test_close(&f->device, &f->messages);
    return 0;
}

static inline double dual_between(uint64_t *random, double lo, double hi)
{
    return lo + (hi - lo) * (gpu_test_random(random) / 4294967295.0);
}

/* A right-handed turn about an axis of any length (Rodrigues). */
static inline void dual_turn(const double axis[3], double angle, double out[3][3])
{
    double size = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]), c = cos(angle), s = sin(angle);
    double n[3] = {axis[0] / size, axis[1] / size, axis[2] / size};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int k = 3 - i - j;
            double across = i == j ? 0 : (j - i + 3) % 3 == 1 ? -n[k] : n[k];
            out[i][j] = (i == j ? c : 0) + (1 - c) * n[i] * n[j] + s * across;
        }
}

/* --- subjects
 * ---------------------------------------------------------------------------------------------------------- */

typedef hewn_node dual_maker(hewn_field *field, const void *user);

typedef struct dual_subject {
    hewn_field *field;
    hewn_node root;
    hewn_extractor *extractor;
} dual_subject;

static inline hewn_field *dual_field(dual_maker *make, const void *user, hewn_node *root)
{
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    *root = make(field, user);
    GPU_TEST_TRY(hewn_field_status(field, &error));
    return field;
}

static inline dual_subject dual_make(dual_fixture *f, dual_maker *make, const void *user)
{
    dual_subject made = {0};
    made.field = dual_field(make, user, &made.root);
    GPU_TEST_TRY(hewn_extractor_create(f->device, made.field, made.root, &made.extractor, &error));
    return made;
}

/* The same expression with other numbers: nothing is compiled. */
static inline void dual_renumber(dual_subject *subject, dual_maker *make, const void *user)
{
    bool taken = false;
    hewn_field_destroy(&subject->field);
    subject->field = dual_field(make, user, &subject->root);
    GPU_TEST_TRY(hewn_extractor_renumber(subject->extractor, subject->field, subject->root, &taken, &error));
    assert_true(taken);
}

static inline void dual_free(dual_subject *subject)
{
    hewn_extractor_destroy(&subject->extractor);
    hewn_field_destroy(&subject->field);
}

/* --- meshes --------------------------------------------------------------------------------------------------------
 */

typedef struct dual_mesh {
    hewn_triangles triangles;
    struct hewn_grid grid;
} dual_mesh;

static inline dual_mesh dual_extract(const dual_subject *subject, uint32_t cells, hewn_method method,
                                     hewn_extract_stats *stats)
{
    const hewn_extract_desc desc = {.bounds = {{-1, -1, -1}, {1, 1, 1}}, .resolution = cells, .method = method};
    dual_mesh mesh;
    hewn_box grown;
    GPU_TEST_TRY(hewn_grid_lay(&desc, &mesh.grid, &grown, &error));
    GPU_TEST_TRY(hewn_extract(subject->extractor, &desc, &mesh.triangles, stats, &error));
    return mesh;
}

/* Distance in cells from a point to the nearest vertex of its cell. */
static inline double dual_nearest(const dual_mesh *mesh, const struct hewn_grid *grid, const uint32_t cell[3],
                                  const double at[3])
{
    double least = INFINITY;
    for (uint64_t i = 0; i < mesh->triangles.vertex_count; i++) {
        double sum = 0;
        bool here = true;
        for (int k = 0; k < 3; k++) {
            double place = (double)mesh->triangles.positions[3 * i + (uint64_t)k];
            sum += (place - at[k]) * (place - at[k]);
            here &= (uint32_t)((place - (double)grid->origin[k]) / (double)grid->cell) == cell[k];
        }
        if (here)
            least = fmin(least, sqrt(sum) / (double)grid->cell);
    }
    return least;
}

/* Into how many parts the inside or the outside corners of a cell fall at most: more than one, and the cell may have
 * several vertices. */
static inline int dual_parts(unsigned pattern)
{
    int most = 0;
    for (int side = 0; side < 2; side++) {
        unsigned left = side ? pattern : ~pattern & 255u;
        int parts = 0;
        while (left) {
            unsigned part = left & -left, grown = 0;
            while (part != grown) {
                grown = part;
                for (unsigned corner = 0; corner < 8; corner++)
                    for (unsigned axis = 0; axis < 3; axis++)
                        part |= grown >> corner & 1 ? (1u << (corner ^ 1u << axis)) & left : 0;
            }
            left &= ~part;
            parts++;
        }
        most = parts > most ? parts : most;
    }
    return most;
}

/* --- distances
 * --------------------------------------------------------------------------------------------------------- */

typedef struct dual_distance {
    double mean, most; /* in cells */
} dual_distance;

/* Walks each point down to the surface; what is left in `points` is the foot. */
static inline void dual_walk(const dual_subject *subject, double *points, size_t count)
{
    double *values = malloc(4 * count * sizeof *values);
    for (int step = 0; step < 6; step++) {
        GPU_TEST_TRY(hewn_field_gradient(subject->field, subject->root, points, count, values, &error));
        for (size_t i = 0; i < count; i++) {
            const double *g = values + 4 * i;
            double square = g[1] * g[1] + g[2] * g[2] + g[3] * g[3];
            for (int k = 0; k < 3 && square > 0; k++)
                points[3 * i + (size_t)k] -= g[0] * g[1 + k] / square;
        }
    }
    free(values);
}

/* Points spread evenly over the area of a mesh's triangles, away from the bounds. */
static inline size_t dual_spread(const dual_mesh *mesh, size_t wanted, double *points)
{
    const hewn_triangles *t = &mesh->triangles;
    uint64_t random = 99;
    double area = 0, next = 0;
    size_t count = 0;
    double *upto = malloc(t->triangle_count * sizeof *upto);
    for (uint64_t i = 0; i < t->triangle_count; i++) {
        double p[3][3];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                p[c][k] = (double)t->positions[3 * (uint64_t)t->indices[3 * i + (uint64_t)c] + (uint64_t)k];
        double a[3], b[3];
        for (int k = 0; k < 3; k++) {
            a[k] = p[1][k] - p[0][k];
            b[k] = p[2][k] - p[0][k];
        }
        double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
        upto[i] = area += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    for (uint64_t i = 0; i < t->triangle_count; i++)
        for (; count < wanted && next < upto[i]; next = area * (double)count / (double)wanted) {
            double u = dual_between(&random, 0, 1), v = dual_between(&random, 0, 1);
            double w[3] = {u + v > 1 ? 1 - u : u, u + v > 1 ? 1 - v : v};
            w[2] = 1 - w[0] - w[1];
            for (int k = 0; k < 3; k++) {
                points[3 * count + (size_t)k] = 0;
                for (int c = 0; c < 3; c++)
                    points[3 * count + (size_t)k] +=
                        w[c] * (double)t->positions[3 * (uint64_t)t->indices[3 * i + (uint64_t)c] + (uint64_t)k];
            }
            count++;
        }
    free(upto);
    return count;
}

static inline dual_distance dual_measure(const dual_subject *subject, const dual_mesh *mesh, size_t wanted)
{
    dual_distance result = {0};
    double *points = malloc(3 * wanted * sizeof *points), *feet = malloc(3 * wanted * sizeof *feet);
    size_t count = dual_spread(mesh, wanted, points), used = 0;
    memcpy(feet, points, 3 * count * sizeof *feet);
    dual_walk(subject, feet, count);
    for (size_t i = 0; i < count; i++) {
        double sum = 0, reach = 0;
        for (size_t k = 3 * i; k < 3 * i + 3; k++) {
            sum += (points[k] - feet[k]) * (points[k] - feet[k]);
            reach = fmax(reach, fabs(points[k]));
        }
        if (reach > 1 - 2 * (double)mesh->grid.cell)
            continue; /* the caps */
        double off = sqrt(sum) / (double)mesh->grid.cell;
        result.mean += off;
        result.most = fmax(result.most, off);
        used++;
    }
    result.mean /= used ? (double)used : 1;
    free(points);
    free(feet);
    return result;
}

#endif
