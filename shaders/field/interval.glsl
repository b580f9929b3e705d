/* Operations on intervals: vec2 (lo, hi) in and out. A result contains every value that the point operation computes
 * for arguments in the operands, on any driver that keeps Vulkan's promises, and is [-inf, inf] where NaN is possible.
 *
 * Sums, differences and products are rounded correctly, in one mode a device; such rounding is monotone, as is taking
 * denormals for zero. So what is made of them alone needs no widening where it grows with its arguments: the ends have
 * the bits that values there have. What divides, takes roots or adds up polynomials is widened by the error of the
 * value and by that of the end. A unit, F_U, is the greatest distance of neighbouring floats over their size.
 *
 * Operands are finite. Where the emitter cannot tell that they are, and that the result is, it calls f_guard. */
//: core
#define F_WHOLE vec2(-F_INF, F_INF)
#define F_U 1.1920929e-07
/* Four smallest normal numbers: what results near zero may lose. */
#define F_TINY 4.7019774e-38

bool f_is_endless(const vec2 a)
{
    ivec2 magnitude = floatBitsToInt(a) & 0x7fffffff;
    return max(magnitude.x, magnitude.y) >= 0x7f800000;
}

vec2 f_whole_if(const bool condition, const vec2 a)
{
    return mix(a, F_WHOLE, bvec2(condition));
}

/* Everything where a bound is not finite. */
vec2 f_finite(const vec2 a)
{
    return f_whole_if(f_is_endless(a), a);
}

vec2 f_number(const float a)
{
    return f_finite(vec2(a));
}

vec2 f_guard(const vec2 result, const vec2 a)
{
    bool first = f_is_endless(result), second = f_is_endless(a);
    return f_whole_if(first || second, result);
}

vec2 f_guard(const vec2 result, const vec2 a, const vec2 b)
{
    bool first = f_is_endless(a), second = f_is_endless(b);
    return f_whole_if(first || second, f_finite(result));
}

vec2 f_guard(const vec2 result, const vec2 a, const vec2 b, const vec2 c)
{
    bool first = f_is_endless(a), second = f_is_endless(b);
    return f_whole_if(first || second, f_guard(result, c));
}

/* What the emitter knows of sizes holds for coordinates up to 2^30. */
vec2 f_result(const vec2 result, const vec2 x, const vec2 y, const vec2 z)
{
    ivec2 size = max(floatBitsToInt(x) & 0x7fffffff, floatBitsToInt(y) & 0x7fffffff);
    size = max(size, floatBitsToInt(z) & 0x7fffffff);
    return f_whole_if(max(size.x, size.y) > 0x4e800000, result);
}

/* Moves bounds apart by `amount`, which is not negative. */
precise vec2 f_apart(const vec2 a, const vec2 amount)
{
    precise vec2 r = vec2(a.x - amount.x, a.y + amount.y);
    return r;
}

precise vec2 f_widen(const vec2 a, const float units)
{
    precise vec2 amount = abs(a) * (units * F_U) + F_TINY;
    return f_apart(a, amount);
}

/* The same for what is not negative, and then stays so. Roots err by 4.5 units, here and there. */
precise vec2 f_widen_root(const vec2 a)
{
    precise vec2 r = a * vec2(1.0 - 10.0 * F_U, 1.0 + 10.0 * F_U);
    return r;
}

/* For the values of own functions, which are not negative. */
vec2 f_not_negative(const vec2 a)
{
    return vec2(f_pick(a.x < 0.0, 0.0, a.x), a.y);
}

/* Least and greatest absolute value. */
vec2 f_magnitude(const vec2 a)
{
    float less = -a.x;
    return vec2(f_pick(a.x > 0.0, a.x, f_pick(a.y < 0.0, -a.y, 0.0)), f_pick(less > a.y, less, a.y));
}

vec2 f_ordered(const float a, const float b)
{
    bool turned = a > b;
    return vec2(f_pick(turned, b, a), f_pick(turned, a, b));
}

vec2 f_hull(const vec2 a, const vec2 b)
{
    return vec2(f_pick(b.x < a.x, b.x, a.x), f_pick(b.y > a.y, b.y, a.y));
}

