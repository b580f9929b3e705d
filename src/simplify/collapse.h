/* One edge becoming a vertex: what it costs, whether it may, and doing it. */
#ifndef HEWN_SRC_SIMPLIFY_COLLAPSE_H
#define HEWN_SRC_SIMPLIFY_COLLAPSE_H

#include "simplify/work.h"

/* What a collapse would do: `gone` joins `kept`, which moves to `at`. */
typedef struct simplify_plan {
    uint32_t half; /* an edge's name */
    uint32_t gone, kept;
    double at[3];
    double cost; /* infinite where ranks do not allow it */
    bool far;    /* past the largest error */
    bool slim;   /* a triangle would become a sliver and was none; hewn_simplify_allowed() tells */
} simplify_plan;

/* What the collapse of an edge would be by its quadrics and ranks alone. */
simplify_plan hewn_simplify_plan(const simplify_work *work, uint32_t half);

/* Whether the result stays manifold, of the same topology, and no triangle turns over or folds. */
bool hewn_simplify_allowed(const simplify_work *work, simplify_plan *plan);

/* Whether a vertex may go elsewhere by itself: no triangle around it turns over, away or into a sliver. */
bool hewn_simplify_may_move(const simplify_work *work, uint32_t v, const double to[3]);

/* An edge where fans of a complex meet is there once for each of them: a half-edge of it, and its ends there. */
typedef struct simplify_side {
    uint32_t half, gone, kept;
} simplify_side;

/* All that become one with the edge of a plan; 1 where its vertex that goes is not tied. 0: the fans do not agree. */
uint32_t hewn_simplify_sides(const simplify_work *work, const simplify_plan *plan,
                             simplify_side sides[SIMPLIFY_MOST_TIED]);

/* Does it. Keys around `kept` become lower bounds. Returns how many triangles are gone. */
uint32_t hewn_simplify_collapse(simplify_work *work, const simplify_plan *plan);

#endif
