#include <math.h>

#include "base/alloc.h"
#include "mesh/carry.h"

/* Neighbours that a blend looks at; more would change nothing that anybody sees. */
enum { MOST_SOURCES = 64 };

/* `layer` is 0 where a vertex has an origin, else how far inside it lies; `order` has the vertices without origin,
 * those further out first. `corner` is a half-edge that ends in the vertex and has its corner's values, or HEWN_NONE.
 */
typedef struct spreading {
    hewn_mesh *mesh;
    const hewn_repair_origins *origins;
    uint32_t *layer, *order, *corner;
    uint32_t inner_count;
} spreading;

static bool is_made(const spreading *work, uint32_t face)
{
    return face != HEWN_NONE && work->origins->face_origins[face] == HEWN_NONE;
}

/* The neighbours of a vertex in layers below `layer`, at most MOST_SOURCES. */
static uint32_t find_sources(const spreading *work, uint32_t v, uint32_t layer, uint32_t *out)
{
    hewn_ring ring = hewn_vert_ring(work->mesh, (hewn_vert){v});
    hewn_half half;
    uint32_t count = 0;
    while (count < MOST_SOURCES && hewn_ring_next(work->mesh, &ring, &half)) {
        uint32_t other = work->mesh->head[half.id];
        if (work->layer[other] < layer)
            out[count++] = other;
    }
    return count;
}

static void blend(hewn_mesh *mesh, hewn_domain domain, uint32_t to, const uint32_t *from, uint32_t count)
{
    double weights[MOST_SOURCES];
    for (uint32_t i = 0; i < count; i++)
        weights[i] = 1.0 / count;
    hewn_mesh_blend_values(mesh, domain, to, from, weights, count);
}

/* --- vertices ----------------------------------------------------------------------------------------------------- */

/* Puts the vertices of the next layer in front of those that are further in; returns how many they are. */
static uint32_t find_layer(spreading *work, uint32_t begin, uint32_t layer)
{
    uint32_t sources[MOST_SOURCES], end = begin;
    for (uint32_t i = begin; i < work->inner_count; i++) {
        uint32_t v = work->order[i];
        if (find_sources(work, v, layer, sources) > 0) {
            work->order[i] = work->order[end];
            work->order[end++] = v;
        }
    }
    for (uint32_t i = begin; i < end; i++)
        work->layer[work->order[i]] = layer;
    return end - begin;
}

static void spread_verts(spreading *work)
{
    hewn_mesh *mesh = work->mesh;
    for (uint32_t v = 0; v < mesh->vert_bound; v++) {
        bool inner = work->origins->vertex_origins[v] == HEWN_NONE;
        work->layer[v] = inner ? HEWN_NONE : 0;
        if (inner)
            work->order[work->inner_count++] = v;
    }
    uint32_t begin = 0, sources[MOST_SOURCES];
    for (uint32_t layer = 1; begin < work->inner_count; layer++) {
        uint32_t count = find_layer(work, begin, layer);
        if (count == 0)
            break;
        for (uint32_t i = begin; i < begin + count; i++)
            blend(mesh, HEWN_DOMAIN_VERT, work->order[i], sources, find_sources(work, work->order[i], layer, sources));
        begin += count;
    }
}

/* --- faces -------------------------------------------------------------------------------------------------------- */

/* A face beside this one that has its values, or HEWN_NONE. */
static uint32_t find_neighbour(const hewn_mesh *mesh, uint32_t face, const uint8_t *known)
{
    uint32_t first = mesh->face_half[face], h = first;
    do {
        uint32_t other = mesh->face[h ^ 1];
        if (other != HEWN_NONE && known[other])
            return other;
        h = mesh->next[h];
    } while (h != first);
    return HEWN_NONE;
}

/* Breadth-first from the rims: `queue` has room for all faces, `known` says which have their values. */
static void spread_faces(const spreading *work, uint32_t *queue, uint8_t *known)
{
    hewn_mesh *mesh = work->mesh;
    uint32_t count = 0;
    for (uint32_t f = 0; f < mesh->face_bound; f++)
        known[f] = !is_made(work, f);
    for (uint32_t f = 0; f < mesh->face_bound; f++)
        if (!known[f] && find_neighbour(mesh, f, known) != HEWN_NONE)
            queue[count++] = f;
    for (uint32_t i = 0; i < count; i++)
        hewn_mesh_copy_values(mesh, HEWN_DOMAIN_FACE, queue[i], find_neighbour(mesh, queue[i], known));
    for (uint32_t i = 0; i < count; i++)
        known[queue[i]] = true;
    for (uint32_t at = 0; at < count; at++) {
        uint32_t first = mesh->face_half[queue[at]], h = first;
        do {
            uint32_t other = mesh->face[h ^ 1];
            if (other != HEWN_NONE && !known[other]) {
                hewn_mesh_copy_values(mesh, HEWN_DOMAIN_FACE, other, queue[at]);
                known[other] = true;
                queue[count++] = other;
            }
            h = mesh->next[h];
        } while (h != first);
    }
}

/* --- corners ------------------------------------------------------------------------------------------------------ */

