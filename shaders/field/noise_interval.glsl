/* Bounds of noise, outlines and zigzags: about the value in the middle, from how steep they can be. A computed value
 * errs by some units, here and there. */
//: lattice
float f_reach(const vec2 a, const float middle)
{
    precise float low = middle - a.x, high = a.y - middle;
    return f_pick(high > low, high, low);
}

vec2 f_kept(const vec2 a)
{
    return vec2(f_kept(a.x), f_kept(a.y));
}

precise vec2 f_steep(const vec2 a, const vec2 b, const vec2 c, const vec3 middle, const float value, const float slope,
                     const float error)
{
    precise float reach = (f_reach(a, middle.x) + f_reach(b, middle.y) + f_reach(c, middle.z)) * (slope * 1.000001);
    precise float room = reach + error, least = value - room, most = value + room;
    return vec2(f_pick(least < -1.0, -1.0, least), f_pick(most > 1.0, 1.0, most));
}

//: noise_value lattice
vec2 f_noise_value(const vec2 a, const vec2 b, const vec2 c, const float seed)
{
    vec2 x = f_kept(a), y = f_kept(b), z = f_kept(c);
    vec3 m = f_middle(x, y, z);
    return f_steep(x, y, z, m, f_noise_value(m.x, m.y, m.z, seed), 3.75, 48.0 * F_U);
}

//: noise_gradient lattice
vec2 f_noise_gradient(const vec2 a, const vec2 b, const vec2 c, const float seed)
{
    vec2 x = f_kept(a), y = f_kept(b), z = f_kept(c);
    vec3 m = f_middle(x, y, z);
    return f_steep(x, y, z, m, f_noise_gradient(m.x, m.y, m.z, seed), 3.7, 48.0 * F_U);
}

//: noise_simplex lattice
/* The skewed lattice costs units of the coordinates' sum, times the slope. */
vec2 f_noise_simplex(const vec2 a, const vec2 b, const vec2 c, const float seed)
{
    vec2 x = f_kept(a), y = f_kept(b), z = f_kept(c);
    vec3 m = f_middle(x, y, z);
    float size = f_magnitude(x).y + f_magnitude(y).y + f_magnitude(z).y;
    return f_steep(x, y, z, m, f_noise_simplex(m.x, m.y, m.z, seed), 7.0, (64.0 + 200.0 * size) * F_U);
}

//: noise_cellular lattice
precise vec2 f_noise_cellular(const vec2 a, const vec2 b, const vec2 c, const float seed)
{
    vec2 x = f_kept(a), y = f_kept(b), z = f_kept(c);
    vec3 m = f_middle(x, y, z), side = vec3(f_reach(x, m.x), f_reach(y, m.y), f_reach(z, m.z));
    precise float reach = sqrt(side.x * side.x + side.y * side.y + side.z * side.z) * 1.000002;
    precise float root = sqrt(f_noise_cellular(m.x, m.y, m.z, seed)), least = root - reach, most = root + reach;
    least = f_pick(least > 0.0, least, 0.0);
    precise float low = least * least - 64.0 * F_U, high = most * most * 1.000002 + 64.0 * F_U;
    return vec2(f_pick(low > 0.0, low, 0.0), f_pick(high > 1.0, 1.0, high));
}

//: edge
/* A link holds its value in the middle of the box. */
vec2 f_edge(const vec2 chain, const vec2 x, const vec2 y, const float ax, const float ay, const float bx,
            const float by, const float inverse)
{
    return vec2(f_edge(chain.x, 0.5 * x.x + 0.5 * x.y, 0.5 * y.x + 0.5 * y.y, ax, ay, bx, by, inverse));
}

//: outline
precise vec2 f_outline(const vec2 chain, const vec2 x, const vec2 y, const float size)
{
    vec2 m = vec2(0.5 * x.x + 0.5 * x.y, 0.5 * y.x + 0.5 * y.y);
    float value = f_outline(chain.x, m.x, m.y, size);
    precise vec2 low = m - vec2(x.x, y.x), high = vec2(x.y, y.y) - m;
    vec2 side = mix(low, high, greaterThan(high, low));
    precise float reach = sqrt(side.x * side.x + side.y * side.y) * 1.000002;
    precise float far = f_magnitude(x).y + f_magnitude(y).y + size;
    precise float room = reach + abs(value) * (24.0 * F_U) + far * (48.0 * F_U) + 1e-18;
    precise vec2 r = vec2(value - room, value + room);
    return r;
}

//: zigzag wave
precise vec2 f_zigzag(const vec2 a, const float period, const float inverse)
{
    precise vec2 turns = a * inverse;
    precise float error = (f_magnitude(a).y + period) * (8.0 * F_U);
    vec2 r = f_apart(f_ordered(f_zigzag(a.x, period, inverse), f_zigzag(a.y, period, inverse)), vec2(error));
    bool low = f_holds_whole_number(turns) || r.x < 0.0, high = f_holds_whole_number(turns - 0.5) || r.y > 0.5 * period;
    return vec2(f_pick(low, 0.0, r.x), f_pick(high, 0.5 * period, r.y));
}
