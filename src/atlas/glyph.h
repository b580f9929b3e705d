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
 * `*softened` receives how many texels lost their colours. Where some do, the shape's edges get the colours of several
 * that are tried with which the least is lost. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_glyph_draw(hewn_shape *shape, hewn_atlas_type type, double range, const hewn_texels *texels,
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
 * more than plain distances would be, the four texels get the plain one for all three, or, `gently`, their own middle
 * one first and that where it is still wrong; `*count` receives how many texels did. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_drawn_soften(const hewn_shape *shape, hewn_drawn *drawn, bool gently, size_t *count,
                              hewn_error *error);

/* What a letter would cover, in pixels of a quarter of a texel. */
typedef struct hewn_covered {
    uint32_t width, height; /* four times as many less one as there are texels */
    float *shares;          /* 0 to 1, the lowest row first */
} hewn_covered;

/* The middle one of a texel's three distances. */
uint8_t hewn_texel_middle(const uint8_t texel[4]);

/* What a shape covers of those pixels; and how much of them what is drawn covers wrongly, in texels. */
hewn_result hewn_shape_cover(const hewn_shape *shape, uint32_t width, uint32_t height, hewn_covered *out,
                             hewn_error *error);
double hewn_drawn_wrong(const hewn_drawn *drawn, const hewn_covered *covered);

#endif
