#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"
#include "base/utf8.h"
#include "hewn/labels.h"

enum { MOST_FIELDS = 64, MOST_BYTES = 64 << 20 };

/* A part of a line. */
typedef struct field {
    const char *begin, *end;
    bool quoted;
} field;

typedef struct parser {
    const char *name; /* of the file */
    uint32_t line;
    field fields[MOST_FIELDS];
    size_t field_count;
    bool columns; /* the line has tabs, commas or semicolons between its fields, so that names may have spaces */
    hewn_label_table *table;
    size_t room;
    uint32_t *lines; /* of each entry */
    size_t line_room;
    bool some_opaque; /* a label other than 0 has a fourth number above 0 behind its colour */
} parser;

static hewn_result fail(const parser *by, hewn_error *error, const char *what)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, by->name, by->line, "%s", what);
}

/* --- fields --------------------------------------------------------------------------------------------------------
 */

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static void trim(field *of)
{
    while (of->begin < of->end && is_space(*of->begin))
        of->begin++;
    while (of->end > of->begin && is_space(of->end[-1]))
        of->end--;
    if (of->end - of->begin >= 2 && *of->begin == '"' && of->end[-1] == '"') {
        of->quoted = true;
        of->begin++;
        of->end--;
    }
}

/* What the fields of a line are parted by: ',', ';', a tab, or else white space. */
static char find_separator(const char *begin, const char *end)
{
    static const char candidates[] = "\t,;";
    for (const char *candidate = candidates; *candidate; candidate++) {
        bool quoted = false;
        for (const char *at = begin; at < end; at++) {
            quoted = quoted != (*at == '"');
            if (*at == *candidate && !quoted && at > begin)
                return *candidate;
        }
    }
    return ' ';
}

/* The end of the field that begins at `at`. */
static const char *end_of_field(const char *at, const char *end, char separator)
{
    for (bool quoted = false; at < end; at++) {
        quoted = quoted != (*at == '"');
        if (!quoted && (separator == ' ' ? is_space(*at) : *at == separator))
            break;
    }
    return at;
}

static hewn_result split(parser *by, const char *begin, const char *end, hewn_error *error)
{
    char separator = find_separator(begin, end);
    /* Columns that are lined up with tabs, some of them doubled, are white space. */
    if (separator == '\t' && end_of_field(begin, end, ' ') < end_of_field(begin, end, '\t'))
        separator = ' ';
    by->columns = separator != ' ';
    by->field_count = 0;
    for (const char *at = begin; at < end;) {
        field *to = &by->fields[by->field_count];
        const char *stop = end_of_field(at, end, separator);
        *to = (field){at, stop, false};
        trim(to);
        at = stop < end ? stop + 1 : end;
        if (to->begin == to->end && !to->quoted && (separator == ' ' || separator == '\t'))
            continue;
        if (++by->field_count == MOST_FIELDS)
            return fail(by, error, "too many fields");
    }
    return HEWN_OK;
}

static bool read_number(const field *of, double *out)
{
    char text[40], *end;
    size_t length = (size_t)(of->end - of->begin);
    if (of->quoted || length == 0 || length >= sizeof text)
        return false;
    memcpy(text, of->begin, length);
    text[length] = '\0';
    if (strspn(text, "+-.0123456789eE") != length)
        return false;
    *out = strtod(text, &end);
    return *end == '\0' && isfinite(*out);
}

static bool read_label(const field *of, int64_t *out)
{
    double value;
    if (!read_number(of, &value) || rint(value) != value || fabs(value) > 9007199254740992.0)
        return false;
    *out = (int64_t)value;
    return true;
}

/* How many of the last fields are numbers, of those from `from` on. */
static size_t count_numbers(const parser *by, size_t from)
{
    double value;
    size_t count = 0;
    while (by->field_count - count > from && read_number(&by->fields[by->field_count - count - 1], &value))
        count++;
    return count;
}

/* --- entries -------------------------------------------------------------------------------------------------------
 */

/* Whether bytes are UTF-8 without control characters: names go into JSON, headers and names of files. */
static bool is_text(const char *begin, const char *end)
{
    for (const char *at = begin; at < end;) {
        uint32_t value;
        size_t length = hewn_utf8_next(at, (size_t)(end - at), &value);
        if (length == 0 || value < 0x20 || value == 0x7f)
            return false;
        at += length;
    }
    return true;
}

