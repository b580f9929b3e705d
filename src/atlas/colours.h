/* Which of the three distances each edge of an outline counts for. */
#ifndef HEWN_SRC_ATLAS_COLOURS_H
#define HEWN_SRC_ATLAS_COLOURS_H

#include "atlas/nearest.h"

/* The edges of an outline, its points times `scale` and then moved by `move`. Edges that meet at a corner (where the
 * outline turns by `corner` radians or more) have exactly one colour in common; a contour without one is white. Curves
 * of a contour with a single corner may be divided. Release with hewn_shape_clear(). HEWN_OUT_OF_MEMORY. */
hewn_result hewn_shape_create(const hewn_glyph_outline *outline, double scale, const double move[2], double corner,
                              hewn_shape *out, hewn_error *error);
void hewn_shape_clear(hewn_shape *shape);

#endif
