#include "mesh/star.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* Rows up to RING_LIMIT try the cheap walk around the vertex; rows past ROW_LIMIT leave the threads' fixed memory. */
enum { RING_LIMIT = 16, ROW_LIMIT = HEWN_STAR_SHORT, PART_LIMIT = 8 };

/* --- sorting corners into rows ------------------------------------------------------------------------------------ */

/* The vertices begin to begin + length - 1. */
typedef struct vertex_range {
    uint32_t begin, length;
} vertex_range;

static bool is_in(const vertex_range *range, uint32_t vertex)
{
    return vertex - range->begin < range->length;
}

/* Each part of the vertices belongs to one thread, which reads all faces: no atomics, and the order inside a row does
 * not depend on the number of threads. Triangles go a way of their own, which is a third faster. */
static void count_part(const hewn_face_view *view, uint32_t *count, vertex_range mine)
{
    if (!view->first) {
        for (uint64_t t = 0; t < view->face_count; t++) {
            const uint32_t *corner = view->corners + 3 * t;
            if (hewn_triangle_collapsed(corner))
                continue;
            for (int k = 0; k < 3; k++)
                if (is_in(&mine, corner[k]))
                    count[corner[k]]++;
        }
        return;
    }
    for (uint64_t c = 0; c < view->corner_count; c++)
        if (is_in(&mine, view->corners[c]) && !view->collapsed[view->faces[c]])
            count[view->corners[c]]++;
}

static void fill_part(const hewn_face_view *view, hewn_stars *stars, vertex_range mine)
{
    if (!view->first) {
        for (uint64_t t = 0; t < view->face_count; t++) {
            const uint32_t *corner = view->corners + 3 * t;
            if (hewn_triangle_collapsed(corner))
                continue;
            for (int k = 0; k < 3; k++)
                if (is_in(&mine, corner[k]))
                    stars->corners[stars->first[corner[k]]++] = (uint32_t)(3 * t) + (uint32_t)k;
        }
        return;
    }
    for (uint64_t c = 0; c < view->corner_count; c++)
        if (is_in(&mine, view->corners[c]) && !view->collapsed[view->faces[c]])
            stars->corners[stars->first[view->corners[c]]++] = (uint32_t)c;
}

static vertex_range nth_part(uint64_t vertices, int p, int parts)
{
    uint64_t begin = vertices * (uint64_t)p / (uint64_t)parts, end = vertices * (uint64_t)(p + 1) / (uint64_t)parts;
    return (vertex_range){(uint32_t)begin, (uint32_t)(end - begin)};
}

/* Counts to the start of each row. */
static uint32_t accumulate(uint32_t *first, uint64_t count, uint32_t *longest)
{
    uint32_t sum = 0;
    *longest = 0;
    for (uint64_t v = 0; v < count; v++) {
        uint32_t length = first[v];
        *longest = length > *longest ? length : *longest;
        first[v] = sum;
        sum += length;
    }
    return sum;
}

hewn_result hewn_stars_build(const hewn_face_view *view, hewn_stars *out, hewn_error *error)
{
    uint64_t vertices = view->vertex_count;
    *out = (hewn_stars){.first = hewn_alloc_zero(vertices + 1, sizeof *out->first)};
    if (!out->first)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the stars of %llu vertices",
                         (unsigned long long)vertices);
    int threads = view->face_count < HEWN_CHECK_ALONE ? 1 : omp_get_max_threads();
    int parts = threads < PART_LIMIT ? threads : PART_LIMIT;
#pragma omp parallel for schedule(static, 1) num_threads(parts)
    for (int p = 0; p < parts; p++)
        count_part(view, out->first, nth_part(vertices, p, parts));
    uint32_t total = accumulate(out->first, vertices, &out->longest);
    out->corners = hewn_alloc(total, sizeof *out->corners);
    if (!out->corners) {
        hewn_stars_free(out);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the stars of %llu faces",
                         (unsigned long long)view->face_count);
    }
#pragma omp parallel for schedule(static, 1) num_threads(parts)
    for (int p = 0; p < parts; p++)
        fill_part(view, out, nth_part(vertices, p, parts));
    /* Filling moved each start to its row's end, which is the next row's start. */
    memmove(out->first + 1, out->first, vertices * sizeof *out->first);
    out->first[0] = 0;
    return HEWN_OK;
}

