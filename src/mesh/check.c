#include "hewn/check.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "mesh/check_parts.h"
#include "mesh/cut.h"
#include "mesh/self_intersections.h"

static const char stage_name[] = "check";

enum { USUAL_PAIRS = 16, USUAL_COMPONENTS = 64 };

/* All that is at hand while one soup is examined. */
typedef struct examination {
    hewn_face_view view;
    hewn_face_room room;
    hewn_triangle_view mesh; /* the faces cut into triangles; the soup's own where they are triangles */
    uint32_t *triangles;     /* corners of the cut, NULL where nothing was cut */
    uint32_t *begins, *faces;
    uint8_t *degenerate; /* a face, where there was a cut */
    hewn_stars stars;
    hewn_components components;
    hewn_star_counts *counts; /* of each slot, as the next two */
    hewn_sheet_counts *sheets;
    hewn_measure *measures;
    hewn_check_desc desc;
    hewn_check *out;
} examination;

hewn_check_desc hewn_check_desc_default(void)
{
    return (hewn_check_desc){.most_pairs = USUAL_PAIRS, .most_components = USUAL_COMPONENTS};
}

static hewn_result fail_memory(const examination *at, hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory examining %llu faces",
                     (unsigned long long)at->view.face_count);
}

/* --- triangles ---------------------------------------------------------------------------------------------------- */

/* Which triangles are whose, and which faces are degenerate. */
static hewn_result describe_cut(examination *at, hewn_error *error)
{
    uint64_t faces = at->view.face_count, count = 0;
    at->begins = hewn_alloc(faces + 1, sizeof *at->begins);
    at->faces = hewn_alloc(at->mesh.triangle_count, sizeof *at->faces);
    at->degenerate = hewn_alloc(faces, sizeof *at->degenerate);
    if (!at->begins || !at->faces || !at->degenerate)
        return fail_memory(at, error);
    at->begins[0] = 0;
    for (uint64_t f = 0; f < faces; f++) {
        uint64_t length = hewn_face_begin(&at->view, f + 1) - hewn_face_begin(&at->view, f);
        for (uint64_t i = 2; i < length; i++)
            at->faces[count++] = (uint32_t)f;
        at->begins[f + 1] = (uint32_t)count;
    }
#pragma omp parallel for schedule(static) if (faces >= HEWN_CHECK_ALONE)
    for (uint64_t f = 0; f < faces; f++)
        at->degenerate[f] = hewn_face_degenerate(&at->view, f);
    return HEWN_OK;
}

static hewn_result cut_faces(examination *at, hewn_error *error)
{
    const hewn_face_view *view = &at->view;
    at->mesh = (hewn_triangle_view){.vertex_count = view->vertex_count,
                                    .triangle_count = view->face_count,
                                    .doubles = view->doubles,
                                    .floats = view->floats,
                                    .corners = view->corners};
    if (!view->first)
        return HEWN_OK;
    const hewn_polygons polygons = {view->vertex_count, view->doubles, view->face_count, view->first, view->corners};
    uint64_t count;
    HEWN_TRY(hewn_cut_polygons(&polygons, &at->triangles, &count, at->desc.progress, error));
    for (uint64_t i = 0; i < 3 * count; i++)
        at->triangles[i] = view->corners[at->triangles[i]];
    at->mesh.triangle_count = count;
    at->mesh.corners = at->triangles;
    return describe_cut(at, error);
}

static hewn_result measure(examination *at, hewn_error *error)
{
    hewn_certificate *certificate = &at->out->certificate;
    hewn_measure all = {0};
    hewn_measure_bounds(&at->view, &all.bounds);
    HEWN_TRY(hewn_measure_triangles(&at->mesh, stage_name, at->desc.progress, &all, error));
    certificate->bounds = all.bounds;
    certificate->volume = all.volume;
    certificate->area = all.area;
    certificate->degenerate_faces = all.flat_triangles;
    if (at->degenerate) {
        certificate->degenerate_faces = 0;
        for (uint64_t f = 0; f < at->view.face_count; f++)
            certificate->degenerate_faces += at->degenerate[f];
    }
    return HEWN_OK;
}

/* --- topology ----------------------------------------------------------------------------------------------------- */

