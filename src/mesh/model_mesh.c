#include <string.h>

#include "base/alloc.h"
#include "hewn/model.h"
#include "mesh/carry.h"

/* --- to a mesh ---------------------------------------------------------------------------------------------------- */

static hewn_result build_strictly(const hewn_model *model, const hewn_polygons *polygons, hewn_mesh **out,
                                  hewn_error *error)
{
    HEWN_TRY(hewn_mesh_from_polygons(polygons, out, error));
    return hewn_mesh_carry(*out, model, NULL, error);
}

static hewn_result build_repaired(const hewn_model *model, const hewn_polygons *polygons,
                                  const hewn_repair_desc *repair, hewn_mesh **out, hewn_repair_report *report,
                                  hewn_error *error)
{
    hewn_repair_origins origins;
    HEWN_TRY(hewn_mesh_from_soup(polygons, repair, out, report, &origins, error));
    hewn_result result = hewn_mesh_carry(*out, model, &origins, error);
    if (result == HEWN_OK)
        result = hewn_mesh_spread(*out, &origins, error);
    hewn_repair_origins_destroy(&origins);
    return result;
}

hewn_result hewn_mesh_from_model(const hewn_model *model, const hewn_repair_desc *repair, hewn_mesh **out,
                                 hewn_repair_report *report, hewn_error *error)
{
    *out = NULL;
    if (report)
        *report = (hewn_repair_report){0};
    HEWN_TRY(hewn_model_check(model, error));
    hewn_polygons polygons = hewn_model_polygons(model);
    hewn_result result = repair ? build_repaired(model, &polygons, repair, out, report, error)
                                : build_strictly(model, &polygons, out, error);
    if (result != HEWN_OK) {
        hewn_mesh_destroy(out);
        if (report)
            *report = (hewn_repair_report){0};
    }
    return result;
}

/* --- and back ----------------------------------------------------------------------------------------------------- */

/* Puts vertices and their numbers in the model: `numbers` has one for each live vertex. */
static void copy_verts(const hewn_mesh *mesh, hewn_model *model, uint32_t *numbers)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < mesh->vert_bound; v++) {
        if (!mesh_has_vert(mesh, v))
            continue;
        memcpy(model->positions + 3 * (size_t)count, mesh->position + 3 * (size_t)v, 3 * sizeof(double));
        numbers[v] = count++;
    }
}

static void copy_faces(const hewn_mesh *mesh, hewn_model *model, const uint32_t *numbers)
{
    uint64_t corner = 0, face = 0;
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        if (!mesh_has_face(mesh, f))
            continue;
        uint32_t first = mesh->face_half[f], h = first;
        do {
            model->corners[corner++] = numbers[mesh->head[h]];
            h = mesh->next[h];
        } while (h != first);
        face++;
        if (model->first)
            model->first[face] = corner;
    }
}

static hewn_result copy_elements(const hewn_mesh *mesh, hewn_model *model, hewn_error *error)
{
    uint64_t corners = 0;
    bool triangles = true;
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        uint32_t degree = mesh_has_face(mesh, f) ? hewn_face_degree(mesh, (hewn_face){f}) : 3;
        corners += mesh_has_face(mesh, f) ? degree : 0;
        triangles = triangles && degree == 3;
    }
    model->vertex_count = mesh->live_verts;
    model->face_count = mesh->live_faces;
    model->positions = hewn_alloc(mesh->live_verts, 3 * sizeof *model->positions);
    model->corners = hewn_alloc(corners, sizeof *model->corners);
    model->first = triangles ? NULL : hewn_alloc_zero((size_t)mesh->live_faces + 1, sizeof *model->first);
    uint32_t *numbers = hewn_alloc(mesh->vert_bound, sizeof *numbers);
    bool room = model->positions && model->corners && (triangles || model->first) && numbers;
    if (room) {
        copy_verts(mesh, model, numbers);
        copy_faces(mesh, model, numbers);
    }
    hewn_free(numbers);
    return room ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u faces", mesh->live_faces);
}

static void copy_values(const hewn_mesh *mesh, const mesh_attribute *attribute, unsigned char *to)
{
    size_t stride = attribute->stride;
    for (uint32_t v = 0; attribute->info.domain == HEWN_DOMAIN_VERT && v < mesh->vert_bound; v++)
        if (mesh_has_vert(mesh, v)) {
            memcpy(to, attribute->data + v * stride, stride);
            to += stride;
        }
    for (uint32_t f = 0; attribute->info.domain != HEWN_DOMAIN_VERT && f < mesh->face_bound; f++) {
        if (!mesh_has_face(mesh, f))
            continue;
        uint32_t first = mesh->face_half[f], h = first;
        do {
            uint32_t element = attribute->info.domain == HEWN_DOMAIN_FACE ? f : h;
            memcpy(to, attribute->data + element * stride, stride);
            to += stride;
            h = mesh->next[h];
        } while (attribute->info.domain == HEWN_DOMAIN_CORNER && h != first);
    }
}

static hewn_result copy_names(const mesh_attribute *attribute, hewn_channel *channel, hewn_error *error)
{
    if (attribute->name_count == 0)
        return HEWN_OK;
    channel->names = hewn_alloc(attribute->name_count, sizeof *channel->names);
    for (uint32_t i = 0; channel->names && i < attribute->name_count; i++) {
        channel->names[i] = hewn_strdup(attribute->names[i]);
        if (!channel->names[i])
            break;
        channel->name_count++;
    }
    if (channel->name_count < attribute->name_count)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u names", attribute->name_count);
    return HEWN_OK;
}

static hewn_result copy_attributes(const hewn_mesh *mesh, hewn_model *model, hewn_error *error)
{
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        const mesh_attribute *attribute = &mesh->attributes[i];
        hewn_channel *channel;
        HEWN_TRY(hewn_model_add_channel(model, &attribute->info, &channel, error));
        copy_values(mesh, attribute, channel->values);
        HEWN_TRY(copy_names(attribute, channel, error));
    }
    return HEWN_OK;
}

hewn_result hewn_model_from_mesh(const hewn_mesh *mesh, hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){0};
    hewn_result result = copy_elements(mesh, out, error);
    if (result == HEWN_OK)
        result = copy_attributes(mesh, out, error);
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result;
}
