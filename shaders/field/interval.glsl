/* Operations on intervals: vec2 (lo, hi) in and out. A result contains every value that the point operation computes, on
 * any driver that keeps Vulkan's promises, for arguments in the operands, and is [-inf, inf] where NaN is possible; so an
 * operand of [-inf, inf] may stand for NaN. What is added to a bound counts the errors of both: those of the values and
 * those of the bound itself. One unit, F_U, is the largest distance of neighbouring floats over their size. */
//: core
#define F_WHOLE vec2(-F_INF, F_INF)
#define F_U 1.1920929e-07
/* Four smallest normal numbers: more than what denormal operands and results lose where they become zero. */
#define F_TINY 4.7019774e-38

/* Finite bounds of a variable. A bound that is denormal moves to where zero is inside. */
vec2 f_box_side(vec2 a)
{
    ivec2 magnitude = floatBitsToInt(a) & 0x7fffffff;
    bvec2 denormal = lessThan(magnitude, ivec2(0x00800000));
    bvec2 up = greaterThan(floatBitsToInt(a), ivec2(0));
    vec2 safe = vec2(f_pick(up.x || magnitude.x == 0, 0.0, -1.17549435e-38),
                     f_pick(up.y, 1.17549435e-38, 0.0));
    return mix(a, safe, denormal);
}

bool f_is_whole(vec2 a)
{
    ivec2 bits = floatBitsToInt(a);
    return ((bits.x ^ int(0xff800000u)) | (bits.y ^ 0x7f800000)) == 0;
}

bool f_is_nan(vec2 a)
{
    return f_is_nan(a.x, a.y);
}

/* Everything where a bound came out as NaN. */
vec2 f_settle(vec2 a)
{
    return mix(a, F_WHOLE, bvec2(f_is_nan(a)));
}

vec2 f_number(float a)
{
    return f_settle(vec2(a));
}

/* Everything where a bound is not finite. */
vec2 f_finite(vec2 a)
{
    ivec2 magnitude = floatBitsToInt(a) & 0x7fffffff;
    return mix(a, F_WHOLE, bvec2(max(magnitude.x, magnitude.y) >= 0x7f800000));
}

/* Moves bounds apart by `amount`, which is not negative. */
precise vec2 f_apart(vec2 a, vec2 amount)
{
    precise vec2 r = vec2(a.x - amount.x, a.y + amount.y);
    return r;
}

precise vec2 f_widen(vec2 a, float units)
{
    precise vec2 amount = abs(a) * (units * F_U) + F_TINY;
    return f_settle(f_apart(a, amount));
}

vec2 f_not_negative(vec2 a, bool condition)
{
    return vec2(f_pick(condition && a.x < 0.0, 0.0, a.x), a.y);
}

/* Least and greatest absolute value. */
vec2 f_magnitude(vec2 a)
{
    bool within = a.x <= 0.0 && a.y >= 0.0;
    vec2 m = abs(a);
    bool turned = m.x > m.y;
    return vec2(f_pick(within, 0.0, f_pick(turned, m.y, m.x)), f_pick(turned, m.x, m.y));
}

vec2 f_ordered(float a, float b)
{
    bool turned = a > b;
    return vec2(f_pick(turned, b, a), f_pick(turned, a, b));
}

vec2 f_hull(vec2 a, vec2 b)
{
    return vec2(f_pick(b.x < a.x, b.x, a.x), f_pick(b.y > a.y, b.y, a.y));
}

vec2 f_whole_if(bool condition, vec2 a)
{
    return mix(a, F_WHOLE, bvec2(condition));
}

//: length
/* For what lengths go into: squares that are denormal may be lost, and 3 of them are worth less than 2^-62. */
#define F_LOST 2.1684043e-19

precise vec2 f_widen_length(vec2 a, float units)
{
    precise vec2 amount = abs(a) * (units * F_U) + F_LOST;
    return f_settle(f_apart(a, amount));
}