void hewn_stars_free(hewn_stars *stars)
{
    hewn_free(stars->first);
    hewn_free(stars->corners);
    *stars = (hewn_stars){0};
}

/* --- reading one star --------------------------------------------------------------------------------------------- */

static void gather(const hewn_face_view *view, const uint32_t *row, uint32_t length, hewn_link_arc *arcs)
{
    static const uint8_t after[3] = {1, 2, 0}, before[3] = {2, 0, 1};
    for (uint32_t i = 0; i < length && !view->first; i++) {
        uint32_t k = row[i] % 3;
        const uint32_t *corner = view->corners + (row[i] - k);
        arcs[i] = (hewn_link_arc){corner[after[k]], corner[before[k]]};
    }
    for (uint32_t i = 0; i < length && view->first; i++)
        arcs[i] = (hewn_link_arc){view->corners[hewn_corner_after(view, row[i])],
                                  view->corners[hewn_corner_before(view, row[i])]};
}

/* Whether the arcs form one directed ring that meets each neighbour once: the usual case. */
static bool is_ring(const hewn_link_arc *arcs, uint32_t length)
{
    uint32_t at = 0;
    for (uint32_t step = 0; step < length; step++) {
        uint32_t next = 0, matches = 0;
        for (uint32_t i = 0; i < length; i++) {
            bool match = arcs[i].tail == arcs[at].head;
            matches += match;
            next = match ? i : next;
        }
        if (matches != 1 || (next == 0) != (step + 1 == length))
            return false;
        at = next;
    }
    return true;
}

