/* Control meshes for the tests of subdivision. */
#ifndef HEWN_TEST_SUBDIVIDE_SUPPORT_H
#define HEWN_TEST_SUBDIVIDE_SUPPORT_H

#include "hewn/io.h"
#include "hewn/subdivide.h"
#include "test_model_support.h"

static inline hewn_subdivision *subdivide(const hewn_model *model, const hewn_subdivide_desc *desc)
{
    hewn_error error = {0};
    hewn_subdivision *out;
    hewn_polygons polygons = hewn_model_polygons(model);
    if (hewn_subdivision_create(&polygons, desc, &out, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return out;
}

/* Values of the last level; the caller frees them (hewn_free). */
static inline double *evaluate(const hewn_subdivision *subdivision, const double *control)
{
    double *out = hewn_alloc(hewn_subdivision_vert_count(subdivision), 3 * sizeof *out);
    assert_non_null(out);
    assert_int_equal(hewn_subdivision_evaluate(subdivision, control, 3, out, NULL), HEWN_OK);
    return out;
}

static inline hewn_model cube_of_quads(void)
{
    static const uint32_t corners[] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    hewn_model model = make_model(8, 6, 24, true);
    for (uint32_t i = 0; i < 24; i++)
        model.positions[i] = (i / 3 >> i % 3 & 1) ? 0.5 : -0.5;
    for (uint32_t f = 0; f <= 6; f++)
        model.first[f] = 4ull * f;
    memcpy(model.corners, corners, sizeof corners);
    return model;
}

/* A sheet of n × n squares with some faces missing (so boundaries of all kinds), and some cut in two or joined to a
 * pentagon where `mixed`; all triangles where `triangles`. Manifold. */
static inline hewn_model make_sheet(uint32_t n, bool mixed, bool triangles, random_state *random)
{
    uint32_t side = n + 1;
    hewn_model model = make_model((uint64_t)side * side, 2ull * n * n, 6ull * n * n, true);
    for (uint32_t v = 0; v < side * side; v++) {
        model.positions[3 * (size_t)v] = v % side + 0.3 * random_unit(random);
        model.positions[3 * (size_t)v + 1] = v / side + 0.3 * random_unit(random);
        model.positions[3 * (size_t)v + 2] = random_unit(random);
    }
    uint32_t hole = random_below(random, n), face = 0, corner = 0;
    for (uint32_t f = 0; f < n * n; f++) {
        uint32_t a = f / n * side + f % n, quad[4] = {a, a + 1, a + side + 1, a + side};
        if (f % n == hole && f / n > 0 && f / n < n - 1 && f / n % 2 == 1)
            continue;
        bool cut = triangles || (mixed && random_below(random, 3) == 0);
        uint32_t turn = random_below(random, 4);
        for (uint32_t k = 0; k < (cut ? 6u : 4u); k++) {
            static const uint32_t halves[] = {0, 1, 2, 0, 2, 3};
            model.corners[corner++] = quad[((cut ? halves[k] : k) + turn) % 4];
            if (cut && k == 2)
                model.first[++face] = corner;
        }
        model.first[++face] = corner;
    }
    model.face_count = face;
    if (triangles) {
        hewn_free(model.first);
        model.first = NULL;
    }
    return model;
}

/* Drops vertices without a face. */
static inline void drop_isolated(hewn_model *model)
{
    uint32_t *number = calloc(model->vertex_count, sizeof *number), count = 0;
    assert_non_null(number);
    for (uint64_t c = 0; c < hewn_model_corner_count(model); c++)
        number[model->corners[c]] = 1;
    for (uint32_t v = 0; v < model->vertex_count; v++) {
        if (!number[v])
            continue;
        memmove(model->positions + 3 * (size_t)count, model->positions + 3 * (size_t)v, 3 * sizeof(double));
        number[v] = count++;
    }
    for (uint64_t c = 0; c < hewn_model_corner_count(model); c++)
        model->corners[c] = number[model->corners[c]];
    model->vertex_count = count;
    free(number);
}

/* Random creases and corners over the edges of a model. */
typedef struct tags {
    hewn_crease creases[400];
    hewn_corner_tag corners[100];
    uint64_t crease_count, corner_count;
} tags;

static inline double random_sharpness(random_state *random)
{
    uint32_t kind = random_below(random, 5);
    return kind == 0 ? 10 : kind == 1 ? 1 + random_below(random, 3) : 3.5 * random_unit(random);
}

static inline void make_tags(const hewn_model *model, uint32_t one_in, tags *out, random_state *random)
{
    out->crease_count = out->corner_count = 0;
    for (uint64_t f = 0; f < model->face_count; f++) {
        uint64_t begin = model->first ? model->first[f] : 3 * f, end = model->first ? model->first[f + 1] : 3 * f + 3;
        for (uint64_t c = begin; c < end; c++) {
            uint32_t a = model->corners[c], b = model->corners[c + 1 < end ? c + 1 : begin];
            if (random_below(random, one_in) || out->crease_count == 400 || a > b)
                continue;
            out->creases[out->crease_count++] = (hewn_crease){{a, b}, random_sharpness(random)};
        }
    }
    for (uint32_t v = 0; v < model->vertex_count && out->corner_count < 100; v++)
        if (random_below(random, 3 * one_in) == 0)
            out->corners[out->corner_count++] = (hewn_corner_tag){v, random_sharpness(random)};
}

#endif
