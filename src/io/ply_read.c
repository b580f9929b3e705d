/* Stanford PLY: text and both binary orders; vertices, faces and triangle strips with their properties. Other elements
 * are passed over, and so are faces of fewer than three corners, with their values. */
#include <math.h>
#include <string.h>

#include "base/progress.h"
#include "io/builder.h"
#include "io/bytes.h"
#include "io/formats.h"
#include "io/parts.h"
#include "io/ply_channels.h"
#include "io/ply_layout.h"
#include "io/ply_values.h"
#include "io/remark.h"

/* Items of a fixed size that are decoded property by property, and items of a part. */
enum { BLOCK = 512, PART = 1 << 14 };

typedef struct ply_reader {
    const hewn_source *source;
    hewn_scan scan;
    hewn_ply_header header;
    bool text, big;
    hewn_builder builder;
    hewn_ply_layout vertices, faces;
    uint64_t first_face; /* of those that `faces` has values of */
} ply_reader;

/* --- single values and lists -------------------------------------------------------------------------------------- */

static hewn_result fail_short(const ply_reader *reader, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0, "the file ends before its last element does");
}

static hewn_result read_value(ply_reader *reader, hewn_ply_type type, double *out, hewn_error *error)
{
    if (reader->text)
        return hewn_ply_read_word(&reader->scan, type, out, error);
    size_t size = hewn_ply_type_size(type);
    if ((size_t)(reader->scan.end - reader->scan.at) < size)
        return fail_short(reader, error);
    hewn_ply_run run = {type, reader->big, reader->scan.at, 0, HEWN_SCALAR_DOUBLE, (char *)out, 0, 1};
    hewn_ply_decode(&run);
    reader->scan.at += size;
    return HEWN_OK;
}

/* `count` values that follow each other, to scalars that do. A list's length is checked before, so that they fit. */
static hewn_result read_values(ply_reader *reader, hewn_ply_type type, const hewn_ply_column *column, char *to,
                               size_t count, hewn_error *error)
{
    size_t size = hewn_ply_type_size(type), step = column->size;
    for (size_t i = 0; reader->text && i < count; i++) {
        double value = 0;
        HEWN_TRY(hewn_ply_read_word(&reader->scan, type, &value, error));
        hewn_ply_store(value, column->scalar, to + i * step);
    }
    if (reader->text)
        return HEWN_OK;
    if ((size_t)(reader->scan.end - reader->scan.at) / size < count)
        return fail_short(reader, error);
    hewn_ply_run run = {type, reader->big, reader->scan.at, size, column->scalar, to, step, count};
    hewn_ply_decode(&run);
    reader->scan.at += count * size;
    return HEWN_OK;
}

static hewn_result skip_values(ply_reader *reader, hewn_ply_type type, uint64_t count, hewn_error *error)
{
    if (reader->text) {
        for (uint64_t i = 0; i < count; i++)
            if (hewn_scan_word(&reader->scan).begin == reader->scan.end)
                return fail_short(reader, error);
        return HEWN_OK;
    }
    size_t size = hewn_ply_type_size(type);
    if ((size_t)(reader->scan.end - reader->scan.at) / size < count)
        return fail_short(reader, error);
    reader->scan.at += (size_t)count * size;
    return HEWN_OK;
}

/* A list's length, which the rest of the file must be able to hold. */
static hewn_result read_length(ply_reader *reader, const hewn_ply_property *property, uint64_t *out, hewn_error *error)
{
    double length = 0; /* a whole number of 32 bits or fewer */
    if (!reader->text && hewn_ply_type_size(property->count_type) == 1 && reader->scan.at < reader->scan.end)
        length = property->count_type == HEWN_PLY_UINT8 ? (unsigned char)*reader->scan.at++
                                                        : (signed char)*reader->scan.at++;
    else
        HEWN_TRY(read_value(reader, property->count_type, &length, error));
    uint64_t least = reader->text ? 2 : hewn_ply_type_size(property->type);
    uint64_t room = (uint64_t)(reader->scan.end - reader->scan.at) + (reader->text ? 1 : 0);
    if (length < 0 || (uint64_t)length * least > room)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, reader->scan.line,
                            "a list of %.0f values does not fit in the rest of the file", length);
    *out = (uint64_t)length;
    return HEWN_OK;
}

