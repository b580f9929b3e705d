/* Plain triangle buffers, as the extraction makes them, and the certificate that says what they are. */
#ifndef HEWN_TRIANGLES_H
#define HEWN_TRIANGLES_H

#include "hewn/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Indexed triangles, counter-clockwise seen from outside. Zero is the empty one. Owned by whoever holds the struct;
 * move it by assignment and leave it with hewn_triangles_destroy(). */
typedef struct hewn_triangles {
    uint64_t vertex_count;
    uint64_t triangle_count;
    float *positions;             /* vertex_count × 3, scene units */
    float *normals;               /* vertex_count × 3, unit length, outward; or NULL */
    uint32_t *indices;            /* triangle_count × 3 */
    bool paired;                  /* triangles 2i and 2i + 1 are quad i: (a, b, c) and (a, c, d) of (a, b, c, d) */
    void (*release)(void *owner); /* frees all three; where NULL they are from the heap */
    void *owner;
} hewn_triangles;

HEWN_API void hewn_triangles_destroy(hewn_triangles *triangles);

/* What was proven of a mesh. A face with two equal corners has no sides: it counts as degenerate and in the bounds, and
 * takes no part in edges, vertices and components. A mesh without faces is closed, manifold and oriented. */
typedef struct hewn_certificate {
    bool closed;   /* every edge has a face on both sides */
    bool manifold; /* no edge has more than two faces, the faces at each vertex form one fan or one ring */
    bool oriented; /* the two faces of each edge run along it in opposite directions; of more faces, half each way */
    uint64_t components; /* of faces joined at shared vertices; isolated vertices do not count */
    int64_t genus;       /* of all components together; -1 where the mesh is not closed, manifold and oriented */
    uint64_t boundary_edges;
    uint64_t non_manifold_edges;
    uint64_t non_manifold_vertices;
    uint64_t degenerate_faces; /* with two equal corners, or an area of exactly 0 */
    double volume;             /* signed, scene units cubed; meaningful where closed and oriented */
    double area;
    hewn_box bounds;     /* of the vertices that faces use; all 0 where there is none */
    double max_residual; /* set by the extraction: largest |f|/|grad f| in cells at a vertex; NaN where not known */
} hewn_certificate;

/* Examines triangles. Linear in their number, deterministic (sums in a fixed order). HEWN_BAD_INPUT for an index out of
 * range or a position that is not finite, naming the first; HEWN_LIMIT for 2^32 or more corners or
 * vertices; HEWN_OUT_OF_MEMORY. `progress` may be NULL, its stage is "certify". */
HEWN_API hewn_result hewn_certify(const hewn_triangles *triangles, const hewn_progress *progress, hewn_certificate *out,
                                  hewn_error *error);

/* --- meshes that come in parts ------------------------------------------------------------------------------------ */

/* Numbers in a row. */
typedef struct hewn_number_run {
    uint64_t first, count;
} hewn_number_run;

/* Vertices `first` to `first + count - 1` of the mesh. */
typedef struct hewn_vertex_run {
    uint64_t first, count;
    const float *positions, *normals; /* count × 3 */
} hewn_vertex_run;

typedef struct hewn_triangle_run {
    uint64_t first, count;
    const uint32_t *indices; /* count × 3: numbers of the whole mesh's vertices, also of such as are still to come */
} hewn_triangle_run;

/* A part of a mesh. Each vertex and triangle comes once, at the place that it has in the whole; runs may be empty.
 * `open` tells, in ascending order, the vertices that are still to come or that triangles of later parts may still
 * name. */
typedef struct hewn_mesh_part {
    hewn_vertex_run vertices[2];
    hewn_triangle_run triangles[2];
    const hewn_number_run *open;
    uint64_t open_count;
} hewn_mesh_part;

/* Where the parts of a mesh go. What a part points to is there for the time of the call only. Calls of `take` come in
 * the order of the parts, one at a time, but perhaps on another thread than the caller's, which makes the next part
 * meanwhile. `bytes` comes on the caller's thread, and not while a part is taken. After `take` fails there are no more
 * calls. */
typedef struct hewn_mesh_sink {
    void *user;
    hewn_result (*take)(void *user, const hewn_mesh_part *part, hewn_error *error);
    /* Host memory that it will take at the most while it takes a part, with what it holds already; of NULL, what it
     * holds, which is no more than it told of the last part. NULL: none. */
    uint64_t (*bytes)(void *user, const hewn_mesh_part *part);
} hewn_mesh_sink;

/* Certifies a mesh that comes in parts, in memory that grows with the largest part and with what is open. The
 * certificate is the one that hewn_certify() gives of the whole, bit by bit; triangles must name vertex 0. */
typedef struct hewn_certifier hewn_certifier;
HEWN_API hewn_result hewn_certifier_create(hewn_certifier **out, hewn_error *error);
HEWN_API void hewn_certifier_destroy(hewn_certifier **certifier);

/* HEWN_BAD_INPUT for a position that is not finite; HEWN_INVALID_ARGUMENT for a vertex that comes twice or is named
 * when it is no longer open; HEWN_LIMIT for parts of 2^32 corners; HEWN_OUT_OF_MEMORY. After an error the certifier can
 * only be destroyed. */
HEWN_API hewn_result hewn_certifier_take(hewn_certifier *certifier, const hewn_mesh_part *part, hewn_error *error);

/* As the sink's, for hewn_certifier_take(). */
HEWN_API uint64_t hewn_certifier_bytes(const hewn_certifier *certifier, const hewn_mesh_part *part);

/* After the last part. HEWN_INVALID_ARGUMENT where vertices are missing or open. `max_residual` is NaN. */
HEWN_API hewn_result hewn_certifier_finish(hewn_certifier *certifier, hewn_certificate *out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
