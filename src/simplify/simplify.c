#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/cut.h"
#include "simplify/desc.h"
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

/* --- what comes in ------------------------------------------------------------------------------------------------ */

/* The input as triangles; what had to be made for that is owned. */
typedef struct input {
    hewn_polygons triangles;
    uint32_t *corners;
    uint32_t *faces;  /* the polygon of each triangle; NULL where it is the triangle's own number */
    int32_t *labels; /* of each triangle */
    hewn_simplify_desc desc;
} input;

static void release(input *in)
{
    hewn_free(in->corners);
    hewn_free(in->faces);
    hewn_free(in->labels);
}

static hewn_result check_polygons(const hewn_polygons *polygons, hewn_error *error)
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
static hewn_result cut(const hewn_polygons *polygons, input *in, hewn_error *error)
{
    in->triangles = *polygons;
    if (!polygons->first)
        return HEWN_OK;
    uint64_t count, t = 0;
    HEWN_TRY(hewn_cut_polygons(polygons, &in->corners, &count, in->desc.progress, error));
    in->faces = hewn_alloc(count, sizeof *in->faces);
    in->labels = in->desc.labels ? hewn_alloc(count, sizeof *in->labels) : NULL;
    if (!in->faces || (in->desc.labels && !in->labels))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (uint64_t f = 0; f < polygons->face_count; f++)
        for (uint64_t k = polygons->first[f] + 2; k < polygons->first[f + 1]; k++, t++) {
            in->faces[t] = (uint32_t)f;
            if (in->labels)
                in->labels[t] = in->desc.labels[f];
        }
    for (uint64_t c = 0; c < 3 * count; c++)
        in->corners[c] = polygons->corners[in->corners[c]];
    in->triangles.first = NULL;
    in->triangles.corners = in->corners;
    in->triangles.face_count = count;
    in->desc.labels = in->labels;
    return HEWN_OK;
}

/* --- one run ------------------------------------------------------------------------------------------------------ */

static hewn_result hand_out(const simplify_work *work, const input *in, hewn_simplified *out, hewn_error *error)
{
    const size_t verts = work->vertex_count, faces = work->face_count;
    *out = (hewn_simplified){.vertex_count = verts, .face_count = faces};
    out->positions = hewn_alloc(verts, 3 * sizeof *out->positions);
    out->corners = hewn_alloc(faces, 3 * sizeof *out->corners);
    out->vertex_origins = hewn_alloc(verts, sizeof *out->vertex_origins);
    out->face_origins = hewn_alloc(faces, sizeof *out->face_origins);
    if (!out->positions || !out->corners || !out->vertex_origins || !out->face_origins)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    memcpy(out->corners, work->tail, 3 * faces * sizeof *out->corners);
    memcpy(out->vertex_origins, work->origins, verts * sizeof *out->vertex_origins);
    for (size_t f = 0; f < faces; f++)
        out->face_origins[f] = in->faces ? in->faces[work->face_origins[f]] : work->face_origins[f];
    for (size_t i = 0; i < 3 * verts; i++) { /* what has not moved keeps its bits */
        const double before = in->triangles.positions[3 * (size_t)work->origins[i / 3] + i % 3];
        const bool moved = simplify_inward(work, before, i % 3) != work->positions[i];
        out->positions[i] = moved ? work->origin[i % 3] + work->scale * work->positions[i] : before;
        if (!isfinite(out->positions[i]))
            return hewn_fail(error, HEWN_LIMIT, "vertex %zu would not stay finite", i / 3);
    }
    return HEWN_OK;
}

static void count_ranks(const simplify_work *work, hewn_simplify_report *report)
{
    report->locked_vertices = report->unwalked_vertices = 0;
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        report->locked_vertices += work->rank[v] == SIMPLIFY_LOCKED;
        report->unwalked_vertices += work->rank[v] == SIMPLIFY_APART;
    }
}

/* `into` is handed to the caller. */
static hewn_result run_once(const input *in, double most, hewn_simplified *out, uint32_t **into,
                            hewn_simplify_report *report, hewn_error *error)
{
    simplify_work work = {.desc = &in->desc};
    hewn_result result = hewn_simplify_build(&work, &in->triangles, error);
    work.most = most / work.scale;
    report->dropped_faces = in->triangles.face_count - work.face_count;
    report->dropped_vertices = in->triangles.vertex_count - work.live_vertices;
    uint64_t target = hewn_simplify_target(&in->desc, in->triangles.face_count);
    if (result == HEWN_OK)
        result = hewn_simplify_order(&work, 0, error);
    if (result == HEWN_OK)
        result = hewn_simplify_mark(&work, error);
    if (result == HEWN_OK) {
        hewn_simplify_weigh(&work);
        result = hewn_simplify_run(&work, target < work.live_faces ? (uint32_t)target : work.live_faces, error);
    }
    if (result == HEWN_OK)
        result = hand_out(&work, in, out, error);
    if (result == HEWN_OK) {
        count_ranks(&work, report);
        report->triangles = out->face_count;
        report->target = target;
        report->reached = out->face_count <= target || target == 0;
        *into = work.into;
        work.into = NULL;
    }
    hewn_simplify_release(&work);
    if (result != HEWN_OK)
        hewn_simplified_destroy(out);
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run(input *in, hewn_simplified *out, hewn_simplify_report *report, hewn_error *error)
{
    uint32_t *into = NULL;
    hewn_result result = run_once(in, INFINITY, out, &into, report, error);
    report->runs = 1;
    hewn_free(into);
    return result;
}

hewn_result hewn_polygons_simplify(const hewn_polygons *polygons, const hewn_simplify_desc *desc, hewn_simplified *out,
                                   hewn_simplify_report *report, hewn_error *error)
{
    hewn_simplify_report done = {0};
    *out = (hewn_simplified){0};
    if (report)
        *report = done;
    HEWN_TRY(hewn_simplify_check(desc, error));
    HEWN_TRY(check_polygons(polygons, error));
    input in = {.desc = *desc};
    hewn_result result = cut(polygons, &in, error);
    if (result == HEWN_OK && 3 * in.triangles.face_count >= SIMPLIFY_GONE)
        result = hewn_fail(error, HEWN_LIMIT, "too many triangles to simplify: %llu",
                           (unsigned long long)in.triangles.face_count);
    done.triangles_before = in.triangles.face_count;
    if (result == HEWN_OK)
        result = run(&in, out, &done, error);
    release(&in);
    if (result == HEWN_OK && report)
        *report = done;
    return result;
}
