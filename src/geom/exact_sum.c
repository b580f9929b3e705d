#include "geom/exact_sum.h"

#include <math.h>
#include <stdbool.h>

/* Digits but the last come to lie from 0 to 2^32 - 1; the last has the sign. */
void hewn_exact_sum_settle(hewn_exact_sum *sum)
{
    for (int i = 0; i + 1 < HEWN_EXACT_DIGITS; i++) {
        int64_t low = sum->digits[i] & 0xFFFFFFFF;
        sum->digits[i + 1] += (sum->digits[i] - low) / ((int64_t)1 << 32);
        sum->digits[i] = low;
    }
}

void hewn_exact_sum_join(hewn_exact_sum *sum, hewn_exact_sum *other)
{
    hewn_exact_sum_settle(sum);
    hewn_exact_sum_settle(other);
    for (int i = 0; i < HEWN_EXACT_DIGITS; i++)
        sum->digits[i] += other->digits[i];
    sum->endless += other->endless;
    hewn_exact_sum_settle(sum);
}

/* From the highest digit that is not 0, four of them: more than a double holds. */
double hewn_exact_sum_value(hewn_exact_sum *sum)
{
    hewn_exact_sum magnitude = *sum;
    hewn_exact_sum_settle(&magnitude);
    bool negative = magnitude.digits[HEWN_EXACT_DIGITS - 1] < 0;
    if (sum->endless != 0)
        return sum->endless;
    for (int i = 0; i < HEWN_EXACT_DIGITS && negative; i++)
        magnitude.digits[i] = -magnitude.digits[i];
    hewn_exact_sum_settle(&magnitude);
    int top = HEWN_EXACT_DIGITS - 1;
    while (top > 0 && magnitude.digits[top] == 0)
        top--;
    double value = 0;
    for (int i = top; i >= 0 && i > top - 4; i--)
        value += ldexp((double)magnitude.digits[i], 32 * i - 1074);
    return negative ? -value : value;
}
