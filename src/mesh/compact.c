#include "mesh/mesh_data.h"

#include <string.h>

#include "base/alloc.h"

/* New ids of all elements, HEWN_NONE for the deleted; edges are counted by pairs of half-edges. */
typedef struct renumbering {
    uint32_t *verts, *edges, *faces;
} renumbering;

static void free_renumbering(renumbering *map)
{
    hewn_free(map->verts);
    hewn_free(map->edges);
    hewn_free(map->faces);
}

static hewn_result renumber(const hewn_mesh *mesh, renumbering *map, hewn_error *error)
{
    map->verts = hewn_alloc(mesh->vert_bound, sizeof *map->verts);
    map->edges = hewn_alloc(mesh->half_bound / 2, sizeof *map->edges);
    map->faces = hewn_alloc(mesh->face_bound, sizeof *map->faces);
    if (!map->verts || !map->edges || !map->faces) {
        free_renumbering(map);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory compacting a mesh");
    }
    uint32_t count = 0;
    for (uint32_t v = 0; v < mesh->vert_bound; v++)
        map->verts[v] = mesh_has_vert(mesh, v) ? count++ : HEWN_NONE;
    count = 0;
    for (uint32_t e = 0; e < mesh->half_bound / 2; e++)
        map->edges[e] = mesh_has_half(mesh, 2 * e) ? count++ : HEWN_NONE;
    count = 0;
    for (uint32_t f = 0; f < mesh->face_bound; f++)
        map->faces[f] = mesh_has_face(mesh, f) ? count++ : HEWN_NONE;
    return HEWN_OK;
}

static uint32_t new_half(const renumbering *map, uint32_t h)
{
    return h == HEWN_NONE ? HEWN_NONE : 2 * map->edges[h / 2] + (h & 1);
}

/* Elements only move down, so each can be written before those behind it are read. */
static void move_verts(hewn_mesh *mesh, const renumbering *map)
{
    for (uint32_t v = 0; v < mesh->vert_bound; v++) {
        uint32_t to = map->verts[v];
        if (to == HEWN_NONE)
            continue;
        mesh->vert_half[to] = new_half(map, mesh->vert_half[v]);
        memmove(mesh->position + 3 * (size_t)to, mesh->position + 3 * (size_t)v, 3 * sizeof *mesh->position);
        if (to != v)
            hewn_mesh_copy_values(mesh, HEWN_DOMAIN_VERT, to, v);
    }
    mesh->vert_bound = mesh->live_verts;
}

static void move_halves(hewn_mesh *mesh, const renumbering *map)
{
    for (uint32_t h = 0; h < mesh->half_bound; h++) {
        if (map->edges[h / 2] == HEWN_NONE)
            continue;
        uint32_t to = new_half(map, h);
        mesh->head[to] = map->verts[mesh->head[h]];
        mesh->next[to] = new_half(map, mesh->next[h]);
        mesh->prev[to] = new_half(map, mesh->prev[h]);
        mesh->face[to] = mesh->face[h] == HEWN_NONE ? HEWN_NONE : map->faces[mesh->face[h]];
        if (to != h)
            hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, to, h);
    }
    mesh->half_bound = 2 * mesh->live_edges;
}

static void move_faces(hewn_mesh *mesh, const renumbering *map)
{
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        uint32_t to = map->faces[f];
        if (to == HEWN_NONE)
            continue;
        mesh->face_half[to] = new_half(map, mesh->face_half[f]);
        if (to != f)
            hewn_mesh_copy_values(mesh, HEWN_DOMAIN_FACE, to, f);
    }
    mesh->face_bound = mesh->live_faces;
}

/* A block that cannot shrink stays as it is; that is no failure. */
static void shrink(void **block, size_t count, size_t size)
{
    void *moved = hewn_realloc(*block, count, size);
    if (moved)
        *block = moved;
}

static void give_back(hewn_mesh *mesh)
{
    uint32_t **halves[] = {&mesh->head, &mesh->next, &mesh->prev, &mesh->face};
    for (size_t i = 0; i < sizeof halves / sizeof *halves; i++)
        shrink((void **)halves[i], mesh->half_bound, sizeof(uint32_t));
    shrink((void **)&mesh->vert_half, mesh->vert_bound, sizeof *mesh->vert_half);
    shrink((void **)&mesh->position, mesh->vert_bound, 3 * sizeof *mesh->position);
    shrink((void **)&mesh->face_half, mesh->face_bound, sizeof *mesh->face_half);
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        mesh_attribute *attribute = &mesh->attributes[i];
        shrink((void **)&attribute->data, mesh_domain_bound(mesh, attribute->info.domain), attribute->stride);
    }
    mesh->half_capacity = mesh->half_bound;
    mesh->vert_capacity = mesh->vert_bound;
    mesh->face_capacity = mesh->face_bound;
}

hewn_result hewn_mesh_compact(hewn_mesh *mesh, hewn_error *error)
{
    bool whole = mesh->live_verts == mesh->vert_bound && mesh->live_faces == mesh->face_bound &&
                 2 * (uint64_t)mesh->live_edges == mesh->half_bound;
    if (!whole) {
        renumbering map;
        HEWN_TRY(renumber(mesh, &map, error));
        move_verts(mesh, &map);
        move_halves(mesh, &map);
        move_faces(mesh, &map);
        free_renumbering(&map);
    }
    give_back(mesh);
    return HEWN_OK;
}
