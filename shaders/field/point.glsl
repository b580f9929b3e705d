/* Operations on values: float in, float out. The other flavours take their values from here, so that every kernel
 * computes the same bits. A block runs from one marker (slashes, colon, its name, the blocks it needs) to the next, and
 * only the blocks that a field uses are compiled. Parameters are const, which passes values instead of variables.
 * Errors are tabled in docs/evaluation.md. */
//: core
/* True; see listing.c for what it keeps apart. */
layout(constant_id = 2000) const bool f_always = true;
#define F_INF uintBitsToFloat(0x7f800000u)
#define F_NAN uintBitsToFloat(0x7fc00000u)

/* On the bits, because a driver may take it for granted that no float is NaN. */
bool f_is_nan(const float a)
{
    return (floatBitsToInt(a) & 0x7fffffff) > 0x7f800000;
}

bool f_is_nan(const float a, const float b)
{
    return max(floatBitsToInt(a) & 0x7fffffff, floatBitsToInt(b) & 0x7fffffff) > 0x7f800000;
}

/* A selection, never a branch. */
float f_pick(const bool condition, const float yes, const float no)
{
    return mix(no, yes, condition);
}

/* max(a, 0) that lets NaN through: as integers, negative numbers (NaN apart) are those up to the bits of -inf. */
float f_positive(const float a)
{
    return f_pick(floatBitsToInt(a) <= -0x800000, 0.0, a);
}

float f_copy_sign(const float magnitude, const float sign)
{
    return intBitsToFloat(floatBitsToInt(magnitude) | (floatBitsToInt(sign) & int(0x80000000u)));
}

//: length
precise float f_length(const float a, const float b)
{
    precise float sum = a * a + b * b;
    return sqrt(sum);
}

precise float f_length(const float a, const float b, const float c)
{
    precise float sum = a * a + b * b + c * c;
    return sqrt(sum);
}

//: neg
float f_neg(const float a)
{
    return -a;
}

//: abs
float f_abs(const float a)
{
    return abs(a);
}

//: sqrt
float f_sqrt(const float a)
{
    return sqrt(a);
}

//: square
precise float f_square(const float a)
{
    precise float r = a * a;
    return r;
}

//: wave
/* x less the nearest multiple `quarter` of pi/2, for Cody and Waite's reduction with pi/2 in five pieces. The first
 * four have 11 bits each, so that their products are exact while quarter has 13 bits. Past that the rest loses its
 * meaning and is only kept small. */
precise float f_reduce(const float x, out float quarter)
{
    precise float k = floor(x * 0.636619747 + 0.5);
    precise float r = x - k * 1.5703125;
    r = r - k * 0.000483751297;
    r = r - k * 7.54953362e-08;
    r = r - k * 2.563282919e-12;
    r = r - k * 6.123234263e-17;
    precise float turns = floor(k * 0.25), rest = k - 4.0 * turns;
    quarter = rest;
    return f_pick(r > 0.7875, 0.7875, f_pick(r < -0.7875, -0.7875, r));
}

precise float f_sine_near_0(const float r)
{
    precise float z = r * r;
    precise float s = ((-0.00019517896 * z + 0.00833218731) * z - 0.166666552) * z;
    precise float result = r + r * s;
    return result;
}

precise float f_cosine_near_0(const float r)
{
    precise float z = r * r;
    precise float s = ((2.44323273e-05 * z - 0.00138873095) * z + 0.0416666456) * z;
    precise float result = 1.0 - (0.5 * z - z * s);
    return result;
}

bool f_is_endless(const float a)
{
    return (floatBitsToInt(a) & 0x7fffffff) >= 0x7f800000;
}

//: sin wave
precise float f_sin(const float a)
{
    float quarter;
    precise float r = f_reduce(a, quarter);
    int q = int(quarter);
    float v = f_pick((q & 1) != 0, f_cosine_near_0(r), f_sine_near_0(r));
    return f_pick(f_is_endless(a), F_NAN, f_pick(q >= 2, -v, v));
}

//: cos wave
precise float f_cos(const float a)
{
    float quarter;
    precise float r = f_reduce(a, quarter);
    int q = int(quarter);
    float v = f_pick((q & 1) != 0, f_sine_near_0(r), f_cosine_near_0(r));
    return f_pick(f_is_endless(a), F_NAN, f_pick(q == 1 || q == 2, -v, v));
}

