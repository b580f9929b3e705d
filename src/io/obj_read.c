/* Wavefront OBJ: v (with colours), vt, vn, f, o, g, usemtl and s; everything else is passed over.
 *
 * What the field leaves open is decided so: of a v line's numbers 4 to 6 are a colour where all are there, and a lone
 * fourth one, the weight of a rational curve, means nothing to polygons. A colour, texture coordinate or normal that is
 * missing somewhere while others have one, or that is not finite, is zero. Texture coordinates and normals are a
 * channel of vertices where every vertex has one value at all its corners, else of corners. Labels are channels of
 * faces whose values are numbered by first use; a face before the first label has -1. "smooth" is the number after s, 0
 * for off. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/progress.h"
#include "io/builder.h"
#include "io/formats.h"
#include "io/parts.h"
#include "io/remark.h"
#include "io/scan.h"

static const uint32_t NONE = 0xFFFFFFFFu, UNSET = 0xFFFFFFFEu;

enum { REPORT_EVERY = 1 << 20 /* bytes */, PART = 1 << 14 /* vertices or faces */ };

/* The greatest number by which faces name something, 1-based, and where. */
typedef struct obj_range {
    uint64_t greatest;
    uint32_t line;
} obj_range;

/* The values of vt or vn lines, and which of them corners take. */
typedef struct obj_values {
    const char *what;
    uint32_t components;
    float *items;
    size_t count, room;
    uint32_t *of; /* for the first of_count corners: a value or NONE; later ones have none */
    uint64_t of_count;
    size_t of_room;
    obj_range range;
    bool skipped; /* nobody wants them: they are counted only */
} obj_values;

/* From face number `face` on. */
typedef struct obj_label {
    uint64_t face;
    hewn_word name; /* empty: none */
    uint32_t smooth;
} obj_label;

typedef enum label_kind { LABEL_OBJECT, LABEL_GROUP, LABEL_MATERIAL, LABEL_SMOOTH, LABEL_COUNT } label_kind;

typedef struct obj_labels {
    obj_label *items;
    size_t count, room;
} obj_labels;

typedef struct obj_reader {
    hewn_scan scan;
    hewn_builder builder;
    float *colors; /* of the first color_count vertices */
    size_t color_count, color_room;
    obj_values uvs, normals;
    obj_range range; /* of vertices */
    obj_labels labels[LABEL_COUNT];
    uint64_t vertices_before;                                /* that were handed out in parts */
    const hewn_part_taker *taker;                            /* of parts; NULL: the file is read as a whole */
    bool has_colors, has_uvs, has_normals, has[LABEL_COUNT]; /* of parts: what the file has anywhere */
    hewn_model *about;
} obj_reader;

static hewn_result fail_here(const obj_reader *reader, const char *what, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, reader->scan.line, "%s", what);
}

static hewn_result expected(obj_reader *reader, const char *what, hewn_error *error)
{
    return hewn_scan_fail(&reader->scan, hewn_scan_word_in_line(&reader->scan), what, error);
}

/* --- vertices and their values ------------------------------------------------------------------------------------ */

static hewn_result note_color(obj_reader *reader, const float color[3], hewn_error *error)
{
    size_t vertex = reader->builder.model.vertex_count - 1;
    void *items = reader->colors;
    HEWN_TRY(hewn_reserve(&items, &reader->color_room, vertex + 1, 3 * sizeof(float), error));
    reader->colors = items;
    memset(reader->colors + 3 * reader->color_count, 0, (vertex - reader->color_count) * 3 * sizeof(float));
    for (int k = 0; k < 3; k++)
        reader->colors[3 * vertex + k] = isfinite(color[k]) ? color[k] : 0;
    reader->color_count = vertex + 1;
    return HEWN_OK;
}

static hewn_result read_vertex(obj_reader *reader, hewn_error *error)
{
    double position[3];
    for (int axis = 0; axis < 3; axis++)
        if (!hewn_scan_double_in_line(&reader->scan, &position[axis]))
            return expected(reader, "a number is expected", error);
    if (!(isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2])))
        return fail_here(reader, "a position is not finite", error);
    HEWN_TRY(hewn_builder_add_vertex(&reader->builder, position, error));
    float color[3];
    int count = 0;
    while (count < 3 && !hewn_scan_line_is_done(&reader->scan) && hewn_scan_float_in_line(&reader->scan, &color[count]))
        count++;
    return count == 3 ? note_color(reader, color, error) : HEWN_OK;
}

