/* STL, binary and text. Corners at equal positions become one vertex; positions are the floats of the file, also in
 * text. Solids of a text become the face channel "object" where there are several, the words after a binary file's
 * facets, in which some programs keep colours, the face channel "attribute" where one is not 0. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/progress.h"
#include "io/bytes.h"
#include "io/formats.h"
#include "io/parts.h"
#include "io/remark.h"
#include "io/scan.h"
#include "io/welder.h"

enum { HEADER = 84, FACET = 50 };    /* bytes */
enum { BLOCK = 1 << 14, AHEAD = 8 }; /* facets between two looks at the progress callback; facets looked ahead */

typedef struct stl_solid {
    uint64_t first; /* face; the next one's is where it ends */
    hewn_word name; /* the rest of its line */
} stl_solid;

typedef struct stl_reader {
    hewn_builder builder;
    hewn_welder welder;
    const hewn_source *source;
    stl_solid *solids; /* of a text, those that have facets */
    size_t solid_count, solid_room;
} stl_reader;

/* --- binary ------------------------------------------------------------------------------------------------------- */

static void get_position(const char *at, double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (double)hewn_get_float(at + 4 * axis);
}

static hewn_result read_corner(stl_reader *reader, uint64_t facet, const char *at, hewn_error *error)
{
    uint32_t vertex = 0;
    double position[3];
    get_position(at, position);
    if (!(isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2])))
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->source->name, 0,
                            "facet %llu has a position that is not finite", (unsigned long long)facet);
    HEWN_TRY(hewn_welder_add(&reader->welder, &reader->builder, position, &vertex, error));
    return hewn_builder_add_corner(&reader->builder, vertex, error);
}

static hewn_result read_binary(stl_reader *reader, bool *has_attributes, hewn_error *error)
{
    const char *bytes = reader->source->bytes;
    uint64_t count = hewn_get_u32(bytes + HEADER - 4);
    uint32_t attributes = 0;
    HEWN_TRY(hewn_welder_reserve(&reader->welder, &reader->builder, count / 2, error)); /* as in a closed mesh */
    for (uint64_t t = 0; t < count; t++) {
        const char *at = bytes + HEADER + FACET * t;
        if (t % BLOCK == 0)
            HEWN_TRY(hewn_progress_report(reader->source->progress, "load", (double)t / (double)count, error));
        for (int k = 1; k <= 3 && count - t > AHEAD; k++) {
            double position[3];
            get_position(at + FACET * (size_t)AHEAD + 12 * (size_t)k, position);
            hewn_welder_expect(&reader->welder, position);
        }
        for (int k = 1; k <= 3; k++)
            HEWN_TRY(read_corner(reader, t, at + 12 * (size_t)k, error));
        HEWN_TRY(hewn_builder_end_face(&reader->builder, error));
        attributes |= hewn_get_u16(at + FACET - 2);
    }
    *has_attributes = attributes != 0;
    return HEWN_OK;
}

static hewn_result add_attributes(stl_reader *reader, hewn_error *error)
{
    hewn_channel *channel;
    hewn_attribute_info info = {"attribute", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1};
    HEWN_TRY(hewn_model_add_channel(&reader->builder.model, &info, &channel, error));
    for (uint64_t t = 0; t < reader->builder.model.face_count; t++)
        ((int32_t *)channel->values)[t] = (int32_t)hewn_get_u16(reader->source->bytes + HEADER + FACET * (t + 1) - 2);
    return HEWN_OK;
}

/* --- text --------------------------------------------------------------------------------------------------------- */

static hewn_result expect(hewn_scan *scan, const char *keyword, hewn_error *error)
{
    hewn_word word = hewn_scan_word(scan);
    if (hewn_word_is_any_case(word, keyword))
        return HEWN_OK;
    char what[48];
    snprintf(what, sizeof what, "\"%s\" is expected", keyword);
    return hewn_scan_fail(scan, word, what, error);
}

static hewn_result read_text_corner(stl_reader *reader, hewn_scan *scan, hewn_error *error)
{
    double position[3];
    for (int axis = 0; axis < 3; axis++) {
        float value;
        hewn_word word = hewn_scan_word(scan);
        if (!hewn_word_float(word, &value) || !isfinite(value))
            return hewn_scan_fail(scan, word, "a finite number is expected", error);
        position[axis] = (double)value;
    }
    uint32_t vertex = 0;
    HEWN_TRY(hewn_welder_add(&reader->welder, &reader->builder, position, &vertex, error));
    return hewn_builder_add_corner(&reader->builder, vertex, error);
}

