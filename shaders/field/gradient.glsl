/* Operations on values with gradients: vec4 (d/dx, d/dy, d/dz, value) in and out, by forward differentiation. Values
 * come from the point operations and have their bits. Where there is no derivative it is that of one side (at ties the
 * first operand's), or zero. */
//: core
precise vec3 f_away(const vec4 a)
{
    return mix(a.xyz, -a.xyz, bvec3(a.w < 0.0));
}

/* 1/a, and 0 for 0: the slope of a length at its centre. */
precise float f_inverse(const float a)
{
    return f_pick(a > 0.0, 1.0 / a, 0.0);
}

precise vec4 f_choose(const bool condition, const vec4 yes, const vec4 no)
{
    return mix(no, yes, bvec4(condition));
}

//: neg
precise vec4 f_neg(const vec4 a)
{
    return -a;
}

//: abs
precise vec4 f_abs(const vec4 a)
{
    return vec4(f_away(a), abs(a.w));
}

//: sqrt
precise vec4 f_sqrt(const vec4 a)
{
    float r = f_sqrt(a.w);
    return vec4(a.xyz * (0.5 * f_inverse(r)), r);
}

//: square
precise vec4 f_square(const vec4 a)
{
    return vec4(a.xyz * (2.0 * a.w), f_square(a.w));
}

//: sin cos
precise vec4 f_sin(const vec4 a)
{
    return vec4(a.xyz * f_cos(a.w), f_sin(a.w));
}

//: cos sin
precise vec4 f_cos(const vec4 a)
{
    return vec4(a.xyz * -f_sin(a.w), f_cos(a.w));
}

//: tan
precise vec4 f_tan(const vec4 a)
{
    float t = f_tan(a.w);
    return vec4(a.xyz * (1.0 + t * t), t);
}

//: asin
precise vec4 f_asin(const vec4 a)
{
    return vec4(a.xyz * f_inverse(sqrt((1.0 - a.w) * (1.0 + a.w))), f_asin(a.w));
}

//: acos
precise vec4 f_acos(const vec4 a)
{
    return vec4(a.xyz * -f_inverse(sqrt((1.0 - a.w) * (1.0 + a.w))), f_acos(a.w));
}

//: atan
precise vec4 f_atan(const vec4 a)
{
    return vec4(a.xyz / (1.0 + a.w * a.w), f_atan(a.w));
}

//: exp
precise vec4 f_exp(const vec4 a)
{
    float e = f_exp(a.w);
    return vec4(a.xyz * e, e);
}

//: ln
precise vec4 f_ln(const vec4 a)
{
    return vec4(a.xyz / a.w, f_ln(a.w));
}

//: floor
precise vec4 f_floor(const vec4 a)
{
    return vec4(vec3(0.0), floor(a.w));
}

//: ceil
precise vec4 f_ceil(const vec4 a)
{
    return vec4(vec3(0.0), ceil(a.w));
}

//: round
precise vec4 f_round(const vec4 a)
{
    return vec4(vec3(0.0), f_round(a.w));
}

//: not
precise vec4 f_not(const vec4 a)
{
    return vec4(vec3(0.0), f_not(a.w));
}

//: add
precise vec4 f_add(const vec4 a, const vec4 b)
{
    return vec4(a.xyz + b.xyz, f_add(a.w, b.w));
}

precise vec4 f_add(const vec4 a, const float b)
{
    return vec4(a.xyz, f_add(a.w, b));
}

//: sub
precise vec4 f_sub(const vec4 a, const vec4 b)
{
    return vec4(a.xyz - b.xyz, f_sub(a.w, b.w));
}

precise vec4 f_sub(const vec4 a, const float b)
{
    return vec4(a.xyz, f_sub(a.w, b));
}

//: mul
precise vec4 f_mul(const vec4 a, const vec4 b)
{
    return vec4(a.xyz * b.w + b.xyz * a.w, f_mul(a.w, b.w));
}

precise vec4 f_mul(const vec4 a, const float b)
{
    return vec4(a.xyz * b, f_mul(a.w, b));
}

//: div
precise vec4 f_div(const vec4 a, const vec4 b)
{
    float q = f_div(a.w, b.w);
    return vec4((a.xyz - q * b.xyz) / b.w, q);
}

precise vec4 f_div(const vec4 a, const float b)
{
    return vec4(a.xyz / b, f_div(a.w, b));
}

//: min
precise vec4 f_min(const vec4 a, const vec4 b)
{
    bool unknown = f_is_nan(b.w), less = b.w < a.w;
    return f_choose(less || unknown, b, a);
}