/* A vt line may leave out all but the first number. */
static hewn_result read_value(obj_reader *reader, obj_values *values, uint32_t least, hewn_error *error)
{
    if (values->skipped) {
        values->count++;
        return HEWN_OK;
    }
    void *items = values->items;
    HEWN_TRY(hewn_reserve(&items, &values->room, values->count + 1, values->components * sizeof(float), error));
    values->items = items;
    float *value = values->items + values->components * values->count;
    for (uint32_t k = 0; k < values->components; k++) {
        value[k] = 0;
        bool there = (k < least || !hewn_scan_line_is_done(&reader->scan));
        if (there && !hewn_scan_float_in_line(&reader->scan, &value[k]))
            return expected(reader, "a number is expected", error);
        if (!isfinite(value[k]))
            value[k] = 0;
    }
    values->count++;
    return HEWN_OK;
}

/* --- faces -------------------------------------------------------------------------------------------------------- */

/* A 1-based or, counted from the end, negative number to a 0-based one. Numbers of things yet to come are allowed, and
 * checked at the end of the file against the greatest. */
static bool resolve(int64_t number, uint64_t count, obj_range *range, uint32_t line, uint32_t *out)
{
    int64_t index = number > 0 ? number - 1 : (int64_t)count + number;
    if (number == 0 || index < 0 || index >= (int64_t)UNSET)
        return false;
    if ((uint64_t)index + 1 > range->greatest)
        *range = (obj_range){(uint64_t)index + 1, line};
    *out = (uint32_t)index;
    return true;
}

/* What follows a slash, which may be nothing. */
static const char *parse_value(const obj_reader *reader, obj_values *values, const char *at, uint32_t *out)
{
    int64_t number;
    *out = NONE;
    if (at == reader->scan.end || !((*at >= '0' && *at <= '9') || *at == '-' || *at == '+'))
        return at;
    at = hewn_parse_index(at, reader->scan.end, &number);
    return at && resolve(number, values->count, &values->range, reader->scan.line, out) ? at : NULL;
}

static hewn_result note_value(obj_values *values, uint64_t corner, uint32_t value, hewn_error *error)
{
    if (value == NONE || values->skipped)
        return HEWN_OK;
    void *items = values->of;
    HEWN_TRY(hewn_reserve(&items, &values->of_room, corner + 1, sizeof(uint32_t), error));
    values->of = items;
    memset(values->of + values->of_count, 0xff, (corner - values->of_count) * sizeof(uint32_t));
    values->of[corner] = value;
    values->of_count = corner + 1;
    return HEWN_OK;
}

/* v, v/vt, v//vn, v/vt/vn; the parts after a slash may be missing. */
static hewn_result read_corner(obj_reader *reader, hewn_error *error)
{
    hewn_scan *scan = &reader->scan;
    const char *at = scan->at, *end = scan->end;
    int64_t number;
    uint32_t vertex, uv = NONE, normal = NONE;
    at = hewn_parse_index(at, end, &number);
    const uint64_t count = reader->vertices_before + reader->builder.model.vertex_count;
    if (!at || !resolve(number, count, &reader->range, scan->line, &vertex))
        return expected(reader, "a face's corner is expected", error);
    if (at < end && *at == '/')
        at = parse_value(reader, &reader->uvs, at + 1, &uv);
    if (at && at < end && *at == '/')
        at = parse_value(reader, &reader->normals, at + 1, &normal);
    if (!at || !hewn_scan_ends_word(scan, at))
        return expected(reader, "a face's corner is expected", error);
    scan->at = at;
    uint64_t corner = reader->builder.corner_count;
    HEWN_TRY(note_value(&reader->uvs, corner, uv, error));
    HEWN_TRY(note_value(&reader->normals, corner, normal, error));
    return hewn_builder_add_corner(&reader->builder, vertex, error);
}

static hewn_result read_face(obj_reader *reader, hewn_error *error)
{
    uint64_t before = reader->builder.corner_count;
    while (!hewn_scan_line_is_done(&reader->scan))
        HEWN_TRY(read_corner(reader, error));
    if (reader->builder.corner_count - before < 3)
        return fail_here(reader, "a face needs at least three corners", error);
    return hewn_builder_end_face(&reader->builder, error);
}

