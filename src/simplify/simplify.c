#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/cut.h"
#include "simplify/balance.h"
#include "simplify/desc.h"
#include "simplify/promise.h"
#include "simplify/run.h"
#include "simplify/work.h"

void hewn_simplified_destroy(hewn_simplified *simplified)
{
    if (!simplified)
        return;
    hewn_free(simplified->positions);
    hewn_free(simplified->corners);
    hewn_free(simplified->vertex_origins);
    hewn_free(simplified->face_origins);
    *simplified = (hewn_simplified){0};
}

void hewn_simplify_result_release(simplify_result *result)
{
    hewn_simplified_destroy(&result->mesh);
    hewn_free(result->into);
    hewn_free(result->wedges);
    hewn_free(result->values);
    *result = (simplify_result){0};
}

/* --- what comes in ------------------------------------------------------------------------------------------------ */

static void release(simplify_input *in)
{
    hewn_free(in->corners);
    hewn_free(in->faces);
    hewn_free(in->labels);
    hewn_free(in->corner_wedges);
    hewn_free(in->frozen);
    hewn_free(in->limits);
}

hewn_result hewn_simplify_check_polygons(const hewn_polygons *polygons, hewn_error *error)
{
    const hewn_model view = {.vertex_count = polygons->vertex_count,
                             .face_count = polygons->face_count,
                             .positions = (double *)polygons->positions,
                             .first = (uint64_t *)polygons->first,
                             .corners = (uint32_t *)polygons->corners};
    if (polygons->vertex_count >= SIMPLIFY_GONE)
        return hewn_fail(error, HEWN_LIMIT, "too many vertices to simplify: %llu",
                         (unsigned long long)polygons->vertex_count);
    return hewn_model_check(&view, error);
}

/* Triangles follow the order of the faces that they were cut from, corners - 2 each. */
static hewn_result spread_faces(const hewn_polygons *polygons, simplify_input *in, hewn_error *error)
{
    const uint64_t count = in->triangles.face_count;
    in->faces = hewn_alloc(count, sizeof *in->faces);
    in->labels = in->desc.labels ? hewn_alloc(count, sizeof *in->labels) : NULL;
    if (!in->faces || (in->desc.labels && !in->labels))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (uint64_t f = 0, t = 0; f < polygons->face_count; f++)
        for (uint64_t k = polygons->first[f] + 2; k < polygons->first[f + 1]; k++, t++) {
            in->faces[t] = (uint32_t)f;
            if (in->labels)
                in->labels[t] = in->desc.labels[f];
        }
    in->desc.labels = in->labels;
    return HEWN_OK;
}

static hewn_result cut(const hewn_polygons *polygons, simplify_input *in, hewn_error *error)
{
    in->triangles = *polygons;
    if (!polygons->first)
        return HEWN_OK;
    HEWN_TRY(hewn_cut_polygons(polygons, &in->corners, &in->triangles.face_count, in->desc.progress, error));
    HEWN_TRY(spread_faces(polygons, in, error));
    const uint64_t count = 3 * in->triangles.face_count;
    if (in->wedges && in->wedges->corners) {
        in->corner_wedges = hewn_alloc(count, sizeof *in->corner_wedges);
        if (!in->corner_wedges)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
        for (uint64_t c = 0; c < count; c++)
            in->corner_wedges[c] = in->wedges->corners[in->corners[c]];
    }
    for (uint64_t c = 0; c < count; c++)
        in->corners[c] = polygons->corners[in->corners[c]];
    in->triangles.first = NULL;
    in->triangles.corners = in->corners;
    return HEWN_OK;
}

/* --- one run ------------------------------------------------------------------------------------------------------ */

static hewn_result hand_out(simplify_work *work, const simplify_input *in, simplify_result *result, hewn_error *error)
{
    const size_t verts = work->vertex_count, faces = work->face_count;
    hewn_simplified *out = &result->mesh;
    *out = (hewn_simplified){.vertex_count = verts, .face_count = faces};
    out->positions = hewn_alloc(verts, 3 * sizeof *out->positions);
    out->face_origins = hewn_alloc(faces, sizeof *out->face_origins);
    if (!out->positions || !out->face_origins)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (size_t f = 0; f < faces; f++)
        out->face_origins[f] = in->faces ? in->faces[work->face_origins[f]] : work->face_origins[f];
    for (size_t i = 0; i < 3 * verts; i++) { /* what has not moved keeps its bits */
        const double before = in->triangles.positions[3 * (size_t)work->origins[i / 3] + i % 3];
        const bool moved = simplify_inward(work, before, i % 3) != work->positions[i];
        out->positions[i] = moved ? work->origin[i % 3] + work->scale * work->positions[i] : before;
        if (!isfinite(out->positions[i]))
            return hewn_fail(error, HEWN_LIMIT, "vertex %zu would not stay finite", i / 3);
    }
    out->corners = work->tail;
    out->vertex_origins = work->origins;
    result->into = work->into;
    result->wedges = work->wedge;
    work->tail = work->origins = work->into = work->wedge = NULL;
    return HEWN_OK;
}

