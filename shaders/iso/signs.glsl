/* Evaluates the samples of active bricks and keeps one bit of each: one invocation a sign word, four rows of eight. */
#include "iso/grid.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_sign_push push;
};

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

void main()
{
    /* Nobody leaves before the field is evaluated: subgroups may do that together. */
    uint own = invocation(), at = min(own, push.count * HEWN_BRICK_WORDS - 1u);
    uvec3 first = 8u * unpack_brick(push.bricks.at[at / HEWN_BRICK_WORDS]);
    uint word = at % HEWN_BRICK_WORDS;
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
    field_select(at / HEWN_BRICK_WORDS);
    uint inside = field_word_inside(first.x, y, z) & counts;
    if (own == at)
        push.signs.at[at] = inside;
}
