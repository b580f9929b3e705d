/* How far a simplified mesh is from its input, place by place: not proven, but soon known. */
#ifndef HEWN_SRC_SIMPLIFY_GAP_H
#define HEWN_SRC_SIMPLIFY_GAP_H

#include "geom/bvh.h"
#include "simplify/work.h"

/* Of each vertex of the result: how far the input is from what it stands for, and whether a triangle around it is
 * flipped, that is, faces away from the input's triangle nearest to its middle. */
typedef struct simplify_gaps {
    float *away; /* in the work's unit */
    uint8_t *turned;
    double most;
    uint32_t flips; /* triangles */
} simplify_gaps;

typedef struct simplify_gauge {
    const simplify_work *work;
    const hewn_polygons *input;
    double *positions; /* of the input's vertices, in coordinates of the work: far from the origin all is the same */
    hewn_bvh bvh;      /* of the input */
    uint32_t *place;   /* of each of the input's vertices that is left: its number now; else HEWN_NONE */
    uint32_t *near; /* of each of the input's vertices: a triangle of the result near it; HEWN_NONE: not looked for */
    float *gap;     /* and how far that is */
    uint32_t step;  /* so many-th vertices of the input are looked at */
} simplify_gauge;

/* HEWN_OUT_OF_MEMORY; release it also then. */
hewn_result hewn_simplify_gauge_make(const simplify_work *work, const hewn_polygons *input, simplify_gauge *out,
                                     hewn_error *error);
void hewn_simplify_gauge_release(simplify_gauge *gauge);

/* The vertex of the result that one of the input has become; HEWN_NONE where there is none. */
uint32_t hewn_simplify_place(const simplify_gauge *gauge, uint32_t v);

/* Measures `work`, which must be in order, into arrays that are large enough: the distances of the input's vertices to
 * the result, and those of the result's vertices and of the middles of its triangles to the input. The same for any
 * number of threads. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_measure(simplify_gauge *gauge, simplify_gaps *out, hewn_error *error);

#endif
