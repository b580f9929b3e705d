#include "mesh/mesh_data.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"

/* --- life --------------------------------------------------------------------------------------------------------- */

hewn_result hewn_mesh_create(hewn_mesh **out, hewn_error *error)
{
    *out = hewn_alloc_zero(1, sizeof **out);
    return *out ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a mesh");
}

void hewn_mesh_destroy(hewn_mesh **mesh)
{
    hewn_mesh *gone = *mesh;
    if (!gone)
        return;
    while (gone->attribute_count > 0)
        hewn_mesh_remove_attribute(gone, gone->attribute_count - 1);
    hewn_free(gone->attributes);
    hewn_free(gone->head);
    hewn_free(gone->next);
    hewn_free(gone->prev);
    hewn_free(gone->face);
    hewn_free(gone->vert_half);
    hewn_free(gone->position);
    hewn_free(gone->face_half);
    hewn_free(gone);
    *mesh = NULL;
}

hewn_result hewn_mesh_duplicate(const hewn_mesh *mesh, hewn_mesh **out, hewn_error *error)
{
    hewn_mesh *copy;
    *out = NULL;
    HEWN_TRY(hewn_mesh_create(&copy, error));
    hewn_result result = hewn_mesh_append(copy, mesh, error);
    if (result != HEWN_OK)
        hewn_mesh_destroy(&copy);
    *out = copy;
    return result;
}

/* --- growth ------------------------------------------------------------------------------------------------------- */

/* The capacity that holds `more` ids past `bound`: as it is, or half as much again. */
static hewn_result enough(uint32_t bound, uint64_t more, uint32_t *capacity, hewn_error *error)
{
    uint64_t needed = bound + more;
    if (needed > MESH_MOST_IDS)
        return hewn_fail(error, HEWN_LIMIT, "the mesh would need %llu ids of one kind, more than there are",
                         (unsigned long long)needed);
    if (needed <= *capacity)
        return HEWN_OK;
    uint64_t grown = bound == 0 ? needed : *capacity + (uint64_t)*capacity / 2 + 16;
    grown = grown < needed ? needed : grown;
    *capacity = (uint32_t)(grown > MESH_MOST_IDS ? MESH_MOST_IDS : grown);
    return HEWN_OK;
}

static hewn_result resize(void **block, size_t count, size_t size, hewn_error *error)
{
    void *moved = hewn_realloc(*block, count, size);
    if (!moved)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory growing a mesh to %zu elements of one kind", count);
    *block = moved;
    return HEWN_OK;
}

static hewn_result resize_values(hewn_mesh *mesh, hewn_domain domain, size_t count, hewn_error *error)
{
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        mesh_attribute *attribute = &mesh->attributes[i];
        if (attribute->info.domain == domain)
            HEWN_TRY(resize((void **)&attribute->data, count, attribute->stride, error));
    }
    return HEWN_OK;
}

static hewn_result grow_verts(hewn_mesh *mesh, uint32_t capacity, hewn_error *error)
{
    if (capacity == mesh->vert_capacity)
        return HEWN_OK;
    HEWN_TRY(resize((void **)&mesh->vert_half, capacity, sizeof *mesh->vert_half, error));
    HEWN_TRY(resize((void **)&mesh->position, capacity, 3 * sizeof *mesh->position, error));
    HEWN_TRY(resize_values(mesh, HEWN_DOMAIN_VERT, capacity, error));
    mesh->vert_capacity = capacity;
    return HEWN_OK;
}

static hewn_result grow_halves(hewn_mesh *mesh, uint32_t capacity, hewn_error *error)
{
    if (capacity == mesh->half_capacity)
        return HEWN_OK;
    uint32_t **arrays[] = {&mesh->head, &mesh->next, &mesh->prev, &mesh->face};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        HEWN_TRY(resize((void **)arrays[i], capacity, sizeof(uint32_t), error));
    HEWN_TRY(resize_values(mesh, HEWN_DOMAIN_CORNER, capacity, error));
    mesh->half_capacity = capacity;
    return HEWN_OK;
}

static hewn_result grow_faces(hewn_mesh *mesh, uint32_t capacity, hewn_error *error)
{
    if (capacity == mesh->face_capacity)
        return HEWN_OK;
    HEWN_TRY(resize((void **)&mesh->face_half, capacity, sizeof *mesh->face_half, error));
    HEWN_TRY(resize_values(mesh, HEWN_DOMAIN_FACE, capacity, error));
    mesh->face_capacity = capacity;
    return HEWN_OK;
}

hewn_result hewn_mesh_reserve(hewn_mesh *mesh, uint32_t verts, uint32_t edges, uint32_t faces, hewn_error *error)
{
    uint32_t vert_capacity = mesh->vert_capacity, half_capacity = mesh->half_capacity;
    uint32_t face_capacity = mesh->face_capacity;
    HEWN_TRY(enough(mesh->vert_bound, verts, &vert_capacity, error));
    HEWN_TRY(enough(mesh->half_bound, 2 * (uint64_t)edges, &half_capacity, error));
    HEWN_TRY(enough(mesh->face_bound, faces, &face_capacity, error));
    HEWN_TRY(grow_verts(mesh, vert_capacity, error));
    HEWN_TRY(grow_halves(mesh, half_capacity, error));
    return grow_faces(mesh, face_capacity, error);
}