/* Of magnitudes: each side's sum errs by 2 (or 3) units, its root by half of that and 4.5. */
vec2 f_length(vec2 a, vec2 b)
{
    return f_not_negative(f_widen_length(vec2(f_length(a.x, b.x), f_length(a.y, b.y)), 12.0), true);
}

vec2 f_length(vec2 a, vec2 b, vec2 c)
{
    return f_not_negative(f_widen_length(vec2(f_length(a.x, b.x, c.x), f_length(a.y, b.y, c.y)), 13.0), true);
}

//: neg
vec2 f_neg(vec2 a)
{
    return -a.yx;
}

//: abs
vec2 f_abs(vec2 a)
{
    return f_whole_if(f_is_whole(a), f_magnitude(a));
}

//: sqrt
vec2 f_sqrt(vec2 a)
{
    vec2 r = f_not_negative(f_widen(sqrt(f_magnitude(a)), 10.0), true);
    return f_whole_if(a.x < 0.0, r);
}

//: square
precise vec2 f_square(vec2 a)
{
    vec2 m = f_magnitude(a);
    precise vec2 e = m * m;
    return f_whole_if(f_is_whole(a), f_not_negative(f_widen(e, 1.0), true));
}

//: wave
/* Whether a whole number lies within, with room for the errors of finding out. */
bool f_holds_whole_number(vec2 turns)
{
    precise vec2 t = f_apart(turns, abs(turns) * 9.5367432e-07 + 9.5367432e-07);
    precise float last = floor(t.y);
    return last >= t.x;
}

/* Where the reduction holds: quarters of 13 bits. */
bool f_is_reducible(vec2 a)
{
    return a.x >= -12867.0 && a.y <= 12867.0;
}

/* Bounds of a sine or cosine from those at the ends and whether a crest and a trough lie between. */
vec2 f_swing(vec2 a, vec2 e, bool crest, bool trough)
{
    vec2 r = f_widen(e, 9.0);
    bool low = trough || r.x < -1.0, high = crest || r.y > 1.0;
    r = vec2(f_pick(low, -1.0, r.x), f_pick(high, 1.0, r.y));
    r = mix(vec2(-1.0, 1.0), r, bvec2(f_is_reducible(a)));
    bool endless = f_is_endless(a.x) || f_is_endless(a.y);
    return f_whole_if(endless, r);
}

//: sin wave
precise vec2 f_sin(vec2 a)
{
    precise vec2 turns = a * 0.159154937;
    bool crest = f_holds_whole_number(turns - 0.25), trough = f_holds_whole_number(turns + 0.25);
    return f_swing(a, f_ordered(f_sin(a.x), f_sin(a.y)), crest, trough);
}

//: cos wave
precise vec2 f_cos(vec2 a)
{
    precise vec2 turns = a * 0.159154937;
    bool crest = f_holds_whole_number(turns), trough = f_holds_whole_number(turns - 0.5);
    return f_swing(a, f_ordered(f_cos(a.x), f_cos(a.y)), crest, trough);
}

//: tan wave
precise vec2 f_tan(vec2 a)
{
    precise vec2 turns = a * 0.318309873;
    bool pole = f_holds_whole_number(turns - 0.5), sure = f_is_reducible(a);
    return f_whole_if(pole || !sure, f_widen(f_ordered(f_tan(a.x), f_tan(a.y)), 18.0));
}

//: asin
vec2 f_asin(vec2 a)
{
    bool outside = a.x < -1.0 || a.y > 1.0;
    return f_whole_if(outside, f_widen(vec2(f_asin(a.x), f_asin(a.y)), 9.0));
}

//: acos
vec2 f_acos(vec2 a)
{
    bool outside = a.x < -1.0 || a.y > 1.0;
    return f_whole_if(outside, f_not_negative(f_widen(vec2(f_acos(a.y), f_acos(a.x)), 9.0), true));
}

//: atan
vec2 f_atan(vec2 a)
{
    return f_whole_if(f_is_whole(a), f_widen(vec2(f_atan(a.x), f_atan(a.y)), 9.0));
}

