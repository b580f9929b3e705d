/* Expansions: exact sums of doubles, as arrays of parts that do not overlap, smallest first and without zeros. Internal
 * to the predicates. After Shewchuk 1997, 'Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
 * Predicates'; the error-free sum is Knuth's, the error-free product Dekker's and Veltkamp's.
 *
 * Exact while nothing overflows and every product's last bit is at least 2^-1074. Needs rounding to nearest even. */
#ifndef HEWN_SRC_GEOM_EXPANSION_H
#define HEWN_SRC_GEOM_EXPANSION_H

#include <math.h>

/* a + b = result + *low. */
static inline double hewn_two_sum(double a, double b, double *low)
{
    double sum = a + b, from_b = sum - a, from_a = sum - from_b;
    *low = (a - from_a) + (b - from_b);
    return sum;
}

/* a - b = result + *low. */
static inline double hewn_two_difference(double a, double b, double *low)
{
    return hewn_two_sum(a, -b, low);
}

/* a into 26 and 26 bits and a sign: a = result + *low. */
static inline double hewn_halve_bits(double a, double *low)
{
    double scaled = 0x1.0000002p27 * a, high = scaled - (scaled - a);
    *low = a - high;
    return high;
}

/* a × b = result + *low. */
static inline double hewn_two_product(double a, double b, double *low)
{
    double product = a * b, a_low, b_low;
    double a_high = hewn_halve_bits(a, &a_low), b_high = hewn_halve_bits(b, &b_low);
    *low = a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low);
    return product;
}

static inline int hewn_expansion_drop_zeros(double *parts, int count)
{
    int kept = 0;
    for (int i = 0; i < count; i++)
        if (parts[i] != 0)
            parts[kept++] = parts[i];
    return kept;
}

/* sum = a + b, m + n parts at most; returns how many. Shewchuk's EXPANSION-SUM: slow, but parts that are not even
 * adjacent stay so (his theorem 12), which scaling asks for. */
static inline int hewn_expansion_add(int m, const double *a, int n, const double *b, double *sum)
{
    for (int i = 0; i < m; i++)
        sum[i] = a[i];
    for (int j = 0; j < n; j++) {
        double carry = b[j];
        for (int i = j; i < m + j; i++)
            carry = hewn_two_sum(carry, sum[i], &sum[i]);
        sum[m + j] = carry;
    }
    return hewn_expansion_drop_zeros(sum, m + n);
}

/* The same in linear time, by merging (FAST-EXPANSION-SUM, theorem 13). The result may be added on, but not scaled. */
static inline int hewn_expansion_merge(int m, const double *a, int n, const double *b, double *sum)
{
    int i = 0, j = 0, count = 0;
    double carry = 0;
    while (i < m || j < n) {
        double next = j == n || (i < m && fabs(a[i]) < fabs(b[j])) ? a[i++] : b[j++], low;
        carry = hewn_two_sum(carry, next, &low);
        if (low != 0)
            sum[count++] = low;
    }
    if (carry != 0)
        sum[count++] = carry;
    return count;
}

/* product = a × factor, 2n parts at most; returns how many (SCALE-EXPANSION, theorem 19). */
static inline int hewn_expansion_scale(int n, const double *a, double factor, double *product)
{
    int count = 0;
    double carry = 0;
    for (int i = 0; i < n; i++) {
        double low, part, high = hewn_two_product(a[i], factor, &low);
        carry = hewn_two_sum(carry, low, &part);
        if (part != 0)
            product[count++] = part;
        carry = hewn_two_sum(high, carry, &part);
        if (part != 0)
            product[count++] = part;
    }
    if (carry != 0)
        product[count++] = carry;
    return count;
}

/* The largest part has the sign of the whole. */
static inline int hewn_expansion_sign(int n, const double *a)
{
    return n == 0 ? 0 : (a[n - 1] > 0) - (a[n - 1] < 0);
}

#endif
