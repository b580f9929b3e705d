/* Eight numbers as two vectors of four, which any processor holds. Comparisons give -1, all bits, where they hold. */
#ifndef HEWN_SRC_SMOOTH_FOUR_H
#define HEWN_SRC_SMOOTH_FOUR_H

#include <stdint.h>
#include <string.h>

enum { SMOOTH_EIGHT = 8 };

typedef int32_t smooth_four __attribute__((vector_size(4 * sizeof(int32_t))));
typedef float smooth_four_floats __attribute__((vector_size(4 * sizeof(float))));

typedef struct smooth_eight {
    smooth_four half[2];
} smooth_eight;

/* Copies `length` of eight numbers; all of them where there is room, which is one step. */
static inline void smooth_eight_copy(void *to, const void *from, uint32_t length, uint64_t room)
{
    if (room >= SMOOTH_EIGHT)
        memcpy(to, from, SMOOTH_EIGHT * sizeof(int32_t));
    else
        memcpy(to, from, length * sizeof(int32_t));
}

#endif
