#include "query/heap.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"

static char *item_at(const hewn_heap *heap, size_t at)
{
    return heap->items + at * heap->size;
}

static float bound_at(const hewn_heap *heap, size_t at)
{
    float bound;
    memcpy(&bound, item_at(heap, at), sizeof bound);
    return bound;
}

static void swap(const hewn_heap *heap, size_t a, size_t b)
{
    char held[HEWN_HEAP_MOST];
    memcpy(held, item_at(heap, a), heap->size);
    memcpy(item_at(heap, a), item_at(heap, b), heap->size);
    memcpy(item_at(heap, b), held, heap->size);
}

hewn_result hewn_heap_push(hewn_heap *heap, const void *item, hewn_error *error)
{
    HEWN_TRY(hewn_reserve((void **)&heap->items, &heap->capacity, heap->count + 1, heap->size, error));
    size_t at = heap->count++;
    memcpy(item_at(heap, at), item, heap->size);
    for (; at > 0 && bound_at(heap, at) < bound_at(heap, (at - 1) / 2); at = (at - 1) / 2)
        swap(heap, at, (at - 1) / 2);
    return HEWN_OK;
}

void hewn_heap_pop(hewn_heap *heap, void *item)
{
    memcpy(item, heap->items, heap->size);
    heap->count--;
    if (heap->count > 0)
        memcpy(heap->items, item_at(heap, heap->count), heap->size);
    for (size_t at = 0, least = 0;; at = least) {
        for (size_t child = 2 * at + 1; child <= 2 * at + 2 && child < heap->count; child++)
            least = bound_at(heap, child) < bound_at(heap, least) ? child : least;
        if (least == at)
            return;
        swap(heap, at, least);
    }
}

float hewn_heap_least(const hewn_heap *heap)
{
    return heap->count > 0 ? bound_at(heap, 0) : INFINITY;
}

void hewn_heap_free(hewn_heap *heap)
{
    hewn_free(heap->items);
    *heap = (hewn_heap){.size = heap->size};
}
