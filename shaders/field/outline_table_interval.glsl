/* Bounds of outlines that go by tables. */
//: outline_table
precise vec2 f_outline_table(const vec2 x, const vec2 y, const F_TABLE)
{
    vec2 m = vec2(0.5 * x.x + 0.5 * x.y, 0.5 * y.x + 0.5 * y.y);
    return f_outline(vec2(f_table_chain(m.x, m.y, F_TABLE_NAMES)), x, y, size);
}