/* A corner of an old face at a vertex, as the half-edge that ends there; of a made one where `made`. */
static uint32_t find_corner(const spreading *work, uint32_t v, bool made)
{
    const hewn_mesh *mesh = work->mesh;
    hewn_ring ring = hewn_vert_ring(mesh, (hewn_vert){v});
    hewn_half half;
    while (hewn_ring_next(mesh, &ring, &half)) {
        uint32_t face = mesh->face[half.id];
        if (face != HEWN_NONE && is_made(work, face) == made)
            return mesh->prev[half.id];
    }
    return HEWN_NONE;
}

static void spread_inner_corners(spreading *work)
{
    hewn_mesh *mesh = work->mesh;
    for (uint32_t i = 0; i < work->inner_count; i++) {
        uint32_t v = work->order[i], near[MOST_SOURCES], sources[MOST_SOURCES], count = 0;
        uint32_t near_count = find_sources(work, v, work->layer[v], near);
        for (uint32_t k = 0; k < near_count; k++)
            if (work->corner[near[k]] != HEWN_NONE)
                sources[count++] = work->corner[near[k]];
        work->corner[v] = find_corner(work, v, true);
        if (work->corner[v] != HEWN_NONE && count > 0)
            blend(mesh, HEWN_DOMAIN_CORNER, work->corner[v], sources, count);
    }
}

static void spread_corners(spreading *work)
{
    hewn_mesh *mesh = work->mesh;
    for (uint32_t v = 0; v < mesh->vert_bound; v++)
        work->corner[v] = work->layer[v] == 0 ? find_corner(work, v, false) : HEWN_NONE;
    spread_inner_corners(work);
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        uint32_t first = mesh->face_half[f], h = first;
        if (!is_made(work, f))
            continue;
        do {
            uint32_t from = work->corner[mesh->head[h]];
            if (from != HEWN_NONE && from != h)
                hewn_mesh_copy_values(mesh, HEWN_DOMAIN_CORNER, h, from);
            h = mesh->next[h];
        } while (h != first);
    }
}

/* --- normals ------------------------------------------------------------------------------------------------------ */

static bool make_unit(double vector[3])
{
    double length = sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    if (!(length > 0) || !isfinite(length))
        return false;
    for (int k = 0; k < 3; k++)
        vector[k] /= length;
    return true;
}

/* The mean of the made faces around a vertex, weighted by area. */
static bool find_normal(const spreading *work, uint32_t v, double out[3])
{
    hewn_ring ring = hewn_vert_ring(work->mesh, (hewn_vert){v});
    hewn_half half;
    out[0] = out[1] = out[2] = 0;
    while (hewn_ring_next(work->mesh, &ring, &half)) {
        double vector[3];
        if (!is_made(work, work->mesh->face[half.id]))
            continue;
        hewn_mesh_face_vector(work->mesh, work->mesh->face[half.id], vector);
        for (int k = 0; k < 3; k++)
            out[k] += vector[k];
    }
    return make_unit(out);
}

static void set_normals(const spreading *work, mesh_attribute *attribute)
{
    const hewn_mesh *mesh = work->mesh;
    double normal[3];
    hewn_domain domain = attribute->info.domain;
    for (uint32_t i = 0; domain == HEWN_DOMAIN_VERT && i < work->inner_count; i++)
        if (find_normal(work, work->order[i], normal))
            hewn_mesh_write_direction(attribute, work->order[i], normal);
    for (uint32_t f = 0; domain != HEWN_DOMAIN_VERT && f < mesh->face_bound; f++) {
        uint32_t first = mesh->face_half[f], h = first;
        if (!is_made(work, f))
            continue;
        hewn_mesh_face_vector(mesh, f, normal);
        if (domain == HEWN_DOMAIN_FACE && make_unit(normal))
            hewn_mesh_write_direction(attribute, f, normal);
        if (domain == HEWN_DOMAIN_FACE)
            continue;
        do {
            if (find_normal(work, mesh->head[h], normal))
                hewn_mesh_write_direction(attribute, h, normal);
            h = mesh->next[h];
        } while (h != first);
    }
}

hewn_result hewn_mesh_spread(hewn_mesh *mesh, const hewn_repair_origins *origins, hewn_error *error)
{
    bool made = false;
    for (uint32_t f = 0; f < mesh->face_bound && !made; f++)
        made = origins->face_origins[f] == HEWN_NONE;
    if (!made || mesh->attribute_count == 0)
        return HEWN_OK;
    spreading work = {.mesh = mesh, .origins = origins};
    work.layer = hewn_alloc(mesh->vert_bound, sizeof *work.layer);
    work.order = hewn_alloc(mesh->vert_bound, sizeof *work.order);
    work.corner = hewn_alloc(mesh->vert_bound, sizeof *work.corner);
    uint32_t *queue = hewn_alloc(mesh->face_bound, sizeof *queue);
    uint8_t *known = hewn_alloc(mesh->face_bound, 1);
    bool room = work.layer && work.order && work.corner && queue && known;
    if (room) {
        spread_verts(&work);
        spread_faces(&work, queue, known);
        spread_corners(&work);
        for (uint32_t i = 0; i < mesh->attribute_count; i++)
            if (mesh->attributes[i].direction)
                set_normals(&work, &mesh->attributes[i]);
    }
    hewn_free(work.layer);
    hewn_free(work.order);
    hewn_free(work.corner);
    hewn_free(queue);
    hewn_free(known);
    return room ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for what filling made");
}
