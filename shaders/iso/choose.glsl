/* Tests blocks by interval arithmetic over their parents' lists, and counts what of a list a block will keep: one
 * invocation a block. */
#include "iso/grid.h"
#include "iso/choices.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_choose_push push;
};

/* What the block holds: 0 where it may hold surface, else a stand-in. Its choices are written either way. */
uint block_state(uvec3 block, uint first_choice)
{
    uvec3 cells = uvec3(push.grid.cells[0], push.grid.cells[1], push.grid.cells[2]);
    uvec3 first = block * push.size;
    bool beyond = any(greaterThanEqual(first, cells + push.grid.open));
    first = min(first, cells);
    uvec3 last = min(first + push.size, cells);
    vec2 sides[3];
    for (uint axis = 0u; axis < 3u; axis++)
        sides[axis] = vec2(sample_coordinate(push.grid, axis, first[axis]), sample_coordinate(push.grid, axis, last[axis]));
    vec2 range = field_choose(sides[0], sides[1], sides[2], hewn_words(uvec2(push.choices)), first_choice);
    if (beyond || range.x >= 0.0)
        return HEWN_ALL_OUTSIDE;
    bool at_bounds = any(equal(first, uvec3(0u))) || any(equal(last, cells));
    if (range.y < 0.0 && (push.grid.open != 0u || !at_bounds))
        return HEWN_ALL_INSIDE;
    return 0u;
}

void main()
{
    /* Nobody leaves: a subgroup reads the list that it shares together. */
    uint own = invocation(), at = min(own, push.tested - 1u);
    uvec3 dense = uvec3(push.dense[0], push.dense[1], push.dense[2]);
    uint first_choice = select_parent(at, dense.x != 0u, push.parent_ranges);
    uint state = block_state(block_at(at, dense, push.parents), first_choice);
    if (own != at)
        return;
    push.states.at[at] = state;
    push.flags.at[at] = state == 0u ? 1u : 0u;
    uint kept = 0u;
    if (state == 0u)
        kept = field_keep(hewn_words(uvec2(push.choices)), first_choice, false, hewn_words(uvec2(push.choices)), 0u);
    push.lengths.at[at] = kept;
}
