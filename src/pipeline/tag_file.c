#include "pipeline/tag_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"

enum { MOST_BYTES = 1 << 30 };

void hewn_tags_free(hewn_tags *tags)
{
    hewn_free(tags->creases);
    hewn_free(tags->corners);
    *tags = (hewn_tags){0};
}

/* The next number of a line, which ends with a NUL; false where there is none. */
static bool read_count(char **at, uint32_t *out)
{
    char *end;
    *at += strspn(*at, " \t/");
    if (**at < '0' || **at > '9')
        return false;
    unsigned long long value = strtoull(*at, &end, 10);
    *at = end;
    *out = value < HEWN_NONE ? (uint32_t)value : HEWN_NONE;
    return true;
}

static hewn_result add_crease(hewn_tags *tags, uint32_t a, uint32_t b, hewn_error *error)
{
    void *items = tags->creases;
    HEWN_TRY(hewn_reserve(&items, &tags->crease_room, tags->crease_count + 1, sizeof *tags->creases, error));
    tags->creases = items;
    tags->creases[tags->crease_count++] = (hewn_crease){{a, b}, 0};
    return HEWN_OK;
}

static hewn_result add_corner(hewn_tags *tags, uint32_t v, hewn_error *error)
{
    void *items = tags->corners;
    HEWN_TRY(hewn_reserve(&items, &tags->corner_room, tags->corner_count + 1, sizeof *tags->corners, error));
    tags->corners = items;
    tags->corners[tags->corner_count++] = (hewn_corner_tag){v, 0};
    return HEWN_OK;
}

/* What follows the word: how many whole numbers, real ones and words, then these. */
static hewn_result read_tag(char *at, bool crease, hewn_tags *tags, bool *good, hewn_error *error)
{
    uint32_t whole, real, words, before = 0, vert;
    size_t first_crease = tags->crease_count, first_corner = tags->corner_count;
    *good = read_count(&at, &whole) && read_count(&at, &real) && read_count(&at, &words) && real >= 1 && words == 0 &&
            whole >= (crease ? 2u : 1u);
    for (uint32_t i = 0; *good && i < whole; i++) {
        *good = read_count(&at, &vert);
        if (*good && crease && i > 0)
            HEWN_TRY(add_crease(tags, before, vert, error));
        else if (*good && !crease)
            HEWN_TRY(add_corner(tags, vert, error));
        before = vert;
    }
    double sharpness = 0;
    size_t count = crease ? tags->crease_count - first_crease : tags->corner_count - first_corner;
    for (size_t i = 0; *good && i < count; i++) {
        char *end = at;
        if (i < real) /* one for each, or one for all */
            sharpness = strtod(at, &end);
        *good = (end != at || i >= real) && sharpness >= 0;
        at = end;
        if (crease)
            tags->creases[first_crease + i].sharpness = sharpness;
        else
            tags->corners[first_corner + i].sharpness = sharpness;
    }
    return HEWN_OK;
}

static hewn_result read_lines(const char *path, char *text, hewn_tags *out, hewn_error *error)
{
    uint32_t number = 0;
    for (char *line = text; line; number++) {
        char *end = strchr(line, '\n'), *at = line;
        if (end)
            *end = '\0';
        at += strspn(at, " \t");
        bool tag = at[0] == 't' && (at[1] == ' ' || at[1] == '\t'), good = true;
        at += tag ? 1 + strspn(at + 1, " \t") : 0;
        bool crease = tag && strncmp(at, "crease ", 7) == 0, corner = tag && strncmp(at, "corner ", 7) == 0;
        if (crease || corner)
            HEWN_TRY(read_tag(at + 7, crease, out, &good, error));
        if (!good)
            return hewn_fail_at(error, HEWN_BAD_INPUT, path, number + 1,
                                "`t crease 2/1/0 A B SHARPNESS` or `t corner 1/1/0 V SHARPNESS` is expected");
        line = end ? end + 1 : NULL;
    }
    return HEWN_OK;
}

hewn_result hewn_tags_read(const char *path, hewn_tags *out, hewn_error *error)
{
    char *text;
    size_t length;
    *out = (hewn_tags){0};
    HEWN_TRY(hewn_file_read(path, MOST_BYTES, &text, &length, error));
    hewn_result result = read_lines(path, text, out, error);
    hewn_free(text);
    if (result != HEWN_OK)
        hewn_tags_free(out);
    return result;
}
