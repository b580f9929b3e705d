/* Noise, outlines and zigzags with their gradients. */
//: lattice
precise vec4 f_slopes(const vec4 a, const vec4 b, const vec4 c, const vec3 slope, const float value)
{
    return vec4(slope.x * a.xyz + slope.y * b.xyz + slope.z * c.xyz, value);
}

//: between
precise vec3 f_fade_slope(const vec3 f)
{
    return 30.0 * f * f * (f - 1.0) * (f - 1.0);
}

precise vec3 f_between_slope(const vec4 low, const vec4 high, const vec3 weight, const vec3 slope)
{
    vec4 square = low + weight.z * (high - low), rise = slope.z * (high - low);
    vec2 side = square.xy + weight.y * (square.zw - square.xy), along = slope.y * (square.zw - square.xy);
    vec2 up = rise.xy + weight.y * (rise.zw - rise.xy);
    return vec3(slope.x * (side.y - side.x), along.x + weight.x * (along.y - along.x), up.x + weight.x * (up.y - up.x));
}

//: noise_value lattice between
precise vec4 f_noise_value(const vec4 a, const vec4 b, const vec4 c, const float seed)
{
    vec3 at;
    ivec3 cell = f_cell(a.w, b.w, c.w, at);
    uint s = uint(seed);
    vec4 low = f_value_corners(cell, s), high = f_value_corners(cell + ivec3(0, 0, 1), s);
    vec3 slope = f_between_slope(low, high, f_fade(at), f_fade_slope(at));
    return f_slopes(a, b, c, slope, f_noise_value(a.w, b.w, c.w, seed));
}

//: noise_gradient lattice between
precise vec4 f_noise_gradient(const vec4 a, const vec4 b, const vec4 c, const float seed)
{
    vec3 at, g[4], h[4];
    ivec3 cell = f_cell(a.w, b.w, c.w, at);
    uint s = uint(seed);
    vec4 low = f_gradient_corners(cell, s, at, g);
    vec4 high = f_gradient_corners(cell + ivec3(0, 0, 1), s, at - vec3(0.0, 0.0, 1.0), h);
    vec3 w = f_fade(at), slope = f_between_slope(low, high, w, f_fade_slope(at));
    vec3 under = mix(mix(g[0], g[1], w.x), mix(g[2], g[3], w.x), w.y);
    vec3 over = mix(mix(h[0], h[1], w.x), mix(h[2], h[3], w.x), w.y);
    return f_slopes(a, b, c, (slope + mix(under, over, w.z)) * 0.96, f_noise_gradient(a.w, b.w, c.w, seed));
}

//: noise_simplex lattice
precise vec4 f_noise_simplex(const vec4 a, const vec4 b, const vec4 c, const float seed)
{
    vec4 r = f_simplex(a.w, b.w, c.w, seed);
    return f_slopes(a, b, c, r.xyz, f_known(a.w, b.w, c.w, r.w));
}

//: noise_cellular lattice
precise vec4 f_noise_cellular(const vec4 a, const vec4 b, const vec4 c, const float seed)
{
    vec4 r = f_nearest_feature(a.w, b.w, c.w, seed);
    return f_slopes(a, b, c, 2.0 * r.xyz, f_known(a.w, b.w, c.w, r.w));
}

//: edge
/* A link carries the unit direction away from the nearest edge in place of a derivative: along an edge its normal,
 * which is right on the edge too: a point there counts as right of an edge that rises or falls, and as above a level
 * one. */
precise vec4 f_edge(const vec4 chain, const vec4 x, const vec4 y, const float ax, const float ay, const float bx,
                    const float by, const float inverse)
{
    f_side side = f_side_of(x.w, y.w, ax, ay, bx, by, inverse);
    float value = f_edge(chain.w, x.w, y.w, ax, ay, bx, by, inverse);
    vec2 edge = vec2(bx - ax, by - ay), away = side.away;
    bool level = side.turn == 0.0 && edge.y == 0.0 && edge.x > 0.0, left = side.turn > 0.0;
    vec2 normal = vec2(-edge.y, edge.x) * f_pick(left || level, 1.0, -1.0);
    bool beside = side.t > 0.0 && side.t < 1.0;
    away = mix(away, normal, bvec2(beside));
    vec2 unit = away * f_inverse(f_length(away.x, away.y));
    return vec4(mix(chain.xyz, unit.x * x.xyz + unit.y * y.xyz, bvec3(side.square < abs(chain.w))), value);
}

//: outline
precise vec4 f_outline(const vec4 chain, const vec4 x, const vec4 y, const float size)
{
    return vec4(mix(chain.xyz, -chain.xyz, bvec3(floatBitsToInt(chain.w) < 0)), f_outline(chain.w, x.w, y.w, size));
}

//: zigzag
precise vec4 f_zigzag(const vec4 a, const float period, const float inverse)
{
    precise float rest = a.w - floor(a.w * inverse + 0.5) * period;
    return vec4(mix(a.xyz, -a.xyz, bvec3(rest < 0.0)), f_zigzag(a.w, period, inverse));
}
