#include "simplify/gap.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "geom/nearest.h"

/* Of larger meshes a part of the vertices is looked at, so many for each triangle of the result. What is nearest is
 * looked for where the triangles around what a vertex has become are further away than those of all but this share. */
enum { SAMPLES = 16, BINS = 1 << 12, SHARE = 20, FEW = SIMPLIFY_FEW / 8 };

static hewn_triangle_view view_input(const simplify_gauge *gauge)
{
    return (hewn_triangle_view){.vertex_count = gauge->input->vertex_count,
                                .triangle_count = gauge->input->face_count,
                                .doubles = gauge->positions,
                                .corners = gauge->input->corners};
}

hewn_result hewn_simplify_gauge_make(const simplify_work *work, const hewn_polygons *input, simplify_gauge *out,
                                     hewn_error *error)
{
    *out = (simplify_gauge){.work = work, .input = input};
    out->positions = hewn_alloc(work->input_count, 3 * sizeof *out->positions);
    if (!out->positions)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
#pragma omp parallel for schedule(static) if (work->input_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < work->input_count; v++)
        for (size_t axis = 0; axis < 3; axis++)
            out->positions[3 * (size_t)v + axis] = simplify_inward(work, input->positions[3 * (size_t)v + axis], axis);
    const hewn_triangle_view view = view_input(out);
    HEWN_TRY(hewn_bvh_build(&view, &out->bvh, error));
    out->place = hewn_alloc(work->input_count, sizeof *out->place);
    out->near = hewn_alloc(work->input_count, sizeof *out->near);
    out->gap = hewn_alloc(work->input_count, sizeof *out->gap);
    return out->place && out->near && out->gap ? HEWN_OK
                                               : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
}

void hewn_simplify_gauge_release(simplify_gauge *gauge)
{
    hewn_bvh_free(&gauge->bvh);
    hewn_free(gauge->positions);
    hewn_free(gauge->place);
    hewn_free(gauge->near);
    hewn_free(gauge->gap);
    *gauge = (simplify_gauge){0};
}

uint32_t hewn_simplify_place(const simplify_gauge *gauge, uint32_t v)
{
    const uint32_t *into = gauge->work->into;
    while (into[v] != v)
        v = into[v];
    return gauge->place[v];
}

/* --- from the input to the result --------------------------------------------------------------------------------- */

