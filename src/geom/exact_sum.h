/* Sums of doubles without rounding: any order of the terms, and any number of threads, gives the same bits. After Neal
 * 2015 ('Fast exact summation using small and large superaccumulators'). */
#ifndef HEWN_SRC_GEOM_EXACT_SUM_H
#define HEWN_SRC_GEOM_EXACT_SUM_H

#include <stdint.h>
#include <string.h>

/* Digit i counts 2^(32 i - 1074). Digits are kept apart, and carried on only when hewn_exact_sum_settle() is called:
 * at least after every 1.5 * 2^30 terms. Zero is the sum of nothing. */
enum { HEWN_EXACT_DIGITS = 68 };

typedef struct hewn_exact_sum {
    int64_t digits[HEWN_EXACT_DIGITS];
    double endless; /* the sum of terms that are not finite */
} hewn_exact_sum;

static inline void hewn_exact_sum_add(hewn_exact_sum *sum, double term)
{
    uint64_t bits;
    memcpy(&bits, &term, sizeof bits);
    uint64_t exponent = bits >> 52 & 2047, fraction = bits & (((uint64_t)1 << 52) - 1);
    if (exponent == 2047) {
        sum->endless += term;
        return;
    }
    fraction |= (uint64_t)(exponent != 0) << 52;
    uint64_t place = exponent - (exponent != 0), shift = place % 32;
    int64_t *digit = sum->digits + place / 32;
    uint64_t low = fraction << shift, high = shift == 0 ? 0 : fraction >> (64 - shift);
    int64_t sign = (int64_t)bits >> 63; /* -1 for a negative term */
    digit[0] += ((int64_t)(low & 0xFFFFFFFFu) ^ sign) - sign;
    digit[1] += ((int64_t)(low >> 32) ^ sign) - sign;
    digit[2] += ((int64_t)high ^ sign) - sign;
}

/* Carries, so that there is room for further terms. */
void hewn_exact_sum_settle(hewn_exact_sum *sum);

/* Adds another sum; both are settled after that. */
void hewn_exact_sum_join(hewn_exact_sum *sum, hewn_exact_sum *other);

/* The sum as a double: within one unit of its last place, and a function of the exact sum. */
double hewn_exact_sum_value(hewn_exact_sum *sum);

#endif