/* --- lists of corners --------------------------------------------------------------------------------------------- */

static hewn_result read_corner(ply_reader *reader, hewn_ply_type type, bool strip, int64_t *out, hewn_error *error)
{
    double value = 0;
    HEWN_TRY(read_value(reader, type, &value, error));
    bool restart = strip && value == -1;
    if (!restart && !(value >= 0 && value < 4294967295.0 && value == floor(value)))
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, reader->scan.line, "%g is not a vertex's number",
                            value);
    *out = (int64_t)value;
    return HEWN_OK;
}

/* Numbers of 32 bits that are all good, as they are in most files; false, and nothing done, where that is not so. */
static bool take_corners(ply_reader *reader, hewn_ply_type type, size_t length)
{
    bool quick = !reader->text && (type == HEWN_PLY_INT32 || type == HEWN_PLY_UINT32) &&
                 (size_t)(reader->scan.end - reader->scan.at) / 4 >= length;
    uint32_t most = 0;
    if (!quick)
        return false;
    uint32_t *to = reader->builder.model.corners + reader->builder.corner_count;
    hewn_ply_run run = {HEWN_PLY_INT32, reader->big, reader->scan.at, 4, HEWN_SCALAR_INT32, (char *)to, 4, length};
    hewn_ply_decode(&run);
    for (size_t i = 0; i < length; i++)
        most = to[i] > most ? to[i] : most;
    if (most > (type == HEWN_PLY_INT32 ? (uint32_t)INT32_MAX : HEWN_NONE - 1))
        return false;
    reader->builder.corner_count += length;
    reader->scan.at += 4 * length;
    return true;
}

static hewn_result read_polygon(ply_reader *reader, const hewn_ply_property *property, hewn_error *error)
{
    uint64_t length = 0;
    HEWN_TRY(read_length(reader, property, &length, error));
    if (length == 0)
        return HEWN_OK;
    hewn_builder *builder = &reader->builder;
    void *items = builder->model.corners;
    HEWN_TRY(
        hewn_reserve(&items, &builder->corner_room, (size_t)(builder->corner_count + length), sizeof(uint32_t), error));
    builder->model.corners = items;
    if (take_corners(reader, property->type, (size_t)length))
        return HEWN_OK;
    for (uint64_t i = 0; i < length; i++) {
        int64_t corner = 0;
        HEWN_TRY(read_corner(reader, property->type, false, &corner, error));
        builder->model.corners[builder->corner_count++] = (uint32_t)corner;
    }
    return HEWN_OK;
}

/* Strips, parted by -1. Every other triangle of a strip runs the other way, and those with two equal corners only turn
 * the strip. */
static hewn_result read_strips(ply_reader *reader, const hewn_ply_property *property, hewn_error *error)
{
    uint64_t length = 0, run = 0;
    int64_t a = 0, b = 0, c = 0;
    HEWN_TRY(read_length(reader, property, &length, error));
    for (uint64_t i = 0; i < length; i++) {
        HEWN_TRY(read_corner(reader, property->type, true, &c, error));
        if (c < 0) {
            run = 0;
            continue;
        }
        if (run >= 2 && a != b && b != c && c != a)
            HEWN_TRY(hewn_builder_add_triangle(&reader->builder, (uint32_t)(run % 2 == 0 ? a : b),
                                               (uint32_t)(run % 2 == 0 ? b : a), (uint32_t)c, error));
        a = b;
        b = c;
        run++;
    }
    return HEWN_OK;
}

static hewn_result skip_list(ply_reader *reader, const hewn_ply_property *property, hewn_error *error)
{
    uint64_t length = 0;
    HEWN_TRY(read_length(reader, property, &length, error));
    return skip_values(reader, property->type, length, error);
}

/* The list of a corner channel; end_face() compares its length. */
static hewn_result read_corner_values(ply_reader *reader, const hewn_ply_property *property, hewn_ply_column *column,
                                      hewn_error *error)
{
    uint64_t length = 0;
    size_t size = column->size;
    HEWN_TRY(read_length(reader, property, &length, error));
    if (length == 0)
        return HEWN_OK;
    HEWN_TRY(hewn_ply_column_reserve(column, column->value_count + (size_t)length, error));
    HEWN_TRY(read_values(reader, property->type, column, column->values + size * column->value_count, (size_t)length,
                         error));
    column->value_count += (size_t)length;
    return HEWN_OK;
}

