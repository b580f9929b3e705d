/* Walking through text in memory, word by word, knowing the line. A line ends with LF, CR or CR LF. */
#ifndef HEWN_SRC_IO_SCAN_H
#define HEWN_SRC_IO_SCAN_H

#include <string.h>

#include "hewn/base.h"

typedef struct hewn_scan {
    const char *at, *end;
    const char *name; /* of the file, for messages */
    uint32_t line;    /* of `at`, 1-based */
} hewn_scan;

typedef struct hewn_word {
    const char *begin, *end; /* empty: there was none */
} hewn_word;

static inline bool hewn_is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static inline bool hewn_is_line_end(char c)
{
    return c == '\n' || c == '\r';
}

/* The whole number at `at`, up to 2^32 - 1 either way, and what follows it; NULL where there is none. */
static inline const char *hewn_parse_index(const char *at, const char *end, int64_t *out)
{
    bool negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    const char *digits = at;
    int64_t value = 0;
    for (; at < end && *at >= '0' && *at <= '9' && value <= (int64_t)UINT32_MAX; at++)
        value = 10 * value + (*at - '0');
    *out = negative ? -value : value;
    return at > digits && value <= (int64_t)UINT32_MAX ? at : NULL;
}

/* At the beginning of a text: passes over the mark of UTF-8. HEWN_BAD_INPUT for UTF-16; `format` is the one expected.
 */
hewn_result hewn_scan_begin(hewn_scan *scan, const char *format, hewn_error *error);

/* Past blanks inside a line. A backslash before a line's end continues the line. */
void hewn_scan_blanks_and_lines(hewn_scan *scan);
static inline void hewn_scan_blanks(hewn_scan *scan)
{
    while (scan->at < scan->end && hewn_is_blank(*scan->at))
        scan->at++;
    if (scan->at < scan->end && *scan->at == '\\')
        hewn_scan_blanks_and_lines(scan);
}

/* Past blanks and line ends. */
void hewn_scan_space(hewn_scan *scan);

/* Past blanks, line ends and comments, which begin with # and go to the line's end. */
void hewn_scan_all_space(hewn_scan *scan);
static inline void hewn_scan_space_and_comments(hewn_scan *scan)
{
    if (scan->at < scan->end && *scan->at == ' ')
        scan->at++;
    if (scan->at < scan->end && (unsigned char)*scan->at <= '#') /* all blanks, line ends and # itself */
        hewn_scan_all_space(scan);
}

/* Past the end of this line. */
void hewn_scan_line(hewn_scan *scan);

/* Whether nothing but blanks and perhaps a comment is left in this line. */
static inline bool hewn_scan_line_is_done(hewn_scan *scan)
{
    hewn_scan_blanks(scan);
    return scan->at == scan->end || hewn_is_line_end(*scan->at) || *scan->at == '#';
}

/* The next word of this line, or of the text. */
hewn_word hewn_scan_word_in_line(hewn_scan *scan);
hewn_word hewn_scan_word(hewn_scan *scan);

/* Whether a word may end before `at`. */
static inline bool hewn_scan_ends_word(const hewn_scan *scan, const char *at)
{
    return at == scan->end || hewn_is_blank(*at) || hewn_is_line_end(*at) || *at == '#' || *at == '\\';
}

/* The number that is next in this line, all of its word but for a comment: false, and nothing passed but blanks, where
 * there is none. */
static inline bool hewn_scan_index_in_line(hewn_scan *scan, int64_t *out)
{
    hewn_scan_blanks(scan);
    const char *next = hewn_parse_index(scan->at, scan->end, out);
    bool good = next && hewn_scan_ends_word(scan, next);
    scan->at = good ? next : scan->at;
    return good;
}
bool hewn_scan_double_in_line(hewn_scan *scan, double *out);
bool hewn_scan_float_in_line(hewn_scan *scan, float *out);

/* Whether a word is exactly this, */
static inline bool hewn_word_is(hewn_word word, const char *text)
{
    size_t length = strlen(text);
    return (size_t)(word.end - word.begin) == length && memcmp(word.begin, text, length) == 0;
}
bool hewn_word_is_any_case(hewn_word word, const char *text); /* or with ASCII letters of either case, */
bool hewn_word_float(hewn_word word, float *out);             /* and whether all of it is a number */
bool hewn_word_double(hewn_word word, double *out);
bool hewn_word_integer(hewn_word word, int64_t *out);

/* HEWN_BAD_INPUT at this line: "`what`, but there is "WORD"", or "... but the file ends" for an empty word. */
hewn_result hewn_scan_fail(const hewn_scan *scan, hewn_word word, const char *what, hewn_error *error);

#endif
