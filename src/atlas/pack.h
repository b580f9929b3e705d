/* Rectangles side by side in a larger one. */
#ifndef HEWN_SRC_ATLAS_PACK_H
#define HEWN_SRC_ATLAS_PACK_H

#include "hewn/base.h"

typedef struct hewn_packed {
    uint32_t width, height; /* of the rectangle */
    uint32_t x, y;          /* its place, y from the top */
} hewn_packed;

/* Finds places, the tallest first, each as high up and then as far left as the skyline of those before it leaves (J.
 * Jylanki, A thousand ways to pack the bin, 2010); `gap` free columns and rows lie between two. False where they do not
 * fit. The same places for the same sizes in the same order. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_pack(hewn_packed *items, size_t count, uint32_t gap, uint32_t width, uint32_t height, bool *fit,
                      hewn_error *error);

/* Finds the least side of a square, a multiple of 4 or with `power_of_two` such a power, in which they fit: the first
 * of a row of sides, each a little longer, from that of the sum of their areas on. HEWN_LIMIT where that is more than
 * `most`. */
hewn_result hewn_pack_square(hewn_packed *items, size_t count, uint32_t gap, bool power_of_two, uint32_t most,
                             uint32_t *side, hewn_error *error);

#endif
