/* The half-edge mesh: polygons with their neighbours, attributes, and the operations that keep it valid.
 *
 * Half-edges come in pairs: the twin of h is h ^ 1, and the pair is one edge. A half-edge knows the vertex at its head,
 * the face at its left (none along a boundary), and the next and previous half-edge of that face or boundary loop. A
 * vertex knows one half-edge that leaves it (a boundary one if there is one), a face one of its half-edges. Every walk
 * is O(1) a step and allocates nothing. Vertices are 2-manifold or 2-manifold with boundary: around a vertex lies one
 * fan or one ring.
 *
 * What always holds, and what hewn_mesh_validate() checks: every edge joins two different vertices and has a face on at
 * least one side; no two edges join the same two vertices; a face has three or more corners and no vertex twice;
 * positions are finite. Isolated vertices are allowed. (So are two faces back to back over the same corners.)
 *
 * Elements are typed 32-bit indices. Deleted elements stay as holes until hewn_mesh_compact(), which keeps the order of
 * the rest. Mueller and Preparata 1978, Kettner 1999 ('Using generic programming for designing a data structure for
 * polyhedral surfaces').
 *
 * A mesh is changed by one thread at a time; any number of threads may read it while nobody changes it. Questions about
 * an element that is none, deleted or out of range are answered with none, 0, false or NULL; operations refuse it. */
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
#ifdef __cplusplus
#define HEWN_VERT_NONE (hewn_vert{HEWN_NONE})
#define HEWN_HALF_NONE (hewn_half{HEWN_NONE})
#define HEWN_FACE_NONE (hewn_face{HEWN_NONE})
#else
#define HEWN_VERT_NONE ((hewn_vert){HEWN_NONE})
#define HEWN_HALF_NONE ((hewn_half){HEWN_NONE})
#define HEWN_FACE_NONE ((hewn_face){HEWN_NONE})
#endif

/* --- life --------------------------------------------------------------------------------------------------------- */

/* An empty mesh. HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_mesh_create(hewn_mesh **out, hewn_error *error);
HEWN_API void hewn_mesh_destroy(hewn_mesh **mesh);

/* A copy with the same ids, holes and attributes. HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_mesh_duplicate(const hewn_mesh *mesh, hewn_mesh **out, hewn_error *error);

/* Builds a mesh from polygons over shared vertices in linear time, on all threads of OpenMP: face f has the corners
 * corners[first[f]] to corners[first[f + 1] - 1], counter-clockwise (`first` begins with 0 and has face_count + 1
 * entries; NULL: triangles). Positions are 3 doubles a vertex (scene units), copied. Vertices and faces keep their
 * numbers; edges are numbered by their lesser vertex, and even half-edges run from the lesser to the greater one, for
 * any number of threads. HEWN_BAD_INPUT, naming the first offender, where a position is not finite, an index is out of
 * range, a face has fewer than three or repeated corners, an edge would have more than two faces or two that run along
 * it the same way, or a vertex more than one fan: repair the soup first (hewn/repair.h). HEWN_OUT_OF_MEMORY, HEWN_LIMIT
 * past 2^32 - 2 half-edges. */
typedef struct hewn_polygons {
    uint64_t vertex_count;
    const double *positions;
    uint64_t face_count;
    const uint64_t *first;
    const uint32_t *corners;
} hewn_polygons;
HEWN_API hewn_result hewn_mesh_from_polygons(const hewn_polygons *polygons, hewn_mesh **out, hewn_error *error);

/* The same from the extraction's triangles (positions become doubles; normals become the vertex attribute "normal"
 * where there are any). The triangles stay the caller's. */
HEWN_API hewn_result hewn_mesh_from_triangles(const hewn_triangles *triangles, hewn_mesh **out, hewn_error *error);

/* Back to indexed triangles of floats, live elements in order, those of a face together; polygons are cut as
 * hewn_mesh_triangulate() would, and along an edge that exists already where there is no other way. A vertex attribute
 * "normal" (3 FLOAT or DOUBLE) becomes the normals. `*out` is the caller's. HEWN_LIMIT for a position that a float
 * cannot hold, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_mesh_to_triangles(const hewn_mesh *mesh, hewn_triangles *out, hewn_error *error);

/* --- sizes and walking -------------------------------------------------------------------------------------------- */

