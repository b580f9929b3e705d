/* Stanford PLY: text and both binary orders, vertices, faces and triangle strips; other elements are passed over. */
#include <math.h>
#include <string.h>

#include "io/builder.h"
#include "io/formats.h"
#include "io/ply_header.h"

typedef struct ply_reader {
    hewn_scan scan;
    hewn_ply_header header;
    hewn_builder builder;
} ply_reader;

/* --- single values ---------------------------------------------------------------------------------------------------
 */

static hewn_result fail_short(const ply_reader *reader, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0, "the file ends before its last element does");
}

static double decode(const char *bytes, hewn_ply_type type, bool big)
{
    size_t size = hewn_ply_type_size(type);
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++)
        bits |= (uint64_t)(unsigned char)bytes[big ? size - 1 - i : i] << 8 * i;
    uint32_t half = (uint32_t)bits;
    float single;
    double real;
    switch (type) {
    case HEWN_PLY_INT8: return (int8_t)bits;
    case HEWN_PLY_INT16: return (int16_t)bits;
    case HEWN_PLY_INT32: return (int32_t)bits;
    case HEWN_PLY_NONE:
    case HEWN_PLY_UINT8:
    case HEWN_PLY_UINT16:
    case HEWN_PLY_UINT32: return (double)bits;
    case HEWN_PLY_FLOAT: memcpy(&single, &half, sizeof single); return (double)single;
    case HEWN_PLY_DOUBLE: memcpy(&real, &bits, sizeof real); return real;
    }
    return 0;
}

static hewn_result read_word(ply_reader *reader, hewn_ply_type type, double *out, hewn_error *error)
{
    hewn_word word = hewn_scan_word(&reader->scan);
    float single;
    int64_t whole;
    bool good;
    if (type == HEWN_PLY_FLOAT) { /* straight to float: rounding twice could miss the nearest one */
        good = hewn_word_float(word, &single);
        *out = good ? (double)single : 0;
    } else if (type == HEWN_PLY_DOUBLE) {
        good = hewn_word_double(word, out);
    } else {
        good = hewn_word_integer(word, &whole);
        *out = good ? (double)whole : 0;
    }
    if (!good)
        return hewn_scan_fail(&reader->scan, word,
                              type < HEWN_PLY_FLOAT ? "a whole number is expected" : "a number is expected", error);
    return HEWN_OK;
}

static hewn_result read_value(ply_reader *reader, hewn_ply_type type, double *out, hewn_error *error)
{
    if (reader->header.form == HEWN_PLY_TEXT)
        return read_word(reader, type, out, error);
    size_t size = hewn_ply_type_size(type);
    if ((size_t)(reader->scan.end - reader->scan.at) < size)
        return fail_short(reader, error);
    *out = decode(reader->scan.at, type, reader->header.form == HEWN_PLY_BIG);
    reader->scan.at += size;
    return HEWN_OK;
}

/* A list's length, which the rest of the file must be able to hold. */
static hewn_result read_length(ply_reader *reader, const hewn_ply_property *property, uint64_t *out, hewn_error *error)
{
    double length;
    HEWN_TRY(read_value(reader, property->count_type, &length, error));
    uint64_t least = reader->header.form == HEWN_PLY_TEXT ? 2 : hewn_ply_type_size(property->type);
    uint64_t room = (uint64_t)(reader->scan.end - reader->scan.at) + 1;
    if (length < 0 || length * (double)least > (double)room)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name,
                            reader->header.form == HEWN_PLY_TEXT ? reader->scan.line : 0,
                            "a list of %.0f values does not fit in the rest of the file", length);
    *out = (uint64_t)length;
    return HEWN_OK;
}

/* --- lists of corners ------------------------------------------------------------------------------------------------
 */

static hewn_result read_corner(ply_reader *reader, hewn_ply_type type, bool strip, int64_t *out, hewn_error *error)
{
    double value;
    HEWN_TRY(read_value(reader, type, &value, error));
    bool restart = strip && value == -1;
    if (!restart && !(value >= 0 && value < 4294967295.0 && value == floor(value)))
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name,
                            reader->header.form == HEWN_PLY_TEXT ? reader->scan.line : 0, "%g is not a vertex's number",
                            value);
    *out = (int64_t)value;
    return HEWN_OK;
}

