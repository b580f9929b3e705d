/* Words that fields read from memory, and samples at points. src/field/sampling.h has their layout. */
//: words
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer f_samples { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer f_two_samples { uvec2 at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer f_three_samples { uvec3 at; };

/* An address comes as three whole numbers of 22 bits. */
uvec2 f_samples_of(const float low, const float middle, const float high)
{
    uint a = uint(low), b = uint(middle), c = uint(high);
    return uvec2(a | b << 22, b >> 10 | c << 12);
}

/* The address of a word. Words that lie side by side are read at once: CPU drivers read lane by lane. */
uvec2 f_word_of(const uvec2 s, const uint word)
{
    uint carry, low = uaddCarry(s.x, word << 2u, carry);
    return uvec2(low, s.y + (word >> 30u) + carry);
}

vec2 f_pair(const uvec2 s, const uint word)
{
    return uintBitsToFloat(f_two_samples(f_word_of(s, word)).at);
}

//: sampled words
#define F_SAMPLED float low, const float middle, const float high, const float nx, const float ny, const float nz, \
    const float grows, const float most

/* The samples at the corners of the cell that a point is in, low ones along z first; how far along it is, and how many
 * such cells there are in one of the lattice; and what is left of the point past the lattice. */
struct f_cell_of_samples {
    vec4 low, high;
    vec3 t, beyond;
    float scale;
};

precise f_cell_of_samples f_find_samples(const uvec2 s, const vec3 at, const vec3 n)
{
    precise vec3 u = at + n * 0.5;
    vec3 inside = mix(mix(u, vec3(0.0), lessThan(u, vec3(0.0))), n, greaterThan(u, n));
    vec3 last = max(n - 1.0, vec3(0.0));
    uvec3 cells = uvec3(n), cell = uvec3(mix(floor(inside), last, greaterThan(inside, last)));
    uvec3 bricks = max((cells + 7u) >> 3u, uvec3(1u)), brick = cell >> 3u;
    uint count = bricks.x * bricks.y * bricks.z;
    uint fine = f_samples(s).at[16u + brick.x + bricks.x * (brick.y + bricks.y * brick.z)];
    bool coarse = fine == 0u, flat_one = cells.z == 0u;
    uint row = coarse ? bricks.x + 1u : 9u, layer = coarse ? row * (bricks.y + 1u) : 81u;
    layer = flat_one ? 0u : layer;
    uvec3 from = coarse ? brick : cell & 7u;
    uint first = (coarse ? 16u + count : fine) + from.x + row * from.y + layer * from.z;
    f_cell_of_samples r;
    r.scale = f_pick(coarse, 0.125, 1.0);
    precise vec3 beyond = u - inside;
    precise vec3 t = (inside - vec3(coarse ? brick << 3u : cell)) * r.scale;
    r.beyond = beyond;
    r.t = t;
    r.low = vec4(f_pair(s, first), f_pair(s, first + row));
    first += layer;
    r.high = vec4(f_pair(s, first), f_pair(s, first + row));
    return r;
}

precise float f_between_samples(const f_cell_of_samples c)
{
    vec4 plane = c.low + c.t.z * (c.high - c.low);
    vec2 line = plane.xy + c.t.y * (plane.zw - plane.xy);
    return line.x + c.t.x * (line.y - line.x);
}

vec3 f_numbers(const float a, const float b, const float c)
{
    return vec3(f_pick(f_is_nan(a), 0.0, a), f_pick(f_is_nan(b), 0.0, b), f_pick(f_is_nan(c), 0.0, c));
}

precise float f_past_samples(const f_cell_of_samples c, const float value, const float grows)
{
    precise float beyond = (c.beyond.x * c.beyond.x + c.beyond.y * c.beyond.y + c.beyond.z * c.beyond.z) * grows;
    return f_pick(beyond > 0.0, sqrt(beyond + value * value), value);
}

precise float f_sampled(const float a, const float b, const float c, const F_SAMPLED)
{
    uvec2 s = f_samples_of(low, middle, high);
    f_cell_of_samples cell = f_find_samples(s, f_numbers(a, b, c), vec3(nx, ny, nz));
    float value = f_past_samples(cell, f_between_samples(cell), grows);
    bool first = f_is_nan(a, b), second = f_is_nan(c);
    return f_pick(first || second, F_NAN, value);
}
