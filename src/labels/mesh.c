#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/labels.h"
#include "labels/cut.h"
#include "labels/islands.h"
#include "labels/relax.h"

static hewn_result fail_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the mesh of labels");
}

void hewn_label_mesh_destroy(hewn_label_mesh *mesh)
{
    hewn_free(mesh->labels);
    hewn_free(mesh->voxel_count);
    hewn_free(mesh->positions);
    hewn_free(mesh->indices);
    hewn_free(mesh->sides);
    hewn_free(mesh->first);
    hewn_free(mesh->faces);
    *mesh = (hewn_label_mesh){0};
}

uint32_t hewn_label_mesh_find(const hewn_label_mesh *mesh, int64_t label)
{
    uint32_t lo = 0, hi = mesh->label_count;
    while (lo < hi) {
        uint32_t middle = lo + (hi - lo) / 2;
        if (mesh->labels[middle] < label)
            lo = middle + 1;
        else
            hi = middle;
    }
    return lo < mesh->label_count && mesh->labels[lo] == label ? lo + 1 : 0;
}

/* --- meshing -------------------------------------------------------------------------------------------------------
 */

/* From the lattice to the world, where a left-handed lattice turns triangles over. */
static hewn_result bring_to_world(const hewn_volume *volume, hewn_label_mesh *mesh, hewn_error *error)
{
    bool turned = hewn_volume_determinant(volume) < 0, finite = true;
#pragma omp parallel for schedule(static) reduction(&& : finite)
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        double world[3], *at = mesh->positions + 3 * v;
        hewn_volume_to_world(volume, at, world);
        memcpy(at, world, sizeof world);
        finite = finite && isfinite(world[0]) && isfinite(world[1]) && isfinite(world[2]);
    }
    for (uint64_t t = 0; turned && t < mesh->triangle_count; t++) {
        uint32_t *corners = mesh->indices + 3 * t, second = corners[1];
        corners[1] = corners[2];
        corners[2] = second;
    }
    return finite ? HEWN_OK : hewn_fail(error, HEWN_LIMIT, "the volume's place in the world is too far for doubles");
}

/* Each label's triangles. */
static hewn_result list_faces(hewn_label_mesh *mesh, hewn_error *error)
{
    mesh->first = hewn_alloc_zero((size_t)mesh->label_count + 3, sizeof *mesh->first);
    mesh->faces = hewn_alloc(mesh->triangle_count, 2 * sizeof *mesh->faces);
    if (!mesh->first || !mesh->faces)
        return fail_memory(error);
    for (uint64_t i = 0; i < 2 * mesh->triangle_count; i++)
        mesh->first[mesh->sides[i] + 2]++;
    for (uint32_t n = 0; n <= mesh->label_count; n++)
        mesh->first[n + 2] += mesh->first[n + 1];
    for (uint64_t i = 0; i < 2 * mesh->triangle_count; i++)
        mesh->faces[mesh->first[mesh->sides[i] + 1]++] = (uint32_t)i;
    return HEWN_OK;
}

static hewn_result make(const hewn_volume *volume, const hewn_label_desc *desc, hewn_label_ids *ids,
                        hewn_label_nets *nets, hewn_label_mesh *out, hewn_error *error)
{
    HEWN_TRY(hewn_label_ids_find(volume, desc, ids, error));
    if (desc->keep)
        HEWN_TRY(
            hewn_label_islands_choose(ids, desc->keep, fabs(hewn_volume_determinant(volume)), &out->islands, error));
    HEWN_TRY(hewn_label_nets_make(ids, desc->progress, nets, error));
    HEWN_TRY(hewn_label_nets_relax(nets, desc->relaxations, desc->progress, error));
    HEWN_TRY(hewn_label_nets_cut(nets, volume->to_world, out, error));
    out->label_count = ids->label_count;
    out->labels = ids->labels;
    out->voxel_count = ids->voxel_count;
    ids->labels = NULL;
    ids->voxel_count = NULL;
    HEWN_TRY(bring_to_world(volume, out, error));
    return list_faces(out, error);
}