/* Live elements, and the bound that all ids are below (larger where there are holes). */
HEWN_API uint32_t hewn_mesh_vert_count(const hewn_mesh *mesh);
HEWN_API uint32_t hewn_mesh_edge_count(const hewn_mesh *mesh);
HEWN_API uint32_t hewn_mesh_face_count(const hewn_mesh *mesh);
HEWN_API uint32_t hewn_mesh_vert_bound(const hewn_mesh *mesh);
HEWN_API uint32_t hewn_mesh_half_bound(const hewn_mesh *mesh);
HEWN_API uint32_t hewn_mesh_face_bound(const hewn_mesh *mesh);

/* Heap bytes that the mesh holds, room for growth and attributes included. */
HEWN_API size_t hewn_mesh_bytes(const hewn_mesh *mesh);

/* Makes room for so many elements more, so that adding them does not move the arrays. Not needed: operations make their
 * own room. HEWN_OUT_OF_MEMORY, HEWN_LIMIT. */
HEWN_API hewn_result hewn_mesh_reserve(hewn_mesh *mesh, uint32_t verts, uint32_t edges, uint32_t faces,
                                       hewn_error *error);

/* Whether an element is there and not deleted. */
HEWN_API bool hewn_mesh_has_vert(const hewn_mesh *mesh, hewn_vert vert);
HEWN_API bool hewn_mesh_has_half(const hewn_mesh *mesh, hewn_half half);
HEWN_API bool hewn_mesh_has_face(const hewn_mesh *mesh, hewn_face face);

/* The other half-edge of the same edge; not to be asked of none. */
static inline hewn_half hewn_half_twin(hewn_half half)
{
    half.id ^= 1u;
    return half;
}
HEWN_API hewn_half hewn_half_next(const hewn_mesh *mesh, hewn_half half);
HEWN_API hewn_half hewn_half_prev(const hewn_mesh *mesh, hewn_half half);
HEWN_API hewn_vert hewn_half_head(const hewn_mesh *mesh, hewn_half half);
HEWN_API hewn_vert hewn_half_tail(const hewn_mesh *mesh, hewn_half half);
HEWN_API hewn_face hewn_half_face(const hewn_mesh *mesh, hewn_half half); /* none along a boundary */

/* A half-edge that leaves a vertex: the one without a face where the vertex is on a boundary, none where it is
 * isolated.
 */
HEWN_API hewn_half hewn_vert_half(const hewn_mesh *mesh, hewn_vert vert);

/* The half-edge of a face whose head is the face's first corner: heads along hewn_half_next() give the corners in their
 * order. */
HEWN_API hewn_half hewn_face_half(const hewn_mesh *mesh, hewn_face face);

/* An isolated vertex is not on a boundary. Valence counts edges, degree corners; both walk around. */
HEWN_API bool hewn_vert_on_boundary(const hewn_mesh *mesh, hewn_vert vert);
HEWN_API uint32_t hewn_vert_valence(const hewn_mesh *mesh, hewn_vert vert);
HEWN_API uint32_t hewn_face_degree(const hewn_mesh *mesh, hewn_face face);

/* The half-edge from one vertex to another, or none. Takes time in proportion to the lesser valence of the two. */
HEWN_API hewn_half hewn_mesh_find_half(const hewn_mesh *mesh, hewn_vert from, hewn_vert to);

/* The half-edges that leave a vertex, counter-clockwise, once around, starting with hewn_vert_half() (on a boundary the
 * last of the fan; the gap comes next): for (hewn_ring r = hewn_vert_ring(m, v); hewn_ring_next(m, &r, &h);). The mesh
 * must not change meanwhile. */
typedef struct hewn_ring {
    hewn_half at, first;
} hewn_ring;
HEWN_API hewn_ring hewn_vert_ring(const hewn_mesh *mesh, hewn_vert vert);
HEWN_API bool hewn_ring_next(const hewn_mesh *mesh, hewn_ring *ring, hewn_half *out);

/* The position of a vertex, three doubles; valid until vertices are added. */
HEWN_API const double *hewn_vert_position(const hewn_mesh *mesh, hewn_vert vert);