/* --- items -------------------------------------------------------------------------------------------------------- */

static hewn_result read_property(ply_reader *reader, const hewn_ply_element *element, size_t i, hewn_ply_layout *layout,
                                 uint64_t index, hewn_error *error)
{
    const hewn_ply_property *property = &reader->header.properties[element->first + i];
    hewn_ply_slot slot = layout ? layout->slots[i] : (hewn_ply_slot){HEWN_NONE, 0};
    hewn_ply_column *column = slot.column == HEWN_NONE ? NULL : &layout->columns[slot.column];
    bool list = property->count_type != HEWN_PLY_NONE;
    if (list && property->role == HEWN_PLY_CORNERS)
        return element->kind == HEWN_PLY_FACES ? read_polygon(reader, property, error)
                                               : read_strips(reader, property, error);
    if (!column)
        return list ? skip_list(reader, property, error) : skip_values(reader, property->type, 1, error);
    if (list)
        return read_corner_values(reader, property, column, error);
    size_t at = (size_t)index * column->components + slot.component;
    return read_values(reader, property->type, column, column->values + at * column->size, 1, error);
}

/* Where the face that was read has three corners or more, it is kept, with its values. */
static hewn_result end_face(ply_reader *reader, uint64_t corners_before, hewn_error *error)
{
    hewn_builder *builder = &reader->builder;
    uint64_t corners = builder->corner_count - corners_before;
    if (corners < 3) {
        builder->corner_count = corners_before;
        hewn_ply_layout_drop_item(&reader->faces);
        return HEWN_OK;
    }
    HEWN_TRY(hewn_ply_layout_end_item(&reader->faces, corners, &reader->scan, error));
    return hewn_builder_end_face(builder, error);
}

static hewn_result report(const ply_reader *reader, hewn_error *error)
{
    double left = (double)(reader->scan.end - reader->scan.at);
    return hewn_progress_report(reader->source->progress, "load", 1 - left / (double)reader->source->length, error);
}

static hewn_result read_items(ply_reader *reader, const hewn_ply_element *element, uint64_t first,
                              hewn_ply_layout *layout, hewn_error *error)
{
    bool faces = element->kind == HEWN_PLY_FACES;
    for (uint64_t item = first; item < element->count; item++) {
        uint64_t corners_before = reader->builder.corner_count;
        uint64_t index = faces ? reader->builder.model.face_count - reader->first_face : item;
        if (item % (16 * BLOCK) == 0)
            HEWN_TRY(report(reader, error));
        for (size_t i = 0; i < element->property_count; i++)
            HEWN_TRY(read_property(reader, element, i, layout, index, error));
        if (faces)
            HEWN_TRY(end_face(reader, corners_before, error));
    }
    return HEWN_OK;
}

/* Items that all take the same bytes, so that a property's values lie at a fixed stride. The file is long enough. */
static hewn_result read_blocks(ply_reader *reader, const hewn_ply_element *element, size_t stride,
                               const hewn_ply_layout *layout, hewn_error *error)
{
    for (uint64_t item = 0; item < element->count; item += BLOCK) {
        size_t count = element->count - item < BLOCK ? (size_t)(element->count - item) : BLOCK, offset = 0;
        if (item % (16 * BLOCK) == 0)
            HEWN_TRY(report(reader, error));
        for (size_t i = 0; i < element->property_count; i++) {
            hewn_ply_type type = reader->header.properties[element->first + i].type;
            const char *from = reader->scan.at + offset;
            offset += hewn_ply_type_size(type);
            if (layout->slots[i].column == HEWN_NONE)
                continue;
            const hewn_ply_column *column = &layout->columns[layout->slots[i].column];
            size_t size = column->size;
            size_t to = ((size_t)item * column->components + layout->slots[i].component) * size;
            hewn_ply_run run = {
                type, reader->big, from, stride, column->scalar, column->values + to, size * column->components, count};
            hewn_ply_decode(&run);
        }
        reader->scan.at += stride * count;
    }
    return HEWN_OK;
}

