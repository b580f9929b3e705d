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

/* Other colours of which the same holds, but that a contour without corners may have two of the three; 0 is what
 * hewn_shape_create() gives, other numbers any that have nothing to do with each other. Which of them is best depends
 * on what lies close together: the two sides of a thin stroke are told apart only where they differ. */
void hewn_shape_recolour(hewn_shape *shape, uint32_t number);

#endif
