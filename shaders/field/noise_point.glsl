/* Noise over a lattice of cells of size 1, and outlines of polygons, at points. All of it is integer hashes, sums,
 * products and floor, so that its bits are the same on every device. The C twin in double is src/field/noise.c, which
 * names the papers. */
//: lattice
uint f_hash(const ivec3 cell, const uint seed)
{
    uint h = uint(cell.x) * 0x9e3779b1u + uint(cell.y) * 0x94d049bbu + uint(cell.z) * 0xd1b54a33u + seed * 0x7f4a7c15u;
    h ^= h >> 16;
    h *= 0x7feb352du;
    h ^= h >> 15;
    h *= 0x846ca68bu;
    return h ^ (h >> 16);
}

/* Farther out cells are those at the rim; NaN must not reach an integer. */
float f_kept(const float a)
{
    return f_pick(f_is_nan(a), 0.0, f_pick(a < -16777216.0, -16777216.0, f_pick(a > 16777216.0, 16777216.0, a)));
}

precise ivec3 f_cell(const float a, const float b, const float c, out vec3 at)
{
    vec3 p = vec3(f_kept(a), f_kept(b), f_kept(c)), whole = floor(p);
    precise vec3 rest = p - whole;
    at = rest;
    return ivec3(whole);
}

float f_known(const float a, const float b, const float c, const float result)
{
    bool first = f_is_nan(a, b), second = f_is_nan(c);
    return f_pick(first || second, F_NAN, result);
}

/* One of the twelve directions to the edges of a cube. */
vec3 f_direction(const uint h)
{
    uint flat_axis = h % 3u;
    float first = float(int(1u - 2u * (h >> 8 & 1u))), second = float(int(1u - 2u * (h >> 9 & 1u)));
    return vec3(f_pick(flat_axis == 0u, 0.0, first),
                f_pick(flat_axis == 1u, 0.0, f_pick(flat_axis == 0u, first, second)),
                f_pick(flat_axis == 2u, 0.0, second));
}

//: between
precise vec3 f_fade(const vec3 f)
{
    precise vec3 r = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    return r;
}

/* Values at the corners of a cube: those at its lower z and those at its upper, each with x running first. */
precise float f_between(const vec4 low, const vec4 high, const vec3 weight)
{
    precise vec4 square = low + weight.z * (high - low);
    precise vec2 side = square.xy + weight.y * (square.zw - square.xy);
    precise float r = side.x + weight.x * (side.y - side.x);
    return r;
}

//: noise_value lattice between
precise float f_value_corner(const ivec3 cell, const uint seed)
{
    precise float r = float(f_hash(cell, seed) >> 8) * 1.1920929e-07 - 1.0;
    return r;
}

precise vec4 f_value_corners(const ivec3 cell, const uint seed)
{
    return vec4(f_value_corner(cell, seed), f_value_corner(cell + ivec3(1, 0, 0), seed),
                f_value_corner(cell + ivec3(0, 1, 0), seed), f_value_corner(cell + ivec3(1, 1, 0), seed));
}

precise float f_noise_value(const float a, const float b, const float c, const float seed)
{
    vec3 at;
    ivec3 cell = f_cell(a, b, c, at);
    uint s = uint(seed);
    vec4 low = f_value_corners(cell, s), high = f_value_corners(cell + ivec3(0, 0, 1), s);
    return f_known(a, b, c, f_between(low, high, f_fade(at)));
}

//: noise_gradient lattice between
precise float f_gradient_corner(const ivec3 cell, const uint seed, const vec3 d, out vec3 g)
{
    g = f_direction(f_hash(cell, seed));
    precise float r = g.x * d.x + g.y * d.y + g.z * d.z;
    return r;
}

precise vec4 f_gradient_corners(const ivec3 cell, const uint seed, const vec3 d, out vec3 g[4])
{
    precise vec3 e = d - vec3(1.0, 1.0, 0.0);
    return vec4(f_gradient_corner(cell, seed, d, g[0]),
                f_gradient_corner(cell + ivec3(1, 0, 0), seed, vec3(e.x, d.yz), g[1]),
                f_gradient_corner(cell + ivec3(0, 1, 0), seed, vec3(d.x, e.y, d.z), g[2]),
                f_gradient_corner(cell + ivec3(1, 1, 0), seed, e, g[3]));
}

