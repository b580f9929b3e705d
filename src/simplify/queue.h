/* The least first: a heap with four children a node over numbers that hold a cost and an edge, so that edges of equal
 * cost come in the order of their names. */
#ifndef HEWN_SRC_SIMPLIFY_QUEUE_H
#define HEWN_SRC_SIMPLIFY_QUEUE_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/alloc.h"

/* Where the first item was taken, there is a hole until the next push or take: an item that comes back soon goes there.
 */
typedef struct simplify_queue {
    uint64_t *items;
    size_t count, capacity; /* with the hole */
    bool hollow;
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

/* The least of up to four children from `child` on. */
static inline size_t simplify_queue_least(const simplify_queue *queue, size_t child)
{
    const uint64_t *items = queue->items;
    if (child + 4 > queue->count) {
        size_t least = child;
        for (size_t other = child + 1; other < queue->count; other++)
            least = items[other] < items[least] ? other : least;
        return least;
    }
    const size_t one = child + (items[child + 1] < items[child]);
    const size_t two = child + 2 + (items[child + 3] < items[child + 2]);
    return items[two] < items[one] ? two : one;
}

/* Puts an item where there is none, or below. */
static inline void simplify_queue_sink(simplify_queue *queue, size_t at, uint64_t item)
{
    for (size_t child; (child = 4 * at + 1) < queue->count; at = child) {
        child = simplify_queue_least(queue, child);
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
            simplify_queue_sink(queue, at, queue->items[at]);
}

static inline bool simplify_queue_is_empty(const simplify_queue *queue)
{
    return queue->count <= (size_t)queue->hollow;
}

/* The least item; there must be one. */
static inline uint64_t simplify_queue_head(const simplify_queue *queue)
{
    return queue->items[queue->hollow ? simplify_queue_least(queue, 1) : 0];
}

/* HEWN_OUT_OF_MEMORY. */
static inline hewn_result simplify_queue_push(simplify_queue *queue, uint64_t item)
{
    if (queue->hollow) {
        queue->hollow = false;
        simplify_queue_sink(queue, 0, item);
        return HEWN_OK;
    }
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
static inline uint64_t simplify_queue_take(simplify_queue *queue)
{
    if (queue->hollow) /* by the last, which mostly belongs far below */
        simplify_queue_sink(queue, 0, queue->items[--queue->count]);
    queue->hollow = true;
    return queue->items[0];
}

#endif
