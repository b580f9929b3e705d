/* Sets of characters, from names, text and files. */
#ifndef HEWN_SRC_ATLAS_CHARSET_H
#define HEWN_SRC_ATLAS_CHARSET_H

#include "font/font.h"

/* Code points in any order, some perhaps twice. Zero is the empty set. */
typedef struct hewn_charset {
    uint32_t *items;
    size_t count, room;
} hewn_charset;

/* "ascii" (U+0020 to U+007E), "latin1" (that, and U+00A0 to U+00FF) or "all" (what the font has). `*known` tells
 * whether the name is one of these. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_charset_add_named(hewn_charset *set, const char *name, const hewn_font *font, bool *known,
                                   hewn_error *error);

/* All characters of a text but control characters. HEWN_BAD_INPUT where it is not UTF-8, with the byte's place. */
hewn_result hewn_charset_add_text(hewn_charset *set, const char *text, hewn_error *error);

/* What a description of a set names, as msdf-atlas-gen takes them: numbers (decimal, or hexadecimal with 0x), single
 * characters in '…' and strings in "…", both with \ before what would end them, and ranges of two of these in
 * [ , ]; separated by commas or blanks. HEWN_BAD_INPUT with the line. */
hewn_result hewn_charset_add_description(hewn_charset *set, const char *text, hewn_error *error);

void hewn_charset_clear(hewn_charset *set);

#endif
