/* Outlines by a table of cells (src/eval/outline_table.h), at points: of all sides only those are looked at that can be
 * nearest in the point's cell. Each is a link of the chain that all of them would be, in the same order. */
//: table edge words
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer f_four_words { vec4 at; };

#define F_TABLE float low, const float middle, const float high, const float size, const float mx, const float my, \
    const float inverse, const float across
#define F_TABLE_NAMES low, middle, high, size, mx, my, inverse, across

/* The place of the first entry's word, and the counts. */
uvec2 f_table_cell(const uvec2 s, const float x, const float y, const float mx, const float my, const float inverse,
                   const float across)
{
    precise vec2 u = vec2((x - mx) * inverse, (y - my) * inverse);
    u = vec2(f_pick(f_is_nan(x), 0.0, u.x), f_pick(f_is_nan(y), 0.0, u.y));
    float far = f_pick(abs(u.x) > abs(u.y), abs(u.x), abs(u.y));
    /* each ring is four times as large as what it surrounds */
    uint ring = far >= 1.0 ? (floatBitsToUint(far) - 0x3F800000u >> 24u) + 1u : 0u, n = uint(across), base = n * n;
    bool close = ring == 0u, beyond = ring > 6u;
    float cells = f_pick(close, across, 8.0), shrunk = uintBitsToFloat(0x3F800000u - (beyond ? 0u : ring << 24u));
    n = close ? n : 8u;
    precise vec2 v = (u * shrunk + 1.0) * (0.5 * cells);
    v = mix(v, vec2(0.0), bvec2(beyond || v.x < 0.0, beyond || v.y < 0.0));
    uvec2 i = min(uvec2(v), uvec2(n - 1u));
    vec2 t = v - vec2(i);
    uint own = i.y * n + i.x, outer = base + 64u * ring - 64u + own, last = base + 384u + (u.x < 0.0 ? 1u : 0u);
    uvec2 cell = floatBitsToUint(f_pair(s, 2u * (close ? own : beyond ? last : outer)));
    while (cell.y >= 0x80000000u) {
        t *= 4.0;
        i = min(uvec2(t), uvec2(3u));
        t -= vec2(i);
        cell = floatBitsToUint(f_pair(s, cell.x + 2u * (4u * i.y + i.x)));
    }
    return cell;
}

/* The square of the distance, below 0 inside: what the last link of the chain gives. */
float f_table_chain(const float x, const float y, const F_TABLE)
{
    uvec2 s = f_samples_of(low, middle, high), cell = f_table_cell(s, x, y, mx, my, inverse, across);
    uint at = cell.x, turns = at + (cell.y >> 14u & 0x3FFFu), end = turns + 5u * (cell.y & 0x3FFFu);
    float chain = (cell.y >> 28u & 1u) != 0u ? -1e29 : 1e29;
    for (; at < turns; at++)
        chain = f_pick(uintBitsToFloat(f_samples(f_word_of(s, at)).at[0]) <= y, -chain, chain);
    for (; at < end; at += 5u) {
        uvec2 word = f_word_of(s, at);
        vec4 side = f_four_words(word).at;
        float by_length = uintBitsToFloat(f_samples(word).at[4]);
        chain = f_edge(chain, x, y, side.x, side.y, side.z, side.w, by_length);
    }
    return chain;
}

//: outline_table table outline
float f_outline_table(const float x, const float y, const F_TABLE)
{
    return f_outline(f_table_chain(x, y, F_TABLE_NAMES), x, y, size);
}