/* --- faces of one list ---------------------------------------------------------------------------------------------
 */

/* What most binary files have: besides single values only the corners, numbers of 32 bits. */
typedef struct plain_faces {
    size_t before, after; /* bytes of single values beside the list */
    size_t length_size;   /* 1 or 4 */
    size_t list;          /* its place among the properties */
} plain_faces;

static bool is_plain(const ply_reader *reader, const hewn_ply_element *element, plain_faces *out)
{
    size_t lists = 0;
    *out = (plain_faces){0};
    for (size_t i = 0; i < element->property_count; i++) {
        const hewn_ply_property *property = &reader->header.properties[element->first + i];
        if (property->count_type == HEWN_PLY_NONE) {
            *(lists == 0 ? &out->before : &out->after) += hewn_ply_type_size(property->type);
            continue;
        }
        out->list = i;
        out->length_size = hewn_ply_type_size(property->count_type);
        lists++;
        if (property->role != HEWN_PLY_CORNERS || hewn_ply_type_size(property->type) != 4 ||
            property->type == HEWN_PLY_FLOAT || out->length_size == 2)
            return false;
    }
    return lists == 1 && !reader->text;
}

static uint32_t word_at(const ply_reader *reader, const char *at)
{
    return reader->big ? hewn_get_u32_big(at) : hewn_get_u32(at);
}

/* The single values of a face that is kept; its list takes `list_size` bytes. */
static void take_face_values(ply_reader *reader, const hewn_ply_element *element, const plain_faces *plain,
                             size_t list_size)
{
    const char *at = reader->scan.at;
    uint64_t index = reader->builder.model.face_count - reader->first_face;
    for (size_t i = 0; i < element->property_count; i++) {
        hewn_ply_type type = reader->header.properties[element->first + i].type;
        const char *from = at;
        at += i == plain->list ? list_size : hewn_ply_type_size(type);
        if (reader->faces.slots[i].column == HEWN_NONE)
            continue;
        hewn_ply_column *column = &reader->faces.columns[reader->faces.slots[i].column];
        size_t to = ((size_t)index * column->components + reader->faces.slots[i].component) * column->size;
        hewn_ply_run run = {type, reader->big, from, 0, column->scalar, column->values + to, 0, 1};
        hewn_ply_decode(&run);
    }
}

/* Reads faces as long as they are sound and returns how many; for the next one read_items() knows what is wrong. */
static hewn_result read_plain_faces(ply_reader *reader, const hewn_ply_element *element, const plain_faces *plain,
                                    uint64_t *done, hewn_error *error)
{
    hewn_builder *builder = &reader->builder;
    bool has_values = element->property_count > 1;
    for (*done = 0; *done < element->count; ++*done) {
        size_t left = (size_t)(reader->scan.end - reader->scan.at);
        const char *at = reader->scan.at + plain->before;
        if (*done % (16 * BLOCK) == 0)
            HEWN_TRY(report(reader, error));
        if (left < plain->before + plain->length_size)
            return HEWN_OK;
        size_t length = plain->length_size == 1 ? (unsigned char)*at : word_at(reader, at), size;
        at += plain->length_size;
        size = plain->before + plain->length_size + 4 * length + plain->after;
        if (left < size || length > INT8_MAX) /* where that is the type, more is less than none */
            return HEWN_OK;
        void *items = builder->model.corners;
        HEWN_TRY(hewn_reserve(&items, &builder->corner_room, builder->corner_count + length, sizeof(uint32_t), error));
        builder->model.corners = items;
        uint32_t *to = builder->model.corners + builder->corner_count, signs = 0;
        for (size_t k = 0; k < length; k++, at += 4)
            signs |= to[k] = word_at(reader, at);
        if (signs > INT32_MAX)
            return HEWN_OK;
        if (length >= 3) {
            if (has_values)
                take_face_values(reader, element, plain, plain->length_size + 4 * length);
            builder->corner_count += length;
            HEWN_TRY(hewn_builder_end_face(builder, error));
        }
        reader->scan.at += size;
    }
    return HEWN_OK;
}

/* --- elements ----------------------------------------------------------------------------------------------------- */

