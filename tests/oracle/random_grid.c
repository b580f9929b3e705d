#include "random_grid.h"

#include <math.h>
#include <stdbool.h>

const char *const random_kind_names[RANDOM_KINDS] = {"uniform", "normal", "small integers", "many at the iso value"};

/* Marsaglia's xorshift with a multiplier (Vigna 2016). */
static uint32_t next_bits(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (uint32_t)(*state * UINT64_C(2685821657736338717) >> 32);
}

uint32_t random_below(uint64_t *state, uint32_t limit)
{
    return (uint32_t)((uint64_t)next_bits(state) * limit >> 32);
}

static double uniform(uint64_t *state)
{
    return ((double)random_below(state, 1u << 24) + 0.5) / (1 << 23) - 1;
}

double random_value(uint64_t *state, random_kind kind)
{
    switch (kind) {
    case RANDOM_NORMAL: {
        double a = uniform(state) / 2 + 0.5, b = uniform(state);
        return (double)(float)(sqrt(-2 * log(a)) * cos(3.14159265358979323846 * b));
    }
    case RANDOM_INTEGERS: return (double)random_below(state, 7) - 3;
    case RANDOM_AT_ISO: return random_below(state, 3) == 0 ? 0 : (double)(float)uniform(state);
    default: return (double)(float)uniform(state);
    }
}

void random_grid(uint64_t seed, random_kind kind, uint32_t n, double *values)
{
    uint64_t state = seed * UINT64_C(0x9E3779B97F4A7C15) + 1;
    for (int warm = 0; warm < 4; warm++)
        (void)next_bits(&state);
    for (uint32_t i = 0; i < n * n * n; i++) {
        uint32_t at[3] = {i % n, i / n % n, i / n / n};
        bool border = false;
        for (int axis = 0; axis < 3; axis++)
            border |= at[axis] == 0 || at[axis] == n - 1;
        double value = random_value(&state, kind);
        values[i] = border ? fabs(value) + 0.25 : value;
    }
}
