/* Integers wide enough to hold the determinant of any finite doubles: the predicates' last resort, where a product
 * would overflow or lose bits below the smallest double. Internal to the predicates. */
#ifndef HEWN_SRC_GEOM_WIDE_H
#define HEWN_SRC_GEOM_WIDE_H

#include <stdint.h>

/* A double is a multiple of 2^-1074 below 2^1024, so 2098 bits; a product of three differences has 6297, and six of
 * those are summed. */
enum { HEWN_WIDE_LIMBS = 200 };

typedef struct hewn_wide {
    int sign;  /* -1, 0 or 1 */
    int count; /* limbs in use, the last one not 0 */
    uint32_t limb[HEWN_WIDE_LIMBS];
} hewn_wide;

/* value × 2^1074; the value must be finite. */
void hewn_wide_set(hewn_wide *out, double value);

/* out = a - b and out = a × b; `out` is neither operand. */
void hewn_wide_subtract(const hewn_wide *a, const hewn_wide *b, hewn_wide *out);
void hewn_wide_multiply(const hewn_wide *a, const hewn_wide *b, hewn_wide *out);

#endif
