/* The half-edge mesh: polygons with their neighbours, attributes, and the operations that keep it valid.
 *
 * Half-edges come in pairs: the twin of h is h ^ 1, and the pair is one edge. A half-edge knows the vertex at its head,
 * the face at its left (none along a boundary), and the next and previous half-edge of that face or boundary loop. A
 * vertex knows one half-edge that leaves it (a boundary one if there is one), a face one of its half-edges. Every walk
 * is O(1) a step and allocates nothing. Vertices are 2-manifold or 2-manifold with boundary: around a vertex lies one
 * fan or one ring.
 *
 * Elements are typed 32-bit indices. Deleted elements stay as holes until hewn_mesh_compact(), which keeps the order of
 * the rest. Mueller and Preparata 1978, Kettner 1999 ('Using generic programming for designing a data structure for
 * polyhedral surfaces').
 *
 * A mesh is changed by one thread at a time; any number of threads may read it while nobody changes it. */
#ifndef HEWN_MESH_H
#define HEWN_MESH_H

#include "hewn/triangles.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hewn_mesh hewn_mesh;

typedef struct hewn_vert {
    uint32_t id;
} hewn_vert;
typedef struct hewn_half {
    uint32_t id;
} hewn_half;
typedef struct hewn_face {
    uint32_t id;
} hewn_face;

#define HEWN_NONE 0xFFFFFFFFu
#define HEWN_VERT_NONE ((hewn_vert){HEWN_NONE})
#define HEWN_HALF_NONE ((hewn_half){HEWN_NONE})
#define HEWN_FACE_NONE ((hewn_face){HEWN_NONE})

/* --- life ------------------------------------------------------------------------------------------------------- */

HEWN_API hewn_result hewn_mesh_create(hewn_mesh **out, hewn_error *error);
HEWN_API void hewn_mesh_destroy(hewn_mesh **mesh);
HEWN_API hewn_result hewn_mesh_duplicate(const hewn_mesh *mesh, hewn_mesh **out, hewn_error *error);

/* Builds a mesh from polygons over shared vertices in linear time: face f has the corners corners[first[f]] to
 * corners[first[f + 1] - 1], counter-clockwise (`first` has face_count + 1 entries; NULL: triangles). Positions are 3
 * doubles a vertex (scene units), copied. HEWN_BAD_INPUT, naming the first offender, where an index is out of range, a
 * face has fewer than three or repeated corners, an edge would have more than two faces or two that run along it the
 * same way, or a vertex more than one fan: repair the soup first (hewn/repair.h). HEWN_OUT_OF_MEMORY, HEWN_LIMIT past
 * 2^32 - 2 half-edges. */
typedef struct hewn_polygons {
    uint64_t vertex_count;
    const double *positions;
    uint64_t face_count;
    const uint64_t *first;
    const uint32_t *corners;
} hewn_polygons;
HEWN_API hewn_result hewn_mesh_from_polygons(const hewn_polygons *polygons, hewn_mesh **out, hewn_error *error);

/* The same from the extraction's triangles (positions become doubles; normals become a vertex attribute where there are
 * any). */
HEWN_API hewn_result hewn_mesh_from_triangles(const hewn_triangles *triangles, hewn_mesh **out, hewn_error *error);

/* Back to indexed triangles of floats; polygons are triangulated as hewn_mesh_triangulate() would. */
HEWN_API hewn_result hewn_mesh_to_triangles(const hewn_mesh *mesh, hewn_triangles *out, hewn_error *error);

/* --- sizes and walking ------------------------------------------------------------------------------------------- */

/* Live elements, and the bound that all ids are below (larger where there are holes). */
HEWN_API uint32_t hewn_mesh_vert_count(const hewn_mesh *mesh);
HEWN_API uint32_t hewn_mesh_edge_count(const hewn_mesh *mesh);
HEWN_API uint32_t hewn_mesh_face_count(const hewn_mesh *mesh);
HEWN_API uint32_t hewn_mesh_vert_bound(const hewn_mesh *mesh);
HEWN_API uint32_t hewn_mesh_half_bound(const hewn_mesh *mesh);
HEWN_API uint32_t hewn_mesh_face_bound(const hewn_mesh *mesh);

