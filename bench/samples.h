/* Timings of runs, and what is told of them. */
#ifndef HEWN_BENCH_SAMPLES_H
#define HEWN_BENCH_SAMPLES_H

#include <stdlib.h>
#include <string.h>

enum { MOST_RUNS = 99 };

static inline int bench_by_value(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;
    return (left > right) - (left < right);
}

/* Of 1 to MOST_RUNS values. */
static inline double bench_median(const double *values, int count)
{
    double sorted[MOST_RUNS];
    memcpy(sorted, values, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, bench_by_value);
    return count % 2 ? sorted[count / 2] : 0.5 * (sorted[count / 2 - 1] + sorted[count / 2]);
}

#endif