/* --- labels ------------------------------------------------------------------------------------------------------- */

static bool is_control(char c)
{
    return (unsigned char)c <= ' ' || c == 0x7f;
}

/* The rest of the line, blanks and all: names hold # and spaces. */
static hewn_word read_name(hewn_scan *scan)
{
    hewn_scan_blanks(scan);
    hewn_word name = {scan->at, scan->at};
    while (scan->at < scan->end && !hewn_is_line_end(*scan->at))
        scan->at++;
    name.end = scan->at;
    while (name.begin < name.end && is_control(*name.begin))
        name.begin++;
    while (name.end > name.begin && (is_control(name.end[-1]) || name.end[-1] == '\\'))
        name.end--;
    return name;
}

static hewn_result add_label(obj_reader *reader, label_kind kind, hewn_word name, uint32_t smooth, hewn_error *error)
{
    obj_labels *labels = &reader->labels[kind];
    uint64_t face = reader->builder.model.face_count;
    if (labels->count == 0 || labels->items[labels->count - 1].face != face) {
        void *items = labels->items;
        HEWN_TRY(hewn_reserve(&items, &labels->room, labels->count + 1, sizeof(obj_label), error));
        labels->items = items;
        labels->count++;
    }
    labels->items[labels->count - 1] = (obj_label){face, name, smooth};
    return HEWN_OK;
}

static hewn_result read_name_label(obj_reader *reader, label_kind kind, hewn_error *error)
{
    return add_label(reader, kind, read_name(&reader->scan), 0, error);
}

/* Numbers up to 2^32 - 1, which some take for sets of groups; "on" is 1, "off" and everything else 0. */
static hewn_result read_smooth(obj_reader *reader, hewn_error *error)
{
    hewn_word word = hewn_scan_word_in_line(&reader->scan);
    int64_t number = 0;
    if (!hewn_word_integer(word, &number) || number < 0 || number > (int64_t)UINT32_MAX)
        number = hewn_word_is(word, "on");
    return add_label(reader, LABEL_SMOOTH, (hewn_word){0}, (uint32_t)number, error);
}

/* --- the file ----------------------------------------------------------------------------------------------------- */

/* Past the rest of a statement that began at `begin`, which lines that end with a backslash continue. Comments are not
 * continued: they may well end with a path. */
static void end_statement(hewn_scan *scan, const char *begin)
{
    while (scan->at < scan->end) {
        bool comment = *scan->at == '#';
        while (scan->at < scan->end && !hewn_is_line_end(*scan->at))
            scan->at++;
        bool continued = !comment && begin < scan->at && scan->at < scan->end && scan->at[-1] == '\\';
        hewn_scan_line(scan);
        if (!continued)
            return;
    }
}

static void read_comment(obj_reader *reader)
{
    const char *begin = reader->scan.at;
    hewn_scan_line(&reader->scan);
    if (reader->vertices_before + reader->builder.model.vertex_count == 0)
        hewn_remark_read(begin, reader->scan.at, &reader->builder.model);
}

static hewn_result read_statement(obj_reader *reader, hewn_error *error)
{
    hewn_word word = hewn_scan_word_in_line(&reader->scan);
    if (hewn_word_is(word, "v"))
        return read_vertex(reader, error);
    if (hewn_word_is(word, "f") || hewn_word_is(word, "fo"))
        return read_face(reader, error);
    if (hewn_word_is(word, "vn"))
        return read_value(reader, &reader->normals, 3, error);
    if (hewn_word_is(word, "vt"))
        return read_value(reader, &reader->uvs, 1, error);
    if (hewn_word_is(word, "o"))
        return read_name_label(reader, LABEL_OBJECT, error);
    if (hewn_word_is(word, "g"))
        return read_name_label(reader, LABEL_GROUP, error);
    if (hewn_word_is(word, "usemtl"))
        return read_name_label(reader, LABEL_MATERIAL, error);
    if (hewn_word_is(word, "s"))
        return read_smooth(reader, error);
    return HEWN_OK;
}

static hewn_result hand_out(obj_reader *reader, uint64_t least, hewn_error *error);

