#include "io/volume/nrrd_header.h"

#include <math.h>
#include <string.h>

#include "base/error.h"

/* One line, "field: value", taken apart: `value` scans no further than the line's end. */
typedef struct nrrd_line {
    hewn_word field;
    hewn_scan value;
    hewn_nrrd_header *header;
} nrrd_line;

typedef hewn_result (*read_field)(nrrd_line *line, hewn_error *error);

static hewn_result bad(nrrd_line *line, const char *what, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, line->value.name, line->value.line, "%.*s: %s",
                        (int)(line->field.end - line->field.begin), line->field.begin, what);
}

static hewn_word rest_of(nrrd_line *line)
{
    while (line->value.at < line->value.end && hewn_is_blank(*line->value.at))
        line->value.at++;
    hewn_word rest = {line->value.at, line->value.end};
    while (rest.end > rest.begin && hewn_is_blank(rest.end[-1]))
        rest.end--;
    return rest;
}

/* The next word, where blanks are all that parts words: scan.h's knows comments and continued lines too. */
static hewn_word next_word(nrrd_line *line)
{
    hewn_word word = rest_of(line);
    const char *end = word.begin;
    while (end < word.end && !hewn_is_blank(*end))
        end++;
    line->value.at = end;
    word.end = end;
    return word;
}

static hewn_word next_quoted(nrrd_line *line)
{
    hewn_word word = rest_of(line);
    if (word.begin == word.end || *word.begin != '"')
        return next_word(line);
    const char *end = memchr(word.begin + 1, '"', (size_t)(word.end - word.begin - 1));
    line->value.at = end ? end + 1 : word.end;
    return (hewn_word){word.begin + 1, end ? end : word.end};
}

static hewn_result need_dimension(nrrd_line *line, hewn_error *error)
{
    return line->header->dimension > 0 ? HEWN_OK : bad(line, "comes before the dimension", error);
}

static hewn_result read_type(nrrd_line *line, hewn_error *error)
{
    static const struct {
        const char *name;
        hewn_voxel type;
    } names[] = {{"signed char", HEWN_VOXEL_INT8},
                 {"int8", HEWN_VOXEL_INT8},
                 {"int8_t", HEWN_VOXEL_INT8},
                 {"uchar", HEWN_VOXEL_UINT8},
                 {"unsigned char", HEWN_VOXEL_UINT8},
                 {"uint8", HEWN_VOXEL_UINT8},
                 {"uint8_t", HEWN_VOXEL_UINT8},
                 {"short", HEWN_VOXEL_INT16},
                 {"short int", HEWN_VOXEL_INT16},
                 {"signed short", HEWN_VOXEL_INT16},
                 {"signed short int", HEWN_VOXEL_INT16},
                 {"int16", HEWN_VOXEL_INT16},
                 {"int16_t", HEWN_VOXEL_INT16},
                 {"ushort", HEWN_VOXEL_UINT16},
                 {"unsigned short", HEWN_VOXEL_UINT16},
                 {"unsigned short int", HEWN_VOXEL_UINT16},
                 {"uint16", HEWN_VOXEL_UINT16},
                 {"uint16_t", HEWN_VOXEL_UINT16},
                 {"int", HEWN_VOXEL_INT32},
                 {"signed int", HEWN_VOXEL_INT32},
                 {"int32", HEWN_VOXEL_INT32},
                 {"int32_t", HEWN_VOXEL_INT32},
                 {"uint", HEWN_VOXEL_UINT32},
                 {"unsigned int", HEWN_VOXEL_UINT32},
                 {"uint32", HEWN_VOXEL_UINT32},
                 {"uint32_t", HEWN_VOXEL_UINT32},
                 {"longlong", HEWN_VOXEL_INT64},
                 {"long long", HEWN_VOXEL_INT64},
                 {"long long int", HEWN_VOXEL_INT64},
                 {"signed long long", HEWN_VOXEL_INT64},
                 {"signed long long int", HEWN_VOXEL_INT64},
                 {"int64", HEWN_VOXEL_INT64},
                 {"int64_t", HEWN_VOXEL_INT64},
                 {"ulonglong", HEWN_VOXEL_UINT64},
                 {"unsigned long long", HEWN_VOXEL_UINT64},
                 {"unsigned long long int", HEWN_VOXEL_UINT64},
                 {"uint64", HEWN_VOXEL_UINT64},
                 {"uint64_t", HEWN_VOXEL_UINT64},
                 {"float", HEWN_VOXEL_FLOAT},
                 {"double", HEWN_VOXEL_DOUBLE}};
    hewn_word word = rest_of(line);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (hewn_word_is_any_case(word, names[i].name)) {
            line->header->type = names[i].type;
            line->header->has_type = true;
            return HEWN_OK;
        }
    }
    return bad(line, "not a type of numbers", error);
}