//: atan2
vec2 f_atan2(vec2 y, vec2 x)
{
    vec2 low = f_ordered(f_atan2(y.x, x.x), f_atan2(y.x, x.y));
    vec2 high = f_ordered(f_atan2(y.y, x.x), f_atan2(y.y, x.y));
    vec2 r = f_widen(f_hull(low, high), 9.0);
    bool level = y.x <= 0.0 && y.y >= 0.0, behind = x.x <= 0.0;
    r = mix(r, vec2(-3.1415932, 3.1415932), bvec2(level && behind));
    bool either = f_is_whole(y), other = f_is_whole(x);
    return f_whole_if(either || other, r);
}

//: exp
vec2 f_exp(vec2 a)
{
    vec2 r = f_not_negative(f_widen(vec2(f_exp(a.x), f_exp(a.y)), 9.0), true);
    return f_whole_if(f_is_whole(a), r);
}

//: ln
vec2 f_ln(vec2 a)
{
    return f_whole_if(a.x < 0.0, f_widen(vec2(f_ln(a.x), f_ln(a.y)), 9.0));
}

//: floor
vec2 f_floor(vec2 a)
{
    return floor(a);
}

//: ceil
vec2 f_ceil(vec2 a)
{
    return ceil(a);
}

//: round
vec2 f_round(vec2 a)
{
    return vec2(f_round(a.x), f_round(a.y));
}

//: not
vec2 f_not(vec2 a)
{
    bool may_be = a.x <= 0.0 && a.y >= 0.0, must_be = a.x == 0.0 && a.y == 0.0;
    return vec2(f_pick(must_be, 1.0, 0.0), f_pick(may_be, 1.0, 0.0));
}

//: add
precise vec2 f_add(vec2 a, vec2 b)
{
    precise vec2 e = a + b;
    bool first = a.x >= 0.0, second = b.x >= 0.0;
    return f_not_negative(f_widen(e, 1.0), first && second);
}

precise vec2 f_add(vec2 a, float b)
{
    precise vec2 e = a + b;
    bool first = a.x >= 0.0, second = b >= 0.0;
    return f_not_negative(f_widen(e, 1.0), first && second);
}

//: sub
precise vec2 f_sub(vec2 a, vec2 b)
{
    precise vec2 e = a - b.yx;
    return f_widen(e, 1.0);
}

precise vec2 f_sub(vec2 a, float b)
{
    precise vec2 e = a - b;
    return f_widen(e, 1.0);
}

//: mul
precise vec2 f_mul(vec2 a, vec2 b)
{
    precise vec4 e = a.xxyy * b.xyxy;
    precise float sum = (e.x + e.y) + (e.z + e.w); /* NaN where one is, or where both infinities are: either way all */
    vec2 r = f_widen(f_hull(f_ordered(e.x, e.y), f_ordered(e.z, e.w)), 1.0);
    bool positive = a.x >= 0.0 && b.x >= 0.0, negative = a.y <= 0.0 && b.y <= 0.0;
    return f_whole_if(f_is_nan(sum), f_not_negative(r, positive || negative));
}

precise vec2 f_mul(vec2 a, float b)
{
    precise vec2 e = a * b;
    bool flip = b < 0.0;
    vec2 r = f_widen(mix(e, e.yx, bvec2(flip)), 1.0);
    bool positive = a.x >= 0.0 && b >= 0.0, negative = a.y <= 0.0 && flip;
    return f_whole_if(f_is_nan(e), f_not_negative(r, positive || negative));
}

//: div
/* 2.5 units a division, for divisors between 2^-126 and 2^126; no promise beyond. */
precise vec2 f_div(vec2 a, vec2 b)
{
    precise vec4 e = a.xxyy / b.xyxy;
    precise float sum = (e.x + e.y) + (e.z + e.w);
    vec2 r = f_widen(f_hull(f_ordered(e.x, e.y), f_ordered(e.z, e.w)), 6.0);
    bool positive = a.x >= 0.0 && b.x >= 0.0, negative = a.y <= 0.0 && b.y <= 0.0;
    bool zero = b.x <= 0.0 && b.y >= 0.0, far = b.x < -8.5e37 || b.y > 8.5e37, unknown = f_is_nan(sum);
    return f_whole_if(zero || far || unknown, f_not_negative(r, positive || negative));
}

