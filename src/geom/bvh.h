/* A hierarchy of boxes over triangles, for searches. Four children a node, laid out level by level without pointers:
 * block b of a level holds the boxes of blocks 4b to 4b + 3 of the level below, and on level 0 those of the triangles
 * in slots 4b to 4b + 3. Ranges are halved about their median along the longest side, so depth and time do not depend
 * on where the triangles are: O(n log n), 52 bytes a triangle while building, 36 after. The same for any number of
 * threads. */
#ifndef HEWN_SRC_GEOM_BVH_H
#define HEWN_SRC_GEOM_BVH_H

#include <math.h>
#include <stdbool.h>

#include "base/clones.h"
#include "geom/triangle_view.h"
#include "hewn/base.h"

/* Four boxes side by side, closed, rounded outward (to infinity beyond the floats). A slot without one holds NaNs. */
typedef struct hewn_boxes4 {
    float lo[3][4], hi[3][4];
} hewn_boxes4;

enum { HEWN_BVH_LEVELS = 16 }; /* 4^16 triangles */

typedef struct hewn_bvh {
    uint32_t *order; /* triangle in each slot; triangle_count, then the last one again to fill the block */
    uint32_t level_count;
    uint64_t block_count[HEWN_BVH_LEVELS];
    hewn_boxes4 *level[HEWN_BVH_LEVELS]; /* all in one allocation, level[0]'s; the last level has one block */
} hewn_bvh;

/* The box of one triangle, as the hierarchy holds it. */
void hewn_triangle_box(const hewn_triangle_view *mesh, uint32_t triangle, float lo[3], float hi[3]);

/* Builds the hierarchy; indices must be in range, positions finite, triangles at least 1 and below 2^32.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_bvh_build(const hewn_triangle_view *mesh, hewn_bvh *out, hewn_error *error);

/* The same for triangles in an order in which neighbours are mostly near each other, which takes a fraction of the
 * time; searches take somewhat more. `order` names each triangle once and has room for three more; it is the
 * hierarchy's from then on, also where this fails. */
hewn_result hewn_bvh_build_along(const hewn_triangle_view *mesh, uint32_t *order, hewn_bvh *out, hewn_error *error);
void hewn_bvh_free(hewn_bvh *bvh);

/* A walk over the blocks of level 0 that may hold a triangle whose box meets a box. Begin with hewn_bvh_walk_begin();
 * blocks before `first` are left out. Blocks come in ascending order. */
typedef struct hewn_bvh_walk {
    const hewn_bvh *bvh;
    float lo[3], hi[3];
    uint64_t first;
    uint32_t depth;
    struct {
        uint64_t block;
        uint32_t level;
    } stack[3 * HEWN_BVH_LEVELS + 1];
} hewn_bvh_walk;

hewn_bvh_walk hewn_bvh_walk_begin(const hewn_bvh *bvh, const float lo[3], const float hi[3], uint64_t first);
bool hewn_bvh_walk_next(hewn_bvh_walk *walk, uint64_t *block);

/* The box around all four. */
static inline void hewn_boxes4_all(const hewn_boxes4 *boxes, float lo[3], float hi[3])
{
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = INFINITY;
        hi[axis] = -INFINITY;
        for (int k = 0; k < 4; k++) { /* never true of NaNs */
            lo[axis] = boxes->lo[axis][k] < lo[axis] ? boxes->lo[axis][k] : lo[axis];
            hi[axis] = boxes->hi[axis][k] > hi[axis] ? boxes->hi[axis][k] : hi[axis];
        }
    }
}

/* Which of four closed boxes meet a closed box, one bit each. */
static inline unsigned hewn_boxes4_meet(const hewn_boxes4 *boxes, const float lo[3], const float hi[3])
{
    typedef int32_t four __attribute__((vector_size(16)));
    typedef float quad __attribute__((vector_size(16)));
    four meets = {-1, -1, -1, -1};
    for (int axis = 0; axis < 3; axis++) {
        const float *box_lo = boxes->lo[axis], *box_hi = boxes->hi[axis];
        quad los = {box_lo[0], box_lo[1], box_lo[2], box_lo[3]}, his = {box_hi[0], box_hi[1], box_hi[2], box_hi[3]};
        quad query_lo = {lo[axis], lo[axis], lo[axis], lo[axis]}, query_hi = {hi[axis], hi[axis], hi[axis], hi[axis]};
        meets &= (los <= query_hi) & (his >= query_lo);
    }
    meets &= (four){1, 2, 4, 8};
    return (unsigned)(meets[0] | meets[1] | meets[2] | meets[3]);
}

/* Squared distances to four boxes; of slots without one infinite. */
static HEWN_INTO_CLONES void hewn_boxes4_squares(const hewn_boxes4 *boxes, const double at[3], double out[4])
{
    typedef float quad __attribute__((vector_size(16), aligned(4)));
    typedef double four __attribute__((vector_size(32), aligned(8)));
    typedef int64_t bits __attribute__((vector_size(32)));
    four sum = {0};
    bits full = {0};
    for (int axis = 0; axis < 3; axis++) {
        const four lo = __builtin_convertvector(*(const quad *)boxes->lo[axis], four);
        const four hi = __builtin_convertvector(*(const quad *)boxes->hi[axis], four);
        const four under = lo - at[axis], over = at[axis] - hi;
        const bits low = under > over;
        four gap = (four)(((bits)under & low) | ((bits)over & ~low));
        gap = (four)((bits)gap & (gap > 0));
        sum += gap * gap;
        full = axis == 0 ? lo <= hi : full;
    }
    *(four *)out = (four)(((bits)sum & full) | ((bits)(INFINITY + (four){0}) & ~full));
}

/* The least of four; the first of those. */
static inline int hewn_least_of4(const double value[4])
{
    const int one = value[1] < value[0] ? 1 : 0, two = value[3] < value[2] ? 3 : 2;
    return value[two] < value[one] ? two : one;
}

#endif
