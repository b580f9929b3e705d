/* What a soup of polygons is: everything that a certificate says, for each component too, duplicates, and where it runs
 * through itself. All counts are exact. */
#ifndef HEWN_CHECK_H
#define HEWN_CHECK_H

#include "hewn/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Counts the pairs of faces that meet improperly, exactly (no tolerance; robust predicates, Shewchuk 1997).
 *
 * Two faces meet properly where what their closed triangles have in common is nothing, or exactly the vertex or the
 * edge that they share by index. Everything else is counted: faces that cross, that touch at a point or along a line
 * not shared by index (so also where vertices lie at one place under two indices), that overlap in a plane, that fold
 * back onto each other along a shared edge, and that have the same three vertices. A face without area is the segment
 * or point that its corners span; one that names a vertex twice is the segment of its other edge.
 *
 * `positions`: vertex_count × 3, scene units. `triangles`: triangle_count × 3 indices. `*count` becomes the number of
 * unordered pairs. `pairs`, of room for max_pairs, receives the first of them in lexicographic order, the lower face
 * first in each: min(*count, max_pairs) are written. It may be NULL where max_pairs is 0. The same for any number of
 * threads.
 *
 * About 56 bytes a triangle of memory while it runs, and n log n time plus that of the pairs whose boxes meet: a mesh
 * piled up in one place takes quadratic time. `progress` may be NULL, its stage is "self-intersections".
 *
 * HEWN_BAD_INPUT for an index out of range or a position that is not finite, naming the first; HEWN_INVALID_ARGUMENT
 * for a missing array; HEWN_LIMIT for 2^32 or more triangles or vertices; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. `*count`
 * is then 0, and what `pairs` holds is without meaning. Safe from any thread while nobody changes the arrays. */
HEWN_API hewn_result hewn_count_self_intersections(const double *positions, uint64_t vertex_count,
                                                   const uint32_t *triangles, uint64_t triangle_count,
                                                   uint64_t max_pairs, uint32_t (*pairs)[2],
                                                   const hewn_progress *progress, uint64_t *count, hewn_error *error);

/* The same of triangles with float positions, which are read where they are. */
HEWN_API hewn_result hewn_triangles_count_self_intersections(const hewn_triangles *triangles, uint64_t max_pairs,
                                                             uint32_t (*pairs)[2], const hewn_progress *progress,
                                                             uint64_t *count, hewn_error *error);

/* --- the whole check ---------------------------------------------------------------------------------------------- */

/* What to do; zero means the default. */
typedef struct hewn_check_desc {
    bool skip_self_intersections;  /* they take most of the time */
    uint32_t most_pairs;           /* of self-intersecting faces to list; 0: 16 */
    uint32_t most_components;      /* to list; 0: 64 */
    const hewn_progress *progress; /* may be NULL; stages "triangulate", "check" and "self-intersections" */
} hewn_check_desc;
HEWN_API hewn_check_desc hewn_check_desc_default(void);

/* Faces joined at shared vertices, and what they are by themselves. Faces that name a vertex twice or have fewer than
 * three corners are left out, but for volume and area. */
typedef struct hewn_component {
    uint64_t vertices, edges, faces;
    int64_t euler;                   /* vertices - edges + faces */
    bool closed, manifold, oriented; /* as of the certificate */
    bool orientable;                 /* its faces can be turned so that two beside an edge of two faces agree */
    uint64_t boundary_edges;
    uint64_t boundary_loops; /* cycles of them, each vertex taken apart into its fans */
    uint64_t non_manifold_edges;
    uint64_t non_manifold_vertices;
    int64_t genus; /* (2 - euler - loops) / 2 handles where orientable, 2 - euler - loops cross-caps where not; -1 where
                      the component is not manifold */
    double volume; /* signed, meaningful where closed and oriented */
    double area;
    hewn_box bounds; /* of its vertices */
} hewn_component;

/* What was found. `certificate` says of all faces together what hewn_certify() says of triangles, with these meanings
 * for polygons: degenerate is a face that names a vertex twice, has fewer than three corners, or whose corners all lie
 * on one line (exactly); a face of the first two kinds has no sides and takes no part in edges, vertices and
 * components. Volume and area are those of the triangles that faces are cut into, as hewn_mesh_to_triangles() cuts
 * them; bounds are those of all vertices that faces name. `max_residual` is NaN.
 *
 * Faces intersect where any of their triangles meet improperly (hewn_count_self_intersections()); a pair is counted
 * once. A face that runs through itself, and is not degenerate, is a pair with itself. Where a face is not flat this is
 * said of the triangles that it is cut into. (A winding polygon of many thousands of corners may be cut with less care,
 * and then be found to meet itself.) */