//: tan wave
precise float f_tan(const float a)
{
    float quarter;
    precise float r = f_reduce(a, quarter);
    precise float s = f_sine_near_0(r), c = f_cosine_near_0(r);
    bool odd = (int(quarter) & 1) != 0;
    precise float result = f_pick(odd, -c, s) / f_pick(odd, s, c);
    return f_pick(f_is_endless(a), F_NAN, result);
}

//: arcsine
/* A square root to an ulp whatever the driver's is worth: one step of Newton's from a remainder without rounding. */
precise float f_root(const float z)
{
    precise float s = sqrt(z);
    precise float hi = intBitsToFloat(floatBitsToInt(s) & int(0xfffff000u));
    precise float lo = s - hi;
    precise float rest = ((z - hi * hi) - 2.0 * (hi * lo)) - lo * lo;
    precise float better = s + 0.5 * (rest / s);
    return f_pick(s > 0.0, better, s);
}

/* asin of s in [-1/2, 1/2] from s and s^2 */
precise float f_arcsine_near_0(const float s, const float z)
{
    precise float p = (((0.0421664417 * z + 0.0241807681) * z + 0.0454697721) * z + 0.0749530643) * z + 0.166667521;
    precise float result = s + s * (z * p);
    return result;
}

//: asin arcsine
precise float f_asin(const float a)
{
    float m = abs(a);
    bool far = m > 0.5;
    precise float half_rest = (1.0 - m) * 0.5, squared = m * m;
    float z = f_pick(far, half_rest, squared);
    precise float p = f_arcsine_near_0(f_pick(far, f_root(abs(half_rest)), m), z);
    precise float steep = (1.57079625 - 2.0 * p) + 7.54979013e-08;
    float result = f_copy_sign(f_pick(far, steep, p), a);
    return f_pick(m > 1.0, F_NAN, result);
}

//: acos arcsine
precise float f_acos(const float a)
{
    float m = abs(a);
    bool far = m > 0.5;
    precise float half_rest = (1.0 - m) * 0.5, squared = m * m;
    float z = f_pick(far, half_rest, squared);
    precise float p = f_arcsine_near_0(f_pick(far, f_root(abs(half_rest)), a), z);
    precise float middle = 1.57079625 - (p - 7.54979013e-08);
    precise float twice = 2.0 * p;
    precise float left = 3.1415925 - (twice - 1.50995803e-07);
    return f_pick(m > 1.0, F_NAN, f_pick(far, f_pick(a < 0.0, left, twice), middle));
}

//: arctangent
/* atan of t in [0, 1] */
precise float f_arctangent_to_1(const float t)
{
    precise float z = t * t;
    precise float p = (((-0.00178249995 * z + 0.0108676627) * z - 0.0310957283) * z + 0.0578806475) * z - 0.0839928538;
    p = (((p * z + 0.109508783) * z - 0.142640159) * z + 0.199985296) * z - 0.333332986;
    precise float result = t + t * (z * p);
    return result;
}

//: atan arctangent
precise float f_atan(const float a)
{
    float m = abs(a);
    bool far = m > 1.0;
    precise float inverse = 1.0 / f_pick(m > 1e30, 1e30, m);
    precise float p = f_arctangent_to_1(f_pick(far, inverse, m));
    precise float steep = (1.57079625 - p) + 7.54979013e-08;
    return f_copy_sign(f_pick(far, steep, p), a);
}

//: atan2 arctangent
precise float f_atan2(const float y, const float x)
{
    float m = abs(y), n = abs(x);
    bool steep = m > n;
    float less = f_pick(steep, n, m), more = f_pick(steep, m, n);
    /* division is only sure of its precision for divisors up to 2^126 */
    float scale = f_pick(more > 1e30, 1e-10, 1.0);
    precise float ratio = (less * scale) / (more * scale);
    ratio = f_pick(more == 0.0, 0.0, ratio);
    ratio = f_pick(f_is_nan(ratio), 1.0, ratio); /* both infinite */
    precise float p = f_arctangent_to_1(ratio);
    precise float up = (1.57079625 - p) + 7.54979013e-08;
    precise float r = f_pick(steep, up, p);
    precise float back = (3.1415925 - r) + 1.50995803e-07;
    float result = f_copy_sign(f_pick(floatBitsToInt(x) < 0, back, r), y);
    return f_pick(f_is_nan(y, x), F_NAN, result);
}

