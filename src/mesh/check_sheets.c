#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/check_parts.h"

/* Half-edges go by the corner that they leave. `loop` is a union-find over those along the boundary (HEWN_NONE
 * elsewhere), `parent` one over faces; `turned` says whether a face must be turned over to agree with its parent.
 * Either is NULL where it is not asked for. */
typedef struct sheet_search {
    const hewn_face_view *view;
    const hewn_stars *stars;
    hewn_star_room room;
    uint32_t
        *fan_sides; /* of each fan of the star at hand a half-edge along its boundary, HEWN_NONE before one is met */
    uint32_t *loop;
    uint32_t *parent;
    uint8_t *turned;
} sheet_search;

/* --- loops -------------------------------------------------------------------------------------------------------- */

static uint32_t find_loop(uint32_t *loop, uint32_t side)
{
    while (loop[side] != side) {
        loop[side] = loop[loop[side]];
        side = loop[side];
    }
    return side;
}

/* A half-edge of the boundary that begins or ends at v: the boundary goes on in the half-edge at the other end of its
 * fan. */
static void link_side(sheet_search *search, uint32_t fan, uint32_t side)
{
    if (search->loop[side] == HEWN_NONE)
        search->loop[side] = side;
    if (search->fan_sides[fan] == HEWN_NONE)
        search->fan_sides[fan] = side;
    else
        search->loop[find_loop(search->loop, side)] = find_loop(search->loop, search->fan_sides[fan]);
}

static void link_boundary(sheet_search *search, uint32_t v)
{
    uint32_t length = hewn_star_length(search->stars, v);
    const uint32_t *row = search->stars->corners + search->stars->first[v];
    const uint64_t *ends = search->room.ends;
    memset(search->fan_sides, 0xFF, length * sizeof *search->fan_sides);
    for (size_t i = 0, count = 2 * (size_t)length; i < count; i++) {
        bool alone =
            (i == 0 || ends[i - 1] >> 32 != ends[i] >> 32) && (i + 1 == count || ends[i + 1] >> 32 != ends[i] >> 32);
        uint32_t arc = (uint32_t)ends[i] >> 1;
        if (alone)
            link_side(search, hewn_star_fan(&search->room, arc),
                      ends[i] & 1 ? hewn_corner_before(search->view, row[arc]) : row[arc]);
    }
}

/* --- sides of faces ----------------------------------------------------------------------------------------------- */

/* The root of a face; `*turned` becomes whether the face must be turned to agree with it. */
static uint32_t find_face(sheet_search *search, uint32_t face, uint8_t *turned)
{
    uint32_t *parent = search->parent;
    *turned = 0;
    while (parent[face] != face) {
        uint32_t up = parent[face];
        search->turned[face] ^= search->turned[up];
        parent[face] = parent[up];
        *turned ^= search->turned[face];
        face = parent[face];
    }
    return face;
}

/* False where the faces are known to be to each other as they are not. */
static bool join_faces(sheet_search *search, uint32_t a, uint32_t b, uint8_t bent)
{
    uint8_t turn_a, turn_b;
    a = find_face(search, a, &turn_a);
    b = find_face(search, b, &turn_b);
    uint8_t turn = turn_a ^ turn_b ^ bent;
    if (a == b)
        return turn == 0;
    search->parent[b] = a;
    search->turned[b] = turn;
    return true;
}

/* The edges of two faces whose lesser end is v. False where a sheet meets itself the wrong way round. */
static bool join_across(sheet_search *search, uint32_t v)
{
    uint32_t length = hewn_star_length(search->stars, v);
    const uint32_t *row = search->stars->corners + search->stars->first[v];
    const uint64_t *ends = search->room.ends;
    bool agree = true;
    for (size_t begin = 0, end, count = 2 * (size_t)length; begin < count; begin = end) {
        for (end = begin + 1; end < count && ends[end] >> 32 == ends[begin] >> 32;)
            end++;
        if (end - begin != 2 || ends[begin] >> 32 < v)
            continue;
        uint32_t a = row[(uint32_t)ends[begin] >> 1], b = row[(uint32_t)ends[begin + 1] >> 1];
        uint8_t bent = (ends[begin] & 1) == (ends[begin + 1] & 1);
        agree = join_faces(search, hewn_corner_face(search->view, a), hewn_corner_face(search->view, b), bent) && agree;
    }
    return agree;
}

static bool join_ring(sheet_search *search, uint32_t v)
{
    const uint32_t *row = search->stars->corners + search->stars->first[v];
    bool agree = true;
    for (uint32_t i = 1; i < hewn_star_length(search->stars, v); i++)
        agree = join_faces(search, hewn_corner_face(search->view, row[0]), hewn_corner_face(search->view, row[i]), 0) &&
                agree;
    return agree;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static void search_stars(sheet_search *search, const uint32_t *slots, hewn_sheet_counts *sheets)
{
    const hewn_face_view *view = search->view;
    for (uint64_t at = 0; at < view->vertex_count; at++) {
        uint32_t v = (uint32_t)at;
        if (hewn_star_length(search->stars, v) == 0)
            continue;
        bool ring = hewn_star_read(view, search->stars, v, &search->room);
        if (search->loop && !ring)
            link_boundary(search, v);
        if (search->parent && !(ring ? join_ring(search, v) : join_across(search, v)))
            sheets[slots[v]].one_sided = true;
    }
    for (uint64_t side = 0; search->loop && side < view->corner_count; side++)
        sheets[slots[view->corners[side]]].boundary_loops += search->loop[side] == side;
}

static hewn_result make_room(sheet_search *search, const hewn_star_counts *total, hewn_error *error)
{
    const hewn_face_view *view = search->view;
    bool made = (search->fan_sides = hewn_alloc(search->stars->longest, sizeof *search->fan_sides)) != NULL;
    if (total->boundary_edges > 0) {
        made = made && (search->loop = hewn_alloc(view->corner_count, sizeof *search->loop));
        if (made)
            memset(search->loop, 0xFF, view->corner_count * sizeof *search->loop);
    }
    if (total->bent_edges > 0) {
        made = made && (search->parent = hewn_alloc(view->face_count, sizeof *search->parent));
        made = made && (search->turned = hewn_alloc_zero(view->face_count, sizeof *search->turned));
        for (uint64_t f = 0; made && f < view->face_count; f++)
            search->parent[f] = (uint32_t)f;
    }
    if (!made)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the boundary of %llu faces",
                         (unsigned long long)view->face_count);
    return hewn_star_room_create(search->stars->longest, &search->room, error);
}

hewn_result hewn_sheets_find(const hewn_face_view *view, const hewn_stars *stars, const uint32_t *slots,
                             const hewn_star_counts *total, hewn_sheet_counts *sheets, hewn_error *error)
{
    if (total->boundary_edges == 0 && total->bent_edges == 0)
        return HEWN_OK;
    sheet_search search = {.view = view, .stars = stars};
    hewn_result result = make_room(&search, total, error);
    if (result == HEWN_OK)
        search_stars(&search, slots, sheets);
    hewn_star_room_free(&search.room);
    hewn_free(search.fan_sides);
    hewn_free(search.loop);
    hewn_free(search.parent);
    hewn_free(search.turned);
    return result;
}
