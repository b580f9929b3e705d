#include "io/scan.h"

#include <string.h>
#include <strings.h>

#include "base/error.h"
#include "io/shim/number.h"

/* How long the line end at `at` is; 0 where there is none. */
static size_t line_end(const char *at, const char *end)
{
    if (at >= end || !hewn_is_line_end(*at))
        return 0;
    return at[0] == '\r' && end - at >= 2 && at[1] == '\n' ? 2 : 1;
}

/* How long a backslash and the line end after it are; 0 where there is no such thing. */
static size_t continuation(const hewn_scan *scan)
{
    size_t length = scan->at < scan->end && *scan->at == '\\' ? line_end(scan->at + 1, scan->end) : 0;
    return length > 0 ? length + 1 : 0;
}

hewn_result hewn_scan_begin(hewn_scan *scan, const char *format, hewn_error *error)
{
    const unsigned char *at = (const unsigned char *)scan->at;
    size_t length = (size_t)(scan->end - scan->at);
    if (length >= 2 && ((at[0] == 0xfe && at[1] == 0xff) || (at[0] == 0xff && at[1] == 0xfe)))
        return hewn_fail_at(error, HEWN_BAD_INPUT, scan->name, 1, "the text is in UTF-16; %s files are in UTF-8",
                            format);
    if (length >= 3 && memcmp(at, "\xef\xbb\xbf", 3) == 0)
        scan->at += 3;
    return HEWN_OK;
}

void hewn_scan_blanks_and_lines(hewn_scan *scan)
{
    while (scan->at < scan->end) {
        size_t length = 0;
        if (hewn_is_blank(*scan->at)) {
            scan->at++;
        } else if ((length = continuation(scan)) > 0) {
            scan->at += length;
            scan->line++;
        } else {
            return;
        }
    }
}

void hewn_scan_space(hewn_scan *scan)
{
    while (scan->at < scan->end) {
        size_t length = line_end(scan->at, scan->end);
        if (length == 0 && !hewn_is_blank(*scan->at))
            return;
        scan->line += length > 0;
        scan->at += length > 0 ? length : 1;
    }
}

void hewn_scan_all_space(hewn_scan *scan)
{
    for (hewn_scan_space(scan); scan->at < scan->end && *scan->at == '#'; hewn_scan_space(scan))
        hewn_scan_line(scan);
}

void hewn_scan_line(hewn_scan *scan)
{
    while (scan->at < scan->end && !hewn_is_line_end(*scan->at))
        scan->at++;
    size_t length = line_end(scan->at, scan->end);
    scan->line += length > 0;
    scan->at += length;
}

static hewn_word take_word(hewn_scan *scan)
{
    hewn_word word = {scan->at, scan->at};
    while (word.end < scan->end && !hewn_is_blank(*word.end) && !hewn_is_line_end(*word.end)) {
        scan->at = word.end;
        if (*word.end == '\\' && continuation(scan) > 0)
            break;
        word.end++;
    }
    scan->at = word.end;
    return word;
}

hewn_word hewn_scan_word_in_line(hewn_scan *scan)
{
    hewn_scan_blanks(scan);
    return take_word(scan);
}

hewn_word hewn_scan_word(hewn_scan *scan)
{
    hewn_scan_space(scan);
    return take_word(scan);
}

bool hewn_scan_double_in_line(hewn_scan *scan, double *out)
{
    hewn_scan_blanks(scan);
    const char *next = hewn_number_parse_double(scan->at, scan->end, out);
    bool good = next && hewn_scan_ends_word(scan, next);
    scan->at = good ? next : scan->at;
    return good;
}

bool hewn_scan_float_in_line(hewn_scan *scan, float *out)
{
    hewn_scan_blanks(scan);
    const char *next = hewn_number_parse_float(scan->at, scan->end, out);
    bool good = next && hewn_scan_ends_word(scan, next);
    scan->at = good ? next : scan->at;
    return good;
}

bool hewn_word_is_any_case(hewn_word word, const char *text)
{
    size_t length = strlen(text);
    return (size_t)(word.end - word.begin) == length && strncasecmp(word.begin, text, length) == 0;
}

bool hewn_word_float(hewn_word word, float *out)
{
    return word.begin < word.end && hewn_number_parse_float(word.begin, word.end, out) == word.end;
}

bool hewn_word_double(hewn_word word, double *out)
{
    return word.begin < word.end && hewn_number_parse_double(word.begin, word.end, out) == word.end;
}

bool hewn_word_integer(hewn_word word, int64_t *out)
{
    return word.begin < word.end && hewn_number_parse_integer(word.begin, word.end, out) == word.end;
}

hewn_result hewn_scan_fail(const hewn_scan *scan, hewn_word word, const char *what, hewn_error *error)
{
    if (word.begin == word.end && scan->at == scan->end)
        return hewn_fail_at(error, HEWN_BAD_INPUT, scan->name, scan->line, "%s, but the file ends", what);
    if (word.begin == word.end)
        return hewn_fail_at(error, HEWN_BAD_INPUT, scan->name, scan->line, "%s, but the line ends", what);
    char shown[40]; /* messages are plain text, whatever the file holds */
    size_t length = 0;
    for (const char *at = word.begin; at < word.end && length < sizeof shown - 1; at++)
        shown[length++] = (char)(*at >= 0x20 && *at < 0x7f ? *at : '?');
    shown[length] = '\0';
    return hewn_fail_at(error, HEWN_BAD_INPUT, scan->name, scan->line, "%s, but there is \"%s\"", what, shown);
}
