#include "iso/host_surface.h"

#include "iso/host_places.h"
#include "iso/host_walk.h"
#include "iso/marching_cubes.h"

/* --- counting ------------------------------------------------------------------------------------------------------
 */

static void count_brick(const hewn_host_surface *surface, const hewn_mc_table *table, uint32_t slot)
{
    walk own = walk_begin(surface, slot);
    uint32_t vertices = 0, triangles = 0;
    for (uint32_t z = 0; z < 8; z++) {
        walk_to(&own, z);
        vertices += write_crossed(&own, surface->edges + (uint64_t)2 * slot * HEWN_BRICK_EDGE_WORDS);
        for (uint64_t cut = surface_cells(&own); cut != 0; cut &= cut - 1)
            triangles += table->words[cell_pattern(&own, first_bit(cut))][0];
    }
    surface->vertex_bases[slot] = vertices;
    surface->triangle_bases[slot] = triangles;
}

void hewn_host_surface_count(const hewn_host_surface *surface, uint32_t totals[4])
{
    hewn_mc_table table;
    hewn_mc_table_derive(&table);
#pragma omp parallel for schedule(dynamic, SHARE) if (surface->count >= ALONE)
    for (uint32_t slot = 0; slot < surface->count; slot++)
        count_brick(surface, &table, slot);
    sum_before_each(surface->vertex_bases, surface->count, totals);
    sum_before_each(surface->triangle_bases, surface->count, totals + 2);
}

/* --- spreading -----------------------------------------------------------------------------------------------------
 */

static void spread_brick(const hewn_host_surface *surface, uint32_t slot)
{
    uint32_t vertex = surface->vertex_bases[slot], packed = surface->bricks[slot];
    uint32_t short_brick = (packed & 127) | (packed >> 10 & 127) << 7 | (packed >> 20 & 127) << 14;
    uint32_t *pair = surface->edges + (uint64_t)2 * slot * HEWN_BRICK_EDGE_WORDS;
    for (uint32_t word = 0; word < HEWN_BRICK_EDGE_WORDS; word++, pair += 2) {
        pair[1] = vertex;
        for (uint32_t mask = pair[0]; mask != 0; mask &= mask - 1, vertex++) {
            uint32_t *record = surface->vertices + (uint64_t)3 * vertex;
            record[0] = packed;
            record[1] = (32 * word + first_bit(mask)) | short_brick << 11;
        }
    }
}

void hewn_host_surface_spread(const hewn_host_surface *surface)
{
#pragma omp parallel for schedule(dynamic, SHARE) if (surface->count >= ALONE)
    for (uint32_t slot = 0; slot < surface->count; slot++)
        spread_brick(surface, slot);
}

/* --- triangles ------------------------------------------------------------------------------------------------------
 */

/* The triangles of each pattern as places of their corners, counted from the cell's own place. */
typedef struct corner_table {
    uint32_t counts[256]; /* corners */
    uint32_t corners[256][3 * HEWN_MC_MAX_TRIANGLES];
} corner_table;

static void derive_corners(corner_table *out)
{
    hewn_mc_table table;
    hewn_mc_table_derive(&table);
    for (uint32_t pattern = 0; pattern < 256; pattern++) {
        out->counts[pattern] = 3 * table.words[pattern][0];
        for (uint32_t i = 0; i < out->counts[pattern]; i++) {
            uint32_t edge = table.words[pattern][1 + i / 6] >> (16 * (i / 3 % 2) + 4 * (i % 3)) & 15;
            out->corners[pattern][i] = place_of_edge(edge);
        }
    }
}

/* Numbers are set only where edges are crossed, and only those are read. */
static void triangulate_brick(const hewn_host_surface *surface, const corner_table *table, uint32_t slot)
{
    uint32_t numbers[3 * AN_AXIS];
    place_vertices(surface, surface->links + (uint64_t)slot * HEWN_BRICK_LINKS, numbers);
    walk own = walk_begin(surface, slot);
    uint32_t *out = surface->indices + (uint64_t)3 * surface->triangle_bases[slot];
    for (uint32_t z = 0; z < 8; z++) {
        walk_to(&own, z);
        for (uint64_t cut = surface_cells(&own); cut != 0; cut &= cut - 1) {
            uint32_t bit = first_bit(cut), pattern = cell_pattern(&own, bit), count = table->counts[pattern];
            const uint32_t *from = numbers + place_of(bit & 7, bit >> 3, z), *corners = table->corners[pattern];
            for (uint32_t i = 0; i < count; i++)
                *out++ = from[corners[i]];
        }
    }
}

void hewn_host_surface_triangulate(const hewn_host_surface *surface, uint32_t first, uint32_t end,
                                   uint64_t triangle_count)
{
    corner_table table;
    derive_corners(&table);
#pragma omp parallel for schedule(dynamic, SHARE) if (end - first >= ALONE)
    for (uint32_t slot = first; slot < end; slot++) {
        uint64_t next = slot + 1 < surface->count ? surface->triangle_bases[slot + 1] : triangle_count;
        if (next > surface->triangle_bases[slot])
            triangulate_brick(surface, &table, slot);
    }
}

/* --- where the surface is, coarsely ---------------------------------------------------------------------------------
 */

/* From eight rows of eight cells to four rows of four blocks. */
static uint64_t halve(uint64_t cells)
{
    cells |= cells >> 1;
    cells = (cells | cells >> 8) & 0x0055005500550055u;
    cells = (cells | cells >> 1) & 0x0033003300330033u;
    cells = (cells | cells >> 2) & 0x000F000F000F000Fu;
    return (cells | cells >> 12 | cells >> 24 | cells >> 36) & 0xFFFFu;
}

void hewn_host_surface_cut(const hewn_host_surface *surface, uint32_t *cuts)
{
#pragma omp parallel for schedule(dynamic, SHARE) if (surface->count >= ALONE)
    for (uint32_t slot = 0; slot < surface->count; slot++) {
        walk own = walk_begin(surface, slot);
        uint64_t blocks = 0;
        for (uint32_t z = 0; z < 8; z++) {
            walk_to(&own, z);
            blocks |= halve(surface_cells(&own)) << 16 * (z / 2);
        }
        cuts[2 * (uint64_t)slot] = (uint32_t)blocks;
        cuts[2 * (uint64_t)slot + 1] = (uint32_t)(blocks >> 32);
    }
}
