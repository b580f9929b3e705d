#include "mesh/star.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* Rows up to RING_LIMIT try the cheap walk around the vertex; rows past ROW_LIMIT leave the threads' fixed memory. */
enum { RING_LIMIT = 16, ROW_LIMIT = 256, PART_LIMIT = 8 };

/* --- sorting triangles into rows --------------------------------------------------------------------------------- */

/* Each part of the vertices belongs to one thread, which reads all triangles: no atomics, and the order inside a row
 * does not depend on the number of threads. */
static void count_part(const hewn_triangles *mesh, uint32_t *count, uint32_t begin, uint32_t length)
{
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corner = mesh->indices + 3 * t;
        if (hewn_triangle_collapsed(corner))
            continue;
        for (int k = 0; k < 3; k++)
            if (corner[k] - begin < length)
                count[corner[k]]++;
    }
}

static void fill_part(const hewn_triangles *mesh, hewn_stars *stars, uint32_t begin, uint32_t length)
{
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corner = mesh->indices + 3 * t;
        if (hewn_triangle_collapsed(corner))
            continue;
        for (int k = 0; k < 3; k++)
            if (corner[k] - begin < length)
                stars->triangles[stars->first[corner[k]]++] = (uint32_t)t;
    }
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

hewn_result hewn_stars_build(const hewn_triangles *mesh, hewn_stars *out, hewn_error *error)
{
    uint64_t vertices = mesh->vertex_count;
    *out = (hewn_stars){.first = hewn_alloc_zero(vertices + 1, sizeof *out->first)};
    if (!out->first)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the stars of %llu vertices",
                         (unsigned long long)vertices);
    int threads = mesh->triangle_count < HEWN_CERTIFY_ALONE ? 1 : omp_get_max_threads();
    int parts = threads < PART_LIMIT ? threads : PART_LIMIT;
#pragma omp parallel for schedule(static, 1) num_threads(parts)
    for (int p = 0; p < parts; p++) {
        uint32_t begin = (uint32_t)(vertices * (uint64_t)p / (uint64_t)parts);
        uint32_t end = (uint32_t)(vertices * (uint64_t)(p + 1) / (uint64_t)parts);
        count_part(mesh, out->first, begin, end - begin);
    }
    uint32_t total = accumulate(out->first, vertices, &out->longest);
    out->triangles = hewn_alloc(total, sizeof *out->triangles);
    if (!out->triangles) {
        hewn_stars_free(out);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the stars of %llu triangles",
                         (unsigned long long)mesh->triangle_count);
    }
#pragma omp parallel for schedule(static, 1) num_threads(parts)
    for (int p = 0; p < parts; p++) {
        uint32_t begin = (uint32_t)(vertices * (uint64_t)p / (uint64_t)parts);
        uint32_t end = (uint32_t)(vertices * (uint64_t)(p + 1) / (uint64_t)parts);
        fill_part(mesh, out, begin, end - begin);
    }
    /* Filling moved each start to its row's end, which is the next row's start. */
    memmove(out->first + 1, out->first, vertices * sizeof *out->first);
    out->first[0] = 0;
    return HEWN_OK;
}

void hewn_stars_free(hewn_stars *stars)
{
    hewn_free(stars->first);
    hewn_free(stars->triangles);
    *stars = (hewn_stars){0};
}

/* --- reading one star --------------------------------------------------------------------------------------------- */

/* A triangle (v, tail, head) seen from v: an arc of v's link, from `tail` to `head`. It uses the edge v-tail outward
 * and the edge v-head inward. */
typedef struct link_arc {
    uint32_t tail, head;
} link_arc;

/* Room for one star of any shape. */
typedef struct star_room {
    link_arc *arcs;
    uint64_t *ends;   /* two an arc: neighbour << 32 | arc << 1 | is it the head */
    uint32_t *parent; /* of a union-find over arcs */
} star_room;

static void gather(const hewn_triangles *mesh, const uint32_t *row, uint32_t length, uint32_t v, link_arc *arcs)
{
    for (uint32_t i = 0; i < length; i++) {
        const uint32_t *corner = mesh->indices + 3 * (uint64_t)row[i];
        if (corner[0] == v)
            arcs[i] = (link_arc){corner[1], corner[2]};
        else if (corner[1] == v)
            arcs[i] = (link_arc){corner[2], corner[0]};
        else
            arcs[i] = (link_arc){corner[0], corner[1]};
    }
}

/* Whether the arcs form one directed ring that meets each neighbour once: the usual case, and nothing is wrong there.
 * Counts the edges whose lesser end is v. */