static hewn_result take_name(parser *by, size_t first, size_t last, hewn_label_name *entry, hewn_error *error)
{
    const char *begin = by->fields[first].begin, *end = by->fields[last].end;
    if (begin >= end)
        return fail(by, error, "the label has no name");
    if (!is_text(begin, end))
        return fail(by, error, "the name is not UTF-8 text, or has control characters");
    entry->name = hewn_alloc((size_t)(end - begin) + 1, 1);
    if (!entry->name)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the names of labels");
    memcpy(entry->name, begin, (size_t)(end - begin));
    entry->name[end - begin] = '\0';
    return HEWN_OK;
}

/* Three numbers from 0 to 255, or decimals from 0 to 1. */
static hewn_result take_color(parser *by, size_t first, hewn_label_name *entry, hewn_error *error)
{
    double values[3];
    bool decimals = false, small = true;
    for (size_t k = 0; k < 3; k++) {
        const field *of = &by->fields[first + k];
        if (!read_number(of, &values[k]))
            return fail(by, error, "the colour is not three numbers");
        decimals = decimals || memchr(of->begin, '.', (size_t)(of->end - of->begin));
        small = small && values[k] <= 1;
    }
    for (size_t k = 0; k < 3; k++) {
        double value = decimals && small ? values[k] * 255 : values[k];
        if (!(value >= 0 && value <= 255))
            return fail(by, error, "a colour's numbers go from 0 to 255");
        entry->color[k] = (uint8_t)rint(value);
    }
    entry->has_color = true;
    entry->color[3] = 255;
    return HEWN_OK;
}

/* ITK-SNAP: label, red, green, blue, opacity from 0 to 1, two flags, name in quotes. */
static bool is_snap(const parser *by)
{
    double value;
    bool right = by->field_count == 8 && by->fields[7].quoted && !by->columns;
    for (size_t i = 1; right && i < 7; i++)
        right = read_number(&by->fields[i], &value);
    return right;
}

static hewn_result take_snap(parser *by, hewn_label_name *entry, hewn_error *error)
{
    double opacity = 0;
    HEWN_TRY(take_color(by, 1, entry, error));
    if (!read_number(&by->fields[4], &opacity) || opacity < 0 || opacity > 1)
        return fail(by, error, "opacity goes from 0 to 1");
    entry->color[3] = (uint8_t)rint(opacity * 255);
    by->some_opaque = true;
    return take_name(by, 7, 7, entry, error);
}

/* Label, name, and perhaps a colour with a fourth number. */
static hewn_result take_plain(parser *by, hewn_label_name *entry, hewn_error *error)
{
    size_t count = by->field_count, numbers = count_numbers(by, 2), colors = 0;
    if (count < 2)
        return fail(by, error, "the label has no name");
    if (by->columns && count > 2) {
        /* Columns say themselves what is what: those of the colour may be empty. */
        while (count > 2 && by->fields[count - 1].begin == by->fields[count - 1].end)
            count--;
        colors = count - 2;
        if (colors != 0 && colors != 3 && colors != 4)
            return fail(by, error, "behind a name there are three or four numbers of a colour, or none");
    } else if (numbers >= 3) {
        colors = numbers == 4 && count == 6 ? 4 : 3;
    }
    if (colors >= 3)
        HEWN_TRY(take_color(by, count - colors, entry, error));
    double fourth = 0;
    if (colors == 4) {
        if (!read_number(&by->fields[count - 1], &fourth) || fourth < 0 || fourth > 255)
            return fail(by, error, "opacity goes from 0 to 255");
        entry->color[3] = (uint8_t)rint(fourth);
        by->some_opaque = by->some_opaque || (fourth > 0 && entry->label != 0);
    }
    return take_name(by, 1, by->columns ? 1 : count - colors - 1, entry, error);
}

static bool is_heading(const parser *by)
{
    static const char *const words[] = {"label",  "labels", "labelvalue", "index", "idx", "id",
                                        "number", "no",     "no.",        "value", "key"};
    const field *of = &by->fields[0];
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        size_t length = strlen(words[i]), k = 0;
        if ((size_t)(of->end - of->begin) != length)
            continue;
        while (k < length && tolower((unsigned char)of->begin[k]) == words[i][k])
            k++;
        if (k == length)
            return true;
    }
    return false;
}

