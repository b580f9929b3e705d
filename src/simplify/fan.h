/* Triangles around one place, as they would be with a vertex there, and which of them is nearest to points: four points
 * at a time. All is relative to the place. */
#ifndef HEWN_SRC_SIMPLIFY_FAN_H
#define HEWN_SRC_SIMPLIFY_FAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hewn/base.h"

enum { SIMPLIFY_FOUR = 4 };

#define SIMPLIFY_NOWHERE 0xFFFFFFFFu

/* Each has the place and two more corners, p and q; what is left over in the last block is like its last one. Vectors
 * outward, of any length, across the sides from the place to p, from p to q and from q to the place; then the normal.
 * Without area it is beyond all sides. */
typedef struct simplify_fan_block {
    double p[3][SIMPLIFY_FOUR], q[3][SIMPLIFY_FOUR];
    double across[4][3][SIMPLIFY_FOUR];
    double inverse[4][SIMPLIFY_FOUR]; /* of squared lengths; 0: without area */
    double offset[SIMPLIFY_FOUR];     /* of the side from p to q */
    uint32_t face[SIMPLIFY_FOUR];
} simplify_fan_block;

/* Zero is an empty one; arrays grow and are used again. */
typedef struct simplify_fan {
    uint32_t count; /* of triangles */
    simplify_fan_block *blocks;
    double *least, *beyond; /* of four points: no distance is less; how far they are out of the triangle */
    size_t capacity, least_capacity, beyond_capacity;
} simplify_fan;

typedef struct simplify_fan_point {
    double at[3], square; /* distance to the nearest triangle */
    uint32_t near;        /* that triangle's number in the fan; SIMPLIFY_NOWHERE: it is to be found */
    uint32_t sample;      /* the caller's */
} simplify_fan_point;

/* Places to which the nearest of some points are to be found. */
typedef struct simplify_mark_block {
    double at[3][SIMPLIFY_FOUR], square[SIMPLIFY_FOUR];
    int64_t nearest[SIMPLIFY_FOUR]; /* a point's number */
} simplify_mark_block;

void hewn_simplify_fan_release(simplify_fan *fan);

/* HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_fan_add(simplify_fan *fan, uint32_t face, const double p[3], const double q[3]);

/* Once all are there. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_fan_settle(simplify_fan *fan);

/* The nearest triangle of each point that is nowhere. There must be one. */
void hewn_simplify_fan_nearest(const simplify_fan *fan, simplify_fan_point *points, size_t count);

/* Whether a triangle is at a squared distance of at most `most`: then what hewn_simplify_fan_nearest() finds is no more
 * than that, to the bit. False where the two are as good as equal. */
bool hewn_simplify_fan_is_within(const simplify_fan *fan, uint32_t face, const double at[3], double most);

/* The nearest point of each mark; the first of those that are as near. There must be one. */
void hewn_simplify_find_marks(const simplify_fan_point *points, size_t count, simplify_mark_block *marks,
                              size_t blocks);

/* One of four vectors, of a block's arrays from the first of three on. */
static inline void simplify_fan_vector(const double *from, uint32_t lane, double out[3])
{
    for (uint32_t axis = 0; axis < 3; axis++)
        out[axis] = from[axis * SIMPLIFY_FOUR + lane];
}

#endif
