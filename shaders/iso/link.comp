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

#include "iso/slot.h"

void main()
{
    uint at = invocation();
    uint slot = at / HEWN_BRICK_LINKS;
    if (slot >= push.count)
        return;
    uvec3 offset = uvec3(at, at >> 1, at >> 2) & 1u;
    push.links.at[at] = find_slot(unpack_brick(push.bricks.at[slot]) + offset);
}
