/* Items with a bound each, the one of the least bound first: a binary heap. */
#ifndef HEWN_SRC_QUERY_HEAP_H
#define HEWN_SRC_QUERY_HEAP_H

#include "base/error.h"

/* Of items of `size` bytes, at most HEWN_HEAP_MOST, whose first member is their bound, a float. Zero but for `size` is
 * empty. Items are owned. */
typedef struct hewn_heap {
    size_t size, count, capacity;
    char *items;
} hewn_heap;

enum { HEWN_HEAP_MOST = 256 };

hewn_result hewn_heap_push(hewn_heap *heap, const void *item, hewn_error *error); /* HEWN_OUT_OF_MEMORY */

/* Takes the first item of a heap that is not empty. */
void hewn_heap_pop(hewn_heap *heap, void *item);

/* The least bound; infinite where there is none. */
float hewn_heap_least(const hewn_heap *heap);

void hewn_heap_free(hewn_heap *heap);

#endif
