/* Outlines as polygons on a grid of whole numbers, where decisions are exact. */
#ifndef HEWN_SRC_FONT_CURVES_H
#define HEWN_SRC_FONT_CURVES_H

#include "hewn/base.h"

typedef struct hewn_grid_point {
    int64_t x, y;
} hewn_grid_point;

/* Coordinates stay below this, so that products of twice their differences fit. */
#define HEWN_GRID_MOST ((int64_t)1 << 27)

/* A directed side; `winding` says how often it counts. */
typedef struct hewn_side_on_grid {
    hewn_grid_point a, b;
    int64_t winding;
    uint32_t tag; /* where it comes from; its parts keep that */
} hewn_grid_side;

typedef struct hewn_grid_sides {
    hewn_grid_side *items;
    size_t count, room;
    uint32_t tag; /* of sides that are added */
} hewn_grid_sides;

/* Above 0 where c lies left of the line from a to b. */
static inline int64_t hewn_grid_turn(hewn_grid_point a, hewn_grid_point b, hewn_grid_point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static inline bool hewn_grid_same(hewn_grid_point a, hewn_grid_point b)
{
    return a.x == b.x && a.y == b.y;
}

/* Adds a side; one of no length is left out. HEWN_LIMIT for a coordinate too far out, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_grid_add(hewn_grid_sides *sides, hewn_grid_point a, hewn_grid_point b, hewn_error *error);

/* Adds chords of a Bezier curve of degree 1 to 3, given by degree + 1 points in grid units, each within `off` of it:
 * equal parts of its parameter. `tag` is one more for each chord, also for those that have no length. */
hewn_result hewn_grid_add_curve(hewn_grid_sides *sides, unsigned degree, const double (*points)[2], double off,
                                hewn_error *error);

void hewn_grid_sides_clear(hewn_grid_sides *sides);

/* The sides between where the closed polygons that `sides` make wind around a point and where they do not (the nonzero
 * rule), as sides that meet at ends alone, the inside on their left; `sides` is replaced by them. Polygons are closed:
 * as many sides leave each point as come in. Where two sides cross they are bent to the nearest point of the grid.
 * HEWN_LIMIT for more than `most` sides, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_grid_nonzero(hewn_grid_sides *sides, size_t most, hewn_error *error);

#endif
