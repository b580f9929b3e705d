#include "mesh/mesh_data.h"

#include <math.h>

#include "base/alloc.h"

/* Half-edges on their own: live neighbours that agree about them. */
static hewn_result check_half(const hewn_mesh *mesh, uint32_t h, hewn_error *error)
{
    uint32_t next = mesh->next[h], prev = mesh->prev[h], face = mesh->face[h];
    if (!mesh_has_half(mesh, h ^ 1))
        return hewn_fail(error, HEWN_INTERNAL, "half-edge %u has no twin", h);
    if (!mesh_has_vert(mesh, mesh->head[h]))
        return hewn_fail(error, HEWN_INTERNAL, "half-edge %u ends at vertex %u, which is not there", h, mesh->head[h]);
    if (mesh->head[h] == mesh->head[h ^ 1])
        return hewn_fail(error, HEWN_INTERNAL, "half-edge %u begins and ends at vertex %u", h, mesh->head[h]);
    if (!mesh_has_half(mesh, next) || !mesh_has_half(mesh, prev))
        return hewn_fail(error, HEWN_INTERNAL, "half-edge %u has no neighbour in its loop", h);
    if (mesh->prev[next] != h || mesh->next[prev] != h)
        return hewn_fail(error, HEWN_INTERNAL, "half-edge %u and its neighbours in the loop disagree", h);
    if (mesh->head[h] != mesh->head[next ^ 1])
        return hewn_fail(error, HEWN_INTERNAL, "half-edge %u does not end where its next one begins", h);
    if (face != mesh->face[next])
        return hewn_fail(error, HEWN_INTERNAL, "half-edge %u and its next one have different faces", h);
    if (face != HEWN_NONE && !mesh_has_face(mesh, face))
        return hewn_fail(error, HEWN_INTERNAL, "half-edge %u has face %u, which is not there", h, face);
    if (face == mesh->face[h ^ 1])
        return hewn_fail(error, HEWN_INTERNAL, "half-edge %u and its twin have the same face or none", h);
    return HEWN_OK;
}

static hewn_result check_halves(const hewn_mesh *mesh, uint64_t *face_halves, hewn_error *error)
{
    uint64_t live = 0;
    *face_halves = 0;
    if (mesh->half_bound % 2 != 0)
        return hewn_fail(error, HEWN_INTERNAL, "an odd number of half-edges");
    for (uint32_t h = 0; h < mesh->half_bound; h++) {
        if (!mesh_has_half(mesh, h))
            continue;
        live++;
        *face_halves += mesh->face[h] != HEWN_NONE;
        HEWN_TRY(check_half(mesh, h, error));
    }
    if (live != 2 * (uint64_t)mesh->live_edges)
        return hewn_fail(error, HEWN_INTERNAL, "%llu live half-edges, but %u edges are counted",
                         (unsigned long long)live, mesh->live_edges);
    return HEWN_OK;
}

/* Loops close, for next and prev are each other's inverse by now. `marks` (one a vertex) holds the last face that came
 * by, plus 1. */
static hewn_result check_faces(const hewn_mesh *mesh, uint64_t face_halves, uint32_t *marks, hewn_error *error)
{
    uint64_t reached = 0;
    uint32_t live = 0;
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        if (!mesh_has_face(mesh, f))
            continue;
        uint32_t first = mesh->face_half[f], h = first, degree = 0;
        live++;
        if (!mesh_has_half(mesh, first) || mesh->face[first] != f)
            return hewn_fail(error, HEWN_INTERNAL, "the half-edge of face %u is not one of its own", f);
        do {
            if (marks[mesh->head[h]] == f + 1)
                return hewn_fail(error, HEWN_INTERNAL, "face %u has the vertex %u twice", f, mesh->head[h]);
            marks[mesh->head[h]] = f + 1;
            degree++;
            h = mesh->next[h];
        } while (h != first);
        if (degree < 3)
            return hewn_fail(error, HEWN_INTERNAL, "face %u has %u corners", f, degree);
        reached += degree;
    }
    if (live != mesh->live_faces)
        return hewn_fail(error, HEWN_INTERNAL, "%u live faces, but %u are counted", live, mesh->live_faces);
    if (reached != face_halves)
        return hewn_fail(error, HEWN_INTERNAL, "%llu half-edges have a face that does not reach them",
                         (unsigned long long)(face_halves - reached));
    return HEWN_OK;
}