/* Moves a vertex; a position that is not finite is ignored. */
HEWN_API void hewn_vert_set_position(hewn_mesh *mesh, hewn_vert vert, const double position[3]);

/* --- attributes --------------------------------------------------------------------------------------------------- */

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

/* Bytes of one scalar; 0 for a value that is none. */
HEWN_API size_t hewn_scalar_size(hewn_scalar scalar);

/* What an attribute is. Names that readers, writers and algorithms know: "normal" (3, unit length: normalised again
 * after blending), "uv" (2, origin at the lower left), "color" (3 or 4), "label" (1 INT32). Others are the user's own.
 */
typedef struct hewn_attribute_info {
    const char *name; /* owned by the mesh; unique within a domain */
    hewn_domain domain;
    hewn_scalar scalar;
    uint32_t components; /* 1 to 16 */
} hewn_attribute_info;

/* Adds an attribute, zero everywhere; the name is copied. HEWN_INVALID_ARGUMENT for a name taken or empty, or a bad
 * domain, scalar or number of components; HEWN_OUT_OF_MEMORY. `out` (its index) may be NULL. */
HEWN_API hewn_result hewn_mesh_add_attribute(hewn_mesh *mesh, const hewn_attribute_info *info, uint32_t *out,
                                             hewn_error *error);
HEWN_API void hewn_mesh_remove_attribute(hewn_mesh *mesh, uint32_t attribute); /* later ones move down by one */
HEWN_API uint32_t hewn_mesh_attribute_count(const hewn_mesh *mesh);
HEWN_API const hewn_attribute_info *hewn_mesh_attribute(const hewn_mesh *mesh, uint32_t attribute);
HEWN_API bool hewn_mesh_find_attribute(const hewn_mesh *mesh, hewn_domain domain, const char *name, uint32_t *out);

/* Names of an INT32 attribute's values: value i is called names[i], other values have no name. They are copied, in
 * place of those that were there. HEWN_INVALID_ARGUMENT for another attribute or a missing name; HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_mesh_name_values(hewn_mesh *mesh, uint32_t attribute, const char *const *names,
                                           uint32_t count, hewn_error *error);

/* How many names there are, and that of a value; NULL where it has none. */
HEWN_API uint32_t hewn_mesh_value_name_count(const hewn_mesh *mesh, uint32_t attribute);
HEWN_API const char *hewn_mesh_value_name(const hewn_mesh *mesh, uint32_t attribute, int32_t value);

/* The values of one element (`components` scalars): its id is a vert's, a half's or a face's. Valid until elements or
 * attributes are added or removed. NULL for an attribute or element that is not there. */
HEWN_API void *hewn_mesh_attribute_at(hewn_mesh *mesh, uint32_t attribute, uint32_t element);
HEWN_API const void *hewn_mesh_attribute_read(const hewn_mesh *mesh, uint32_t attribute, uint32_t element);

/* --- operations: each leaves the mesh valid, or refuses and changes nothing ------------------------------------------
 *
 * What an operation makes gets its attributes from what was there: a vertex on an edge or in a face the blend that
 * keeps linear functions linear, a new face those of the face it was cut from. All may fail with HEWN_OUT_OF_MEMORY or
 * HEWN_LIMIT (too many ids) where they return a result; elements that are not live are HEWN_INVALID_ARGUMENT. Ids of
 * elements that an operation does not name stay as they are, but for hewn_mesh_compact(). `out` may be NULL. */

/* An isolated vertex, attributes zero. HEWN_INVALID_ARGUMENT for a position that is not finite. */
HEWN_API hewn_result hewn_mesh_add_vert(hewn_mesh *mesh, const double position[3], hewn_vert *out, hewn_error *error);

/* A face over existing vertices, attributes zero. HEWN_INVALID_ARGUMENT where it would not stay 2-manifold, also for a
 * moment: a face that meets others at a vertex must share an edge with the end of that vertex's fan. */
HEWN_API hewn_result hewn_mesh_add_face(hewn_mesh *mesh, const hewn_vert *corners, uint32_t count, hewn_face *out,
                                        hewn_error *error);

/* Takes a face away; its edges go where no other face has them, its vertices stay. Where a vertex would be left with
 * two fans it is split: the fan that follows the face counter-clockwise moves to a new vertex of the same position and
 * attributes. */