static hewn_result read_whole(nrrd_line *line, int64_t least, int64_t most, int64_t *out, hewn_error *error)
{
    if (!hewn_word_integer(next_word(line), out) || *out < least || *out > most)
        return bad(line, "not a whole number that can be there", error);
    return HEWN_OK;
}

static hewn_result read_dimension(nrrd_line *line, hewn_error *error)
{
    int64_t value;
    HEWN_TRY(read_whole(line, 1, HEWN_NRRD_AXES, &value, error));
    line->header->dimension = (uint32_t)value;
    return HEWN_OK;
}

static hewn_result read_sizes(nrrd_line *line, hewn_error *error)
{
    HEWN_TRY(need_dimension(line, error));
    for (uint32_t i = 0; i < line->header->dimension; i++) {
        int64_t size;
        HEWN_TRY(read_whole(line, 1, UINT32_MAX, &size, error));
        line->header->axes[i].size = (uint64_t)size;
    }
    return HEWN_OK;
}

/* A number for each axis; `which` tells where it goes. */
static hewn_result read_numbers(nrrd_line *line, size_t which, hewn_error *error)
{
    HEWN_TRY(need_dimension(line, error));
    for (uint32_t i = 0; i < line->header->dimension; i++) {
        double *out = (double *)((char *)&line->header->axes[i] + which);
        if (!hewn_word_double(next_word(line), out))
            return bad(line, "not a number for each axis", error);
    }
    return HEWN_OK;
}

static hewn_result read_spacings(nrrd_line *line, hewn_error *error)
{
    return read_numbers(line, offsetof(hewn_nrrd_axis, spacing), error);
}

static hewn_result read_mins(nrrd_line *line, hewn_error *error)
{
    return read_numbers(line, offsetof(hewn_nrrd_axis, min), error);
}

static hewn_result read_maxs(nrrd_line *line, hewn_error *error)
{
    return read_numbers(line, offsetof(hewn_nrrd_axis, max), error);
}

static hewn_result read_centers(nrrd_line *line, hewn_error *error)
{
    HEWN_TRY(need_dimension(line, error));
    for (uint32_t i = 0; i < line->header->dimension; i++)
        line->header->axes[i].cell = hewn_word_is_any_case(next_word(line), "cell");
    return HEWN_OK;
}

static hewn_result read_kinds(nrrd_line *line, hewn_error *error)
{
    HEWN_TRY(need_dimension(line, error));
    for (uint32_t i = 0; i < line->header->dimension; i++) {
        hewn_nrrd_axis *axis = &line->header->axes[i];
        hewn_word kind = next_word(line);
        axis->has_kind = !hewn_word_is(kind, "???") && !hewn_word_is_any_case(kind, "none") && kind.begin < kind.end;
        axis->not_domain =
            axis->has_kind && !hewn_word_is_any_case(kind, "domain") && !hewn_word_is_any_case(kind, "space");
    }
    return HEWN_OK;
}

static hewn_result read_unit(nrrd_line *line, uint32_t count, hewn_error *error)
{
    HEWN_TRY(need_dimension(line, error));
    for (uint32_t i = 0; i < count; i++) {
        hewn_word unit = next_quoted(line), *known = &line->header->unit;
        if (unit.begin == unit.end || hewn_word_is(unit, "???"))
            continue;
        size_t length = (size_t)(unit.end - unit.begin);
        bool same = length == (size_t)(known->end - known->begin) && memcmp(unit.begin, known->begin, length) == 0;
        if (known->begin != known->end && !same && !line->header->axes[i].not_domain)
            return bad(line, "the axes are in different units", error);
        *known = known->begin != known->end ? *known : unit;
    }
    return HEWN_OK;
}

static hewn_result read_units(nrrd_line *line, hewn_error *error)
{
    return read_unit(line, line->header->dimension < 3 ? line->header->dimension : 3, error);
}

static hewn_result read_space_units(nrrd_line *line, hewn_error *error)
{
    return read_unit(line, line->header->space < 3 ? line->header->space : 3, error);
}

