#include "io/ply_header.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

static hewn_ply_type type_of(hewn_word word)
{
    static const struct {
        const char *name, *alias;
        hewn_ply_type type;
    } known[] = {{"char", "int8", HEWN_PLY_INT8},      {"uchar", "uint8", HEWN_PLY_UINT8},
                 {"short", "int16", HEWN_PLY_INT16},   {"ushort", "uint16", HEWN_PLY_UINT16},
                 {"int", "int32", HEWN_PLY_INT32},     {"uint", "uint32", HEWN_PLY_UINT32},
                 {"float", "float32", HEWN_PLY_FLOAT}, {"double", "float64", HEWN_PLY_DOUBLE}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (hewn_word_is(word, known[i].name) || hewn_word_is(word, known[i].alias))
            return known[i].type;
    return HEWN_PLY_NONE;
}

uint64_t hewn_ply_least_size(const hewn_ply_header *header, const hewn_ply_element *element, bool *fixed)
{
    uint64_t size = 0;
    bool lists = false;
    for (size_t i = 0; i < element->property_count; i++) {
        const hewn_ply_property *property = &header->properties[element->first + i];
        bool list = property->count_type != HEWN_PLY_NONE;
        lists = lists || list;
        /* in text a digit and a blank */
        size += header->form == HEWN_PLY_TEXT ? 2 : hewn_ply_type_size(list ? property->count_type : property->type);
    }
    if (fixed)
        *fixed = header->form != HEWN_PLY_TEXT && !lists;
    return size;
}

size_t hewn_ply_find(const hewn_ply_header *header, const hewn_ply_element *element, const char *name)
{
    for (size_t i = 0; i < element->property_count; i++) {
        const hewn_ply_property *property = &header->properties[element->first + i];
        if (property->count_type == HEWN_PLY_NONE && hewn_word_is(property->name, name))
            return i;
    }
    return HEWN_PLY_MOST;
}

static hewn_ply_role role_of(hewn_ply_kind kind, hewn_word name, bool list)
{
    static const char *const vertex_names[] = {"x", "y", "z"};
    if (kind == HEWN_PLY_VERTICES && !list)
        for (int i = 0; i < 3; i++)
            if (hewn_word_is(name, vertex_names[i]))
                return (hewn_ply_role)(HEWN_PLY_X + i);
    bool corners = hewn_word_is(name, "vertex_indices") || hewn_word_is(name, "vertex_index");
    if ((kind == HEWN_PLY_FACES || kind == HEWN_PLY_STRIPS) && list && corners)
        return HEWN_PLY_CORNERS;
    return HEWN_PLY_OTHER;
}

static hewn_result read_format(hewn_scan *scan, hewn_ply_header *header, hewn_error *error)
{
    hewn_word word = hewn_scan_word_in_line(scan);
    if (hewn_word_is(word, "ascii"))
        header->form = HEWN_PLY_TEXT;
    else if (hewn_word_is(word, "binary_little_endian"))
        header->form = HEWN_PLY_LITTLE;
    else if (hewn_word_is(word, "binary_big_endian"))
        header->form = HEWN_PLY_BIG;
    else
        return hewn_scan_fail(scan, word, "ascii, binary_little_endian or binary_big_endian is expected", error);
    return HEWN_OK;
}

static hewn_result read_element(hewn_scan *scan, hewn_ply_header *header, hewn_error *error)
{
    void *items = header->elements;
    HEWN_TRY(hewn_reserve(&items, &header->element_room, header->element_count + 1, sizeof(hewn_ply_element), error));
    header->elements = items;
    hewn_ply_element element = {.first = header->property_count};
    hewn_word word = hewn_scan_word_in_line(scan);
    if (header->element_count == HEWN_PLY_MOST)
        return hewn_scan_fail(scan, word, "no more than 1000 elements are expected", error);
    if (hewn_word_is(word, "vertex"))
        element.kind = HEWN_PLY_VERTICES;
    else if (hewn_word_is(word, "face"))
        element.kind = HEWN_PLY_FACES;
    else if (hewn_word_is(word, "tristrips"))
        element.kind = HEWN_PLY_STRIPS;
    for (size_t i = 0; i < header->element_count; i++)
        if (element.kind != HEWN_PLY_UNKNOWN && header->elements[i].kind == element.kind)
            return hewn_scan_fail(scan, word, "each element is expected once", error);
    int64_t count;
    word = hewn_scan_word_in_line(scan);
    if (!hewn_word_integer(word, &count) || count < 0)
        return hewn_scan_fail(scan, word, "the number of items is expected", error);
    element.count = (uint64_t)count;
    header->elements[header->element_count++] = element;
    return HEWN_OK;
}

static hewn_result read_property(hewn_scan *scan, hewn_ply_header *header, hewn_error *error)
{
    hewn_word word = hewn_scan_word_in_line(scan);
    if (header->element_count == 0)
        return hewn_scan_fail(scan, word, "an element is expected before its properties", error);
    hewn_ply_property property = {.count_type = HEWN_PLY_NONE};
    if (hewn_word_is(word, "list")) {
        word = hewn_scan_word_in_line(scan);
        property.count_type = type_of(word);
        if (property.count_type == HEWN_PLY_NONE || property.count_type >= HEWN_PLY_FLOAT)
            return hewn_scan_fail(scan, word, "a whole number's type is expected", error);
        word = hewn_scan_word_in_line(scan);
    }
    property.type = type_of(word);
    if (property.type == HEWN_PLY_NONE)
        return hewn_scan_fail(scan, word, "a type is expected", error);
    hewn_ply_element *element = &header->elements[header->element_count - 1];
    property.name = hewn_scan_word_in_line(scan);
    property.role = role_of(element->kind, property.name, property.count_type != HEWN_PLY_NONE);
    if (header->property_count == HEWN_PLY_MOST)
        return hewn_scan_fail(scan, property.name, "no more than 1000 properties are expected", error);
    for (size_t i = 0; i < element->property_count; i++)
        if (property.role != HEWN_PLY_OTHER && header->properties[element->first + i].role == property.role)
            return hewn_scan_fail(scan, property.name, "each property is expected once", error);
    void *items = header->properties;
    HEWN_TRY(
        hewn_reserve(&items, &header->property_room, header->property_count + 1, sizeof(hewn_ply_property), error));
    header->properties = items;
    header->properties[header->property_count++] = property;
    element->property_count++;
    return HEWN_OK;
}

static hewn_result keep_comment(hewn_scan *scan, hewn_ply_header *header, hewn_error *error)
{
    void *items = header->comments;
    HEWN_TRY(hewn_reserve(&items, &header->comment_room, header->comment_count + 1, sizeof(hewn_word), error));
    header->comments = items;
    const char *end = memchr(scan->at, '\n', (size_t)(scan->end - scan->at));
    hewn_word comment = {scan->at, end ? end : scan->end};
    comment.end -= comment.end > comment.begin && comment.end[-1] == '\r';
    comment.begin += comment.begin < comment.end;
    header->comments[header->comment_count++] = comment;
    return HEWN_OK;
}

static hewn_result read_header(hewn_scan *scan, hewn_ply_header *header, hewn_error *error)
{
    hewn_word word = hewn_scan_word_in_line(scan);
    if (!hewn_word_is(word, "ply"))
        return hewn_scan_fail(scan, word, "\"ply\" is expected", error);
    bool has_format = false;
    for (;;) {
        hewn_scan_line(scan);
        word = hewn_scan_word_in_line(scan);
        if (hewn_word_is(word, "format")) {
            has_format = true;
            HEWN_TRY(read_format(scan, header, error));
        } else if (hewn_word_is(word, "element")) {
            HEWN_TRY(read_element(scan, header, error));
        } else if (hewn_word_is(word, "property")) {
            HEWN_TRY(read_property(scan, header, error));
        } else if (hewn_word_is(word, "comment") || hewn_word_is(word, "obj_info")) {
            HEWN_TRY(keep_comment(scan, header, error));
        } else if (hewn_word_is(word, "end_header") && has_format) {
            hewn_scan_line(scan);
            return HEWN_OK;
        } else if (scan->at == scan->end) {
            return hewn_fail_at(error, HEWN_BAD_INPUT, scan->name, scan->line, "the header has no format or no end");
        } /* else one of the remarks that some exporters write without the word for it */
    }
}

hewn_result hewn_ply_header_read(hewn_scan *scan, hewn_ply_header *out, hewn_error *error)
{
    *out = (hewn_ply_header){0};
    hewn_result result = read_header(scan, out, error);
    if (result != HEWN_OK)
        hewn_ply_header_free(out);
    return result;
}

void hewn_ply_header_free(hewn_ply_header *header)
{
    hewn_free(header->elements);
    hewn_free(header->properties);
    hewn_free(header->comments);
    *header = (hewn_ply_header){0};
}
