/* The least first: a heap with four children a node over numbers that hold a cost and an edge, so that edges of equal
 * cost come in the order of their names. */
#ifndef HEWN_SRC_SIMPLIFY_QUEUE_H
#define HEWN_SRC_SIMPLIFY_QUEUE_H

#include <stdint.h>
#include <string.h>

#include "base/alloc.h"

typedef struct simplify_queue {
    uint64_t *items;
    size_t count, capacity;
} simplify_queue;

/* Costs are not negative, so their bits are in their order. */
static inline uint64_t simplify_item(float cost, uint32_t edge)
{
    uint32_t bits;
    memcpy(&bits, &cost, sizeof bits);
    return (uint64_t)bits << 32 | edge;
}

static inline float simplify_item_cost(uint64_t item)
{
    uint32_t bits = (uint32_t)(item >> 32);
    float cost;
    memcpy(&cost, &bits, sizeof cost);
    return cost;
}

static inline void simplify_queue_sink(simplify_queue *queue, size_t at)
{
    const uint64_t item = queue->items[at];
    for (size_t child; (child = 4 * at + 1) < queue->count; at = child) {
        const size_t end = child + 4 < queue->count ? child + 4 : queue->count;
        for (size_t other = child + 1; other < end; other++)
            child = queue->items[other] < queue->items[child] ? other : child;
        if (queue->items[child] >= item)
            break;
        queue->items[at] = queue->items[child];
    }
    queue->items[at] = item;
}

/* Makes a heap of items in any order. */
static inline void simplify_queue_settle(simplify_queue *queue)
{
    for (size_t at = queue->count / 4 + 1; at-- > 0;)
        if (at < queue->count)
            simplify_queue_sink(queue, at);
}

/* HEWN_OUT_OF_MEMORY. */
static inline hewn_result simplify_queue_push(simplify_queue *queue, uint64_t item)
{
    if (queue->count == queue->capacity) {
        hewn_result result =
            hewn_reserve((void **)&queue->items, &queue->capacity, queue->count + 1, sizeof *queue->items, NULL);
        if (result != HEWN_OK)
            return result;
    }
    size_t at = queue->count++;
    for (; at > 0 && queue->items[(at - 1) / 4] > item; at = (at - 1) / 4)
        queue->items[at] = queue->items[(at - 1) / 4];
    queue->items[at] = item;
    return HEWN_OK;
}

/* The least item goes; there must be one. */
static inline void simplify_queue_pop(simplify_queue *queue)
{
    queue->items[0] = queue->items[--queue->count];
    if (queue->count > 0)
        simplify_queue_sink(queue, 0);
}

#endif
