/* Walking through text in memory, word by word, knowing the line. */
#ifndef HEWN_SRC_IO_SCAN_H
#define HEWN_SRC_IO_SCAN_H

#include "hewn/base.h"

typedef struct hewn_scan {
    const char *at, *end;
    const char *name; /* of the file, for messages */
    uint32_t line;    /* of `at`, 1-based */
} hewn_scan;

typedef struct hewn_word {
    const char *begin, *end; /* empty: there was none */
} hewn_word;

/* Past blanks inside a line. A backslash before a line's end continues the line. */
void hewn_scan_blanks(hewn_scan *scan);

/* Past blanks and line ends. */
void hewn_scan_space(hewn_scan *scan);

/* Past the end of this line. */
void hewn_scan_line(hewn_scan *scan);

/* The next word of this line, or of the text. */
hewn_word hewn_scan_word_in_line(hewn_scan *scan);
hewn_word hewn_scan_word(hewn_scan *scan);

bool hewn_word_is(hewn_word word, const char *text);          /* exactly */
bool hewn_word_is_any_case(hewn_word word, const char *text); /* ASCII letters of either case */
bool hewn_word_float(hewn_word word, float *out);             /* the whole word is a number */
bool hewn_word_double(hewn_word word, double *out);
bool hewn_word_integer(hewn_word word, int64_t *out);

/* HEWN_BAD_INPUT at this line: "`what`, but there is "WORD"", or "... but the file ends" for an empty word. */
hewn_result hewn_scan_fail(const hewn_scan *scan, hewn_word word, const char *what, hewn_error *error);

#endif
