/* Finds the upper neighbours of each active brick by walking the levels of culling down: one invocation a brick and neighbour. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/brick.h"
#include "shared/invocation.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_link_push push;
};

uint find_slot(uvec3 brick)
{
    uvec3 top = uvec3(push.top[0], push.top[1], push.top[2]);
    uvec3 block = brick >> 2u * (push.levels - 1u);
    if (any(greaterThanEqual(block, top)))
        return HEWN_ALL_OUTSIDE;
    uint state = push.states[0].at[block.x + top.x * (block.y + top.y * block.z)];
    for (uint level = 1u; level < push.levels; level++) {
        if (state >= HEWN_ALL_OUTSIDE)
            break;
        uvec3 child = brick >> 2u * (push.levels - 1u - level) & 3u;
        state = push.states[level].at[64u * state + child.x + 4u * child.y + 16u * child.z];
    }
    return state;
}

void main()
{
    uint at = invocation();
    uint slot = at / HEWN_BRICK_LINKS;
    if (slot >= push.count)
        return;
    uvec3 offset = uvec3(at, at >> 1, at >> 2) & 1u;
    push.links.at[at] = find_slot(unpack_brick(push.bricks.at[slot]) + offset);
}
