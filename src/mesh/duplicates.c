#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/soup.h"

/* A face read from its lowest corner towards the lower of that corner's neighbours: equal for all faces around the same
 * corners. Corners of a face are distinct. */
typedef struct face_reader {
    const uint32_t *corners;
    uint32_t length, start;
    bool forward;
} face_reader;

static face_reader read_face(const hewn_soup *soup, uint32_t face)
{
    face_reader reader = {soup->corners + soup->first[face], (uint32_t)(soup->first[face + 1] - soup->first[face]), 0,
                          true};
    for (uint32_t i = 1; i < reader.length; i++)
        if (reader.corners[i] < reader.corners[reader.start])
            reader.start = i;
    uint32_t after = reader.corners[(reader.start + 1) % reader.length];
    uint32_t before = reader.corners[(reader.start + reader.length - 1) % reader.length];
    reader.forward = after < before;
    return reader;
}

static uint32_t corner_at(const face_reader *reader, uint32_t i)
{
    uint32_t at = reader->start + (reader->forward ? i : reader->length - i);
    return reader->corners[at >= reader->length ? at - reader->length : at];
}

static bool same_face(const face_reader *a, const face_reader *b)
{
    if (a->length != b->length)
        return false;
    for (uint32_t i = 0; i < a->length; i++)
        if (corner_at(a, i) != corner_at(b, i))
            return false;
    return true;
}

static uint64_t hash_face(const face_reader *reader)
{
    uint64_t hash = reader->length;
    for (uint32_t i = 0; i < reader->length; i++) {
        hash = (hash ^ corner_at(reader, i)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    return hash * 0xbf58476d1ce4e5b9u;
}

/* The faces around one cycle of corners, at its lowest face. */
typedef struct face_class {
    uint32_t alike;    /* run as the lowest does, itself included */
    uint32_t opposite; /* run the other way */
    uint32_t first_opposite;
} face_class;

/* Writes each face's lowest twin to `lowest`, and classes there. */
static hewn_result classify(const hewn_soup *soup, uint32_t *lowest, face_class *classes, hewn_error *error)
{
    uint64_t size = 16;
    while (size < 2 * (uint64_t)soup->face_count)
        size *= 2;
    uint32_t *slots = hewn_alloc(size, sizeof *slots);
    if (!slots)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory comparing %u faces", soup->face_count);
    memset(slots, 0xFF, size * sizeof *slots);
    for (uint32_t f = 0; f < soup->face_count; f++) {
        face_reader reader = read_face(soup, f), other = reader;
        uint64_t at = hash_face(&reader) >> 20 & (size - 1);
        for (; slots[at] != HEWN_NONE; at = (at + 1) & (size - 1)) {
            other = read_face(soup, slots[at]);
            if (same_face(&reader, &other))
                break;
        }
        if (slots[at] == HEWN_NONE)
            slots[at] = f;
        lowest[f] = slots[at];
        face_class *twins = classes + lowest[f];
        if (f == lowest[f])
            *twins = (face_class){.alike = 1, .first_opposite = HEWN_NONE};
        else if (reader.forward == other.forward)
            twins->alike++;
        else if (twins->opposite++ == 0)
            twins->first_opposite = f;
    }
    hewn_free(slots);
    return HEWN_OK;
}

static bool stays(uint32_t face, uint32_t lowest, const face_class *twins, hewn_opposite opposite)
{
    if (face != lowest && face != twins->first_opposite)
        return false;
    switch (opposite) {
    case HEWN_OPPOSITE_KEEP: return true;
    case HEWN_OPPOSITE_CANCEL: return face == lowest ? twins->alike > twins->opposite : twins->opposite > twins->alike;
    default: return face == lowest;
    }
}

hewn_result hewn_soup_drop_duplicates(hewn_soup *soup, hewn_opposite opposite, bool strict, hewn_repair_report *report,
                                      hewn_error *error)
{
    uint32_t *lowest = hewn_alloc(soup->face_count, sizeof *lowest);
    face_class *classes = hewn_alloc(soup->face_count, sizeof *classes);
    uint8_t *keep = hewn_alloc(soup->face_count, 1);
    hewn_result result = lowest && classes && keep ? classify(soup, lowest, classes, error)
                                                   : hewn_fail(error, HEWN_OUT_OF_MEMORY,
                                                               "out of memory comparing %u faces", soup->face_count);
    uint64_t dropped = 0;
    for (uint32_t f = 0; result == HEWN_OK && f < soup->face_count; f++) {
        keep[f] = stays(f, lowest[f], classes + lowest[f], opposite);
        dropped += !keep[f];
        if (!keep[f] && strict)
            result = hewn_fail(error, HEWN_BAD_INPUT, "face %u has the same corners as another face (the first is %u)",
                               soup->face_origins[f], soup->face_origins[lowest[f]]);
    }
    if (result == HEWN_OK && dropped > 0) {
        hewn_soup_keep_faces(soup, keep);
        report->duplicate_faces += dropped;
    }
    hewn_free(keep);
    hewn_free(classes);
    hewn_free(lowest);
    return result;
}