/* The nearest of the triangles around a vertex. */
static uint32_t nearest_around(const simplify_work *work, uint32_t v, const double at[3], double *distance)
{
    const uint32_t first = work->half[v];
    uint32_t h = first, best = first / 3;
    *distance = INFINITY;
    do {
        const uint32_t in = simplify_prev(h);
        const double found = hewn_triangle_reach(at, simplify_at(work, v), simplify_at(work, simplify_head(work, h)),
                                                 simplify_at(work, work->tail[in]));
        best = found < *distance ? h / 3 : best;
        *distance = found < *distance ? found : *distance;
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    return best;
}

/* Distances to the triangles around what each vertex has become. */
static void look_around(simplify_gauge *gauge)
{
    const simplify_work *work = gauge->work;
#pragma omp parallel for schedule(dynamic, 256) if (work->vertex_count > FEW)
    for (uint32_t v = 0; v < work->input_count; v += gauge->step) {
        const uint32_t root = hewn_simplify_place(gauge, v);
        const double *at = gauge->positions + 3 * (size_t)v;
        double distance;
        gauge->near[v] = HEWN_NONE;
        if (root == HEWN_NONE || work->rank[root] == SIMPLIFY_APART)
            continue;
        gauge->near[v] = nearest_around(work, root, at, &distance);
        gauge->gap[v] = (float)distance;
    }
}

/* A distance that one of SHARE is above. Floats that are not negative are in the order of their bits. */
static uint32_t bin_of(float distance)
{
    uint32_t bits;
    memcpy(&bits, &distance, sizeof bits);
    return bits >> 19 < BINS ? bits >> 19 : BINS - 1;
}

static uint32_t find_far(const simplify_gauge *gauge)
{
    uint32_t bins[BINS] = {0}, count = 0, above = 0, bin = BINS;
    for (uint32_t v = 0; v < gauge->work->input_count; v += gauge->step)
        if (gauge->near[v] != HEWN_NONE) {
            bins[bin_of(gauge->gap[v])]++;
            count++;
        }
    while (bin > 0 && above + bins[bin - 1] <= count / SHARE)
        above += bins[--bin];
    return bin;
}

static hewn_result search(simplify_gauge *gauge, hewn_error *error)
{
    const simplify_work *work = gauge->work;
    const hewn_triangle_view now = {.vertex_count = work->vertex_count,
                                    .triangle_count = work->face_count,
                                    .doubles = work->positions,
                                    .corners = work->tail};
    const uint32_t far = find_far(gauge);
    hewn_bvh bvh;
    HEWN_TRY(hewn_bvh_build(&now, &bvh, error));
#pragma omp parallel for schedule(dynamic, 1024) if (work->vertex_count > FEW)
    for (uint32_t v = 0; v < work->input_count; v += gauge->step) {
        double distance;
        if (gauge->near[v] == HEWN_NONE || bin_of(gauge->gap[v]) < far)
            continue;
        gauge->near[v] = hewn_bvh_nearest(&bvh, &now, gauge->positions + 3 * (size_t)v, gauge->near[v], &distance);
        gauge->gap[v] = (float)distance;
    }
    hewn_bvh_free(&bvh);
    return HEWN_OK;
}

static void note(float *away, float distance)
{
    *away = distance > *away ? distance : *away;
}

/* --- from the result to the input --------------------------------------------------------------------------------- */

/* The distance from a point to the input, and the triangle there. */
static double reach(const simplify_gauge *gauge, const double at[3], uint32_t *face)
{
    const hewn_triangle_view input = view_input(gauge);
    double distance;
    *face = hewn_bvh_nearest(&gauge->bvh, &input, at, *face, &distance);
    return distance;
}

/* `*middle` is the distance of the triangle's middle, `corners` those of the corners whose turn it is here, else 0.
 * Whether the triangle is flipped. */
static bool measure_face(const simplify_gauge *gauge, uint32_t face, float *middle, float corners[3])
{
    const simplify_work *work = gauge->work;
    const uint32_t *corner = work->tail + 3 * (size_t)face;
    const double *at[3] = {simplify_at(work, corner[0]), simplify_at(work, corner[1]), simplify_at(work, corner[2])};
    double center[3], own[3], other[3];
    uint32_t near = work->face_origins[face];
    for (int axis = 0; axis < 3; axis++)
        center[axis] = (at[0][axis] + at[1][axis] + at[2][axis]) / 3;
    *middle = (float)reach(gauge, center, &near);
    const uint32_t *there = gauge->input->corners + 3 * (size_t)near;
    simplify_area_vector(gauge->positions + 3 * (size_t)there[0], gauge->positions + 3 * (size_t)there[1],
                         gauge->positions + 3 * (size_t)there[2], other);
    simplify_area_vector(at[0], at[1], at[2], own);
    for (uint32_t k = 0; k < 3; k++)
        corners[k] = work->half[corner[k]] == 3 * face + k ? (float)reach(gauge, at[k], &near) : 0;
    return simplify_dot(own, other) < 0;
}

typedef struct face_gap {
    float middle, corners[3];
    bool flipped;
} face_gap;

static hewn_result measure_back(const simplify_gauge *gauge, simplify_gaps *out, hewn_error *error)
{
    const simplify_work *work = gauge->work;
    face_gap *found = hewn_alloc(work->face_count, sizeof *found);
    if (!found)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
#pragma omp parallel for schedule(dynamic, 64) if (work->vertex_count > FEW)
    for (uint32_t f = 0; f < work->face_count; f++)
        found[f].flipped = measure_face(gauge, f, &found[f].middle, found[f].corners);
    for (uint32_t f = 0; f < work->face_count; f++) {
        out->flips += found[f].flipped;
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t v = work->tail[3 * (size_t)f + k];
            note(&out->away[v], found[f].middle);
            note(&out->away[v], found[f].corners[k]);
            out->turned[v] |= found[f].flipped;
        }
    }
    hewn_free(found);
    return HEWN_OK;
}

/* --- both --------------------------------------------------------------------------------------------------------- */

hewn_result hewn_simplify_measure(simplify_gauge *gauge, simplify_gaps *out, hewn_error *error)
{
    const simplify_work *work = gauge->work;
    const uint64_t samples = SAMPLES * (uint64_t)work->face_count;
    gauge->step = work->input_count / (uint32_t)(samples < UINT32_MAX ? samples + 1 : UINT32_MAX) + 1;
    memset(out->away, 0, work->vertex_count * sizeof *out->away);
    memset(out->turned, 0, work->vertex_count);
    memset(gauge->place, 0xFF, work->input_count * sizeof *gauge->place);
    for (uint32_t v = 0; v < work->vertex_count; v++)
        gauge->place[work->origins[v]] = v;
    out->flips = 0;
    look_around(gauge);
    HEWN_TRY(search(gauge, error));
    for (uint32_t v = 0; v < work->input_count; v += gauge->step)
        if (gauge->near[v] != HEWN_NONE) {
            note(&out->away[hewn_simplify_place(gauge, v)], gauge->gap[v]);
            for (size_t k = 0; k < 3; k++)
                note(&out->away[work->tail[3 * (size_t)gauge->near[v] + k]], gauge->gap[v]);
        }
    HEWN_TRY(measure_back(gauge, out, error));
    out->most = 0;
    for (uint32_t v = 0; v < work->vertex_count; v++)
        out->most = fmax(out->most, (double)out->away[v]);
    return HEWN_OK;
}