/* From after "facet" to its end. Its normal is not looked at: exporters write all kinds of things there. */
static hewn_result read_facet(stl_reader *reader, hewn_scan *scan, hewn_error *error)
{
    HEWN_TRY(expect(scan, "normal", error));
    for (int axis = 0; axis < 3; axis++)
        hewn_scan_word(scan);
    HEWN_TRY(expect(scan, "outer", error));
    HEWN_TRY(expect(scan, "loop", error));
    for (uint64_t count = 0;; count++) {
        hewn_word word = hewn_scan_word(scan);
        if (hewn_word_is_any_case(word, "endloop") && count >= 3)
            break;
        if (!hewn_word_is_any_case(word, "vertex"))
            return hewn_scan_fail(scan, word, count < 3 ? "\"vertex\" is expected" : "\"endloop\" is expected", error);
        HEWN_TRY(read_text_corner(reader, scan, error));
    }
    HEWN_TRY(hewn_builder_end_face(&reader->builder, error));
    return expect(scan, "endfacet", error);
}

/* The rest of the line without the blanks around it. */
static hewn_word read_name(hewn_scan *scan)
{
    hewn_scan_blanks(scan);
    hewn_word name = {scan->at, scan->at};
    hewn_scan_line(scan);
    name.end = scan->at;
    while (name.end > name.begin && (unsigned char)name.end[-1] <= ' ')
        name.end--;
    return name;
}

static hewn_result begin_solid(stl_reader *reader, hewn_word name, hewn_error *error)
{
    void *items = reader->solids;
    if (reader->solid_count > 0 && reader->solids[reader->solid_count - 1].first == reader->builder.model.face_count)
        reader->solid_count--; /* the last one had no facet */
    HEWN_TRY(hewn_reserve(&items, &reader->solid_room, reader->solid_count + 1, sizeof(stl_solid), error));
    reader->solids = items;
    reader->solids[reader->solid_count++] = (stl_solid){reader->builder.model.face_count, name};
    return HEWN_OK;
}

static hewn_result read_text(stl_reader *reader, hewn_scan *scan, hewn_error *error)
{
    bool inside = false;
    for (uint64_t items = 0;; items++) {
        hewn_word word = hewn_scan_word(scan);
        bool ends = word.begin == word.end;
        if (ends && !inside)
            return HEWN_OK;
        if (items % BLOCK == 0)
            HEWN_TRY(hewn_progress_report(reader->source->progress, "load",
                                          1 - (double)(scan->end - scan->at) / (double)reader->source->length, error));
        if (!inside && hewn_word_is_any_case(word, "solid")) {
            HEWN_TRY(begin_solid(reader, read_name(scan), error));
            inside = true;
        } else if (inside && hewn_word_is_any_case(word, "facet")) {
            HEWN_TRY(read_facet(reader, scan, error));
        } else if (inside && hewn_word_is_any_case(word, "endsolid")) {
            hewn_scan_line(scan);
            inside = false;
        } else {
            return hewn_scan_fail(scan, word,
                                  inside ? "\"facet\" or \"endsolid\" is expected" : "\"solid\" is expected", error);
        }
    }
}

/* The value of a solid's name; the third one without a name is called "solid 3". */
static hewn_result object_of(const stl_reader *reader, size_t solid, hewn_channel *channel, int32_t *out,
                             hewn_error *error)
{
    hewn_word word = reader->solids[solid].name;
    size_t length = (size_t)(word.end - word.begin);
    char *name = hewn_alloc(length + 32, 1);
    if (!name)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a name");
    memcpy(name, word.begin, length);
    name[length] = '\0';
    if (length == 0)
        snprintf(name, 32, "solid %zu", solid + 1);
    hewn_result result = hewn_channel_value(channel, name, out, error);
    hewn_free(name);
    return result;
}

static hewn_result add_objects(stl_reader *reader, hewn_error *error)
{
    hewn_model *model = &reader->builder.model;
    hewn_channel *channel;
    hewn_attribute_info info = {"object", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1};
    HEWN_TRY(hewn_model_add_channel(model, &info, &channel, error));
    for (size_t i = 0; i < reader->solid_count; i++) {
        int32_t value = 0;
        HEWN_TRY(object_of(reader, i, channel, &value, error));
        uint64_t end = i + 1 < reader->solid_count ? reader->solids[i + 1].first : model->face_count;
        for (uint64_t face = reader->solids[i].first; face < end; face++)
            ((int32_t *)channel->values)[face] = value;
    }
    return HEWN_OK;
}

/* --- which -------------------------------------------------------------------------------------------------------- */

/* Binary headers may begin with "solid" too. A length that fits the count settles it, else zero bytes near the start.
 */
static bool is_text(const char *bytes, size_t length)
{
    if (length >= HEADER && length == HEADER + FACET * (uint64_t)hewn_get_u32(bytes + HEADER - 4))
        return false;
    hewn_scan scan = {bytes, bytes + length, "", 1};
    bool solid = hewn_word_is_any_case(hewn_scan_word(&scan), "solid");
    return solid && !memchr(bytes, 0, length < 512 ? length : 512);
}

