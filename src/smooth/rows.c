#include "smooth/rows.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

enum { MOST_PARTS = 8, SHORT_ROW = 48 };

void hewn_smooth_rows_free(smooth_rows *rows)
{
    hewn_free(rows->first);
    hewn_free(rows->items);
    *rows = (smooth_rows){0};
}

/* Sides or corners of all faces are handed to the vertices by several threads at once: each reads all of them and
 * serves a range of vertices of its own, so no order depends on threads. */
typedef struct row_filler {
    const hewn_polygons *polygons;
    uint32_t *ends; /* of each row, counted up while it is filled */
    uint32_t *items;
    bool sides; /* both ends of each side, else corners */
} row_filler;

static inline void serve(const row_filler *filler, uint32_t vertex, uint32_t item)
{
    if (filler->items)
        filler->items[filler->ends[vertex]] = item;
    filler->ends[vertex]++;
}

static inline bool is_in(uint32_t vertex, uint32_t from, uint32_t to)
{
    return vertex - from < to - from;
}

static void serve_range(const row_filler *filler, uint32_t from, uint32_t to)
{
    const hewn_polygons *polygons = filler->polygons;
    const uint32_t *corners = polygons->corners;
    for (uint64_t f = 0, begin = 0; f < polygons->face_count; f++) {
        uint64_t end = smooth_face_begin(polygons, f + 1);
        uint32_t before = end > begin ? corners[end - 1] : 0;
        for (uint64_t c = begin; c < end; c++) {
            uint32_t at = corners[c];
            if (!filler->sides && is_in(at, from, to))
                serve(filler, at, (uint32_t)c);
            if (filler->sides && at != before) {
                if (is_in(at, from, to))
                    serve(filler, at, before);
                if (is_in(before, from, to))
                    serve(filler, before, at);
            }
            before = at;
        }
        begin = end;
    }
}

static void serve_all(const row_filler *filler)
{
    int parts = omp_get_max_threads();
    parts = parts > MOST_PARTS ? MOST_PARTS : parts;
    uint64_t count = filler->polygons->vertex_count;
    parts = count < 4096 ? 1 : parts;
#pragma omp parallel for schedule(static) num_threads(parts) if (parts > 1)
    for (int part = 0; part < parts; part++)
        serve_range(filler, (uint32_t)(count * (uint64_t)part / (uint64_t)parts),
                    (uint32_t)(count * ((uint64_t)part + 1) / (uint64_t)parts));
}

/* Rows of raw entries: for sides each neighbour once for every face beside the edge. */
static hewn_result fill_rows(const hewn_polygons *polygons, bool sides, smooth_rows *out, hewn_error *error)
{
    uint32_t count = (uint32_t)polygons->vertex_count;
    *out = (smooth_rows){.count = count, .first = hewn_alloc_zero((size_t)count + 1, sizeof *out->first)};
    if (!out->first)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the neighbours of %u vertices", count);
    row_filler filler = {.polygons = polygons, .ends = out->first + 1, .sides = sides};
    serve_all(&filler);
    uint32_t sum = 0;
    for (uint32_t v = 0; v < count; v++) { /* lengths become beginnings, one place later, which filling makes ends */
        uint32_t length = out->first[v + 1];
        out->first[v + 1] = sum;
        sum += length;
    }
    out->items = hewn_alloc(sum, sizeof *out->items);
    if (!out->items)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the neighbours of %u vertices", count);
    filler.items = out->items;
    serve_all(&filler);
    return HEWN_OK;
}

hewn_result hewn_smooth_corners(const hewn_polygons *polygons, smooth_rows *out, hewn_error *error)
{
    hewn_result result = fill_rows(polygons, false, out, error);
    if (result != HEWN_OK)
        hewn_smooth_rows_free(out);
    return result;
}

/* --- neighbours --------------------------------------------------------------------------------------------------- */

static int by_id(const void *a, const void *b)
{
    uint32_t left = *(const uint32_t *)a, right = *(const uint32_t *)b;
    return (left > right) - (left < right);
}

static void sort_row(uint32_t *row, uint32_t length)
{
    if (length > SHORT_ROW) {
        qsort(row, length, sizeof *row, by_id);
        return;
    }
    for (uint32_t i = 1; i < length; i++) {
        uint32_t item = row[i], at = i;
        for (; at > 0 && row[at - 1] > item; at--)
            row[at] = row[at - 1];
        row[at] = item;
    }
}

/* Sorts a row of raw entries and keeps at its front what belongs there; the new length is returned. */
static uint32_t settle_row(uint32_t *row, uint32_t length, uint8_t *flags)
{
    sort_row(row, length);
    uint32_t kept = 0, rims = 0, rim[2] = {0, 0};
    for (uint32_t i = 0; i < length;) {
        uint32_t end = i + 1;
        while (end < length && row[end] == row[i])
            end++;
        if (end - i != 2 && rims++ < 2)
            rim[rims - 1] = row[i];
        row[kept++] = row[i];
        i = end;
    }
    *flags = (uint8_t)((length > 0 ? SMOOTH_USED : 0) | (rims > 0 ? SMOOTH_RIM : 0));
    if (rims == 2)
        memcpy(row, rim, sizeof rim);
    return rims == 0 ? kept : rims == 2 ? 2 : 0;
}

hewn_result hewn_smooth_neighbours(const hewn_polygons *polygons, smooth_rows *out, uint8_t *flags, hewn_error *error)
{
    smooth_rows raw;
    uint32_t count = (uint32_t)polygons->vertex_count;
    *out = (smooth_rows){.count = count, .first = hewn_alloc((size_t)count + 1, sizeof *out->first)};
    hewn_result result = fill_rows(polygons, true, &raw, error);
    if (result == HEWN_OK && !out->first)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the neighbours of %u vertices", count);
    if (result == HEWN_OK) {
#pragma omp parallel for schedule(static)
        for (uint32_t v = 0; v < count; v++)
            out->first[v] = settle_row(raw.items + raw.first[v], raw.first[v + 1] - raw.first[v], flags + v);
        uint32_t sum = 0;
        for (uint32_t v = 0; v < count; v++) {
            uint32_t length = out->first[v];
            out->first[v] = sum;
            sum += length;
        }
        out->first[count] = sum;
        out->items = hewn_alloc(sum, sizeof *out->items);
        if (!out->items)
            result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the neighbours of %u vertices", count);
    }
    if (result == HEWN_OK)
#pragma omp parallel for schedule(static)
        for (uint32_t v = 0; v < count; v++)
            memcpy(out->items + out->first[v], raw.items + raw.first[v],
                   (out->first[v + 1] - out->first[v]) * sizeof *out->items);
    hewn_smooth_rows_free(&raw);
    if (result != HEWN_OK)
        hewn_smooth_rows_free(out);
    return result;
}
