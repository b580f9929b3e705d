#include "pipeline/mesh_samples.h"

#include "base/error.h"

/* Less than this calls for a second look; a hole alone leaves more. */
static const double doubtful_share = 0.01;

/* The faces turned to agree, as a model. */
static hewn_result turn_faces(const hewn_model *model, hewn_model *out, bool *turned, hewn_error *error)
{
    const hewn_repair_desc repair = {.weld = true};
    hewn_repair_report report;
    hewn_mesh *mesh = NULL;
    HEWN_TRY(hewn_mesh_from_model(model, &repair, &mesh, &report, error));
    *turned = report.turned_faces > 0;
    hewn_result result = *turned ? hewn_model_from_mesh(mesh, out, error) : HEWN_OK;
    hewn_mesh_destroy(&mesh);
    return result;
}

hewn_result hewn_mesh_samples(const hewn_model *model, const hewn_mesh_sampling_desc *desc, hewn_sampling **out,
                              hewn_sampling_place *place, hewn_mesh_sampling_report *report, hewn_error *error)
{
    hewn_polygons polygons = hewn_model_polygons(model);
    HEWN_TRY(hewn_sampling_from_mesh(&polygons, desc, out, place, report, error));
    if (report->doubtful <= doubtful_share)
        return HEWN_OK;
    hewn_model other = {0};
    bool turned = false;
    hewn_sampling *again = NULL;
    hewn_sampling_place again_place;
    hewn_mesh_sampling_report again_report;
    hewn_result result = turn_faces(model, &other, &turned, error);
    if (result == HEWN_OK && turned) {
        polygons = hewn_model_polygons(&other);
        result = hewn_sampling_from_mesh(&polygons, desc, &again, &again_place, &again_report, error);
    }
    hewn_model_destroy(&other);
    if (result == HEWN_OK && again && again_report.confidence > report->confidence) {
        hewn_sampling_destroy(out);
        *out = again;
        *place = again_place;
        *report = again_report;
        return HEWN_OK;
    }
    hewn_sampling_destroy(&again);
    if (result == HEWN_CANCELLED) {
        hewn_sampling_destroy(out);
        return result;
    }
    return HEWN_OK; /* what came first is good enough where the rest does not work out */
}
