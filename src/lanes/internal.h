/* What the files of this room share. */
#ifndef HEWN_SRC_LANES_INTERNAL_H
#define HEWN_SRC_LANES_INTERNAL_H

#include "lanes/tape.h"

#define HEWN_NO_STEP 0xFFFFFFFFu

/* What may be cut: keep both operands, or only the first (for a step with a number: the register) or the second. */
enum { HEWN_KEEP_BOTH = 0, HEWN_KEEP_FIRST = 1, HEWN_KEEP_SECOND = 2 };

static inline bool hewn_lane_can_cut(const hewn_lane_step *step)
{
    return step->kind >= HEWN_LANE_FLOOR_AT && step->kind <= HEWN_LANE_OTHER_BLEND;
}

/* The steps that one reads, by their places. */
typedef uint32_t hewn_lane_operands[HEWN_LANE_INPUTS];

/* From steps without registers, which read others by `in` (written over), to a tape of those that `last` depends on. */
hewn_result hewn_lane_tape_settle(const hewn_lane_tape *steps, hewn_lane_operands *in, uint32_t last,
                                  hewn_lane_tape **out, hewn_error *error);

#endif