static bool has_role(const ply_reader *reader, const hewn_ply_element *element, hewn_ply_role role)
{
    for (size_t i = 0; i < element->property_count; i++)
        if (reader->header.properties[element->first + i].role == role)
            return true;
    return false;
}

static hewn_result read_vertices(ply_reader *reader, const hewn_ply_element *element, size_t stride, bool fixed,
                                 hewn_error *error)
{
    bool placed = has_role(reader, element, HEWN_PLY_X) && has_role(reader, element, HEWN_PLY_Y) &&
                  has_role(reader, element, HEWN_PLY_Z);
    if (element->count > 0 && !placed)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0, "the vertices have no x, y and z");
    if (element->count > UINT32_MAX)
        return hewn_fail_at(error, HEWN_LIMIT, reader->scan.name, 0, "more vertices than indices can name");
    HEWN_TRY(hewn_ply_layout_make(&reader->header, element, &reader->vertices, error));
    HEWN_TRY(hewn_ply_layout_begin(&reader->vertices, element->count, error));
    if (fixed)
        HEWN_TRY(read_blocks(reader, element, stride, &reader->vertices, error));
    else
        HEWN_TRY(read_items(reader, element, 0, &reader->vertices, error));
    hewn_ply_layout_take_positions(&reader->vertices, &reader->builder.model.positions);
    reader->builder.position_room = (size_t)element->count;
    reader->builder.model.vertex_count = element->count;
    return HEWN_OK;
}

/* Room for triangles, as far as the file's length allows for so many. */
static hewn_result expect_faces(ply_reader *reader, const hewn_ply_element *element, hewn_error *error)
{
    uint64_t left = (uint64_t)(reader->scan.end - reader->scan.at) / (reader->text ? 2 : 4);
    uint64_t corners = 3 * element->count < left ? 3 * element->count : left;
    void *items = reader->builder.model.corners;
    HEWN_TRY(hewn_reserve(&items, &reader->builder.corner_room, (size_t)(reader->builder.corner_count + corners),
                          sizeof(uint32_t), error));
    reader->builder.model.corners = items;
    return HEWN_OK;
}

static hewn_result read_faces(ply_reader *reader, const hewn_ply_element *element, hewn_error *error)
{
    if (element->count > 0 && !has_role(reader, element, HEWN_PLY_CORNERS))
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0, "the faces have no list vertex_indices");
    if (element->kind == HEWN_PLY_STRIPS)
        return read_items(reader, element, 0, NULL, error);
    reader->first_face = reader->builder.model.face_count;
    HEWN_TRY(hewn_ply_layout_make(&reader->header, element, &reader->faces, error));
    HEWN_TRY(hewn_ply_layout_begin(&reader->faces, element->count, error));
    HEWN_TRY(expect_faces(reader, element, error));
    uint64_t done = 0;
    plain_faces plain;
    if (is_plain(reader, element, &plain)) {
        HEWN_TRY(read_plain_faces(reader, element, &plain, &done, error));
        reader->faces.item_count = reader->builder.model.face_count - reader->first_face;
    }
    return read_items(reader, element, done, &reader->faces, error);
}

/* Whether the rest of the file can hold what is promised. */
static hewn_result check_room(const ply_reader *reader, const hewn_ply_element *element, uint64_t least,
                              hewn_error *error)
{
    uint64_t left = (uint64_t)(reader->scan.end - reader->scan.at);
    uint64_t room = left + (reader->text ? 1 : 0); /* text need not end in a blank */
    if (least > 0 && element->count > room / least)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0,
                            "the header promises %llu items of at least %llu bytes, but only %llu bytes are left",
                            (unsigned long long)element->count, (unsigned long long)least, (unsigned long long)left);
    return HEWN_OK;
}

static hewn_result read_element(ply_reader *reader, const hewn_ply_element *element, hewn_error *error)
{
    bool fixed;
    uint64_t least = hewn_ply_least_size(&reader->header, element, &fixed);
    HEWN_TRY(check_room(reader, element, least, error));
    if (element->kind == HEWN_PLY_VERTICES)
        return read_vertices(reader, element, (size_t)least, fixed, error);
    if (least == 0)
        return HEWN_OK; /* nothing is written of items without properties, however many there are */
    if (element->kind == HEWN_PLY_FACES || element->kind == HEWN_PLY_STRIPS)
        return read_faces(reader, element, error);
    if (!fixed)
        return read_items(reader, element, 0, NULL, error);
    reader->scan.at += (size_t)(least * element->count);
    return HEWN_OK;
}