HEWN_API hewn_result hewn_mesh_delete_face(hewn_mesh *mesh, hewn_face face, hewn_error *error);

/* Takes a vertex away and every face around it, as hewn_mesh_delete_face() does. */
HEWN_API hewn_result hewn_mesh_delete_vert(hewn_mesh *mesh, hewn_vert vert, hewn_error *error);

/* Whether the edge of two triangles can turn, and turning it: the half-edge then runs between their other two corners,
 * from the one at the right to the one at the left. Does nothing where it cannot. */
HEWN_API bool hewn_mesh_can_flip(const hewn_mesh *mesh, hewn_half half);
HEWN_API void hewn_mesh_flip(hewn_mesh *mesh, hewn_half half);

/* Puts a vertex on an edge at (1 - t) tail + t head, 0 <= t <= 1; the faces beside it gain a corner, and triangles are
 * split in two (of two triangles back to back only the left one). The half-edge then runs from its old tail to the new
 * vertex. */
HEWN_API hewn_result hewn_mesh_split(hewn_mesh *mesh, hewn_half half, double t, hewn_vert *out, hewn_error *error);

/* Whether the edge may shrink to its head without a non-manifold result (the link condition: Dey, Edelsbrunner, Guha
 * and Nekhayev 1999; on boundaries and beside polygons too), and doing so: the tail goes; the head keeps its position
 * and attributes. A corner that moves along takes the head's corner values where it had those of the tail beside the
 * edge, so that seams stay. Does nothing where it may not. */
HEWN_API bool hewn_mesh_can_collapse(const hewn_mesh *mesh, hewn_half half);
HEWN_API void hewn_mesh_collapse(hewn_mesh *mesh, hewn_half half);

/* A vertex inside a face, joined to all its corners; the face keeps its first two. Attributes are blended by mean value
 * coordinates (Hormann and Floater 2006). HEWN_INVALID_ARGUMENT for a position that is not finite. */
HEWN_API hewn_result hewn_mesh_poke(hewn_mesh *mesh, hewn_face face, const double position[3], hewn_vert *out,
                                    hewn_error *error);

/* Cuts polygons into triangles: ears (Meisters 1975), the best shaped first, judged exactly in the coordinate plane
 * that is nearest to the plane of best fit (Newell's normal), so that concave faces come out right; never an edge that
 * exists already. Degenerate and self-crossing faces are cut somehow. HEWN_INVALID_ARGUMENT, naming the face, where
 * every way that was tried needs an edge that exists already (poke it instead); all faces are then as before. */
HEWN_API hewn_result hewn_mesh_triangulate_face(hewn_mesh *mesh, hewn_face face, hewn_error *error);
HEWN_API hewn_result hewn_mesh_triangulate(hewn_mesh *mesh, hewn_error *error);

/* Closes the holes that deleted elements left; all ids change, their order does not. Also gives back room for growth.
 */
HEWN_API hewn_result hewn_mesh_compact(hewn_mesh *mesh, hewn_error *error);

/* Adds a copy of `other`, holes included: its element i becomes i + the bound before. Attributes are joined by domain
 * and name; where only one mesh has one, it is zero in the other's part. Values that have names in `other` become those
 * that are called so here, new names are added. HEWN_INVALID_ARGUMENT where two attributes of one name differ in scalar
 * or components. `other` may be `mesh`. */
HEWN_API hewn_result hewn_mesh_append(hewn_mesh *mesh, const hewn_mesh *other, hewn_error *error);

/* Positions by a row-major 3 x 4 matrix, attributes "normal" by its inverse transpose; a mirroring matrix also reverses
 * all faces. HEWN_INVALID_ARGUMENT for a matrix that is singular or not finite, or a position that would not be. */
HEWN_API hewn_result hewn_mesh_transform(hewn_mesh *mesh, const double matrix[12], hewn_error *error);

/* Turns every face over (its first corner stays first), and attributes "normal" with it. */
HEWN_API void hewn_mesh_reverse(hewn_mesh *mesh);

/* Checks every invariant named at the top, finite positions and counts included, in linear time. HEWN_INTERNAL, naming
 * the element, for the first that does not hold; HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_mesh_validate(const hewn_mesh *mesh, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
