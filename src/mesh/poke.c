#include "mesh/mesh_data.h"

#include <math.h>

#include "base/alloc.h"
#include "mesh/plane.h"

/* What blending needs: the corners of the face from its first on, and their weights. */
typedef struct corner_weights {
    uint32_t count;
    uint32_t *halves, *verts;
    double *weights;
} corner_weights;

/* The new vertex goes through the same projection as the corners, as one corner more that does not count. */
static hewn_result find_weights(const hewn_mesh *mesh, const double *point, corner_weights *out, hewn_error *error)
{
    uint32_t count = out->count;
    const double **corners = hewn_alloc((size_t)count + 1, sizeof *corners);
    double *plane = hewn_alloc((size_t)count + 1, 2 * sizeof *plane);
    if (!corners || !plane) {
        hewn_free(corners);
        hewn_free(plane);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory blending %u corners", count);
    }
    for (uint32_t i = 0; i < count; i++)
        corners[i] = mesh->position + 3 * (size_t)out->verts[i];
    corners[count] = point;
    hewn_plane_project(corners, count, count + 1, plane);
    hewn_plane_weights(plane, count, plane + 2 * (size_t)count, out->weights);
    hewn_free(corners);
    hewn_free(plane);
    return HEWN_OK;
}

static hewn_result collect(const hewn_mesh *mesh, uint32_t f, const double *point, corner_weights *out,
                           hewn_error *error)
{
    *out = (corner_weights){.count = hewn_face_degree(mesh, (hewn_face){f})};
    out->halves = hewn_alloc(out->count, sizeof *out->halves);
    out->verts = hewn_alloc(out->count, sizeof *out->verts);
    out->weights = hewn_alloc(out->count, sizeof *out->weights);
    if (!out->halves || !out->verts || !out->weights)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a face of %u corners", out->count);
    uint32_t h = mesh->face_half[f];
    for (uint32_t i = 0; i < out->count; i++, h = mesh->next[h]) {
        out->halves[i] = h;
        out->verts[i] = mesh->head[h];
    }
    return find_weights(mesh, point, out, error);
}

/* Triangle i lies between the corners i and i + 1; the first takes the face over. */
static void fan_out(hewn_mesh *mesh, uint32_t f, const corner_weights *corners, uint32_t v)
{
    uint32_t count = corners->count, first_spoke = mesh->half_bound;
    for (uint32_t i = 0; i < count; i++)
        hewn_mesh_new_edge(mesh, v, corners->verts[i]);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t j = i + 1 < count ? i + 1 : 0, side = corners->halves[j];
        uint32_t out = first_spoke + 2 * i, back = (first_spoke + 2 * j) ^ 1;
        uint32_t face = i == 0 ? f : hewn_mesh_new_face(mesh, out);
        mesh->face_half[face] = out;
        mesh->face[out] = mesh->face[side] = mesh->face[back] = face;
        mesh_link(mesh, out, side);
        mesh_link(mesh, side, back);
        mesh_link(mesh, back, out);
        if (face != f)
            hewn_mesh_copy_values(mesh, HEWN_DOMAIN_FACE, face, f);
        hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, out, corners->halves[i]);
        hewn_mesh_blend_values(mesh, HEWN_DOMAIN_CORNER, back, corners->halves, corners->weights, count);
    }
    mesh->vert_half[v] = first_spoke;
    hewn_mesh_blend_values(mesh, HEWN_DOMAIN_VERT, v, corners->verts, corners->weights, count);
}

hewn_result hewn_mesh_poke(hewn_mesh *mesh, hewn_face face, const double position[3], hewn_vert *out, hewn_error *error)
{
    if (out)
        *out = HEWN_VERT_NONE;
    if (!mesh_has_face(mesh, face.id))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no face %u to poke", face.id);
    if (!isfinite(position[0]) || !isfinite(position[1]) || !isfinite(position[2]))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the position of a vertex must be finite");
    const double point[3] = {position[0], position[1], position[2]};
    corner_weights corners;
    hewn_result result = collect(mesh, face.id, point, &corners, error);
    if (result == HEWN_OK)
        result = hewn_mesh_reserve(mesh, 1, corners.count, corners.count - 1, error);
    if (result == HEWN_OK) {
        uint32_t v = hewn_mesh_new_vert(mesh, point);
        fan_out(mesh, face.id, &corners, v);
        if (out)
            out->id = v;
    }
    hewn_free(corners.halves);
    hewn_free(corners.verts);
    hewn_free(corners.weights);
    return result;
}
