/* How loops over lanes are written, so that the compiler makes vector code of them. */
#ifndef HEWN_SRC_LANES_LOOPS_H
#define HEWN_SRC_LANES_LOOPS_H

#include "lanes/tape.h"

/* Rows that a step writes are none that it reads. */
#if defined(__clang__)
#define HEWN_LANE_APART
#else
#define HEWN_LANE_APART _Pragma("GCC ivdep")
#endif

/* Over a count that is a multiple of a block, which leaves no rest to treat one by one. */
/* clang-format off */
#define HEWN_LANE_LOOP(COUNT) \
    HEWN_LANE_APART \
    for (uint32_t block = 0; block < (COUNT); block += HEWN_LANE_BLOCK) \
        for (uint32_t i = block; i < block + HEWN_LANE_BLOCK; i++)
/* clang-format on */

/* Compiled for processors with AVX2 too, and chosen when the program is loaded. Neither form fuses products with sums,
 * so both give the same bits. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__) &&                        \
    !defined(__SANITIZE_ADDRESS__)
#define HEWN_LANE_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define HEWN_LANE_CLONES
#endif

#endif
