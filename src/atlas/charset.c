#include "atlas/charset.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/utf8.h"

enum { WORDS = (HEWN_CHARACTER_MOST + 1) / 32 };

void hewn_charset_clear(hewn_charset *set)
{
    hewn_free(set->bits);
    *set = (hewn_charset){0};
}

hewn_result hewn_charset_add(hewn_charset *set, uint32_t first, uint32_t last, hewn_error *error)
{
    if (!set->bits)
        set->bits = hewn_alloc_zero(WORDS, sizeof *set->bits);
    if (!set->bits)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a set of characters");
    for (uint32_t at = first; at <= last; at++) {
        uint32_t bit = 1u << at % 32;
        set->count += (set->bits[at / 32] & bit) == 0;
        set->bits[at / 32] |= bit;
    }
    return HEWN_OK;
}

hewn_result hewn_charset_list(const hewn_charset *set, uint32_t **out, hewn_error *error)
{
    *out = hewn_alloc(set->count > 0 ? set->count : 1, sizeof **out);
    if (!*out)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a set of characters");
    size_t count = 0;
    for (uint32_t at = 0; set->bits && at <= HEWN_CHARACTER_MOST; at++)
        if (set->bits[at / 32] >> at % 32 & 1)
            (*out)[count++] = at;
    return HEWN_OK;
}

static hewn_result add_all(hewn_charset *set, const hewn_font *font, hewn_error *error)
{
    uint32_t *items;
    size_t count;
    HEWN_TRY(hewn_font_characters(font, &items, &count, error));
    hewn_result result = HEWN_OK;
    for (size_t i = 0; i < count && result == HEWN_OK; i++)
        if (items[i] <= HEWN_CHARACTER_MOST) /* a font's table may name anything */
            result = hewn_charset_add(set, items[i], items[i], error);
    hewn_free(items);
    return result;
}

hewn_result hewn_charset_add_named(hewn_charset *set, const char *name, const hewn_font *font, bool *known,
                                   hewn_error *error)
{
    *known = true;
    if (strcmp(name, "all") == 0)
        return add_all(set, font, error);
    *known = strcmp(name, "ascii") == 0 || strcmp(name, "latin1") == 0;
    if (*known)
        HEWN_TRY(hewn_charset_add(set, 0x20, 0x7E, error));
    return strcmp(name, "latin1") == 0 ? hewn_charset_add(set, 0xA0, 0xFF, error) : HEWN_OK;
}

hewn_result hewn_charset_add_text(hewn_charset *set, const char *text, hewn_error *error)
{
    for (const char *at = text; *at;) {
        uint32_t value;
        size_t length = hewn_utf8_next(at, SIZE_MAX, &value);
        if (length == 0)
            return hewn_fail(error, HEWN_BAD_INPUT, "byte %zu is not UTF-8", (size_t)(at - text) + 1);
        bool mark = value == 0xFEFF && at == text; /* of the byte order, as some editors write it */
        if (value >= 0x20 && value != 0x7F && !mark)
            HEWN_TRY(hewn_charset_add(set, value, value, error));
        at += length;
    }
    return HEWN_OK;
}

/* --- descriptions --------------------------------------------------------------------------------------------------
 */

/* A description being read. */
typedef struct reader {
    const char *at;
    uint32_t line;
    hewn_error *error;
} reader;

static hewn_result fail(const reader *own, const char *what)
{
    return hewn_fail_at(own->error, HEWN_BAD_INPUT, "", own->line, "%s", what);
}

static void skip_blanks(reader *own)
{
    for (; *own->at == ' ' || *own->at == '\t' || *own->at == '\r' || *own->at == '\n' || *own->at == ','; own->at++)
        own->line += *own->at == '\n';
}

static int digit_of(char c, int base)
{
    int value = c >= '0' && c <= '9'   ? c - '0'
                : c >= 'a' && c <= 'f' ? c - 'a' + 10
                : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                       : 99;
    return value < base ? value : -1;
}

static hewn_result read_number(reader *own, uint32_t *out)
{
    int base = own->at[0] == '0' && (own->at[1] == 'x' || own->at[1] == 'X') ? 16 : 10;
    uint32_t value = 0;
    own->at += base == 16 ? 2 : 0;
    if (digit_of(*own->at, base) < 0)
        return fail(own, "a number has no digits");
    for (int digit; (digit = digit_of(*own->at, base)) >= 0; own->at++) {
        value = value * (uint32_t)base + (uint32_t)digit;
        if (value > HEWN_CHARACTER_MOST)
            return fail(own, "a character is at most 0x10FFFF");
    }
    *out = value;
    return HEWN_OK;
}

/* The next character between quotes; `*end` where the closing one comes instead. */
static hewn_result read_quoted(reader *own, char quote, uint32_t *out, bool *end)
{
    *end = *own->at == quote;
    if (*end) {
        own->at++;
        return HEWN_OK;
    }
    if (*own->at == '\0' || *own->at == '\n')
        return fail(own, "a quoted text does not end");
    if (*own->at == '\\') {
        own->at++;
        if (*own->at != '\\' && *own->at != '"' && *own->at != '\'')
            return fail(own, "after \\ there is another \\ or a quote");
    }
    size_t length = hewn_utf8_next(own->at, SIZE_MAX, out);
    if (length == 0)
        return fail(own, "a byte that is not UTF-8");
    own->at += length;
    return HEWN_OK;
}

/* A number, or one character in quotes. */
static hewn_result read_character(reader *own, uint32_t *out)
{
    bool end;
    uint32_t none;
    if (*own->at != '\'')
        return digit_of(*own->at, 10) >= 0 ? read_number(own, out) : fail(own, "a number or a 'character' is wanted");
    own->at++;
    HEWN_TRY(read_quoted(own, '\'', out, &end));
    if (!end)
        HEWN_TRY(read_quoted(own, '\'', &none, &end));
    else
        end = false;
    return end ? HEWN_OK : fail(own, "there is one character between two '");
}

static hewn_result read_range(reader *own, hewn_charset *set)
{
    uint32_t first, last;
    own->at++;
    skip_blanks(own);
    HEWN_TRY(read_character(own, &first));
    skip_blanks(own);
    HEWN_TRY(read_character(own, &last));
    skip_blanks(own);
    if (*own->at != ']')
        return fail(own, "a range is [FIRST, LAST]");
    own->at++;
    if (first > last)
        return fail(own, "a range runs from the lower character to the higher");
    return hewn_charset_add(set, first, last, own->error);
}

static hewn_result read_string(reader *own, hewn_charset *set)
{
    own->at++;
    for (bool end = false;;) {
        uint32_t value = 0;
        HEWN_TRY(read_quoted(own, '"', &value, &end));
        if (end)
            return HEWN_OK;
        HEWN_TRY(hewn_charset_add(set, value, value, own->error));
    }
}

hewn_result hewn_charset_add_description(hewn_charset *set, const char *text, hewn_error *error)
{
    reader own = {.at = text, .line = 1, .error = error};
    if (strncmp(own.at, "\xEF\xBB\xBF", 3) == 0)
        own.at += 3;
    for (skip_blanks(&own); *own.at; skip_blanks(&own)) {
        if (*own.at == '[') {
            HEWN_TRY(read_range(&own, set));
        } else if (*own.at == '"') {
            HEWN_TRY(read_string(&own, set));
        } else {
            uint32_t value = 0;
            HEWN_TRY(read_character(&own, &value));
            HEWN_TRY(hewn_charset_add(set, value, value, error));
        }
    }
    return HEWN_OK;
}
