/* Tests blocks of cells by interval arithmetic: one invocation a block. */
#include "iso/grid.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_cull_push push;
};

/* What the block holds: 0 where it may hold surface, else a stand-in. */
uint block_state(uvec3 block)
{
    uvec3 cells = uvec3(push.grid.cells[0], push.grid.cells[1], push.grid.cells[2]);
    uvec3 first = block * push.size;
    if (any(greaterThanEqual(first, cells + push.grid.open)))
        return HEWN_ALL_OUTSIDE;
    uvec3 last = min(first + push.size, cells);
    vec2 sides[3];
    for (uint axis = 0u; axis < 3u; axis++)
        sides[axis] = vec2(sample_coordinate(push.grid, axis, first[axis]), sample_coordinate(push.grid, axis, last[axis]));
    vec2 range = field_interval(sides[0], sides[1], sides[2]);
    if (range.x >= 0.0)
        return HEWN_ALL_OUTSIDE;
    bool at_bounds = any(equal(first, uvec3(0u))) || any(equal(last, cells));
    if (range.y < 0.0 && (push.grid.open != 0u || !at_bounds))
        return HEWN_ALL_INSIDE;
    return 0u;
}

void main()
{
    uint at = invocation();
    if (at >= push.tested.at[0])
        return;
    uvec3 dense = uvec3(push.dense[0], push.dense[1], push.dense[2]);
    uint state = block_state(block_at(at, dense, push.parents));
    push.states.at[at] = state;
    push.flags.at[at] = state == 0u ? 1u : 0u;
}