hewn_result hewn_labels_mesh(const hewn_volume *volume, const hewn_label_desc *desc, hewn_label_mesh *out,
                             hewn_error *error)
{
    static const hewn_label_desc defaults;
    hewn_label_ids ids = {0};
    hewn_label_nets nets = {0};
    *out = (hewn_label_mesh){0};
    hewn_result result = make(volume, desc ? desc : &defaults, &ids, &nets, out, error);
    hewn_label_ids_free(&ids);
    hewn_label_nets_free(&nets);
    if (result != HEWN_OK)
        hewn_label_mesh_destroy(out);
    return result;
}

hewn_result hewn_label_mesh_smooth(hewn_label_mesh *mesh, const hewn_smooth_desc *desc, hewn_smooth_report *report,
                                   hewn_error *error)
{
    hewn_polygons polygons = {.positions = mesh->positions,
                              .vertex_count = mesh->vertex_count,
                              .corners = mesh->indices,
                              .face_count = mesh->triangle_count};
    return hewn_polygons_smooth(&polygons, desc, mesh->positions, report, error);
}

/* What was made of faces keeps their sides. */
static hewn_result take(hewn_label_mesh *mesh, hewn_simplified *from, hewn_error *error)
{
    uint16_t *sides = hewn_alloc(from->face_count, 2 * sizeof *sides);
    if (!sides)
        return fail_memory(error);
    for (uint64_t f = 0; f < from->face_count; f++)
        memcpy(sides + 2 * f, mesh->sides + 2 * (size_t)from->face_origins[f], 2 * sizeof *sides);
    hewn_free(mesh->sides);
    hewn_free(mesh->positions);
    hewn_free(mesh->indices);
    hewn_free(mesh->first);
    hewn_free(mesh->faces);
    mesh->sides = sides;
    mesh->positions = from->positions;
    mesh->indices = from->corners;
    mesh->vertex_count = from->vertex_count;
    mesh->triangle_count = from->face_count;
    mesh->first = NULL;
    mesh->faces = NULL;
    from->positions = NULL;
    from->corners = NULL;
    return list_faces(mesh, error);
}

hewn_result hewn_label_mesh_simplify(hewn_label_mesh *mesh, const hewn_simplify_desc *desc,
                                     hewn_simplify_report *report, hewn_error *error)
{
    hewn_polygons polygons = {.positions = mesh->positions,
                              .vertex_count = mesh->vertex_count,
                              .corners = mesh->indices,
                              .face_count = mesh->triangle_count};
    hewn_simplified simple;
    HEWN_TRY(hewn_polygons_simplify(&polygons, desc, &simple, report, error));
    hewn_result result = take(mesh, &simple, error);
    hewn_simplified_destroy(&simple);
    return result;
}

/* --- shells --------------------------------------------------------------------------------------------------------
 */

/* The corners of a triangle as a label sees it from outside. */
static void read_face(const hewn_label_mesh *mesh, uint32_t face, uint32_t out[3])
{
    const uint32_t *corners = mesh->indices + 3 * (size_t)(face >> 1);
    out[0] = corners[0];
    out[1] = corners[face & 1 ? 2 : 1];
    out[2] = corners[face & 1 ? 1 : 2];
}

/* Writes the shell of a label behind what `to` has. `place` (a vertex each) is all 0, and is so again. */
static void append_shell(const hewn_label_mesh *mesh, uint32_t number, uint32_t *place, hewn_model *to)
{
    for (uint64_t i = mesh->first[number]; i < mesh->first[number + 1]; i++) {
        uint32_t corners[3];
        read_face(mesh, mesh->faces[i], corners);
        for (int k = 0; k < 3; k++) {
            uint32_t *at = &place[corners[k]];
            if (*at == 0) {
                memcpy(to->positions + 3 * to->vertex_count, mesh->positions + 3 * (size_t)corners[k],
                       3 * sizeof *to->positions);
                *at = (uint32_t)++to->vertex_count;
            }
            to->corners[3 * to->face_count + (uint64_t)k] = *at - 1;
        }
        to->face_count++;
    }
    for (uint64_t i = mesh->first[number]; i < mesh->first[number + 1]; i++)
        for (int k = 0; k < 3; k++)
            place[mesh->indices[3 * (size_t)(mesh->faces[i] >> 1) + (size_t)k]] = 0;
}