/* The ring of one vertex. `marks` (one a vertex) holds the last vertex that had it as a neighbour, plus 1. */
static hewn_result check_ring(const hewn_mesh *mesh, uint32_t v, uint32_t *marks, uint64_t *reached, hewn_error *error)
{
    uint32_t first = mesh->vert_half[v], h = first;
    if (!mesh_has_half(mesh, first) || mesh_tail(mesh, first) != v)
        return hewn_fail(error, HEWN_INTERNAL, "the half-edge of vertex %u does not leave it", v);
    do {
        if (h != first && mesh->face[h] == HEWN_NONE)
            return hewn_fail(error, HEWN_INTERNAL,
                             "vertex %u has the boundary half-edge %u, which is not its own or one of two", v, h);
        if (marks[mesh->head[h]] == v + 1)
            return hewn_fail(error, HEWN_INTERNAL, "two edges join the vertices %u and %u", v, mesh->head[h]);
        marks[mesh->head[h]] = v + 1;
        (*reached)++;
        h = mesh_ccw(mesh, h);
    } while (h != first);
    return HEWN_OK;
}

static hewn_result check_verts(const hewn_mesh *mesh, uint32_t *marks, hewn_error *error)
{
    uint64_t reached = 0;
    uint32_t live = 0;
    for (uint32_t v = 0; v < mesh->vert_bound; v++)
        marks[v] = 0;
    for (uint32_t v = 0; v < mesh->vert_bound; v++) {
        if (!mesh_has_vert(mesh, v))
            continue;
        live++;
        const double *position = mesh->position + 3 * (size_t)v;
        if (!isfinite(position[0]) || !isfinite(position[1]) || !isfinite(position[2]))
            return hewn_fail(error, HEWN_INTERNAL, "the position of vertex %u is not finite", v);
        if (mesh->vert_half[v] != HEWN_NONE)
            HEWN_TRY(check_ring(mesh, v, marks, &reached, error));
    }
    if (live != mesh->live_verts)
        return hewn_fail(error, HEWN_INTERNAL, "%u live vertices, but %u are counted", live, mesh->live_verts);
    if (reached == 2 * (uint64_t)mesh->live_edges)
        return HEWN_OK;
    /* Some half-edge leaves a vertex whose ring does not have it. */
    for (uint32_t h = 0; h < mesh->half_bound; h++) {
        if (!mesh_has_half(mesh, h))
            continue;
        uint32_t v = mesh_tail(mesh, h), first = mesh->vert_half[v], k = first;
        while (k != HEWN_NONE && k != h && (k = mesh_ccw(mesh, k)) != first)
            ;
        if (k != h)
            return hewn_fail(error, HEWN_INTERNAL, "the half-edges around vertex %u form more than one ring", v);
    }
    return hewn_fail(error, HEWN_INTERNAL, "the rings around the vertices do not have all half-edges");
}

hewn_result hewn_mesh_validate(const hewn_mesh *mesh, hewn_error *error)
{
    uint64_t face_halves;
    HEWN_TRY(check_halves(mesh, &face_halves, error));
    uint32_t *marks = hewn_alloc_zero(mesh->vert_bound, sizeof *marks);
    if (!marks)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory validating a mesh");
    hewn_result result = check_faces(mesh, face_halves, marks, error);
    if (result == HEWN_OK)
        result = check_verts(mesh, marks, error);
    hewn_free(marks);
    return result;
}
