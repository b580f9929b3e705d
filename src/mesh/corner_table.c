#include "hewn/mesh_views.h"

#include "base/alloc.h"
#include "mesh/mesh_data.h"

void hewn_corner_table_destroy(hewn_corner_table *table)
{
    hewn_free(table->vertices);
    hewn_free(table->opposites);
    *table = (hewn_corner_table){0};
}

static hewn_result check_triangles(const hewn_mesh *mesh, hewn_error *error)
{
    if (mesh->live_verts != mesh->vert_bound || mesh->live_faces != mesh->face_bound)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a corner table needs a mesh without holes: compact it first");
    for (uint32_t f = 0; f < mesh->face_bound; f++)
        if (!mesh_in_triangle(mesh, mesh->face_half[f]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "face %u is not a triangle", f);
    if (mesh->face_bound > MESH_MOST_IDS / 3)
        return hewn_fail(error, HEWN_LIMIT, "%u triangles have too many corners for a table", mesh->face_bound);
    return HEWN_OK;
}

/* The corner that the side of half-edge h faces, counted in its triangle from the first. */
static uint32_t facing_corner(const hewn_mesh *mesh, uint32_t h)
{
    uint32_t f = mesh->face[h], apex = mesh->next[h], first = mesh->face_half[f];
    return 3 * f + (apex == first ? 0 : apex == mesh->next[first] ? 1 : 2);
}

/* Corner i ends half-edge i of its triangle; the side that faces it is the half-edge before that. */
static uint32_t opposite_of(const hewn_mesh *mesh, uint32_t at_corner)
{
    uint32_t across = mesh->prev[at_corner] ^ 1;
    return mesh->face[across] == HEWN_NONE ? HEWN_NONE : facing_corner(mesh, across);
}

hewn_result hewn_corner_table_from_mesh(const hewn_mesh *mesh, hewn_corner_table *out, hewn_error *error)
{
    *out = (hewn_corner_table){0};
    HEWN_TRY(check_triangles(mesh, error));
    hewn_corner_table table = {.vertex_count = mesh->vert_bound, .triangle_count = mesh->face_bound};
    table.vertices = hewn_alloc(mesh->face_bound, 3 * sizeof *table.vertices);
    table.opposites = hewn_alloc(mesh->face_bound, 3 * sizeof *table.opposites);
    if (!table.vertices || !table.opposites) {
        hewn_corner_table_destroy(&table);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a corner table of %u triangles",
                         mesh->face_bound);
    }
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        uint32_t h = mesh->face_half[f];
        for (uint32_t i = 3 * f; i < 3 * f + 3; i++, h = mesh->next[h]) {
            table.vertices[i] = mesh->head[h];
            table.opposites[i] = opposite_of(mesh, h);
        }
    }
    *out = table;
    return HEWN_OK;
}

static hewn_result check_opposites(const hewn_mesh *mesh, const hewn_corner_table *table, hewn_error *error)
{
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        uint32_t h = mesh->face_half[f];
        for (uint32_t i = 3 * f; i < 3 * f + 3; i++, h = mesh->next[h])
            if (table->opposites[i] != opposite_of(mesh, h))
                return hewn_fail(error, HEWN_BAD_INPUT, "the opposite of corner %u is not what the vertices say", i);
    }
    return HEWN_OK;
}

hewn_result hewn_corner_table_to_mesh(const hewn_corner_table *table, const double *positions, hewn_mesh **out,
                                      hewn_error *error)
{
    const hewn_polygons polygons = {.vertex_count = table->vertex_count,
                                    .positions = positions,
                                    .face_count = table->triangle_count,
                                    .corners = table->vertices};
    HEWN_TRY(hewn_mesh_from_polygons(&polygons, out, error));
    hewn_result result = check_opposites(*out, table, error);
    if (result != HEWN_OK)
        hewn_mesh_destroy(out);
    return result;
}
