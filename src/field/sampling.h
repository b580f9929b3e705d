/* The inside of a hewn_sampling: one block of 32-bit words that the host and shaders read alike (shaders/field/sampled*
 * has the same layout), from the front:
 *   - HEWN_SAMPLING_HEAD words: the places of the levels of the pyramid;
 *   - a word for each brick of 8 x 8 x 8 cells, x fastest: the place of its samples, or 0, which makes it a coarse one:
 *     its values are those between its eight corners;
 *   - a float for each corner of a brick;
 *   - the pyramid: on level 0 the least and greatest sample and the greatest slope of each brick; on level n + 1 those
 *     of each block of 2^n bricks a side together with the next one along each axis, so that whatever is no longer than
 *     such a block lies in one entry;
 *   - the samples of bricks that are not coarse, 9 x 9 x 9, their far sides included.
 * A flat sampling has one layer of samples: then bricks are 8 x 8 cells and have 9 x 9 samples.
 *
 * On a side or an edge that a brick shares with a coarse one its samples are what that one has there, so that values
 * are continuous. */
#ifndef HEWN_SRC_FIELD_SAMPLING_H
#define HEWN_SRC_FIELD_SAMPLING_H

#include <stdatomic.h>

#include "hewn/sampling.h"

enum {
    HEWN_SAMPLING_BRICK = 8,
    HEWN_SAMPLING_SIDE = 9, /* samples along the side of a brick */
    HEWN_SAMPLING_HEAD = 16,
    HEWN_SAMPLING_CELLS_MOST = 1 << 17, /* along a side, so that levels fit the head and floats hold places */
};

struct hewn_sampling {
    atomic_uint uses;
    uint32_t cells[3];  /* the last is 0 where it is flat */
    uint32_t bricks[3]; /* at least 1 */
    bool endless;
    bool enclosed;                   /* values at its sides are above 0 */
    float least, greatest, steepest; /* of all samples; the slope is at most this between them */
    uint32_t level_count;
    uint64_t fine_count; /* bricks that are not coarse */
    size_t word_count;
    uint32_t words[];
};

/* A sampling that is being made: `fine` has a byte for each brick, 0 where it is coarse. Samples are 0 until they are
 * set. HEWN_LIMIT for more cells than can be, HEWN_OUT_OF_MEMORY. */
typedef struct hewn_sampling_shape {
    uint32_t cells[3]; /* without coarse bricks any numbers, else multiples of 8 */
    bool endless;
    const uint8_t *fine; /* NULL: all are fine */
} hewn_sampling_shape;

hewn_result hewn_sampling_begin(const hewn_sampling_shape *shape, hewn_sampling **out, hewn_error *error);

/* The words that such a sampling takes, in bytes. */
uint64_t hewn_sampling_bytes(const uint32_t cells[3], uint64_t fine_count);

/* The samples of a brick (x fastest, 9 along a side), NULL where it is coarse; and those of all corners. */
float *hewn_sampling_brick(const hewn_sampling *sampling, uint64_t brick);
float *hewn_sampling_corners(const hewn_sampling *sampling);

/* Fits fine bricks to coarse ones and makes the pyramid. The same for any number of threads. */
void hewn_sampling_finish(hewn_sampling *sampling);

/* One more user of it; each ends with hewn_sampling_destroy(). */
hewn_sampling *hewn_sampling_share(const hewn_sampling *sampling);

/* How many entries lie along an axis. */
static inline uint32_t hewn_sampling_entries(const hewn_sampling *sampling, int axis, uint32_t level)
{
    uint32_t size = level == 0 ? 0 : level - 1;
    return (sampling->bricks[axis] + (1u << size) - 1) >> size;
}

/* The value at a place counted in cells from the middle of the lattice, and its derivatives after the place (or NULL).
 * Bounds over a box of such places. */
double hewn_sampling_value(const hewn_sampling *sampling, const double at[3], double slopes[3]);
hewn_interval hewn_sampling_bound(const hewn_sampling *sampling, const hewn_interval in[3]);

/* No slope is more in a box of such places. */
double hewn_sampling_steepest(const hewn_sampling *sampling, const hewn_interval in[3]);

#endif
