/* What the kernel that answers questions shares with its host. */
#ifndef HEWN_SHADERS_SHARED_QUERY_H
#define HEWN_SHADERS_SHARED_QUERY_H

#include "shared/types.h"

#define HEWN_QUERY_NEAREST 0u
#define HEWN_QUERY_RAY 1u  /* radius 0 */
#define HEWN_QUERY_BALL 2u /* a ball that moves */

/* A question is ten words: from, begin, along (unit), end, radius, and which of the above it is. An answer is ten
 * words: low, high, point, normal, and flags. */
#define HEWN_QUESTION_WORDS 10u
#define HEWN_ANSWER_WORDS 10u

#define HEWN_ANSWER_INSIDE 1u
#define HEWN_ANSWER_RAN_OUT 2u

/* Halvings of the box, at most. */
#define HEWN_QUERY_LEVELS 20u

/* Loops that the questions of a subgroup may run through, all together: CPU drivers end loops after 65,535 and say
 * nothing. */
#define HEWN_QUERY_STEPS 60000u

struct hewn_query_push {
    HEWN_FLOATS questions;
    HEWN_FLOATS answers;
    float lo[3], hi[3];
    float tolerance;
    float fine;           /* shorter than this nothing is told apart */
    float steepness;      /* no slope in the box is more; 0: unknown */
    float wide_steepness; /* with room around it, in the box that follows */
    float wide_lo[3], wide_hi[3];
    HEWN_UINT count;
    HEWN_UINT levels;
    HEWN_UINT most_steps;
};

#endif
