/* Smoothing the extraction's triangles. */
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/smooth.h"

static hewn_result to_model(const hewn_triangles *triangles, hewn_model *out, hewn_error *error)
{
    const uint64_t vertices = triangles->vertex_count, faces = triangles->triangle_count;
    *out = (hewn_model){.vertex_count = vertices, .face_count = faces};
    out->positions = hewn_alloc(vertices, 3 * sizeof *out->positions);
    out->corners = hewn_alloc(faces, 3 * sizeof *out->corners);
    if (!out->positions || !out->corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %llu triangles",
                         (unsigned long long)faces);
    for (uint64_t i = 0; i < 3 * vertices; i++)
        out->positions[i] = (double)triangles->positions[i];
    memcpy(out->corners, triangles->indices, 3 * faces * sizeof *out->corners);
    if (!triangles->normals)
        return HEWN_OK;
    const hewn_attribute_info info = {"normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3};
    hewn_channel *normals;
    HEWN_TRY(hewn_model_add_channel(out, &info, &normals, error));
    memcpy(normals->values, triangles->normals, 3 * vertices * sizeof *triangles->normals);
    return HEWN_OK;
}

hewn_result hewn_triangles_smooth(hewn_triangles *triangles, const hewn_smooth_desc *desc, hewn_smooth_report *report,
                                  hewn_error *error)
{
    hewn_model model = {0};
    hewn_triangles out = {0};
    hewn_result result = to_model(triangles, &model, error);
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