typedef struct hewn_check {
    uint64_t vertex_count, face_count; /* of the soup */
    uint64_t used_vertices;            /* of faces with sides, as are `edges` and `sided_faces` */
    uint64_t edges;
    uint64_t sided_faces;
    int64_t euler; /* used_vertices - edges + sided_faces */
    hewn_certificate certificate;
    bool orientable;
    uint64_t boundary_loops;
    uint64_t unoriented_edges;  /* of two faces or more, and not as many one way as the other */
    uint64_t duplicate_faces;   /* with the corners of an earlier one, in the same cyclic order or reversed */
    uint64_t isolated_vertices; /* that no face names */
    bool self_intersections_known;
    uint64_t self_intersections; /* pairs of faces */
    uint32_t pair_count;         /* that are listed */
    uint32_t (*pairs)[2];        /* the first in lexicographic order, the lower face first in each */
    uint32_t component_count;    /* that are listed; certificate.components tells how many there are */
    hewn_component *components;  /* those of most faces first, of as many that with the lowest vertex */
} hewn_check;

/* Examines polygons, which may be anything: `first` NULL stands for triangles. The same result for any number of
 * threads; no count depends on the order of vertices, faces and corners, but for self-intersections of faces that are
 * not flat. `desc` may be NULL. Linear time and about 100 bytes a corner, but for self-intersections.
 *
 * HEWN_BAD_INPUT for an index out of range, a position that is not finite, or faces that do not follow each other,
 * naming the first; HEWN_INVALID_ARGUMENT for a missing array; HEWN_LIMIT for 2^32 or more corners, faces or vertices;
 * HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. Safe from any thread while nobody changes the arrays. */
HEWN_API hewn_result hewn_check_polygons(const hewn_polygons *polygons, const hewn_check_desc *desc, hewn_check **out,
                                         hewn_error *error);

/* The same of triangles with float positions, which are read where they are. */
HEWN_API hewn_result hewn_check_triangles(const hewn_triangles *triangles, const hewn_check_desc *desc,
                                          hewn_check **out, hewn_error *error);
HEWN_API void hewn_check_destroy(hewn_check **check);

/* --- requirements ------------------------------------------------------------------------------------------------- */

/* What may be asked of a mesh: one bit each. */
typedef enum hewn_requirement {
    HEWN_REQUIRE_CLOSED = 1 << 0,                /* "closed" */
    HEWN_REQUIRE_MANIFOLD = 1 << 1,              /* "manifold" */
    HEWN_REQUIRE_ORIENTED = 1 << 2,              /* "oriented" */
    HEWN_REQUIRE_NO_SELF_INTERSECTIONS = 1 << 3, /* "no-self-intersections" */
    HEWN_REQUIRE_NO_DEGENERATE_FACES = 1 << 4,   /* "no-degenerate-faces" */
    HEWN_REQUIRE_NO_DUPLICATE_FACES = 1 << 5,    /* "no-duplicate-faces" */
    HEWN_REQUIRE_NO_ISOLATED_VERTICES = 1 << 6,  /* "no-isolated-vertices" */
    HEWN_REQUIRE_ONE_COMPONENT = 1 << 7,         /* "one-component" */
    HEWN_REQUIRE_POSITIVE_VOLUME = 1 << 8,       /* "positive-volume": closed, oriented, and a volume above 0 */
    HEWN_REQUIRE_ALL = (1 << 9) - 1
} hewn_requirement;

/* The word for a single requirement, or NULL. Static storage. */
HEWN_API const char *hewn_requirement_name(hewn_requirement requirement);

/* Reads words separated by commas (blanks around them do not matter) into bits. HEWN_INVALID_ARGUMENT, naming the first
 * that is empty or not known. */
HEWN_API hewn_result hewn_requirements_parse(const char *words, uint32_t *out, hewn_error *error);

/* Those of the required bits that do not hold; what was not looked at (self-intersections) does not hold. */
HEWN_API uint32_t hewn_check_unmet(const hewn_check *check, uint32_t required);

#ifdef __cplusplus
}
#endif
#endif