static int compare_ends(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

static void sort_ends(uint64_t *ends, size_t count)
{
    if (count > 64) {
        qsort(ends, count, sizeof *ends, compare_ends);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        uint64_t end = ends[i];
        size_t j = i;
        for (; j > 0 && ends[j - 1] > end; j--)
            ends[j] = ends[j - 1];
        ends[j] = end;
    }
}

uint32_t hewn_star_fan(const hewn_star_room *room, uint32_t arc)
{
    uint32_t *parent = room->parent;
    while (parent[arc] != arc) {
        parent[arc] = parent[parent[arc]];
        arc = parent[arc];
    }
    return arc;
}

/* Ends sorted by neighbour show the uses of each edge; arcs that meet at a neighbour are of one fan. */
static void find_fans(const hewn_star_room *room, uint32_t length)
{
    for (uint32_t i = 0; i < length; i++) {
        room->ends[2 * (size_t)i] = (uint64_t)room->arcs[i].tail << 32 | (uint64_t)i << 1;
        room->ends[2 * (size_t)i + 1] = (uint64_t)room->arcs[i].head << 32 | (uint64_t)i << 1 | 1;
        room->parent[i] = i;
    }
    sort_ends(room->ends, 2 * (size_t)length);
    for (size_t i = 1; i < 2 * (size_t)length; i++)
        if (room->ends[i] >> 32 == room->ends[i - 1] >> 32) {
            uint32_t fan = hewn_star_fan(room, (uint32_t)room->ends[i] >> 1);
            room->parent[fan] = hewn_star_fan(room, (uint32_t)room->ends[i - 1] >> 1);
        }
}

static bool read_row(const hewn_face_view *view, const uint32_t *row, uint32_t length, const hewn_star_room *room)
{
    gather(view, row, length, room->arcs);
    if (length <= RING_LIMIT && is_ring(room->arcs, length))
        return true;
    find_fans(room, length);
    return false;
}

bool hewn_star_read(const hewn_face_view *view, const hewn_stars *stars, uint32_t v, const hewn_star_room *room)
{
    return read_row(view, stars->corners + stars->first[v], hewn_star_length(stars, v), room);
}

/* A star that is no ring: what its edges and fans add to the counts. */
static void count_star(const hewn_star_room *room, uint32_t length, uint32_t v, hewn_star_counts *counts)
{
    uint32_t fans = 0;
    bool crowded = false;
    for (uint32_t i = 0; i < length; i++)
        fans += room->parent[i] == i;
    size_t end_count = 2 * (size_t)length;
    for (size_t begin = 0, end; begin < end_count; begin = end) {
        uint32_t neighbour = (uint32_t)(room->ends[begin] >> 32);
        uint64_t inward = 0;
        for (end = begin; end < end_count && room->ends[end] >> 32 == neighbour; end++)
            inward += room->ends[end] & 1;
        uint64_t uses = end - begin;
        crowded = crowded || uses > 2;
        if (neighbour > v) {
            counts->edges++;
            counts->boundary_edges += uses == 1;
            counts->non_manifold_edges += uses > 2;
            counts->unoriented_edges += uses > 1 && 2 * inward != uses;
            counts->bent_edges += uses == 2 && inward != 1;
        }
    }
    counts->non_manifold_vertices += crowded || fans > 1;
}

hewn_result hewn_star_room_create(uint32_t length, hewn_star_room *out, hewn_error *error)
{
    out->arcs = hewn_alloc(length, sizeof *out->arcs);
    out->ends = hewn_alloc(2 * (size_t)length, sizeof *out->ends);
    out->parent = hewn_alloc(length, sizeof *out->parent);
    if (!out->arcs || !out->ends || !out->parent)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a vertex with %u faces", length);
    return HEWN_OK;
}

void hewn_star_room_free(hewn_star_room *room)
{
    hewn_free(room->arcs);
    hewn_free(room->ends);
    hewn_free(room->parent);
}

void hewn_star_examine(const hewn_face_view *view, const uint32_t *row, uint32_t length, uint32_t v,
                       const hewn_star_room *room, hewn_star_counts *counts)
{
    counts->used_vertices++;
    if (!read_row(view, row, length, room)) {
        count_star(room, length, v, counts);
        return;
    }
    for (uint32_t i = 0; i < length; i++)
        counts->edges += room->arcs[i].head > v;
}

static void examine_vertex(const hewn_face_view *view, const hewn_stars *stars, uint32_t v, const hewn_star_room *room,
                           hewn_star_counts *counts)
{
    hewn_star_examine(view, stars->corners + stars->first[v], hewn_star_length(stars, v), v, room, counts);
}

/* --- all stars ---------------------------------------------------------------------------------------------------- */

void hewn_star_counts_add(hewn_star_counts *sum, const hewn_star_counts *part)
{
    sum->used_vertices += part->used_vertices;
    sum->edges += part->edges;
    sum->boundary_edges += part->boundary_edges;
    sum->non_manifold_edges += part->non_manifold_edges;
    sum->unoriented_edges += part->unoriented_edges;
    sum->bent_edges += part->bent_edges;
    sum->non_manifold_vertices += part->non_manifold_vertices;
}

/* Rows that fit into the threads' fixed memory. Sums are kept for a run of vertices of one slot. */
static void examine_short_rows(const hewn_face_view *view, const hewn_stars *stars, uint64_t begin, uint64_t end,
                               const uint32_t *slots, hewn_star_counts *counts)
{
#pragma omp parallel if (end - begin >= HEWN_CHECK_ALONE)
    {
        hewn_link_arc arcs[ROW_LIMIT];
        uint64_t ends[2 * ROW_LIMIT];
        uint32_t parent[ROW_LIMIT], slot = 0;
        hewn_star_room room = {arcs, ends, parent};
        hewn_star_counts part = {0};
#pragma omp for schedule(dynamic, 4096)
        for (uint64_t v = begin; v < end; v++) {
            uint32_t length = hewn_star_length(stars, (uint32_t)v);
            if (length == 0 || length > ROW_LIMIT)
                continue;
            if (slots && slots[v] != slot) {
#pragma omp critical(hewn_star_sum)
                hewn_star_counts_add(&counts[slot], &part);
                part = (hewn_star_counts){0};
                slot = slots[v];
            }
            examine_vertex(view, stars, (uint32_t)v, &room, &part);
        }
#pragma omp critical(hewn_star_sum)
        hewn_star_counts_add(&counts[slot], &part);
    }
}

hewn_result hewn_stars_examine(const hewn_face_view *view, const hewn_stars *stars, uint64_t begin, uint64_t end,
                               const uint32_t *slots, hewn_star_counts *counts, hewn_error *error)
{
    examine_short_rows(view, stars, begin, end, slots, counts);
    if (stars->longest <= ROW_LIMIT)
        return HEWN_OK;
    hewn_star_room room;
    hewn_result result = hewn_star_room_create(stars->longest, &room, error);
    for (uint64_t v = begin; v < end && result == HEWN_OK; v++)
        if (hewn_star_length(stars, (uint32_t)v) > ROW_LIMIT)
            examine_vertex(view, stars, (uint32_t)v, &room, &counts[slots ? slots[v] : 0]);
    hewn_star_room_free(&room);
    return result;
}
