/* Values of one level from those of the one before, and limits. Values are `width` doubles a vertex. */
#ifndef HEWN_SRC_SUBDIVIDE_POINTS_H
#define HEWN_SRC_SUBDIVIDE_POINTS_H

#include "subdivide/level.h"

/* What a scheme does with a level's values. */
typedef struct sub_masks {
    hewn_scheme scheme;
    hewn_creasing creasing;
    bool linear; /* nothing is smoothed, as always with BILINEAR */
} sub_masks;

/* `in` are those of `level`, `out` those of the level after it, all vertices of which are written. */
void hewn_sub_points(const sub_level *level, sub_masks masks, const double *in, uint32_t width, double *out);

/* Where the vertices of a level end up. All its faces must have four corners, three with Loop's scheme; it must have
 * edges. */
void hewn_sub_limits(const sub_level *level, sub_masks masks, const double *in, uint32_t width, double *out);

/* Two tangents of the limit surface at a vertex, three components each; their cross product points outward. */
void hewn_sub_tangents(const sub_level *level, sub_masks masks, const double *in, uint32_t v, double t[2][3]);

#endif