static hewn_result check_binary(const hewn_source *source, hewn_error *error)
{
    if (source->length == 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "the file is empty");
    if (source->length < HEADER)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0,
                            "neither text nor long enough for a binary STL file");
    uint64_t count = hewn_get_u32(source->bytes + HEADER - 4);
    if (HEADER + FACET * count > source->length)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0,
                            "the header promises %llu facets, but the file's %zu bytes hold at most %llu",
                            (unsigned long long)count, source->length,
                            (unsigned long long)((source->length - HEADER) / FACET));
    return HEWN_OK;
}

static hewn_result read_either(stl_reader *reader, hewn_error *error)
{
    const hewn_source *source = reader->source;
    bool text = is_text(source->bytes, source->length), has_attributes = false;
    if (text) {
        hewn_scan scan = {source->bytes, source->bytes + source->length, source->name, 1};
        HEWN_TRY(read_text(reader, &scan, error));
    } else {
        HEWN_TRY(check_binary(source, error));
        HEWN_TRY(read_binary(reader, &has_attributes, error));
        hewn_remark_read(source->bytes, source->bytes + HEADER - 4, &reader->builder.model);
    }
    hewn_welder_clear(&reader->welder);
    HEWN_TRY(hewn_builder_finish(&reader->builder, source->name, error));
    if (has_attributes)
        HEWN_TRY(add_attributes(reader, error));
    bool last_is_empty =
        reader->solid_count > 0 && reader->solids[reader->solid_count - 1].first == reader->builder.model.face_count;
    reader->solid_count -= last_is_empty;
    return reader->solid_count > 1 ? add_objects(reader, error) : HEWN_OK;
}

hewn_result hewn_stl_read(const hewn_source *source, hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){0};
    stl_reader reader = {.source = source};
    hewn_result result = read_either(&reader, error);
    if (result == HEWN_OK)
        hewn_builder_move(&reader.builder, out);
    hewn_builder_clear(&reader.builder);
    hewn_welder_clear(&reader.welder);
    hewn_free(reader.solids);
    return result;
}

/* --- in parts ----------------------------------------------------------------------------------------------------- */

static hewn_result find_attributes(const hewn_source *source, uint64_t count, bool *out, hewn_error *error)
{
    *out = false;
    for (uint64_t t = 0; t < count && !*out; t++) {
        if (t % BLOCK == 0)
            HEWN_TRY(hewn_progress_report(source->progress, "load", 0, error));
        *out = hewn_get_u16(source->bytes + HEADER + FACET * (t + 1) - 2) != 0;
    }
    return HEWN_OK;
}

/* Facets from `first` on with vertices of their own. */
static hewn_result take_facets(const hewn_source *source, uint64_t first, uint64_t count, bool attributes,
                               hewn_model *out, hewn_error *error)
{
    hewn_channel *channel = NULL;
    const hewn_attribute_info info = {"attribute", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1};
    *out = (hewn_model){.vertex_count = 3 * count,
                        .face_count = count,
                        .positions = hewn_alloc(9 * count, sizeof *out->positions),
                        .corners = hewn_alloc(3 * count, sizeof *out->corners)};
    if (!out->positions || !out->corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for facets");
    if (attributes)
        HEWN_TRY(hewn_model_add_channel(out, &info, &channel, error));
    for (uint64_t t = 0; t < count; t++) {
        const char *at = source->bytes + HEADER + FACET * (first + t);
        for (uint64_t k = 0; k < 3; k++) {
            get_position(at + 12 * (k + 1), out->positions + 3 * (3 * t + k));
            out->corners[3 * t + k] = (uint32_t)(3 * t + k);
        }
        if (channel)
            ((int32_t *)channel->values)[t] = (int32_t)hewn_get_u16(at + FACET - 2);
    }
    return HEWN_OK;
}

hewn_result hewn_stl_read_parts(const hewn_source *source, const hewn_part_taker *taker, hewn_model *about,
                                hewn_error *error)
{
    bool attributes;
    *about = (hewn_model){0};
    if (is_text(source->bytes, source->length))
        return hewn_fail_at(error, HEWN_LIMIT, source->name, 0,
                            "an STL file of text cannot be read in parts; one of binary facets can");
    HEWN_TRY(check_binary(source, error));
    hewn_remark_read(source->bytes, source->bytes + HEADER - 4, about);
    const uint64_t count = hewn_get_u32(source->bytes + HEADER - 4);
    HEWN_TRY(find_attributes(source, count, &attributes, error));
    for (uint64_t done = 0; done < count; done += BLOCK) {
        hewn_model part;
        HEWN_TRY(hewn_progress_report(source->progress, "load", (double)done / (double)count, error));
        hewn_result result =
            take_facets(source, done, count - done < BLOCK ? count - done : BLOCK, attributes, &part, error);
        if (result == HEWN_OK)
            result = taker->take(taker->user, &part, error);
        hewn_model_destroy(&part);
        HEWN_TRY(result);
    }
    return HEWN_OK;
}