//: exp
precise float f_exp(const float a)
{
    float x = f_pick(a < -104.0, -104.0, f_pick(a > 89.0, 89.0, a));
    x = f_pick(f_is_nan(a), 0.0, x);
    precise float k = floor(x * 1.44269502 + 0.5);
    precise float r = (x - k * 0.693145752) - k * 1.42860677e-06;
    precise float p = (((0.0013838294 * r + 0.00836929865) * r + 0.0416680872) * r + 0.166665152) * r + 0.49999994;
    precise float y = 1.0 + (r + r * r * p);
    /* 2^k in two steps, neither of which leaves the range */
    int first = int(k) >> 1, second = int(k) - first;
    precise float result = (y * intBitsToFloat((first + 127) << 23)) * intBitsToFloat((second + 127) << 23);
    return f_pick(f_is_nan(a), a, f_pick(a < -104.0, 0.0, result));
}

//: ln
/* Denormal arguments count as zero, whatever the device does with them elsewhere. */
precise float f_ln(const float a)
{
    int bits = floatBitsToInt(a), magnitude = bits & 0x7fffffff;
    int exponent = (bits - 0x3f3504f3) >> 23; /* the fraction lies between sqrt(1/2) and sqrt(2) */
    precise float k = float(exponent);
    precise float f = intBitsToFloat(bits - (exponent << 23)) - 1.0;
    precise float p = (((0.0531719401 * f - 0.109038524) * f + 0.121121712) * f - 0.125521585) * f + 0.142094254;
    p = (((p * f - 0.166592136) * f + 0.20002225) * f - 0.250001699) * f + 0.333333135;
    precise float square = f * f;
    precise float tail = (square * f) * p + k * 1.42860677e-06;
    precise float result = (f + (tail - 0.5 * square)) + k * 0.693145752;
    result = f_pick(magnitude >= 0x7f800000, a, result);
    result = f_pick(bits < 0, F_NAN, result);
    return f_pick(magnitude < 0x00800000, -F_INF, result);
}

//: floor
float f_floor(const float a)
{
    return floor(a);
}

//: ceil
float f_ceil(const float a)
{
    return ceil(a);
}

//: round
precise float f_round(const float a)
{
    float m = abs(a);
    precise float whole = floor(m);
    precise float up = whole + 1.0;
    precise float rest = m - whole;
    return f_copy_sign(f_pick(rest >= 0.5, up, whole), a);
}

//: not
float f_not(const float a)
{
    return f_pick(a == 0.0, 1.0, 0.0);
}

//: add
precise float f_add(const float a, const float b)
{
    precise float r = a + b;
    return r;
}

//: sub
precise float f_sub(const float a, const float b)
{
    precise float r = a - b;
    return r;
}

//: mul
precise float f_mul(const float a, const float b)
{
    precise float r = a * b;
    return r;
}

//: div
precise float f_div(const float a, const float b)
{
    precise float r = a / b;
    return r;
}

//: min
float f_min(const float a, const float b)
{
    bool unknown = f_is_nan(b), less = b < a;
    return f_pick(less || unknown, b, a);
}

/* The same of what is no NaN, for half the price. */
float f_lesser(const float a, const float b)
{
    return f_pick(b < a, b, a);
}

//: max
float f_max(const float a, const float b)
{
    bool unknown = f_is_nan(b), more = b > a;
    return f_pick(more || unknown, b, a);
}

float f_greater(const float a, const float b)
{
    return f_pick(b > a, b, a);
}

//: mod
/* a - b floor(a/b) with an exact product (both factors split into halves), then put right where the quotient was just
 * off a whole number. Past |a/b| of 2^22 the result is only kept between 0 and |b|. */
