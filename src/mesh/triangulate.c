#include "mesh/mesh_data.h"

#include "base/alloc.h"
#include "mesh/ears.h"
#include "mesh/plane.h"

/* --- planning ----------------------------------------------------------------------------------------------------- */

typedef struct face_plan {
    const hewn_mesh *mesh;
    uint32_t face, count;
    uint32_t *halves;      /* of each corner the half-edge that ends there, in what is left of the face */
    uint32_t *next, *prev; /* the corners that are left */
    const double **corners;
    double *plane;
    uint32_t *order; /* of the ears */
} face_plan;

static bool may_join(const void *user, uint32_t a, uint32_t b)
{
    const face_plan *plan = user;
    const hewn_mesh *mesh = plan->mesh;
    return hewn_mesh_find(mesh, mesh->head[plan->halves[a]], mesh->head[plan->halves[b]]) == HEWN_NONE;
}

static void free_plan(face_plan *plan)
{
    hewn_free(plan->halves);
    hewn_free(plan->next);
    hewn_free(plan->prev);
    hewn_free(plan->corners);
    hewn_free(plan->plane);
    hewn_free(plan->order);
}

static hewn_result lay_out(const hewn_mesh *mesh, uint32_t f, face_plan *out, hewn_error *error)
{
    *out = (face_plan){.mesh = mesh, .face = f, .count = hewn_face_degree(mesh, (hewn_face){f})};
    out->halves = hewn_alloc(out->count, sizeof *out->halves);
    out->next = hewn_alloc(out->count, sizeof *out->next);
    out->prev = hewn_alloc(out->count, sizeof *out->prev);
    out->corners = hewn_alloc(out->count, sizeof *out->corners);
    out->plane = hewn_alloc(out->count, 2 * sizeof *out->plane);
    out->order = hewn_alloc(out->count, sizeof *out->order);
    if (!out->halves || !out->next || !out->prev || !out->corners || !out->plane || !out->order)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a face of %u corners", out->count);
    uint32_t h = mesh->face_half[f];
    for (uint32_t i = 0; i < out->count; i++, h = mesh->next[h]) {
        out->halves[i] = h;
        out->next[i] = i + 1 < out->count ? i + 1 : 0;
        out->prev[i] = i > 0 ? i - 1 : out->count - 1;
        out->corners[i] = mesh->position + 3 * (size_t)mesh->head[h];
    }
    hewn_plane_project(out->corners, out->count, out->count, out->plane);
    return HEWN_OK;
}

/* --- cutting ------------------------------------------------------------------------------------------------------ */

/* Cuts off the corner at the head of `in`, in what is left of a face; returns the face that is left. The triangle gets
 * a new face unless it has the first corner's half-edge of `f`, which stays with f: so the cuts of f can be undone. */
static uint32_t cut_ear(hewn_mesh *mesh, uint32_t f, uint32_t rest, uint32_t in)
{
    uint32_t out = mesh->next[in], before = mesh->prev[in], after = mesh->next[out], first = mesh->face_half[f];
    uint32_t d = hewn_mesh_new_edge(mesh, mesh->head[out], mesh->head[before]), e = d ^ 1;
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, d, before);
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, e, out);
    mesh_link(mesh, out, d);
    mesh_link(mesh, d, in);
    mesh_link(mesh, before, e);
    mesh_link(mesh, e, after);
    uint32_t ear = hewn_mesh_new_face(mesh, in);
    hewn_mesh_copy_values(mesh, HEWN_DOMAIN_FACE, ear, f);
    if (rest == f && (in == first || out == first)) {
        mesh->face_half[ear] = e;
        rest = ear;
        ear = f;
        for (uint32_t h = mesh->next[e]; h != e; h = mesh->next[h])
            mesh->face[h] = rest;
    }
    mesh->face[in] = mesh->face[out] = mesh->face[d] = ear;
    mesh->face[e] = rest;
    if (rest != f)
        mesh->face_half[rest] = e;
    return rest;
}

