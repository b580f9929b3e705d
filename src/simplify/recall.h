/* What earlier runs have shown already. Each run begins with the input, but comes out the same wherever nothing else
 * was asked for: most triangles of the result are those of the run before, to the bit, and what is known of them holds.
 */
#ifndef HEWN_SRC_SIMPLIFY_RECALL_H
#define HEWN_SRC_SIMPLIFY_RECALL_H

#include "geom/bvh.h"

/* A result's triangles and which of them are near enough to the input. Zero is the empty one. */
typedef struct simplify_recall {
    double *points; /* 9 a triangle */
    uint8_t *good;
    uint32_t *slots; /* open addressing: places by the hash of points, HEWN_NONE is free */
    uint64_t count, slot_count;
} simplify_recall;

/* Takes the place of what was remembered; `far` is not 0 where a triangle is not good. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_remember(simplify_recall *recall, const hewn_triangle_view *triangles, const uint8_t *far,
                                   hewn_error *error);
void hewn_simplify_forget(simplify_recall *recall);

/* Marks in `known` the triangles that are remembered as good. */
void hewn_simplify_recall(const simplify_recall *recall, const hewn_triangle_view *triangles, uint8_t *known);

/* Takes out of `known`, one a triangle of `from`, those that have a point within `reach` of a remembered triangle which
 * is not among `now`: what showed that they are near may be gone. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_recall_near(const simplify_recall *recall, const hewn_triangle_view *now,
                                      const hewn_triangle_view *from, double reach, uint8_t *known, hewn_error *error);

#endif
