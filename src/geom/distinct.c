#include "geom/distinct.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

#define FREE 0xFFFFFFFFu

/* The same for equal positions: -0 is 0. */
static uint64_t hash_of(const float *position)
{
    uint64_t hash = 0x9e3779b97f4a7c15u;
    for (int axis = 0; axis < 3; axis++) {
        float value = position[axis] + 0.0F;
        uint32_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = (hash ^ bits) * 0xbf58476d1ce4e5b9u;
        hash ^= hash >> 29;
    }
    return hash;
}

static bool equal(const float *a, const float *b)
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* The slot of this position, or the free one where it belongs. */
static uint64_t find_slot(const uint32_t *slots, uint64_t mask, const float *positions, const float *position)
{
    uint64_t slot = hash_of(position) & mask;
    while (slots[slot] != FREE && !equal(positions + 3 * (size_t)slots[slot], position))
        slot = (slot + 1) & mask;
    return slot;
}

hewn_result hewn_triangles_make_distinct(hewn_triangles *triangles, uint64_t *moved, hewn_error *error)
{
    uint64_t size = 16, count = 0;
    while (size < 2 * triangles->vertex_count)
        size *= 2;
    uint32_t *slots = hewn_alloc(size, sizeof *slots);
    if (!slots)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory comparing %llu vertices",
                         (unsigned long long)triangles->vertex_count);
    memset(slots, 0xFF, size * sizeof *slots);
    for (uint64_t v = 0; v < triangles->vertex_count; v++) {
        float *position = triangles->positions + 3 * v;
        uint64_t slot = find_slot(slots, size - 1, triangles->positions, position);
        count += slots[slot] != FREE;
        while (slots[slot] != FREE) {
            position[0] = nextafterf(position[0], INFINITY);
            slot = find_slot(slots, size - 1, triangles->positions, position);
        }
        slots[slot] = (uint32_t)v;
    }
    hewn_free(slots);
    if (moved)
        *moved = count;
    return HEWN_OK;
}
