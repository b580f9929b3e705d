/* Geomview's OFF, text and binary: OFF with any of the prefixes ST (texture coordinates), C (colours) and N (normals).
 *
 * What the field leaves open is decided so: vertex colours have as many components as the first vertex's line leaves
 * for them, else the four of the book. Whole numbers from 0 to 255 are bytes, unless none is above 1 and one is 1;
 * everything else is kept as it is. A colour that is missing while others are there is zero; an opacity, opaque. An
 * index into a table of colours, which the file does not have, is passed over. So are faces of one or two corners,
 * which are Geomview's points and lines. */
#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "base/progress.h"
#include "io/builder.h"
#include "io/bytes.h"
#include "io/formats.h"
#include "io/remark.h"
#include "io/scan.h"

enum { REPORT_EVERY = 1 << 14 /* vertices or faces */ };

/* Colours of the first `count` vertices or faces, four numbers each. Where an opacity is missing it is NaN. */
typedef struct off_colors {
    float *items;
    size_t count, room;
    uint32_t components;
    bool real; /* some number is no whole one */
    float least, greatest;
} off_colors;

typedef struct off_reader {
    hewn_scan scan;
    const hewn_progress *progress;
    hewn_builder builder;
    bool has_uvs, has_colors, has_normals, binary;
    uint64_t vertex_count, face_count; /* that the header promises */
    float *normals, *uvs;
    size_t normal_room, uv_room;
    off_colors vertex_colors, face_colors;
} off_reader;

static hewn_result expected(off_reader *reader, const char *what, hewn_error *error)
{
    return hewn_scan_fail(&reader->scan, hewn_scan_word_in_line(&reader->scan), what, error);
}

static hewn_result report(const off_reader *reader, uint64_t done, hewn_error *error)
{
    double all = (double)reader->vertex_count + (double)reader->face_count;
    return done % REPORT_EVERY ? HEWN_OK : hewn_progress_report(reader->progress, "load", (double)done / all, error);
}

/* --- what vertices and faces have --------------------------------------------------------------------------------- */

static hewn_result note_color(off_colors *colors, uint64_t element, const float *color, uint32_t components, bool real,
                              hewn_error *error)
{
    void *items = colors->items;
    HEWN_TRY(hewn_reserve(&items, &colors->room, element + 1, 4 * sizeof(float), error));
    colors->items = items;
    float *to = colors->items + 4 * element;
    memset(colors->items + 4 * colors->count, 0, (element + 1 - colors->count) * 4 * sizeof(float));
    to[3] = NAN;
    for (uint32_t k = 0; k < components; k++) {
        to[k] = isfinite(color[k]) ? color[k] : 0;
        colors->least = fminf(colors->least, to[k]);
        colors->greatest = fmaxf(colors->greatest, to[k]);
    }
    colors->real = colors->real || real;
    colors->components = components > colors->components ? components : colors->components;
    colors->count = element + 1;
    return HEWN_OK;
}

/* Adds to an array of `components` floats for each vertex; the newest vertex is the last. */
static hewn_result note_vector(off_reader *reader, float **array, size_t *room, const float *vector,
                               uint32_t components, hewn_error *error)
{
    uint64_t vertex = reader->builder.model.vertex_count - 1;
    void *items = *array;
    HEWN_TRY(hewn_reserve(&items, room, vertex + 1, components * sizeof(float), error));
    *array = items;
    for (uint32_t k = 0; k < components; k++)
        (*array)[components * vertex + k] = isfinite(vector[k]) ? vector[k] : 0;
    return HEWN_OK;
}

/* --- text --------------------------------------------------------------------------------------------------------- */

static hewn_result read_floats(off_reader *reader, float *out, uint32_t count, bool *real, hewn_error *error)
{
    for (uint32_t k = 0; k < count; k++) {
        hewn_scan_space_and_comments(&reader->scan);
        const char *begin = reader->scan.at;
        if (!hewn_scan_float_in_line(&reader->scan, &out[k]))
            return expected(reader, "a number is expected", error);
        for (; begin < reader->scan.at; begin++)
            *real = *real || !((*begin >= '0' && *begin <= '9') || *begin == '-' || *begin == '+');
    }
    return HEWN_OK;
}

