/* The inside of a hewn_font. */
#ifndef HEWN_SRC_FONT_FONT_H
#define HEWN_SRC_FONT_FONT_H

#include <ft2build.h>
#include <hb.h>
#include FT_FREETYPE_H

#include "font/curves.h"
#include "hewn/font.h"

struct hewn_font {
    FT_Library library;
    FT_Face face;
    hb_font_t *shaper; /* its units are those of the font */
    char *bytes;
    char name[256];
    double units; /* of the font to the em */
    double grid;  /* steps of the grid to a unit: a power of two */
};

/* One curve of an outline: a Bezier curve of degree 1 to 3, by degree + 1 points. */
typedef hewn_result hewn_take_curve(void *user, unsigned degree, const double (*points)[2], hewn_error *error);

/* Hands on the curves of a glyph's outline, closed contours one after another, times `scale` and moved by `move`; a
 * contour may end with a curve of no length. Where the glyph has no outline nothing is handed on. HEWN_BAD_INPUT where
 * the font's data are bad; what `take` returns. */
hewn_result hewn_font_walk(hewn_font *font, uint32_t glyph, double scale, const double move[2], hewn_take_curve *take,
                           void *user, hewn_error *error);

/* Adds a glyph's outline to `sides`, moved by (x, y) steps of the grid. Where the glyph has none nothing is added.
 * HEWN_BAD_INPUT where the font's data are bad. */
hewn_result hewn_font_add_glyph(hewn_font *font, uint32_t glyph, int64_t x, int64_t y, hewn_grid_sides *sides,
                                hewn_error *error);

/* The glyph that stands for a character alone; 0 where the font has none. */
uint32_t hewn_font_glyph(const hewn_font *font, uint32_t character);

/* How far the next letter is, in ems. */
double hewn_font_advance(const hewn_font *font, uint32_t glyph);

/* The characters (Unicode code points) that a font has, ascending; owned by the caller (hewn_free).
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_font_characters(const hewn_font *font, uint32_t **out, size_t *count, hewn_error *error);

/* All pairs of `count` characters that are kerned, in their order, by what HarfBuzz makes of each two beside one
 * another from left to right (GPOS or kern); owned by the caller as above. The stage of `progress` (or NULL) is
 * "kerning". HEWN_CANCELLED, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_font_kerning(hewn_font *font, const uint32_t *characters, size_t count, const hewn_progress *progress,
                              hewn_kerning **out, size_t *pairs, hewn_error *error);

/* Takes the closed polygons of exact borders apart: `points` one after another, `counts` how many each has. Both are
 * the caller's (hewn_free). */
typedef struct hewn_grid_loops {
    hewn_grid_point *points;
    size_t *counts;
    size_t point_count, count;
} hewn_grid_loops;

hewn_result hewn_grid_loops_create(const hewn_grid_sides *borders, hewn_grid_loops *out, hewn_error *error);
void hewn_grid_loops_destroy(hewn_grid_loops *loops);

#endif
