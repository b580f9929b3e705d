/* A walk through a brick's layers of cells on the host, a layer of 64 signs to a word. Private to the stages that the
 * host does for devices which share its memory. */
#ifndef HEWN_SRC_ISO_HOST_WALK_H
#define HEWN_SRC_ISO_HOST_WALK_H

#include "iso/host_surface.h"
#include "shared/iso.h"

/* Bricks that a thread takes at a time, and fewer than it pays to wake other threads for. */
enum { SHARE = 64, ALONE = 512 };

/* A layer as it is and shifted by one sample in x, in y and in both; bit x + 8 y. */
typedef struct layer {
    uint64_t at[4];
} layer;

static inline uint64_t read_layer(const hewn_host_surface *surface, uint32_t slot, uint32_t z)
{
    if (slot >= HEWN_ALL_OUTSIDE)
        return slot == HEWN_ALL_INSIDE ? ~(uint64_t)0 : 0;
    const uint32_t *words = surface->signs + (uint64_t)slot * HEWN_BRICK_WORDS + 2 * z;
    return words[0] | (uint64_t)words[1] << 32;
}

/* `slots` are a brick's own and its neighbours in x, in y and in both. */
static inline layer load_layer(const hewn_host_surface *surface, const uint32_t slots[4], uint32_t z)
{
    const uint64_t first_column = 0x0101010101010101u;
    uint64_t own = read_layer(surface, slots[0], z), beside = read_layer(surface, slots[1], z);
    uint64_t up = own >> 8 | read_layer(surface, slots[2], z) << 56;
    uint64_t beside_up = beside >> 8 | read_layer(surface, slots[3], z) << 56;
    return (layer){{own, (own >> 1 & ~(first_column << 7)) | (beside & first_column) << 7, up,
                    (up >> 1 & ~(first_column << 7)) | (beside_up & first_column) << 7}};
}

/* A walk up the layers of cells of a brick. */
typedef struct walk {
    const hewn_host_surface *surface;
    const uint32_t *links;
    uint64_t below[2]; /* samples of a layer that have a cell along x, along y */
    uint32_t layers;   /* that have a cell along z */
    uint32_t z;
    layer lower, upper;
} walk;

static inline uint32_t cells_from(const hewn_host_surface *surface, uint32_t packed, uint32_t axis)
{
    uint32_t first = 8 * (packed >> 10 * axis & 1023u);
    uint32_t left = surface->cells[axis] > first ? surface->cells[axis] - first : 0;
    return left < 8 ? left : 8;
}

static inline walk walk_begin(const hewn_host_surface *surface, uint32_t slot)
{
    walk own = {.surface = surface, .links = surface->links + (uint64_t)slot * HEWN_BRICK_LINKS};
    uint32_t packed = surface->bricks[slot], rows = cells_from(surface, packed, 1);
    own.below[0] = ((1u << cells_from(surface, packed, 0)) - 1) * 0x0101010101010101u;
    own.below[1] = rows == 8 ? ~(uint64_t)0 : ((uint64_t)1 << 8 * rows) - 1;
    own.layers = cells_from(surface, packed, 2);
    own.upper = load_layer(surface, own.links, 0);
    return own;
}

/* To the layer of cells at `z`, which are called in order. */
static inline void walk_to(walk *own, uint32_t z)
{
    own->z = z;
    own->lower = own->upper;
    own->upper = z < 7 ? load_layer(own->surface, own->links, z + 1) : load_layer(own->surface, own->links + 4, 0);
}

static inline uint64_t surface_cells(const walk *own)
{
    if (own->z >= own->layers)
        return 0;
    uint64_t any = 0, all = ~(uint64_t)0;
    for (int i = 0; i < 4; i++) {
        any |= own->lower.at[i] | own->upper.at[i];
        all &= own->lower.at[i] & own->upper.at[i];
    }
    return any & ~all & own->below[0] & own->below[1];
}

static inline uint32_t cell_pattern(const walk *own, uint32_t bit)
{
    uint32_t pattern = 0;
    for (int i = 0; i < 4; i++)
        pattern |= (uint32_t)(own->lower.at[i] >> bit & 1) << i | (uint32_t)(own->upper.at[i] >> bit & 1) << (4 + i);
    return pattern;
}

static inline uint32_t first_bit(uint64_t mask)
{
    return (uint32_t)__builtin_ctzll(mask);
}

/* The crossed edges that leave a layer's samples upward, written and counted. */
static inline uint32_t write_crossed(const walk *own, uint32_t *edges)
{
    const uint64_t crossed[3] = {(own->lower.at[0] ^ own->lower.at[1]) & own->below[0],
                                 (own->lower.at[0] ^ own->lower.at[2]) & own->below[1],
                                 own->z < own->layers ? own->lower.at[0] ^ own->upper.at[0] : 0};
    uint32_t count = 0;
    for (uint32_t axis = 0; axis < 3; axis++) {
        uint32_t *pair = edges + 2 * (axis * HEWN_BRICK_WORDS + 2 * own->z);
        pair[0] = (uint32_t)crossed[axis];
        pair[2] = (uint32_t)(crossed[axis] >> 32);
        count += (uint32_t)__builtin_popcountll(crossed[axis]);
    }
    return count;
}

/* Counts become sums of those before; `total` in two words. */
static inline void sum_before_each(uint32_t *counts, uint32_t count, uint32_t total[2])
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t own = counts[i];
        counts[i] = (uint32_t)sum;
        sum += own;
    }
    total[0] = (uint32_t)sum;
    total[1] = (uint32_t)(sum >> 32);
}

#endif
