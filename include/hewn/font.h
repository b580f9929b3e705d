/* Fonts, and lines of text as fields. */
#ifndef HEWN_FONT_H
#define HEWN_FONT_H

#include "hewn/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A font file with outlines: TrueType or OpenType (.ttf, .otf, .ttc, .woff). Serves one thread at a time. */
typedef struct hewn_font hewn_font;

/* Reads a font file. `face` is which of a collection's fonts, from 0. HEWN_IO where the file cannot be read,
 * HEWN_BAD_INPUT where it is no such font, both naming the file; HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_font_open(const char *path, uint32_t face, hewn_font **out, hewn_error *error);

/* The same from memory, which is copied. */
HEWN_API hewn_result hewn_font_from_memory(const void *bytes, size_t length, uint32_t face, hewn_font **out,
                                           hewn_error *error);
HEWN_API void hewn_font_destroy(hewn_font **font);

/* Family and style, in UTF-8; valid as long as the font. */
HEWN_API const char *hewn_font_name(const hewn_font *font);

typedef enum hewn_align { HEWN_ALIGN_LEFT, HEWN_ALIGN_CENTER, HEWN_ALIGN_RIGHT } hewn_align;

/* What of the text lies at y = 0. The last three go by what is seen of it. */
typedef enum hewn_text_anchor {
    HEWN_TEXT_BASELINE, /* of the first line */
    HEWN_TEXT_TOP,
    HEWN_TEXT_MIDDLE,
    HEWN_TEXT_BOTTOM
} hewn_text_anchor;

typedef struct hewn_text_desc {
    double size;      /* of the em, in scene units: about the distance between lines; capitals are about 0.7 of it */
    hewn_align align; /* of each line, at x = 0 */
    hewn_text_anchor anchor;
    double spacing;      /* more between letters, scene units; below 0: less */
    double line_spacing; /* between baselines, of what the font says; 0 is 1 */
    bool no_kerning;
} hewn_text_desc;

/* A flat shape (hewn/field.h): text in UTF-8, "\n" begins a line. Letters and their places are what HarfBuzz makes of a
 * line: kerning (GPOS or kern), ligatures, marks; each line is of one script and direction. Outlines are filled by the
 * nonzero rule, whatever overlaps in or between letters; the values are exact distances to them, curves off by less
 * than a 4,000th of the em. The field refuses text that is not UTF-8, has no outline or characters that the font lacks.
 */
HEWN_API hewn_node hewn_font_text(hewn_field *field, hewn_font *font, const char *text, const hewn_text_desc *desc);

/* Lengths of a font in ems, upward. */
typedef struct hewn_font_metrics {
    double line_height;         /* between baselines */
    double ascender, descender; /* above the baseline; a descender is mostly below 0 */
    double underline_y, underline_thickness;
} hewn_font_metrics;

/* What the font file says of all its letters; cannot fail. */
HEWN_API void hewn_font_measure(const hewn_font *font, hewn_font_metrics *out);

/* How much nearer to the first one (below 0) than its advance the second of two characters comes. */
typedef struct hewn_kerning {
    uint32_t first, second;
    double advance; /* ems */
} hewn_kerning;

#ifdef __cplusplus
}
#endif
#endif
