/* Smoothing the extraction's triangles. */
#include "base/error.h"
#include "hewn/smooth.h"

hewn_result hewn_triangles_smooth(hewn_triangles *triangles, const hewn_smooth_desc *desc, hewn_smooth_report *report,
                                  hewn_error *error)
{
    hewn_model model = {0};
    hewn_triangles out = {0};
    hewn_result result = hewn_model_from_triangles(triangles, &model, error);
    if (result == HEWN_OK)
        result = hewn_model_smooth(&model, desc, report, error);
    if (result == HEWN_OK)
        result = hewn_triangles_from_model(&model, &out, error);
    hewn_model_destroy(&model);
    if (result == HEWN_OK) {
        out.paired = triangles->paired;
        hewn_triangles_destroy(triangles);
        *triangles = out;
    }
    return result;
}
