/* What a mesh is made of, for the algorithms of this room: arrays to be read directly, and the steps that walk them.
 *
 * Twins are h ^ 1. A deleted half-edge has head, next, prev and face HEWN_NONE; a deleted vertex or face has
 * MESH_DELETED as its half-edge, so marks cost no memory. Ids stay below HEWN_NONE - 1 for that reason. */
#ifndef HEWN_SRC_MESH_MESH_DATA_H
#define HEWN_SRC_MESH_MESH_DATA_H

#include "base/error.h"
#include "hewn/mesh.h"

#define MESH_DELETED 0xFFFFFFFEu
#define MESH_MOST_IDS 0xFFFFFFFEu

/* Scalars of one attribute lie side by side, `stride` bytes an element. Corner values are indexed by half-edge; those
 * of half-edges without face are unused. */
typedef struct mesh_attribute {
    hewn_attribute_info info; /* its name is owned */
    unsigned char *data;
    size_t stride;
    bool direction; /* "normal" with three floating-point components: kept at unit length */
    char **names;   /* of the values 0 to name_count - 1, owned; INT32 only */
    uint32_t name_count;
} mesh_attribute;

struct hewn_mesh {
    /* One a half-edge. */
    uint32_t *head, *next, *prev, *face;
    uint32_t half_bound, half_capacity;
    /* One a vertex; positions three. */
    uint32_t *vert_half;
    double *position;
    uint32_t vert_bound, vert_capacity;
    /* One a face. */
    uint32_t *face_half;
    uint32_t face_bound, face_capacity;

    uint32_t live_verts, live_edges, live_faces;

    mesh_attribute *attributes;
    uint32_t attribute_count;
    size_t attribute_capacity;
};

static inline bool mesh_has_vert(const hewn_mesh *mesh, uint32_t v)
{
    return v < mesh->vert_bound && mesh->vert_half[v] != MESH_DELETED;
}

static inline bool mesh_has_half(const hewn_mesh *mesh, uint32_t h)
{
    return h < mesh->half_bound && mesh->head[h] != HEWN_NONE;
}

static inline bool mesh_has_face(const hewn_mesh *mesh, uint32_t f)
{
    return f < mesh->face_bound && mesh->face_half[f] != MESH_DELETED;
}

static inline uint32_t mesh_tail(const hewn_mesh *mesh, uint32_t h)
{
    return mesh->head[h ^ 1];
}

/* The next half-edge that leaves the same tail, counter-clockwise. */
static inline uint32_t mesh_ccw(const hewn_mesh *mesh, uint32_t h)
{
    return mesh->prev[h] ^ 1;
}

static inline bool mesh_on_boundary(const hewn_mesh *mesh, uint32_t v)
{
    return mesh->vert_half[v] != HEWN_NONE && mesh->face[mesh->vert_half[v]] == HEWN_NONE;
}

static inline bool mesh_in_triangle(const hewn_mesh *mesh, uint32_t h)
{
    return mesh->next[mesh->next[mesh->next[h]]] == h;
}

/* Makes `b` follow `a`. */
static inline void mesh_link(hewn_mesh *mesh, uint32_t a, uint32_t b)
{
    mesh->next[a] = b;
    mesh->prev[b] = a;
}

/* The half-edge between two live vertices, or HEWN_NONE. */
uint32_t hewn_mesh_find(const hewn_mesh *mesh, uint32_t from, uint32_t to);

/* New elements, attributes zero; room must have been reserved. A new edge has both heads and neither links nor faces;
 * its half-edge from `from` to `to` is returned. */
uint32_t hewn_mesh_new_vert(hewn_mesh *mesh, const double position[3]);
uint32_t hewn_mesh_new_edge(hewn_mesh *mesh, uint32_t from, uint32_t to);
uint32_t hewn_mesh_new_face(hewn_mesh *mesh, uint32_t half);

/* Marks elements deleted and counts them out; links to them are the caller's business. */
void hewn_mesh_drop_vert(hewn_mesh *mesh, uint32_t v);
void hewn_mesh_drop_edge(hewn_mesh *mesh, uint32_t h);
void hewn_mesh_drop_face(hewn_mesh *mesh, uint32_t f);

/* Makes a boundary half-edge that leaves `v` its half-edge, if there is one; `start` is any that leaves it. */
void hewn_mesh_settle_vert(hewn_mesh *mesh, uint32_t v, uint32_t start);

/* Attribute values of one element, of all attributes of a domain: zero, copied, or blended from `count` elements
 * (labels: from that of the greatest weight, the first of equals). The target may not be among the sources. */
void hewn_mesh_clear_values(hewn_mesh *mesh, hewn_domain domain, uint32_t element);
void hewn_mesh_copy_values(hewn_mesh *mesh, hewn_domain domain, uint32_t to, uint32_t from);
void hewn_mesh_blend_values(hewn_mesh *mesh, hewn_domain domain, uint32_t to, const uint32_t *from,
                            const double *weights, uint32_t count);
bool hewn_mesh_has_values(const hewn_mesh *mesh, hewn_domain domain);

/* Three components of a normal; `attribute` must be a direction. */
void hewn_mesh_read_direction(const mesh_attribute *attribute, uint32_t element, double out[3]);
void hewn_mesh_write_direction(mesh_attribute *attribute, uint32_t element, const double direction[3]);

/* Frees the names of an attribute's values. */
void hewn_mesh_clear_names(mesh_attribute *attribute);

/* Adds the names of `from` that `attribute` lacks; (*map)[i] becomes the value here of what is value i there. `*map` is
 * the caller's, NULL where all values stay as they are. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_mesh_join_names(mesh_attribute *attribute, const mesh_attribute *from, int32_t **map,
                                 hewn_error *error);

static inline uint32_t mesh_domain_bound(const hewn_mesh *mesh, hewn_domain domain)
{
    return domain == HEWN_DOMAIN_VERT   ? mesh->vert_bound
           : domain == HEWN_DOMAIN_FACE ? mesh->face_bound
                                        : mesh->half_bound;
}

/* The operations without their checks: `hewn_mesh_can_...()` must have said yes. */
void hewn_mesh_flip_unchecked(hewn_mesh *mesh, uint32_t h);
void hewn_mesh_collapse_unchecked(hewn_mesh *mesh, uint32_t h);

/* Reverses all faces, their normals untouched. */
void hewn_mesh_reverse_topology(hewn_mesh *mesh);

#endif
