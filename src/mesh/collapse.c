#include "mesh/mesh_data.h"

#include <string.h>

/* --- whether ------------------------------------------------------------------------------------------------------ */

static bool beside_triangle(const hewn_mesh *mesh, uint32_t h)
{
    return mesh->face[h] != HEWN_NONE && mesh_in_triangle(mesh, h);
}

/* Whether some vertex but the two apexes is joined to both ends: the two edges to it would become one. */
static bool has_other_neighbour(const hewn_mesh *mesh, uint32_t h, uint32_t left, uint32_t right)
{
    uint32_t head = mesh->head[h];
    for (uint32_t g = mesh_ccw(mesh, h); g != h; g = mesh_ccw(mesh, g)) {
        uint32_t v = mesh->head[g];
        if (v != left && v != right && hewn_mesh_find(mesh, v, head) != HEWN_NONE)
            return true;
    }
    return false;
}

/* Whether a face that is not beside the edge has both ends as corners: it would visit the head twice. */
static bool has_other_face(const hewn_mesh *mesh, uint32_t h)
{
    uint32_t head = mesh->head[h];
    for (uint32_t g = mesh_ccw(mesh, h); g != h; g = mesh_ccw(mesh, g)) {
        uint32_t f = mesh->face[g];
        if (f == HEWN_NONE || f == mesh->face[h] || f == mesh->face[h ^ 1])
            continue;
        for (uint32_t k = mesh->next[g]; k != g; k = mesh->next[k])
            if (mesh->head[k] == head)
                return true;
    }
    return false;
}

static bool has_three_edges(const hewn_mesh *mesh, uint32_t h)
{
    return mesh_ccw(mesh, mesh_ccw(mesh, mesh_ccw(mesh, h))) == h;
}

bool hewn_mesh_can_collapse(const hewn_mesh *mesh, hewn_half half)
{
    uint32_t h = half.id, g = h ^ 1;
    if (!mesh_has_half(mesh, h))
        return false;
    uint32_t left = HEWN_NONE, right = HEWN_NONE;
    if (beside_triangle(mesh, h))
        left = mesh->head[mesh->next[h]];
    if (beside_triangle(mesh, g))
        right = mesh->head[mesh->next[g]];
    bool inside = mesh->face[h] != HEWN_NONE && mesh->face[g] != HEWN_NONE;
    if (inside) {
        if (mesh_on_boundary(mesh, mesh_tail(mesh, h)) && mesh_on_boundary(mesh, mesh->head[h]))
            return false;
        if (left != HEWN_NONE && right != HEWN_NONE &&
            (left == right || (has_three_edges(mesh, h) && has_three_edges(mesh, g))))
            return false;
    } else {
        uint32_t k = mesh->face[h] != HEWN_NONE ? h : g;
        if (mesh_in_triangle(mesh, k) && mesh->face[mesh->next[k] ^ 1] == HEWN_NONE &&
            mesh->face[mesh->prev[k] ^ 1] == HEWN_NONE)
            return false;
    }
    return !has_other_neighbour(mesh, h, left, right) && !has_other_face(mesh, h);
}

/* --- doing -------------------------------------------------------------------------------------------------------- */

/* Corners of the tail become corners of the head. Each attribute on its own: a corner that had the tail's value left or
 * right of the edge takes the head's value there. */
static void move_corner(mesh_attribute *attribute, uint32_t corner, const uint32_t tail_corner[2],
                        const uint32_t head_corner[2])
{
    unsigned char *data = attribute->data, *at = data + corner * attribute->stride;
    for (int side = 0; side < 2; side++) {
        if (tail_corner[side] == HEWN_NONE ||
            memcmp(at, data + tail_corner[side] * attribute->stride, attribute->stride) != 0)
            continue;
        memcpy(at, data + head_corner[side] * attribute->stride, attribute->stride);
        return;
    }
}

static void move_corners(hewn_mesh *mesh, uint32_t h)
{
    uint32_t g = h ^ 1;
    bool left = mesh->face[h] != HEWN_NONE, right = mesh->face[g] != HEWN_NONE;
    const uint32_t tail_corner[2] = {left ? mesh->prev[h] : HEWN_NONE, right ? g : HEWN_NONE};
    const uint32_t head_corner[2] = {h, right ? mesh->prev[g] : HEWN_NONE};
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        if (mesh->attributes[i].info.domain != HEWN_DOMAIN_CORNER)
            continue;
        for (uint32_t k = mesh_ccw(mesh, h); k != h; k = mesh_ccw(mesh, k))
            if (mesh->face[k ^ 1] != HEWN_NONE && (k ^ 1) != tail_corner[0])
                move_corner(&mesh->attributes[i], k ^ 1, tail_corner, head_corner);
    }
    /* A polygon at the left stays, and with it the half-edge that now ends at the head. */
    if (left)
        hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, mesh->prev[h], h);
}

/* A triangle that lost its edge is a loop of two: `gone` and its twin are dropped, `kept` takes the place that the twin
 * of `gone` had in the loop beyond. */
static void close_gap(hewn_mesh *mesh, uint32_t kept, uint32_t gone)
{
    uint32_t beyond = gone ^ 1, face = mesh->face[beyond], v = mesh->head[beyond], w = mesh->head[gone];
    hewn_mesh_drop_face(mesh, mesh->face[kept]);
    mesh->face[kept] = face;
    mesh_link(mesh, mesh->prev[beyond], kept);
    mesh_link(mesh, kept, mesh->next[beyond]);
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, kept, beyond);
    if (face != HEWN_NONE && mesh->face_half[face] == beyond)
        mesh->face_half[face] = kept;
    if (mesh->vert_half[v] == gone)
        mesh->vert_half[v] = kept ^ 1;
    if (mesh->vert_half[w] == beyond)
        mesh->vert_half[w] = kept;
    hewn_mesh_drop_edge(mesh, gone);
}

/* Takes h out of its loop. */
static void unlink_half(hewn_mesh *mesh, uint32_t h)
{
    uint32_t face = mesh->face[h];
    mesh_link(mesh, mesh->prev[h], mesh->next[h]);
    if (face != HEWN_NONE && mesh->face_half[face] == h)
        mesh->face_half[face] = mesh->prev[h];
}

void hewn_mesh_collapse_unchecked(hewn_mesh *mesh, uint32_t h)
{
    uint32_t g = h ^ 1, tail = mesh->head[g], head = mesh->head[h];
    uint32_t after = mesh->next[h], before = mesh->prev[h], right_before = mesh->prev[g], right_after = mesh->next[g];
    bool left = beside_triangle(mesh, h), right = beside_triangle(mesh, g);
    if (hewn_mesh_has_values(mesh, HEWN_DOMAIN_CORNER))
        move_corners(mesh, h);
    for (uint32_t k = mesh_ccw(mesh, h); k != h; k = mesh_ccw(mesh, k))
        mesh->head[k ^ 1] = head;
    unlink_half(mesh, h);
    unlink_half(mesh, g);
    mesh->vert_half[head] = HEWN_NONE;
    if (left)
        close_gap(mesh, after, before);
    if (right)
        close_gap(mesh, right_before, right_after);
    hewn_mesh_drop_edge(mesh, h);
    hewn_mesh_drop_vert(mesh, tail);
    hewn_mesh_settle_vert(mesh, head, after);
}

void hewn_mesh_collapse(hewn_mesh *mesh, hewn_half half)
{
    if (hewn_mesh_can_collapse(mesh, half))
        hewn_mesh_collapse_unchecked(mesh, half.id);
}
