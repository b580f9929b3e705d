#include "smooth/rows.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

enum { MOST_PARTS = 8, SHORT_ROW = 48, MOST_INSIDE = 8 };

void hewn_smooth_rows_free(smooth_rows *rows)
{
    hewn_free(rows->first);
    hewn_free(rows->items);
    *rows = (smooth_rows){0};
}

/* --- corners ------------------------------------------------------------------------------------------------------ */

/* The vertices before and after a corner in its face. */
typedef struct corner_sides {
    uint32_t next, before;
} corner_sides;

/* Corners of all faces are handed to the vertices by several threads at once: each reads all of them and serves a range
 * of vertices of its own, so no order depends on threads. Without rows to fill they are only counted. */
typedef struct row_filler {
    const hewn_polygons *polygons;
    uint32_t *ends;      /* of each row, counted up while it is filled */
    uint32_t *corners;   /* rows of corners, or */
    corner_sides *sides; /* rows of their sides */
} row_filler;

typedef enum row_kind { COUNTED, CORNERS, SIDES } row_kind;

/* A range of vertices, which one thread serves with rows of one kind. */
typedef struct row_server {
    uint32_t *ends, *corners;
    corner_sides *sides;
    uint32_t from, length;
} row_server;

static inline void serve(const row_server *to, row_kind kind, uint64_t corner, const uint32_t around[3])
{
    uint32_t at = around[1];
    if (at - to->from >= to->length)
        return;
    uint32_t place = to->ends[at]++;
    if (kind == CORNERS)
        to->corners[place] = (uint32_t)corner;
    if (kind == SIDES)
        to->sides[place] = (corner_sides){around[2], around[0]};
}

static inline void serve_triangles(const hewn_polygons *polygons, row_server to, row_kind kind)
{
    for (uint64_t c = 0; c < 3 * polygons->face_count; c += 3) {
        const uint32_t *corner = polygons->corners + c;
        const uint32_t around[5] = {corner[2], corner[0], corner[1], corner[2], corner[0]};
        for (uint64_t k = 0; k < 3; k++)
            serve(&to, kind, c + k, around + k);
    }
}

static inline void serve_polygons(const hewn_polygons *polygons, row_server to, row_kind kind)
{
    for (uint64_t f = 0; f < polygons->face_count; f++) {
        uint64_t begin = polygons->first[f], end = polygons->first[f + 1];
        for (uint64_t c = begin; c < end; c++) {
            const uint32_t around[3] = {polygons->corners[c > begin ? c - 1 : end - 1], polygons->corners[c],
                                        polygons->corners[c + 1 < end ? c + 1 : begin]};
            serve(&to, kind, c, around);
        }
    }
}

