/* One letter of an atlas: its texels. */
#ifndef HEWN_SRC_ATLAS_GLYPH_H
#define HEWN_SRC_ATLAS_GLYPH_H

#include "atlas/nearest.h"
#include "hewn/atlas.h"

/* Where texels go. */
typedef struct hewn_texels {
    uint32_t width, height, channels;
    uint8_t *first; /* of the highest row */
    size_t stride;  /* bytes from row to row */
} hewn_texels;

/* Fills the texels with distances to a shape, whose units are texels from the lower left corner of the lowest one;
 * `*softened` receives how many texels lost their colours. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_glyph_draw(const hewn_shape *shape, hewn_atlas_type type, double range, const hewn_texels *texels,
                            size_t *softened, hewn_error *error);

/* What correct.c is given: the letter's texels, the highest row first. */
typedef struct hewn_drawn {
    uint32_t width, height;
    double range;
    uint8_t (*texels)[4]; /* the three distances and the plain one */
    double *distances;    /* the plain one, in texels */
} hewn_drawn;

/* A distance as a texel holds it. */
uint8_t hewn_texel_of(double distance, double range);

/* Where the middle one of three distances, interpolated between four texels, is on the wrong side of the outline by
 * more than plain distances would be, the four texels get the plain one for all three; `*count` receives how
 * many did. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_drawn_soften(const hewn_shape *shape, hewn_drawn *drawn, size_t *count, hewn_error *error);

#endif
