/* Simplification: edges of a mesh are collapsed, the ones that change its shape least first (Garland and Heckbert 1997,
 * 'Surface simplification using quadric error metrics'). */
#ifndef HEWN_SIMPLIFY_H
#define HEWN_SIMPLIFY_H

#include "hewn/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Attributes that are kept besides the shape: one bit each. */
typedef enum hewn_preserve {
    HEWN_PRESERVE_UV = 1 << 0,     /* "uv": texture coordinates and their seams */
    HEWN_PRESERVE_NORMAL = 1 << 1, /* "normal": the file's own normals, and edges where they differ */
    HEWN_PRESERVE_COLOR = 1 << 2,  /* "color": colours and the steps between them */
    HEWN_PRESERVE_LABEL = 1 << 3,  /* "label": borders between labels, materials, groups and objects */
    HEWN_PRESERVE_NONE = 1 << 4,   /* "none" */
    HEWN_PRESERVE_USUAL = HEWN_PRESERVE_UV | HEWN_PRESERVE_COLOR | HEWN_PRESERVE_LABEL /* where nothing is said */
} hewn_preserve;

/* When to stop, and what stays; at least one of `faces`, `ratio`, `error` and `relative_error` must be there. With
 * several, what comes first stops.
 *
 * faces: triangles to be left, 1 or more. ratio: the same as a share of the input's triangles (polygons count as the
 * triangles that they are cut into), above 0 to 1.
 *
 * error: a length in the model's unit, above 0. The two-sided Hausdorff distance between input and result is at most
 * that, which is proven before the result is handed out: where a first result is further away, its vertices there are
 * kept as they were and all is done again. relative_error: the same in diagonals of the input's box.
 *
 * lock_boundary: vertices on boundaries stay where they are. lock_angle above 0, in degrees: so do both ends of edges
 * whose faces bend by more. lock_labels: and vertices where `labels`, one a face, differ. Without it, borders between
 * labels are kept as lines like boundaries are: in their place as well as may be. `frozen`, one a vertex: these stay
 * too where it is not 0.
 *
 * no_self_intersections: no two triangles of the result meet improperly (hewn/check.h), but for those that were so in
 * the input and are as they were.
 *
 * measure: find the distance between input and result, for the report; it is found anyway where an error is given.
 *
 * preserve: for models, which attributes count as well as the shape; 0 stands for UV, COLOR and LABEL. */
typedef struct hewn_simplify_desc {
    uint64_t faces;
    double ratio;
    double error, relative_error;
    bool lock_boundary;
    double lock_angle;
    bool lock_labels;
    const int32_t *labels;
    const uint8_t *frozen;
    bool no_self_intersections;
    bool measure;
    uint32_t preserve;
    const hewn_progress *progress; /* or NULL; stages "simplify" and "measure" */
} hewn_simplify_desc;

/* What was done. */
typedef struct hewn_simplify_report {
    uint64_t triangles_before; /* that the input's faces were cut into */
    uint64_t triangles;
    uint64_t target;            /* triangles that were asked for; 0: none */
    bool reached;               /* as few as asked for, or no target */
    uint64_t dropped_faces;     /* of the input, for naming a vertex twice */
    uint64_t dropped_vertices;  /* of the input, for being part of no face */
    uint64_t locked_vertices;   /* that stayed, as asked for, of the result */
    uint64_t unwalked_vertices; /* that stayed because the input is not manifold there */
    uint32_t runs;              /* 1, or more where a promise asked for it */
    bool measured;
    double error_allowed; /* a length; 0: none was given */
    double distance;      /* Hausdorff distance, two-sided: certainly not more than this, */
    double distance_low;  /* and not less than this */
} hewn_simplify_report;

/* Triangles that were made of polygons. Owned; leave it with hewn_simplified_destroy(). */
typedef struct hewn_simplified {
    uint64_t vertex_count, face_count;
    double *positions;        /* 3 a vertex; the bits of the input where a vertex has not moved */
    uint32_t *corners;        /* 3 a triangle */
    uint32_t *vertex_origins; /* the input's vertex that each was, before others joined it */
    uint32_t *face_origins;   /* the input's face that each is what is left of */
} hewn_simplified;

/* Simplifies polygons, which may be open or closed. What is not manifold stays as it is: vertices on edges of three or
 * more faces, of two that disagree in direction, or with several fans. A manifold input gives a manifold result of the
 * same topology: components, boundary loops and handles stay. No triangle turns by more than 80 degrees in one
 * collapse. The same bytes for any number of threads. Some 170 bytes a triangle of memory beside input and result.
 *
 * HEWN_INVALID_ARGUMENT for a bad `desc`; HEWN_BAD_INPUT for a position or index that cannot be used, naming it;
 * HEWN_LIMIT for 2^32 - 2 corners and more; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. `report` may be NULL. Safe from any
 * thread while nobody changes the polygons. */
HEWN_API hewn_result hewn_polygons_simplify(const hewn_polygons *polygons, const hewn_simplify_desc *desc,
                                            hewn_simplified *out, hewn_simplify_report *report, hewn_error *error);
HEWN_API void hewn_simplified_destroy(hewn_simplified *simplified);

/* The same of a model, with its attributes. Those of vertices and corners are blended where edges collapse; what
 * `preserve` names counts in the order of collapses besides the shape (Hoppe 1999, 'New quadric metric for simplifying
 * meshes with appearance attributes'), and edges where corners differ in it are kept as lines, like boundaries.
 * Normals that are not preserved are made anew, sharp where faces bend by more than 40 degrees if they are of corners;
 * texture coordinates that are not preserved are dropped. Whole numbers are not blended. Attributes of faces stay with
 * what is left of each face. Where `labels` is NULL, faces that differ in label, material, group or object have
 * different labels (and those of different colours, for COLOR). Vertices without faces are dropped. */
HEWN_API hewn_result hewn_model_simplify(hewn_model *model, const hewn_simplify_desc *desc,
                                         hewn_simplify_report *report, hewn_error *error);

/* The same of the extraction's triangles; normals, where there are any, are made anew. Positions become floats again
 * after the distance was proven. */
HEWN_API hewn_result hewn_triangles_simplify(hewn_triangles *triangles, const hewn_simplify_desc *desc,
                                             hewn_simplify_report *report, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