static void serve_range(const row_filler *filler, uint32_t from, uint32_t to)
{
    const hewn_polygons *polygons = filler->polygons;
    const row_server server = {filler->ends, filler->corners, filler->sides, from, to - from};
    row_kind kind = filler->corners ? CORNERS : filler->sides ? SIDES : COUNTED;
    if (polygons->first)
        serve_polygons(polygons, server, kind);
    else if (kind == CORNERS)
        serve_triangles(polygons, server, CORNERS);
    else if (kind == SIDES)
        serve_triangles(polygons, server, SIDES);
    else
        serve_triangles(polygons, server, COUNTED);
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

static hewn_result out_of_memory(uint32_t count, hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the neighbours of %u vertices", count);
}

/* Where rows of corners begin; with room for another word a row after them. */
static hewn_result count_corners(const hewn_polygons *polygons, uint32_t **first, hewn_error *error)
{
    uint32_t count = (uint32_t)polygons->vertex_count, sum = 0;
    *first = hewn_alloc_zero((size_t)count + 2, sizeof **first);
    if (!*first)
        return out_of_memory(count, error);
    const row_filler counter = {.polygons = polygons, .ends = *first + 2};
    serve_all(&counter);
    for (uint32_t v = 0; v < count; v++) { /* lengths become beginnings, one place later, which filling makes ends */
        uint32_t length = (*first)[v + 2];
        (*first)[v + 1] = sum;
        sum += length;
    }
    (*first)[count + 1] = sum;
    return HEWN_OK;
}

hewn_result hewn_smooth_corners(const hewn_polygons *polygons, smooth_rows *out, hewn_error *error)
{
    *out = (smooth_rows){.count = (uint32_t)polygons->vertex_count};
    hewn_result result = count_corners(polygons, &out->first, error);
    if (result == HEWN_OK) {
        out->items = hewn_alloc(out->first[out->count + 1], sizeof *out->items);
        if (!out->items)
            result = out_of_memory(out->count, error);
    }
    if (result != HEWN_OK) {
        hewn_smooth_rows_free(out);
        return result;
    }
    const row_filler filler = {.polygons = polygons, .ends = out->first + 1, .corners = out->items};
    serve_all(&filler);
    return HEWN_OK;
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

/* Neighbours, each once for every face beside the edge: those that all edges share belong there, or the two of the rim.
 * They go to the row's front; how many they are is returned. */
static uint32_t settle_rim(uint32_t *row, uint32_t length, uint8_t *flags)
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

/* Sorts `count` of MOST_INSIDE items by counting those that are less, without a branch; false where two are the same.
 * Items past the count are INT32_MAX, which no vertex is. */
static bool rank_sort(const int32_t items[MOST_INSIDE], uint32_t count, uint32_t *out)
{
    int32_t ranks[MOST_INSIDE] = {0};
    uint32_t taken = 0;
    for (int k = 0; k < MOST_INSIDE; k++)
        for (int i = 0; i < MOST_INSIDE; i++)
            ranks[i] += items[k] < items[i];
    for (uint32_t i = 0; i < count; i++) {
        out[ranks[i]] = (uint32_t)items[i];
        taken |= 1u << ranks[i];
    }
    return taken == (1u << count) - 1;
}

/* Whether each of `count` items stands exactly once in `among`. */
static bool stand_once(const int32_t items[MOST_INSIDE], const int32_t among[MOST_INSIDE], uint32_t count)
{
    int32_t found[MOST_INSIDE] = {0}, wrong = 0;
    for (int k = 0; k < MOST_INSIDE; k++)
        for (int i = 0; i < MOST_INSIDE; i++)
            found[i] += items[i] == among[k];
    for (uint32_t i = 0; i < count; i++)
        wrong |= found[i] ^ 1;
    return wrong == 0;
}

/* Around most vertices each neighbour comes after one corner and before another: these are sorted to `out`. */
static bool settle_inside(const corner_sides *sides, uint32_t length, uint32_t v, uint32_t out[MOST_INSIDE])
{
    int32_t next[MOST_INSIDE], before[MOST_INSIDE];
    bool itself = length == 0;
    for (uint32_t i = 0; i < MOST_INSIDE; i++)
        next[i] = before[i] = INT32_MAX;
    for (uint32_t i = 0; i < length; i++) {
        next[i] = (int32_t)sides[i].next;
        before[i] = (int32_t)sides[i].before;
        itself = itself || next[i] == (int32_t)v;
    }
    return !itself && stand_once(next, before, length) && rank_sort(next, length, out);
}

/* Rows under way: those of sides, in whose order vertices are served, become rows of neighbours. */
typedef struct row_settler {
    const uint32_t *places; /* where rows begin, by their corners */
    corner_sides *sides;
    uint32_t *items; /* room for a neighbour a corner */
} row_settler;

/* Where a row of `kept` neighbours lies: a vertex of a rim may have one more than it has corners. */
static uint32_t *settled_row(const row_settler *rows, uint32_t v, uint32_t kept)
{
    const uint32_t place = rows->places[v], length = rows->places[v + 1] - place;
    return kept <= length ? rows->items + place : (uint32_t *)(rows->sides + place);
}

/* Finds the neighbours of a vertex; returns how many they are. */
static uint32_t settle_row(const row_settler *rows, uint32_t v, uint8_t *flags)
{
    corner_sides *sides = rows->sides + rows->places[v];
    const uint32_t length = rows->places[v + 1] - rows->places[v];
    uint32_t inside[MOST_INSIDE], *row = (uint32_t *)sides, kept = 0;
    if (length <= MOST_INSIDE && settle_inside(sides, length, v, inside)) {
        memcpy(rows->items + rows->places[v], inside, length * sizeof *inside);
        *flags = SMOOTH_USED;
        return length;
    }
    for (uint32_t i = 0; i < 2 * length; i++)
        if (row[i] != v)
            row[kept++] = row[i];
    kept = settle_rim(row, kept, flags);
    if (kept <= length)
        memcpy(rows->items + rows->places[v], row, kept * sizeof *row);
    return kept;
}

/* Settles all rows, whose lengths go to `lengths`; returns whether each is as long as it has corners, which is so for
 * closed surfaces. */
static bool settle_each(const row_settler *rows, uint32_t count, uint32_t *lengths, uint8_t *flags)
{
    bool even = true;
#pragma omp parallel for schedule(static) reduction(&& : even)
    for (uint32_t v = 0; v < count; v++) {
        lengths[v] = settle_row(rows, v, flags + v);
        even = even && lengths[v] == rows->places[v + 1] - rows->places[v];
    }
    return even;
}

/* Moves rows together; `first` holds the lengths of `out`'s. */
static hewn_result take_rows(const row_settler *rows, smooth_rows *out, hewn_error *error)
{
    uint32_t sum = 0;
    for (uint32_t v = 0; v < out->count; v++) {
        uint32_t length = out->first[v];
        out->first[v] = sum;
        sum += length;
    }
    out->first[out->count] = sum;
    out->items = hewn_alloc(sum, sizeof *out->items);
    if (!out->items)
        return out_of_memory(out->count, error);
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < out->count; v++) {
        const uint32_t length = out->first[v + 1] - out->first[v];
        memcpy(out->items + out->first[v], settled_row(rows, v, length), length * sizeof *out->items);
    }
    return HEWN_OK;
}

static hewn_result settle_rows(const hewn_polygons *polygons, uint32_t **places, smooth_rows *out, uint8_t *flags,
                               hewn_error *error)
{
    row_settler rows = {*places, hewn_alloc((*places)[out->count + 1], sizeof *rows.sides),
                        hewn_alloc((*places)[out->count + 1], sizeof *rows.items)};
    hewn_result result = rows.sides && rows.items ? HEWN_OK : out_of_memory(out->count, error);
    if (result == HEWN_OK) {
        const row_filler filler = {.polygons = polygons, .ends = *places + 1, .sides = rows.sides};
        serve_all(&filler);
        if (settle_each(&rows, out->count, out->first, flags)) {
            hewn_free(out->first);
            *out = (smooth_rows){out->count, *places, rows.items};
            *places = rows.items = NULL;
        } else {
            result = take_rows(&rows, out, error);
        }
    }
    hewn_free(rows.sides);
    hewn_free(rows.items);
    return result;
}

hewn_result hewn_smooth_neighbours(const hewn_polygons *polygons, smooth_rows *out, uint8_t *flags, hewn_error *error)
{
    uint32_t count = (uint32_t)polygons->vertex_count, *places = NULL;
    *out = (smooth_rows){.count = count, .first = hewn_alloc((size_t)count + 1, sizeof *out->first)};
    hewn_result result = out->first ? HEWN_OK : out_of_memory(count, error);
    if (result == HEWN_OK)
        result = count_corners(polygons, &places, error);
    if (result == HEWN_OK)
        result = settle_rows(polygons, &places, out, flags, error);
    hewn_free(places);
    if (result != HEWN_OK)
        hewn_smooth_rows_free(out);
    return result;
}
