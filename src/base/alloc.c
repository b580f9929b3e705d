#include "base/alloc.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "base/error.h"

static bool product(size_t count, size_t size, size_t *bytes)
{
    if (size != 0 && count > SIZE_MAX / size)
        return false;
    *bytes = count * size;
    if (*bytes == 0)
        *bytes = 1;
    return true;
}

/* Asks the kernel for huge pages under what of a big block they can cover: with small ones, giving a fresh block its
 * pages takes about as long as one pass over it, and walks in no order miss the TLB at each step. */
static void *advise(void *block, size_t bytes)
{
    enum { HUGE_PAGE = 1 << 21 };
    const uintptr_t begin = ((uintptr_t)block + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
    const uintptr_t end = ((uintptr_t)block + bytes) / HUGE_PAGE * HUGE_PAGE;
    if (block && begin < end)
        madvise((char *)block + (begin - (uintptr_t)block), end - begin, MADV_HUGEPAGE); /* refused, nothing is lost */
    return block;
}

void *hewn_alloc(size_t count, size_t size)
{
    size_t bytes;
    return product(count, size, &bytes) ? advise(malloc(bytes), bytes) : NULL;
}

void *hewn_alloc_zero(size_t count, size_t size)
{
    size_t bytes;
    return product(count, size, &bytes) ? advise(calloc(1, bytes), bytes) : NULL;
}

void *hewn_realloc(void *block, size_t count, size_t size)
{
    size_t bytes;
    return product(count, size, &bytes) ? advise(realloc(block, bytes), bytes) : NULL;
}

hewn_result hewn_reserve(void **items, size_t *capacity, size_t needed, size_t size, hewn_error *error)
{
    if (needed <= *capacity)
        return HEWN_OK;
    size_t grown = *capacity < 16 ? 16 : *capacity;
    while (grown < needed)
        grown = grown > SIZE_MAX / 2 ? needed : grown * 2;
    void *moved = hewn_realloc(*items, grown, size);
    if (!moved)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory growing an array to %zu items", grown);
    *items = moved;
    *capacity = grown;
    return HEWN_OK;
}

void hewn_free(void *block)
{
    free(block);
}

char *hewn_strdup(const char *string)
{
    size_t length = strlen(string) + 1;
    char *copy = hewn_alloc(length, 1);
    if (copy)
        memcpy(copy, string, length);
    return copy;
}
