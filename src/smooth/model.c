/* Smoothing models and half-edge meshes. */
#include <string.h>

#include "base/alloc.h"
#include "mesh/renew_normals.h"
#include "smooth/work.h"

hewn_result hewn_model_smooth(hewn_model *model, const hewn_smooth_desc *desc, hewn_smooth_report *report,
                              hewn_error *error)
{
    hewn_polygons polygons = hewn_model_polygons(model);
    hewn_smooth_report done;
    if (report)
        *report = (hewn_smooth_report){0};
    double *positions = hewn_alloc(model->vertex_count, 3 * sizeof *positions);
    if (!positions)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %llu vertices",
                         (unsigned long long)model->vertex_count);
    hewn_result result = hewn_polygons_smooth(&polygons, desc, positions, &done, error);
    if (result == HEWN_OK) { /* both sets of positions stay until nothing can fail */
        double *before = model->positions;
        model->positions = positions;
        result = hewn_model_renew_normals(model, error);
        model->positions = result == HEWN_OK ? positions : before;
        positions = result == HEWN_OK ? before : positions;
    }
    if (result == HEWN_OK && report)
        *report = done;
    hewn_free(positions);
    return result;
}

hewn_result hewn_mesh_smooth(hewn_mesh *mesh, const hewn_smooth_desc *desc, hewn_smooth_report *report,
                             hewn_error *error)
{
    if (report)
        *report = (hewn_smooth_report){0};
    if (hewn_mesh_vert_count(mesh) != hewn_mesh_vert_bound(mesh) ||
        hewn_mesh_face_count(mesh) != hewn_mesh_face_bound(mesh))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the mesh has holes; compact it first");
    hewn_model model;
    HEWN_TRY(hewn_model_from_mesh(mesh, &model, error));
    hewn_result result = hewn_model_smooth(&model, desc, report, error);
    for (uint32_t v = 0; result == HEWN_OK && v < model.vertex_count; v++)
        hewn_vert_set_position(mesh, (hewn_vert){v}, model.positions + 3 * (size_t)v);
    uint32_t normals;
    const hewn_channel *channel = hewn_model_find_channel(&model, HEWN_DOMAIN_VERT, "normal");
    bool renewed = channel && hewn_mesh_find_attribute(mesh, HEWN_DOMAIN_VERT, "normal", &normals);
    size_t stride = renewed ? channel->info.components * hewn_scalar_size(channel->info.scalar) : 0;
    for (uint32_t v = 0; result == HEWN_OK && renewed && v < model.vertex_count; v++)
        memcpy(hewn_mesh_attribute_at(mesh, normals, v), (const char *)channel->values + v * stride, stride);
    channel = hewn_model_find_channel(&model, HEWN_DOMAIN_CORNER, "normal");
    renewed = channel && hewn_mesh_find_attribute(mesh, HEWN_DOMAIN_CORNER, "normal", &normals);
    stride = renewed ? channel->info.components * hewn_scalar_size(channel->info.scalar) : 0;
    for (uint32_t f = 0, c = 0; result == HEWN_OK && renewed && f < model.face_count; f++) {
        hewn_half first = hewn_face_half(mesh, (hewn_face){f}), h = first;
        do {
            memcpy(hewn_mesh_attribute_at(mesh, normals, h.id), (const char *)channel->values + c++ * stride, stride);
            h = hewn_half_next(mesh, h);
        } while (h.id != first.id);
    }
    hewn_model_destroy(&model);
    return result;
}
