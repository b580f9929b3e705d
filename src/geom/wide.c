#include "geom/wide.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

static void trim(hewn_wide *out)
{
    while (out->count > 0 && out->limb[out->count - 1] == 0)
        out->count--;
    if (out->count == 0)
        out->sign = 0;
}

void hewn_wide_set(hewn_wide *out, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    uint64_t exponent = bits >> 52 & 0x7ff, mantissa = bits & 0xfffffffffffffu;
    assert(exponent < 0x7ff);
    uint64_t shift = 0;
    if (exponent > 0) {
        mantissa |= 0x10000000000000u;
        shift = exponent - 1;
    }
    int first = (int)(shift / 32);
    memset(out->limb, 0, sizeof out->limb[0] * (size_t)first);
    int bits_up = (int)(shift % 32);
    uint64_t low = (mantissa & 0xffffffffu) << bits_up, high = (mantissa >> 32 << bits_up) + (low >> 32);
    out->limb[first] = (uint32_t)low;
    out->limb[first + 1] = (uint32_t)high;
    out->limb[first + 2] = (uint32_t)(high >> 32);
    out->count = first + 3;
    out->sign = bits >> 63 ? -1 : 1;
    trim(out);
}

static int compare_sizes(const hewn_wide *a, const hewn_wide *b)
{
    if (a->count != b->count)
        return a->count < b->count ? -1 : 1;
    for (int i = a->count - 1; i >= 0; i--)
        if (a->limb[i] != b->limb[i])
            return a->limb[i] < b->limb[i] ? -1 : 1;
    return 0;
}

/* |a| + |b|, where |a| >= |b|. */
static void add_sizes(const hewn_wide *a, const hewn_wide *b, hewn_wide *out)
{
    uint64_t carry = 0;
    for (int i = 0; i < a->count; i++) {
        carry += (uint64_t)a->limb[i] + (i < b->count ? b->limb[i] : 0);
        out->limb[i] = (uint32_t)carry;
        carry >>= 32;
    }
    out->count = a->count;
    if (carry > 0) {
        assert(out->count < HEWN_WIDE_LIMBS);
        out->limb[out->count++] = (uint32_t)carry;
    }
}

/* |a| - |b|, where |a| >= |b|. */
static void subtract_sizes(const hewn_wide *a, const hewn_wide *b, hewn_wide *out)
{
    uint64_t borrow = 0;
    for (int i = 0; i < a->count; i++) {
        uint64_t take = (i < b->count ? b->limb[i] : 0) + borrow;
        borrow = a->limb[i] < take;
        out->limb[i] = (uint32_t)(a->limb[i] - take);
    }
    out->count = a->count;
}

void hewn_wide_subtract(const hewn_wide *a, const hewn_wide *b, hewn_wide *out)
{
    bool swapped = compare_sizes(a, b) < 0;
    const hewn_wide *large = swapped ? b : a, *small = swapped ? a : b;
    out->sign = swapped ? -b->sign : a->sign;
    if (a->sign * b->sign < 0)
        add_sizes(large, small, out);
    else
        subtract_sizes(large, small, out);
    trim(out);
}

void hewn_wide_multiply(const hewn_wide *a, const hewn_wide *b, hewn_wide *out)
{
    out->count = a->count + b->count;
    out->sign = a->sign * b->sign;
    assert(out->count <= HEWN_WIDE_LIMBS);
    memset(out->limb, 0, sizeof out->limb[0] * (size_t)out->count);
    for (int i = 0; i < a->count; i++) {
        uint64_t carry = 0;
        for (int j = 0; j < b->count; j++) {
            carry += (uint64_t)a->limb[i] * b->limb[j] + out->limb[i + j];
            out->limb[i + j] = (uint32_t)carry;
            carry >>= 32;
        }
        out->limb[i + b->count] = (uint32_t)carry;
    }
    trim(out);
}
