/* Subdivision surfaces: Catmull-Clark 1978, Loop 1987 and bilinear refinement, with the rules of OpenSubdiv for
 * boundaries, corners, semi-sharp creases (DeRose, Kass and Truong 1998; Hoppe and others 1994) and face-varying data.
 */
#ifndef HEWN_SUBDIVIDE_H
#define HEWN_SUBDIVIDE_H

#include "hewn/model.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hewn_scheme {
    HEWN_SCHEME_CATMULL_CLARK, /* any polygons; all faces are quadrilaterals after the first level */
    HEWN_SCHEME_LOOP,          /* triangles only */
    HEWN_SCHEME_BILINEAR,      /* as Catmull-Clark, but nothing is smoothed */
    HEWN_SCHEME_COUNT
} hewn_scheme;

/* What becomes of a boundary: a smooth curve, with the corner of a lone face (a boundary vertex of one face) sharp or
 * not; or the faces that touch it are left out. */
typedef enum hewn_subdivide_boundary {
    HEWN_BOUNDARY_EDGE_AND_CORNER,
    HEWN_BOUNDARY_EDGE_ONLY,
    HEWN_BOUNDARY_NONE,
    HEWN_BOUNDARY_COUNT
} hewn_subdivide_boundary;

/* Sharpness falls by one a level; Chaikin's rule first evens it out along a crease. */
typedef enum hewn_creasing { HEWN_CREASING_UNIFORM, HEWN_CREASING_CHAIKIN, HEWN_CREASING_COUNT } hewn_creasing;

/* Where attributes of corners (uv) are interpolated linearly instead of smoothly: nowhere; at corners, values of one
 * face; there and where three regions or more meet; there and at the ends of seams and at the concave side of corners;
 * along all boundaries of regions; everywhere. */
typedef enum hewn_uv_rule {
    HEWN_UV_CORNERS_PLUS1,
    HEWN_UV_NONE,
    HEWN_UV_CORNERS_ONLY,
    HEWN_UV_CORNERS_PLUS2,
    HEWN_UV_BOUNDARIES,
    HEWN_UV_ALL,
    HEWN_UV_COUNT
} hewn_uv_rule;

/* "catmull-clark", "loop", "bilinear"; "edge-and-corner", "edge-only", "none"; "uniform", "chaikin"; "corners-plus1",
 * "none", "corners-only", "corners-plus2", "boundaries", "all". NULL for a value that is none. */
HEWN_API const char *hewn_scheme_name(hewn_scheme scheme);
HEWN_API const char *hewn_subdivide_boundary_name(hewn_subdivide_boundary boundary);
HEWN_API const char *hewn_creasing_name(hewn_creasing creasing);
HEWN_API const char *hewn_uv_rule_name(hewn_uv_rule rule);

/* An edge by its two vertices, and how many levels long it stays sharp; 10 and more is for ever. */
typedef struct hewn_crease {
    uint32_t verts[2];
    double sharpness;
} hewn_crease;

/* A sharp vertex. */
typedef struct hewn_corner_tag {
    uint32_t vert;
    double sharpness;
} hewn_corner_tag;

#define HEWN_LEVELS_NONE 0xFFFFFFFFu
enum { HEWN_MOST_LEVELS = 16 };

/* How; zero is one level of Catmull-Clark. */
typedef struct hewn_subdivide_desc {
    hewn_scheme scheme;
    uint32_t levels; /* 0: 1; HEWN_LEVELS_NONE: none, which makes sense with `limit` */
    hewn_subdivide_boundary boundary;
    hewn_creasing creasing;
    hewn_uv_rule uv;
    const hewn_crease *creases;
    uint64_t crease_count;
    const hewn_corner_tag *corners;
    uint64_t corner_count;
    double crease_angle; /* edges whose faces bend by more than so many degrees are sharp for ever; 0: none */
    bool limit;          /* vertices go where they would be after infinitely many levels, and normals are exact there */
    uint64_t max_memory; /* levels that take more bytes than that are refused; 0: more than the machine has */
    const hewn_progress *progress; /* or NULL; the stage is "subdivide" */
} hewn_subdivide_desc;
HEWN_API hewn_subdivide_desc hewn_subdivide_desc_default(void);

/* Refined connections, without positions: made once, evaluated for as many positions as wanted. Vertices keep their
 * numbers; those of a level's edges follow, then those of its faces. Face f of n corners becomes n (Loop: 4), in order.
 * Many threads may read one. */
typedef struct hewn_subdivision hewn_subdivision;

/* HEWN_BAD_INPUT where polygons are no manifold (see hewn_mesh_from_polygons()), for a face that is no triangle (LOOP),
 * for a crease or corner that is not there or a sharpness that is no number from 0 on, naming it;
 * HEWN_INVALID_ARGUMENT for a bad desc; HEWN_LIMIT for more corners or half-edges than 32 bits number, and
 * HEWN_OUT_OF_MEMORY for more than max_memory, both before any level is made; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. */
HEWN_API hewn_result hewn_subdivision_create(const hewn_polygons *polygons, const hewn_subdivide_desc *desc,
                                             hewn_subdivision **out, hewn_error *error);
HEWN_API void hewn_subdivision_destroy(hewn_subdivision **subdivision);

HEWN_API uint32_t hewn_subdivision_vert_count(const hewn_subdivision *subdivision);
HEWN_API uint32_t hewn_subdivision_face_count(const hewn_subdivision *subdivision);

/* The refined polygons; `positions` is NULL. A view that lives as long as the subdivision. */
HEWN_API hewn_polygons hewn_subdivision_polygons(const hewn_subdivision *subdivision);

/* Values of the control vertices, `components` numbers each, to values of the refined ones. The two may not overlap.
 * With `limit` in the desc they are those of the limit surface. HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. The same bytes for
 * any number of threads. */
HEWN_API hewn_result hewn_subdivision_evaluate(const hewn_subdivision *subdivision, const double *control,
                                               uint32_t components, double *out, hewn_error *error);

/* The same of three components, and two tangents and their cross product, the unit normal, at each refined vertex of
 * the limit surface; each array may be NULL. HEWN_INVALID_ARGUMENT where the desc had no `limit`. */
HEWN_API hewn_result hewn_subdivision_limit(const hewn_subdivision *subdivision, const double *control,
                                            double *positions, double *tangents_u, double *tangents_v, double *normals,
                                            hewn_error *error);

/* What was done to a model. */
typedef struct hewn_subdivide_report {
    uint32_t levels;
    uint64_t creases, corners; /* sharp edges and vertices of the control mesh, those of boundaries left out */
    uint64_t dropped_faces;    /* for HEWN_BOUNDARY_NONE, of the control mesh */
    uint64_t adaptive_faces;   /* faces of a lower level than `levels`; 0 where not adaptive */
} hewn_subdivide_report;

/* Subdivides a model. Channels of vertices follow positions (whole numbers are those of the nearest control vertex),
 * those of corners follow the desc's rule for them, those of faces go to all children. Channels "normal" of vertices
 * and corners are made anew: with `limit` exact ones of vertices, else from faces.
 *
 * `adaptive` above 0 keeps faces of a lower level where they lie within that distance of the points that the next
 * level would add; such a face has those vertices of finer neighbours that lie on its edges as corners of its own, so
 * there are no cracks, and no vertex on the inside of an edge. All vertices are then those of the finest level.
 *
 * `report` may be NULL. The errors of hewn_subdivision_create(). The model is unchanged after an error. */
HEWN_API hewn_result hewn_model_subdivide(hewn_model *model, const hewn_subdivide_desc *desc, double adaptive,
                                          hewn_subdivide_report *report, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
