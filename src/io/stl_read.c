/* STL, binary and text. Corners at equal positions become one vertex. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/builder.h"
#include "io/bytes.h"
#include "io/formats.h"
#include "io/scan.h"

enum { HEADER = 84, FACET = 50 };

static const uint32_t NONE = 0xFFFFFFFFu;

/* --- welding ---------------------------------------------------------------------------------------------------------
 */

/* An open-addressing table of vertex numbers, keyed by their positions' bits. */
typedef struct stl_welder {
    hewn_builder builder;
    uint32_t *slots;
    size_t slot_count; /* a power of two, at least twice the vertices */
} stl_welder;

static uint64_t hash_position(const float position[3])
{
    uint32_t bits[3];
    memcpy(bits, position, sizeof bits);
    uint64_t hash = ((uint64_t)bits[0] << 32 | bits[1]) * 0x9e3779b97f4a7c15u;
    hash = (hash ^ hash >> 29 ^ bits[2]) * 0xbf58476d1ce4e5b9u;
    return hash ^ hash >> 32;
}

static uint32_t *find_slot(const stl_welder *welder, const float position[3])
{
    size_t mask = welder->slot_count - 1, at = hash_position(position) & mask;
    const float *positions = welder->builder.mesh.positions;
    while (positions && welder->slots[at] != NONE && /* without any vertex all slots are free */
           memcmp(positions + 3 * (size_t)welder->slots[at], position, 3 * sizeof(float)) != 0)
        at = (at + 1) & mask;
    return &welder->slots[at];
}

/* False when out of memory. */
static bool grow_table(stl_welder *welder)
{
    size_t count = welder->slot_count ? 2 * welder->slot_count : 256;
    uint32_t *slots = hewn_alloc(count, sizeof *slots);
    if (!slots)
        return false;
    memset(slots, 0xff, count * sizeof *slots);
    hewn_free(welder->slots);
    welder->slots = slots;
    welder->slot_count = count;
    for (uint64_t v = 0; v < welder->builder.mesh.vertex_count; v++)
        *find_slot(welder, welder->builder.mesh.positions + 3 * v) = (uint32_t)v;
    return true;
}

static hewn_result weld(stl_welder *welder, const float given[3], uint32_t *vertex, hewn_error *error)
{
    const float position[3] = {given[0] + 0.0f, given[1] + 0.0f, given[2] + 0.0f}; /* -0 becomes 0 */
    hewn_triangles *mesh = &welder->builder.mesh;
    if (mesh->vertex_count >= NONE)
        return hewn_fail(error, HEWN_LIMIT, "more vertices than indices can name");
    if (2 * (mesh->vertex_count + 1) > welder->slot_count && !grow_table(welder))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory welding vertices");
    uint32_t *slot = find_slot(welder, position);
    if (*slot == NONE) {
        *slot = (uint32_t)mesh->vertex_count;
        *vertex = *slot;
        return hewn_builder_add_vertex(&welder->builder, position, error);
    }
    *vertex = *slot;
    return HEWN_OK;
}

/* --- binary ----------------------------------------------------------------------------------------------------------
 */

static hewn_result read_binary(stl_welder *welder, const char *bytes, const char *name, hewn_error *error)
{
    uint64_t count = hewn_get_u32(bytes + HEADER - 4);
    for (uint64_t t = 0; t < count; t++) {
        const char *at = bytes + HEADER + FACET * t + 12;
        uint32_t corner[3] = {0};
        for (int k = 0; k < 3; k++, at += 12) {
            uint32_t bits[3] = {hewn_get_u32(at), hewn_get_u32(at + 4), hewn_get_u32(at + 8)};
            float position[3];
            memcpy(position, bits, sizeof position);
            if (!(isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2])))
                return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "facet %llu has a position that is not finite",
                                    (unsigned long long)t);
            HEWN_TRY(weld(welder, position, &corner[k], error));
        }
        HEWN_TRY(hewn_builder_add_triangle(&welder->builder, corner[0], corner[1], corner[2], error));
    }
    return HEWN_OK;
}

/* --- text ------------------------------------------------------------------------------------------------------------
 */

