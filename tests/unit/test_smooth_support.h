/* What the tests of smoothing share: shapes in double precision, and one way to call. */
#ifndef HEWN_TEST_SMOOTH_SUPPORT_H
#define HEWN_TEST_SMOOTH_SUPPORT_H

#include "hewn/io.h"
#include "hewn/smooth.h"
#include "test_model_support.h"

static const hewn_smooth_method all_methods[] = {HEWN_SMOOTH_TAUBIN,   HEWN_SMOOTH_LAPLACIAN, HEWN_SMOOTH_COTAN,
                                                 HEWN_SMOOTH_IMPLICIT, HEWN_SMOOTH_BILATERAL, HEWN_SMOOTH_HC};

static inline void smooth(const hewn_model *model, const hewn_smooth_desc *desc, double *positions,
                          hewn_smooth_report *report)
{
    hewn_error error = {0};
    hewn_polygons polygons = hewn_model_polygons(model);
    if (hewn_polygons_smooth(&polygons, desc, positions, report, &error) != HEWN_OK)
        fail_msg("%s", error.message);
}

static inline double *make_positions(const hewn_model *model)
{
    double *positions = hewn_alloc(model->vertex_count, 3 * sizeof *positions);
    assert_non_null(positions);
    memcpy(positions, model->positions, model->vertex_count * 3 * sizeof *positions);
    return positions;
}

/* A model of triangles; takes them over. */
static inline hewn_model model_of(hewn_triangles triangles)
{
    hewn_model model =
        make_model(triangles.vertex_count, triangles.triangle_count, 3 * triangles.triangle_count, false);
    for (uint64_t i = 0; i < 3 * triangles.vertex_count; i++)
        model.positions[i] = (double)triangles.positions[i];
    memcpy(model.corners, triangles.indices, triangles.triangle_count * 3 * sizeof(uint32_t));
    hewn_triangles_destroy(&triangles);
    return model;
}

/* An octahedron whose triangles are cut in n × n, on the sphere of radius r: valences 4 and 6. */
static inline hewn_model make_sphere(uint32_t n, double r)
{
    uint32_t side = 2 * n + 1, grid = side * side;
    uint32_t *number = malloc(2 * grid * sizeof *number);
    assert_non_null(number);
    hewn_model model = make_model(4ull * n * n + 2, 8ull * n * n, 24ull * n * n, false);
    uint32_t count = 0, face = 0;
    for (uint32_t side_at = 0; side_at < 2 * grid; side_at++) { /* the octahedron unfolded: |x| + |y| <= n, z by side */
        int x = (int)(side_at % side) - (int)n, y = (int)(side_at / side % side) - (int)n;
        int z = (int)n - abs(x) - abs(y), up = side_at < grid ? 1 : -1;
        number[side_at] = HEWN_NONE;
        if (z < 0 || (z == 0 && up < 0)) {
            number[side_at] = z == 0 ? number[side_at - grid] : HEWN_NONE;
            continue;
        }
        double p[3] = {x, y, up * z}, length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (int axis = 0; axis < 3; axis++)
            model.positions[3 * (size_t)count + (size_t)axis] = r * p[axis] / length;
        number[side_at] = count++;
    }
    assert_int_equal(count, model.vertex_count);
    static const int signs[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    for (int up = 0; up < 2; up++)
        for (int quadrant = 0; quadrant < 4; quadrant++)
            for (int i = 0; i < (int)n; i++)
                for (int j = 0; j < (int)n - i; j++)
                    for (int second = 0; second < (i + j + 1 < (int)n ? 2 : 1); second++) {
                        int a[3][2] = {
                            {i + second, j + second}, {i + 1 - second, j + second}, {i + second, j + 1 - second}};
                        if (second)
                            a[0][0] = i + 1, a[0][1] = j + 1, a[1][0] = i, a[1][1] = j + 1, a[2][0] = i + 1,
                            a[2][1] = j;
                        bool turn = (signs[quadrant][0] * signs[quadrant][1] < 0) != (up == 1);
                        for (int k = 0; k < 3; k++) {
                            int *at = a[turn && k > 0 ? 3 - k : k];
                            int x = signs[quadrant][0] * at[0] + (int)n, y = signs[quadrant][1] * at[1] + (int)n;
                            model.corners[3 * (size_t)face + (size_t)k] =
                                number[(uint32_t)up * grid + (uint32_t)y * side + (uint32_t)x];
                        }
                        face++;
                    }
    assert_int_equal(face, model.face_count);
    free(number);
    return model;
}

static inline double distance(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* Triangles that name vertices at random: non-manifold, degenerate, duplicate, with vertices at one place. */
static inline hewn_model make_soup(random_state *random)
{
    uint32_t vertices = 3 + random_below(random, 30), faces = random_below(random, 60);
    hewn_model model = make_model(vertices, faces, 3ull * faces, false);
    double scale = pow(10, 20 * random_unit(random) - 10);
    for (uint32_t i = 0; i < 3 * vertices; i++)
        model.positions[i] = scale * (random_below(random, 3) ? random_unit(random) : random_below(random, 2));
    for (uint32_t c = 0; c < 3 * faces; c++)
        model.corners[c] = random_below(random, vertices);
    return model;
}

/* Normal noise of this deviation in every coordinate. */
static inline void add_noise(hewn_model *model, double deviation, random_state *random)
{
    for (uint64_t i = 0; i < 3 * model->vertex_count; i++) {
        double u = random_unit(random), v = random_unit(random);
        model->positions[i] += deviation * sqrt(-2 * log(1 - u)) * cos(2 * M_PI * v);
    }
}

static inline double mean_edge(const hewn_model *model)
{
    double sum = 0;
    for (uint64_t c = 0; c < 3 * model->face_count; c++)
        sum += distance(model->positions + 3 * (size_t)model->corners[c],
                        model->positions + 3 * (size_t)model->corners[c % 3 == 2 ? c - 2 : c + 1]);
    return sum / (3 * (double)model->face_count);
}

/* Reads a file of the test data; false where there is none. */
static inline bool read_data(const char *name, hewn_model *out)
{
    char folder[4096], path[4096 + 256];
    if (!data_folder(folder))
        return false;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    hewn_error error = {0};
    if (hewn_model_read(path, NULL, out, &error) != HEWN_OK)
        fail_msg("%s: %s", path, error.message);
    return true;
}

#endif
