#include "noise.h"

#include <math.h>

static uint32_t mixed(uint32_t x, uint32_t y, uint32_t z, uint32_t seed)
{
    uint32_t h = x * 0x9e3779b1u;
    h += y * 0x94d049bbu;
    h += z * 0xd1b54a33u;
    h += seed * 0x7f4a7c15u;
    h = (h ^ h >> 16) * 0x7feb352du;
    h = (h ^ h >> 15) * 0x846ca68bu;
    return h ^ h >> 16;
}

static float within(float a)
{
    return fminf(fmaxf(a, -0x1p24f), 0x1p24f);
}

static float dot(uint32_t h, float x, float y, float z)
{
    float first = h >> 8 & 1 ? -1.0f : 1.0f, second = h >> 9 & 1 ? -1.0f : 1.0f;
    switch (h % 3) {
    case 0: return 0.0f * x + first * y + second * z;
    case 1: return first * x + 0.0f * y + second * z;
    default: return first * x + second * y + 0.0f * z;
    }
}

static float mix(float a, float b, float weight)
{
    return a + weight * (b - a);
}

static float fade(float f)
{
    return f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
}

static float cube(int kind, float x, float y, float z, uint32_t seed)
{
    float whole[3] = {floorf(within(x)), floorf(within(y)), floorf(within(z))};
    float at[3] = {within(x) - whole[0], within(y) - whole[1], within(z) - whole[2]}, corner[8];
    for (uint32_t c = 0; c < 8; c++) {
        uint32_t off[3] = {c & 1, c >> 1 & 1, c >> 2}, cell[3];
        for (int i = 0; i < 3; i++)
            cell[i] = (uint32_t)(int32_t)whole[i] + off[i];
        uint32_t h = mixed(cell[0], cell[1], cell[2], seed);
        corner[c] = kind == ORACLE_NOISE_VALUE
                        ? (float)(h >> 8) * 0x1p-23f - 1.0f
                        : dot(h, at[0] - (float)off[0], at[1] - (float)off[1], at[2] - (float)off[2]);
    }
    float wx = fade(at[0]), wy = fade(at[1]), wz = fade(at[2]), square[4];
    for (int i = 0; i < 4; i++)
        square[i] = mix(corner[i], corner[4 + i], wz);
    float result = mix(mix(square[0], square[2], wy), mix(square[1], square[3], wy), wx);
    return kind == ORACLE_NOISE_VALUE ? result : result * 0.96f;
}

static float from_corner(const float *d, const uint32_t *cell, uint32_t seed)
{
    float rest = 0.5f - d[0] * d[0] - d[1] * d[1] - d[2] * d[2];
    if (!(rest > 0))
        rest = 0;
    float three = rest * rest * rest;
    return three * rest * dot(mixed(cell[0], cell[1], cell[2], seed), d[0], d[1], d[2]);
}

static float simplex(const float *p, uint32_t seed)
{
    float skew = (p[0] + p[1] + p[2]) * 0.333333343f, whole[3], d[3], sum = 0;
    for (int i = 0; i < 3; i++)
        whole[i] = floorf(p[i] + skew);
    float back = (whole[0] + whole[1] + whole[2]) * 0.166666672f;
    for (int i = 0; i < 3; i++)
        d[i] = (p[i] - whole[i]) + back;
    /* Coordinates from the largest to the least; the later of two equal ones goes last. */
    int order[3] = {0, 1, 2};
    for (int i = 1; i < 3; i++)
        for (int k = i; k > 0 && d[order[k]] > d[order[k - 1]]; k--) {
            int swapped = order[k];
            order[k] = order[k - 1];
            order[k - 1] = swapped;
        }
    static const float shifts[4] = {0.0f, 0.166666672f, 0.333333343f, 0.0f};
    uint32_t cell[3];
    float off[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        cell[i] = (uint32_t)(int32_t)whole[i];
    for (int c = 0; c < 4; c++) {
        float e[3];
        for (int i = 0; i < 3; i++)
            e[i] = c == 3 ? d[i] - 0.5f : (d[i] - off[i]) + shifts[c];
        float part = from_corner(e, cell, seed);
        sum = c == 0 ? part : sum + part;
        if (c < 3) {
            off[order[c]] = 1;
            cell[order[c]]++;
        }
    }
    return sum * 76.0f;
}

static float cellular(const float *p, uint32_t seed)
{
    float best = 1;
    for (int z = -1; z <= 1; z++)
        for (int y = -1; y <= 1; y++)
            for (int x = -1; x <= 1; x++) {
                const int off[3] = {x, y, z};
                uint32_t cell[3];
                float square = 0;
                for (int i = 0; i < 3; i++)
                    cell[i] = (uint32_t)((int32_t)floorf(p[i]) + off[i]);
                uint32_t h = mixed(cell[0], cell[1], cell[2], seed);
                for (int i = 0; i < 3; i++) {
                    float jitter = ((float)(h >> 10 * i & 1023u) + 0.5f) * 0x1p-10f;
                    float d = ((p[i] - floorf(p[i])) - (float)off[i]) - jitter;
                    square = i == 0 ? d * d : square + d * d;
                }
                best = square < best ? square : best;
            }
    return best;
}

float oracle_noise(int kind, float x, float y, float z, uint32_t seed)
{
    const float p[3] = {within(x), within(y), within(z)};
    switch (kind) {
    case ORACLE_NOISE_SIMPLEX: return simplex(p, seed);
    case ORACLE_NOISE_CELLULAR: return cellular(p, seed);
    default: return cube(kind, x, y, z, seed);
    }
}