precise vec2 f_div(vec2 a, float b)
{
    precise vec2 e = a / b;
    bool flip = b < 0.0, positive = a.x >= 0.0 && b > 0.0;
    vec2 r = f_not_negative(f_widen(mix(e, e.yx, bvec2(flip)), 6.0), positive);
    bool zero = b == 0.0, far = abs(b) > 8.5e37, unknown = f_is_nan(e);
    return f_whole_if(zero || far || unknown, r);
}

//: min
vec2 f_min(vec2 a, vec2 b)
{
    bool first = f_is_whole(a), second = f_is_whole(b);
    vec2 r = vec2(f_pick(b.x < a.x, b.x, a.x), f_pick(b.y < a.y, b.y, a.y));
    return f_whole_if(first || second, r);
}

vec2 f_min(vec2 a, float b)
{
    vec2 r = vec2(f_pick(b < a.x, b, a.x), f_pick(b < a.y, b, a.y));
    bool first = f_is_whole(a), second = f_is_nan(b);
    return f_whole_if(first || second, r);
}

//: max
vec2 f_max(vec2 a, vec2 b)
{
    bool first = f_is_whole(a), second = f_is_whole(b);
    vec2 r = vec2(f_pick(b.x > a.x, b.x, a.x), f_pick(b.y > a.y, b.y, a.y));
    return f_whole_if(first || second, r);
}

vec2 f_max(vec2 a, float b)
{
    vec2 r = vec2(f_pick(b > a.x, b, a.x), f_pick(b > a.y, b, a.y));
    bool first = f_is_whole(a), second = f_is_nan(b);
    return f_whole_if(first || second, r);
}

//: mod
/* Where the whole part q of a/b is the same everywhere (with room to spare) it is a - q |b|, else anything from 0 to |b|. */
precise vec2 f_mod(vec2 a, vec2 b)
{
    vec2 m = f_magnitude(b);
    precise vec4 turns = a.xxyy / m.xyxy;
    vec2 ends = f_hull(f_ordered(turns.x, turns.y), f_ordered(turns.z, turns.w));
    precise vec2 wide = f_apart(ends, abs(ends) * 9.5367432e-07 + 9.5367432e-07);
    float q = floor(ends.x);
    bool shift = floor(wide.x) == floor(wide.y) && abs(wide.x) < 4e6 && abs(wide.y) < 4e6;
    shift = shift || (q == 0.0 && a.x >= 0.0 && a.y < m.x);
    precise vec2 multiples = f_ordered(q * m.x, q * m.y);
    precise vec2 rest = a - multiples.yx;
    precise vec2 lost = (abs(multiples.yx) + m.yy) * (4.0 * F_U) + F_TINY;
    rest = f_apart(rest, lost);
    precise float whole = a.y + a.y * (4.0 * F_U); /* of what is positive nothing is left that is larger */
    float most = f_pick(a.x >= 0.0 && whole < m.y, whole, m.y);
    vec2 r = vec2(f_pick(shift && rest.x > 0.0, rest.x, 0.0), f_pick(shift && rest.y < most, rest.y, most));
    bool zero = b.x <= 0.0 && b.y >= 0.0, far = m.y > 8.5e37;
    bool endless = max(floatBitsToInt(abs(a.x)), floatBitsToInt(abs(a.y))) >= 0x7f800000;
    return f_whole_if(zero || far || endless, r);
}

//: compare
vec2 f_compare(vec2 a, vec2 b)
{
    bool less = a.y < b.x, more = a.x > b.y, not_less = a.x >= b.y, not_more = a.y <= b.x;
    vec2 r = vec2(f_pick(more, 1.0, f_pick(not_less, 0.0, -1.0)), f_pick(less, -1.0, f_pick(not_more, 0.0, 1.0)));
    bool first = f_is_whole(a), second = f_is_whole(b);
    return f_whole_if(first || second, r);
}

