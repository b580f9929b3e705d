/* Takes back the blocks that a level of culling kept but a part of the grid does not need: one invocation a block
 * tested. Needed are the part's own bricks, and those around them whose signs decide about what is the part's own: one
 * below and two above along each axis, since a brick's cells and edges reach into its upper neighbours, and what is
 * numbered there into theirs. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/block.h"
#include "shared/invocation.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_clip_push push;
};

const uint BELOW = 1u; /* bricks */
const uint ABOVE = 2u;

/* The number of the block's first brick in the order of bricks. */
uint first_brick(uvec3 block)
{
    uvec3 top = block >> 2u * push.level;
    uint number = top.x + push.top[0] * (top.y + push.top[1] * top.z);
    for (uint digit = push.level; digit > 0u; digit--) {
        uvec3 child = block >> 2u * (digit - 1u) & 3u;
        number = 64u * number + child.x + 4u * child.y + 16u * child.z;
    }
    return number << 6u * push.below;
}

/* Whether the block holds bricks of the part's own. */
bool is_own(uvec3 block)
{
    uint first = first_brick(block);
    return first < push.end && first + (1u << 6u * push.below) > push.begin;
}

bool is_needed(uvec3 block)
{
    if (is_own(block))
        return true;
    /* From a needed brick an own one is found the other way. */
    uint above = push.below == 0u ? BELOW : 1u, under = push.below == 0u ? ABOVE : 1u, side = under + 1u + above;
    uvec3 limit = uvec3(push.top[0], push.top[1], push.top[2]) << 2u * push.level;
    for (uint i = 0u; i < side * side * side; i++) {
        /* Below 0 wraps around to beyond the limit. */
        uvec3 near = block + uvec3(i % side, i / side % side, i / (side * side)) - under;
        if (all(lessThan(near, limit)) && is_own(near))
            return true;
    }
    return false;
}

void main()
{
    uint at = invocation();
    if (at >= push.tested || push.states.at[at] != 0u)
        return;
    if (is_needed(block_at(at, uvec3(push.dense[0], push.dense[1], push.dense[2]), push.parents)))
        return;
    push.states.at[at] = HEWN_ALL_OUTSIDE;
    push.flags.at[at] = 0u;
}
