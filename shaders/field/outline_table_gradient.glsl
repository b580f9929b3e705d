/* Outlines that go by tables, with their gradients. */
//: outline_table
precise vec4 f_outline_table(const vec4 x, const vec4 y, const F_TABLE)
{
    uvec2 s = f_samples_of(low, middle, high), cell = f_table_cell(s, x.w, y.w, mx, my, inverse, across);
    uint at = cell.x, turns = at + (cell.y >> 14u & 0x3FFFu), end = turns + 5u * (cell.y & 0x3FFFu);
    vec4 chain = vec4(0.0, 0.0, 0.0, (cell.y >> 28u & 1u) != 0u ? -1e29 : 1e29);
    for (; at < turns; at++)
        chain.w = f_pick(uintBitsToFloat(f_samples(f_word_of(s, at)).at[0]) <= y.w, -chain.w, chain.w);
    for (; at < end; at += 5u) {
        uvec2 word = f_word_of(s, at);
        vec4 side = f_four_words(word).at;
        float by_length = uintBitsToFloat(f_samples(word).at[4]);
        chain = f_edge(chain, x, y, side.x, side.y, side.z, side.w, by_length);
    }
    return f_outline(chain, x, y, size);
}
