/* An outline as coloured edges, and which of them are nearest to a point. */
#ifndef HEWN_SRC_ATLAS_NEAREST_H
#define HEWN_SRC_ATLAS_NEAREST_H

#include "font/outline.h"

/* Colours: which of the three distances an edge counts for; or them together. */
enum { HEWN_RED = 1, HEWN_GREEN = 2, HEWN_BLUE = 4, HEWN_WHITE = 7 };

typedef struct hewn_edge {
    hewn_bezier curve;
    unsigned colour;
    bool begins; /* at a corner */
    double lo[2], hi[2];
    double powers[4][2]; /* of the curve, and of its derivative */
    double slope[3][2];
    double itself[6];  /* curve times derivative, whose sum with -p times derivative is 0 where p is nearest */
    double ends[2][2]; /* unit directions */
    unsigned turns;    /* how often it turns up or down between its ends, where, and how high it is there: turn 0 and
                          turn `turns` + 1 are its ends */
    double turn[4], height[4];
} hewn_edge;

/* Edges have the inside on their left. */
typedef struct hewn_shape {
    hewn_edge *edges;
    size_t count;
    size_t *ends; /* of each contour, one past its last edge */
    size_t contours;
} hewn_shape;

/* The place of an edge that is nearest to a point. */
typedef struct hewn_near {
    double distance; /* not below 0 */
    double skew;     /* of an end: cosine of the angle between the edge and the way to the point; 0 within an edge. Of
                        two edges with the same end it tells which one the point belongs to */
    double t;
    const hewn_edge *edge;
} hewn_near;

/* Fills in what hewn_shape_nearest() needs of an edge whose curve is set. */
void hewn_edge_prepare(hewn_edge *edge);

/* What is nearest to a point: `near[k]` of the edges of colour 1 << k, near[3] of all. Their distances say what is
 * known already not to be exceeded (or infinity), and their edges are NULL. */
void hewn_shape_nearest(const hewn_shape *shape, const double p[2], hewn_near near[4]);

/* Whether a point is inside: whether edges wind around it, whatever is near. */
bool hewn_shape_holds(const hewn_shape *shape, const double p[2]);

/* The distance to the edge continued straight beyond its ends, above 0 on its left. */
double hewn_near_straight(const hewn_near *near, const double p[2]);

/* The distance to all of a shape, which is not more than `most`; above 0 inside. */
double hewn_shape_distance(const hewn_shape *shape, const double p[2], double most);

#endif
