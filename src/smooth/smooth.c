#include "hewn/smooth.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "mesh/cut.h"
#include "smooth/cotangent.h"
#include "smooth/desc.h"

/* --- input -------------------------------------------------------------------------------------------------------- */

static hewn_result check_faces(const hewn_polygons *polygons, hewn_error *error)
{
    if (polygons->face_count > 0 && !polygons->corners)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "faces need corners");
    for (uint64_t f = 0; f < polygons->face_count; f++) {
        uint64_t begin = smooth_face_begin(polygons, f), end = smooth_face_begin(polygons, f + 1);
        if (end < begin || end > INT32_MAX)
            return end < begin ? hewn_fail(error, HEWN_BAD_INPUT, "face %llu does not follow the one before it",
                                           (unsigned long long)f)
                               : hewn_fail(error, HEWN_LIMIT, "faces of 2^31 corners and more cannot be smoothed");
        for (uint64_t c = begin; c < end; c++)
            if (polygons->corners[c] >= polygons->vertex_count)
                return hewn_fail(error, HEWN_BAD_INPUT, "face %llu names vertex %u, but there are %llu",
                                 (unsigned long long)f, polygons->corners[c],
                                 (unsigned long long)polygons->vertex_count);
    }
    return HEWN_OK;
}

static hewn_result check_polygons(const hewn_polygons *polygons, const double *freedom, hewn_error *error)
{
    if (polygons->vertex_count > 0 && !polygons->positions)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "vertices need positions");
    if (polygons->vertex_count > INT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "2^31 vertices and more cannot be smoothed");
    for (uint64_t v = 0; v < polygons->vertex_count; v++) {
        const double *at = polygons->positions + 3 * v;
        if (!isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2]))
            return hewn_fail(error, HEWN_BAD_INPUT, "the position of vertex %llu is not finite", (unsigned long long)v);
        if (freedom && !(freedom[v] >= 0 && freedom[v] <= 1))
            return hewn_fail(error, HEWN_BAD_INPUT, "the freedom of vertex %llu must be from 0 to 1, not %g",
                             (unsigned long long)v, freedom[v]);
    }
    return check_faces(polygons, error);
}

/* --- measures ----------------------------------------------------------------------------------------------------- */

/* Lengths are measured from the middle of the box, so that a mesh far from the origin loses nothing. */
typedef struct frame {
    double origin[3], scale;
} frame;

/* Coordinates are brought to at most 1 by a power of two, so that no square of them overflows. */
static frame find_frame(const hewn_polygons *polygons)
{
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY}, most = 0;
    frame out = {{0, 0, 0}, 1};
    for (uint64_t i = 0; i < 3 * polygons->vertex_count; i++) {
        lo[i % 3] = fmin(lo[i % 3], polygons->positions[i]);
        hi[i % 3] = fmax(hi[i % 3], polygons->positions[i]);
    }
    for (int axis = 0; axis < 3 && polygons->vertex_count > 0; axis++) {
        out.origin[axis] = lo[axis] / 2 + hi[axis] / 2;
        most = fmax(most, hi[axis] / 2 - lo[axis] / 2);
    }
    int exponent = 0;
    (void)frexp(most, &exponent);
    if (most > 0)
        out.scale = ldexp(1, exponent > 1000 ? 1000 : exponent < -1000 ? -1000 : exponent);
    return out;
}

static void measure(const smooth_work *work, const double *positions, double scale, double *volume, double *area)
{
    double volume_sum = 0, area_sum = 0;
    for (uint64_t t = 0; t < work->cut.face_count; t++) {
        const uint32_t *corner = work->cut.corners + 3 * t;
        const double *a = positions + 3 * (size_t)corner[0], *b = positions + 3 * (size_t)corner[1],
                     *c = positions + 3 * (size_t)corner[2];
        double u[3], v[3], n[3];
        smooth_between(a, b, u);
        smooth_between(a, c, v);
        smooth_cross(u, v, n);
        volume_sum += smooth_dot(a, n) / 6;
        area_sum += sqrt(smooth_dot(n, n)) / 2;
    }
    *volume = volume_sum * scale * scale * scale;
    *area = area_sum * scale * scale;
}

