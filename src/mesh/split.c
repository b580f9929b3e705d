#include "mesh/mesh_data.h"

#include <math.h>

/* The corner of one face at a new vertex, `in`, from those before and after it along the edge. */
static void blend_corner(hewn_mesh *mesh, uint32_t in, uint32_t before, double weight_before, uint32_t after,
                         double weight_after)
{
    if (mesh->face[in] == HEWN_NONE)
        return;
    const uint32_t from[2] = {before, after};
    const double weights[2] = {weight_before, weight_after};
    hewn_mesh_blend_values(mesh, HEWN_DOMAIN_CORNER, in, from, weights, 2);
}

/* Puts `v` into the edge of h: h and its twin end at v, the new edge runs from v to the old head. Its half-edge is
 * returned. */
static uint32_t cut_edge(hewn_mesh *mesh, uint32_t h, uint32_t v, double t)
{
    uint32_t g = h ^ 1, head = mesh->head[h];
    uint32_t k = hewn_mesh_new_edge(mesh, v, head), l = k ^ 1;
    mesh->face[k] = mesh->face[h];
    mesh->face[l] = mesh->face[g];
    mesh_link(mesh, k, mesh->next[h]);
    mesh_link(mesh, h, k);
    mesh_link(mesh, mesh->prev[g], l);
    mesh_link(mesh, l, g);
    mesh->head[h] = v;
    if (mesh->face[h] != HEWN_NONE && mesh->face_half[mesh->face[h]] == h)
        mesh->face_half[mesh->face[h]] = k;
    if (mesh->vert_half[head] == g)
        mesh->vert_half[head] = l;
    /* A boundary half-edge is the vertex's own: k where h has no face, g where that has none. */
    mesh->vert_half[v] = mesh->face[k] == HEWN_NONE ? k : g;
    /* The head's corner left of h moves on to k, the tail's corner right of it stays at g. */
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, k, h);
    blend_corner(mesh, h, mesh->prev[h], 1 - t, k, t);
    blend_corner(mesh, l, mesh->prev[l], t, g, 1 - t);
    const uint32_t ends[2] = {mesh->head[g], head};
    const double weights[2] = {1 - t, t};
    hewn_mesh_blend_values(mesh, HEWN_DOMAIN_VERT, v, ends, weights, 2);
    return k;
}

/* Joins the head of h, a corner of a quadrilateral, to the corner opposite: the face keeps h. */
static void halve_face(hewn_mesh *mesh, uint32_t h)
{
    uint32_t f = mesh->face[h], out = mesh->next[h], far = mesh->next[out], last = mesh->next[far];
    uint32_t v = mesh->head[h], apex = mesh->head[far];
    uint32_t d = hewn_mesh_new_edge(mesh, v, apex), e = d ^ 1, g = hewn_mesh_new_face(mesh, e);
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_FACE, g, f);
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, d, far);
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, e, h);
    mesh_link(mesh, h, d);
    mesh_link(mesh, d, last);
    mesh_link(mesh, far, e);
    mesh_link(mesh, e, out);
    mesh->face[d] = f;
    mesh->face[e] = mesh->face[out] = mesh->face[far] = g;
    if (mesh->face_half[f] == out || mesh->face_half[f] == far)
        mesh->face_half[f] = d;
}

hewn_result hewn_mesh_split(hewn_mesh *mesh, hewn_half half, double t, hewn_vert *out, hewn_error *error)
{
    uint32_t h = half.id;
    if (out)
        *out = HEWN_VERT_NONE;
    if (!mesh_has_half(mesh, h))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no half-edge %u to split", h);
    if (!(t >= 0 && t <= 1))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an edge is split from 0 to 1 of its length, not at %g", t);
    HEWN_TRY(hewn_mesh_reserve(mesh, 1, 3, 2, error));
    bool left = mesh->face[h] != HEWN_NONE && mesh_in_triangle(mesh, h);
    bool right = mesh->face[h ^ 1] != HEWN_NONE && mesh_in_triangle(mesh, h ^ 1);
    /* Back to back triangles: the second cut would double the edge of the first. */
    if (left && right && mesh->head[mesh->next[h]] == mesh->head[mesh->next[h ^ 1]])
        right = false;
    const double *a = mesh->position + 3 * (size_t)mesh_tail(mesh, h);
    const double *b = mesh->position + 3 * (size_t)mesh->head[h];
    double position[3];
    for (int i = 0; i < 3; i++)
        position[i] = (1 - t) * a[i] + t * b[i];
    uint32_t v = hewn_mesh_new_vert(mesh, position);
    uint32_t k = cut_edge(mesh, h, v, t);
    if (left)
        halve_face(mesh, h);
    if (right)
        halve_face(mesh, k ^ 1);
    if (out)
        out->id = v;
    return HEWN_OK;
}
