#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/renew_normals.h"
#include "simplify/channels.h"

/* The simplified triangles with their attributes; unit and axes are the model's. */
static hewn_result make_model(const hewn_model *from, const simplify_channels *channels, simplify_result *result,
                              hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){.vertex_count = result->mesh.vertex_count,
                        .face_count = result->mesh.face_count,
                        .positions = result->mesh.positions,
                        .corners = result->mesh.corners,
                        .unit = from->unit,
                        .up = from->up,
                        .up_known = from->up_known};
    result->mesh.positions = NULL;
    const hewn_result given = hewn_simplify_give_channels(from, channels, result, out, error);
    result->mesh.corners = NULL;
    return given;
}

hewn_result hewn_model_simplify(hewn_model *model, const hewn_simplify_desc *desc, hewn_simplify_report *report,
                                hewn_error *error)
{
    hewn_simplify_desc own = desc ? *desc : (hewn_simplify_desc){0};
    const uint32_t preserve = own.preserve ? own.preserve : HEWN_PRESERVE_USUAL;
    const hewn_polygons polygons = hewn_model_polygons(model);
    simplify_channels channels = {0};
    simplify_result result = {0};
    hewn_model out = {0};
    int32_t *labels = NULL;
    HEWN_TRY(hewn_model_check(model, error));
    hewn_result done = hewn_simplify_take_channels(model, preserve, &channels, error);
    if (done == HEWN_OK && !own.labels)
        done = hewn_simplify_join_labels(model, own.lock_labels ? preserve | HEWN_PRESERVE_LABEL : preserve, &labels,
                                         error);
    own.labels = own.labels ? own.labels : labels;
    own.lock_labels &= own.labels != NULL;
    const bool wedges = channels.wedges.scalars > 0 || channels.corners;
    if (done == HEWN_OK)
        done = hewn_simplify_polygons(&polygons, &own, wedges ? &channels.wedges : NULL, NULL, &result, report, error);
    if (done == HEWN_OK)
        done = make_model(model, &channels, &result, &out, error);
    if (done == HEWN_OK && !(preserve & HEWN_PRESERVE_NORMAL))
        done = hewn_simplify_renew_normals(&out, error);
    if (done == HEWN_OK) {
        hewn_model_destroy(model);
        *model = out;
    } else {
        hewn_model_destroy(&out);
    }
    hewn_simplify_release_channels(&channels);
    hewn_simplify_result_release(&result);
    hewn_free(labels);
    return done;
}

/* --- the extraction's triangles ----------------------------------------------------------------------------------- */

hewn_result hewn_triangles_simplify(hewn_triangles *triangles, const hewn_simplify_desc *desc,
                                    hewn_simplify_report *report, hewn_error *error)
{
    hewn_model model = {0};
    hewn_triangles out = {0};
    hewn_result result = hewn_model_from_triangles(triangles, &model, error);
    if (result == HEWN_OK)
        result = hewn_model_simplify(&model, desc, report, error);
    if (result == HEWN_OK)
        result = hewn_triangles_from_model(&model, &out, error);
    hewn_model_destroy(&model);
    if (result == HEWN_OK) {
        hewn_triangles_destroy(triangles);
        *triangles = out;
    }
    return result;
}
