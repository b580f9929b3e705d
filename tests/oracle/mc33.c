#include "mc33.h"

#include <gmp.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "iso/cube.h"

/* --- decisions ---------------------------------------------------------------------------------------------------- */

/* Values as rationals, which are exact and need no scale. */
static void load(mpq_t into[8], const double values[8])
{
    for (int i = 0; i < 8; i++) {
        mpq_init(into[i]);
        mpq_set_d(into[i], values[i]);
    }
}

static void unload(mpq_t from[8])
{
    for (int i = 0; i < 8; i++)
        mpq_clear(from[i]);
}

/* The sign of a b - c d. */
static int sign_of_minor(const mpq_t a, const mpq_t b, const mpq_t c, const mpq_t d)
{
    mpq_t left, right;
    mpq_inits(left, right, NULL);
    mpq_mul(left, a, b);
    mpq_mul(right, c, d);
    int sign = mpq_cmp(left, right);
    mpq_clears(left, right, NULL);
    return sign;
}

uint32_t oracle_mc33_joined(const double values[8])
{
    uint32_t joined = 0, pattern = 0;
    for (uint32_t c = 0; c < 8; c++)
        pattern |= (values[c] < 0 ? 1u : 0u) << c;
    uint32_t ambiguous = hewn_mc33_ambiguous(pattern);
    if (ambiguous == 0)
        return 0;
    mpq_t v[8];
    load(v, values);
    for (uint32_t face = 0; face < 6; face++) {
        if (!(ambiguous >> face & 1))
            continue;
        uint32_t corner[4];
        hewn_cube_face_corners(face, corner);
        int sign = sign_of_minor(v[corner[0]], v[corner[2]], v[corner[1]], v[corner[3]]);
        if (values[corner[0]] < 0 ? sign > 0 : sign < 0)
            joined |= 1u << face;
    }
    unload(v);
    return joined;
}

/* The upright edges a, b, c, d around the cell; q = a c - b d = q2 z^2 + q1 z + q0. */
typedef struct upright {
    mpq_t q[3], height, here, test;
} upright;

static void multiply_add(mpq_t sum, const mpq_t a, const mpq_t b, bool minus)
{
    mpq_t product;
    mpq_init(product);
    mpq_mul(product, a, b);
    if (minus)
        mpq_sub(sum, sum, product);
    else
        mpq_add(sum, sum, product);
    mpq_clear(product);
}

static void expand(upright *up, mpq_t low[4], mpq_t rise[4])
{
    for (int i = 0; i < 2; i++) {
        multiply_add(up->q[0], low[i], low[i + 2], i);
        multiply_add(up->q[1], low[i], rise[i + 2], i);
        multiply_add(up->q[1], rise[i], low[i + 2], i);
        multiply_add(up->q[2], rise[i], rise[i + 2], i);
    }
}

/* At the extremum of q, if it is within the cell: which join the slice there shows. */
static hewn_mc33_join judge(upright *up, mpq_t low[4], mpq_t rise[4])
{
    if (mpq_sgn(up->q[2]) == 0)
        return HEWN_MC33_NO_JOIN;
    mpq_add(up->test, up->q[2], up->q[2]);
    mpq_div(up->height, up->q[1], up->test);
    mpq_neg(up->height, up->height);
    if (mpq_sgn(up->height) <= 0 || mpq_cmp_ui(up->height, 1, 1) >= 0)
        return HEWN_MC33_NO_JOIN;
    bool in[4];
    for (int i = 0; i < 4; i++) {
        mpq_set(up->here, low[i]);
        multiply_add(up->here, rise[i], up->height, false);
        in[i] = mpq_sgn(up->here) < 0;
    }
    if (in[0] == in[1] || in[0] != in[2] || in[1] != in[3])
        return HEWN_MC33_NO_JOIN;
    mpq_set(up->here, up->q[0]);
    mpq_div_2exp(up->test, up->q[1], 1);
    multiply_add(up->here, up->test, up->height, false);
    bool inside = in[0] ? mpq_sgn(up->here) > 0 : mpq_sgn(up->here) < 0;
    /* A maximum of the joined side's product: only then is it joined here and not at both ends. */
    bool extreme = mpq_sgn(up->q[2]) < 0 ? in[0] == inside : in[0] != inside;
    if (!extreme)
        return HEWN_MC33_NO_JOIN;
    bool first = in[0] == inside; /* whether columns a and c are those that are joined */
    return first ? (inside ? HEWN_MC33_INSIDE_0 : HEWN_MC33_OUTSIDE_0)
                 : (inside ? HEWN_MC33_INSIDE_1 : HEWN_MC33_OUTSIDE_1);
}

hewn_mc33_join oracle_mc33_join(const double values[8])
{
    static const int column[4] = {0, 1, 3, 2};
    mpq_t v[8], low[4], rise[4];
    upright up;
    load(v, values);
    mpq_inits(up.q[0], up.q[1], up.q[2], up.height, up.here, up.test, NULL);
    for (int i = 0; i < 4; i++) {
        mpq_inits(low[i], rise[i], NULL);
        mpq_set(low[i], v[column[i]]);
        mpq_sub(rise[i], v[column[i] + 4], v[column[i]]);
    }
    expand(&up, low, rise);
    hewn_mc33_join join = judge(&up, low, rise);
    for (int i = 0; i < 4; i++)
        mpq_clears(low[i], rise[i], NULL);
    mpq_clears(up.q[0], up.q[1], up.q[2], up.height, up.here, up.test, NULL);
    unload(v);
    return join;
}

/* --- triangles ---------------------------------------------------------------------------------------------------- */

typedef struct builder {
    const uint32_t *samples;
    const double *values;
    const hewn_mc33_table *table;
    uint32_t *edge_vertex; /* three a sample */
    hewn_triangles out;
} builder;

