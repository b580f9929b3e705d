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

/* Adds a glyph's outline to `sides`, moved by (x, y) steps of the grid. Where the glyph has none nothing is added.
 * HEWN_BAD_INPUT where the font's data are bad. */
hewn_result hewn_font_add_glyph(hewn_font *font, uint32_t glyph, int64_t x, int64_t y, hewn_grid_sides *sides,
                                hewn_error *error);

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
