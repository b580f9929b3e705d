/* The one door to the heap: counts cannot overflow, and a failure is a result like any other. */
#ifndef HEWN_SRC_BASE_ALLOC_H
#define HEWN_SRC_BASE_ALLOC_H

#include "hewn/base.h"

/* `count` items of `size` bytes, uninitialised; NULL when out of memory. A count of 0 gives a valid block. */
void *hewn_alloc(size_t count, size_t size);

/* The same, all bytes zero. */
void *hewn_alloc_zero(size_t count, size_t size);

/* Grows or shrinks a block; on failure returns NULL and leaves the block as it was. */
void *hewn_realloc(void *block, size_t count, size_t size);

/* Makes room for at least `needed` items in a growing array, doubling its capacity (in items).
 * On HEWN_OUT_OF_MEMORY the array is untouched. */
hewn_result hewn_reserve(void **items, size_t *capacity, size_t needed, size_t size, hewn_error *error);

void hewn_free(void *block);

/* A copy of a string on the heap, or NULL when out of memory. */
char *hewn_strdup(const char *string);

#endif
