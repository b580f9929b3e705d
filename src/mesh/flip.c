#include "mesh/mesh_data.h"

bool hewn_mesh_can_flip(const hewn_mesh *mesh, hewn_half half)
{
    uint32_t h = half.id, g = h ^ 1;
    if (!mesh_has_half(mesh, h) || mesh->face[h] == HEWN_NONE || mesh->face[g] == HEWN_NONE ||
        !mesh_in_triangle(mesh, h) || !mesh_in_triangle(mesh, g))
        return false;
    uint32_t left = mesh->head[mesh->next[h]], right = mesh->head[mesh->next[g]];
    return left != right && hewn_mesh_find(mesh, left, right) == HEWN_NONE;
}

static void close_triangle(hewn_mesh *mesh, uint32_t face, uint32_t a, uint32_t b, uint32_t c)
{
    mesh_link(mesh, a, b);
    mesh_link(mesh, b, c);
    mesh_link(mesh, c, a);
    mesh->face[a] = mesh->face[b] = mesh->face[c] = face;
    mesh->face_half[face] = a;
}

/* With h from a to b, c at its left and d at its right: abc and bad become cad and dbc. */
void hewn_mesh_flip_unchecked(hewn_mesh *mesh, uint32_t h)
{
    uint32_t g = h ^ 1, left = mesh->face[h], right = mesh->face[g];
    uint32_t bc = mesh->next[h], ca = mesh->prev[h], ad = mesh->next[g], db = mesh->prev[g];
    uint32_t a = mesh->head[ca], b = mesh->head[db], c = mesh->head[bc], d = mesh->head[ad];
    if (mesh->vert_half[a] == h)
        mesh->vert_half[a] = ad;
    if (mesh->vert_half[b] == g)
        mesh->vert_half[b] = bc;
    mesh->head[h] = c;
    mesh->head[g] = d;
    /* Each new corner takes the values that the other face had at that vertex. */
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, h, bc);
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, g, ad);
    close_triangle(mesh, left, h, ca, ad);
    close_triangle(mesh, right, g, db, bc);
}

void hewn_mesh_flip(hewn_mesh *mesh, hewn_half half)
{
    if (hewn_mesh_can_flip(mesh, half))
        hewn_mesh_flip_unchecked(mesh, half.id);
}