static hewn_result take_line(parser *by, const char *begin, const char *end, hewn_error *error)
{
    field whole = {begin, end, false};
    trim(&whole);
    if (!whole.quoted && (whole.begin == whole.end || *whole.begin == '#' ||
                          (whole.end - whole.begin >= 2 && memcmp(whole.begin, "//", 2) == 0)))
        return HEWN_OK;
    HEWN_TRY(split(by, whole.begin, whole.end, error));
    hewn_label_table *table = by->table;
    hewn_label_name entry = {0};
    if (by->field_count == 0 || !read_label(&by->fields[0], &entry.label)) {
        if (table->count == 0 && by->field_count > 1 && is_heading(by))
            return HEWN_OK;
        return fail(by, error, "the line does not begin with the number of a label");
    }
    void *items = table->entries;
    HEWN_TRY(hewn_reserve(&items, &by->room, table->count + 1, sizeof *table->entries, error));
    table->entries = items;
    items = by->lines;
    HEWN_TRY(hewn_reserve(&items, &by->line_room, table->count + 1, sizeof *by->lines, error));
    by->lines = items;
    hewn_result result = is_snap(by) ? take_snap(by, &entry, error) : take_plain(by, &entry, error);
    if (result != HEWN_OK) {
        hewn_free(entry.name);
        return result;
    }
    by->lines[table->count] = by->line;
    table->entries[table->count++] = entry;
    return HEWN_OK;
}

/* --- the whole -----------------------------------------------------------------------------------------------------
 */

static int compare(const void *a, const void *b)
{
    int64_t one = ((const hewn_label_name *)a)->label, other = ((const hewn_label_name *)b)->label;
    return (one > other) - (one < other);
}

/* In order of labels; the first line that has one again is at fault. */
static hewn_result sort(parser *by, hewn_error *error)
{
    hewn_label_table *table = by->table;
    bool rising = true;
    for (size_t i = 1; i < table->count; i++)
        rising = rising && table->entries[i - 1].label < table->entries[i].label;
    if (rising)
        return HEWN_OK;
    hewn_label_name *sorted = hewn_alloc(table->count, sizeof *sorted);
    if (!sorted)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the names of labels");
    memcpy(sorted, table->entries, table->count * sizeof *sorted);
    qsort(sorted, table->count, sizeof *sorted, compare);
    uint32_t again = 0;
    int64_t label = 0;
    for (size_t i = 1; i < table->count; i++) {
        if (sorted[i - 1].label != sorted[i].label)
            continue;
        label = sorted[i].label;
        unsigned seen = 0;
        for (size_t k = 0; k < table->count && !again; k++)
            if (table->entries[k].label == label && ++seen == 2)
                again = by->lines[k];
        break;
    }
    hewn_free(table->entries);
    table->entries = sorted;
    if (!again)
        return HEWN_OK;
    return hewn_fail_at(error, HEWN_BAD_INPUT, by->name, again, "label %lld comes a second time", (long long)label);
}

static hewn_result parse(parser *by, const char *text, size_t length, hewn_error *error)
{
    const char *end = text + length, *at = text;
    if (length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0)
        at += 3;
    while (at < end) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        by->line++;
        HEWN_TRY(take_line(by, at, stop ? stop : end, error));
        at = stop ? stop + 1 : end;
    }
    if (by->table->count == 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, by->name, 0, "there is no label in the table");
    /* FreeSurfer's fourth number is 0 throughout, and means that nothing is transparent. */
    for (size_t i = 0; i < by->table->count; i++)
        if (!by->some_opaque && by->table->entries[i].has_color && by->table->entries[i].color[3] == 0)
            by->table->entries[i].color[3] = 255;
    return sort(by, error);
}

hewn_result hewn_label_table_parse(const char *text, size_t length, const char *name, hewn_label_table *out,
                                   hewn_error *error)
{
    *out = (hewn_label_table){0};
    parser *by = hewn_alloc_zero(1, sizeof *by);
    if (!by)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the names of labels");
    by->name = name;
    by->table = out;
    hewn_result result = parse(by, text, length, error);
    hewn_free(by->lines);
    hewn_free(by);
    if (result != HEWN_OK)
        hewn_label_table_destroy(out);
    return result;
}

hewn_result hewn_label_table_read(const char *path, hewn_label_table *out, hewn_error *error)
{
    char *bytes;
    size_t length;
    *out = (hewn_label_table){0};
    HEWN_TRY(hewn_file_read(path, MOST_BYTES, &bytes, &length, error));
    hewn_result result = hewn_label_table_parse(bytes, length, path, out, error);
    hewn_free(bytes);
    return result;
}

void hewn_label_table_destroy(hewn_label_table *table)
{
    for (size_t i = 0; i < table->count; i++)
        hewn_free(table->entries[i].name);
    hewn_free(table->entries);
    *table = (hewn_label_table){0};
}

const hewn_label_name *hewn_label_table_find(const hewn_label_table *table, int64_t label)
{
    hewn_label_name key = {.label = label};
    return table->count ? bsearch(&key, table->entries, table->count, sizeof key, compare) : NULL;
}