precise float f_mod(const float a, const float b)
{
    float m = abs(b);
    precise float q = floor(a / m);
    precise float product = q * m;
    precise float q_hi = intBitsToFloat(floatBitsToInt(q) & int(0xfffff000u));
    precise float m_hi = intBitsToFloat(floatBitsToInt(m) & int(0xfffff000u));
    precise float q_lo = q - q_hi, m_lo = m - m_hi;
    precise float lost = ((q_hi * m_hi - product) + q_hi * m_lo + q_lo * m_hi) + q_lo * m_lo;
    precise float r = (a - product) - lost;
    precise float above = r + m, below = r - m;
    r = f_pick(r < 0.0, above, f_pick(r >= m, below, r));
    r = f_pick(r < 0.0, 0.0, f_pick(r > m, m, r));
    r = f_pick(f_is_nan(r), 0.0, r); /* the quotient overflowed */
    bool endless = m > 3.40282347e38;
    precise float shifted = a + m;
    r = f_pick(endless, f_pick(a < 0.0, shifted, a), r);
    bool bad = (floatBitsToInt(a) & 0x7fffffff) >= 0x7f800000, none = m == 0.0, unknown = f_is_nan(b);
    return f_pick(bad || none || unknown, F_NAN, r);
}

//: compare
float f_compare(const float a, const float b)
{
    return f_pick(f_is_nan(a, b), F_NAN, f_pick(a < b, -1.0, f_pick(a > b, 1.0, 0.0)));
}

//: and
float f_and(const float a, const float b)
{
    return f_pick(a == 0.0, a, b);
}

//: or
float f_or(const float a, const float b)
{
    return f_pick(a == 0.0, b, a);
}

//: shift
precise float f_shift(const float a, const float s)
{
    precise float r = a + s;
    return r;
}

//: affine
precise float f_affine(const float a, const float p, const float s)
{
    precise float sum = p * a + s;
    return sum;
}

precise float f_affine(const float a, const float b, const float p, const float q, const float s)
{
    precise float sum = p * a + q * b + s;
    return sum;
}

precise float f_affine(const float a, const float b, const float c, const float p, const float q, const float r,
                       const float s)
{
    precise float sum = p * a + q * b + r * c + s;
    return sum;
}

//: radicand length
/* A distance before its last two steps, a root and an addition: a walk over a list selects among kinds of shapes here,
 * and takes one root for all of them. */
struct f_radicand {
    float square, rest;
};

precise float f_rooted(const f_radicand of)
{
    precise float d = sqrt(of.square) + of.rest;
    return d;
}

precise f_radicand f_radicand_of(const float a, const float b, const float rest)
{
    precise f_radicand of;
    of.square = a * a + b * b;
    of.rest = rest;
    return of;
}

precise f_radicand f_radicand_of(const float a, const float b, const float c, const float rest)
{
    precise f_radicand of;
    of.square = a * a + b * b + c * c;
    of.rest = rest;
    return of;
}

//: sphere radicand
f_radicand f_sphere_radicand(const float a, const float b, const float c, const float radius)
{
    return f_radicand_of(a, b, c, -radius);
}

float f_sphere(const float a, const float b, const float c, const float radius)
{
    return f_rooted(f_sphere_radicand(a, b, c, radius));
}

//: box radicand
precise f_radicand f_box_radicand(const float a, const float b, const float c, const float p, const float q,
                                  const float r)
{
    precise float x = abs(a) - p, y = abs(b) - q, z = abs(c) - r;
    float most = f_pick(y > x, y, x);
    most = f_pick(z > most, z, most);
    return f_radicand_of(f_positive(x), f_positive(y), f_positive(z), f_pick(most > 0.0, 0.0, most));
}

float f_box(const float a, const float b, const float c, const float p, const float q, const float r)
{
    return f_rooted(f_box_radicand(a, b, c, p, q, r));
}

//: rounded_box box
precise float f_rounded_box(const float a, const float b, const float c, const float p, const float q, const float r,
                            const float radius)
{
    precise float d = f_box(a, b, c, p, q, r) - radius;
    return d;
}

//: torus radicand
precise f_radicand f_torus_radicand(const float a, const float b, const float c, const float major, const float minor)
{
    precise float around = f_length(a, c) - major;
    return f_radicand_of(around, b, -minor);
}

float f_torus(const float a, const float b, const float c, const float major, const float minor)
{
    return f_rooted(f_torus_radicand(a, b, c, major, minor));
}

//: profile radicand
/* Inside a corner the larger of two distances, outside it the length of what is positive of both. */
f_radicand f_corner_radicand(const float x, const float y)
{
    float most = f_pick(y > x, y, x);
    return f_radicand_of(f_positive(x), f_positive(y), f_pick(most > 0.0, 0.0, most));
}

