#include "mesh/mesh_data.h"

#include <string.h>

#include "base/alloc.h"

/* Bounds and attributes of the mesh that grows, before it does. */
typedef struct mesh_bounds {
    uint32_t verts, halves, faces, attributes;
} mesh_bounds;

/* Finds or makes the place of each attribute of `other`; takes back what it made where one cannot be joined. */
static hewn_result join_attributes(hewn_mesh *mesh, const hewn_mesh *other, hewn_error *error)
{
    for (uint32_t i = 0; i < other->attribute_count; i++) {
        const hewn_attribute_info *info = &other->attributes[i].info;
        uint32_t at;
        if (!hewn_mesh_find_attribute(mesh, info->domain, info->name, &at)) {
            HEWN_TRY(hewn_mesh_add_attribute(mesh, info, NULL, error));
            continue;
        }
        const hewn_attribute_info *own = &mesh->attributes[at].info;
        if (own->scalar != info->scalar || own->components != info->components)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                             "the meshes have attributes \"%s\" of different scalars or components", info->name);
    }
    return HEWN_OK;
}

/* Joins the names of values; the maps (one for each attribute of `other`, or NULL) are the caller's also after an
 * error. */
static hewn_result join_names(hewn_mesh *mesh, const hewn_mesh *other, int32_t ***maps, hewn_error *error)
{
    *maps = hewn_alloc_zero(other->attribute_count, sizeof **maps);
    if (!*maps)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory appending a mesh");
    for (uint32_t i = 0; i < other->attribute_count; i++) {
        const mesh_attribute *from = &other->attributes[i];
        uint32_t at;
        if (from->name_count > 0 && hewn_mesh_find_attribute(mesh, from->info.domain, from->info.name, &at))
            HEWN_TRY(hewn_mesh_join_names(&mesh->attributes[at], from, *maps + i, error));
    }
    return HEWN_OK;
}

static void free_maps(int32_t **maps, uint32_t count)
{
    for (uint32_t i = 0; maps && i < count; i++)
        hewn_free(maps[i]);
    hewn_free((void *)maps);
}

/* Labels of the new elements: values that have names in `other` become what is called so here. */
static void map_values(mesh_attribute *attribute, uint32_t old, size_t bytes, const int32_t *map, uint32_t names)
{
    int32_t *values = (int32_t *)(void *)(attribute->data + old * attribute->stride);
    for (size_t i = 0; i < bytes / sizeof *values; i++)
        if (values[i] >= 0 && (uint32_t)values[i] < names)
            values[i] = map[values[i]];
}

/* Values of the new elements: those of `other`, or zero. */
static void fill_values(hewn_mesh *mesh, const hewn_mesh *other, const mesh_bounds *before, int32_t *const *maps)
{
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        mesh_attribute *attribute = &mesh->attributes[i];
        hewn_domain domain = attribute->info.domain;
        uint32_t old = domain == HEWN_DOMAIN_VERT   ? before->verts
                       : domain == HEWN_DOMAIN_FACE ? before->faces
                                                    : before->halves;
        size_t bytes = (mesh_domain_bound(mesh, domain) - old) * attribute->stride;
        uint32_t from;
        if (bytes == 0)
            continue;
        bool found = hewn_mesh_find_attribute(other, domain, attribute->info.name, &from);
        if (found)
            memcpy(attribute->data + old * attribute->stride, other->attributes[from].data, bytes);
        else
            memset(attribute->data + old * attribute->stride, 0, bytes);
        if (found && maps[from])
            map_values(attribute, old, bytes, maps[from], other->attributes[from].name_count);
    }
}

/* Ids moved up by `base`; HEWN_NONE and MESH_DELETED stay. */
static void copy_ids(uint32_t *to, const uint32_t *from, uint32_t count, uint32_t base)
{
    for (uint32_t i = 0; i < count; i++)
        to[i] = from[i] >= MESH_DELETED ? from[i] : from[i] + base;
}

/* `more` are the bounds of `other`, taken before, for it may be the mesh itself. */
static void copy_elements(hewn_mesh *mesh, const hewn_mesh *other, const mesh_bounds *base, const mesh_bounds *more)
{
    copy_ids(mesh->head + base->halves, other->head, more->halves, base->verts);
    copy_ids(mesh->next + base->halves, other->next, more->halves, base->halves);
    copy_ids(mesh->prev + base->halves, other->prev, more->halves, base->halves);
    copy_ids(mesh->face + base->halves, other->face, more->halves, base->faces);
    copy_ids(mesh->vert_half + base->verts, other->vert_half, more->verts, base->halves);
    copy_ids(mesh->face_half + base->faces, other->face_half, more->faces, base->halves);
    if (more->verts > 0)
        memcpy(mesh->position + 3 * (size_t)base->verts, other->position, 3 * sizeof(double) * more->verts);
    mesh->half_bound = base->halves + more->halves;
    mesh->vert_bound = base->verts + more->verts;
    mesh->face_bound = base->faces + more->faces;
}

hewn_result hewn_mesh_append(hewn_mesh *mesh, const hewn_mesh *other, hewn_error *error)
{
    mesh_bounds base = {mesh->vert_bound, mesh->half_bound, mesh->face_bound, mesh->attribute_count};
    mesh_bounds more = {other->vert_bound, other->half_bound, other->face_bound, other->attribute_count};
    uint32_t verts = other->live_verts, edges = other->live_edges, faces = other->live_faces;
    int32_t **maps = NULL;
    hewn_result result = hewn_mesh_reserve(mesh, more.verts, more.halves / 2, more.faces, error);
    if (result == HEWN_OK)
        result = join_attributes(mesh, other, error);
    if (result == HEWN_OK)
        result = join_names(mesh, other, &maps, error);
    if (result != HEWN_OK) {
        free_maps(maps, more.attributes);
        while (mesh->attribute_count > base.attributes)
            hewn_mesh_remove_attribute(mesh, mesh->attribute_count - 1);
        return result;
    }
    copy_elements(mesh, other, &base, &more);
    fill_values(mesh, other, &base, maps);
    free_maps(maps, more.attributes);
    mesh->live_verts += verts;
    mesh->live_edges += edges;
    mesh->live_faces += faces;
    return HEWN_OK;
}
