/* Ranges cut into blocks by their length alone: sums of blocks, added in the blocks' order, are the same for any number
 * of threads. */
#ifndef HEWN_SRC_SMOOTH_BLOCKS_H
#define HEWN_SRC_SMOOTH_BLOCKS_H

#include <stdint.h>

enum { SMOOTH_BLOCKS = 64 };

/* Where block `block` of `blocks` begins in a range of `count`, and so where the one before it ends. */
static inline uint64_t smooth_block_begin(uint64_t count, uint32_t blocks, uint32_t block)
{
    return count / blocks * block + count % blocks * block / blocks;
}

#endif
