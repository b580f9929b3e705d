#include <stdlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/check_parts.h"

/* Rows up to this length are looked at in the threads' fixed memory. */
enum { ROW_LIMIT = 256 };

/* --- cycles of corners -------------------------------------------------------------------------------------------- */

/* A face read from where, and in the direction in which, its corners come first in lexicographic order: equal for all
 * faces around the same cycle of corners. */
typedef struct face_cycle {
    const uint32_t *corners;
    uint64_t length, start;
    bool forward;
} face_cycle;

static uint32_t corner_at(const face_cycle *cycle, uint64_t i)
{
    uint64_t at = cycle->start + (cycle->forward ? i : cycle->length - i);
    return cycle->corners[at >= cycle->length ? at - cycle->length : at];
}

/* Turns a cycle to its lexicographically least start, by elimination between two candidates; linear time. */
static void turn_least(face_cycle *cycle)
{
    uint64_t length = cycle->length, i = 0, j = 1, same = 0;
    cycle->start = 0;
    while (i < length && j < length && same < length) {
        uint32_t a = corner_at(cycle, (i + same) % length), b = corner_at(cycle, (j + same) % length);
        if (a == b) {
            same++;
            continue;
        }
        if (a > b)
            i += same + 1;
        else
            j += same + 1;
        j += i == j;
        same = 0;
    }
    uint64_t least = i < j ? i : j;
    cycle->start = cycle->forward || least == 0 ? least : length - least;
}

static int compare_cycles(const face_cycle *a, const face_cycle *b)
{
    if (a->length != b->length)
        return a->length < b->length ? -1 : 1;
    for (uint64_t i = 0; i < a->length; i++) {
        uint32_t x = corner_at(a, i), y = corner_at(b, i);
        if (x != y)
            return x < y ? -1 : 1;
    }
    return 0;
}

static face_cycle read_cycle(const hewn_face_view *view, uint64_t face)
{
    uint64_t begin = hewn_face_begin(view, face);
    face_cycle there = {view->corners + begin, hewn_face_begin(view, face + 1) - begin, 0, true}, back = there;
    back.forward = false;
    turn_least(&there);
    turn_least(&back);
    return compare_cycles(&there, &back) <= 0 ? there : back;
}

static uint64_t hash_cycle(const face_cycle *cycle)
{
    uint64_t hash = cycle->length;
    for (uint64_t i = 0; i < cycle->length; i++) {
        hash = (hash ^ corner_at(cycle, i)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    return hash;
}

/* --- groups that may be alike ------------------------------------------------------------------------------------- */

/* `key` is equal for faces that are alike. */
typedef struct face_key {
    uint64_t key;
    uint32_t face;
} face_key;

static int compare_keys(const void *a, const void *b)
{
    const face_key *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->face < y->face ? -1 : x->face > y->face;
}

/* Faces of one key that are like an earlier one. Keys are hashes, so different faces may have one in common: the first
 * of each kind are gathered at the front. */
static uint64_t count_in_run(const hewn_face_view *view, face_key *run, size_t count)
{
    size_t kinds = 0;
    for (size_t i = 0; i < count; i++) {
        face_cycle cycle = read_cycle(view, run[i].face);
        bool known = false;
        for (size_t k = 0; k < kinds && !known; k++) {
            face_cycle other = read_cycle(view, run[k].face);
            known = compare_cycles(&cycle, &other) == 0;
        }
        if (!known)
            run[kinds++] = run[i];
    }
    return count - kinds;
}

static uint64_t count_in_group(const hewn_face_view *view, face_key *keys, size_t count)
{
    uint64_t found = 0;
    if (count > 1)
        qsort(keys, count, sizeof *keys, compare_keys);
    for (size_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && keys[end].key == keys[begin].key;)
            end++;
        found += end - begin > 1 ? count_in_run(view, keys + begin, end - begin) : 0;
    }
    return found;
}

/* --- all faces ---------------------------------------------------------------------------------------------------- */

/* The corner of a face with sides that names its lowest vertex. */
static uint32_t lowest_corner(const hewn_face_view *view, uint64_t face)
{
    uint64_t lowest = hewn_face_begin(view, face), end = hewn_face_begin(view, face + 1);
    for (uint64_t c = lowest + 1; c < end; c++)
        if (view->corners[c] < view->corners[lowest])
            lowest = c;
    return (uint32_t)lowest;
}

/* Faces are compared at their lowest vertex only. `lowest` (polygons) are their lowest corners. */
static uint64_t count_at_vertex(const hewn_face_view *view, const hewn_stars *stars, const uint32_t *lowest, uint32_t v,
                                face_key *keys)
{
    size_t count = 0;
    for (uint32_t i = stars->first[v]; i < stars->first[v + 1ull]; i++) {
        uint32_t c = stars->corners[i], face = hewn_corner_face(view, c);
        if (lowest) {
            if (lowest[face] == c) {
                face_cycle cycle = read_cycle(view, face);
                keys[count++] = (face_key){hash_cycle(&cycle), face};
            }
            continue;
        }
        uint64_t a = view->corners[hewn_corner_after(view, c)], b = view->corners[hewn_corner_before(view, c)];
        if (a > v && b > v)
            keys[count++] = (face_key){a < b ? a << 32 | b : b << 32 | a, face};
    }
    return count_in_group(view, keys, count);
}

static uint64_t count_at_short_rows(const hewn_face_view *view, const hewn_stars *stars, const uint32_t *lowest)
{
    uint64_t found = 0;
#pragma omp parallel reduction(+ : found) if (view->vertex_count >= HEWN_CHECK_ALONE)
    {
        face_key keys[ROW_LIMIT];
#pragma omp for schedule(dynamic, 4096)
        for (uint64_t v = 0; v < view->vertex_count; v++)
            if (hewn_star_length(stars, (uint32_t)v) <= ROW_LIMIT)
                found += count_at_vertex(view, stars, lowest, (uint32_t)v, keys);
    }
    return found;
}

static uint64_t count_collapsed(const hewn_face_view *view, face_key *keys)
{
    size_t count = 0;
    for (uint64_t f = 0; f < view->face_count; f++)
        if (hewn_face_collapsed(view, f)) {
            face_cycle cycle = read_cycle(view, f);
            keys[count++] = (face_key){hash_cycle(&cycle), (uint32_t)f};
        }
    return count_in_group(view, keys, count);
}

hewn_result hewn_count_duplicate_faces(const hewn_face_view *view, const hewn_stars *stars, uint64_t *count,
                                       hewn_error *error)
{
    uint64_t collapsed = hewn_count_collapsed_faces(view);
    uint64_t room = collapsed > stars->longest ? collapsed : stars->longest;
    uint32_t *lowest = NULL;
    face_key *keys = hewn_alloc(room, sizeof *keys);
    if (!keys || (view->first && !(lowest = hewn_alloc(view->face_count, sizeof *lowest)))) {
        hewn_free(keys);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory comparing %llu faces",
                         (unsigned long long)view->face_count);
    }
    for (uint64_t f = 0; lowest && f < view->face_count; f++)
        lowest[f] = hewn_face_collapsed(view, f) ? 0 : lowest_corner(view, f);
    *count = count_at_short_rows(view, stars, lowest) + count_collapsed(view, keys);
    for (uint64_t v = 0; v < view->vertex_count && stars->longest > ROW_LIMIT; v++)
        if (hewn_star_length(stars, (uint32_t)v) > ROW_LIMIT)
            *count += count_at_vertex(view, stars, lowest, (uint32_t)v, keys);
    hewn_free(lowest);
    hewn_free(keys);
    return HEWN_OK;
}
