/* Tests blocks by interval arithmetic over their parents' lists, and notes what of a list a block needs: one invocation
 * four blocks in a row, so that one walk serves them all. */
#include "iso/grid.h"
#include "iso/choices.h"

layout(local_size_x = 16) in;
layout(push_constant, scalar) uniform Push
{
    hewn_choose_push push;
};

const uint BLOCKS = 4u;

uvec3 grid_cells()
{
    return uvec3(push.grid.cells[0], push.grid.cells[1], push.grid.cells[2]);
}

/* The block's first and last sample. */
void block_samples(uvec3 block, out uvec3 first, out uvec3 last)
{
    uvec3 cells = grid_cells();
    first = min(block * push.size, cells);
    last = min(first + push.size, cells);
}

/* What the block holds: 0 where it may hold surface, else a stand-in. */
uint block_state(uvec3 block, vec2 range)
{
    uvec3 cells = grid_cells(), first, last;
    block_samples(block, first, last);
    bool beyond = any(greaterThanEqual(block * push.size, cells + push.grid.open));
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
    uint own = BLOCKS * invocation(), begin = min(own, (push.tested - 1u) & ~(BLOCKS - 1u));
    uvec3 dense = uvec3(push.dense[0], push.dense[1], push.dense[2]), blocks[BLOCKS];
    uint stride, choices_at = select_parent(begin, dense.x != 0u, push.parent_ranges, stride);
    uint first_choice[BLOCKS];
    vec2 x[BLOCKS], y[BLOCKS], z[BLOCKS], ranges[BLOCKS];
    [[unroll]] for (uint k = 0u; k < BLOCKS; k++) {
        uint past = begin + k - min(begin + k, push.tested - 1u);
        uvec3 first, last;
        blocks[k] = block_at(begin + k - past, dense, push.parents);
        block_samples(blocks[k], first, last);
        first = max(first, push.beyond) - push.beyond;
        last = min(last + push.beyond, grid_cells());
        first_choice[k] = choices_at + (k - past) * stride;
        x[k] = vec2(sample_coordinate(push.grid, 0u, first.x), sample_coordinate(push.grid, 0u, last.x));
        y[k] = vec2(sample_coordinate(push.grid, 1u, first.y), sample_coordinate(push.grid, 1u, last.y));
        z[k] = vec2(sample_coordinate(push.grid, 2u, first.z), sample_coordinate(push.grid, 2u, last.z));
    }
    field_choose(x, y, z, hewn_words(uvec2(push.choices)), first_choice, ranges);
    for (uint k = 0u; k < BLOCKS; k++) {
        if (own + k < push.tested) {
            uint state = block_state(blocks[k], ranges[k]);
            push.states.at[own + k] = state;
            push.flags.at[own + k] = state == 0u ? 1u : 0u;
        }
    }
}