/* Shells of labels `from` to `to` - 1. */
static hewn_result make_shells(const hewn_label_mesh *mesh, uint32_t from, uint32_t to, hewn_model *out,
                               hewn_error *error)
{
    uint64_t faces = mesh->first[to] - mesh->first[from];
    *out = (hewn_model){.up = HEWN_AXIS_PLUS_Z};
    if (3 * faces >= UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "the shells of all labels have more corners than indices can name");
    uint32_t *place = hewn_alloc_zero(mesh->vertex_count, sizeof *place); /* costs only what is touched */
    out->positions = hewn_alloc(3 * faces, 3 * sizeof *out->positions);
    out->corners = hewn_alloc(faces, 3 * sizeof *out->corners);
    bool all_there = place && out->positions && out->corners;
    if (all_there) {
        for (uint32_t number = from; number < to; number++)
            append_shell(mesh, number, place, out);
        double *fitting = hewn_realloc(out->positions, out->vertex_count, 3 * sizeof *out->positions);
        out->positions = fitting ? fitting : out->positions;
    }
    hewn_free(place);
    if (all_there)
        return HEWN_OK;
    hewn_model_destroy(out);
    return fail_memory(error);
}

hewn_result hewn_label_mesh_shell(const hewn_label_mesh *mesh, uint32_t number, hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){0};
    if (number == 0 || number > mesh->label_count)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no label number %u; there are %u", number,
                         mesh->label_count);
    return make_shells(mesh, number, number + 1, out, error);
}

static hewn_result name_shells(const hewn_label_mesh *mesh, const char *const *names, hewn_model *model,
                               hewn_error *error)
{
    hewn_channel *object;
    int32_t value;
    hewn_attribute_info info = {"object", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1};
    HEWN_TRY(hewn_model_add_channel(model, &info, &object, error));
    for (uint32_t n = 0; n < mesh->label_count; n++) {
        HEWN_TRY(hewn_channel_value(object, names[n], &value, error));
        if (value != (int32_t)n)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "two labels have the name '%s'", names[n]);
        for (uint64_t i = mesh->first[n + 1]; i < mesh->first[n + 2]; i++)
            ((int32_t *)object->values)[i - mesh->first[1]] = value;
    }
    return HEWN_OK;
}

hewn_result hewn_label_mesh_shells(const hewn_label_mesh *mesh, const char *const *names, hewn_model *out,
                                   hewn_error *error)
{
    HEWN_TRY(make_shells(mesh, 1, mesh->label_count + 1, out, error));
    hewn_result result = name_shells(mesh, names, out, error);
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result;
}

/* --- the mesh as a model -------------------------------------------------------------------------------------------
 */

static hewn_result fill_side(const hewn_label_mesh *mesh, int side, int32_t outside, hewn_model *model,
                             hewn_error *error)
{
    hewn_channel *channel;
    hewn_attribute_info info = {side == 0 ? "back" : "front", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1};
    HEWN_TRY(hewn_model_add_channel(model, &info, &channel, error));
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        uint16_t number = mesh->sides[2 * t + (uint64_t)side];
        ((int32_t *)channel->values)[t] = number == 0 ? outside : (int32_t)mesh->labels[number - 1];
    }
    return HEWN_OK;
}

hewn_result hewn_label_mesh_model(const hewn_label_mesh *mesh, int32_t outside, hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){.vertex_count = mesh->vertex_count, .face_count = mesh->triangle_count, .up = HEWN_AXIS_PLUS_Z};
    for (uint32_t n = 0; n < mesh->label_count; n++)
        if (mesh->labels[n] < INT32_MIN || mesh->labels[n] > INT32_MAX)
            return hewn_fail(error, HEWN_LIMIT, "label %lld is too large for a number of 32 bits",
                             (long long)mesh->labels[n]);
    out->positions = hewn_alloc(mesh->vertex_count, 3 * sizeof *out->positions);
    out->corners = hewn_alloc(mesh->triangle_count, 3 * sizeof *out->corners);
    hewn_result result = HEWN_OK;
    if (out->positions && out->corners) {
        memcpy(out->positions, mesh->positions, mesh->vertex_count * 3 * sizeof *out->positions);
        memcpy(out->corners, mesh->indices, mesh->triangle_count * 3 * sizeof *out->corners);
        result = fill_side(mesh, 0, outside, out, error);
        if (result == HEWN_OK)
            result = fill_side(mesh, 1, outside, out, error);
    } else {
        result = fail_memory(error);
    }
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result;
}