static hewn_result read_statements(obj_reader *reader, const hewn_progress *progress, hewn_error *error)
{
    hewn_scan *scan = &reader->scan;
    const char *begin = scan->at, *report = scan->at;
    while (scan->at < scan->end) {
        if (scan->at >= report) {
            double fraction = (double)(scan->at - begin) / (double)(scan->end - begin);
            HEWN_TRY(hewn_progress_report(progress, "load", fraction, error));
            report = scan->end - scan->at > REPORT_EVERY ? scan->at + REPORT_EVERY : scan->end;
        }
        hewn_scan_blanks(scan);
        if (scan->at < scan->end && *scan->at == '#') {
            read_comment(reader);
        } else {
            const char *statement = scan->at;
            HEWN_TRY(read_statement(reader, error));
            end_statement(scan, statement);
            if (reader->taker)
                HEWN_TRY(hand_out(reader, PART, error));
        }
    }
    return HEWN_OK;
}

static hewn_result check_range(const obj_reader *reader, obj_range range, uint64_t count, const char *what,
                               hewn_error *error)
{
    if (range.greatest <= count)
        return HEWN_OK;
    return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, range.line,
                        "a face names %s %llu, but there are %llu", what, (unsigned long long)range.greatest,
                        (unsigned long long)count);
}

/* Some exporters number values that they leave out altogether; then there simply are none. */
static hewn_result check_ranges(const obj_reader *reader, hewn_error *error)
{
    const uint64_t vertices = reader->vertices_before + reader->builder.model.vertex_count;
    HEWN_TRY(check_range(reader, reader->range, vertices, "vertex", error));
    const obj_values *all[] = {&reader->uvs, &reader->normals};
    for (int i = 0; i < 2; i++)
        if (all[i]->count > 0)
            HEWN_TRY(check_range(reader, all[i]->range, all[i]->count, all[i]->what, error));
    return HEWN_OK;
}

/* --- channels ----------------------------------------------------------------------------------------------------- */

static hewn_result add_colors(obj_reader *reader, hewn_error *error)
{
    hewn_channel *channel;
    static const hewn_attribute_info info = {"color", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3};
    if (reader->color_count == 0)
        return HEWN_OK;
    HEWN_TRY(hewn_model_add_channel(&reader->builder.model, &info, &channel, error));
    memcpy(channel->values, reader->colors, reader->color_count * 3 * sizeof(float));
    return HEWN_OK;
}

/* The value of a corner; what is missing is zero. */
static const float *value_at(const obj_values *values, uint32_t value)
{
    static const float zero[3];
    return value < values->count ? values->items + (size_t)values->components * value : zero;
}

static uint32_t value_of(const obj_values *values, uint64_t corner)
{
    return corner < values->of_count ? values->of[corner] : NONE;
}

static bool has_own_numbers(const hewn_model *model, const obj_values *values)
{
    uint64_t count = hewn_model_corner_count(model);
    if (values->count != model->vertex_count || (values->of_count == 0 && count > 0))
        return false;
    for (uint64_t corner = 0; corner < count; corner++)
        if (value_of(values, corner) != model->corners[corner])
            return false;
    return true;
}

/* Fills in which value a vertex has at all its corners; false where one has two. */
static bool find_values_of_vertices(const hewn_model *model, const obj_values *values, uint32_t *of)
{
    uint64_t count = hewn_model_corner_count(model);
    for (uint64_t v = 0; v < model->vertex_count; v++)
        of[v] = UNSET;
    for (uint64_t corner = 0; corner < count; corner++) {
        uint32_t *slot = &of[model->corners[corner]], value = value_of(values, corner);
        if (*slot == UNSET)
            *slot = value;
        else if (*slot != value &&
                 memcmp(value_at(values, *slot), value_at(values, value), values->components * sizeof(float)) != 0)
            return false;
    }
    return true;
}

/* A channel of as many elements as `domain` has; element i takes value of[i], or i where `of` is NULL. */
static hewn_result add_values(hewn_model *model, const char *name, hewn_domain domain, const obj_values *values,
                              const uint32_t *of, hewn_error *error)
{
    hewn_channel *channel;
    const hewn_attribute_info info = {name, domain, HEWN_SCALAR_FLOAT, values->components};
    HEWN_TRY(hewn_model_add_channel(model, &info, &channel, error));
    uint64_t count = domain == HEWN_DOMAIN_VERT ? model->vertex_count : values->of_count;
    float *to = channel->values;
    for (uint64_t i = 0; i < count; i++)
        memcpy(to + values->components * i, value_at(values, of ? of[i] : (uint32_t)i),
               values->components * sizeof(float));
    return HEWN_OK;
}