/* Whether an element is live. */
HEWN_API bool hewn_mesh_has_vert(const hewn_mesh *mesh, hewn_vert vert);
HEWN_API bool hewn_mesh_has_half(const hewn_mesh *mesh, hewn_half half);
HEWN_API bool hewn_mesh_has_face(const hewn_mesh *mesh, hewn_face face);

static inline hewn_half hewn_half_twin(hewn_half half)
{
    return (hewn_half){half.id ^ 1u};
}
HEWN_API hewn_half hewn_half_next(const hewn_mesh *mesh, hewn_half half);
HEWN_API hewn_half hewn_half_prev(const hewn_mesh *mesh, hewn_half half);
HEWN_API hewn_vert hewn_half_head(const hewn_mesh *mesh, hewn_half half);
HEWN_API hewn_vert hewn_half_tail(const hewn_mesh *mesh, hewn_half half);
HEWN_API hewn_face hewn_half_face(const hewn_mesh *mesh, hewn_half half); /* none along a boundary */
HEWN_API hewn_half hewn_vert_half(const hewn_mesh *mesh, hewn_vert vert); /* leaves it; none for an isolated vertex */
HEWN_API hewn_half hewn_face_half(const hewn_mesh *mesh, hewn_face face);
HEWN_API bool hewn_vert_on_boundary(const hewn_mesh *mesh, hewn_vert vert);
HEWN_API uint32_t hewn_vert_valence(const hewn_mesh *mesh, hewn_vert vert);
HEWN_API uint32_t hewn_face_degree(const hewn_mesh *mesh, hewn_face face);
HEWN_API hewn_half hewn_mesh_find_half(const hewn_mesh *mesh, hewn_vert from, hewn_vert to); /* or none */

/* The half-edges that leave a vertex, counter-clockwise, once around: for (hewn_ring r = hewn_vert_ring(m, v);
 * hewn_ring_next(m, &r, &h);) */
typedef struct hewn_ring {
    hewn_half at, first;
} hewn_ring;
HEWN_API hewn_ring hewn_vert_ring(const hewn_mesh *mesh, hewn_vert vert);
HEWN_API bool hewn_ring_next(const hewn_mesh *mesh, hewn_ring *ring, hewn_half *out);

/* The position of a vertex, three doubles; valid until vertices are added. */
HEWN_API const double *hewn_vert_position(const hewn_mesh *mesh, hewn_vert vert);
HEWN_API void hewn_vert_set_position(hewn_mesh *mesh, hewn_vert vert, const double position[3]);

/* --- attributes -------------------------------------------------------------------------------------------------- */

typedef enum hewn_domain {
    HEWN_DOMAIN_VERT,
    HEWN_DOMAIN_CORNER, /* where a face meets a vertex: kept at the face's half-edge whose head is that vertex */
    HEWN_DOMAIN_FACE
} hewn_domain;

typedef enum hewn_scalar {
    HEWN_SCALAR_FLOAT,  /* blended by operations that make new elements */
    HEWN_SCALAR_DOUBLE, /* the same */
    HEWN_SCALAR_UINT8,  /* blended and rounded: colours, 255 is 1 */
    HEWN_SCALAR_INT32   /* never blended: labels; a new element takes that of the nearest old one */
} hewn_scalar;

/* What an attribute is. Names that readers, writers and algorithms know: "normal" (3, unit length), "uv" (2, origin at
 * the lower left), "color" (3 or 4), "label" (1 INT32). Others are the user's own. */
typedef struct hewn_attribute_info {
    const char *name; /* owned by the mesh; unique within a domain */
    hewn_domain domain;
    hewn_scalar scalar;
    uint32_t components; /* 1 to 16 */
} hewn_attribute_info;

/* Adds an attribute, zero everywhere. HEWN_INVALID_ARGUMENT for a name taken or empty, or a bad number of components.
 */
HEWN_API hewn_result hewn_mesh_add_attribute(hewn_mesh *mesh, const hewn_attribute_info *info, uint32_t *out,
                                             hewn_error *error);
