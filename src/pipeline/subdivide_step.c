#include "pipeline/subdivide_step.h"

#include "base/error.h"
#include "pipeline/tag_file.h"

static hewn_result cut(hewn_model *model, hewn_error *error)
{
    hewn_mesh *mesh;
    hewn_model triangles;
    HEWN_TRY(hewn_mesh_from_model(model, NULL, &mesh, NULL, error));
    hewn_result result = hewn_mesh_triangulate(mesh, error);
    if (result == HEWN_OK)
        result = hewn_model_from_mesh(mesh, &triangles, error);
    hewn_mesh_destroy(&mesh);
    HEWN_TRY(result);
    triangles.unit = model->unit;
    triangles.up = model->up;
    triangles.up_known = model->up_known;
    hewn_model_destroy(model);
    *model = triangles;
    return HEWN_OK;
}

hewn_result hewn_subdivide_step(hewn_model *model, const hewn_file_subdivide *subdivide, const hewn_progress *progress,
                                hewn_subdivide_report *report, hewn_error *error)
{
    hewn_subdivide_desc desc = subdivide->desc;
    hewn_tags tags = {0};
    if (subdivide->triangulate)
        HEWN_TRY(cut(model, error));
    if (subdivide->creases)
        HEWN_TRY(hewn_tags_read(subdivide->creases, &tags, error));
    desc.creases = tags.creases;
    desc.crease_count = tags.crease_count;
    desc.corners = tags.corners;
    desc.corner_count = tags.corner_count;
    desc.progress = progress;
    hewn_result result = hewn_model_subdivide(model, &desc, subdivide->adaptive, report, error);
    hewn_tags_free(&tags);
    return result;
}

void hewn_subdivide_json(hewn_json *json, hewn_scheme scheme, const hewn_subdivide_report *report)
{
    hewn_json_object(json, "subdivide");
    hewn_json_string(json, "scheme", hewn_scheme_name(scheme));
    hewn_json_unsigned(json, "levels", report->levels);
    hewn_json_unsigned(json, "creases", report->creases);
    hewn_json_unsigned(json, "corners", report->corners);
    hewn_json_unsigned(json, "dropped_faces", report->dropped_faces);
    hewn_json_unsigned(json, "adaptive_faces", report->adaptive_faces);
    hewn_json_end_object(json);
}
