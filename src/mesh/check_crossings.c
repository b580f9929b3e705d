#include <stdlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "geom/bvh.h"
#include "mesh/self_intersections.h"

/* Fewer triangles than ALONE are not worth another thread. A slice of faces is what is done between two looks at the
 * progress callback, a chunk what a thread takes at a time. */
enum { ALONE = 1 << 12, SLICE = 1 << 16, CHUNK = 64 };

static const char stage_name[] = "self-intersections";

/* A row is what begins with one face: the pairs in which it is the lower, and that with itself. */
typedef struct search {
    const hewn_triangle_view *mesh;
    const hewn_cut_faces *cut;
    hewn_bvh bvh;
    uint32_t *rows; /* how many pairs each row has; NULL where no pairs are asked for */
} search;

/* What a thread needs to find a row: which faces are in it already, as bits and as a list. */
typedef struct row_room {
    uint64_t *seen;
    uint32_t *partners;
    size_t count, capacity;
    hewn_result result;
    hewn_error error;
} row_room;

static void open_room(const search *find, row_room *room)
{
    *room = (row_room){.seen = hewn_alloc_zero(find->cut->count / 64 + 1, sizeof *room->seen)};
    if (!room->seen)
        room->result = hewn_fail(&room->error, HEWN_OUT_OF_MEMORY, "out of memory for marks of %llu faces",
                                 (unsigned long long)find->cut->count);
}

static void close_room(row_room *room)
{
    hewn_free(room->seen);
    hewn_free(room->partners);
}

static bool is_seen(const row_room *room, uint32_t face)
{
    return room->seen[face / 64] >> face % 64 & 1;
}

static void note_partner(row_room *room, uint32_t face)
{
    void *partners = room->partners;
    room->result = hewn_reserve(&partners, &room->capacity, room->count + 1, sizeof *room->partners, &room->error);
    room->partners = partners;
    if (room->result != HEWN_OK)
        return;
    room->partners[room->count++] = face;
    room->seen[face / 64] |= 1ull << face % 64;
}

/* Whether triangle `other` of face `partner` is to be compared with one of `face`. */
static bool is_wanted(const search *find, const row_room *room, uint32_t face, uint32_t triangle, uint32_t partner,
                      uint32_t other)
{
    if (partner < face || is_seen(room, partner))
        return false;
    return partner > face || (other > triangle && !find->cut->simple[face]);
}

static void find_partners(const search *find, uint32_t face, uint32_t triangle, row_room *room)
{
    hewn_facet facet, second;
    float lo[3], hi[3];
    hewn_view_facet(find->mesh, triangle, &facet);
    hewn_triangle_box(find->mesh, triangle, lo, hi);
    hewn_bvh_walk walk = hewn_bvh_walk_begin(&find->bvh, lo, hi, 0);
    uint64_t block;
    while (room->result == HEWN_OK && hewn_bvh_walk_next(&walk, &block)) {
        unsigned meets = hewn_boxes4_meet(&find->bvh.level[0][block], lo, hi);
        for (int i = 0; meets >> i != 0 && room->result == HEWN_OK; i++) {
            uint32_t other = find->bvh.order[4 * block + i], partner = find->cut->faces[other];
            if ((meets >> i & 1) == 0 || !is_wanted(find, room, face, triangle, partner, other))
                continue;
            hewn_view_facet(find->mesh, other, &second);
            if (hewn_facets_meet_improperly(&facet, &second))
                note_partner(room, partner);
        }
    }
}

/* Leaves the row in room->partners, in no order. */
static void find_row(const search *find, uint32_t face, row_room *room)
{
    for (size_t i = 0; i < room->count; i++)
        room->seen[room->partners[i] / 64] = 0;
    room->count = 0;
    for (uint32_t t = find->cut->begins[face]; t < find->cut->begins[face + 1ull] && room->result == HEWN_OK; t++)
        find_partners(find, face, t, room);
}

