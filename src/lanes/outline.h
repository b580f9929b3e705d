/* Outlines of polygons as one step: the sides that can be nearest somewhere in a box, and what the others do to the
 * parity of crossings there. */
#ifndef HEWN_SRC_LANES_OUTLINE_H
#define HEWN_SRC_LANES_OUTLINE_H

#include "lanes/tape.h"

/* The outline that a node is, of all its sides, its arrays the caller's (hewn_lane_outline_free). NULL sides and
 * HEWN_OK where its chain of links is none that this can tell. */
hewn_result hewn_lane_outline_read(const hewn_field *field, const hewn_node_data *node, hewn_lane_outline *out,
                                   hewn_error *error);
void hewn_lane_outline_free(hewn_lane_outline *outline);

/* Copies of outlines with their arrays, all in one block that starts with the first one (hewn_free); NULL when out of
 * memory. */
hewn_lane_outline *hewn_lane_outlines_pack(const hewn_lane_outline *outlines, uint32_t count);

/* Room for what all outlines of a tape, or one cut from it, may be cut down to: an outline each, and from the first
 * one's arrays on as many sides as there are and twice as many turns. In one block; NULL when out of memory. */
hewn_lane_outline *hewn_lane_outlines_room(const hewn_lane_tape *whole);

/* Distances, below 0 inside, in float; a whole number of blocks of points. */
void hewn_lane_outline_value(const hewn_lane_outline *outline, const float *x, const float *y, float *out,
                             uint32_t count);

/* Bounds of these in boxes: rows of lower and of upper ends of x and y. Where a box is not finite they are not. */
void hewn_lane_outline_bound(const hewn_lane_outline *outline, const float *const x[2], const float *const y[2],
                             float *lo, float *hi, uint32_t count);

/* The distance at a point, and the unit vector that it grows along; (0, 0) on the outline's corners. */
float hewn_lane_outline_gradient(const hewn_lane_outline *outline, float x, float y, float away[2]);

/* What of an outline matters in a finite box of x and y: it gives the same bits there. `out` has room for as many sides
 * as `from`, and for twice as many turns as that and `from`'s; `scratch` for as many numbers as `from` has sides. */
void hewn_lane_outline_pick(const hewn_lane_outline *from, const float lo[2], const float hi[2], double *scratch,
                            hewn_lane_outline *out);

#endif