static uint32_t step_of(const builder *build, uint32_t axis)
{
    return axis == 0 ? 1 : axis == 1 ? build->samples[0] : build->samples[0] * build->samples[1];
}

static void place_vertices(builder *build)
{
    uint32_t count = build->samples[0] * build->samples[1] * build->samples[2];
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at[3] = {i % build->samples[0], i / build->samples[0] % build->samples[1],
                          i / build->samples[0] / build->samples[1]};
        for (uint32_t axis = 0; axis < 3; axis++) {
            if (at[axis] + 1 == build->samples[axis])
                continue;
            double from = build->values[i], to = build->values[i + step_of(build, axis)];
            if ((from < 0) == (to < 0))
                continue;
            build->edge_vertex[3 * i + axis] = (uint32_t)build->out.vertex_count;
            float *position = build->out.positions + 3 * build->out.vertex_count++;
            for (int a = 0; a < 3; a++)
                position[a] = (float)at[a];
            position[axis] += (float)fmin(fmax(from / (from - to), 1.0 / 4096), 4095.0 / 4096);
        }
    }
}

static uint32_t record_of(const builder *build, uint32_t pattern, const double values[8])
{
    uint32_t head = build->table->words[pattern];
    if (!(head & HEWN_MC33_DECIDES))
        return head;
    uint32_t joined = oracle_mc33_joined(values), number = 0, bit = 0;
    for (uint32_t face = 0; face < 6; face++)
        if (head >> (16 + face) & 1)
            number |= (joined >> face & 1) << bit++;
    return build->table->words[(head & 0xFFFF) + HEWN_MC33_JOINS * number + oracle_mc33_join(values)];
}

/* The mean of the crossings on these edges; false where there is none of them. */
static bool mean_crossing(const builder *build, uint32_t index, uint32_t edges, double mean[3])
{
    uint32_t count = 0;
    memset(mean, 0, 3 * sizeof *mean);
    for (uint32_t edge = 0; edge < 12; edge++) {
        if (!(edges >> edge & 1))
            continue;
        uint32_t start = hewn_cube_edge_start(edge), at = index;
        for (uint32_t axis = 0; axis < 3; axis++)
            at += (start >> axis & 1) * step_of(build, axis);
        const float *position = build->out.positions + (size_t)3 * build->edge_vertex[3 * at + edge / 4];
        for (int axis = 0; axis < 3; axis++)
            mean[axis] += (double)position[axis];
        count++;
    }
    for (int axis = 0; axis < 3; axis++)
        mean[axis] /= count;
    return count > 0;
}

static void place_centre(builder *build, uint32_t index, uint32_t centre)
{
    double mean[3], near[3];
    uint32_t edges = centre & 0xFFF, face = (centre >> 12) - 1, in_face = 0;
    for (uint32_t edge = 0; edge < 12; edge++)
        in_face |= centre >> 12 && hewn_cube_edge_in_face(edge, face) ? 1u << edge : 0;
    mean_crossing(build, index, edges, mean);
    if (!mean_crossing(build, index, edges & in_face, near))
        memcpy(near, mean, sizeof near);
    float *position = build->out.positions + 3 * build->out.vertex_count++;
    for (int axis = 0; axis < 3; axis++)
        position[axis] = (float)((mean[axis] + near[axis]) / 2);
}

static void cut_cell(builder *build, uint32_t index)
{
    double values[8];
    uint32_t pattern = 0, corner[8];
    for (uint32_t c = 0; c < 8; c++) {
        corner[c] = index + (c & 1) + (c >> 1 & 1) * step_of(build, 1) + (c >> 2) * step_of(build, 2);
        values[c] = build->values[corner[c]];
        pattern |= (values[c] < 0 ? 1u : 0u) << c;
    }
    if (pattern == 0 || pattern == 255)
        return;
    const uint32_t *record = build->table->words + record_of(build, pattern, values);
    uint32_t triangles = record[0] & 255, centres = record[0] >> 8, first = (uint32_t)build->out.vertex_count;
    for (uint32_t i = 0; i < centres; i++)
        place_centre(build, index, record[1 + i / 2] >> 16 * (i % 2) & 0xFFFF);
    for (uint32_t i = 0; i < triangles; i++) {
        uint32_t word = record[1 + (centres + 1) / 2 + i / 2] >> 16 * (i % 2);
        uint32_t *indices = build->out.indices + 3 * build->out.triangle_count++;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t name = word >> 4 * k & 15;
            indices[k] = name < 12 ? build->edge_vertex[3 * corner[hewn_cube_edge_start(name)] + name / 4]
                                   : first + name - HEWN_PATCH_FIRST_CENTRE;
        }
    }
}

hewn_triangles oracle_mc33(const uint32_t samples[3], const double *values, const hewn_mc33_table *table)
{
    size_t count = (size_t)samples[0] * samples[1] * samples[2];
    builder build = {.samples = samples, .values = values, .table = table};
    build.edge_vertex = malloc(3 * count * sizeof *build.edge_vertex);
    build.out.positions = hewn_alloc(count * 3 * (3 + HEWN_PATCH_MOST_CENTRES), sizeof(float));
    build.out.indices = hewn_alloc(count * 3 * HEWN_PATCH_MOST_TRIANGLES, sizeof(uint32_t));
    if (!build.edge_vertex || !build.out.positions || !build.out.indices)
        abort();
    place_vertices(&build);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at[3] = {i % samples[0], i / samples[0] % samples[1], i / samples[0] / samples[1]};
        if (at[0] + 1 < samples[0] && at[1] + 1 < samples[1] && at[2] + 1 < samples[2])
            cut_cell(&build, i);
    }
    free(build.edge_vertex);
    return build.out;
}