static hewn_result add_value_channel(hewn_model *model, const char *name, const obj_values *values, hewn_error *error)
{
    if (values->count == 0)
        return HEWN_OK;
    if (has_own_numbers(model, values))
        return add_values(model, name, HEWN_DOMAIN_VERT, values, NULL, error);
    if (values->of_count == 0)
        return HEWN_OK;
    uint32_t *of = hewn_alloc(model->vertex_count, sizeof *of);
    if (!of)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory");
    bool of_vertices = find_values_of_vertices(model, values, of);
    hewn_result result = of_vertices ? add_values(model, name, HEWN_DOMAIN_VERT, values, of, error)
                                     : add_values(model, name, HEWN_DOMAIN_CORNER, values, values->of, error);
    hewn_free(of);
    return result;
}

/* Names are one line of plain text in a model as they are here. */
static hewn_result value_of_name(hewn_channel *channel, hewn_word name, int32_t *out, hewn_error *error)
{
    size_t length = (size_t)(name.end - name.begin);
    *out = -1;
    if (length == 0)
        return HEWN_OK;
    char *text = hewn_alloc(length + 1, 1);
    if (!text)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory");
    for (size_t i = 0; i < length; i++)
        text[i] = is_control(name.begin[i]) ? ' ' : name.begin[i];
    text[length] = '\0';
    hewn_result result = hewn_channel_value(channel, text, out, error);
    hewn_free(text);
    return result;
}

static bool says_anything(const obj_labels *labels, uint64_t face_count)
{
    for (size_t i = 0; i < labels->count && labels->items[i].face < face_count; i++)
        if (labels->items[i].smooth != 0 || labels->items[i].name.begin < labels->items[i].name.end)
            return true;
    return false;
}

static hewn_result add_label_channel(obj_reader *reader, label_kind kind, const char *name, hewn_error *error)
{
    hewn_model *model = &reader->builder.model;
    const obj_labels *labels = &reader->labels[kind];
    if (!reader->taker && !says_anything(labels, model->face_count))
        return HEWN_OK;
    hewn_channel *channel;
    const hewn_attribute_info info = {name, HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1};
    HEWN_TRY(hewn_model_add_channel(model, &info, &channel, error));
    int32_t *values = channel->values, value = kind == LABEL_SMOOTH ? 0 : -1;
    uint64_t face = 0;
    for (size_t i = 0; i <= labels->count && face < model->face_count; i++) {
        uint64_t end = i < labels->count ? labels->items[i].face : model->face_count;
        while (face < end)
            values[face++] = value;
        if (i < labels->count && kind == LABEL_SMOOTH)
            memcpy(&value, &labels->items[i].smooth, sizeof value);
        else if (i < labels->count && face < model->face_count)
            HEWN_TRY(value_of_name(channel, labels->items[i].name, &value, error));
    }
    return HEWN_OK;
}

static hewn_result add_channels(obj_reader *reader, hewn_error *error)
{
    static const char *const names[LABEL_COUNT] = {"object", "group", "material", "smooth"};
    hewn_model *model = &reader->builder.model;
    HEWN_TRY(add_colors(reader, error));
    HEWN_TRY(add_value_channel(model, "uv", &reader->uvs, error));
    HEWN_TRY(add_value_channel(model, "normal", &reader->normals, error));
    for (int kind = 0; kind < LABEL_COUNT; kind++)
        HEWN_TRY(add_label_channel(reader, (label_kind)kind, names[kind], error));
    return HEWN_OK;
}

/* UTF-16 has a mark of its own or zero bytes; text that this format is in has neither. */
static hewn_result check_text(obj_reader *reader, hewn_error *error)
{
    hewn_scan *scan = &reader->scan;
    HEWN_TRY(hewn_scan_begin(scan, "OBJ", error));
    size_t length = (size_t)(scan->end - scan->at), looked = length < 512 ? length : 512;
    if (looked > 0 && memchr(scan->at, 0, looked))
        return fail_here(reader, "this is not text, so it is not an OBJ file", error);
    return HEWN_OK;
}

