#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/soup.h"

/* How often colliding pairs are cut before whole vertices are taken apart, and then all that are in question. */
enum { GENTLE_ROUNDS = 8, ROUNDS = 16 };

typedef struct stitcher {
    hewn_soup *soup;
    hewn_sides sides;
    uint32_t *mates;
    uint32_t *fans;    /* of each corner: the number its vertex will have */
    uint32_t *special; /* groups that are not simply one edge of one or two agreeing faces */
    uint32_t special_count;
    uint32_t vertex_count; /* with the copies */
    uint32_t longest;      /* group */
    hewn_pair_item *items; /* room for the longest group, as the next two */
    uint32_t *stack;
    struct sub_side *subs;
    uint8_t *apart; /* vertices to be taken apart */
} stitcher;

/* A half-edge of a special group by what its ends will be. */
typedef struct sub_side {
    uint32_t low, high, side;
} sub_side;

static uint32_t side_before(const stitcher *s, uint32_t side)
{
    uint32_t face = s->sides.faces[side];
    return side > s->soup->first[face] ? side - 1 : (uint32_t)s->soup->first[face + 1] - 1;
}

static uint32_t side_after(const stitcher *s, uint32_t side)
{
    return hewn_soup_next(s->soup, s->sides.faces[side], side);
}

static hewn_result refuse(const stitcher *s, uint32_t group, hewn_error *error)
{
    uint32_t begin = s->sides.group[group], count = s->sides.group[group + 1] - begin, side = s->sides.sides[begin];
    const uint32_t *names = s->soup->vertex_origins;
    uint32_t face = s->soup->face_origins[s->sides.faces[side]];
    uint32_t a = names[hewn_side_tail(s->soup, side)], b = names[hewn_side_head(s->soup, &s->sides, side)];
    if (count == 2)
        return hewn_fail(error, HEWN_BAD_INPUT, "faces %u and %u disagree in direction at the edge %u, %u", face,
                         s->soup->face_origins[s->sides.faces[s->sides.sides[begin + 1]]], a, b);
    return hewn_fail(error, HEWN_BAD_INPUT, "the edge %u, %u has %u faces (the first is %u)", a, b, count, face);
}

/* --- mates -------------------------------------------------------------------------------------------------------- */

/* Mates where there is no choice; the other groups become special. */
static hewn_result mate_plain(stitcher *s, bool strict, hewn_repair_report *report, hewn_error *error)
{
    for (uint32_t g = 0; g < s->sides.count; g++) {
        uint32_t begin = s->sides.group[g], count = s->sides.group[g + 1] - begin;
        uint32_t a = s->sides.sides[begin], b = s->sides.sides[begin + (count > 1)];
        s->mates[a] = HEWN_NONE;
        if (count == 1)
            continue;
        if (count == 2 && hewn_side_tail(s->soup, a) != hewn_side_tail(s->soup, b)) {
            s->mates[a] = b;
            s->mates[b] = a;
            continue;
        }
        if (strict)
            return refuse(s, g, error);
        s->mates[b] = HEWN_NONE;
        s->special[s->special_count++] = g;
        s->longest = count > s->longest ? count : s->longest;
        if (count == 2)
            report->one_sided_cuts++;
        else
            report->non_manifold_edges++;
    }
    return HEWN_OK;
}

static void pair_special(stitcher *s)
{
    for (uint32_t i = 0; i < s->special_count; i++) {
        uint32_t g = s->special[i];
        if (s->sides.group[g + 1] - s->sides.group[g] > 2)
            hewn_soup_pair(s->soup, &s->sides, g, s->items, s->stack, s->mates);
    }
}

static void part(stitcher *s, uint32_t side)
{
    uint32_t mate = s->mates[side];
    if (mate != HEWN_NONE)
        s->mates[mate] = HEWN_NONE;
    s->mates[side] = HEWN_NONE;
}

/* --- fans --------------------------------------------------------------------------------------------------------- */

/* Gives one number to all corners around a vertex that mates link to `corner`, in both directions. */
static void walk_fan(stitcher *s, uint32_t corner, uint32_t fan)
{
    uint32_t at = corner;
    do {
        s->fans[at] = fan;
        uint32_t mate = s->mates[at];
        at = mate == HEWN_NONE ? HEWN_NONE : side_after(s, mate);
    } while (at != HEWN_NONE && at != corner);
    at = s->mates[side_before(s, corner)];
    while (at != HEWN_NONE && s->fans[at] != fan) {
        s->fans[at] = fan;
        at = s->mates[side_before(s, at)];
    }
}