HEWN_API void hewn_mesh_remove_attribute(hewn_mesh *mesh, uint32_t attribute); /* later ones move down by one */
HEWN_API uint32_t hewn_mesh_attribute_count(const hewn_mesh *mesh);
HEWN_API const hewn_attribute_info *hewn_mesh_attribute(const hewn_mesh *mesh, uint32_t attribute);
HEWN_API bool hewn_mesh_find_attribute(const hewn_mesh *mesh, hewn_domain domain, const char *name, uint32_t *out);

/* The values of one element (`components` scalars): its id is a vert's, a half's or a face's. Valid until elements or
 * attributes are added. */
HEWN_API void *hewn_mesh_attribute_at(hewn_mesh *mesh, uint32_t attribute, uint32_t element);
HEWN_API const void *hewn_mesh_attribute_read(const hewn_mesh *mesh, uint32_t attribute, uint32_t element);

/* --- operations: each leaves the mesh valid, or refuses and changes nothing ------------------------------------------
 */

HEWN_API hewn_result hewn_mesh_add_vert(hewn_mesh *mesh, const double position[3], hewn_vert *out, hewn_error *error);
/* A face over existing vertices. HEWN_INVALID_ARGUMENT where it would not stay 2-manifold. */
HEWN_API hewn_result hewn_mesh_add_face(hewn_mesh *mesh, const hewn_vert *corners, uint32_t count, hewn_face *out,
                                        hewn_error *error);
HEWN_API void hewn_mesh_delete_face(hewn_mesh *mesh, hewn_face face); /* its edges go where no other face has them */
HEWN_API void hewn_mesh_delete_vert(hewn_mesh *mesh, hewn_vert vert); /* and every face around it */

/* Whether the edge of two triangles can turn, and turning it: it then joins their other two corners. */
HEWN_API bool hewn_mesh_can_flip(const hewn_mesh *mesh, hewn_half half);
HEWN_API void hewn_mesh_flip(hewn_mesh *mesh, hewn_half half);

/* Puts a vertex on an edge at tail + t (head - tail); the faces beside it gain a corner, and triangles are split in
 * two. */
HEWN_API hewn_result hewn_mesh_split(hewn_mesh *mesh, hewn_half half, double t, hewn_vert *out, hewn_error *error);

/* Whether the edge may shrink to its head without a non-manifold result (the link condition: Dey, Edelsbrunner, Guha
 * and Nekhayev 1999; on boundaries and beside polygons too), and doing so: the tail goes; the head keeps its position
 * and attributes. */
HEWN_API bool hewn_mesh_can_collapse(const hewn_mesh *mesh, hewn_half half);
HEWN_API void hewn_mesh_collapse(hewn_mesh *mesh, hewn_half half);

/* A vertex inside a face, joined to all its corners. */
HEWN_API hewn_result hewn_mesh_poke(hewn_mesh *mesh, hewn_face face, const double position[3], hewn_vert *out,
                                    hewn_error *error);

/* Cuts polygons into triangles: ears in the plane of best fit, concave faces right; never an edge that exists already.
 */
HEWN_API hewn_result hewn_mesh_triangulate_face(hewn_mesh *mesh, hewn_face face, hewn_error *error);
HEWN_API hewn_result hewn_mesh_triangulate(hewn_mesh *mesh, hewn_error *error);

HEWN_API hewn_result hewn_mesh_compact(hewn_mesh *mesh, hewn_error *error);
HEWN_API hewn_result hewn_mesh_append(hewn_mesh *mesh, const hewn_mesh *other,
                                      hewn_error *error); /* attributes joined by name */
/* Positions by a row-major 3 x 4 matrix, normals by its inverse transpose; a mirroring matrix also reverses all faces.
 */
HEWN_API hewn_result hewn_mesh_transform(hewn_mesh *mesh, const double matrix[12], hewn_error *error);
HEWN_API void hewn_mesh_reverse(hewn_mesh *mesh); /* turns every face over */

/* Checks every invariant named at the top, finite positions included. HEWN_INTERNAL, naming the element, for the first
 * that does not hold. */
HEWN_API hewn_result hewn_mesh_validate(const hewn_mesh *mesh, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
