/* Wavefront OBJ: v, vn and f; everything else is passed over. */
#include <math.h>
#include <string.h>

#include "io/builder.h"
#include "io/formats.h"
#include "io/scan.h"
#include "io/shim/number.h"

static const uint32_t NONE = 0xFFFFFFFFu;

typedef struct obj_reader {
    hewn_scan scan;
    hewn_builder builder;
    float *normals; /* of the vn lines */
    size_t normal_count, normal_room;
    uint32_t *normal_of; /* the vn that corners give to a vertex, or NONE */
    size_t mapped, mapped_room;
    bool normals_clash; /* a vertex with two normals, or a corner with none */
    uint64_t greatest;  /* vertex number used, 1-based, and where; likewise for normals */
    uint32_t greatest_line;
    uint64_t greatest_normal;
    uint32_t greatest_normal_line;
} obj_reader;

typedef struct obj_corner {
    uint32_t vertex, normal; /* 0-based; normal may be NONE */
} obj_corner;

static hewn_result read_vector(obj_reader *reader, float out[3], hewn_error *error)
{
    for (int axis = 0; axis < 3; axis++) {
        hewn_word word = hewn_scan_word_in_line(&reader->scan);
        if (!hewn_word_float(word, &out[axis]))
            return hewn_scan_fail(&reader->scan, word, "a number is expected", error);
    }
    return HEWN_OK;
}

static hewn_result read_vertex(obj_reader *reader, hewn_error *error)
{
    float position[3];
    HEWN_TRY(read_vector(reader, position, error));
    if (!(isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2])))
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, reader->scan.line, "a position is not finite");
    return hewn_builder_add_vertex(&reader->builder, position, error);
}

static hewn_result read_normal(obj_reader *reader, hewn_error *error)
{
    void *items = reader->normals;
    HEWN_TRY(hewn_reserve(&items, &reader->normal_room, reader->normal_count + 1, 3 * sizeof(float), error));
    reader->normals = items;
    HEWN_TRY(read_vector(reader, reader->normals + 3 * reader->normal_count, error));
    reader->normal_count++;
    return HEWN_OK;
}

/* A 1-based or, counted from the end, negative number to a 0-based one. Numbers of things yet to come are allowed, and
 * checked at the end of the file against `greatest`. */
static bool resolve(int64_t number, uint64_t count, uint64_t *greatest, uint32_t *line, uint32_t now, uint32_t *out)
{
    int64_t index = number > 0 ? number - 1 : (int64_t)count + number;
    if (number == 0 || index < 0 || index >= (int64_t)NONE)
        return false;
    if ((uint64_t)index + 1 > *greatest) {
        *greatest = (uint64_t)index + 1;
        *line = now;
    }
    *out = (uint32_t)index;
    return true;
}

/* v, v/vt, v//vn, v/vt/vn; the parts after a slash may be missing. */
static bool parse_corner(obj_reader *reader, hewn_word word, obj_corner *corner)
{
    int64_t number, texture, normal;
    const char *at = hewn_number_parse_integer(word.begin, word.end, &number);
    corner->normal = NONE;
    if (!at || !resolve(number, reader->builder.mesh.vertex_count, &reader->greatest, &reader->greatest_line,
                        reader->scan.line, &corner->vertex))
        return false;
    if (at < word.end && *at == '/') {
        const char *next = hewn_number_parse_integer(++at, word.end, &texture);
        at = next ? next : at;
    }
    if (at < word.end && *at == '/') {
        const char *next = hewn_number_parse_integer(++at, word.end, &normal);
        if (next && !resolve(normal, reader->normal_count, &reader->greatest_normal, &reader->greatest_normal_line,
                             reader->scan.line, &corner->normal))
            return false;
        at = next ? next : at;
    }
    return at == word.end;
}

static bool same_normal(const obj_reader *reader, uint32_t a, uint32_t b)
{
    return a == b || (a < reader->normal_count && b < reader->normal_count &&
                      memcmp(reader->normals + 3 * (size_t)a, reader->normals + 3 * (size_t)b, 3 * sizeof(float)) == 0);
}

/* Notes a corner's normal for its vertex. Only where all corners of a vertex agree has the mesh normals. */
static hewn_result note_normal(obj_reader *reader, obj_corner corner, hewn_error *error)
{
    if (reader->normals_clash)
        return HEWN_OK;
    if (corner.normal == NONE || corner.vertex >= reader->builder.mesh.vertex_count) {
        reader->normals_clash = true;
        return HEWN_OK;
    }
    if (corner.vertex >= reader->mapped) {
        void *items = reader->normal_of;
        size_t needed = (size_t)corner.vertex + 1;
        HEWN_TRY(hewn_reserve(&items, &reader->mapped_room, needed, sizeof(uint32_t), error));
        reader->normal_of = items;
        memset(reader->normal_of + reader->mapped, 0xff, (needed - reader->mapped) * sizeof(uint32_t));
        reader->mapped = needed;
    }
    uint32_t *slot = &reader->normal_of[corner.vertex];
    if (*slot == NONE)
        *slot = corner.normal;
    reader->normals_clash = !same_normal(reader, *slot, corner.normal);
    return HEWN_OK;
}

