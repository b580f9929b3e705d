/* Simplification with attributes: what polygons and models have in common. */
#ifndef HEWN_SRC_SIMPLIFY_RUN_H
#define HEWN_SRC_SIMPLIFY_RUN_H

#include "hewn/simplify.h"
#include "simplify/wedge.h"

/* The input as triangles; what had to be made for that is owned. */
typedef struct simplify_input {
    hewn_simplify_desc desc;
    hewn_polygons triangles;
    const simplify_wedges *wedges; /* or NULL */
    uint32_t *corners;
    uint32_t *faces;         /* the polygon of each triangle; NULL where it is the triangle's own number */
    int32_t *labels;         /* of each triangle */
    uint32_t *corner_wedges; /* of each triangle's corners; NULL where they are those of `wedges` */
    uint8_t *frozen;         /* one a vertex: stays, for the sake of a promise; or NULL */
    const uint32_t *groups;  /* one a vertex: those with equal ones are one vertex of a complex; or NULL */
    float *limits;           /* one a vertex: the largest error by its quadric, a length; or NULL */
} simplify_input;

/* Triangles, and the wedges of their corners with all wedges' values. */
typedef struct simplify_result {
    hewn_simplified mesh;
    uint32_t *into; /* of each vertex of the input: itself, or the one that it was joined to */
    uint32_t *wedges;
    double *values;
} simplify_result;
void hewn_simplify_result_release(simplify_result *result);

/* One run. */
hewn_result hewn_simplify_once(const simplify_input *in, simplify_result *out, hewn_simplify_report *report,
                               hewn_error *error);

/* Whether polygons can be simplified. HEWN_BAD_INPUT, HEWN_LIMIT. */
hewn_result hewn_simplify_check_polygons(const hewn_polygons *polygons, hewn_error *error);

/* hewn_polygons_simplify(), with wedges or NULL, and groups of a complex (simplify_input) or NULL. */
hewn_result hewn_simplify_polygons(const hewn_polygons *polygons, const hewn_simplify_desc *desc,
                                   const simplify_wedges *wedges, const uint32_t *groups, simplify_result *out,
                                   hewn_simplify_report *report, hewn_error *error);

#endif
