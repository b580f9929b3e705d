#include "iso/host_surface.h"

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

/* A brick's edges and those of the neighbours above on which its cells stand: axis by axis, 9 x 9 x 9 samples. */
enum { SIDE = 9, AN_AXIS = SIDE * SIDE * SIDE };

static uint32_t place_of(uint32_t x, uint32_t y, uint32_t z)
{
    return x + SIDE * (y + SIDE * z);
}

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
            uint32_t axis = edge / 4, low = edge & 1, high = edge >> 1 & 1;
            uint32_t place = axis == 0   ? place_of(0, low, high)
                             : axis == 1 ? place_of(low, 0, high)
                                         : place_of(low, high, 0);
            out->corners[pattern][i] = axis * AN_AXIS + place;
        }
    }
}

/* Puts the numbers of vertices to the places of the edges along `axis` that a brick owns. */
static void place_own(const uint32_t *pairs, uint32_t *numbers)
{
    uint32_t number = pairs[1];
    for (uint32_t word = 0; word < HEWN_BRICK_WORDS; word++)
        for (uint32_t mask = pairs[2 * word]; mask != 0; mask &= mask - 1) {
            uint32_t bit = first_bit(mask);
            numbers[place_of(bit & 7, 4 * (word & 1) + (bit >> 3), word >> 1)] = number++;
        }
}

/* The same of the upper neighbour at `link`, for edges in its first layer of samples along the axes of `link`. */
static void place_beside(const uint32_t *pairs, uint32_t link, uint32_t *numbers)
{
    uint32_t side_x = 8 * (link & 1), side_y = 8 * (link >> 1 & 1), side_z = 8 * (link >> 2 & 1);
    uint32_t seen = (side_x ? 0x01010101u : ~0u) & (side_y ? 0xFFu : ~0u);
    uint32_t words = side_z ? 2 : HEWN_BRICK_WORDS, step = side_y ? 2 : 1;
    for (uint32_t word = 0; word < words; word += step) {
        uint32_t whole = pairs[2 * word], number = pairs[2 * word + 1];
        for (uint32_t mask = whole & seen; mask != 0; mask &= mask - 1) {
            uint32_t bit = first_bit(mask), before = whole & ((1u << bit) - 1);
            uint32_t y = 4 * (word & 1) + (bit >> 3);
            numbers[place_of(side_x + (bit & 7), side_y + y, side_z + (word >> 1))] =
                number + (uint32_t)__builtin_popcount(before);
        }
    }
}

static void place_vertices(const hewn_host_surface *surface, const uint32_t links[HEWN_BRICK_LINKS], uint32_t *numbers)
{
    for (uint32_t link = 0; link < HEWN_BRICK_LINKS; link++)
        for (uint32_t axis = 0; axis < 3 && links[link] < HEWN_ALL_OUTSIDE; axis++) {
            uint64_t first = (uint64_t)links[link] * HEWN_BRICK_EDGE_WORDS + axis * HEWN_BRICK_WORDS;
            if (link == 0)
                place_own(surface->edges + 2 * first, numbers + axis * AN_AXIS);
            else if (!(link >> axis & 1))
                place_beside(surface->edges + 2 * first, link, numbers + axis * AN_AXIS);
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
