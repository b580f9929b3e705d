#include <math.h>

#include "base/error.h"
#include "base/progress.h"
#include "mesh/check_parts.h"

static const char stage_name[] = "certify";

/* --- what the check shares ---------------------------------------------------------------------------------------- */

hewn_result hewn_certify_stars(const hewn_face_view *view, const hewn_stars *stars, const uint32_t *slots,
                               hewn_star_counts *counts, const char *stage, const hewn_progress *progress,
                               hewn_error *error)
{
    enum { SLICE = 1 << 22 };
    for (uint64_t begin = 0; begin < view->vertex_count; begin += SLICE) {
        uint64_t end = begin + SLICE < view->vertex_count ? begin + SLICE : view->vertex_count;
        HEWN_TRY(hewn_stars_examine(view, stars, begin, end, slots, counts, error));
        double fraction = 0.6 + 0.4 * (double)end / (double)view->vertex_count;
        HEWN_TRY(hewn_progress_report(progress, stage, fraction, error));
    }
    return HEWN_OK;
}

void hewn_certify_counts(const hewn_star_counts *counts, uint64_t faces, hewn_certificate *out)
{
    out->boundary_edges = counts->boundary_edges;
    out->non_manifold_edges = counts->non_manifold_edges;
    out->non_manifold_vertices = counts->non_manifold_vertices;
    out->closed = counts->boundary_edges == 0;
    out->manifold = counts->non_manifold_edges == 0 && counts->non_manifold_vertices == 0;
    out->oriented = counts->unoriented_edges == 0;
    out->genus = -1;
    if (out->closed && out->manifold && out->oriented) {
        int64_t euler = (int64_t)counts->used_vertices - (int64_t)counts->edges + (int64_t)faces;
        out->genus = (int64_t)out->components - euler / 2;
    }
}

/* --- the certificate ---------------------------------------------------------------------------------------------- */

/* Where rows of all stars have to be there at once. */
static hewn_result examine_stars(const hewn_face_view *view, const hewn_progress *progress, hewn_star_counts *counts,
                                 hewn_error *error)
{
    hewn_stars stars;
    HEWN_TRY(hewn_stars_build(view, &stars, error));
    hewn_result result = hewn_certify_stars(view, &stars, NULL, counts, stage_name, progress, error);
    hewn_stars_free(&stars);
    return result;
}

static hewn_result examine_topology(const hewn_face_view *view, const hewn_progress *progress, hewn_certificate *out,
                                    hewn_error *error)
{
    hewn_star_counts counts = {0};
    uint64_t roots;
    bool done;
    HEWN_TRY(hewn_trees_count(view, &roots, error));
    HEWN_TRY(hewn_progress_report(progress, stage_name, 0.6, error));
    HEWN_TRY(hewn_stars_examine_ranges(view, stage_name, progress, &counts, &done, error));
    if (!done)
        HEWN_TRY(examine_stars(view, progress, &counts, error));
    out->components = roots - (view->vertex_count - counts.used_vertices); /* the others are trees of their own */
    hewn_certify_counts(&counts, view->face_count - hewn_count_collapsed_faces(view), out);
    return HEWN_OK;
}

static hewn_result certify(const hewn_triangles *triangles, const hewn_progress *progress, hewn_certificate *out,
                           hewn_error *error)
{
    hewn_face_view view;
    hewn_measure measure = {0};
    HEWN_TRY(hewn_face_view_of_triangles(triangles, &view, error));
    const hewn_triangle_view mesh = {.vertex_count = view.vertex_count,
                                     .triangle_count = view.face_count,
                                     .floats = view.floats,
                                     .corners = view.corners};
    hewn_measure_bounds(&view, &measure.bounds);
    HEWN_TRY(hewn_progress_report(progress, stage_name, 0.1, error));
    HEWN_TRY(hewn_measure_triangles(&mesh, stage_name, progress, &measure, error));
    out->bounds = measure.bounds;
    out->volume = measure.volume;
    out->area = measure.area;
    out->degenerate_faces = measure.flat_triangles;
    HEWN_TRY(hewn_progress_report(progress, stage_name, 0.5, error));
    return examine_topology(&view, progress, out, error);
}

hewn_result hewn_certify(const hewn_triangles *triangles, const hewn_progress *progress, hewn_certificate *out,
                         hewn_error *error)
{
    hewn_certificate certificate = {.max_residual = NAN};
    hewn_result result = certify(triangles, progress, &certificate, error);
    *out = result == HEWN_OK ? certificate : (hewn_certificate){0};
    return result;
}
