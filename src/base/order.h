/* Comparing for qsort(). */
#ifndef HEWN_SRC_BASE_ORDER_H
#define HEWN_SRC_BASE_ORDER_H

#include <stdint.h>

/* Whole numbers of 64 bits, in rising order. */
static inline int hewn_order_uint64(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

#endif