static void clear_reader(obj_reader *reader)
{
    hewn_builder_clear(&reader->builder);
    hewn_free(reader->colors);
    hewn_free(reader->uvs.items);
    hewn_free(reader->uvs.of);
    hewn_free(reader->normals.items);
    hewn_free(reader->normals.of);
    for (int kind = 0; kind < LABEL_COUNT; kind++)
        hewn_free(reader->labels[kind].items);
}

hewn_result hewn_obj_read(const hewn_source *source, hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){0};
    obj_reader reader = {.scan = {source->bytes, source->bytes + source->length, source->name, 1},
                         .uvs = {.what = "texture coordinate", .components = 2},
                         .normals = {.what = "normal", .components = 3}};
    hewn_result result = check_text(&reader, error);
    if (result == HEWN_OK)
        result = read_statements(&reader, source->progress, error);
    if (result == HEWN_OK)
        result = check_ranges(&reader, error);
    if (result == HEWN_OK)
        result = hewn_builder_finish(&reader.builder, source->name, error);
    if (result == HEWN_OK)
        result = add_channels(&reader, error);
    if (result == HEWN_OK)
        hewn_builder_move(&reader.builder, out);
    clear_reader(&reader);
    return result;
}

/* --- in parts ----------------------------------------------------------------------------------------------------- */

/* Tables grow by doubling. */
static hewn_result check_memory(const obj_reader *reader, uint64_t uvs, uint64_t normals, hewn_error *error)
{
    const uint64_t bytes = 2 * ((reader->uvs.skipped ? 0 : 8 * uvs) + (reader->normals.skipped ? 0 : 12 * normals));
    if (bytes <= reader->taker->memory)
        return HEWN_OK;
    return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, reader->scan.name, 0,
                        "the file's texture coordinates and normals take up to %llu bytes, and %llu are left for them; "
                        "--preserve says which of them count",
                        (unsigned long long)bytes, (unsigned long long)reader->taker->memory);
}

/* What there is in the file, so that all parts have the same channels. */
static hewn_result look_through(obj_reader *reader, const hewn_progress *progress, hewn_error *error)
{
    static const char *const words[LABEL_COUNT] = {"o", "g", "usemtl", "s"};
    hewn_scan *scan = &reader->scan;
    const char *report = scan->at;
    uint64_t uvs = 0, normals = 0;
    while (scan->at < scan->end) {
        if (scan->at >= report) {
            HEWN_TRY(hewn_progress_report(progress, "load", 0, error));
            report = scan->end - scan->at > REPORT_EVERY ? scan->at + REPORT_EVERY : scan->end;
        }
        hewn_scan_blanks(scan);
        const char *statement = scan->at;
        const hewn_word word = hewn_scan_word_in_line(scan);
        int numbers = 0;
        while (!reader->has_colors && hewn_word_is(word, "v") && numbers < 6 && !hewn_scan_line_is_done(scan)) {
            hewn_scan_word_in_line(scan);
            reader->has_colors = ++numbers == 6;
        }
        uvs += hewn_word_is(word, "vt");
        normals += hewn_word_is(word, "vn");
        for (int kind = 0; kind < LABEL_COUNT; kind++) {
            if (reader->has[kind] || !hewn_word_is(word, words[kind]))
                continue;
            const hewn_word name = kind == LABEL_SMOOTH ? hewn_scan_word_in_line(scan) : read_name(scan);
            const bool none = kind == LABEL_SMOOTH && (hewn_word_is(name, "off") || hewn_word_is(name, "0"));
            reader->has[kind] = name.begin < name.end && !none;
        }
        end_statement(scan, statement);
    }
    reader->has_uvs = uvs > 0;
    reader->has_normals = normals > 0;
    return check_memory(reader, uvs, normals, error);
}
static hewn_result hand_out_vertices(obj_reader *reader, hewn_error *error)
{
    static const hewn_attribute_info info = {"color", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3};
    hewn_model *model = &reader->builder.model, part = {.vertex_count = model->vertex_count};
    hewn_channel *channel = NULL;
    part.positions = model->positions;
    hewn_result result = reader->has_colors ? hewn_model_add_channel(&part, &info, &channel, error) : HEWN_OK;
    if (result == HEWN_OK && channel && reader->color_count > 0)
        memcpy(channel->values, reader->colors, reader->color_count * 3 * sizeof(float));
    if (result == HEWN_OK)
        result = reader->taker->take(reader->taker->user, &part, error);
    part.positions = NULL;
    hewn_model_destroy(&part);
    reader->vertices_before += model->vertex_count;
    model->vertex_count = 0;
    reader->color_count = 0;
    return result;
}

