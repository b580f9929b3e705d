/* Tells each brick's upper neighbours that it is their lower one: one invocation a brick and axis. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "shared/invocation.h"
#include "shared/iso.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_link_push push;
};

void main()
{
    uint at = invocation();
    uint slot = at / 3u, axis = at % 3u;
    if (slot >= push.count)
        return;
    uint upper = push.links.at[slot * HEWN_BRICK_LINKS + (1u << axis)];
    if (upper < HEWN_ALL_OUTSIDE)
        push.lower.at[3u * upper + axis] = slot;
}
