/* Sets of characters, from names, text and files. */
#ifndef HEWN_SRC_ATLAS_CHARSET_H
#define HEWN_SRC_ATLAS_CHARSET_H

#include "font/font.h"

#define HEWN_CHARACTER_MOST 0x10FFFFu

/* A bit a code point, so that it takes the same memory however often each is added. Zero is the empty set. */
typedef struct hewn_charset {
    uint32_t *bits; /* NULL where nothing was added */
    size_t count;
} hewn_charset;

/* All characters from one to another, at most HEWN_CHARACTER_MOST. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_charset_add(hewn_charset *set, uint32_t first, uint32_t last, hewn_error *error);

/* The `count` characters of the set, rising; whoever calls frees them. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_charset_list(const hewn_charset *set, uint32_t **out, hewn_error *error);

/* "ascii" (U+0020 to U+007E), "latin1" (that, and U+00A0 to U+00FF) or "all" (what the font has). `*known` tells
 * whether the name is one of these. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_charset_add_named(hewn_charset *set, const char *name, const hewn_font *font, bool *known,
                                   hewn_error *error);

/* All characters of a text but control characters. HEWN_BAD_INPUT where it is not UTF-8, with the byte's place;
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_charset_add_text(hewn_charset *set, const char *text, hewn_error *error);

/* What a description of a set names, as msdf-atlas-gen takes them: numbers (decimal, or hexadecimal with 0x), single
 * characters in '…' and strings in "…", both with \ before what would end them, and ranges of two of these in
 * [ , ]; separated by commas or blanks. HEWN_BAD_INPUT with the line, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_charset_add_description(hewn_charset *set, const char *text, hewn_error *error);

void hewn_charset_clear(hewn_charset *set);

#endif
