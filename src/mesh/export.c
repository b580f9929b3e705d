#include "mesh/mesh_data.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "mesh/cut.h"

/* The faces of a mesh one after the other, over its vertices as they are numbered. */
typedef struct face_list {
    hewn_polygons polygons;
    uint64_t *first;
    uint32_t *corners;
} face_list;

static void free_list(face_list *list)
{
    hewn_free(list->first);
    hewn_free(list->corners);
}

static hewn_result list_faces(const hewn_mesh *mesh, face_list *out, hewn_error *error)
{
    uint64_t count = 0, at = 0, face = 0;
    for (uint32_t h = 0; h < mesh->half_bound; h++)
        count += mesh->face[h] != HEWN_NONE;
    out->first = hewn_alloc(mesh->live_faces + 1ull, sizeof *out->first);
    out->corners = hewn_alloc(count, sizeof *out->corners);
    if (!out->first || !out->corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u faces", mesh->live_faces);
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        if (!mesh_has_face(mesh, f))
            continue;
        out->first[face++] = at;
        uint32_t h = mesh->face_half[f];
        do {
            out->corners[at++] = mesh->head[h];
            h = mesh->next[h];
        } while (h != mesh->face_half[f]);
    }
    out->first[face] = at;
    out->polygons = (hewn_polygons){mesh->vert_bound, mesh->position, face, out->first, out->corners};
    return HEWN_OK;
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

/* `triangles` are positions in the list of corners. */
static hewn_result write_all(const hewn_mesh *mesh, const face_list *list, const uint32_t *triangles, uint64_t count,
                             hewn_triangles *out, hewn_error *error)
{
    uint32_t *numbers = hewn_alloc(mesh->vert_bound, sizeof *numbers);
    *out = (hewn_triangles){.vertex_count = mesh->live_verts, .triangle_count = count};
    out->positions = hewn_alloc(mesh->live_verts, 3 * sizeof *out->positions);
    out->indices = hewn_alloc(count, 3 * sizeof *out->indices);
    hewn_result result = HEWN_OK;
    if (!numbers || !out->positions || !out->indices)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu triangles", (unsigned long long)count);
    if (result == HEWN_OK)
        result = write_verts(mesh, numbers, out, error);
    for (uint64_t i = 0; i < 3 * count && result == HEWN_OK; i++)
        out->indices[i] = numbers[list->corners[triangles[i]]];
    if (result != HEWN_OK)
        hewn_triangles_destroy(out);
    hewn_free(numbers);
    return result;
}

hewn_result hewn_mesh_to_triangles(const hewn_mesh *mesh, hewn_triangles *out, hewn_error *error)
{
    *out = (hewn_triangles){0};
    face_list list = {0};
    uint32_t *triangles = NULL;
    uint64_t count = 0;
    hewn_result result = list_faces(mesh, &list, error);
    if (result == HEWN_OK)
        result = hewn_cut_polygons(&list.polygons, &triangles, &count, NULL, error);
    if (result == HEWN_OK)
        result = write_all(mesh, &list, triangles, count, out, error);
    hewn_free(triangles);
    free_list(&list);
    return result;
}