precise vec4 f_min(const vec4 a, const float b)
{
    return f_min(a, vec4(vec3(0.0), b));
}

precise vec4 f_lesser(const vec4 a, const vec4 b)
{
    return f_choose(b.w < a.w, b, a);
}

precise vec4 f_lesser(const vec4 a, const float b)
{
    return f_lesser(a, vec4(vec3(0.0), b));
}

//: max
precise vec4 f_max(const vec4 a, const vec4 b)
{
    bool unknown = f_is_nan(b.w), more = b.w > a.w;
    return f_choose(more || unknown, b, a);
}

precise vec4 f_max(const vec4 a, const float b)
{
    return f_max(a, vec4(vec3(0.0), b));
}

precise vec4 f_greater(const vec4 a, const vec4 b)
{
    return f_choose(b.w > a.w, b, a);
}

precise vec4 f_greater(const vec4 a, const float b)
{
    return f_greater(a, vec4(vec3(0.0), b));
}

//: mod round
precise vec4 f_mod(const vec4 a, const vec4 b)
{
    float r = f_mod(a.w, b.w);
    return vec4(a.xyz - f_round((a.w - r) / b.w) * b.xyz, r);
}

//: atan2
precise vec4 f_atan2(const vec4 y, const vec4 x)
{
    float square = x.w * x.w + y.w * y.w;
    return vec4((y.xyz * x.w - x.xyz * y.w) * f_inverse(square), f_atan2(y.w, x.w));
}

//: compare
precise vec4 f_compare(const vec4 a, const vec4 b)
{
    return vec4(vec3(0.0), f_compare(a.w, b.w));
}

//: and
precise vec4 f_and(const vec4 a, const vec4 b)
{
    return f_choose(a.w == 0.0, a, b);
}

//: or
precise vec4 f_or(const vec4 a, const vec4 b)
{
    return f_choose(a.w == 0.0, b, a);
}

//: shift
precise vec4 f_shift(const vec4 a, const float s)
{
    return vec4(a.xyz, f_shift(a.w, s));
}

//: affine
precise vec4 f_affine(const vec4 a, const float p, const float s)
{
    return vec4(p * a.xyz, f_affine(a.w, p, s));
}

precise vec4 f_affine(const vec4 a, const vec4 b, const float p, const float q, const float s)
{
    return vec4(p * a.xyz + q * b.xyz, f_affine(a.w, b.w, p, q, s));
}

precise vec4 f_affine(const vec4 a, const vec4 b, const vec4 c, const float p, const float q, const float r, const float s)
{
    return vec4(p * a.xyz + q * b.xyz + r * c.xyz, f_affine(a.w, b.w, c.w, p, q, r, s));
}

//: length
/* The gradient of a length of two (or three); it is zero where the length is. */
precise vec3 f_pull(const vec4 a, const vec4 b)
{
    return (a.xyz * a.w + b.xyz * b.w) * f_inverse(f_length(a.w, b.w));
}

precise vec3 f_pull(const vec4 a, const vec4 b, const vec4 c)
{
    return (a.xyz * a.w + b.xyz * b.w + c.xyz * c.w) * f_inverse(f_length(a.w, b.w, c.w));
}

/* What is positive of a coordinate's size less an extent, with the gradient of the size. */
precise vec4 f_beyond(const vec4 a, const float extent)
{
    return vec4(f_away(a), f_positive(abs(a.w) - extent));
}

//: sphere length
precise vec4 f_sphere(const vec4 a, const vec4 b, const vec4 c, const float radius)
{
    return vec4(f_pull(a, b, c), f_sphere(a.w, b.w, c.w, radius));
}

//: box length
precise vec4 f_box(const vec4 a, const vec4 b, const vec4 c, const float p, const float q, const float r)
{
    float x = abs(a.w) - p, y = abs(b.w) - q, z = abs(c.w) - r;
    vec3 inside = mix(f_away(a), f_away(b), bvec3(y > x));
    float most = f_pick(y > x, y, x);
    inside = mix(inside, f_away(c), bvec3(z > most));
    most = f_pick(z > most, z, most);
    vec3 outside = f_pull(f_beyond(a, p), f_beyond(b, q), f_beyond(c, r));
    return vec4(mix(inside, outside, bvec3(most > 0.0)), f_box(a.w, b.w, c.w, p, q, r));
}

//: rounded_box box
precise vec4 f_rounded_box(const vec4 a, const vec4 b, const vec4 c, const float p, const float q, const float r,
                   const float radius)
{
    return vec4(f_box(a, b, c, p, q, r).xyz, f_rounded_box(a.w, b.w, c.w, p, q, r, radius));
}