precise float f_noise_gradient(const float a, const float b, const float c, const float seed)
{
    vec3 at, g[4];
    ivec3 cell = f_cell(a, b, c, at);
    precise vec3 above = at - vec3(0.0, 0.0, 1.0);
    uint s = uint(seed);
    vec4 low = f_gradient_corners(cell, s, at, g), high = f_gradient_corners(cell + ivec3(0, 0, 1), s, above, g);
    precise float r = f_between(low, high, f_fade(at)) * 0.96;
    return f_known(a, b, c, r);
}

//: noise_simplex lattice
/* The value in w and, in x, y, z, its derivatives. */
precise vec4 f_simplex_corner(const ivec3 cell, const uint seed, const vec3 d)
{
    vec3 g = f_direction(f_hash(cell, seed));
    precise float rest = 0.5 - d.x * d.x - d.y * d.y - d.z * d.z;
    rest = f_pick(rest > 0.0, rest, 0.0);
    precise float cube = rest * rest * rest, dot_product = g.x * d.x + g.y * d.y + g.z * d.z;
    precise vec4 r = vec4((cube * rest) * g - (8.0 * cube * dot_product) * d, cube * rest * dot_product);
    return r;
}

/* On the way from a cube's first corner to its last the largest coordinate comes first. */
precise vec4 f_simplex(const float a, const float b, const float c, const float seed)
{
    vec3 p = vec3(f_kept(a), f_kept(b), f_kept(c));
    precise float skew = (p.x + p.y + p.z) * 0.333333343;
    precise vec3 whole = floor(p + skew);
    precise float back = (whole.x + whole.y + whole.z) * 0.166666672;
    precise vec3 d = (p - whole) + back;
    ivec3 cell = ivec3(whole), later = ivec3(int(d.y > d.x) + int(d.z > d.x), int(d.x >= d.y) + int(d.z > d.y),
                                             int(d.x >= d.z) + int(d.y >= d.z));
    ivec3 second = ivec3(equal(later, ivec3(0))), third = ivec3(lessThan(later, ivec3(2)));
    precise vec3 e = d - vec3(second) + 0.166666672, f = d - vec3(third) + 0.333333343, g = d - 0.5;
    uint s = uint(seed);
    precise vec4 sum = f_simplex_corner(cell, s, d) + f_simplex_corner(cell + second, s, e);
    sum = sum + f_simplex_corner(cell + third, s, f) + f_simplex_corner(cell + 1, s, g);
    sum = sum * 76.0;
    return sum;
}

float f_noise_simplex(const float a, const float b, const float c, const float seed)
{
    return f_known(a, b, c, f_simplex(a, b, c, seed).w);
}

//: noise_cellular lattice
/* `best` is the way from the nearest point so far and, in w, its square length. Written out instead of in loops,
 * because an invocation has only so many iterations (docs/evaluation.md). */
precise vec4 f_feature(const ivec3 cell, const uint seed, const vec3 at, const int x, const int y, const int z,
                       const vec4 best)
{
    ivec3 off = ivec3(x, y, z);
    uint h = f_hash(cell + off, seed);
    precise vec3 jitter = (vec3(uvec3(h, h >> 10, h >> 20) & 1023u) + 0.5) * 0.0009765625;
    precise vec3 d = (at - vec3(off)) - jitter;
    precise float square = d.x * d.x + d.y * d.y + d.z * d.z;
    return mix(best, vec4(d, square), bvec4(square < best.w));
}

vec4 f_feature_row(const ivec3 cell, const uint seed, const vec3 at, const int y, const int z, const vec4 best)
{
    vec4 first = f_feature(cell, seed, at, -1, y, z, best), next = f_feature(cell, seed, at, 0, y, z, first);
    return f_feature(cell, seed, at, 1, y, z, next);
}

vec4 f_feature_layer(const ivec3 cell, const uint seed, const vec3 at, const int z, const vec4 best)
{
    vec4 first = f_feature_row(cell, seed, at, -1, z, best), next = f_feature_row(cell, seed, at, 0, z, first);
    return f_feature_row(cell, seed, at, 1, z, next);
}

vec4 f_nearest_feature(const float a, const float b, const float c, const float seed)
{
    vec3 at;
    ivec3 cell = f_cell(a, b, c, at);
    uint s = uint(seed);
    vec4 first = f_feature_layer(cell, s, at, -1, vec4(vec3(0.0), 1.0)), next = f_feature_layer(cell, s, at, 0, first);
    return f_feature_layer(cell, s, at, 1, next);
}

float f_noise_cellular(const float a, const float b, const float c, const float seed)
{
    return f_known(a, b, c, f_nearest_feature(a, b, c, seed).w);
}
