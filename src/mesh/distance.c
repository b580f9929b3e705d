#include "hewn/distance.h"

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "geom/hausdorff.h"
#include "hewn/model.h"
#include "mesh/cut.h"

/* One of the two surfaces. */
typedef struct measured_surface {
    hewn_triangle_view view;
    uint32_t *corners; /* owned, where faces had to be cut */
    hewn_bvh bvh;
} measured_surface;

static hewn_result check(const hewn_polygons *polygons, const char *which, hewn_error *error)
{
    const hewn_model view = {.vertex_count = polygons->vertex_count,
                             .face_count = polygons->face_count,
                             .positions = (double *)polygons->positions,
                             .first = (uint64_t *)polygons->first,
                             .corners = (uint32_t *)polygons->corners};
    HEWN_TRY(hewn_model_check(&view, error));
    if (polygons->vertex_count > UINT32_MAX || hewn_model_corner_count(&view) > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "the %s surface has too many corners to be measured", which);
    return HEWN_OK;
}

static hewn_result prepare(const hewn_polygons *polygons, const char *which, const hewn_progress *progress,
                           measured_surface *out, hewn_error *error)
{
    HEWN_TRY(check(polygons, which, error));
    out->view = (hewn_triangle_view){.vertex_count = polygons->vertex_count,
                                     .triangle_count = polygons->face_count,
                                     .doubles = polygons->positions,
                                     .corners = polygons->corners};
    if (polygons->first) {
        HEWN_TRY(hewn_cut_polygons(polygons, &out->corners, &out->view.triangle_count, progress, error));
        for (uint64_t c = 0; c < 3 * out->view.triangle_count; c++)
            out->corners[c] = polygons->corners[out->corners[c]];
        out->view.corners = out->corners;
    }
    if (out->view.triangle_count == 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "the %s surface has no faces: there is no distance", which);
    return hewn_bvh_build(&out->view, &out->bvh, error);
}

static void release(measured_surface *surface)
{
    hewn_free(surface->corners);
    hewn_bvh_free(&surface->bvh);
}

/* The diagonal of the box around the triangles of both. */
static double diagonal(const measured_surface both[2])
{
    double square = 0;
    float lo[2][3] = {0}, hi[2][3] = {0};
    for (int i = 0; i < 2; i++) {
        const hewn_boxes4 *root = both[i].bvh.level[both[i].bvh.level_count - 1];
        if (root)
            hewn_boxes4_all(root, lo[i], hi[i]);
    }
    for (int axis = 0; axis < 3; axis++) {
        double least = fmin((double)lo[0][axis], (double)lo[1][axis]);
        double side = fmax((double)hi[0][axis], (double)hi[1][axis]) - least;
        square += side * side;
    }
    return sqrt(square);
}

static hewn_result measure(const measured_surface both[2], const hewn_distance_desc *desc, hewn_distance *out,
                           hewn_error *error)
{
    const hewn_progress *progress = desc ? desc->progress : NULL;
    hewn_reach there, back;
    hewn_reach_desc reach = {.tolerance = desc && desc->tolerance > 0 ? desc->tolerance : 0.01,
                             .floor = 1e-6 * diagonal(both)};
    HEWN_TRY(hewn_progress_report(progress, "measure", 0, error));
    HEWN_TRY(hewn_surface_reach(&both[0].view, &both[1].view, &both[1].bvh, &reach, &there, error));
    HEWN_TRY(hewn_progress_report(progress, "measure", 0.5, error));
    HEWN_TRY(hewn_surface_reach(&both[1].view, &both[0].view, &both[0].bvh, &reach, &back, error));
    *out = (hewn_distance){.there_low = there.low,
                           .there = there.high,
                           .back_low = back.low,
                           .back = back.high,
                           .low = fmax(there.low, back.low),
                           .high = fmax(there.high, back.high)};
    return hewn_progress_report(progress, "measure", 1, error);
}

hewn_result hewn_polygons_distance(const hewn_polygons *one, const hewn_polygons *two, const hewn_distance_desc *desc,
                                   hewn_distance *out, hewn_error *error)
{
    const hewn_progress *progress = desc ? desc->progress : NULL;
    measured_surface both[2] = {0};
    *out = (hewn_distance){0};
    hewn_result result = prepare(one, "first", progress, &both[0], error);
    if (result == HEWN_OK)
        result = prepare(two, "second", progress, &both[1], error);
    if (result == HEWN_OK)
        result = measure(both, desc, out, error);
    release(&both[0]);
    release(&both[1]);
    return result;
}