static uint32_t words_left_in_line(hewn_scan scan)
{
    uint32_t count = 0;
    for (; count < 16 && !hewn_scan_line_is_done(&scan); count++)
        hewn_scan_word_in_line(&scan);
    return count;
}

/* Reads the position of a vertex and the normal after it. */
static hewn_result read_position(off_reader *reader, hewn_error *error)
{
    double position[3] = {0};
    float normal[3] = {0};
    bool real = false;
    for (int axis = 0; axis < 3; axis++) {
        hewn_scan_space_and_comments(&reader->scan);
        if (!hewn_scan_double_in_line(&reader->scan, &position[axis]))
            return expected(reader, "a number is expected", error);
    }
    if (!(isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2])))
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, reader->scan.line, "a position is not finite");
    HEWN_TRY(hewn_builder_add_vertex(&reader->builder, position, error));
    if (!reader->has_normals)
        return HEWN_OK;
    HEWN_TRY(read_floats(reader, normal, 3, &real, error));
    return note_vector(reader, &reader->normals, &reader->normal_room, normal, 3, error);
}

static hewn_result read_vertices(off_reader *reader, hewn_error *error)
{
    uint32_t color_count = 4;
    for (uint64_t v = 0; v < reader->vertex_count; v++) {
        float color[4] = {0}, uv[2] = {0};
        bool color_real = false, real = false;
        HEWN_TRY(report(reader, v, error));
        HEWN_TRY(read_position(reader, error));
        if (v == 0) {
            uint32_t left = words_left_in_line(reader->scan), others = reader->has_uvs ? 2 : 0;
            color_count = left == others + 1 || left == others + 3 ? left - others : 4;
        }
        if (reader->has_colors)
            HEWN_TRY(read_floats(reader, color, color_count, &color_real, error));
        if (reader->has_colors && color_count > 1)
            HEWN_TRY(note_color(&reader->vertex_colors, v, color, color_count, color_real, error));
        if (reader->has_uvs) {
            HEWN_TRY(read_floats(reader, uv, 2, &real, error));
            HEWN_TRY(note_vector(reader, &reader->uvs, &reader->uv_room, uv, 2, error));
        }
    }
    return HEWN_OK;
}

static hewn_result check_corner(const off_reader *reader, int64_t vertex, hewn_error *error)
{
    if (vertex >= 0 && (uint64_t)vertex < reader->vertex_count)
        return HEWN_OK;
    return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, reader->binary ? 0 : reader->scan.line,
                        "a face names vertex %lld, but there are %llu", (long long)vertex,
                        (unsigned long long)reader->vertex_count);
}

/* Reads a face but for its colour. */
static hewn_result read_corners(off_reader *reader, int64_t *count, hewn_error *error)
{
    int64_t vertex = 0;
    hewn_scan_space_and_comments(&reader->scan);
    if (!hewn_scan_index_in_line(&reader->scan, count))
        return expected(reader, "the number of a face's corners is expected", error);
    if (*count < 1)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, reader->scan.line, "a face has %lld corners",
                            (long long)*count);
    for (int64_t i = 0; i < *count; i++) {
        hewn_scan_space_and_comments(&reader->scan);
        if (!hewn_scan_index_in_line(&reader->scan, &vertex))
            return expected(reader, "a face's corner is expected", error);
        HEWN_TRY(check_corner(reader, vertex, error));
        if (*count >= 3)
            HEWN_TRY(hewn_builder_add_corner(&reader->builder, (uint32_t)vertex, error));
    }
    return *count >= 3 ? hewn_builder_end_face(&reader->builder, error) : HEWN_OK;
}

/* Three or four numbers before the line ends are the newest face's colour. */
static hewn_result read_face_color(off_reader *reader, hewn_error *error)
{
    float color[4] = {0};
    bool real = false;
    uint32_t count = words_left_in_line(reader->scan);
    if (count != 3 && count != 4)
        return HEWN_OK;
    HEWN_TRY(read_floats(reader, color, count, &real, error));
    return note_color(&reader->face_colors, reader->builder.model.face_count - 1, color, count, real, error);
}