/* The first fan of a vertex keeps its number. `used` holds a byte for each vertex. */
static hewn_result find_fans(stitcher *s, uint8_t *used, hewn_error *error)
{
    uint32_t corners = hewn_soup_corner_count(s->soup);
    uint64_t count = s->soup->vertex_count;
    memset(used, 0, s->soup->vertex_count);
    memset(s->fans, 0xFF, (size_t)corners * sizeof *s->fans);
    for (uint32_t c = 0; c < corners; c++) {
        if (s->fans[c] != HEWN_NONE)
            continue;
        uint32_t vertex = s->soup->corners[c];
        if (used[vertex] && count >= HEWN_NONE - 1)
            return hewn_fail(error, HEWN_LIMIT, "splitting makes more vertices than a mesh can hold");
        walk_fan(s, c, used[vertex] ? (uint32_t)count++ : vertex);
        used[vertex] = 1;
    }
    s->vertex_count = (uint32_t)count;
    return HEWN_OK;
}

/* --- edges that would still have too many faces --------------------------------------------------------------------
 */

static int compare_subs(const void *a, const void *b)
{
    const sub_side *x = a, *y = b;
    if (x->low != y->low)
        return x->low < y->low ? -1 : 1;
    if (x->high != y->high)
        return x->high < y->high ? -1 : 1;
    return (x->side > y->side) - (x->side < y->side);
}

/* The group's half-edges sorted by their ends to be; returns their number. */
static uint32_t sort_subs(stitcher *s, uint32_t group)
{
    uint32_t begin = s->sides.group[group], count = s->sides.group[group + 1] - begin;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t side = s->sides.sides[begin + i], a = s->fans[side], b = s->fans[side_after(s, side)];
        s->subs[i] = (sub_side){a < b ? a : b, a < b ? b : a, side};
    }
    qsort(s->subs, count, sizeof *s->subs, compare_subs);
    return count;
}

static uint32_t sub_end(const stitcher *s, uint32_t begin, uint32_t count)
{
    uint32_t end = begin + 1;
    while (end < count && s->subs[end].low == s->subs[begin].low && s->subs[end].high == s->subs[begin].high)
        end++;
    return end;
}

/* Two half-edges with the same ends must be mates; where there are more of them, all are cut, so that the fans at the
 * ends fall apart into smaller ones. Returns whether anything was cut. */
static bool cut_collisions(stitcher *s, uint32_t group, bool harsh)
{
    bool cut = false;
    uint32_t count = sort_subs(s, group);
    for (uint32_t begin = 0, end; begin < count; begin = end) {
        end = sub_end(s, begin, count);
        for (uint32_t i = begin; end - begin > 2 && i < end; i++) {
            uint32_t side = s->subs[i].side;
            if (s->mates[side] == HEWN_NONE)
                continue;
            cut = true;
            part(s, side);
            if (harsh)
                s->apart[s->soup->corners[side]] = s->apart[s->soup->corners[side_after(s, side)]] = 1;
        }
    }
    return cut;
}

/* Where the cutting left a fan whose two rims are one edge, it closes again. */
static void close_slits(stitcher *s, uint32_t group)
{
    uint32_t count = sort_subs(s, group);
    for (uint32_t begin = 0, end; begin < count; begin = end) {
        end = sub_end(s, begin, count);
        uint32_t a = s->subs[begin].side, b = s->subs[end - 1].side;
        if (end - begin == 2 && s->mates[a] == HEWN_NONE && s->mates[b] == HEWN_NONE && s->fans[a] != s->fans[b]) {
            s->mates[a] = b;
            s->mates[b] = a;
        }
    }
}

static void take_apart(stitcher *s)
{
    uint32_t corners = hewn_soup_corner_count(s->soup);
    for (uint32_t c = 0; c < corners; c++)
        if (s->apart[s->soup->corners[c]] || s->apart[s->soup->corners[side_after(s, c)]])
            part(s, c);
}

static hewn_result settle(stitcher *s, uint8_t *used, hewn_error *error)
{
    HEWN_TRY(find_fans(s, used, error));
    for (int round = 0;; round++) {
        bool cut = false;
        for (uint32_t i = 0; i < s->special_count; i++)
            cut |= cut_collisions(s, s->special[i], round >= GENTLE_ROUNDS);
        if (!cut)
            break;
        for (uint32_t i = 0; round >= ROUNDS && i < s->special_count; i++) {
            uint32_t side = s->sides.sides[s->sides.group[s->special[i]]];
            s->apart[s->soup->corners[side]] = s->apart[s->soup->corners[side_after(s, side)]] = 1;
        }
        if (round >= GENTLE_ROUNDS)
            take_apart(s);
        HEWN_TRY(find_fans(s, used, error));
    }
    for (uint32_t i = 0; i < s->special_count; i++)
        close_slits(s, s->special[i]);
    return HEWN_OK;
}

