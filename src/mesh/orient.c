#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/soup.h"

/* --- faces among themselves --------------------------------------------------------------------------------------- */

/* The other half-edge of each edge of exactly two faces. */
static void link_pairs(const hewn_sides *sides, uint32_t corners, uint32_t *link)
{
    for (uint32_t c = 0; c < corners; c++)
        link[c] = HEWN_NONE;
    for (uint32_t g = 0; g < sides->count; g++)
        if (sides->group[g + 1] - sides->group[g] == 2) {
            uint32_t a = sides->sides[sides->group[g]], b = sides->sides[sides->group[g] + 1];
            link[a] = b;
            link[b] = a;
        }
}

/* The lowest half-edge whose partner runs the same way. */
static hewn_result refuse(const hewn_soup *soup, const hewn_sides *sides, const uint32_t *link, hewn_error *error)
{
    for (uint32_t c = 0; c < hewn_soup_corner_count(soup); c++)
        if (link[c] != HEWN_NONE && hewn_side_tail(soup, c) == hewn_side_tail(soup, link[c]))
            return hewn_fail(error, HEWN_BAD_INPUT, "faces %u and %u disagree in direction at the edge %u, %u",
                             soup->face_origins[sides->faces[c]], soup->face_origins[sides->faces[link[c]]],
                             soup->vertex_origins[hewn_side_tail(soup, c)],
                             soup->vertex_origins[hewn_side_head(soup, sides, c)]);
    return HEWN_OK;
}

/* The component of `start` into `queue`, `turned` relative to it; returns its size. `seen` marks faces met. */
static uint32_t search(const hewn_soup *soup, const hewn_sides *sides, const uint32_t *link, uint32_t start,
                       uint32_t *queue, uint8_t *seen, uint8_t *turned)
{
    uint32_t size = 1;
    queue[0] = start;
    seen[start] = 1;
    for (uint32_t at = 0; at < size; at++) {
        uint32_t face = queue[at];
        for (uint64_t c = soup->first[face]; c < soup->first[face + 1]; c++) {
            uint32_t other = link[c] == HEWN_NONE ? face : sides->faces[link[c]];
            if (seen[other])
                continue;
            bool same = hewn_side_tail(soup, (uint32_t)c) == hewn_side_tail(soup, link[c]);
            turned[other] = same ? !turned[face] : turned[face];
            seen[other] = 1;
            queue[size++] = other;
        }
    }
    return size;
}

static void orient_components(const hewn_soup *soup, const hewn_sides *sides, const uint32_t *link, uint32_t *queue,
                              uint8_t *seen, uint8_t *turned)
{
    for (uint32_t start = 0; start < soup->face_count; start++) {
        if (seen[start])
            continue;
        uint32_t size = search(soup, sides, link, start, queue, seen, turned), count = 0;
        for (uint32_t i = 0; i < size; i++)
            count += turned[queue[i]];
        for (uint32_t i = 0; count > size - count && i < size; i++)
            turned[queue[i]] ^= 1;
    }
}

hewn_result hewn_soup_orient(hewn_soup *soup, bool strict, hewn_error *error)
{
    uint32_t corners = hewn_soup_corner_count(soup);
    hewn_sides sides;
    HEWN_TRY(hewn_sides_build(soup, &sides, error));
    uint32_t *link = hewn_alloc(corners, sizeof *link), *queue = hewn_alloc(soup->face_count, sizeof *queue);
    uint8_t *seen = hewn_alloc_zero(soup->face_count, 1), *turned = hewn_alloc_zero(soup->face_count, 1);
    hewn_result result = HEWN_OK;
    if (!link || !queue || !seen || !turned) {
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory orienting %u faces", soup->face_count);
    } else {
        link_pairs(&sides, corners, link);
        if (strict)
            result = refuse(soup, &sides, link, error);
        if (result == HEWN_OK)
            orient_components(soup, &sides, link, queue, seen, turned);
        for (uint32_t f = 0; result == HEWN_OK && f < soup->face_count; f++)
            if (turned[f])
                hewn_soup_turn_face(soup, f);
    }
    hewn_free(turned);
    hewn_free(seen);
    hewn_free(queue);
    hewn_free(link);
    hewn_sides_free(&sides);
    return result;
}

/* --- components against the outside ------------------------------------------------------------------------------- */

/* A volume below this share of what it was summed from is taken for rounding. */
static const double least_volume = 1e-12;

/* What is known of a component, at its lowest vertex. */
typedef struct shell {
    double volume, size; /* × 6, about that vertex: the sum, and that of the absolute values */
    bool open, touched, inverted;
} shell;

static void measure_shells(const hewn_soup *soup, const hewn_sides *sides, uint32_t *parent, shell *shells)
{
    for (uint32_t f = 0; f < soup->face_count; f++) {
        shell *at = shells + hewn_sets_find(parent, soup->corners[soup->first[f]]);
        const double *o = soup->positions + 3 * (size_t)(at - shells);
        const double *p = soup->positions + 3 * (size_t)soup->corners[soup->first[f]];
        double normal[3];
        hewn_soup_face_normal(soup, f, normal);
        for (int axis = 0; axis < 3; axis++) {
            at->volume += (p[axis] - o[axis]) * normal[axis];
            at->size += fabs((p[axis] - o[axis]) * normal[axis]);
        }
        at->touched = at->touched || soup->turned[f];
    }
    for (uint32_t g = 0; g < sides->count; g++)
        if (sides->group[g + 1] - sides->group[g] == 1)
            shells[hewn_sets_find(parent, soup->corners[sides->sides[sides->group[g]]])].open = true;
}

static void turn_shells(hewn_soup *soup, uint32_t *parent, shell *shells, hewn_outward outward,
                        hewn_repair_report *report)
{
    for (uint32_t v = 0; v < soup->vertex_count; v++) {
        shell *s = shells + v;
        s->inverted = !s->open && s->volume < -least_volume * s->size && (s->touched || outward == HEWN_OUTWARD_ALWAYS);
        report->turned_components += s->inverted;
    }
    for (uint32_t f = 0; f < soup->face_count; f++)
        if (shells[hewn_sets_find(parent, soup->corners[soup->first[f]])].inverted)
            hewn_soup_turn_face(soup, f);
}

hewn_result hewn_soup_turn_outward(hewn_soup *soup, hewn_outward outward, hewn_repair_report *report, hewn_error *error)
{
    bool any = outward == HEWN_OUTWARD_ALWAYS;
    for (uint32_t f = 0; outward == HEWN_OUTWARD_TURNED && !any && f < soup->face_count; f++)
        any = soup->turned[f];
    if (!any)
        return HEWN_OK;
    hewn_sides sides;
    HEWN_TRY(hewn_sides_build(soup, &sides, error));
    uint32_t *parent = hewn_sets_create(soup->vertex_count);
    shell *shells = hewn_alloc_zero(soup->vertex_count, sizeof *shells);
    hewn_result result = HEWN_OK;
    if (!parent || !shells) {
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory turning components");
    } else {
        hewn_soup_join_faces(soup, parent);
        measure_shells(soup, &sides, parent, shells);
        turn_shells(soup, parent, shells, outward, report);
    }
    hewn_free(shells);
    hewn_free(parent);
    hewn_sides_free(&sides);
    return result;
}