static hewn_result read_faces(off_reader *reader, hewn_error *error)
{
    for (uint64_t f = 0; f < reader->face_count; f++) {
        int64_t count = 0;
        HEWN_TRY(report(reader, reader->vertex_count + f, error));
        HEWN_TRY(read_corners(reader, &count, error));
        if (count >= 3 && !hewn_scan_line_is_done(&reader->scan))
            HEWN_TRY(read_face_color(reader, error));
        hewn_scan_line(&reader->scan);
    }
    return HEWN_OK;
}

/* --- binary ------------------------------------------------------------------------------------------------------- */

static size_t bytes_left(const off_reader *reader)
{
    return (size_t)(reader->scan.end - reader->scan.at);
}

static hewn_result fail_short(const off_reader *reader, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0, "the file ends in the middle of its data");
}

static hewn_result get_word(off_reader *reader, uint32_t *out, hewn_error *error)
{
    if (bytes_left(reader) < 4)
        return fail_short(reader, error);
    *out = hewn_get_u32_big(reader->scan.at);
    reader->scan.at += 4;
    return HEWN_OK;
}

static hewn_result get_floats(off_reader *reader, float *out, uint32_t count, hewn_error *error)
{
    if (bytes_left(reader) < 4 * (size_t)count)
        return fail_short(reader, error);
    for (uint32_t k = 0; k < count; k++)
        out[k] = hewn_get_float_big(reader->scan.at + 4 * (size_t)k);
    reader->scan.at += 4 * (size_t)count;
    return HEWN_OK;
}

static hewn_result get_vertex(off_reader *reader, uint64_t v, hewn_error *error)
{
    float single[4] = {0};
    HEWN_TRY(get_floats(reader, single, 3, error));
    const double position[3] = {(double)single[0], (double)single[1], (double)single[2]};
    HEWN_TRY(hewn_builder_add_vertex(&reader->builder, position, error));
    if (reader->has_normals) {
        HEWN_TRY(get_floats(reader, single, 3, error));
        HEWN_TRY(note_vector(reader, &reader->normals, &reader->normal_room, single, 3, error));
    }
    if (reader->has_colors) {
        HEWN_TRY(get_floats(reader, single, 4, error));
        HEWN_TRY(note_color(&reader->vertex_colors, v, single, 4, true, error));
    }
    if (!reader->has_uvs)
        return HEWN_OK;
    HEWN_TRY(get_floats(reader, single, 2, error));
    return note_vector(reader, &reader->uvs, &reader->uv_room, single, 2, error);
}

static hewn_result get_face(off_reader *reader, hewn_error *error)
{
    uint32_t count = 0, vertex = 0, color_count = 0;
    float color[4] = {0};
    HEWN_TRY(get_word(reader, &count, error));
    if (count == 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0, "a face has 0 corners");
    for (uint32_t i = 0; i < count; i++) {
        HEWN_TRY(get_word(reader, &vertex, error));
        HEWN_TRY(check_corner(reader, vertex, error));
        if (count >= 3)
            HEWN_TRY(hewn_builder_add_corner(&reader->builder, vertex, error));
    }
    if (count >= 3)
        HEWN_TRY(hewn_builder_end_face(&reader->builder, error));
    HEWN_TRY(get_word(reader, &color_count, error));
    if (color_count > bytes_left(reader) / 4)
        return fail_short(reader, error);
    if ((color_count != 3 && color_count != 4) || count < 3) {
        reader->scan.at += 4 * (size_t)color_count;
        return HEWN_OK;
    }
    HEWN_TRY(get_floats(reader, color, color_count, error));
    return note_color(&reader->face_colors, reader->builder.model.face_count - 1, color, color_count, true, error);
}