static hewn_result begin(ply_reader *reader, hewn_error *error)
{
    HEWN_TRY(hewn_ply_header_read(&reader->scan, &reader->header, error));
    reader->text = reader->header.form == HEWN_PLY_TEXT;
    reader->big = reader->header.form == HEWN_PLY_BIG;
    reader->scan.line = reader->text ? reader->scan.line : 0; /* what follows has no lines */
    return HEWN_OK;
}

static hewn_result add_channels(ply_reader *reader, hewn_error *error)
{
    hewn_model *model = &reader->builder.model;
    HEWN_TRY(hewn_ply_channels_add(model, &reader->vertices, 0, error));
    HEWN_TRY(hewn_ply_channels_add(model, &reader->faces, reader->first_face, error));
    for (size_t i = 0; i < reader->header.comment_count; i++) {
        hewn_remark_read(reader->header.comments[i].begin, reader->header.comments[i].end, model);
        HEWN_TRY(hewn_ply_channels_name(model, reader->header.comments[i], error));
    }
    return HEWN_OK;
}

static hewn_result read_file(ply_reader *reader, hewn_error *error)
{
    HEWN_TRY(begin(reader, error));
    for (size_t i = 0; i < reader->header.element_count; i++)
        HEWN_TRY(read_element(reader, &reader->header.elements[i], error));
    HEWN_TRY(hewn_builder_finish(&reader->builder, reader->scan.name, error));
    return add_channels(reader, error);
}

static void clear_read(ply_reader *reader)
{
    hewn_builder_clear(&reader->builder);
    hewn_ply_layout_free(&reader->vertices);
    hewn_ply_layout_free(&reader->faces);
}

hewn_result hewn_ply_read(const hewn_source *source, hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){0};
    ply_reader reader = {.source = source, .scan = {source->bytes, source->bytes + source->length, source->name, 1}};
    hewn_result result = read_file(&reader, error);
    if (result == HEWN_OK)
        hewn_builder_move(&reader.builder, out);
    clear_read(&reader);
    hewn_ply_header_free(&reader.header);
    return result;
}

/* --- in parts ----------------------------------------------------------------------------------------------------- */

/* Some items of an element, as if these were all. */
static hewn_result take_some(ply_reader *reader, const hewn_ply_element *some, const hewn_part_taker *taker,
                             hewn_model *about, hewn_error *error)
{
    HEWN_TRY(read_element(reader, some, error));
    HEWN_TRY(add_channels(reader, error));
    hewn_model *model = &reader->builder.model;
    *about = (hewn_model){.unit = model->unit, .up = model->up, .up_known = model->up_known};
    if (model->vertex_count > 0 || model->face_count > 0)
        HEWN_TRY(taker->take(taker->user, model, error));
    return HEWN_OK;
}

static hewn_result read_in_parts(ply_reader *reader, const hewn_part_taker *taker, hewn_model *about, hewn_error *error)
{
    HEWN_TRY(begin(reader, error));
    for (size_t i = 0; i < reader->header.element_count; i++) {
        const hewn_ply_element *element = &reader->header.elements[i];
        const uint64_t least = hewn_ply_least_size(&reader->header, element, NULL);
        HEWN_TRY(check_room(reader, element, least, error));
        for (uint64_t done = 0; least > 0 && done < element->count; done += PART) {
            hewn_ply_element some = *element;
            some.count = element->count - done < PART ? element->count - done : PART;
            hewn_result result = take_some(reader, &some, taker, about, error);
            clear_read(reader);
            HEWN_TRY(result);
        }
    }
    return HEWN_OK;
}

hewn_result hewn_ply_read_parts(const hewn_source *source, const hewn_part_taker *taker, hewn_model *about,
                                hewn_error *error)
{
    ply_reader reader = {.source = source, .scan = {source->bytes, source->bytes + source->length, source->name, 1}};
    hewn_result result = read_in_parts(&reader, taker, about, error);
    hewn_ply_header_free(&reader.header);
    return result;
}