static hewn_result read_face(obj_reader *reader, hewn_error *error)
{
    uint32_t first = 0, last = 0;
    for (uint64_t count = 0;; count++) {
        hewn_word word = hewn_scan_word_in_line(&reader->scan);
        if (word.begin == word.end || *word.begin == '#') {
            if (count < 3)
                return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, reader->scan.line,
                                    "a face needs at least three corners");
            reader->scan.at = word.begin;
            return HEWN_OK;
        }
        obj_corner corner;
        if (!parse_corner(reader, word, &corner))
            return hewn_scan_fail(&reader->scan, word, "a face's corner is expected", error);
        HEWN_TRY(note_normal(reader, corner, error));
        if (count == 0)
            first = corner.vertex;
        if (count >= 2)
            HEWN_TRY(hewn_builder_add_triangle(&reader->builder, first, last, corner.vertex, error));
        last = corner.vertex;
    }
}

static hewn_result read_lines(obj_reader *reader, hewn_error *error)
{
    while (reader->scan.at < reader->scan.end) {
        hewn_word word = hewn_scan_word_in_line(&reader->scan);
        if (hewn_word_is(word, "v"))
            HEWN_TRY(read_vertex(reader, error));
        else if (hewn_word_is(word, "vn"))
            HEWN_TRY(read_normal(reader, error));
        else if (hewn_word_is(word, "f"))
            HEWN_TRY(read_face(reader, error));
        hewn_scan_line(&reader->scan);
    }
    if (reader->greatest > reader->builder.mesh.vertex_count)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, reader->greatest_line,
                            "a face names vertex %llu, but there are %llu", (unsigned long long)reader->greatest,
                            (unsigned long long)reader->builder.mesh.vertex_count);
    /* Some exporters number normals that they leave out altogether; then there simply are none. */
    if (reader->normal_count > 0 && reader->greatest_normal > reader->normal_count)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->scan.name, reader->greatest_normal_line,
                            "a face names normal %llu, but there are %zu", (unsigned long long)reader->greatest_normal,
                            reader->normal_count);
    return HEWN_OK;
}

/* Gives the vertices their normals, where every one has exactly one. A vertex that no face uses takes the normal of its
 * own number, if there are as many normals as vertices. */
static hewn_result assign_normals(obj_reader *reader, hewn_error *error)
{
    hewn_triangles *mesh = &reader->builder.mesh;
    bool paired = reader->normal_count == mesh->vertex_count;
    if (reader->normals_clash || reader->normal_count == 0 || (!paired && reader->mapped < mesh->vertex_count))
        return HEWN_OK;
    float *normals = hewn_alloc(mesh->vertex_count, 3 * sizeof(float));
    if (!normals)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, reader->scan.name, 0, "out of memory");
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t from = v < reader->mapped ? reader->normal_of[v] : NONE;
        if (from == NONE && !paired) {
            hewn_free(normals);
            return HEWN_OK;
        }
        size_t source = from == NONE ? (size_t)v : from;
        memcpy(normals + 3 * v, reader->normals + 3 * source, 3 * sizeof(float));
    }
    mesh->normals = normals;
    reader->builder.normal_room = mesh->vertex_count;
    return HEWN_OK;
}

/* UTF-16 has a mark of its own or zero bytes; text that this format is in has neither. */
static hewn_result check_text(hewn_scan *scan, hewn_error *error)
{
    const unsigned char *at = (const unsigned char *)scan->at;
    size_t length = (size_t)(scan->end - scan->at), looked = length < 512 ? length : 512;
    if (length >= 2 && ((at[0] == 0xfe && at[1] == 0xff) || (at[0] == 0xff && at[1] == 0xfe)))
        return hewn_fail_at(error, HEWN_BAD_INPUT, scan->name, 1, "the text is in UTF-16; OBJ files are in UTF-8");
    if (looked > 0 && memchr(at, 0, looked))
        return hewn_fail_at(error, HEWN_BAD_INPUT, scan->name, 1, "this is not text, so it is not an OBJ file");
    if (length >= 3 && memcmp(at, "\xef\xbb\xbf", 3) == 0)
        scan->at += 3;
    return HEWN_OK;
}

hewn_result hewn_obj_read(const char *bytes, size_t length, const char *name, hewn_triangles *out, hewn_error *error)
{
    *out = (hewn_triangles){0};
    obj_reader reader = {.scan = {bytes, bytes + length, name, 1}};
    hewn_result result = check_text(&reader.scan, error);
    if (result == HEWN_OK)
        result = read_lines(&reader, error);
    if (result == HEWN_OK)
        result = assign_normals(&reader, error);
    if (result == HEWN_OK)
        result = hewn_builder_finish(&reader.builder, name, out, error);
    hewn_builder_clear(&reader.builder);
    hewn_free(reader.normals);
    hewn_free(reader.normal_of);
    return result;
}