/* --- copies ------------------------------------------------------------------------------------------------------- */

static hewn_result refuse_vertices(const stitcher *s, hewn_error *error)
{
    uint32_t corners = hewn_soup_corner_count(s->soup), least = HEWN_NONE;
    for (uint32_t c = 0; c < corners; c++)
        if (s->fans[c] >= s->soup->vertex_count && s->soup->corners[c] < least)
            least = s->soup->corners[c];
    return hewn_fail(error, HEWN_BAD_INPUT, "the faces at vertex %u form more than one fan",
                     s->soup->vertex_origins[least]);
}

/* New numbers are handed out in order of corners, so each copy is met in turn. */
static hewn_result copy_vertices(stitcher *s, uint8_t *split, hewn_repair_report *report, hewn_error *error)
{
    hewn_soup *soup = s->soup;
    uint32_t corners = hewn_soup_corner_count(soup), old = soup->vertex_count;
    HEWN_TRY(hewn_soup_reserve(soup, s->vertex_count - old, 0, 0, error));
    if (old > 0)
        memset(split, 0, old);
    for (uint32_t c = 0; c < corners; c++) {
        uint32_t vertex = soup->corners[c];
        if (s->fans[c] == soup->vertex_count) {
            const double *p = soup->positions + 3 * (size_t)vertex;
            double position[3] = {p[0], p[1], p[2]};
            hewn_soup_add_vertex(soup, position, soup->vertex_origins[vertex]);
            report->non_manifold_vertices += !split[vertex];
            report->vertex_copies++;
            split[vertex] = 1;
        }
        soup->corners[c] = s->fans[c];
    }
    return HEWN_OK;
}

static hewn_result allocate(stitcher *s, hewn_error *error)
{
    size_t corners = hewn_soup_corner_count(s->soup);
    s->mates = hewn_alloc(corners, sizeof *s->mates);
    s->fans = hewn_alloc(corners, sizeof *s->fans);
    s->special = hewn_alloc(corners / 2 + 1, sizeof *s->special);
    s->apart = hewn_alloc_zero(s->soup->vertex_count, 1);
    if (!s->mates || !s->fans || !s->special || !s->apart)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory stitching %u faces", s->soup->face_count);
    return HEWN_OK;
}

static hewn_result allocate_special(stitcher *s, hewn_error *error)
{
    s->items = hewn_alloc(s->longest, sizeof *s->items);
    s->stack = hewn_alloc(s->longest, sizeof *s->stack);
    s->subs = hewn_alloc(s->longest, sizeof *s->subs);
    if (!s->items || !s->stack || !s->subs)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory stitching %u faces", s->soup->face_count);
    return HEWN_OK;
}

static hewn_result stitch(stitcher *s, bool strict, uint8_t *bytes, hewn_repair_report *report, hewn_error *error)
{
    HEWN_TRY(mate_plain(s, strict, report, error));
    HEWN_TRY(allocate_special(s, error));
    pair_special(s);
    HEWN_TRY(settle(s, bytes, error));
    if (strict && s->vertex_count > s->soup->vertex_count)
        return refuse_vertices(s, error);
    return copy_vertices(s, bytes, report, error);
}

hewn_result hewn_soup_stitch(hewn_soup *soup, bool strict, hewn_repair_report *report, hewn_error *error)
{
    stitcher s = {.soup = soup};
    HEWN_TRY(hewn_sides_build(soup, &s.sides, error));
    uint8_t *bytes = hewn_alloc(soup->vertex_count, 1);
    hewn_result result = allocate(&s, error);
    if (result == HEWN_OK && !bytes)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory stitching %u faces", soup->face_count);
    if (result == HEWN_OK)
        result = stitch(&s, strict, bytes, report, error);
    hewn_free(s.mates);
    hewn_free(bytes);
    hewn_free(s.fans);
    hewn_free(s.special);
    hewn_free(s.apart);
    hewn_free(s.items);
    hewn_free(s.stack);
    hewn_free(s.subs);
    hewn_sides_free(&s.sides);
    return result;
}
