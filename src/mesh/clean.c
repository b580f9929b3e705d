#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/soup.h"

/* A face being walked: the corners since the last cut, and where in that pile each vertex is. */
typedef struct face_cleaner {
    uint32_t *vertices;
    uint32_t *origins;
    uint32_t *place; /* of each vertex in the pile, HEWN_NONE if not there */
    uint64_t *first; /* of the new faces */
    uint32_t *face_origins;
    uint8_t *turned;
    uint32_t face_count, corner_count;
} face_cleaner;

static hewn_result create_cleaner(const hewn_soup *soup, face_cleaner *out, hewn_error *error)
{
    uint32_t corners = hewn_soup_corner_count(soup);
    *out = (face_cleaner){.vertices = hewn_alloc(corners, sizeof *out->vertices),
                          .origins = hewn_alloc(corners, sizeof *out->origins),
                          .place = hewn_alloc(soup->vertex_count, sizeof *out->place),
                          .first = hewn_alloc_zero((size_t)corners / 3 + 2, sizeof *out->first),
                          .face_origins = hewn_alloc((size_t)corners / 3 + 1, sizeof *out->face_origins)};
    out->turned = hewn_alloc_zero((size_t)corners / 3 + 1, 1);
    if (!out->turned || !out->vertices || !out->origins || !out->place || !out->first || !out->face_origins)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory cleaning faces");
    if (soup->vertex_count > 0)
        memset(out->place, 0xFF, soup->vertex_count * sizeof *out->place);
    return HEWN_OK;
}

static void free_cleaner(face_cleaner *cleaner)
{
    hewn_free(cleaner->vertices);
    hewn_free(cleaner->origins);
    hewn_free(cleaner->place);
    hewn_free(cleaner->first);
    hewn_free(cleaner->face_origins);
    hewn_free(cleaner->turned);
}

/* Takes pile items from `bottom` up as a face, if they are enough. Never writes past the corners already read. */
static void emit(hewn_soup *soup, face_cleaner *cleaner, uint32_t face, uint32_t bottom, uint32_t top)
{
    for (uint32_t i = bottom; i < top; i++)
        cleaner->place[cleaner->vertices[i]] = HEWN_NONE;
    if (top - bottom < 3)
        return;
    size_t bytes = (top - bottom) * sizeof *soup->corners;
    memcpy(soup->corners + cleaner->corner_count, cleaner->vertices + bottom, bytes);
    memcpy(soup->corner_origins + cleaner->corner_count, cleaner->origins + bottom, bytes);
    cleaner->corner_count += top - bottom;
    cleaner->face_origins[cleaner->face_count++] = soup->face_origins[face];
    cleaner->first[cleaner->face_count] = cleaner->corner_count;
}

/* Whether the face was more than simply taken over. */
static bool clean_face(hewn_soup *soup, face_cleaner *cleaner, uint32_t face)
{
    uint32_t height = 0;
    bool repeated = false;
    for (uint64_t c = soup->first[face]; c < soup->first[face + 1]; c++) {
        uint32_t vertex = soup->corners[c], origin = soup->corner_origins[c];
        uint32_t place = cleaner->place[vertex];
        if (place != HEWN_NONE) {
            emit(soup, cleaner, face, place, height);
            height = place;
            repeated = true;
        }
        cleaner->vertices[height] = vertex;
        cleaner->origins[height] = origin;
        cleaner->place[vertex] = height++;
    }
    emit(soup, cleaner, face, 0, height);
    return repeated;
}

/* The first face that cleaning would touch. */
static hewn_result refuse(const hewn_soup *soup, face_cleaner *cleaner, hewn_error *error)
{
    for (uint32_t f = 0; f < soup->face_count; f++) {
        uint64_t begin = soup->first[f], end = soup->first[f + 1];
        if (end - begin < 3)
            return hewn_fail(error, HEWN_BAD_INPUT, "face %u has only %u corners", soup->face_origins[f],
                             (unsigned)(end - begin));
        for (uint64_t c = begin; c < end; c++) {
            if (cleaner->place[soup->corners[c]] == f)
                return hewn_fail(error, HEWN_BAD_INPUT, "face %u meets vertex %u twice", soup->face_origins[f],
                                 soup->vertex_origins[soup->corners[c]]);
            cleaner->place[soup->corners[c]] = f;
        }
    }
    return HEWN_OK;
}

static hewn_result drop_flat_faces(hewn_soup *soup, bool strict, hewn_repair_report *report, hewn_error *error)
{
    uint8_t *keep = hewn_alloc(soup->face_count, 1);
    if (!keep)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory dropping flat faces");
    for (uint32_t f = 0; f < soup->face_count; f++) {
        double normal[3];
        hewn_soup_face_normal(soup, f, normal);
        keep[f] = !(normal[0] == 0 && normal[1] == 0 && normal[2] == 0);
        report->flat_faces += !keep[f];
        if (!keep[f] && strict) {
            hewn_free(keep);
            return hewn_fail(error, HEWN_BAD_INPUT, "face %u has no area", soup->face_origins[f]);
        }
    }
    hewn_soup_keep_faces(soup, keep);
    hewn_free(keep);
    return HEWN_OK;
}

static void clean_faces(hewn_soup *soup, face_cleaner *cleaner, hewn_repair_report *report)
{
    for (uint32_t f = 0; f < soup->face_count; f++) {
        uint32_t before = cleaner->face_count;
        bool repeated = clean_face(soup, cleaner, f);
        report->degenerate_faces += cleaner->face_count == before;
        report->cleaned_faces += repeated && cleaner->face_count > before;
    }
    hewn_free(soup->first);
    hewn_free(soup->face_origins);
    hewn_free(soup->turned);
    soup->first = cleaner->first;
    soup->face_origins = cleaner->face_origins;
    soup->face_count = cleaner->face_count;
    cleaner->first = NULL;
    cleaner->face_origins = NULL;
    soup->turned = cleaner->turned;
    cleaner->turned = NULL;
}

hewn_result hewn_soup_clean(hewn_soup *soup, bool drop_flat, bool strict, hewn_repair_report *report, hewn_error *error)
{
    face_cleaner cleaner;
    size_t room = hewn_soup_corner_count(soup) / 3;
    hewn_result result = create_cleaner(soup, &cleaner, error);
    if (result == HEWN_OK && strict)
        result = refuse(soup, &cleaner, error);
    else if (result == HEWN_OK) {
        clean_faces(soup, &cleaner, report);
        soup->first_capacity = room + 2;
        soup->face_capacity = soup->turned_capacity = room + 1;
    }
    free_cleaner(&cleaner);
    if (result == HEWN_OK && drop_flat)
        result = drop_flat_faces(soup, strict, report, error);
    return result;
}