float f_corner(const float x, const float y)
{
    return f_rooted(f_corner_radicand(x, y));
}

//: cylinder profile
precise f_radicand f_cylinder_radicand(const float a, const float b, const float c, const float radius,
                                       const float half_height)
{
    precise float x = f_length(a, c) - radius, y = abs(b) - half_height;
    return f_corner_radicand(x, y);
}

float f_cylinder(const float a, const float b, const float c, const float radius, const float half_height)
{
    return f_rooted(f_cylinder_radicand(a, b, c, radius, half_height));
}

//: capsule radicand
precise f_radicand f_capsule_radicand(const float a, const float b, const float c, const float radius,
                                      const float half_height)
{
    precise float y = abs(b) - half_height;
    return f_radicand_of(a, f_positive(y), c, -radius);
}

float f_capsule(const float a, const float b, const float c, const float radius, const float half_height)
{
    return f_rooted(f_capsule_radicand(a, b, c, radius, half_height));
}

//: cone length
/* Where a point of the half-plane (r, y) lies against the frustum's profile: `cap` and `side` are the distances to the
 * lines of the nearer end and of the slant, `over` and `along` how far it is past those edges' ends (0 where beside
 * them). The unit normal of the slant is (u, v), `slant` half its length, `mean` its radius at y = 0. */
struct f_frustum {
    float cap, side, over, along, turn;
};

precise f_frustum f_around_frustum(const float r, const float y, const float bottom, const float top,
                                   const float half_height, const float u, const float v, const float slant,
                                   const float mean)
{
    precise f_frustum f;
    precise float off = r - mean;
    f.cap = abs(y) - half_height;
    f.side = u * off + v * y;
    f.over = f_positive(r - f_pick(y < 0.0, bottom, top));
    f.turn = u * y - v * off;
    f.along = f_positive(abs(f.turn) - slant);
    return f;
}

precise float f_frustum_distance(const f_frustum f)
{
    precise float to_cap = f_length(f.over, f.cap), to_side = f_length(f.side, f.along);
    float outside = f_pick(to_side < to_cap, to_side, to_cap);
    float inside = f_pick(f.side > f.cap, f.side, f.cap);
    bool under = f.cap <= 0.0, behind = f.side <= 0.0;
    float d = f_pick(under && behind, inside, outside);
    return f_pick(f_is_nan(f.cap, f.side), F_NAN, d);
}

precise float f_cone(const float a, const float b, const float c, const float bottom, const float top,
                     const float half_height, const float u, const float v, const float slant, const float mean)
{
    return f_frustum_distance(f_around_frustum(f_length(a, c), b, bottom, top, half_height, u, v, slant, mean));
}

//: blend min
/* k - |a - b|, or 0 where the two are too far apart to melt together; equal infinities are not apart. */
precise float f_overlap(const float a, const float b, const float k)
{
    precise float apart = abs(a - b);
    apart = f_pick(a == b, 0.0, apart);
    precise float rest = k - apart;
    return f_positive(rest);
}

//: blend_quadratic blend
precise float f_blend_quadratic(const float a, const float b, const float k, const float inverse)
{
    precise float h = f_overlap(a, b, k);
    precise float r = f_min(a, b) - 0.25 * (h * (h * inverse));
    return r;
}

//: blend_cubic blend
precise float f_blend_cubic(const float a, const float b, const float k, const float inverse)
{
    precise float h = f_overlap(a, b, k), t = h * inverse;
    precise float r = f_min(a, b) - h * (t * t) * 0.166666672;
    return r;
}

//: blend_circular blend
precise float f_blend_circular(const float a, const float b, const float k, const float inverse)
{
    precise float t = f_overlap(a, b, k) * inverse;
    precise float depth = (1.0 + t) - sqrt(1.0 + t * (2.0 - t));
    depth = f_pick(t > 0.0, depth * (0.5 * k), 0.0);
    precise float r = f_min(a, b) - depth;
    return r;
}

//: blend_exponential blend exp ln
precise float f_blend_exponential(const float a, const float b, const float k, const float inverse)
{
    precise float apart = abs(a - b);
    apart = f_pick(a == b, 0.0, apart);
    precise float r = f_min(a, b) - f_ln(1.0 + f_exp(-k * apart)) * inverse;
    return r;
}