vec3 f_middle(const vec2 x, const vec2 y, const vec2 z)
{
    return vec3(0.5 * x.x + 0.5 * x.y, 0.5 * y.x + 0.5 * y.y, 0.5 * z.x + 0.5 * z.y);
}

/* As near to the value in the middle of the box as slope and errors allow. The value of a shape in an affine frame errs by
 * at most 22 units of the sum of what its coordinates and parameters are made of (5 for its coordinates, times the root of
 * 3, and 13 for itself), twice; a length by 7 of its own. */
precise vec2 f_about(const float value, const vec3 middle, const vec2 x, const vec2 y, const vec2 z, const float slope,
                     const float factors, const float rest)
{
    precise vec3 low = middle - vec3(x.x, y.x, z.x), high = vec3(x.y, y.y, z.y) - middle;
    vec3 side = mix(low, high, greaterThan(high, low)), size = max(abs(low), abs(high)) + abs(middle);
    precise float reach = sqrt(side.x * side.x + side.y * side.y + side.z * side.z) * slope * 1.000004;
    precise float far = size.x + size.y + size.z;
    precise float room = reach + (factors * far + rest) * (64.0 * F_U) + 1e-18;
    return f_apart(vec2(value), vec2(room));
}

//: length
/* Of magnitudes. */
vec2 f_length(const vec2 a, const vec2 b)
{
    return f_widen_root(vec2(f_length(a.x, b.x), f_length(a.y, b.y)));
}

vec2 f_length(const vec2 a, const vec2 b, const vec2 c)
{
    return f_widen_root(vec2(f_length(a.x, b.x, c.x), f_length(a.y, b.y, c.y)));
}

//: neg
vec2 f_neg(const vec2 a)
{
    return -a.yx;
}

//: abs
vec2 f_abs(const vec2 a)
{
    return f_magnitude(a);
}

//: sqrt
vec2 f_sqrt(const vec2 a)
{
    return f_whole_if(a.x < 0.0, f_widen_root(sqrt(a)));
}

//: square
precise vec2 f_square(const vec2 a)
{
    vec2 m = f_magnitude(a);
    precise vec2 r = m * m;
    return r;
}

//: wave
/* Whether a whole number lies within, with room for the errors of finding out. */
bool f_holds_whole_number(const vec2 turns)
{
    precise vec2 t = f_apart(turns, abs(turns) * 9.5367432e-07 + 9.5367432e-07);
    precise float last = floor(t.y);
    return last >= t.x;
}

/* Where the reduction holds: quarters of 13 bits. */
bool f_is_reducible(const vec2 a)
{
    bool first = a.x >= -12867.0, second = a.y <= 12867.0;
    return first && second;
}

/* Bounds of a sine or cosine from those at the ends and whether a crest and a trough lie between. */
vec2 f_swing(const vec2 a, const vec2 e, const bool crest, const bool trough)
{
    vec2 r = f_widen(e, 9.0);
    bool low = r.x<-1.0, high = r.y> 1.0, far = !f_is_reducible(a);
    return vec2(f_pick(trough || low || far, -1.0, r.x), f_pick(crest || high || far, 1.0, r.y));
}

//: sin wave
precise vec2 f_sin(const vec2 a)
{
    precise vec2 turns = a * 0.159154937;
    bool crest = f_holds_whole_number(turns - 0.25), trough = f_holds_whole_number(turns + 0.25);
    return f_swing(a, f_ordered(f_sin(a.x), f_sin(a.y)), crest, trough);
}

//: cos wave
precise vec2 f_cos(const vec2 a)
{
    precise vec2 turns = a * 0.159154937;
    bool crest = f_holds_whole_number(turns), trough = f_holds_whole_number(turns - 0.5);
    return f_swing(a, f_ordered(f_cos(a.x), f_cos(a.y)), crest, trough);
}

//: tan wave
precise vec2 f_tan(const vec2 a)
{
    precise vec2 turns = a * 0.318309873;
    bool pole = f_holds_whole_number(turns - 0.5), sure = f_is_reducible(a);
    return f_whole_if(pole || !sure, f_widen(f_ordered(f_tan(a.x), f_tan(a.y)), 18.0));
}

//: asin
vec2 f_asin(const vec2 a)
{
    bool low = a.x<-1.0, high = a.y> 1.0;
    return f_whole_if(low || high, f_widen(vec2(f_asin(a.x), f_asin(a.y)), 9.0));
}