static hewn_result read_space(nrrd_line *line, hewn_error *error)
{
    static const struct {
        const char *name;
        uint32_t dimension;
        bool anatomical, left, posterior;
    } spaces[] = {{"right-anterior-superior", 3, true, false, false},
                  {"RAS", 3, true, false, false},
                  {"left-anterior-superior", 3, true, true, false},
                  {"LAS", 3, true, true, false},
                  {"left-posterior-superior", 3, true, true, true},
                  {"LPS", 3, true, true, true},
                  {"right-anterior-superior-time", 4, true, false, false},
                  {"RAST", 4, true, false, false},
                  {"left-anterior-superior-time", 4, true, true, false},
                  {"LAST", 4, true, true, false},
                  {"left-posterior-superior-time", 4, true, true, true},
                  {"LPST", 4, true, true, true},
                  {"scanner-xyz", 3, false, false, false},
                  {"scanner-xyz-time", 4, false, false, false},
                  {"3D-right-handed", 3, false, false, false},
                  {"3D-left-handed", 3, false, false, false},
                  {"3D-right-handed-time", 4, false, false, false},
                  {"3D-left-handed-time", 4, false, false, false}};
    hewn_word word = rest_of(line);
    for (size_t i = 0; i < sizeof spaces / sizeof *spaces; i++) {
        if (hewn_word_is_any_case(word, spaces[i].name)) {
            line->header->space = spaces[i].dimension;
            line->header->anatomical = spaces[i].anatomical;
            line->header->left = spaces[i].left;
            line->header->posterior = spaces[i].posterior;
            return HEWN_OK;
        }
    }
    return bad(line, "an unknown space", error);
}

static hewn_result read_space_dimension(nrrd_line *line, hewn_error *error)
{
    int64_t value;
    HEWN_TRY(read_whole(line, 1, HEWN_NRRD_SPACE, &value, error));
    line->header->space = (uint32_t)value;
    return HEWN_OK;
}

/* "(1,0,0)", blanks allowed between. */
static bool read_vector(nrrd_line *line, uint32_t count, double *out)
{
    hewn_scan *scan = &line->value;
    for (uint32_t i = 0; i <= count; i++) {
        hewn_scan_blanks(scan);
        char mark = i == 0 ? '(' : i == count ? ')' : ',';
        if (i > 0) {
            const char *end = scan->at;
            while (end < scan->end && *end != ',' && *end != ')' && !hewn_is_blank(*end))
                end++;
            if (!hewn_word_double((hewn_word){scan->at, end}, &out[i - 1]))
                return false;
            scan->at = end;
            hewn_scan_blanks(scan);
        }
        if (scan->at == scan->end || *scan->at != mark)
            return false;
        scan->at++;
    }
    return true;
}

static hewn_result read_directions(nrrd_line *line, hewn_error *error)
{
    HEWN_TRY(need_dimension(line, error));
    if (line->header->space == 0)
        return bad(line, "comes before the space", error);
    for (uint32_t i = 0; i < line->header->dimension; i++) {
        hewn_nrrd_axis *axis = &line->header->axes[i];
        hewn_word rest = rest_of(line);
        axis->has_direction = rest.begin < rest.end && *rest.begin == '(';
        if (axis->has_direction ? !read_vector(line, line->header->space, axis->direction)
                                : !hewn_word_is_any_case(next_word(line), "none"))
            return bad(line, "not a vector of the space, or none, for each axis", error);
    }
    return HEWN_OK;
}

static hewn_result read_origin(nrrd_line *line, hewn_error *error)
{
    if (line->header->space == 0)
        return bad(line, "comes before the space", error);
    return read_vector(line, line->header->space, line->header->origin) ? HEWN_OK
                                                                        : bad(line, "not a point of the space", error);
}

static hewn_result read_encoding(nrrd_line *line, hewn_error *error)
{
    static const struct {
        const char *name;
        hewn_nrrd_encoding encoding;
    } names[] = {{"raw", HEWN_NRRD_RAW},    {"txt", HEWN_NRRD_TEXT},  {"text", HEWN_NRRD_TEXT},
                 {"ascii", HEWN_NRRD_TEXT}, {"hex", HEWN_NRRD_HEX},   {"gz", HEWN_NRRD_GZIP},
                 {"gzip", HEWN_NRRD_GZIP},  {"bz2", HEWN_NRRD_BZIP2}, {"bzip2", HEWN_NRRD_BZIP2}};
    hewn_word word = rest_of(line);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (hewn_word_is_any_case(word, names[i].name)) {
            line->header->encoding = names[i].encoding;
            line->header->has_encoding = true;
            return HEWN_OK;
        }
    }
    return bad(line, "an unknown encoding; known are raw, text, hex, gzip and bzip2", error);
}

static hewn_result read_endian(nrrd_line *line, hewn_error *error)
{
    hewn_word word = rest_of(line);
    line->header->big_endian = hewn_word_is_any_case(word, "big");
    line->header->has_endian = line->header->big_endian || hewn_word_is_any_case(word, "little");
    return line->header->has_endian ? HEWN_OK : bad(line, "neither little nor big", error);
}

static hewn_result read_line_skip(nrrd_line *line, hewn_error *error)
{
    return read_whole(line, 0, INT64_MAX / 2, &line->header->line_skip, error);
}

