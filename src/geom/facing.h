/* Where the triangles under each block of a hierarchy face, so that those that face away from a direction are found
 * without looking at all that are near. */
#ifndef HEWN_SRC_GEOM_FACING_H
#define HEWN_SRC_GEOM_FACING_H

#include "geom/bvh.h"

/* Boxes of unit normals, of the blocks below as a hierarchy's boxes are; there are none on level 0. About 8 bytes a
 * triangle. */
typedef struct hewn_facing {
    hewn_boxes4 *level[HEWN_BVH_LEVELS]; /* all in one allocation, level[1]'s */
} hewn_facing;

/* HEWN_OUT_OF_MEMORY. */
hewn_result hewn_facing_build(const hewn_bvh *bvh, const hewn_triangle_view *mesh, hewn_facing *out, hewn_error *error);
void hewn_facing_free(hewn_facing *facing);

/* The triangle's area vector, doubled. */
void hewn_triangle_normal(const hewn_triangle_view *mesh, uint32_t triangle, double out[3]);

/* Triangles are as near as the nearest one up to this share of the distance. */
#define HEWN_AS_NEAR 1e-6

/* Whether the triangle nearest to a point faces away from a direction, and all that are as near do, as far as can be
 * told without finding it: all that are as near as some face like the guess. */
typedef enum hewn_side { HEWN_SIDE_ALONG, HEWN_SIDE_AWAY, HEWN_SIDE_UNSURE } hewn_side;
hewn_side hewn_bvh_nearest_side(const hewn_bvh *bvh, const hewn_facing *facing, const hewn_triangle_view *mesh,
                                const double at[3], uint32_t guess, const double direction[3]);

#endif
