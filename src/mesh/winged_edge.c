#include "hewn/mesh_views.h"

#include <string.h>

#include "base/alloc.h"
#include "mesh/mesh_data.h"

void hewn_winged_edges_destroy(hewn_winged_edges *edges)
{
    hewn_free(edges->edges);
    hewn_free(edges->vertex_edges);
    hewn_free(edges->face_edges);
    *edges = (hewn_winged_edges){0};
}

/* --- from a mesh -------------------------------------------------------------------------------------------------- */

static hewn_winged_edge record(const hewn_mesh *mesh, uint32_t h)
{
    uint32_t g = h + 1;
    return (hewn_winged_edge){.start = mesh->head[g],
                              .end = mesh->head[h],
                              .left = mesh->face[h],
                              .right = mesh->face[g],
                              .left_prev = mesh->prev[h] / 2,
                              .left_next = mesh->next[h] / 2,
                              .right_prev = mesh->prev[g] / 2,
                              .right_next = mesh->next[g] / 2};
}

hewn_result hewn_winged_edges_from_mesh(const hewn_mesh *mesh, hewn_winged_edges *out, hewn_error *error)
{
    *out = (hewn_winged_edges){0};
    if (mesh->live_verts != mesh->vert_bound || mesh->live_faces != mesh->face_bound ||
        mesh->live_edges != mesh->half_bound / 2)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "winged edges need a mesh without holes: compact it first");
    hewn_winged_edges all = {mesh->live_verts, mesh->live_edges, mesh->live_faces, NULL, NULL, NULL};
    all.edges = hewn_alloc(all.edge_count, sizeof *all.edges);
    all.vertex_edges = hewn_alloc(all.vertex_count, sizeof *all.vertex_edges);
    all.face_edges = hewn_alloc(all.face_count, sizeof *all.face_edges);
    if (!all.edges || !all.vertex_edges || !all.face_edges) {
        hewn_winged_edges_destroy(&all);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u winged edges", mesh->live_edges);
    }
    for (uint32_t e = 0; e < all.edge_count; e++)
        all.edges[e] = record(mesh, 2 * e);
    for (uint32_t v = 0; v < all.vertex_count; v++)
        all.vertex_edges[v] = mesh->vert_half[v] == HEWN_NONE ? HEWN_NONE : mesh->vert_half[v] / 2;
    for (uint32_t f = 0; f < all.face_count; f++)
        all.face_edges[f] = mesh->face_half[f] / 2;
    *out = all;
    return HEWN_OK;
}

/* --- to a mesh ---------------------------------------------------------------------------------------------------- */

static hewn_result check_record(const hewn_winged_edges *all, uint32_t e, hewn_error *error)
{
    const hewn_winged_edge *edge = &all->edges[e];
    bool verts = edge->start < all->vertex_count && edge->end < all->vertex_count && edge->start != edge->end;
    bool faces = (edge->left < all->face_count || edge->left == HEWN_NONE) &&
                 (edge->right < all->face_count || edge->right == HEWN_NONE);
    bool wings = edge->left_prev < all->edge_count && edge->left_next < all->edge_count &&
                 edge->right_prev < all->edge_count && edge->right_next < all->edge_count;
    if (!verts || !faces || !wings)
        return hewn_fail(error, HEWN_BAD_INPUT, "the winged edge %u names a vertex, face or edge that is not there", e);
    return HEWN_OK;
}

/* The half-edge of an edge that leaves or reaches a vertex; HEWN_NONE where the edge does not touch it. */
static uint32_t leaving(const hewn_winged_edges *all, uint32_t e, uint32_t v)
{
    return all->edges[e].start == v ? 2 * e : all->edges[e].end == v ? 2 * e + 1 : HEWN_NONE;
}

static uint32_t reaching(const hewn_winged_edges *all, uint32_t e, uint32_t v)
{
    uint32_t h = leaving(all, e, v);
    return h == HEWN_NONE ? HEWN_NONE : h ^ 1;
}

static hewn_result fill_edges(const hewn_winged_edges *all, hewn_mesh *mesh, hewn_error *error)
{
    for (uint32_t e = 0; e < all->edge_count; e++)
        HEWN_TRY(check_record(all, e, error));
    for (uint32_t e = 0; e < all->edge_count; e++) {
        const hewn_winged_edge *edge = &all->edges[e];
        uint32_t h = hewn_mesh_new_edge(mesh, edge->start, edge->end), g = h + 1;
        mesh->face[h] = edge->left;
        mesh->face[g] = edge->right;
        mesh->next[h] = leaving(all, edge->left_next, edge->end);
        mesh->prev[h] = reaching(all, edge->left_prev, edge->start);
        mesh->next[g] = leaving(all, edge->right_next, edge->start);
        mesh->prev[g] = reaching(all, edge->right_prev, edge->end);
    }
    return HEWN_OK;
}

static hewn_result fill_ends(const hewn_winged_edges *all, hewn_mesh *mesh, hewn_error *error)
{
    for (uint32_t v = 0; v < all->vertex_count; v++) {
        uint32_t e = all->vertex_edges[v];
        if (e == HEWN_NONE)
            continue;
        uint32_t h = e < all->edge_count ? leaving(all, e, v) : HEWN_NONE;
        if (h == HEWN_NONE)
            return hewn_fail(error, HEWN_BAD_INPUT, "the edge of vertex %u does not touch it", v);
        mesh->vert_half[v] = h;
    }
    for (uint32_t f = 0; f < all->face_count; f++) {
        uint32_t e = all->face_edges[f];
        bool left = e < all->edge_count && all->edges[e].left == f;
        if (!left && !(e < all->edge_count && all->edges[e].right == f))
            return hewn_fail(error, HEWN_BAD_INPUT, "the edge of face %u is not one of its own", f);
        hewn_mesh_new_face(mesh, left ? 2 * e : 2 * e + 1);
    }
    return HEWN_OK;
}

static hewn_result fill(const hewn_winged_edges *all, const double *positions, hewn_mesh *mesh, hewn_error *error)
{
    if (all->edge_count > MESH_MOST_IDS / 2)
        return hewn_fail(error, HEWN_LIMIT, "%u winged edges are more than there are ids", all->edge_count);
    HEWN_TRY(hewn_mesh_reserve(mesh, all->vertex_count, all->edge_count, all->face_count, error));
    for (uint32_t v = 0; v < all->vertex_count; v++)
        hewn_mesh_new_vert(mesh, positions + 3 * (size_t)v);
    HEWN_TRY(fill_edges(all, mesh, error));
    HEWN_TRY(fill_ends(all, mesh, error));
    hewn_result result = hewn_mesh_validate(mesh, error);
    if (result != HEWN_INTERNAL)
        return result;
    if (error)
        error->code = HEWN_BAD_INPUT;
    return HEWN_BAD_INPUT;
}

hewn_result hewn_winged_edges_to_mesh(const hewn_winged_edges *edges, const double *positions, hewn_mesh **out,
                                      hewn_error *error)
{
    *out = NULL;
    if (edges->vertex_count > 0 && !positions)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "winged edges without positions");
    HEWN_TRY(hewn_mesh_create(out, error));
    hewn_result result = fill(edges, positions, *out, error);
    if (result != HEWN_OK)
        hewn_mesh_destroy(out);
    return result;
}
