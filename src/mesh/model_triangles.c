#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/model.h"
#include "mesh/cut.h"

static hewn_result copy_positions(const hewn_model *model, hewn_triangles *out, hewn_error *error)
{
    for (uint64_t i = 0; i < 3 * model->vertex_count; i++) {
        out->positions[i] = (float)model->positions[i];
        if (!isfinite(out->positions[i]))
            return hewn_fail(error, HEWN_LIMIT, "the position of vertex %llu does not fit into a float",
                             (unsigned long long)(i / 3));
    }
    return HEWN_OK;
}

static const hewn_channel *find_normals(const hewn_model *model)
{
    const hewn_channel *channel = hewn_model_find_channel(model, HEWN_DOMAIN_VERT, "normal");
    bool real = channel && (channel->info.scalar == HEWN_SCALAR_FLOAT || channel->info.scalar == HEWN_SCALAR_DOUBLE);
    return real && channel->info.components == 3 ? channel : NULL;
}

static hewn_result copy_normals(const hewn_model *model, hewn_triangles *out, hewn_error *error)
{
    const hewn_channel *channel = find_normals(model);
    if (!channel)
        return HEWN_OK;
    out->normals = hewn_alloc(model->vertex_count, 3 * sizeof *out->normals);
    if (!out->normals)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu normals",
                         (unsigned long long)model->vertex_count);
    for (uint64_t i = 0; i < 3 * model->vertex_count; i++)
        out->normals[i] = channel->info.scalar == HEWN_SCALAR_FLOAT ? ((const float *)channel->values)[i]
                                                                    : (float)((const double *)channel->values)[i];
    return HEWN_OK;
}

/* `cut` has three places in `corners` a triangle; NULL: all faces are triangles. */
static hewn_result build(const hewn_model *model, const uint32_t *cut, uint64_t count, hewn_triangles *out,
                         hewn_error *error)
{
    *out = (hewn_triangles){.vertex_count = model->vertex_count, .triangle_count = count};
    out->positions = hewn_alloc(model->vertex_count, 3 * sizeof *out->positions);
    out->indices = hewn_alloc(count, 3 * sizeof *out->indices);
    if (!out->positions || !out->indices)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu triangles", (unsigned long long)count);
    for (uint64_t i = 0; i < 3 * count; i++)
        out->indices[i] = model->corners[cut ? cut[i] : i];
    HEWN_TRY(copy_positions(model, out, error));
    return copy_normals(model, out, error);
}

hewn_result hewn_triangles_from_model(const hewn_model *model, hewn_triangles *out, hewn_error *error)
{
    *out = (hewn_triangles){0};
    HEWN_TRY(hewn_model_check(model, error));
    uint32_t *cut = NULL;
    uint64_t count = model->face_count;
    if (model->first) {
        hewn_polygons polygons = hewn_model_polygons(model);
        HEWN_TRY(hewn_cut_polygons(&polygons, &cut, &count, NULL, error));
    }
    hewn_result result = build(model, cut, count, out, error);
    hewn_free(cut);
    if (result != HEWN_OK)
        hewn_triangles_destroy(out);
    return result;
}

/* --- and back ----------------------------------------------------------------------------------------------------- */

static hewn_result fill(const hewn_triangles *triangles, hewn_model *out, hewn_error *error)
{
    const uint64_t vertices = out->vertex_count = triangles->vertex_count;
    const uint64_t faces = out->face_count = triangles->triangle_count;
    out->positions = hewn_alloc(vertices, 3 * sizeof *out->positions);
    out->corners = hewn_alloc(faces, 3 * sizeof *out->corners);
    if (!out->positions || !out->corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu triangles", (unsigned long long)faces);
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

hewn_result hewn_model_from_triangles(const hewn_triangles *triangles, hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){0};
    hewn_result result = fill(triangles, out, error);
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result;
}
