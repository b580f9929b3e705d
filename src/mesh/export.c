#include "mesh/mesh_data.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"

static bool all_triangles(const hewn_mesh *mesh)
{
    bool triangles = true;
    for (uint32_t f = 0; f < mesh->face_bound && triangles; f++)
        triangles = !mesh_has_face(mesh, f) || mesh_in_triangle(mesh, mesh->face_half[f]);
    return triangles;
}

/* Vertices get new numbers in `numbers`, without the holes. */
static hewn_result write_verts(const hewn_mesh *mesh, uint32_t *numbers, hewn_triangles *out, hewn_error *error)
{
    uint32_t attribute, count = 0;
    const mesh_attribute *normal = NULL;
    if (hewn_mesh_find_attribute(mesh, HEWN_DOMAIN_VERT, "normal", &attribute) && mesh->attributes[attribute].direction)
        normal = &mesh->attributes[attribute];
    if (normal && !(out->normals = hewn_alloc(mesh->live_verts, 3 * sizeof(float))))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u normals", mesh->live_verts);
    for (uint32_t v = 0; v < mesh->vert_bound; v++) {
        if (!mesh_has_vert(mesh, v))
            continue;
        numbers[v] = count++;
        for (size_t k = 0; k < 3; k++) {
            double value = mesh->position[3 * (size_t)v + k];
            float *position = out->positions + 3 * (size_t)numbers[v] + k;
            *position = (float)value;
            if (!isfinite(*position))
                return hewn_fail(error, HEWN_LIMIT, "the position of vertex %u does not fit into a float", v);
            if (normal) {
                const void *at = normal->data + v * normal->stride;
                out->normals[3 * (size_t)numbers[v] + k] =
                    normal->info.scalar == HEWN_SCALAR_FLOAT ? ((const float *)at)[k] : (float)((const double *)at)[k];
            }
        }
    }
    return HEWN_OK;
}

static void write_faces(const hewn_mesh *mesh, const uint32_t *numbers, hewn_triangles *out)
{
    uint32_t *corner = out->indices;
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        if (!mesh_has_face(mesh, f))
            continue;
        uint32_t h = mesh->face_half[f];
        for (int i = 0; i < 3; i++, h = mesh->next[h])
            *corner++ = numbers[mesh->head[h]];
    }
}

static hewn_result write_all(const hewn_mesh *mesh, hewn_triangles *out, hewn_error *error)
{
    uint32_t *numbers = hewn_alloc(mesh->vert_bound, sizeof *numbers);
    *out = (hewn_triangles){.vertex_count = mesh->live_verts, .triangle_count = mesh->live_faces};
    out->positions = hewn_alloc(mesh->live_verts, 3 * sizeof *out->positions);
    out->indices = hewn_alloc(mesh->live_faces, 3 * sizeof *out->indices);
    hewn_result result = HEWN_OK;
    if (!numbers || !out->positions || !out->indices)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u triangles", mesh->live_faces);
    if (result == HEWN_OK)
        result = write_verts(mesh, numbers, out, error);
    if (result == HEWN_OK)
        write_faces(mesh, numbers, out);
    else
        hewn_triangles_destroy(out);
    hewn_free(numbers);
    return result;
}

hewn_result hewn_mesh_to_triangles(const hewn_mesh *mesh, hewn_triangles *out, hewn_error *error)
{
    *out = (hewn_triangles){0};
    if (all_triangles(mesh))
        return write_all(mesh, out, error);
    hewn_mesh *cut;
    HEWN_TRY(hewn_mesh_duplicate(mesh, &cut, error));
    hewn_result result = hewn_mesh_triangulate(cut, error);
    if (result == HEWN_OK)
        result = write_all(cut, out, error);
    hewn_mesh_destroy(&cut);
    return result;
}
