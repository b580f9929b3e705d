#include "iso/host_mc33.h"

#include "iso/host_places.h"
#include "iso/host_walk.h"
#include "iso/mc33.h"

static uint32_t cell_number(uint32_t bit, uint32_t z)
{
    return bit + 64 * z;
}

/* --- asking ------------------------------------------------------------------------------------------------------- */

/* A brick's cells that values decide: counted, and listed where there is a place for them. */
static uint32_t ask_brick(const hewn_host_mc33 *mc33, uint32_t slot, uint32_t *asked)
{
    walk own = walk_begin(&mc33->surface, slot);
    uint32_t count = 0;
    for (uint32_t z = 0; z < 8; z++) {
        walk_to(&own, z);
        for (uint64_t cut = surface_cells(&own); cut != 0; cut &= cut - 1) {
            uint32_t bit = first_bit(cut), pattern = cell_pattern(&own, bit);
            if (!(mc33->table[pattern] & HEWN_MC33_DECIDES))
                continue;
            if (asked) {
                asked[2 * count] = slot;
                asked[2 * count + 1] = cell_number(bit, z) | pattern << 9;
            }
            count++;
        }
    }
    return count;
}

void hewn_host_mc33_rank(const hewn_host_mc33 *mc33, uint32_t total[2])
{
    const uint32_t count = mc33->surface.count;
#pragma omp parallel for schedule(dynamic, SHARE) if (count >= ALONE)
    for (uint32_t slot = 0; slot < count; slot++)
        mc33->ranks[slot] = ask_brick(mc33, slot, NULL);
    sum_before_each(mc33->ranks, count, total);
}

void hewn_host_mc33_ask(const hewn_host_mc33 *mc33)
{
    const uint32_t count = mc33->surface.count;
#pragma omp parallel for schedule(dynamic, SHARE) if (count >= ALONE)
    for (uint32_t slot = 0; slot < count; slot++)
        ask_brick(mc33, slot, mc33->asked + (uint64_t)2 * mc33->ranks[slot]);
}

/* --- counting ------------------------------------------------------------------------------------------------------
 */

/* The record of a cell; `asked` runs over the decisions of those that were asked. */
static const uint32_t *find_record(const hewn_host_mc33 *mc33, uint32_t pattern, const uint32_t **asked)
{
    uint32_t head = mc33->table[pattern], place = head & 0xFFFF;
    if (head & HEWN_MC33_DECIDES) {
        place = **asked;
        *asked += 2;
    }
    return mc33->table + place;
}

static void count_brick(const hewn_host_mc33 *mc33, uint32_t slot)
{
    walk own = walk_begin(&mc33->surface, slot);
    const uint32_t *asked = mc33->asked + (uint64_t)2 * mc33->ranks[slot];
    uint32_t triangles = 0, centres = 0;
    for (uint32_t z = 0; z < 8; z++) {
        walk_to(&own, z);
        for (uint64_t cut = surface_cells(&own); cut != 0; cut &= cut - 1) {
            const uint32_t *record = find_record(mc33, cell_pattern(&own, first_bit(cut)), &asked);
            triangles += record[0] & 255;
            centres += record[0] >> 8;
        }
    }
    mc33->surface.triangle_bases[slot] = triangles;
    mc33->centre_bases[slot] = centres;
}

void hewn_host_mc33_count(const hewn_host_mc33 *mc33, uint32_t totals[4])
{
    const uint32_t count = mc33->surface.count;
#pragma omp parallel for schedule(dynamic, SHARE) if (count >= ALONE)
    for (uint32_t slot = 0; slot < count; slot++)
        count_brick(mc33, slot);
    sum_before_each(mc33->surface.triangle_bases, count, totals);
    sum_before_each(mc33->centre_bases, count, totals + 2);
}

/* --- emission ------------------------------------------------------------------------------------------------------
 */

/* A number of 16 bits; two to a word. */
static uint32_t half_word(const uint32_t *words, uint32_t i)
{
    return words[i / 2] >> 16 * (i % 2) & 0xFFFF;
}

/* The records of a brick's vertices in cells. */
static void spread_centres(const hewn_host_mc33 *mc33, uint32_t slot)
{
    walk own = walk_begin(&mc33->surface, slot);
    const uint32_t *asked = mc33->asked + (uint64_t)2 * mc33->ranks[slot];
    uint32_t *out = mc33->surface.vertices + 3 * (mc33->first_centre + mc33->centre_bases[slot]);
    for (uint32_t z = 0; z < 8; z++) {
        walk_to(&own, z);
        for (uint64_t cut = surface_cells(&own); cut != 0; cut &= cut - 1) {
            uint32_t bit = first_bit(cut);
            const uint32_t *record = find_record(mc33, cell_pattern(&own, bit), &asked);
            for (uint32_t i = 0; i < record[0] >> 8; i++, out += 3) {
                out[0] = slot;
                out[1] = cell_number(bit, z) + 512 * half_word(record + 1, i);
            }
        }
    }
}

/* A cell's triangles. Corners below 12 are edges of the cell, those above vertices in it, of which `centre` is the
 * first. */
static uint32_t *write_cell(const uint32_t *record, const uint32_t *from, const uint32_t edge_places[12],
                            uint32_t centre, uint32_t *out)
{
    uint32_t centres = record[0] >> 8, count = record[0] & 255;
    const uint32_t *triangles = record + 1 + (centres + 1) / 2;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t corners = half_word(triangles, i);
        for (uint32_t k = 0; k < 3; k++, corners >>= 4) {
            uint32_t corner = corners & 15;
            *out++ = corner < 12 ? from[edge_places[corner]] : centre + corner - 12;
        }
    }
    return out;
}

static void triangulate_brick(const hewn_host_mc33 *mc33, const uint32_t edge_places[12], uint32_t slot)
{
    const hewn_host_surface *surface = &mc33->surface;
    uint32_t numbers[3 * AN_AXIS];
    place_vertices(surface, surface->links + (uint64_t)slot * HEWN_BRICK_LINKS, numbers);
    walk own = walk_begin(surface, slot);
    const uint32_t *asked = mc33->asked + (uint64_t)2 * mc33->ranks[slot];
    uint32_t centre = (uint32_t)mc33->first_centre + mc33->centre_bases[slot];
    uint32_t *out = surface->indices + (uint64_t)3 * surface->triangle_bases[slot];
    for (uint32_t z = 0; z < 8; z++) {
        walk_to(&own, z);
        for (uint64_t cut = surface_cells(&own); cut != 0; cut &= cut - 1) {
            uint32_t bit = first_bit(cut);
            const uint32_t *record = find_record(mc33, cell_pattern(&own, bit), &asked);
            out = write_cell(record, numbers + place_of(bit & 7, bit >> 3, z), edge_places, centre, out);
            centre += record[0] >> 8;
        }
    }
}

void hewn_host_mc33_emit(const hewn_host_mc33 *mc33, uint32_t first, uint32_t end)
{
    uint32_t edge_places[12];
    for (uint32_t edge = 0; edge < 12; edge++)
        edge_places[edge] = place_of_edge(edge);
    hewn_host_surface_spread(&mc33->surface);
    const uint32_t count = mc33->surface.count;
#pragma omp parallel for schedule(dynamic, SHARE) if (count >= ALONE)
    for (uint32_t slot = 0; slot < count; slot++) {
        spread_centres(mc33, slot);
        if (slot >= first && slot < end)
            triangulate_brick(mc33, edge_places, slot);
    }
}