static bool is_ring(const link_arc *arcs, uint32_t length, uint32_t v, uint64_t *edges)
{
    uint32_t greater = 0, at = 0;
    for (uint32_t step = 0; step < length; step++) {
        uint32_t next = 0, matches = 0;
        for (uint32_t i = 0; i < length; i++) {
            bool match = arcs[i].tail == arcs[at].head;
            matches += match;
            next = match ? i : next;
        }
        if (matches != 1 || (next == 0) != (step + 1 == length))
            return false;
        greater += arcs[at].head > v;
        at = next;
    }
    *edges += greater;
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

static uint32_t find_arc(uint32_t *parent, uint32_t arc)
{
    while (parent[arc] != arc) {
        parent[arc] = parent[parent[arc]];
        arc = parent[arc];
    }
    return arc;
}

/* Any star: ends sorted by neighbour give the uses of each edge, a union-find over arcs the number of fans. */
static void read_star(const star_room *room, uint32_t length, uint32_t v, hewn_star_counts *counts)
{
    for (uint32_t i = 0; i < length; i++) {
        room->ends[2 * (size_t)i] = (uint64_t)room->arcs[i].tail << 32 | (uint64_t)i << 1;
        room->ends[2 * (size_t)i + 1] = (uint64_t)room->arcs[i].head << 32 | (uint64_t)i << 1 | 1;
        room->parent[i] = i;
    }
    size_t end_count = 2 * (size_t)length;
    sort_ends(room->ends, end_count);
    uint32_t fans = length;
    bool crowded = false;
    for (size_t begin = 0, end; begin < end_count; begin = end) {
        uint32_t neighbour = (uint32_t)(room->ends[begin] >> 32);
        uint32_t first = find_arc(room->parent, (uint32_t)room->ends[begin] >> 1);
        uint64_t inward = 0;
        for (end = begin; end < end_count && room->ends[end] >> 32 == neighbour; end++) {
            inward += room->ends[end] & 1;
            uint32_t other = find_arc(room->parent, (uint32_t)room->ends[end] >> 1);
            fans -= other != first;
            room->parent[other] = first;
        }
        uint64_t uses = end - begin;
        crowded = crowded || uses > 2;
        if (neighbour > v) {
            counts->edges++;
            counts->boundary_edges += uses == 1;
            counts->non_manifold_edges += uses > 2;
            counts->unoriented_edges += uses > 1 && 2 * inward != uses;
        }
    }
    counts->non_manifold_vertices += crowded || fans > 1;
}

static bool make_room(star_room *room, uint32_t length)
{
    room->arcs = hewn_alloc(length, sizeof *room->arcs);
    room->ends = hewn_alloc(2 * (size_t)length, sizeof *room->ends);
    room->parent = hewn_alloc(length, sizeof *room->parent);
    return room->arcs && room->ends && room->parent;
}

static void free_room(star_room *room)
{
    hewn_free(room->arcs);
    hewn_free(room->ends);
    hewn_free(room->parent);
}

static void examine_vertex(const hewn_triangles *mesh, const hewn_stars *stars, uint32_t v, const star_room *room,
                           hewn_star_counts *counts)
{
    uint32_t length = stars->first[v + 1ull] - stars->first[v];
    counts->used_vertices++;
    gather(mesh, stars->triangles + stars->first[v], length, v, room->arcs);
    if (length > RING_LIMIT || !is_ring(room->arcs, length, v, &counts->edges))
        read_star(room, length, v, counts);
}

/* --- all stars ---------------------------------------------------------------------------------------------------- */

static void add_counts(hewn_star_counts *sum, const hewn_star_counts *part)
{
    sum->used_vertices += part->used_vertices;
    sum->edges += part->edges;
    sum->boundary_edges += part->boundary_edges;
    sum->non_manifold_edges += part->non_manifold_edges;
    sum->unoriented_edges += part->unoriented_edges;
    sum->non_manifold_vertices += part->non_manifold_vertices;
}

static void examine_short_rows(const hewn_triangles *mesh, const hewn_stars *stars, uint64_t begin, uint64_t end,
                               hewn_star_counts *counts)
{
#pragma omp parallel if (end - begin >= HEWN_CERTIFY_ALONE)
    {
        link_arc arcs[ROW_LIMIT];
        uint64_t ends[2 * ROW_LIMIT];
        uint32_t parent[ROW_LIMIT];
        star_room room = {arcs, ends, parent};
        hewn_star_counts part = {0};
#pragma omp for schedule(dynamic, 4096)
        for (uint64_t v = begin; v < end; v++) {
            uint32_t length = stars->first[v + 1] - stars->first[v];
            if (length > 0 && length <= ROW_LIMIT)
                examine_vertex(mesh, stars, (uint32_t)v, &room, &part);
        }
#pragma omp critical(hewn_star_sum)
        add_counts(counts, &part);
    }
}

hewn_result hewn_stars_examine(const hewn_triangles *mesh, const hewn_stars *stars, uint64_t begin, uint64_t end,
                               hewn_star_counts *counts, hewn_error *error)
{
    examine_short_rows(mesh, stars, begin, end, counts);
    if (stars->longest <= ROW_LIMIT)
        return HEWN_OK;
    star_room room;
    hewn_result result = HEWN_OK;
    if (!make_room(&room, stars->longest))
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a vertex with %u triangles", stars->longest);
    for (uint64_t v = begin; v < end && result == HEWN_OK; v++)
        if (stars->first[v + 1] - stars->first[v] > ROW_LIMIT)
            examine_vertex(mesh, stars, (uint32_t)v, &room, counts);
    free_room(&room);
    return result;
}