/* Adds the rows from `begin` to `end` - 1. */
static hewn_result count_rows(const search *find, uint64_t begin, uint64_t end, uint64_t *count, hewn_error *error)
{
    uint64_t found = 0;
    hewn_result result = HEWN_OK;
    hewn_error reason = {0};
#pragma omp parallel reduction(+ : found) if (find->mesh->triangle_count >= ALONE)
    {
        row_room room;
        open_room(find, &room);
#pragma omp for schedule(dynamic, CHUNK)
        for (uint64_t f = begin; f < end; f++) {
            if (room.result != HEWN_OK)
                continue;
            find_row(find, (uint32_t)f, &room);
            found += room.count;
            if (find->rows)
                find->rows[f] = (uint32_t)room.count;
        }
#pragma omp critical(hewn_crossings_result)
        if (room.result != HEWN_OK) {
            result = room.result;
            reason = room.error;
        }
        close_room(&room);
    }
    if (result != HEWN_OK)
        return hewn_fail(error, result, "%s", reason.message);
    *count += found;
    return HEWN_OK;
}

static int compare_faces(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

/* Finds the first rows again, whose lengths are known. */
static hewn_result write_pairs(const search *find, uint64_t max_pairs, uint32_t (*pairs)[2], hewn_error *error)
{
    row_room room;
    open_room(find, &room);
    uint64_t at = 0;
    for (uint64_t f = 0; f < find->cut->count && at < max_pairs && room.result == HEWN_OK; f++) {
        if (find->rows[f] == 0)
            continue;
        find_row(find, (uint32_t)f, &room);
        qsort(room.partners, room.count, sizeof *room.partners, compare_faces);
        for (size_t i = 0; i < room.count && at < max_pairs; i++, at++) {
            pairs[at][0] = (uint32_t)f;
            pairs[at][1] = room.partners[i];
        }
    }
    hewn_result result = room.result;
    if (result != HEWN_OK)
        hewn_fail(error, result, "%s", room.error.message);
    close_room(&room);
    return result;
}

static hewn_result run_search(search *find, uint64_t max_pairs, uint32_t (*pairs)[2], const hewn_progress *progress,
                              uint64_t *count, hewn_error *error)
{
    uint64_t faces = find->cut->count;
    if (max_pairs > 0 && !(find->rows = hewn_alloc_zero(faces, sizeof *find->rows)))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the counts of %llu faces",
                         (unsigned long long)faces);
    HEWN_TRY(hewn_bvh_build(find->mesh, &find->bvh, error));
    HEWN_TRY(hewn_progress_report(progress, stage_name, 0.2, error));
    for (uint64_t begin = 0; begin < faces; begin += SLICE) {
        uint64_t end = begin + SLICE < faces ? begin + SLICE : faces;
        HEWN_TRY(count_rows(find, begin, end, count, error));
        HEWN_TRY(hewn_progress_report(progress, stage_name, 0.2 + 0.7 * (double)end / (double)faces, error));
    }
    if (max_pairs > 0 && *count > 0)
        HEWN_TRY(write_pairs(find, max_pairs, pairs, error));
    return hewn_progress_report(progress, stage_name, 1, error);
}

hewn_result hewn_count_face_intersections(const hewn_triangle_view *mesh, const hewn_cut_faces *cut, uint64_t max_pairs,
                                          uint32_t (*pairs)[2], const hewn_progress *progress, uint64_t *count,
                                          hewn_error *error)
{
    *count = 0;
    if (mesh->triangle_count == 0)
        return hewn_progress_report(progress, stage_name, 1, error);
    search find = {.mesh = mesh, .cut = cut};
    uint64_t found = 0;
    hewn_result result = run_search(&find, max_pairs, pairs, progress, &found, error);
    hewn_free(find.rows);
    hewn_bvh_free(&find.bvh);
    *count = result == HEWN_OK ? found : 0;
    return result;
}