//: acos
vec2 f_acos(const vec2 a)
{
    bool low = a.x<-1.0, high = a.y> 1.0;
    return f_whole_if(low || high, f_not_negative(f_widen(vec2(f_acos(a.y), f_acos(a.x)), 9.0)));
}

//: atan
vec2 f_atan(const vec2 a)
{
    return f_widen(vec2(f_atan(a.x), f_atan(a.y)), 9.0);
}

//: atan2
vec2 f_atan2(const vec2 y, const vec2 x)
{
    vec2 low = f_ordered(f_atan2(y.x, x.x), f_atan2(y.x, x.y));
    vec2 high = f_ordered(f_atan2(y.y, x.x), f_atan2(y.y, x.y));
    vec2 r = f_widen(f_hull(low, high), 9.0);
    bool under = y.x <= 0.0, over = y.y >= 0.0, behind = x.x <= 0.0;
    bool around = under && over;
    return mix(r, vec2(-3.1415932, 3.1415932), bvec2(around && behind));
}

//: exp
vec2 f_exp(const vec2 a)
{
    return f_not_negative(f_widen(vec2(f_exp(a.x), f_exp(a.y)), 9.0));
}

//: ln
vec2 f_ln(const vec2 a)
{
    return f_whole_if(a.x < 0.0, f_finite(f_widen(vec2(f_ln(a.x), f_ln(a.y)), 9.0)));
}

//: floor
vec2 f_floor(const vec2 a)
{
    return floor(a);
}

//: ceil
vec2 f_ceil(const vec2 a)
{
    return ceil(a);
}

//: round
vec2 f_round(const vec2 a)
{
    return vec2(f_round(a.x), f_round(a.y));
}

//: not
vec2 f_not(const vec2 a)
{
    bool may_be = a.x <= 0.0 && a.y >= 0.0, must_be = a.x == 0.0 && a.y == 0.0;
    return vec2(f_pick(must_be, 1.0, 0.0), f_pick(may_be, 1.0, 0.0));
}

//: add
precise vec2 f_add(const vec2 a, const vec2 b)
{
    precise vec2 r = a + b;
    return r;
}

precise vec2 f_add(const vec2 a, const float b)
{
    precise vec2 r = a + b;
    return r;
}

//: sub
precise vec2 f_sub(const vec2 a, const vec2 b)
{
    precise vec2 r = a - b.yx;
    return r;
}

precise vec2 f_sub(const vec2 a, const float b)
{
    precise vec2 r = a - b;
    return r;
}

//: mul
precise vec2 f_mul(const vec2 a, const vec2 b)
{
    precise vec4 e = a.xxyy * b.xyxy;
    return f_hull(f_ordered(e.x, e.y), f_ordered(e.z, e.w));
}

precise vec2 f_mul(const vec2 a, const float b)
{
    precise vec2 e = a * b;
    return mix(e, e.yx, bvec2(b < 0.0));
}

//: div
/* 2.5 units a division, for divisors between 2^-126 and 2^126; no promise beyond. */
precise vec2 f_div(const vec2 a, const vec2 b)
{
    precise vec4 e = a.xxyy / b.xyxy;
    vec2 r = f_widen(f_hull(f_ordered(e.x, e.y), f_ordered(e.z, e.w)), 6.0);
    bool under = b.x<1.17549435e-38, over = b.y> - 1.17549435e-38;
    bool zero = under && over, low = b.x<-8.5e37, high = b.y> 8.5e37;
    return f_whole_if(zero || low || high, f_finite(r));
}

precise vec2 f_div(const vec2 a, const float b)
{
    precise vec2 e = a / b;
    vec2 r = f_widen(mix(e, e.yx, bvec2(b < 0.0)), 6.0);
    float m = abs(b);
    bool zero = m<1.17549435e-38, far = m> 8.5e37;
    return f_whole_if(zero || far, f_finite(r));
}

//: min
vec2 f_min(const vec2 a, const vec2 b)
{
    return vec2(f_pick(b.x < a.x, b.x, a.x), f_pick(b.y < a.y, b.y, a.y));
}