/* The next part's faces go on with the labels of the last one. */
static void carry_labels(obj_reader *reader)
{
    for (int kind = 0; kind < LABEL_COUNT; kind++) {
        obj_labels *labels = &reader->labels[kind];
        if (labels->count > 0) {
            labels->items[0] = labels->items[labels->count - 1];
            labels->items[0].face = 0;
            labels->count = 1;
        }
    }
}

static hewn_result add_part_values(obj_reader *reader, const char *name, obj_values *values, hewn_error *error)
{
    if (!values->skipped && values->range.greatest > values->count)
        return hewn_fail_at(error, HEWN_LIMIT, reader->scan.name, values->range.line,
                            "a face names %s %llu, which does not come before it; a file that does not fit in the "
                            "memory allowed cannot have that",
                            values->what, (unsigned long long)values->range.greatest);
    hewn_result result = add_values(&reader->builder.model, name, HEWN_DOMAIN_CORNER, values, values->of, error);
    values->of_count = 0;
    return result;
}

/* Afterwards there are no faces. */
static hewn_result hand_out_faces(obj_reader *reader, hewn_error *error)
{
    static const char *const names[LABEL_COUNT] = {"object", "group", "material", "smooth"};
    hewn_model *model = &reader->builder.model;
    if (reader->has_uvs)
        HEWN_TRY(add_part_values(reader, "uv", &reader->uvs, error));
    if (reader->has_normals)
        HEWN_TRY(add_part_values(reader, "normal", &reader->normals, error));
    for (int kind = 0; kind < LABEL_COUNT; kind++)
        if (reader->has[kind])
            HEWN_TRY(add_label_channel(reader, (label_kind)kind, names[kind], error));
    HEWN_TRY(reader->taker->take(reader->taker->user, model, error));
    carry_labels(reader);
    double *positions = model->positions;
    const size_t room = reader->builder.position_room;
    model->positions = NULL;
    hewn_builder_clear(&reader->builder);
    model->positions = positions;
    reader->builder.position_room = room;
    return HEWN_OK;
}

/* Hands out what was read where that are `least` vertices or faces. */
static hewn_result hand_out(obj_reader *reader, uint64_t least, hewn_error *error)
{
    const hewn_model *model = &reader->builder.model;
    if (model->vertex_count < least && model->face_count < least)
        return HEWN_OK;
    if (reader->vertices_before == 0)
        *reader->about = (hewn_model){.unit = model->unit, .up = model->up, .up_known = model->up_known};
    if (model->vertex_count > 0)
        HEWN_TRY(hand_out_vertices(reader, error));
    return model->face_count > 0 ? hand_out_faces(reader, error) : HEWN_OK;
}

static hewn_result read_in_parts(obj_reader *reader, const hewn_source *source, hewn_error *error)
{
    HEWN_TRY(check_text(reader, error));
    const hewn_scan begin = reader->scan;
    HEWN_TRY(look_through(reader, source->progress, error));
    reader->scan = begin;
    HEWN_TRY(read_statements(reader, source->progress, error));
    HEWN_TRY(hand_out(reader, 1, error));
    return check_ranges(reader, error);
}

hewn_result hewn_obj_read_parts(const hewn_source *source, const hewn_part_taker *taker, hewn_model *about,
                                hewn_error *error)
{
    obj_reader reader = {
        .scan = {source->bytes, source->bytes + source->length, source->name, 1},
        .uvs = {.what = "texture coordinate", .components = 2, .skipped = taker->no_uvs},
        .normals = {.what = "normal", .components = 3, .skipped = taker->no_normals},
        .taker = taker,
        .about = about,
    };
    *about = (hewn_model){0};
    hewn_result result = read_in_parts(&reader, source, error);
    clear_reader(&reader);
    return result;
}