static double mean_edge(const smooth_work *work)
{
    double sum = 0;
    uint64_t count = 3 * work->cut.face_count;
    for (uint64_t t = 0; t < work->cut.face_count; t++)
        for (uint64_t k = 0; k < 3; k++) {
            double side[3];
            smooth_between(work->at + 3 * (size_t)work->cut.corners[3 * t + k],
                           work->at + 3 * (size_t)work->cut.corners[3 * t + (k + 1) % 3], side);
            sum += sqrt(smooth_dot(side, side));
        }
    return count > 0 ? sum / (double)count : 0;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static void release(smooth_work *work)
{
    hewn_smooth_rows_free(&work->neighbours);
    hewn_smooth_rows_free(&work->fans);
    hewn_free(work->cut_corners);
    hewn_free(work->flags);
    hewn_free(work->freedom);
    hewn_free(work->at);
    hewn_free(work->next);
}

static hewn_result cut_faces(smooth_work *work, hewn_error *error)
{
    work->cut = *work->polygons;
    if (!work->cut.first)
        return HEWN_OK;
    uint32_t *places;
    HEWN_TRY(hewn_cut_polygons(work->polygons, &places, &work->cut.face_count, work->desc->progress, error));
    for (uint64_t c = 0; c < 3 * work->cut.face_count; c++)
        places[c] = work->polygons->corners[places[c]];
    work->cut.first = NULL;
    work->cut.corners = work->cut_corners = places;
    return HEWN_OK;
}

static hewn_result prepare(smooth_work *work, const frame *from, hewn_error *error)
{
    size_t count = work->count;
    work->flags = hewn_alloc_zero(count, sizeof *work->flags);
    work->at = hewn_alloc(count, 3 * sizeof *work->at);
    work->next = hewn_alloc(count, 3 * sizeof *work->next);
    if (!work->flags || !work->at || !work->next)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    for (size_t i = 0; i < 3 * count; i++)
        work->at[i] = (work->polygons->positions[i] - from->origin[i % 3]) / from->scale;
    HEWN_TRY(cut_faces(work, error));
    return hewn_smooth_neighbours(work->polygons, &work->neighbours, work->flags, error);
}

static hewn_result run_method(smooth_work *work, hewn_error *error)
{
    switch (work->desc->method) {
    case HEWN_SMOOTH_COTAN: return hewn_smooth_flow(work, error);
    case HEWN_SMOOTH_IMPLICIT: return hewn_smooth_implicit(work, error);
    case HEWN_SMOOTH_BILATERAL: return hewn_smooth_bilateral(work, error);
    case HEWN_SMOOTH_HC: return hewn_smooth_hc(work, error);
    default: return hewn_smooth_umbrella(work, error);
    }
}

/* Vertices that have not moved keep their bits. */
static hewn_result bring_back(const smooth_work *work, const frame *from, const double *before, double *positions,
                              hewn_error *error)
{
    hewn_smooth_report *report = work->report;
    double *out = work->next, sum = 0;
    for (uint32_t v = 0; v < work->count; v++) {
        double move[3];
        smooth_between(before + 3 * (size_t)v, work->at + 3 * (size_t)v, move);
        double length = sqrt(smooth_dot(move, move)) * from->scale;
        for (size_t axis = 0; axis < 3; axis++) {
            size_t i = 3 * (size_t)v + axis;
            out[i] = move[axis] == 0 ? work->polygons->positions[i] : from->origin[axis] + work->at[i] * from->scale;
            if (!isfinite(out[i]))
                return hewn_fail(error, HEWN_LIMIT, "vertex %u would not stay finite", v);
        }
        sum += length;
        report->largest_move = fmax(report->largest_move, length);
    }
    report->mean_move = work->count > 0 ? sum / work->count : 0;
    memcpy(positions, out, 3 * (size_t)work->count * sizeof *positions);
    return HEWN_OK;
}

static hewn_result run(smooth_work *work, hewn_smooth_desc *desc, double *positions, hewn_error *error)
{
    frame from = find_frame(work->polygons);
    hewn_smooth_report *report = work->report;
    HEWN_TRY(prepare(work, &from, error));
    desc->step = desc->step > 0 ? desc->step / from.scale : mean_edge(work);
    desc->radius /= from.scale;
    bool triangles = desc->method == HEWN_SMOOTH_COTAN || desc->method == HEWN_SMOOTH_IMPLICIT ||
                     desc->method == HEWN_SMOOTH_BILATERAL;
    if (triangles)
        HEWN_TRY(hewn_smooth_corners(&work->cut, &work->fans, error));
    measure(work, work->at, from.scale, &report->volume_before, &report->area_before);
    HEWN_TRY(hewn_smooth_lock(work, error));
    double *before = hewn_alloc(work->count, 3 * sizeof *before);
    if (!before)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    memcpy(before, work->at, 3 * (size_t)work->count * sizeof *before);
    hewn_result result = desc->step > 0 ? run_method(work, error) : HEWN_OK;
    if (result == HEWN_OK && desc->volume == HEWN_SMOOTH_VOLUME_KEPT)
        result = hewn_smooth_keep_volume(work, before, error);
    if (result == HEWN_OK) {
        measure(work, work->at, from.scale, &report->volume_after, &report->area_after);
        result = bring_back(work, &from, before, positions, error);
    }
    hewn_free(before);
    bool flows = desc->method == HEWN_SMOOTH_COTAN || desc->method == HEWN_SMOOTH_IMPLICIT;
    report->step = flows ? desc->step * from.scale : 0;
    report->radius *= from.scale;
    return result;
}

hewn_result hewn_polygons_smooth(const hewn_polygons *polygons, const hewn_smooth_desc *desc, double *positions,
                                 hewn_smooth_report *report, hewn_error *error)
{
    hewn_smooth_desc settled = desc ? *desc : (hewn_smooth_desc){0};
    hewn_smooth_report done = {0};
    if (report)
        *report = done;
    HEWN_TRY(hewn_smooth_settle(&settled, error));
    HEWN_TRY(check_polygons(polygons, settled.freedom, error));
    smooth_work work = {
        .polygons = polygons, .desc = &settled, .report = &done, .count = (uint32_t)polygons->vertex_count};
    bool umbrella = settled.method == HEWN_SMOOTH_TAUBIN || settled.method == HEWN_SMOOTH_LAPLACIAN;
    done.iterations = settled.iterations;
    done.strength = umbrella ? settled.strength : 0;
    done.passband = settled.method == HEWN_SMOOTH_TAUBIN ? settled.passband : 0;
    done.angle = settled.method == HEWN_SMOOTH_BILATERAL ? settled.angle : 0;
    hewn_result result = run(&work, &settled, positions, error);
    release(&work);
    if (result == HEWN_OK && report)
        *report = done;
    return result;
}

/* --- curvature ---------------------------------------------------------------------------------------------------- */

static void find_curvature(const smooth_work *work, const smooth_triangle *triangles, const frame *from,
                           double *curvature, double *areas)
{
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < work->count; v++) {
        smooth_star star = smooth_star_of(work, triangles, v);
        for (size_t axis = 0; curvature && axis < 3; axis++)
            curvature[3 * (size_t)v + axis] = star.area > 0 ? star.pull[axis] / star.area / from->scale : 0;
        if (areas)
            areas[v] = star.area * from->scale * from->scale;
    }
}

hewn_result hewn_mean_curvature(const hewn_polygons *polygons, double *curvature, double *areas, hewn_error *error)
{
    HEWN_TRY(check_polygons(polygons, NULL, error));
    hewn_smooth_desc desc = {0};
    smooth_work work = {.polygons = polygons, .desc = &desc, .count = (uint32_t)polygons->vertex_count};
    frame from = find_frame(polygons);
    hewn_result result = prepare(&work, &from, error);
    if (result == HEWN_OK)
        result = hewn_smooth_corners(&work.cut, &work.fans, error);
    smooth_triangle *triangles = hewn_alloc(work.cut.face_count, sizeof *triangles);
    if (result == HEWN_OK && !triangles)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory measuring %u vertices", work.count);
    if (result == HEWN_OK) {
        smooth_measure_triangles(&work, triangles);
        find_curvature(&work, triangles, &from, curvature, areas);
    }
    hewn_free(triangles);
    release(&work);
    return result;
}