/* Makes the cuts that were planned. A corner beside an ear ends another half-edge afterwards. */
static void cut_ears(hewn_mesh *mesh, face_plan *plan)
{
    uint32_t rest = plan->face;
    for (uint32_t i = 0; i + 3 < plan->count; i++) {
        uint32_t ear = plan->order[i], before = plan->prev[ear], after = plan->next[ear];
        rest = cut_ear(mesh, plan->face, rest, plan->halves[ear]);
        plan->halves[after] = mesh->half_bound - 1;
        plan->next[before] = after;
        plan->prev[after] = before;
    }
}

static hewn_result cut_face(hewn_mesh *mesh, uint32_t f, hewn_error *error)
{
    face_plan plan;
    bool found = false;
    hewn_result result = lay_out(mesh, f, &plan, error);
    if (result == HEWN_OK)
        result = hewn_ears_cut(plan.plane, plan.count, may_join, &plan, plan.order, &found, error);
    if (result == HEWN_OK && !found)
        result = hewn_fail(error, HEWN_INVALID_ARGUMENT,
                           "face %u cannot be cut into triangles without an edge that exists already", f);
    if (result == HEWN_OK)
        result = hewn_mesh_reserve(mesh, 0, plan.count - 3, plan.count - 3, error);
    if (result == HEWN_OK)
        cut_ears(mesh, &plan);
    free_plan(&plan);
    return result;
}

hewn_result hewn_mesh_triangulate_face(hewn_mesh *mesh, hewn_face face, hewn_error *error)
{
    if (!mesh_has_face(mesh, face.id))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no face %u to cut", face.id);
    return mesh_in_triangle(mesh, mesh->face_half[face.id]) ? HEWN_OK : cut_face(mesh, face.id, error);
}

/* --- all faces ---------------------------------------------------------------------------------------------------- */

/* Takes back all cuts since the mesh had these bounds. */
static void join_faces(hewn_mesh *mesh, uint32_t half_bound, uint32_t face_bound)
{
    mesh->live_edges -= (mesh->half_bound - half_bound) / 2;
    mesh->live_faces -= mesh->face_bound - face_bound;
    for (uint32_t d = mesh->half_bound; d > half_bound; d -= 2) {
        mesh_link(mesh, mesh->prev[d - 1], mesh->next[d - 2]);
        mesh_link(mesh, mesh->prev[d - 2], mesh->next[d - 1]);
    }
    mesh->half_bound = half_bound;
    mesh->face_bound = face_bound;
    for (uint32_t f = 0; f < face_bound; f++) {
        uint32_t first = mesh->face_half[f], h = first;
        if (first == MESH_DELETED)
            continue;
        do {
            mesh->face[h] = f;
            h = mesh->next[h];
        } while (h != first);
    }
}

hewn_result hewn_mesh_triangulate(hewn_mesh *mesh, hewn_error *error)
{
    uint32_t half_bound = mesh->half_bound, face_bound = mesh->face_bound;
    uint64_t corners = 0;
    for (uint32_t h = 0; h < half_bound; h++)
        corners += mesh->face[h] != HEWN_NONE;
    uint64_t cuts = corners - 3 * (uint64_t)mesh->live_faces;
    if (cuts > MESH_MOST_IDS)
        return hewn_fail(error, HEWN_LIMIT, "cutting the faces into triangles needs more ids than there are");
    if (cuts > 0)
        HEWN_TRY(hewn_mesh_reserve(mesh, 0, (uint32_t)cuts, (uint32_t)cuts, error));
    for (uint32_t f = 0; f < face_bound && cuts > 0; f++) {
        if (!mesh_has_face(mesh, f) || mesh_in_triangle(mesh, mesh->face_half[f]))
            continue;
        hewn_result result = cut_face(mesh, f, error);
        if (result != HEWN_OK) {
            join_faces(mesh, half_bound, face_bound);
            return result;
        }
    }
    return HEWN_OK;
}
