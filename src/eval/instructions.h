/* A field as a list of instructions, which can be cut down to what matters in a box.
 *
 * An instruction computes  out = combine(a, body(x, y, z, b, c, d))  on slots, which hold values. Bodies are small
 * expressions; those that differ in their numbers only are one kind, and interpreters have code for each kind. What can
 * be dropped in places (min, max and the blends) is a combination and never part of a body. */
#ifndef HEWN_SRC_EVAL_INSTRUCTIONS_H
#define HEWN_SRC_EVAL_INSTRUCTIONS_H

#include "eval/listing.h"

enum {
    HEWN_BODIES_MAX = 32,
    HEWN_COMBINATIONS_MAX = 15,
    HEWN_SLOTS_MAX = 15,
    HEWN_NO_SLOT = 15,
    HEWN_TOGETHER_MOST = 8,       /* invocations that read an instruction together; its length is a multiple */
    HEWN_BODY_STEPS = 16,         /* of one body */
    HEWN_BODY_INPUTS = 3,         /* slots that a body reads */
    HEWN_BODY_NUMBERS = 21,       /* of one body */
    HEWN_SLOPE_NUMBERS = 3,       /* of these, for shapes in frames */
    HEWN_INSTRUCTIONS_MAX = 30000 /* an invocation walks over all of them; CPU drivers bound its iterations */
};

/* A kind of body: `HEWN_TYPE body_N(x, y, z, b, c, d, q0, ...)` in each flavour. Body 0 copies b. */
typedef struct hewn_body {
    hewn_text texts[3]; /* what stands between its braces: point, interval, gradient */
    uint32_t numbers;
    uint32_t inputs; /* slots it reads */
    uint32_t weight; /* see hewn_listing_weight() */
} hewn_body;

/* Combination i + 1; 0 is none: the body's value alone. */
typedef struct hewn_combination {
    hewn_op op;
    const char *function;
    bool swapped; /* the body's value is the first operand */
    bool guarded; /* intervals may not be finite */
    uint32_t weight;
} hewn_combination;

/* A list has an entry of two words for each instruction: its head (body 8 bits, combination 4, out, a, b, c, d 4 each),
 * and where its numbers stand, which all lists share: two of the blend where the set has any, then the body's. */
typedef struct hewn_instruction_set {
    hewn_body bodies[HEWN_BODIES_MAX];
    uint32_t body_count;
    hewn_combination combinations[HEWN_COMBINATIONS_MAX];
    uint32_t combination_count;
    bool blends;
    uint32_t words; /* numbers of an instruction */
    uint32_t slots;
} hewn_instruction_set;

typedef struct hewn_instructions {
    hewn_instruction_set set;
    uint32_t *entries; /* of the whole field */
    uint32_t *words;
    uint32_t count;
    uint32_t prunable; /* instructions that combine */
} hewn_instructions;

/* `*fits` is false, and `out` empty, where the field has too many kinds or instructions, or needs too many slots. With
 * `known` (or NULL) only its kinds, slots and words are used, so that code made for it stays. */
hewn_result hewn_instructions_create(hewn_instructions *out, const hewn_listing *listing,
                                     const hewn_instruction_set *known, bool *fits, hewn_error *error);
void hewn_instructions_destroy(hewn_instructions *instructions);

/* How a device is best served. */
typedef struct hewn_walking {
    bool masked;       /* it runs every arm of a condition anyway */
    bool whole;        /* nothing is pruned */
    uint32_t together; /* invocations that read an instruction together, 0: each reads all of it */
} hewn_walking;

/* Where the instructions are, and field_select(). */
void hewn_instruction_set_declare(const hewn_instruction_set *set, const hewn_walking *how, hewn_text *text);

/* Appends the functions that `flavours` asks for; the library must precede, and the declarations that. */
void hewn_instruction_set_write(const hewn_instruction_set *set, const hewn_walking *how, uint32_t flavours,
                                hewn_text *text);

#endif