//: and
vec2 f_and(vec2 a, vec2 b)
{
    bool may_be = a.x <= 0.0 && a.y >= 0.0, must_be = a.x == 0.0 && a.y == 0.0;
    return mix(mix(b, f_hull(b, vec2(0.0)), bvec2(may_be)), vec2(0.0), bvec2(must_be));
}

//: or
vec2 f_or(vec2 a, vec2 b)
{
    bool may_be = a.x <= 0.0 && a.y >= 0.0, must_be = a.x == 0.0 && a.y == 0.0;
    return mix(mix(a, f_hull(a, b), bvec2(may_be)), b, bvec2(must_be));
}

//: shift
precise vec2 f_shift(vec2 a, float s)
{
    precise vec2 e = a + s;
    return f_widen(e, 1.0);
}

//: affine
/* Bounds of p a, and what its rounding can lose (with the room that later sums need added by the callers). */
precise vec2 f_term(vec2 a, float p)
{
    precise vec2 e = a * p;
    return mix(e, e.yx, bvec2(p < 0.0));
}

/* A sum of up to four terms of total size `size`: a unit for each product and at most three sums. */
precise vec2 f_sum_bounds(vec2 sum, vec2 size)
{
    return f_settle(f_apart(sum, size * (5.0 * F_U) + F_TINY));
}

precise vec2 f_affine(vec2 a, float p, float s)
{
    precise vec2 t = f_term(a, p);
    precise vec2 sum = t + s, size = abs(t) + abs(s);
    return f_sum_bounds(sum, size);
}

precise vec2 f_affine(vec2 a, vec2 b, float p, float q, float s)
{
    precise vec2 t = f_term(a, p), u = f_term(b, q);
    precise vec2 sum = t + u + s, size = abs(t) + abs(u) + abs(s);
    return f_sum_bounds(sum, size);
}

precise vec2 f_affine(vec2 a, vec2 b, vec2 c, float p, float q, float r, float s)
{
    precise vec2 t = f_term(a, p), u = f_term(b, q), v = f_term(c, r);
    precise vec2 sum = t + u + v + s, size = abs(t) + abs(u) + abs(v) + abs(s);
    return f_sum_bounds(sum, size);
}

//: sphere length
/* Shapes that grow with the size of every coordinate have their bounds at the least and the greatest sizes. */
precise vec2 f_sphere(vec2 a, vec2 b, vec2 c, float radius)
{
    precise vec2 e = f_length(f_magnitude(a), f_magnitude(b), f_magnitude(c)) - radius;
    return f_finite(f_widen(e, 1.0));
}

//: box length
/* Relative errors, for the two parts are never mixed: outside 2 units for the squares, 3 for the sum, halved by the
 * root, and 4.5 for it. */
vec2 f_box(vec2 a, vec2 b, vec2 c, float p, float q, float r)
{
    vec2 x = f_magnitude(a), y = f_magnitude(b), z = f_magnitude(c);
    vec2 e = vec2(f_box(x.x, y.x, z.x, p, q, r), f_box(x.y, y.y, z.y, p, q, r));
    return f_finite(f_widen_length(e, 16.0));
}

//: rounded_box box
precise vec2 f_rounded_box(vec2 a, vec2 b, vec2 c, float p, float q, float r, float radius)
{
    precise vec2 e = f_box(a, b, c, p, q, r) - radius;
    return f_finite(f_widen(e, 1.0));
}

//: torus length
precise vec2 f_torus(vec2 a, vec2 b, vec2 c, float major, float minor)
{
    precise vec2 ring = f_length(f_magnitude(a), f_magnitude(c)) - major;
    precise vec2 e = f_length(f_magnitude(f_widen(ring, 1.0)), f_magnitude(b)) - minor;
    return f_finite(f_widen(e, 1.0));
}

//: profile length
vec2 f_corner(vec2 x, vec2 y)
{
    return f_widen_length(vec2(f_corner(x.x, y.x), f_corner(x.y, y.y)), 12.0);
}

