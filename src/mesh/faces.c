#include "mesh/mesh_data.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

hewn_result hewn_mesh_add_vert(hewn_mesh *mesh, const double position[3], hewn_vert *out, hewn_error *error)
{
    if (out)
        *out = HEWN_VERT_NONE;
    if (!isfinite(position[0]) || !isfinite(position[1]) || !isfinite(position[2]))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the position of a vertex must be finite");
    const double copy[3] = {position[0], position[1], position[2]}; /* it may lie in the array that grows */
    HEWN_TRY(hewn_mesh_reserve(mesh, 1, 0, 0, error));
    uint32_t v = hewn_mesh_new_vert(mesh, copy);
    if (out)
        out->id = v;
    return HEWN_OK;
}

/* --- adding a face ------------------------------------------------------------------------------------------------ */

/* The sides of a face to be: each the half-edge that is there already, or HEWN_NONE for one to be made. */
typedef struct new_face {
    const hewn_vert *corners;
    uint32_t count;
    uint32_t *sides; /* side i runs from corner i to the next */
} new_face;

static int by_value(const void *a, const void *b)
{
    uint32_t left = *(const uint32_t *)a, right = *(const uint32_t *)b;
    return (left > right) - (left < right);
}

/* Uses `sides` as scratch. */
static hewn_result check_corners(const hewn_mesh *mesh, const new_face *face, hewn_error *error)
{
    for (uint32_t i = 0; i < face->count; i++) {
        face->sides[i] = face->corners[i].id;
        if (!mesh_has_vert(mesh, face->sides[i]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no vertex %u", face->sides[i]);
    }
    qsort(face->sides, face->count, sizeof *face->sides, by_value);
    for (uint32_t i = 1; i < face->count; i++)
        if (face->sides[i] == face->sides[i - 1])
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a face cannot have the vertex %u twice", face->sides[i]);
    return HEWN_OK;
}

static hewn_result find_sides(const hewn_mesh *mesh, const new_face *face, hewn_error *error)
{
    for (uint32_t i = 0; i < face->count; i++) {
        uint32_t from = face->corners[i].id, to = face->corners[(i + 1) % face->count].id;
        face->sides[i] = hewn_mesh_find(mesh, from, to);
        if (face->sides[i] != HEWN_NONE && mesh->face[face->sides[i]] != HEWN_NONE)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                             "the edge from vertex %u to vertex %u has a face there already", from, to);
    }
    for (uint32_t i = 0; i < face->count; i++) {
        uint32_t v = face->corners[i].id, before = face->sides[(i + face->count - 1) % face->count];
        if (before == HEWN_NONE && face->sides[i] == HEWN_NONE && mesh->vert_half[v] != HEWN_NONE)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the faces around vertex %u would form more than one fan",
                             v);
    }
    return HEWN_OK;
}

/* Links the loops through corner v, which `in` reaches and `out` leaves along the new face, and what lies outside. */
static void link_corner(hewn_mesh *mesh, uint32_t v, uint32_t in, bool in_is_new, uint32_t out, bool out_is_new)
{
    if (in_is_new && out_is_new) {
        mesh_link(mesh, out ^ 1, in ^ 1);
        mesh->vert_half[v] = in ^ 1;
    } else if (out_is_new) {
        mesh_link(mesh, out ^ 1, mesh->next[in]);
    } else if (in_is_new) {
        mesh_link(mesh, mesh->prev[out], in ^ 1);
        mesh->vert_half[v] = in ^ 1;
    }
    mesh_link(mesh, in, out);
}

static uint32_t make_face(hewn_mesh *mesh, const new_face *face)
{
    uint32_t count = face->count, first_new = mesh->half_bound;
    for (uint32_t i = 0; i < count; i++)
        if (face->sides[i] == HEWN_NONE)
            face->sides[i] = hewn_mesh_new_edge(mesh, face->corners[i].id, face->corners[(i + 1) % count].id);
    uint32_t f = hewn_mesh_new_face(mesh, face->sides[count - 1]);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t in = face->sides[(i + count - 1) % count], out = face->sides[i];
        link_corner(mesh, face->corners[i].id, in, in >= first_new, out, out >= first_new);
    }
    for (uint32_t i = 0; i < count; i++) {
        mesh->face[face->sides[i]] = f;
        hewn_mesh_clear_values(mesh, HEWN_DOMAIN_CORNER, face->sides[i]);
    }
    return f;
}

hewn_result hewn_mesh_add_face(hewn_mesh *mesh, const hewn_vert *corners, uint32_t count, hewn_face *out,
                               hewn_error *error)
{
    if (out)
        *out = HEWN_FACE_NONE;
    if (count < 3)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a face needs three corners, not %u", count);
    new_face face = {corners, count, hewn_alloc(count, sizeof(uint32_t))};
    if (!face.sides)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a face of %u corners", count);
    hewn_result result = check_corners(mesh, &face, error);
    if (result == HEWN_OK)
        result = find_sides(mesh, &face, error);
    if (result == HEWN_OK)
        result = hewn_mesh_reserve(mesh, 0, count, 1, error);
    if (result == HEWN_OK) {
        uint32_t f = make_face(mesh, &face);
        if (out)
            out->id = f;
    }
    hewn_free(face.sides);
    return result;
}

/* --- deleting ----------------------------------------------------------------------------------------------------- */

