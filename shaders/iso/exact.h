/* GLSL only: products and sums with twice a float's digits, as pairs (high, low). Exact for products of two floats and
 * wherever a result fits, as it does for small integers; to 2^-44 of the operands else. Knuth's sum, Dekker's product.
 */
#ifndef HEWN_SHADERS_ISO_EXACT_H
#define HEWN_SHADERS_ISO_EXACT_H

precise vec2 exact_sum(const float a, const float b)
{
    precise float sum = a + b;
    precise float from_b = sum - a;
    precise float from_a = sum - from_b;
    precise float low = (a - from_a) + (b - from_b);
    return vec2(sum, low);
}

precise vec2 exact_product(const float a, const float b)
{
    precise float product = a * b;
    precise float scaled_a = 4097.0 * a, scaled_b = 4097.0 * b;
    precise float a_high = scaled_a - (scaled_a - a), b_high = scaled_b - (scaled_b - b);
    precise float a_low = a - a_high, b_low = b - b_high;
    precise float low = a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low);
    return vec2(product, low);
}

precise vec2 pair_sum(const vec2 a, const vec2 b)
{
    precise vec2 high = exact_sum(a.x, b.x), low = exact_sum(a.y, b.y);
    precise float middle = high.y + low.x;
    precise vec2 sum = exact_sum(high.x, middle);
    precise float rest = sum.y + low.y;
    return exact_sum(sum.x, rest);
}

precise vec2 pair_product(const vec2 a, const vec2 b)
{
    precise vec2 product = exact_product(a.x, b.x);
    precise float cross_terms = a.x * b.y + a.y * b.x;
    precise float low = product.y + cross_terms;
    return exact_sum(product.x, low);
}

/* a b - c d */
precise vec2 pair_minor(const vec2 a, const vec2 b, const vec2 c, const vec2 d)
{
    return pair_sum(pair_product(a, b), -pair_product(c, d));
}

float pair_sign(const vec2 a)
{
    return sign(a.x != 0.0 ? a.x : a.y);
}

/* The power of two that takes a magnitude to between 1 and 2, within what floats can hold. */
float power_to_one(const float magnitude)
{
    int exponent = clamp((floatBitsToInt(magnitude) >> 23 & 255) - 127, -126, 126);
    return intBitsToFloat((127 - exponent) << 23);
}

#endif
