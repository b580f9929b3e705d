#include "smooth/rows.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "smooth/blocks.h"
#include "smooth/four.h"

enum { MOST_PARTS = 8, SHORT_ROW = 48 };

void hewn_smooth_rows_free(smooth_rows *rows)
{
    hewn_free(rows->first);
    hewn_free(rows->items);
    *rows = (smooth_rows){0};
}

void hewn_smooth_sides_free(smooth_sides *sides)
{
    hewn_free(sides->first);
    hewn_free(sides->items);
    *sides = (smooth_sides){0};
}

/* --- corners ------------------------------------------------------------------------------------------------------ */

/* Corners of all faces are handed to the vertices by several threads at once: each reads all of them and serves a range
 * of vertices of its own, so no order depends on threads. Without rows to fill they are only counted. */
typedef struct row_filler {
    const hewn_polygons *polygons;
    uint32_t *ends;     /* of each row, counted up while it is filled */
    uint32_t *corners;  /* rows of corners, or */
    smooth_side *sides; /* rows of their sides */
} row_filler;

typedef enum row_kind { COUNTED, CORNERS, SIDES } row_kind;

/* A range of vertices, which one thread serves with rows of one kind. */
typedef struct row_server {
    uint32_t *ends, *corners;
    smooth_side *sides;
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
        to->sides[place] = (smooth_side){around[2], around[0]};
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

hewn_result hewn_smooth_sides_find(const hewn_polygons *polygons, smooth_sides *out, hewn_error *error)
{
    *out = (smooth_sides){.count = (uint32_t)polygons->vertex_count};
    hewn_result result = count_corners(polygons, &out->first, error);
    if (result == HEWN_OK) {
        /* Rows are read SMOOTH_EIGHT at a time, the last one too. */
        const size_t sum = out->first[out->count + 1];
        out->items = hewn_alloc(sum + SMOOTH_EIGHT, sizeof *out->items);
        if (out->items)
            memset(out->items + sum, 0, SMOOTH_EIGHT * sizeof *out->items);
        else
            result = out_of_memory(out->count, error);
    }
    if (result != HEWN_OK) {
        hewn_smooth_sides_free(out);
        return result;
    }
    const row_filler filler = {.polygons = polygons, .ends = out->first + 1, .sides = out->items};
    serve_all(&filler);
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

#define SPREAD(HALF, LANE) __builtin_shufflevector(HALF, HALF, LANE, LANE, LANE, LANE)

/* Whether each of the items stands exactly once in `among`. */
static inline bool stand_once(const smooth_eight *items, const smooth_eight *among)
{
    const smooth_four none = {0};
    smooth_eight found = {{none, none}};
    for (int half = 0; half < 2; half++) {
        const smooth_four each[4] = {SPREAD(among->half[half], 0), SPREAD(among->half[half], 1),
                                     SPREAD(among->half[half], 2), SPREAD(among->half[half], 3)};
        for (int k = 0; k < 4; k++) {
            found.half[0] += items->half[0] == each[k]; /* -1 where they are the same */
            found.half[1] += items->half[1] == each[k];
        }
    }
    const smooth_four wrong = (found.half[0] + 1) | (found.half[1] + 1);
    return (wrong[0] | wrong[1] | wrong[2] | wrong[3]) == 0;
}

/* Around most vertices each neighbour comes after one corner and before another: then those after corners, in the order
 * of corners, are the row. Items past the length are what only they are. */
static inline bool settle_inside(const smooth_side *sides, uint32_t length, uint32_t v, smooth_eight *out)
{
    smooth_four pairs[4], itself = {0};
    smooth_eight before;
    memcpy(pairs, sides, sizeof pairs);
    for (int half = 0; half < 2; half++) {
        const smooth_four lane = (smooth_four){0, 1, 2, 3} + 4 * half, held = lane < (int32_t)length;
        const smooth_four other = INT32_MIN + lane;
        const smooth_four next = __builtin_shufflevector(pairs[2 * half], pairs[2 * half + 1], 0, 2, 4, 6);
        const smooth_four last = __builtin_shufflevector(pairs[2 * half], pairs[2 * half + 1], 1, 3, 5, 7);
        out->half[half] = (held & next) | (~held & other);
        before.half[half] = (held & last) | (~held & other);
        itself |= out->half[half] == (int32_t)v;
    }
    return (itself[0] | itself[1] | itself[2] | itself[3]) == 0 && stand_once(out, &before) && stand_once(&before, out);
}

/* Rows under way: those of sides become rows of neighbours. */
typedef struct row_settler {
    const smooth_sides *sides;
    uint32_t *lengths; /* of rows; NOT_SETTLED at first where they are not inside */
    uint32_t *items;   /* room for a neighbour a corner */
    uint32_t *room;    /* for two neighbours a corner */
    uint8_t *flags;
} row_settler;

#define NOT_SETTLED UINT32_MAX

/* Settles the rows inside a surface among a range of vertices; whether those are all. */
static bool settle_block(const row_settler *rows, uint32_t begin, uint32_t end)
{
    const uint32_t *first = rows->sides->first;
    bool all = true;
    for (uint32_t v = begin; v < end; v++) {
        const uint32_t place = first[v], length = first[v + 1] - place;
        smooth_eight row;
        if (length == 0 || length > SMOOTH_EIGHT || !settle_inside(rows->sides->items + place, length, v, &row)) {
            rows->lengths[v] = NOT_SETTLED;
            all = false;
            continue;
        }
        /* What is written past a row is written over by the rows that follow in the block. */
        smooth_eight_copy(rows->items + place, &row, length, first[end] - place);
        rows->lengths[v] = length;
        rows->flags[v] = SMOOTH_USED;
    }
    return all;
}

static bool settle_inner(const row_settler *rows)
{
    const uint32_t count = rows->sides->count;
    bool all = true;
#pragma omp parallel for schedule(static) reduction(&& : all)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++) {
        const bool here = settle_block(rows, (uint32_t)smooth_block_begin(count, SMOOTH_BLOCKS, block),
                                       (uint32_t)smooth_block_begin(count, SMOOTH_BLOCKS, block + 1));
        all = all && here;
    }
    return all;
}

/* Where a row of `kept` neighbours lies: a vertex of a rim may have one more than it has corners. */
static uint32_t *settled_row(const row_settler *rows, uint32_t v, uint32_t kept)
{
    const uint32_t place = rows->sides->first[v], length = rows->sides->first[v + 1] - place;
    return kept <= length ? rows->items + place : rows->room + 2 * (size_t)place;
}

/* Finds the neighbours of a vertex; returns how many they are. */
static uint32_t settle_row(const row_settler *rows, uint32_t v)
{
    const smooth_sides *sides = rows->sides;
    uint32_t *row = rows->room + 2 * (size_t)sides->first[v], kept = 0;
    for (uint32_t i = sides->first[v]; i < sides->first[v + 1]; i++) {
        const uint32_t around[2] = {sides->items[i].next, sides->items[i].before};
        for (int k = 0; k < 2; k++)
            if (around[k] != v)
                row[kept++] = around[k];
    }
    kept = settle_rim(row, kept, rows->flags + v);
    uint32_t *to = settled_row(rows, v, kept);
    if (to != row)
        memcpy(to, row, kept * sizeof *row);
    return kept;
}

/* Settles the other rows; returns whether each row is as long as it has corners, which is so for closed surfaces. */
static bool settle_outer(const row_settler *rows)
{
    const uint32_t *first = rows->sides->first;
    bool even = true;
#pragma omp parallel for schedule(static) reduction(&& : even)
    for (uint32_t v = 0; v < rows->sides->count; v++) {
        if (rows->lengths[v] == NOT_SETTLED)
            rows->lengths[v] = settle_row(rows, v);
        even = even && rows->lengths[v] == first[v + 1] - first[v];
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

static hewn_result settle_rest(row_settler *rows, smooth_rows *out, hewn_error *error)
{
    rows->room = hewn_alloc(rows->sides->first[out->count], 2 * sizeof *rows->room);
    if (!rows->room)
        return out_of_memory(out->count, error);
    hewn_result result = HEWN_OK;
    if (!settle_outer(rows))
        result = take_rows(rows, out, error);
    hewn_free(rows->room);
    return result;
}

hewn_result hewn_smooth_neighbours(const smooth_sides *sides, smooth_rows *out, uint8_t *flags, hewn_error *error)
{
    *out = (smooth_rows){.count = sides->count, .first = hewn_alloc((size_t)sides->count + 1, sizeof *out->first)};
    row_settler rows = {
        .sides = sides,
        .lengths = out->first,
        .items = hewn_alloc(sides->first[sides->count], sizeof *rows.items),
        .flags = flags,
    };
    hewn_result result = out->first && rows.items ? HEWN_OK : out_of_memory(sides->count, error);
    if (result == HEWN_OK && !settle_inner(&rows))
        result = settle_rest(&rows, out, error);
    if (result == HEWN_OK && !out->items) { /* each row is as long as it has corners */
        memcpy(out->first, sides->first, ((size_t)sides->count + 1) * sizeof *out->first);
        out->items = rows.items;
        rows.items = NULL;
    }
    hewn_free(rows.items);
    if (result != HEWN_OK)
        hewn_smooth_rows_free(out);
    return result;
}