/* Whether a vertex is the first fan of what it is in the complex. */
static bool is_first_fan(const simplify_work *work, uint32_t v)
{
    bool first = true;
    for (uint32_t at = work->tie ? work->tie[v] : v; at != v && first; at = work->tie[at])
        first = at > v;
    return first;
}

static void describe(const simplify_work *work, uint64_t target, hewn_simplify_report *report)
{
    report->triangles = work->face_count;
    report->target = target;
    report->reached = target == 0 || report->triangles <= target;
    report->locked_vertices = report->unwalked_vertices = 0;
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        if (work->rank[v] == SIMPLIFY_APART)
            report->unwalked_vertices += is_first_fan(work, v);
        else if (work->rank[v] == SIMPLIFY_LOCKED)
            report->locked_vertices += is_first_fan(work, v);
    }
}

static hewn_result prepare(simplify_work *work, const simplify_input *in, hewn_simplify_report *report,
                           hewn_error *error)
{
    HEWN_TRY(hewn_simplify_build(work, &in->triangles, error));
    report->dropped_faces = in->triangles.face_count - work->face_count;
    report->dropped_vertices = in->triangles.vertex_count - work->live_vertices;
    HEWN_TRY(hewn_simplify_order(work, 0, error));
    HEWN_TRY(hewn_simplify_mark(work, error));
    return hewn_simplify_weigh(work, error);
}

hewn_result hewn_simplify_once(const simplify_input *in, simplify_result *out, hewn_simplify_report *report,
                               hewn_error *error)
{
    simplify_wedges wedges = in->wedges ? *in->wedges : (simplify_wedges){0};
    simplify_work work = {.desc = &in->desc,
                          .frozen = in->frozen,
                          .limits = in->limits,
                          .groups = in->groups,
                          .wedges = in->wedges ? &wedges : NULL};
    const uint64_t target = hewn_simplify_target(&in->desc, in->triangles.face_count);
    const size_t scalars = (size_t)wedges.count * wedges.scalars;
    *out = (simplify_result){0};
    wedges.corners = in->corner_wedges ? in->corner_wedges : wedges.corners;
    wedges.values = in->wedges ? hewn_alloc(scalars, sizeof *wedges.values) : NULL;
    hewn_result result = HEWN_OK;
    if (in->wedges && !wedges.values)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for attributes");
    else if (in->wedges)
        memcpy(wedges.values, in->wedges->values, scalars * sizeof *wedges.values);
    if (result == HEWN_OK)
        result = prepare(&work, in, report, error);

    if (result == HEWN_OK)
        result = hewn_simplify_balanced(&work, &in->triangles,
                                        target < work.live_faces ? (uint32_t)target : work.live_faces, error);
    if (result == HEWN_OK) {
        describe(&work, target, report);
        result = hand_out(&work, in, out, error);
        out->values = wedges.values;
        wedges.values = NULL;
    }
    hewn_free(wedges.values);
    hewn_free(wedges.sums);
    hewn_simplify_release(&work);
    if (result != HEWN_OK)
        hewn_simplify_result_release(out);
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

hewn_result hewn_simplify_polygons(const hewn_polygons *polygons, const hewn_simplify_desc *desc,
                                   const simplify_wedges *wedges, const uint32_t *groups, simplify_result *out,
                                   hewn_simplify_report *report, hewn_error *error)
{
    hewn_simplify_report done = {0};
    *out = (simplify_result){0};
    if (report)
        *report = done;
    HEWN_TRY(hewn_simplify_check(desc, error));
    HEWN_TRY(hewn_simplify_check_polygons(polygons, error));
    simplify_input in = {.desc = *desc, .wedges = wedges, .groups = groups};
    hewn_result result = cut(polygons, &in, error);
    if (result == HEWN_OK && 3 * in.triangles.face_count >= SIMPLIFY_GONE)
        result = hewn_fail(error, HEWN_LIMIT, "too many triangles to simplify: %llu",
                           (unsigned long long)in.triangles.face_count);
    done.triangles_before = in.triangles.face_count;
    if (result == HEWN_OK)
        result = hewn_simplify_promised(&in, out, &done, error);
    release(&in);
    if (result == HEWN_OK && report)
        *report = done;
    return result;
}

hewn_result hewn_polygons_simplify(const hewn_polygons *polygons, const hewn_simplify_desc *desc, hewn_simplified *out,
                                   hewn_simplify_report *report, hewn_error *error)
{
    simplify_result result;
    *out = (hewn_simplified){0};
    HEWN_TRY(hewn_simplify_polygons(polygons, desc, NULL, NULL, &result, report, error));
    *out = result.mesh;
    result.mesh = (hewn_simplified){0};
    hewn_simplify_result_release(&result);
    return HEWN_OK;
}