//: torus length
precise vec4 f_torus(const vec4 a, const vec4 b, const vec4 c, const float major, const float minor)
{
    vec4 ring = vec4(f_pull(a, c), f_length(a.w, c.w) - major);
    return vec4(f_pull(ring, b), f_torus(a.w, b.w, c.w, major, minor));
}

//: cylinder length
precise vec4 f_cylinder(const vec4 a, const vec4 b, const vec4 c, const float radius, const float half_height)
{
    float x = f_length(a.w, c.w) - radius, y = abs(b.w) - half_height;
    vec3 around = f_pull(a, c), along = f_away(b);
    vec3 outside = f_pull(vec4(around, f_positive(x)), vec4(along, f_positive(y)));
    bool upper = y > x;
    vec3 inside = mix(around, along, bvec3(upper));
    bool beyond = x > 0.0 || y > 0.0;
    return vec4(mix(inside, outside, bvec3(beyond)), f_cylinder(a.w, b.w, c.w, radius, half_height));
}

//: capsule length
precise vec4 f_capsule(const vec4 a, const vec4 b, const vec4 c, const float radius, const float half_height)
{
    return vec4(f_pull(a, f_beyond(b, half_height), c), f_capsule(a.w, b.w, c.w, radius, half_height));
}

//: cone length
precise vec4 f_cone(const vec4 a, const vec4 b, const vec4 c, const float bottom, const float top, const float half_height,
            const float u, const float v, const float slant, const float mean)
{
    f_frustum f = f_around_frustum(f_length(a.w, c.w), b.w, bottom, top, half_height, u, v, slant, mean);
    vec3 around = f_pull(a, c), up = f_away(b);
    vec4 cap = vec4(up, f.cap), side = vec4(u * around + v * b.xyz, f.side);
    vec4 turn = vec4(u * b.xyz - v * around, f.turn);
    float to_cap = f_length(f.over, f.cap), to_side = f_length(f.side, f.along);
    bool under = f.cap <= 0.0, behind = f.side <= 0.0, nearer_slant = f.side > f.cap;
    /* straight out from the slant it is nearest, whatever rounding makes of two distances that are almost equal */
    bool less = to_side < to_cap, straight = f.along == 0.0 && !behind, nearer_side = less || straight;
    vec3 outside =
        mix(f_pull(vec4(around, f.over), cap), f_pull(side, vec4(f_away(turn), f.along)), bvec3(nearer_side));
    vec3 inside = mix(up, side.xyz, bvec3(nearer_slant));
    float value = f_cone(a.w, b.w, c.w, bottom, top, half_height, u, v, slant, mean);
    return vec4(mix(outside, inside, bvec3(under && behind)), value);
}

//: blend
/* The lesser operand's gradient by 1 - w and the other's by w. */
precise vec4 f_melt(const vec4 a, const vec4 b, const float w, const float value)
{
    bool turned = b.w < a.w;
    vec3 lesser = mix(a.xyz, b.xyz, bvec3(turned)), other = mix(b.xyz, a.xyz, bvec3(turned));
    return vec4(mix(lesser + w * (other - lesser), lesser, bvec3(w == 0.0)), value);
}

//: blend_quadratic blend
precise vec4 f_blend_quadratic(const vec4 a, const vec4 b, const float k, const float inverse)
{
    float t = f_overlap(a.w, b.w, k) * inverse;
    return f_melt(a, b, 0.5 * t, f_blend_quadratic(a.w, b.w, k, inverse));
}

//: blend_cubic blend
precise vec4 f_blend_cubic(const vec4 a, const vec4 b, const float k, const float inverse)
{
    float t = f_overlap(a.w, b.w, k) * inverse;
    return f_melt(a, b, 0.5 * (t * t), f_blend_cubic(a.w, b.w, k, inverse));
}

//: blend_circular blend
precise vec4 f_blend_circular(const vec4 a, const vec4 b, const float k, const float inverse)
{
    float t = f_overlap(a.w, b.w, k) * inverse;
    float w = f_pick(t > 0.0, 0.5 - 0.5 * (1.0 - t) / sqrt(1.0 + t * (2.0 - t)), 0.0);
    return f_melt(a, b, w, f_blend_circular(a.w, b.w, k, inverse));
}

//: blend_exponential blend
precise vec4 f_blend_exponential(const vec4 a, const vec4 b, const float k, const float inverse)
{
    float apart = f_pick(a.w == b.w, 0.0, abs(a.w - b.w));
    float e = f_exp(-k * apart);
    return f_melt(a, b, e / (1.0 + e), f_blend_exponential(a.w, b.w, k, inverse));
}
