/* Generalised winding numbers of triangles about points: how often the surface goes around, a whole number where it is
 * closed, and in between where it has holes (Jacobson, Kavan and Sorkine-Hornung 2013, 'Robust inside-outside
 * segmentation using generalized winding numbers'). Far parts count as what their normals and first moments sum up to
 * (Barill and others 2018, 'Fast winding numbers for soups and clouds'); near triangles count with their solid angles
 * (van Oosterom and Strackee 1983). */
#ifndef HEWN_SRC_GEOM_WINDING_H
#define HEWN_SRC_GEOM_WINDING_H

#include "geom/bvh.h"

/* What the triangles under one block of a hierarchy are from afar. */
typedef struct hewn_winding_part {
    float centre[3], radius;
    float normal[3]; /* the sum of areas times normals */
    float moment[6]; /* of offsets from the centre times those: xx, yy, zz, and sums of xy, yz, zx both ways */
} hewn_winding_part;

/* Zero is the empty one. */
typedef struct hewn_winding {
    const hewn_bvh *bvh;
    const hewn_triangle_view *mesh;
    hewn_winding_part *level[HEWN_BVH_LEVELS]; /* one a block; all in one allocation, level[0]'s */
} hewn_winding;

/* For a hierarchy of that mesh; both must live as long. The same for any number of threads. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_winding_build(const hewn_bvh *bvh, const hewn_triangle_view *mesh, hewn_winding *out,
                               hewn_error *error);
void hewn_winding_free(hewn_winding *winding);

/* The winding number about a point: counter-clockwise triangles seen from outside count up. Off by a few hundredths at
 * the most where parts are far. */
double hewn_winding_number(const hewn_winding *winding, const double at[3]);

/* The same without short cuts, for tests. */
double hewn_winding_number_exactly(const hewn_triangle_view *mesh, const double at[3]);

#endif