static bool stands_alone(const hewn_mesh *mesh, uint32_t h)
{
    return mesh->face[h ^ 1] == HEWN_NONE;
}

/* Whether the face lies in the middle of the fan at the head of `in`, so that two fans would be left. */
static bool parts_fan(const hewn_mesh *mesh, uint32_t in)
{
    return !stands_alone(mesh, in) && !stands_alone(mesh, mesh->next[in]) && mesh_on_boundary(mesh, mesh->head[in]);
}

/* Moves the half-edges that leave a vertex from `h` counter-clockwise to the boundary onto a new vertex. */
static void split_vert(hewn_mesh *mesh, uint32_t h)
{
    uint32_t v = mesh_tail(mesh, h);
    double position[3];
    memcpy(position, mesh->position + 3 * (size_t)v, sizeof position);
    uint32_t twin = hewn_mesh_new_vert(mesh, position);
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_VERT, twin, v);
    for (mesh->head[h ^ 1] = twin; mesh->face[h] != HEWN_NONE; mesh->head[h ^ 1] = twin)
        h = mesh_ccw(mesh, h);
    mesh->vert_half[twin] = h;
}

/* Links what stays at the corner that `in` reaches. Where an edge goes, its half-edges keep their own links until all
 * corners are done. */
static void unlink_corner(hewn_mesh *mesh, uint32_t in, uint32_t out)
{
    uint32_t v = mesh->head[in];
    bool in_goes = stands_alone(mesh, in), out_goes = stands_alone(mesh, out);
    if (in_goes && out_goes) {
        mesh->vert_half[v] = HEWN_NONE;
    } else if (in_goes) {
        mesh_link(mesh, mesh->prev[in ^ 1], out);
        mesh->vert_half[v] = out;
    } else if (out_goes) {
        mesh_link(mesh, in, mesh->next[out ^ 1]);
    } else if (!mesh_on_boundary(mesh, v)) {
        mesh->vert_half[v] = out;
    } else {
        /* Two fans: that from the old gap to the face, and that from the face to the old gap. */
        uint32_t gone = mesh->vert_half[v], arriving = mesh->prev[gone];
        mesh_link(mesh, arriving, out);
        mesh_link(mesh, in, gone);
        mesh->vert_half[v] = out;
        split_vert(mesh, in ^ 1);
    }
}

/* What becomes of a side whose two corners are done. */
static void finish_side(hewn_mesh *mesh, uint32_t h)
{
    if (stands_alone(mesh, h))
        hewn_mesh_drop_edge(mesh, h);
    else
        mesh->face[h] = HEWN_NONE;
}

/* Takes a face away; room for a vertex at each corner that parts_fan() must have been reserved. */
static void remove_face(hewn_mesh *mesh, uint32_t f)
{
    uint32_t first = mesh->face_half[f], in = first;
    do {
        uint32_t out = mesh->next[in];
        unlink_corner(mesh, in, out);
        if (in != first)
            finish_side(mesh, in);
        in = out;
    } while (in != first);
    finish_side(mesh, first);
    hewn_mesh_drop_face(mesh, f);
}

hewn_result hewn_mesh_delete_face(hewn_mesh *mesh, hewn_face face, hewn_error *error)
{
    if (!mesh_has_face(mesh, face.id))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no face %u to delete", face.id);
    uint32_t first = mesh->face_half[face.id], in = first, splits = 0;
    do {
        splits += parts_fan(mesh, in);
        in = mesh->next[in];
    } while (in != first);
    HEWN_TRY(hewn_mesh_reserve(mesh, splits, 0, 0, error));
    remove_face(mesh, face.id);
    return HEWN_OK;
}

/* No fewer than the vertices that are split while the faces around v go one by one. Among triangles only a neighbour
 * that is on a boundary before can be; two polygons may also meet at a vertex far from v. */
static uint32_t count_splits(const hewn_mesh *mesh, uint32_t v)
{
    uint32_t first = mesh->vert_half[v], h = first, corners = 0, boundary_corners = 0;
    bool triangles = true;
    do {
        if (mesh->face[h] != HEWN_NONE) {
            triangles = triangles && mesh_in_triangle(mesh, h);
            for (uint32_t k = mesh->next[h]; k != h; k = mesh->next[k]) {
                corners++;
                boundary_corners += mesh_on_boundary(mesh, mesh_tail(mesh, k));
            }
        }
        h = mesh_ccw(mesh, h);
    } while (h != first);
    return triangles ? boundary_corners : corners;
}

hewn_result hewn_mesh_delete_vert(hewn_mesh *mesh, hewn_vert vert, hewn_error *error)
{
    uint32_t v = vert.id;
    if (!mesh_has_vert(mesh, v))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no vertex %u to delete", v);
    if (mesh->vert_half[v] != HEWN_NONE)
        HEWN_TRY(hewn_mesh_reserve(mesh, count_splits(mesh, v), 0, 0, error));
    while (mesh->vert_half[v] != HEWN_NONE) {
        /* The first of the fan, so that v itself is never split. */
        uint32_t h = mesh->vert_half[v];
        remove_face(mesh, mesh->face[h] != HEWN_NONE ? mesh->face[h] : mesh->face[mesh_ccw(mesh, h)]);
    }
    hewn_mesh_drop_vert(mesh, v);
    return HEWN_OK;
}
