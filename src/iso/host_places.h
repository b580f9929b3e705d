/* The numbers of the vertices on a brick's edges and on those that its cells share with later bricks, for the stages
 * that make triangles on the host. Private to them. */
#ifndef HEWN_SRC_ISO_HOST_PLACES_H
#define HEWN_SRC_ISO_HOST_PLACES_H

#include "iso/host_walk.h"

/* A brick's edges and those of the neighbours above on which its cells stand: axis by axis, 9 x 9 x 9 samples. */
enum { SIDE = 9, AN_AXIS = SIDE * SIDE * SIDE };

static inline uint32_t place_of(uint32_t x, uint32_t y, uint32_t z)
{
    return x + SIDE * (y + SIDE * z);
}

/* Of an edge of a cell, counted from the cell's own place. */
static inline uint32_t place_of_edge(uint32_t edge)
{
    uint32_t axis = edge / 4, low = edge & 1, high = edge >> 1 & 1;
    uint32_t place = axis == 0 ? place_of(0, low, high) : axis == 1 ? place_of(low, 0, high) : place_of(low, high, 0);
    return axis * AN_AXIS + place;
}

/* Puts the numbers of vertices to the places of the edges along `axis` that a brick owns. */
static inline void place_own(const uint32_t *pairs, uint32_t *numbers)
{
    uint32_t number = pairs[1];
    for (uint32_t word = 0; word < HEWN_BRICK_WORDS; word++)
        for (uint32_t mask = pairs[2 * word]; mask != 0; mask &= mask - 1) {
            uint32_t bit = first_bit(mask);
            numbers[place_of(bit & 7, 4 * (word & 1) + (bit >> 3), word >> 1)] = number++;
        }
}

/* The same of the upper neighbour at `link`, for edges in its first layer of samples along the axes of `link`. */
static inline void place_beside(const uint32_t *pairs, uint32_t link, uint32_t *numbers)
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

static inline void place_vertices(const hewn_host_surface *surface, const uint32_t links[HEWN_BRICK_LINKS],
                                  uint32_t *numbers)
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

#endif