/* A polygon, cut into a fan around its first corner. */
static hewn_result read_polygon(ply_reader *reader, const hewn_ply_property *property, hewn_error *error)
{
    uint64_t length = 0;
    int64_t first = 0, last = 0, corner = 0;
    HEWN_TRY(read_length(reader, property, &length, error));
    for (uint64_t i = 0; i < length; i++) {
        HEWN_TRY(read_corner(reader, property->type, false, &corner, error));
        if (i == 0)
            first = corner;
        if (i >= 2)
            HEWN_TRY(
                hewn_builder_add_triangle(&reader->builder, (uint32_t)first, (uint32_t)last, (uint32_t)corner, error));
        last = corner;
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
    double ignored;
    HEWN_TRY(read_length(reader, property, &length, error));
    for (uint64_t i = 0; i < length; i++)
        HEWN_TRY(read_value(reader, property->type, &ignored, error));
    return HEWN_OK;
}

/* --- elements --------------------------------------------------------------------------------------------------------
 */

/* One item: its single values go to `values` by their role. */
static hewn_result read_item(ply_reader *reader, const hewn_ply_element *element, double values[HEWN_PLY_CORNERS],
                             hewn_error *error)
{
    for (size_t i = 0; i < element->property_count; i++) {
        const hewn_ply_property *property = &reader->header.properties[element->first + i];
        if (property->count_type == HEWN_PLY_NONE)
            HEWN_TRY(read_value(reader, property->type, &values[property->role], error));
        else if (property->role != HEWN_PLY_CORNERS)
            HEWN_TRY(skip_list(reader, property, error));
        else if (element->kind == HEWN_PLY_FACES)
            HEWN_TRY(read_polygon(reader, property, error));
        else
            HEWN_TRY(read_strips(reader, property, error));
    }
    return HEWN_OK;
}

static bool has_roles(const ply_reader *reader, const hewn_ply_element *element, hewn_ply_role first,
                      hewn_ply_role last)
{
    unsigned found = 0, wanted = 0;
    for (size_t i = 0; i < element->property_count; i++)
        found |= 1u << reader->header.properties[element->first + i].role;
    for (unsigned role = first; role <= last; role++)
        wanted |= 1u << role;
    return (found & wanted) == wanted;
}

static hewn_result read_vertices(ply_reader *reader, const hewn_ply_element *element, hewn_error *error)
{
    hewn_triangles *mesh = &reader->builder.mesh;
    if (element->count > 0 && !has_roles(reader, element, HEWN_PLY_X, HEWN_PLY_Z))
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0, "the vertices have no x, y and z");
    bool normals = has_roles(reader, element, HEWN_PLY_NX, HEWN_PLY_NZ);
    mesh->positions = hewn_alloc(element->count, 3 * sizeof(float));
    mesh->normals = normals ? hewn_alloc(element->count, 3 * sizeof(float)) : NULL;
    if (!mesh->positions || (normals && !mesh->normals))
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, reader->scan.name, 0, "out of memory for %llu vertices",
                            (unsigned long long)element->count);
    reader->builder.position_room = element->count;
    reader->builder.normal_room = normals ? element->count : 0;
    for (uint64_t v = 0; v < element->count; v++) {
        double values[HEWN_PLY_CORNERS] = {0};
        HEWN_TRY(read_item(reader, element, values, error));
        for (int axis = 0; axis < 3; axis++) {
            mesh->positions[3 * v + axis] = (float)values[HEWN_PLY_X + axis];
            if (normals)
                mesh->normals[3 * v + axis] = (float)values[HEWN_PLY_NX + axis];
        }
    }
    mesh->vertex_count = element->count;
    return HEWN_OK;
}

static hewn_result read_element(ply_reader *reader, const hewn_ply_element *element, hewn_error *error)
{
    uint64_t least = hewn_ply_least_size(&reader->header, element);
    uint64_t room = (uint64_t)(reader->scan.end - reader->scan.at) + 1; /* text need not end in a blank */
    if (least > 0 && element->count > room / least)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0,
                            "the header promises %llu items of at least %llu bytes, but only %llu bytes are left",
                            (unsigned long long)element->count, (unsigned long long)least,
                            (unsigned long long)(room - 1));
    if (element->kind == HEWN_PLY_VERTICES)
        return read_vertices(reader, element, error);
    if (least == 0)
        return HEWN_OK; /* nothing is written of items without properties, however many there are */
    if (element->kind != HEWN_PLY_UNKNOWN && element->count > 0 &&
        !has_roles(reader, element, HEWN_PLY_CORNERS, HEWN_PLY_CORNERS))
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, 0, "the faces have no list vertex_indices");
    for (uint64_t i = 0; i < element->count; i++) {
        double ignored[HEWN_PLY_CORNERS];
        HEWN_TRY(read_item(reader, element, ignored, error));
    }
    return HEWN_OK;
}

hewn_result hewn_ply_read(const char *bytes, size_t length, const char *name, hewn_triangles *out, hewn_error *error)
{
    *out = (hewn_triangles){0};
    ply_reader reader = {.scan = {bytes, bytes + length, name, 1}};
    hewn_result result = hewn_ply_header_read(&reader.scan, &reader.header, error);
    for (size_t i = 0; i < reader.header.element_count && result == HEWN_OK; i++)
        result = read_element(&reader, &reader.header.elements[i], error);
    if (result == HEWN_OK)
        result = hewn_builder_finish(&reader.builder, name, out, error);
    hewn_builder_clear(&reader.builder);
    hewn_ply_header_free(&reader.header);
    return result;
}