static hewn_result get_all(off_reader *reader, hewn_error *error)
{
    for (uint64_t v = 0; v < reader->vertex_count; v++) {
        HEWN_TRY(report(reader, v, error));
        HEWN_TRY(get_vertex(reader, v, error));
    }
    for (uint64_t f = 0; f < reader->face_count; f++) {
        HEWN_TRY(report(reader, reader->vertex_count + f, error));
        HEWN_TRY(get_face(reader, error));
    }
    return HEWN_OK;
}

/* --- the header --------------------------------------------------------------------------------------------------- */

static bool take(const char **at, const char *end, const char *prefix, bool *flag)
{
    size_t length = strlen(prefix);
    if ((size_t)(end - *at) < length || memcmp(*at, prefix, length) != 0 || *flag)
        return false;
    *at += length;
    *flag = true;
    return true;
}

/* Prefixes in any order, as some write them; counts may follow without a blank between. */
static hewn_result read_keyword(off_reader *reader, hewn_error *error)
{
    hewn_scan *scan = &reader->scan;
    bool four = false, any = false;
    hewn_scan_space_and_comments(scan);
    hewn_word word = hewn_scan_word_in_line(scan);
    const char *at = word.begin;
    while (take(&at, word.end, "ST", &reader->has_uvs) || take(&at, word.end, "C", &reader->has_colors) ||
           take(&at, word.end, "N", &reader->has_normals) || take(&at, word.end, "4", &four) ||
           take(&at, word.end, "n", &any))
        continue;
    if (word.end - at < 3 || strncasecmp(at, "OFF", 3) != 0 ||
        (word.end - at > 3 && !(at[3] >= '0' && at[3] <= '9') && at[3] != '#'))
        return hewn_scan_fail(scan, word, "\"OFF\" is expected", error);
    if (four || any)
        return hewn_fail_at(error, HEWN_BAD_INPUT, scan->name, scan->line,
                            "the points have %s coordinates; only OFF files with three can be read",
                            four ? "four" : "any number of");
    scan->at = at + 3;
    hewn_scan rest = *scan;
    reader->binary = hewn_word_is(hewn_scan_word_in_line(&rest), "BINARY");
    if (reader->binary) {
        *scan = rest;
        hewn_scan_line(scan);
    }
    return HEWN_OK;
}

static hewn_result read_count(off_reader *reader, const char *what, uint64_t *out, hewn_error *error)
{
    hewn_scan *scan = &reader->scan;
    int64_t count;
    for (hewn_scan_space(scan); scan->at < scan->end && *scan->at == '#'; hewn_scan_space(scan)) {
        const char *begin = scan->at;
        hewn_scan_line(scan);
        hewn_remark_read(begin, scan->at, &reader->builder.model);
    }
    hewn_word word = hewn_scan_word_in_line(scan);
    if (!hewn_word_integer(word, &count) || count < 0)
        return hewn_scan_fail(scan, word, what, error);
    *out = (uint64_t)count;
    return HEWN_OK;
}

/* The number of edges, which means nothing, may be missing at the end of a line that has the other two. */
static hewn_result read_counts(off_reader *reader, hewn_error *error)
{
    uint64_t edges;
    HEWN_TRY(read_count(reader, "the number of vertices is expected", &reader->vertex_count, error));
    uint32_t line = reader->scan.line;
    HEWN_TRY(read_count(reader, "the number of faces is expected", &reader->face_count, error));
    if (reader->scan.line == line && hewn_scan_line_is_done(&reader->scan))
        return HEWN_OK;
    return read_count(reader, "the number of edges is expected", &edges, error);
}

static hewn_result get_counts(off_reader *reader, hewn_error *error)
{
    uint32_t vertices = 0, faces = 0, edges = 0;
    HEWN_TRY(get_word(reader, &vertices, error));
    HEWN_TRY(get_word(reader, &faces, error));
    HEWN_TRY(get_word(reader, &edges, error));
    reader->vertex_count = vertices;
    reader->face_count = faces;
    return HEWN_OK;
}