vec2 f_min(const vec2 a, const float b)
{
    return vec2(f_pick(b < a.x, b, a.x), f_pick(b < a.y, b, a.y));
}

//: max
vec2 f_max(const vec2 a, const vec2 b)
{
    return vec2(f_pick(b.x > a.x, b.x, a.x), f_pick(b.y > a.y, b.y, a.y));
}

vec2 f_max(const vec2 a, const float b)
{
    return vec2(f_pick(b > a.x, b, a.x), f_pick(b > a.y, b, a.y));
}

//: mod
/* Where the whole part q of a/b is the same everywhere (with room to spare) it is a - q |b|, else anything from 0 to
 * |b|. */
precise vec2 f_mod(const vec2 a, const vec2 b)
{
    vec2 m = f_magnitude(b);
    precise vec4 turns = a.xxyy / m.xyxy;
    vec2 ends = f_hull(f_ordered(turns.x, turns.y), f_ordered(turns.z, turns.w));
    precise vec2 wide = f_apart(ends, abs(ends) * 9.5367432e-07 + 9.5367432e-07);
    float q = floor(ends.x);
    bool same = floor(wide.x) == floor(wide.y), exact = max(abs(wide.x), abs(wide.y)) < 4e6;
    bool none = a.x >= 0.0 && a.y < m.x;
    bool shift = (same && exact) || (q == 0.0 && none);
    precise vec2 multiples = f_ordered(q * m.x, q * m.y);
    precise vec2 rest = a - multiples.yx;
    precise vec2 lost = (abs(multiples.yx) + m.yy) * (4.0 * F_U) + F_TINY;
    rest = f_apart(rest, lost);
    precise float whole = a.y + a.y * (4.0 * F_U); /* of what is positive nothing is left that is larger */
    float most = f_pick(a.x >= 0.0 && whole < m.y, whole, m.y);
    vec2 r = vec2(f_pick(shift && rest.x > 0.0, rest.x, 0.0), f_pick(shift && rest.y < most, rest.y, most));
    bool zero = m.x<1.17549435e-38, far = m.y> 8.5e37;
    return f_whole_if(zero || far, r);
}

//: compare
vec2 f_compare(const vec2 a, const vec2 b)
{
    bool less = a.y<b.x, more = a.x> b.y, not_less = a.x >= b.y, not_more = a.y <= b.x;
    return vec2(f_pick(more, 1.0, f_pick(not_less, 0.0, -1.0)), f_pick(less, -1.0, f_pick(not_more, 0.0, 1.0)));
}

//: and
vec2 f_and(const vec2 a, const vec2 b)
{
    bool may_be = a.x <= 0.0 && a.y >= 0.0, must_be = a.x == 0.0 && a.y == 0.0;
    return mix(mix(b, f_hull(b, vec2(0.0)), bvec2(may_be)), vec2(0.0), bvec2(must_be));
}

//: or
vec2 f_or(const vec2 a, const vec2 b)
{
    bool may_be = a.x <= 0.0 && a.y >= 0.0, must_be = a.x == 0.0 && a.y == 0.0;
    return mix(mix(a, f_hull(a, b), bvec2(may_be)), b, bvec2(must_be));
}

//: shift
precise vec2 f_shift(const vec2 a, const float s)
{
    precise vec2 r = a + s;
    return r;
}

//: affine
precise vec2 f_term(const vec2 a, const float p)
{
    precise vec2 e = a * p;
    return mix(e, e.yx, bvec2(p < 0.0));
}

precise vec2 f_affine(const vec2 a, const float p, const float s)
{
    precise vec2 sum = f_term(a, p) + s;
    return sum;
}

precise vec2 f_affine(const vec2 a, const vec2 b, const float p, const float q, const float s)
{
    precise vec2 sum = f_term(a, p) + f_term(b, q) + s;
    return sum;
}

precise vec2 f_affine(const vec2 a, const vec2 b, const vec2 c, const float p, const float q, const float r,
                      const float s)
{
    precise vec2 sum = f_term(a, p) + f_term(b, q) + f_term(c, r) + s;
    return sum;
}

//: sphere length
/* Shapes that grow with the size of every coordinate have their bounds at the least and the greatest sizes. */
precise vec2 f_sphere(const vec2 a, const vec2 b, const vec2 c, const float radius)
{
    precise vec2 r = f_length(f_magnitude(a), f_magnitude(b), f_magnitude(c)) - radius;
    return r;
}

