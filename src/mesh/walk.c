#include "mesh/mesh_data.h"

bool hewn_mesh_has_vert(const hewn_mesh *mesh, hewn_vert vert)
{
    return mesh_has_vert(mesh, vert.id);
}

bool hewn_mesh_has_half(const hewn_mesh *mesh, hewn_half half)
{
    return mesh_has_half(mesh, half.id);
}

bool hewn_mesh_has_face(const hewn_mesh *mesh, hewn_face face)
{
    return mesh_has_face(mesh, face.id);
}

/* Fields of deleted half-edges are HEWN_NONE, so only the range needs a look. */
static uint32_t field(const hewn_mesh *mesh, const uint32_t *values, uint32_t h)
{
    return h < mesh->half_bound ? values[h] : HEWN_NONE;
}

hewn_half hewn_half_next(const hewn_mesh *mesh, hewn_half half)
{
    return (hewn_half){field(mesh, mesh->next, half.id)};
}

hewn_half hewn_half_prev(const hewn_mesh *mesh, hewn_half half)
{
    return (hewn_half){field(mesh, mesh->prev, half.id)};
}

hewn_vert hewn_half_head(const hewn_mesh *mesh, hewn_half half)
{
    return (hewn_vert){field(mesh, mesh->head, half.id)};
}

hewn_vert hewn_half_tail(const hewn_mesh *mesh, hewn_half half)
{
    return (hewn_vert){field(mesh, mesh->head, half.id ^ 1)};
}

hewn_face hewn_half_face(const hewn_mesh *mesh, hewn_half half)
{
    return (hewn_face){field(mesh, mesh->face, half.id)};
}

hewn_half hewn_vert_half(const hewn_mesh *mesh, hewn_vert vert)
{
    return (hewn_half){mesh_has_vert(mesh, vert.id) ? mesh->vert_half[vert.id] : HEWN_NONE};
}

hewn_half hewn_face_half(const hewn_mesh *mesh, hewn_face face)
{
    return (hewn_half){mesh_has_face(mesh, face.id) ? mesh->face_half[face.id] : HEWN_NONE};
}

bool hewn_vert_on_boundary(const hewn_mesh *mesh, hewn_vert vert)
{
    return mesh_has_vert(mesh, vert.id) && mesh_on_boundary(mesh, vert.id);
}

uint32_t hewn_face_degree(const hewn_mesh *mesh, hewn_face face)
{
    if (!mesh_has_face(mesh, face.id))
        return 0;
    uint32_t first = mesh->face_half[face.id], h = first, count = 0;
    do {
        count++;
        h = mesh->next[h];
    } while (h != first);
    return count;
}

/* Both rings are walked in step, so a hub costs no more than its lesser neighbour. */
uint32_t hewn_mesh_find(const hewn_mesh *mesh, uint32_t from, uint32_t to)
{
    uint32_t first = mesh->vert_half[from], second = mesh->vert_half[to];
    if (first == HEWN_NONE || second == HEWN_NONE)
        return HEWN_NONE;
    uint32_t h = first, g = second;
    do {
        if (mesh->head[h] == to)
            return h;
        if (mesh->head[g] == from)
            return g ^ 1;
        h = mesh_ccw(mesh, h);
        g = mesh_ccw(mesh, g);
    } while (h != first && g != second);
    return HEWN_NONE;
}

hewn_half hewn_mesh_find_half(const hewn_mesh *mesh, hewn_vert from, hewn_vert to)
{
    if (!mesh_has_vert(mesh, from.id) || !mesh_has_vert(mesh, to.id))
        return HEWN_HALF_NONE;
    return (hewn_half){hewn_mesh_find(mesh, from.id, to.id)};
}