static hewn_result read_byte_skip(nrrd_line *line, hewn_error *error)
{
    return read_whole(line, -1, INT64_MAX / 2, &line->header->byte_skip, error);
}

static hewn_result read_content(nrrd_line *line, hewn_error *error)
{
    (void)error;
    line->header->content = rest_of(line);
    return HEWN_OK;
}

static hewn_result read_data_file(nrrd_line *line, hewn_error *error)
{
    hewn_word rest = rest_of(line);
    if (rest.begin == rest.end)
        return bad(line, "no name", error);
    line->header->data_file = rest;
    if (hewn_word_is(rest, "LIST") || (rest.end - rest.begin > 5 && memcmp(rest.begin, "LIST ", 5) == 0))
        line->header->data_list = line->value.end;
    return HEWN_OK;
}

static const struct {
    const char *name;
    read_field read;
} fields[] = {{"type", read_type},
              {"dimension", read_dimension},
              {"sizes", read_sizes},
              {"spacings", read_spacings},
              {"axis mins", read_mins},
              {"axismins", read_mins},
              {"axis maxs", read_maxs},
              {"axismaxs", read_maxs},
              {"centers", read_centers},
              {"centerings", read_centers},
              {"kinds", read_kinds},
              {"units", read_units},
              {"space", read_space},
              {"space dimension", read_space_dimension},
              {"space units", read_space_units},
              {"space directions", read_directions},
              {"space origin", read_origin},
              {"encoding", read_encoding},
              {"endian", read_endian},
              {"line skip", read_line_skip},
              {"lineskip", read_line_skip},
              {"byte skip", read_byte_skip},
              {"byteskip", read_byte_skip},
              {"content", read_content},
              {"data file", read_data_file},
              {"datafile", read_data_file}};

/* "key:=value": whoever writes a file makes them up. One is ours. */
static void read_key(hewn_word key, hewn_nrrd_header *header)
{
    header->level_set = header->level_set || hewn_word_is_any_case(key, HEWN_NRRD_LEVEL_SET);
}

/* Fields that nobody needs here, and other keys, are passed over. */
static hewn_result read_line(nrrd_line *line, hewn_error *error)
{
    const char *at = line->value.at, *end = line->value.end;
    if (at < end && *at == '#')
        return HEWN_OK;
    const char *colon = memchr(at, ':', (size_t)(end - at));
    if (!colon)
        return hewn_scan_fail(&line->value, (hewn_word){at, end}, "expected \"field: value\"", error);
    if (colon + 1 < end && colon[1] == '=') {
        read_key((hewn_word){at, colon}, line->header);
        return HEWN_OK;
    }
    line->field = (hewn_word){at, colon};
    line->value.at = colon + 1;
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (hewn_word_is_any_case(line->field, fields[i].name))
            return fields[i].read(line, error);
    return HEWN_OK;
}

static hewn_result check(const hewn_volume_source *source, const hewn_nrrd_header *header, hewn_error *error)
{
    const char *missing = header->dimension == 0      ? "dimension"
                          : header->axes[0].size == 0 ? "sizes"
                          : !header->has_type         ? "type"
                          : !header->has_encoding     ? "encoding"
                                                      : NULL;
    if (missing)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "the header does not tell the %s", missing);
    bool bytes = header->encoding != HEWN_NRRD_TEXT && hewn_voxel_size(header->type) > 1;
    if (bytes && !header->has_endian)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "the header does not tell the byte order (endian)");
    return HEWN_OK;
}

hewn_result hewn_nrrd_header_read(const hewn_volume_source *source, hewn_nrrd_header *out, hewn_error *error)
{
    hewn_scan scan = {source->bytes, source->bytes + source->length, source->name, 1};
    *out = (hewn_nrrd_header){0};
    for (uint32_t i = 0; i < HEWN_NRRD_AXES; i++)
        out->axes[i].spacing = out->axes[i].min = out->axes[i].max = NAN;
    if (source->length < 8 || memcmp(source->bytes, "NRRD000", 7) != 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 1, "not an NRRD file");
    hewn_scan_line(&scan);
    while (scan.at < scan.end) {
        const char *end = scan.at;
        while (end < scan.end && !hewn_is_line_end(*end))
            end++;
        if (end == scan.at) { /* an empty line ends the header */
            hewn_scan_line(&scan);
            break;
        }
        nrrd_line line = {.value = {scan.at, end, scan.name, scan.line}, .header = out};
        HEWN_TRY(read_line(&line, error));
        hewn_scan_line(&scan);
        if (out->data_list)
            break;
    }
    if (out->data_list)
        out->data_list = scan.at;
    out->samples_at = (size_t)(scan.at - source->bytes);
    return check(source, out, error);
}
