/* Outlines as curves: what a font says, and what is left of it where shapes overlap. */
#ifndef HEWN_SRC_FONT_OUTLINE_H
#define HEWN_SRC_FONT_OUTLINE_H

#include "font/bezier.h"
#include "font/font.h"

/* Closed contours, one after another. Zero is the empty one. */
typedef struct hewn_glyph_outline {
    hewn_bezier *curves;
    size_t count, room;
    size_t *ends; /* of each contour: one past its last curve */
    size_t contours, contour_room;
} hewn_glyph_outline;

/* The curves of a glyph as the font has them, in its units; those of no length are left out. `ends` stays empty. The
 * errors of hewn_font_walk(). */
hewn_result hewn_glyph_outline_read(hewn_font *font, uint32_t glyph, hewn_glyph_outline *out, hewn_error *error);

/* Replaces the curves of hewn_glyph_outline_read() by the border of what they wind around (the nonzero rule), the
 * inside on the left of each curve, the end of each the very point that the next begins with. What meets where is
 * decided exactly, for chords that are off by less than an 8,000th of the em; what is left of a curve is a part of that
 * curve, and ends where the curves meet. Curves shorter than that are left out. `grid` and `units` are the font's.
 * HEWN_LIMIT for an outline that is too involved or reaches too far, HEWN_OUT_OF_MEMORY. May run in several threads. */
hewn_result hewn_glyph_outline_resolve(hewn_glyph_outline *outline, double grid, double units, hewn_error *error);

void hewn_glyph_outline_clear(hewn_glyph_outline *outline);

#endif