/* --- elements ----------------------------------------------------------------------------------------------------- */

uint32_t hewn_mesh_new_vert(hewn_mesh *mesh, const double position[3])
{
    uint32_t v = mesh->vert_bound++;
    mesh->live_verts++;
    mesh->vert_half[v] = HEWN_NONE;
    memcpy(mesh->position + 3 * (size_t)v, position, 3 * sizeof *position);
    hewn_mesh_clear_values(mesh, HEWN_DOMAIN_VERT, v);
    return v;
}

uint32_t hewn_mesh_new_edge(hewn_mesh *mesh, uint32_t from, uint32_t to)
{
    uint32_t h = mesh->half_bound;
    mesh->half_bound += 2;
    mesh->live_edges++;
    mesh->head[h] = to;
    mesh->head[h + 1] = from;
    for (uint32_t i = h; i <= h + 1; i++) {
        mesh->next[i] = mesh->prev[i] = mesh->face[i] = HEWN_NONE;
        hewn_mesh_clear_values(mesh, HEWN_DOMAIN_CORNER, i);
    }
    return h;
}

uint32_t hewn_mesh_new_face(hewn_mesh *mesh, uint32_t half)
{
    uint32_t f = mesh->face_bound++;
    mesh->live_faces++;
    mesh->face_half[f] = half;
    hewn_mesh_clear_values(mesh, HEWN_DOMAIN_FACE, f);
    return f;
}

void hewn_mesh_drop_vert(hewn_mesh *mesh, uint32_t v)
{
    mesh->vert_half[v] = MESH_DELETED;
    mesh->live_verts--;
}

void hewn_mesh_drop_edge(hewn_mesh *mesh, uint32_t h)
{
    h &= ~1u;
    for (uint32_t i = h; i <= h + 1; i++)
        mesh->head[i] = mesh->next[i] = mesh->prev[i] = mesh->face[i] = HEWN_NONE;
    mesh->live_edges--;
}

void hewn_mesh_drop_face(hewn_mesh *mesh, uint32_t f)
{
    mesh->face_half[f] = MESH_DELETED;
    mesh->live_faces--;
}

void hewn_mesh_settle_vert(hewn_mesh *mesh, uint32_t v, uint32_t start)
{
    uint32_t h = start;
    mesh->vert_half[v] = start;
    do {
        if (mesh->face[h] == HEWN_NONE) {
            mesh->vert_half[v] = h;
            return;
        }
        h = mesh_ccw(mesh, h);
    } while (h != start);
}

/* --- sizes -------------------------------------------------------------------------------------------------------- */

uint32_t hewn_mesh_vert_count(const hewn_mesh *mesh)
{
    return mesh->live_verts;
}

uint32_t hewn_mesh_edge_count(const hewn_mesh *mesh)
{
    return mesh->live_edges;
}

uint32_t hewn_mesh_face_count(const hewn_mesh *mesh)
{
    return mesh->live_faces;
}

uint32_t hewn_mesh_vert_bound(const hewn_mesh *mesh)
{
    return mesh->vert_bound;
}

uint32_t hewn_mesh_half_bound(const hewn_mesh *mesh)
{
    return mesh->half_bound;
}

uint32_t hewn_mesh_face_bound(const hewn_mesh *mesh)
{
    return mesh->face_bound;
}

size_t hewn_mesh_bytes(const hewn_mesh *mesh)
{
    size_t bytes = sizeof *mesh + mesh->attribute_capacity * sizeof *mesh->attributes;
    bytes += mesh->half_capacity * 4 * sizeof(uint32_t);
    bytes += mesh->vert_capacity * (sizeof(uint32_t) + 3 * sizeof(double));
    bytes += mesh->face_capacity * sizeof(uint32_t);
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        const mesh_attribute *attribute = &mesh->attributes[i];
        size_t capacity = attribute->info.domain == HEWN_DOMAIN_VERT   ? mesh->vert_capacity
                          : attribute->info.domain == HEWN_DOMAIN_FACE ? mesh->face_capacity
                                                                       : mesh->half_capacity;
        bytes += capacity * attribute->stride + strlen(attribute->info.name) + 1;
        for (uint32_t name = 0; name < attribute->name_count; name++)
            bytes += sizeof(char *) + strlen(attribute->names[name]) + 1;
    }
    return bytes;
}

/* --- positions ---------------------------------------------------------------------------------------------------- */

const double *hewn_vert_position(const hewn_mesh *mesh, hewn_vert vert)
{
    return mesh_has_vert(mesh, vert.id) ? mesh->position + 3 * (size_t)vert.id : NULL;
}

void hewn_vert_set_position(hewn_mesh *mesh, hewn_vert vert, const double position[3])
{
    if (mesh_has_vert(mesh, vert.id) && isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]))
        memcpy(mesh->position + 3 * (size_t)vert.id, position, 3 * sizeof *position);
}