//: box length
/* Outside it is a root, inside it is exact. */
vec2 f_box(const vec2 a, const vec2 b, const vec2 c, const float p, const float q, const float r)
{
    vec2 x = f_magnitude(a), y = f_magnitude(b), z = f_magnitude(c);
    return f_widen(vec2(f_box(x.x, y.x, z.x, p, q, r), f_box(x.y, y.y, z.y, p, q, r)), 10.0);
}

//: rounded_box box
precise vec2 f_rounded_box(const vec2 a, const vec2 b, const vec2 c, const float p, const float q, const float r,
                           const float radius)
{
    precise vec2 e = f_box(a, b, c, p, q, r) - radius;
    return e;
}

//: torus length
precise vec2 f_torus(const vec2 a, const vec2 b, const vec2 c, const float major, const float minor)
{
    precise vec2 ring = f_length(f_magnitude(a), f_magnitude(c)) - major;
    precise vec2 r = f_length(f_magnitude(ring), f_magnitude(b)) - minor;
    return r;
}

//: cylinder profile
precise vec2 f_cylinder(const vec2 a, const vec2 b, const vec2 c, const float radius, const float half_height)
{
    precise vec2 x = f_length(f_magnitude(a), f_magnitude(c)) - radius, y = f_magnitude(b) - half_height;
    return f_widen(vec2(f_corner(x.x, y.x), f_corner(x.y, y.y)), 10.0);
}

//: capsule length
precise vec2 f_capsule(const vec2 a, const vec2 b, const vec2 c, const float radius, const float half_height)
{
    precise vec2 y = f_magnitude(b) - half_height;
    vec2 over = vec2(f_positive(y.x), f_positive(y.y));
    precise vec2 r = f_length(f_magnitude(a), over, f_magnitude(c)) - radius;
    return r;
}

//: cone length
/* The distance to a convex profile grows with r and is convex along y: its greatest value lies at an end, its least
 * where the plane of the wider end and either the slant or the plane of the other end are equally far, or as near to
 * there as the box comes. A computed distance errs by at most 20 units of the sum of all lengths, twice; that place
 * by 10. */
precise vec2 f_cone(const vec2 a, const vec2 b, const vec2 c, const float bottom, const float top,
                    const float half_height, const float u, const float v, const float slant, const float mean)
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
    return f_apart(e, vec2(size * (56.0 * F_U) + 4.3368087e-19)); /* squares below 2^-126 may be lost */
}

//: blend
/* Blends grow with both operands. What they take away errs by some units of their size, and the last sum by one more.
 */
precise vec2 f_blend_bounds(const vec2 e, const float size, const float units)
{
    precise vec2 amount = vec2(size * (units * F_U) + F_TINY);
    return f_widen(f_apart(e, amount), 2.0);
}

//: blend_quadratic blend
vec2 f_blend_quadratic(const vec2 a, const vec2 b, const float k, const float inverse)
{
    vec2 e = vec2(f_blend_quadratic(a.x, b.x, k, inverse), f_blend_quadratic(a.y, b.y, k, inverse));
    return f_blend_bounds(e, k, 8.0);
}

//: blend_cubic blend
vec2 f_blend_cubic(const vec2 a, const vec2 b, const float k, const float inverse)
{
    vec2 e = vec2(f_blend_cubic(a.x, b.x, k, inverse), f_blend_cubic(a.y, b.y, k, inverse));
    return f_blend_bounds(e, k, 8.0);
}

//: blend_circular blend
vec2 f_blend_circular(const vec2 a, const vec2 b, const float k, const float inverse)
{
    vec2 e = vec2(f_blend_circular(a.x, b.x, k, inverse), f_blend_circular(a.y, b.y, k, inverse));
    return f_blend_bounds(e, k, 20.0);
}

//: blend_exponential blend
vec2 f_blend_exponential(const vec2 a, const vec2 b, const float k, const float inverse)
{
    vec2 e = vec2(f_blend_exponential(a.x, b.x, k, inverse), f_blend_exponential(a.y, b.y, k, inverse));
    return f_blend_bounds(e, inverse, 24.0);
}