//: cylinder profile
precise vec2 f_cylinder(vec2 a, vec2 b, vec2 c, float radius, float half_height)
{
    precise vec2 x = f_length(f_magnitude(a), f_magnitude(c)) - radius, y = f_magnitude(b) - half_height;
    return f_finite(f_corner(f_widen(x, 1.0), f_widen(y, 1.0)));
}

//: capsule length
precise vec2 f_capsule(vec2 a, vec2 b, vec2 c, float radius, float half_height)
{
    precise vec2 y = f_magnitude(b) - half_height;
    y = f_widen(y, 1.0);
    y = vec2(f_positive(y.x), f_positive(y.y));
    precise vec2 e = f_length(f_magnitude(a), y, f_magnitude(c)) - radius;
    return f_finite(f_widen(e, 1.0));
}

//: cone length
/* The distance to a convex profile grows with r and is convex along y: its greatest value lies at an end, its least where
 * the plane of the wider end and either the slant or the plane of the other end are equally far, or as near to there
 * as the box comes. A computed distance errs by at most 20 units of the sum of all lengths, twice; that place by 10. */
precise vec2 f_cone(vec2 a, vec2 b, vec2 c, float bottom, float top, float half_height, float u, float v, float slant,
                    float mean)
{
    vec2 r = f_length(f_magnitude(a), f_magnitude(c));
    precise float down = (half_height + u * (r.x - mean)) / (1.0 + abs(v));
    down = f_pick(down > half_height, half_height, f_positive(down));
    float deepest = f_pick(v < 0.0, down, -down);
    deepest = f_pick(deepest < b.x, b.x, f_pick(deepest > b.y, b.y, deepest));
    precise float least =
        f_frustum_distance(f_around_frustum(r.x, deepest, bottom, top, half_height, u, v, slant, mean));
    precise float below = f_frustum_distance(f_around_frustum(r.y, b.x, bottom, top, half_height, u, v, slant, mean));
    precise float above = f_frustum_distance(f_around_frustum(r.y, b.y, bottom, top, half_height, u, v, slant, mean));
    precise vec2 e = vec2(least, f_pick(below > above, below, above));
    precise float size = r.y + f_magnitude(b).y + bottom + top + half_height;
    return f_finite(f_apart(e, vec2(size * (56.0 * F_U) + F_LOST)));
}

//: blend
/* Blends grow with both operands. What they take away errs by some units of their size, and the last sum by one more. */
precise vec2 f_blend_bounds(vec2 e, float size, float units)
{
    precise vec2 amount = vec2(size * (units * F_U) + F_TINY);
    return f_finite(f_widen(f_apart(e, amount), 2.0));
}

//: blend_quadratic blend
vec2 f_blend_quadratic(vec2 a, vec2 b, float k, float inverse)
{
    vec2 e = vec2(f_blend_quadratic(a.x, b.x, k, inverse), f_blend_quadratic(a.y, b.y, k, inverse));
    return f_blend_bounds(e, k, 8.0);
}

//: blend_cubic blend
vec2 f_blend_cubic(vec2 a, vec2 b, float k, float inverse)
{
    vec2 e = vec2(f_blend_cubic(a.x, b.x, k, inverse), f_blend_cubic(a.y, b.y, k, inverse));
    return f_blend_bounds(e, k, 8.0);
}

//: blend_circular blend
vec2 f_blend_circular(vec2 a, vec2 b, float k, float inverse)
{
    vec2 e = vec2(f_blend_circular(a.x, b.x, k, inverse), f_blend_circular(a.y, b.y, k, inverse));
    return f_blend_bounds(e, k, 20.0);
}

//: blend_exponential blend
vec2 f_blend_exponential(vec2 a, vec2 b, float k, float inverse)
{
    vec2 e = vec2(f_blend_exponential(a.x, b.x, k, inverse), f_blend_exponential(a.y, b.y, k, inverse));
    return f_blend_bounds(e, inverse, 24.0);
}
