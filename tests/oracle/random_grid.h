/* Random samples with a positive border, for properties that must hold of any values. */
#ifndef HEWN_TESTS_ORACLE_RANDOM_GRID_H
#define HEWN_TESTS_ORACLE_RANDOM_GRID_H

#include <stdint.h>

typedef enum random_kind {
    RANDOM_UNIFORM,  /* in (-1, 1), 24 bits */
    RANDOM_NORMAL,   /* mean 0, deviation 1, as floats */
    RANDOM_INTEGERS, /* -3 to 3: many ties and zeros, saddles at 0 */
    RANDOM_AT_ISO,   /* uniform, but about a third of the values is exactly 0 */
    RANDOM_KINDS
} random_kind;

extern const char *const random_kind_names[RANDOM_KINDS];

/* A number below `limit`; the state must not be 0. */
uint32_t random_below(uint64_t *state, uint32_t limit);

double random_value(uint64_t *state, random_kind kind);

/* n^3 floats, x fastest, positive on the border. */
void random_grid(uint64_t seed, random_kind kind, uint32_t n, double *values);

#endif
