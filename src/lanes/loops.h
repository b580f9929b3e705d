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
    for (uint32_t i = 0; i < ((COUNT) & ~(HEWN_LANE_BLOCK - 1U)); i++)
/* clang-format on */

#endif
