#include "io/scan.h"

#include <string.h>
#include <strings.h>

#include "base/error.h"
#include "io/shim/number.h"

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/* How long a backslash and the line end after it are; 0 where there is no such thing. */
static size_t continuation(const hewn_scan *scan)
{
    size_t left = (size_t)(scan->end - scan->at);
    if (left >= 2 && scan->at[0] == '\\' && scan->at[1] == '\n')
        return 2;
    if (left >= 3 && scan->at[0] == '\\' && scan->at[1] == '\r' && scan->at[2] == '\n')
        return 3;
    return 0;
}

void hewn_scan_blanks(hewn_scan *scan)
{
    while (scan->at < scan->end) {
        size_t length = continuation(scan);
        if (length > 0) {
            scan->at += length;
            scan->line++;
        } else if (is_blank(*scan->at)) {
            scan->at++;
        } else {
            return;
        }
    }
}

void hewn_scan_space(hewn_scan *scan)
{
    while (scan->at < scan->end && (is_blank(*scan->at) || *scan->at == '\n')) {
        scan->line += *scan->at == '\n';
        scan->at++;
    }
}

void hewn_scan_line(hewn_scan *scan)
{
    const char *end = scan->at < scan->end ? memchr(scan->at, '\n', (size_t)(scan->end - scan->at)) : NULL;
    scan->line += end != NULL;
    scan->at = end ? end + 1 : scan->end;
}

static hewn_word take_word(hewn_scan *scan)
{
    hewn_word word = {scan->at, scan->at};
    while (word.end < scan->end && !is_blank(*word.end) && *word.end != '\n') {
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

bool hewn_word_is(hewn_word word, const char *text)
{
    size_t length = strlen(text);
    return (size_t)(word.end - word.begin) == length && memcmp(word.begin, text, length) == 0;
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