/* No vertex or face takes less than this, so a promise that cannot be kept is seen before anything is allocated. */
static hewn_result check_counts(const off_reader *reader, hewn_error *error)
{
    uint64_t numbers = 3 + (reader->has_normals ? 3 : 0) + (reader->has_uvs ? 2 : 0),
             colors = reader->has_colors ? (reader->binary ? 4 : 1) : 0, size = reader->binary ? 4 : 2,
             left = bytes_left(reader) + 1, vertices = reader->vertex_count, faces = reader->face_count,
             vertex_size = (numbers + colors) * size, face_size = reader->binary ? 12 : 4;
    if (vertices > left / vertex_size || faces > (left - vertices * vertex_size) / face_size)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0,
                            "%llu vertices and %llu faces are promised, but the file is too short for them",
                            (unsigned long long)vertices, (unsigned long long)faces);
    return HEWN_OK;
}

static hewn_result read_all(off_reader *reader, hewn_error *error)
{
    HEWN_TRY(hewn_scan_begin(&reader->scan, "OFF", error));
    HEWN_TRY(read_keyword(reader, error));
    HEWN_TRY(reader->binary ? get_counts(reader, error) : read_counts(reader, error));
    HEWN_TRY(check_counts(reader, error));
    if (reader->binary)
        return get_all(reader, error);
    HEWN_TRY(read_vertices(reader, error));
    return read_faces(reader, error);
}

/* --- channels ----------------------------------------------------------------------------------------------------- */

static hewn_result add_vectors(hewn_model *model, const char *name, const float *values, uint32_t components,
                               hewn_error *error)
{
    hewn_channel *channel;
    const hewn_attribute_info info = {name, HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, components};
    if (!values)
        return HEWN_OK;
    HEWN_TRY(hewn_model_add_channel(model, &info, &channel, error));
    memcpy(channel->values, values, model->vertex_count * components * sizeof(float));
    return HEWN_OK;
}

static hewn_result add_colors(hewn_model *model, hewn_domain domain, const off_colors *colors, hewn_error *error)
{
    hewn_channel *channel;
    bool bytes = !colors->real && colors->least >= 0 && colors->greatest <= 255 && colors->greatest != 1;
    const hewn_attribute_info info = {"color", domain, bytes ? HEWN_SCALAR_UINT8 : HEWN_SCALAR_FLOAT,
                                      colors->components};
    if (colors->count == 0)
        return HEWN_OK;
    HEWN_TRY(hewn_model_add_channel(model, &info, &channel, error));
    uint8_t *to_bytes = channel->values;
    float *to_floats = channel->values;
    for (uint64_t i = 0; i < colors->count; i++)
        for (uint32_t k = 0; k < info.components; k++) {
            float value = colors->items[4 * i + k];
            value = isnan(value) ? (bytes ? 255.0f : 1.0f) : value;
            if (bytes)
                to_bytes[info.components * i + k] = (uint8_t)value;
            else
                to_floats[info.components * i + k] = value;
        }
    return HEWN_OK;
}

static hewn_result finish(off_reader *reader, hewn_error *error)
{
    hewn_model *model = &reader->builder.model;
    HEWN_TRY(hewn_builder_finish(&reader->builder, reader->scan.name, error));
    HEWN_TRY(add_vectors(model, "normal", reader->normals, 3, error));
    HEWN_TRY(add_colors(model, HEWN_DOMAIN_VERT, &reader->vertex_colors, error));
    HEWN_TRY(add_vectors(model, "uv", reader->uvs, 2, error));
    return add_colors(model, HEWN_DOMAIN_FACE, &reader->face_colors, error);
}

hewn_result hewn_off_read(const hewn_source *source, hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){0};
    off_reader reader = {.scan = {source->bytes, source->bytes + source->length, source->name, 1},
                         .progress = source->progress};
    hewn_result result = read_all(&reader, error);
    if (result == HEWN_OK)
        result = finish(&reader, error);
    if (result == HEWN_OK)
        hewn_builder_move(&reader.builder, out);
    hewn_builder_clear(&reader.builder);
    hewn_free(reader.normals);
    hewn_free(reader.uvs);
    hewn_free(reader.vertex_colors.items);
    hewn_free(reader.face_colors.items);
    return result;
}
