/* Lists the blocks that a level of culling kept: one invocation a block tested. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/block.h"
#include "shared/invocation.h"
#include "shared/lists.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_gather_push push;
};

void main()
{
    uint at = invocation();
    if (at >= push.tested || push.states.at[at] != 0u)
        return;
    uint rank = push.ranks.at[at];
    push.states.at[at] = rank;
    push.origins.at[rank] = at;
    push.kept.at[rank] = pack_brick(block_at(at, uvec3(push.dense[0], push.dense[1], push.dense[2]), push.parents));
}
