/* Evaluates the samples of active bricks and keeps one bit of each: one invocation a sign word, four rows of eight, or where
 * subgroups read lists together two of them. */
#include "iso/grid.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_sign_push push;
};

/* From so many instructions on it pays to ask which of them matter to a few words. */
const uint LONG = 24u;

float sample_x(uint i)
{
    return sample_coordinate(push.grid, 0u, i);
}

/* Which samples of an axis count from `first` on: not those past the grid and, unless it is open, not those on the bounds. */
uint counting(uint axis, uint first)
{
    uint lo = push.grid.open != 0u ? 0u : 1u;
    uint hi = push.grid.cells[axis] + push.grid.open; /* exclusive */
    uint mask = 0u;
    for (uint i = 0u; i < 8u; i++)
        mask |= first + i >= lo && first + i < hi ? 1u << i : 0u;
    return mask;
}

void find_word(uvec3 first, uint word, uint at)
{
    uint layer = word >> 1, row = 4u * (word & 1u);
    uint columns = counting(0u, first.x), rows = counting(1u, first.y) >> row;
    bool layer_counts = (counting(2u, first.z) >> layer & 1u) != 0u;
    float z = sample_coordinate(push.grid, 2u, first.z + layer);
    vec4 y;
    uint counts = 0u;
    for (uint i = 0u; i < 4u; i++) {
        y[i] = sample_coordinate(push.grid, 1u, first.y + row + i);
        counts |= layer_counts && (rows >> i & 1u) != 0u ? columns << 8u * i : 0u;
    }
    field_narrow(vec2(sample_x(first.x), sample_x(first.x + 7u)), vec2(y.x, y.w), vec2(z), counts != 0u, LONG);
    push.signs.at[at] = field_word_inside(first.x, y, z) & counts;
}

void main()
{
#ifdef FIELD_TOGETHER
    const uint each = 2u;
#else
    const uint each = 1u;
#endif
#ifdef FIELD_LISTED
    uint own = spread_invocation();
#else
    uint own = invocation();
#endif
    uint a_brick = HEWN_BRICK_WORDS / each, slot = own / a_brick;
    if (slot >= push.count) /* all of a brick's invocations */
        return;
    uvec3 first = 8u * unpack_brick(push.bricks.at[slot]);
    field_select(slot);
    for (uint i = 0u; i < each; i++) {
        uint word = own % a_brick + i * a_brick;
        find_word(first, word, slot * HEWN_BRICK_WORDS + word);
    }
}