static hewn_result make_slots(examination *at, hewn_error *error)
{
    HEWN_TRY(hewn_stars_build(&at->view, &at->stars, error));
    HEWN_TRY(hewn_components_find(&at->view, &at->stars, at->desc.most_components, &at->components, error));
    size_t count = at->components.listed + 1ull;
    at->counts = hewn_alloc_zero(count, sizeof *at->counts);
    at->sheets = hewn_alloc_zero(count, sizeof *at->sheets);
    at->measures = hewn_alloc_zero(count, sizeof *at->measures);
    at->out->components = hewn_alloc_zero(at->components.listed, sizeof *at->out->components);
    if (!at->counts || !at->sheets || !at->measures || !at->out->components)
        return fail_memory(at, error);
    return hewn_progress_report(at->desc.progress, stage_name, 0.6, error);
}

/* Vertices that no face names: some without a star are named by collapsed faces only. */
static hewn_result count_isolated(examination *at, hewn_error *error)
{
    const hewn_face_view *view = &at->view;
    hewn_check *out = at->out;
    out->isolated_vertices = view->vertex_count - out->used_vertices;
    if (out->sided_faces == view->face_count)
        return HEWN_OK;
    uint8_t *named = hewn_alloc_zero(view->vertex_count / 8 + 1, 1);
    if (!named)
        return fail_memory(at, error);
    for (uint64_t f = 0; f < view->face_count; f++) {
        if (!hewn_face_collapsed(view, f))
            continue;
        for (uint64_t c = hewn_face_begin(view, f); c < hewn_face_begin(view, f + 1); c++) {
            uint32_t v = view->corners[c];
            bool fresh = hewn_star_length(&at->stars, v) == 0 && !(named[v / 8] >> v % 8 & 1);
            named[v / 8] |= (uint8_t)(1u << v % 8);
            out->isolated_vertices -= fresh;
        }
    }
    hewn_free(named);
    return HEWN_OK;
}

static hewn_result examine_whole(examination *at, hewn_star_counts *total, hewn_error *error)
{
    hewn_check *out = at->out;
    HEWN_TRY(hewn_certify_stars(&at->view, &at->stars, at->components.slots, at->counts, stage_name, at->desc.progress,
                                error));
    for (uint32_t slot = 0; slot <= at->components.listed; slot++)
        hewn_star_counts_add(total, &at->counts[slot]);
    HEWN_TRY(hewn_sheets_find(&at->view, &at->stars, at->components.slots, total, at->sheets, error));
    out->orientable = true;
    for (uint32_t slot = 0; slot <= at->components.listed; slot++) {
        out->boundary_loops += at->sheets[slot].boundary_loops;
        out->orientable = out->orientable && !at->sheets[slot].one_sided;
    }
    out->sided_faces = at->view.face_count - hewn_count_collapsed_faces(&at->view);
    out->used_vertices = total->used_vertices;
    out->edges = total->edges;
    out->euler = (int64_t)out->used_vertices - (int64_t)out->edges + (int64_t)out->sided_faces;
    out->unoriented_edges = total->unoriented_edges;
    out->certificate.components = at->components.count;
    hewn_certify_counts(total, out->sided_faces, &out->certificate);
    HEWN_TRY(count_isolated(at, error));
    return hewn_count_duplicate_faces(&at->view, &at->stars, &out->duplicate_faces, error);
}

/* --- components --------------------------------------------------------------------------------------------------- */

static int64_t find_genus(const hewn_component *component)
{
    int64_t twice = 2 - component->euler - (int64_t)component->boundary_loops;
    if (!component->manifold)
        return -1;
    return component->orientable ? twice / 2 : twice;
}

static void describe_component(const examination *at, uint32_t slot)
{
    const hewn_star_counts *counts = &at->counts[slot];
    const hewn_measure *size = &at->measures[slot];
    hewn_component *out = &at->out->components[slot];
    out->vertices = counts->used_vertices;
    out->edges = counts->edges;
    out->euler = (int64_t)out->vertices - (int64_t)out->edges + (int64_t)out->faces;
    out->closed = counts->boundary_edges == 0;
    out->manifold = counts->non_manifold_edges == 0 && counts->non_manifold_vertices == 0;
    out->oriented = counts->unoriented_edges == 0;
    out->orientable = !at->sheets[slot].one_sided;
    out->boundary_edges = counts->boundary_edges;
    out->boundary_loops = at->sheets[slot].boundary_loops;
    out->non_manifold_edges = counts->non_manifold_edges;
    out->non_manifold_vertices = counts->non_manifold_vertices;
    out->genus = find_genus(out);
    out->volume = size->volume;
    out->area = size->area;
    out->bounds = size->bounds;
}

