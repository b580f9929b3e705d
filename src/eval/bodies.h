/* How the steps of a listing are gathered into the bodies of instructions, and their text. Private to this room. */
#ifndef HEWN_SRC_EVAL_BODIES_H
#define HEWN_SRC_EVAL_BODIES_H

#include "eval/instructions.h"

#define HEWN_NO_STEP 0xFFFFFFFFu

/* The body whose last step is this one. */
typedef struct hewn_gathering {
    uint32_t inputs[HEWN_BODY_INPUTS]; /* steps whose values come from slots */
    uint8_t input_count;
    uint8_t step_count;
    uint8_t number_count;
    uint8_t absorbed; /* bit k: operand k is part of the body */
    bool owns;        /* the step's value stands in a slot */
    bool prunable;
    uint32_t uses;
} hewn_gathering;

/* One a step; owned by the caller (hewn_free). */
hewn_result hewn_bodies_gather(const hewn_listing *listing, hewn_gathering **out, hewn_error *error);

/* Whether the step can be part of whatever uses it: a variable, a number, or a body that few would want twice. */
bool hewn_body_absorbable(const hewn_listing *listing, const hewn_gathering *gathered, uint32_t step);

uint32_t hewn_body_weight(const hewn_listing *listing, const hewn_gathering *gathered, uint32_t step);

/* What stands before the result of a body that is given under a root, with what is added to that. */
#define HEWN_BODY_ROOT "f_rooted("

/* The body in three flavours (appended), and its numbers. Of a shape in a turned frame bounds are those about the
 * middle of the box, from how steep it can be at most: of intervals of turned coordinates no more would come, and at a
 * multiple of the cost. */
void hewn_body_write(const hewn_listing *listing, const hewn_gathering *gathered, uint32_t step, hewn_text texts[3],
                     float numbers[HEWN_BODY_NUMBERS], uint32_t *number_count);

#endif
