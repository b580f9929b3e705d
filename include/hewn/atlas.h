/* Glyph atlases: the letters of a font as distances in one image, from which a shader draws them sharp at any size. */
#ifndef HEWN_ATLAS_H
#define HEWN_ATLAS_H

#include "hewn/font.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a texel holds: distances to the outline, above one half inside. */
typedef enum hewn_atlas_type {
    HEWN_ATLAS_MSDF, /* three, to the sides of the outline by their colour and as far as these go on straight: the
                        middle one of them keeps corners sharp (Chlumsky 2015) */
    HEWN_ATLAS_SDF,  /* one: the distance */
    HEWN_ATLAS_PSDF, /* one: that to the nearest side, as far as it goes on straight */
    HEWN_ATLAS_MTSDF /* the three of MSDF, and the distance */
} hewn_atlas_type;

/* "msdf", "sdf", "psdf", "mtsdf"; false for any other name. */
HEWN_API bool hewn_atlas_type_named(const char *name, hewn_atlas_type *out);

/* The same name; "unknown" for what is none of the above. A constant. */
HEWN_API const char *hewn_atlas_type_name(hewn_atlas_type type);

/* Zero everywhere but the characters is a sensible default. */
typedef struct hewn_atlas_desc {
    hewn_atlas_type type;
    double size;                /* of the em, in texels; 0: 32 */
    double range;               /* texels from the lowest distance to the highest that a texel can hold; 0: 4 */
    const uint32_t *characters; /* code points, at most 0x10FFFF; may repeat */
    size_t character_count;
    uint32_t width, height; /* of the image; 0: the smallest square that was found whose side is a multiple of 4 */
    bool power_of_two;      /* where they are 0: the smallest square whose side is a power of two */
    double corner;          /* degrees by which an outline turns at a corner, at least; 0: 8; below 180 */
    bool no_kerning;
    const hewn_progress *progress; /* or NULL; the stages are "kerning" and "atlas" */
} hewn_atlas_desc;

typedef struct hewn_atlas_glyph {
    uint32_t character;
    double advance;  /* to the next letter, ems */
    bool seen;       /* it has an outline; else what follows is 0 */
    double plane[4]; /* left, bottom, right, top of the rectangle to draw, in ems from the letter's origin, y upward:
                        the middles of the outermost texels */
    uint32_t x, y, width, height; /* its texels; y counts from the image's top. Glyphs of the same outline share them */
} hewn_atlas_glyph;

/* Owned by whoever holds the struct; leave it with hewn_atlas_destroy(). Zero is the empty one. */
typedef struct hewn_atlas {
    hewn_atlas_type type;
    double size, range;
    uint32_t width, height, channels; /* 1, 3 or 4 */
    uint8_t *texels;                  /* rows from the top; 255 times distance / range + 1/2, rounded, 0 to 255 */
    hewn_font_metrics metrics;
    hewn_atlas_glyph *glyphs; /* by character */
    size_t glyph_count;
    uint32_t *missing; /* characters that the font lacks */
    size_t missing_count;
    hewn_kerning *kerning; /* by first, then second character; pairs without are left out */
    size_t kerning_count;
    size_t softened; /* texels of msdf and mtsdf whose three distances were made one, because between texels their
                        middle would have shown sides that are not there */
} hewn_atlas;

/* Makes an atlas. Outlines are filled by the nonzero rule. The same bytes for the same font and description, for any
 * number of threads. HEWN_INVALID_ARGUMENT for a description that makes no sense; HEWN_BAD_INPUT where the font has
 * none of the characters, or bad data; HEWN_LIMIT for an image that glyphs do not fit in, or of more than 16,384 texels
 * a side, and for outlines that are too involved; HEWN_CANCELLED, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_atlas_create(hewn_font *font, const hewn_atlas_desc *desc, hewn_atlas *out,
                                       hewn_error *error);
HEWN_API void hewn_atlas_destroy(hewn_atlas *atlas);

#ifdef __cplusplus
}
#endif
#endif