static hewn_result describe_components(examination *at, hewn_error *error)
{
    const hewn_face_view *view = &at->view;
    HEWN_TRY(hewn_measure_components(view, &at->mesh, &at->components, at->measures, error));
    for (uint64_t f = 0; f < view->face_count; f++) {
        if (hewn_face_collapsed(view, f))
            continue;
        uint32_t slot = at->components.slots[view->corners[hewn_face_begin(view, f)]];
        if (slot < at->components.listed)
            at->out->components[slot].faces++;
    }
    for (uint32_t slot = 0; slot < at->components.listed; slot++)
        describe_component(at, slot);
    at->out->component_count = at->components.listed;
    return HEWN_OK;
}

/* --- self-intersections ------------------------------------------------------------------------------------------- */

/* The stars are done with by now: the search needs room. */
static hewn_result find_intersections(examination *at, hewn_error *error)
{
    hewn_check *out = at->out;
    uint64_t most = at->desc.most_pairs;
    if (at->desc.skip_self_intersections)
        return HEWN_OK;
    if (!(out->pairs = hewn_alloc(most, sizeof *out->pairs)))
        return fail_memory(at, error);
    if (at->degenerate) {
        const hewn_cut_faces cut = {at->view.face_count, at->begins, at->faces, at->degenerate};
        HEWN_TRY(hewn_count_face_intersections(&at->mesh, &cut, most, out->pairs, at->desc.progress,
                                               &out->self_intersections, error));
    } else {
        HEWN_TRY(hewn_view_count_self_intersections(&at->mesh, most, out->pairs, at->desc.progress,
                                                    &out->self_intersections, error));
    }
    out->pair_count = (uint32_t)(out->self_intersections < most ? out->self_intersections : most);
    out->self_intersections_known = true;
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static void free_topology(examination *at)
{
    hewn_stars_free(&at->stars);
    hewn_components_free(&at->components);
    hewn_free(at->counts);
    hewn_free(at->sheets);
    hewn_free(at->measures);
}

static hewn_result examine_topology(examination *at, hewn_error *error)
{
    hewn_star_counts total = {0};
    HEWN_TRY(make_slots(at, error));
    HEWN_TRY(examine_whole(at, &total, error));
    return describe_components(at, error);
}

/* The view is made already. */
static hewn_result examine(examination *at, hewn_check **out, hewn_error *error)
{
    if (!(at->out = hewn_alloc_zero(1, sizeof *at->out)))
        return fail_memory(at, error);
    at->out->vertex_count = at->view.vertex_count;
    at->out->face_count = at->view.face_count;
    at->out->certificate.max_residual = NAN;
    hewn_result result = cut_faces(at, error);
    if (result == HEWN_OK)
        result = measure(at, error);
    if (result == HEWN_OK)
        result = examine_topology(at, error);
    free_topology(at);
    if (result == HEWN_OK)
        result = find_intersections(at, error);
    hewn_free(at->triangles);
    hewn_free(at->begins);
    hewn_free(at->faces);
    hewn_free(at->degenerate);
    if (result != HEWN_OK)
        hewn_check_destroy(&at->out);
    *out = at->out;
    return result;
}

static examination begin(const hewn_check_desc *desc)
{
    examination at = {.desc = desc ? *desc : hewn_check_desc_default()};
    at.desc.most_pairs = at.desc.most_pairs > 0 ? at.desc.most_pairs : USUAL_PAIRS;
    at.desc.most_components = at.desc.most_components > 0 ? at.desc.most_components : USUAL_COMPONENTS;
    return at;
}

hewn_result hewn_check_polygons(const hewn_polygons *polygons, const hewn_check_desc *desc, hewn_check **out,
                                hewn_error *error)
{
    examination at = begin(desc);
    *out = NULL;
    HEWN_TRY(hewn_face_view_of_polygons(polygons, &at.view, &at.room, error));
    hewn_result result = examine(&at, out, error);
    hewn_face_room_free(&at.room);
    return result;
}

hewn_result hewn_check_triangles(const hewn_triangles *triangles, const hewn_check_desc *desc, hewn_check **out,
                                 hewn_error *error)
{
    examination at = begin(desc);
    *out = NULL;
    HEWN_TRY(hewn_face_view_of_triangles(triangles, &at.view, error));
    return examine(&at, out, error);
}

void hewn_check_destroy(hewn_check **check)
{
    if (!check || !*check)
        return;
    hewn_free((*check)->pairs);
    hewn_free((*check)->components);
    hewn_free(*check);
    *check = NULL;
}