static hewn_result expect(hewn_scan *scan, const char *keyword, hewn_error *error)
{
    hewn_word word = hewn_scan_word(scan);
    if (hewn_word_is_any_case(word, keyword))
        return HEWN_OK;
    char what[48];
    snprintf(what, sizeof what, "\"%s\" is expected", keyword);
    return hewn_scan_fail(scan, word, what, error);
}

static hewn_result read_corner(stl_welder *welder, hewn_scan *scan, uint32_t *vertex, hewn_error *error)
{
    float position[3];
    for (int axis = 0; axis < 3; axis++) {
        hewn_word word = hewn_scan_word(scan);
        if (!hewn_word_float(word, &position[axis]) || !isfinite(position[axis]))
            return hewn_scan_fail(scan, word, "a finite number is expected", error);
    }
    return weld(welder, position, vertex, error);
}

/* From after "facet" to its end. Its normal is not looked at: exporters write all kinds of things there. */
static hewn_result read_facet(stl_welder *welder, hewn_scan *scan, hewn_error *error)
{
    HEWN_TRY(expect(scan, "normal", error));
    for (int axis = 0; axis < 3; axis++)
        hewn_scan_word(scan);
    HEWN_TRY(expect(scan, "outer", error));
    HEWN_TRY(expect(scan, "loop", error));
    uint32_t first = 0, last = 0;
    for (uint64_t count = 0;; count++) {
        hewn_word word = hewn_scan_word(scan);
        if (hewn_word_is_any_case(word, "endloop") && count >= 3)
            break;
        if (!hewn_word_is_any_case(word, "vertex"))
            return hewn_scan_fail(scan, word, count < 3 ? "\"vertex\" is expected" : "\"endloop\" is expected", error);
        uint32_t vertex = 0;
        HEWN_TRY(read_corner(welder, scan, &vertex, error));
        if (count == 0)
            first = vertex;
        if (count >= 2)
            HEWN_TRY(hewn_builder_add_triangle(&welder->builder, first, last, vertex, error));
        last = vertex;
    }
    return expect(scan, "endfacet", error);
}

static hewn_result read_text(stl_welder *welder, hewn_scan *scan, hewn_error *error)
{
    bool inside = false;
    for (;;) {
        hewn_word word = hewn_scan_word(scan);
        bool ends = word.begin == word.end;
        if (ends && !inside)
            return HEWN_OK;
        if (!inside && hewn_word_is_any_case(word, "solid")) {
            hewn_scan_line(scan); /* the rest is a name */
            inside = true;
        } else if (inside && hewn_word_is_any_case(word, "facet")) {
            HEWN_TRY(read_facet(welder, scan, error));
        } else if (inside && hewn_word_is_any_case(word, "endsolid")) {
            hewn_scan_line(scan);
            inside = false;
        } else {
            return hewn_scan_fail(scan, word,
                                  inside ? "\"facet\" or \"endsolid\" is expected" : "\"solid\" is expected", error);
        }
    }
}

/* --- which -----------------------------------------------------------------------------------------------------------
 */

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

static hewn_result check_binary(const char *bytes, size_t length, const char *name, hewn_error *error)
{
    if (length == 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "the file is empty");
    if (length < HEADER)
        return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "neither text nor long enough for a binary STL file");
    uint64_t count = hewn_get_u32(bytes + HEADER - 4);
    if (HEADER + FACET * count > length)
        return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0,
                            "the header promises %llu facets, but the file's %zu bytes hold at most %llu",
                            (unsigned long long)count, length, (unsigned long long)((length - HEADER) / FACET));
    return HEWN_OK;
}

hewn_result hewn_stl_read(const char *bytes, size_t length, const char *name, hewn_triangles *out, hewn_error *error)
{
    *out = (hewn_triangles){0};
    stl_welder welder = {0};
    hewn_result result;
    if (is_text(bytes, length)) {
        hewn_scan scan = {bytes, bytes + length, name, 1};
        result = read_text(&welder, &scan, error);
    } else {
        result = check_binary(bytes, length, name, error);
        if (result == HEWN_OK)
            result = read_binary(&welder, bytes, name, error);
    }
    if (result == HEWN_OK)
        result = hewn_builder_finish(&welder.builder, name, out, error);
    hewn_builder_clear(&welder.builder);
    hewn_free(welder.slots);
    return result;
}
