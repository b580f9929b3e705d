#include "subdivide/level.h"

#include <string.h>

#include "base/alloc.h"
#include "mesh/mesh_data.h"

void hewn_sub_level_free(sub_level *level)
{
    hewn_free(level->first);
    hewn_free(level->corner_face);
    hewn_free(level->corner_verts);
    hewn_free(level->corner_edges);
    hewn_free(level->edge_verts);
    hewn_free(level->edge_corners);
    hewn_free(level->vert_first);
    hewn_free(level->vert_edges);
    hewn_free(level->edge_sharp);
    hewn_free(level->vert_sharp);
    *level = (sub_level){0};
}

static hewn_result allocate(const hewn_mesh *mesh, uint32_t corners, sub_level *out, hewn_error *error)
{
    size_t edges = mesh->live_edges;
    out->verts = mesh->live_verts;
    out->edges = mesh->live_edges;
    out->faces = mesh->live_faces;
    out->corners = corners;
    out->corner_verts = hewn_alloc(corners, sizeof(uint32_t));
    out->corner_edges = hewn_alloc(corners, sizeof(uint32_t));
    out->edge_verts = hewn_alloc(edges, 2 * sizeof(uint32_t));
    out->edge_corners = hewn_alloc(edges, 2 * sizeof(uint32_t));
    out->vert_first = hewn_alloc_zero((size_t)out->verts + 1, sizeof(uint32_t));
    out->vert_edges = hewn_alloc(edges, 2 * sizeof(uint32_t));
    bool mixed = out->sides == 0;
    out->first = mixed ? hewn_alloc((size_t)out->faces + 1, sizeof(uint32_t)) : NULL;
    out->corner_face = mixed ? hewn_alloc(corners, sizeof(uint32_t)) : NULL;
    bool room = out->corner_verts && out->corner_edges && out->edge_verts && out->edge_corners && out->vert_first &&
                out->vert_edges && (!mixed || (out->first && out->corner_face));
    return room ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory subdividing %u faces", out->faces);
}

/* Corners in the order of the polygons; of a half-edge both ends and its corner go to its edge. */
static void fill_faces(const hewn_mesh *mesh, sub_level *out)
{
    uint32_t corner = 0;
    memset(out->edge_corners, 0xFF, 2 * (size_t)out->edges * sizeof(uint32_t));
    for (uint32_t f = 0; f < out->faces; f++) {
        uint32_t first = mesh->face_half[f], h = first;
        if (out->first)
            out->first[f] = corner;
        do {
            uint32_t leaving = mesh->next[h]; /* runs from this corner to the next */
            out->corner_verts[corner] = mesh->head[h];
            out->corner_edges[corner] = leaving / 2;
            out->edge_corners[leaving] = corner;
            out->edge_verts[leaving] = mesh->head[h];
            out->edge_verts[leaving ^ 1u] = mesh->head[leaving];
            if (out->corner_face)
                out->corner_face[corner] = f;
            corner++;
            h = leaving;
        } while (h != first);
    }
    if (out->first)
        out->first[out->faces] = corner;
    for (size_t e = 0; e < out->edges; e++) { /* a boundary edge has its face first */
        uint32_t *corners = out->edge_corners + 2 * e, *verts = out->edge_verts + 2 * e;
        if (corners[0] != HEWN_NONE)
            continue;
        uint32_t other[2] = {corners[1], verts[1]};
        corners[1] = corners[0];
        verts[1] = verts[0];
        corners[0] = other[0];
        verts[0] = other[1];
    }
}

/* Rings run counter-clockwise from the half-edge of a vertex; a boundary one is the last of its fan. */
static void fill_rings(const hewn_mesh *mesh, sub_level *out)
{
    uint32_t at = 0;
    for (uint32_t v = 0; v < out->verts; v++) {
        uint32_t start = mesh->vert_half[v];
        out->vert_first[v] = at;
        if (start == HEWN_NONE)
            continue;
        bool fan = mesh->face[start] == HEWN_NONE;
        uint32_t first = fan ? mesh_ccw(mesh, start) : start, h = first;
        do {
            out->vert_edges[at++] = h / 2;
            h = mesh_ccw(mesh, h);
        } while (h != first);
    }
    out->vert_first[out->verts] = at;
}

static hewn_result from_mesh(const hewn_mesh *mesh, sub_level *out, hewn_error *error)
{
    uint32_t corners = 0, least = UINT32_MAX, most = 0;
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        uint32_t degree = hewn_face_degree(mesh, (hewn_face){f});
        least = degree < least ? degree : least;
        most = degree > most ? degree : most;
        corners += degree;
    }
    out->sides = least == most && (most == 3 || most == 4) ? most : 0;
    HEWN_TRY(allocate(mesh, corners, out, error));
    fill_faces(mesh, out);
    fill_rings(mesh, out);
    for (uint32_t e = 0; e < out->edges; e++)
        if (sub_is_boundary(out, e))
            return hewn_sub_level_sharpen(out, error);
    return HEWN_OK;
}

hewn_result hewn_sub_level_create(const hewn_polygons *polygons, sub_level *out, hewn_error *error)
{
    *out = (sub_level){0};
    hewn_mesh *mesh;
    HEWN_TRY(hewn_mesh_from_polygons(polygons, &mesh, error));
    hewn_result result = from_mesh(mesh, out, error);
    hewn_mesh_destroy(&mesh);
    if (result != HEWN_OK)
        hewn_sub_level_free(out);
    return result;
}

hewn_result hewn_sub_level_sharpen(sub_level *level, hewn_error *error)
{
    if (level->edge_sharp)
        return HEWN_OK;
    level->edge_sharp = hewn_alloc_zero(level->edges, sizeof(float));
    level->vert_sharp = hewn_alloc_zero(level->verts, sizeof(float));
    if (!level->edge_sharp || !level->vert_sharp)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory subdividing %u faces", level->faces);
    for (uint32_t e = 0; e < level->edges; e++)
        if (sub_is_boundary(level, e))
            level->edge_sharp[e] = SHARP_FOREVER;
    return HEWN_OK;
}
