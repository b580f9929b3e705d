/* Lists the blocks that a level of culling kept, and sizes the next level's dispatch: one invocation a block tested. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/block.h"
#include "shared/invocation.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_compact_push push;
};

void main()
{
    uint at = invocation();
    if (at == 0u) {
        uint kept = push.control.at[HEWN_CONTROL_KEPT];
        uint next = HEWN_CONTROL_WORDS;
        push.control.at[next + HEWN_CONTROL_TESTED] = 64u * kept;
        push.control.at[next + HEWN_CONTROL_DISPATCH] = min(kept, 32768u);
        push.control.at[next + HEWN_CONTROL_DISPATCH + 1u] = (kept + 32767u) / 32768u;
        push.control.at[next + HEWN_CONTROL_DISPATCH + 2u] = 1u;
    }
    if (at >= push.control.at[HEWN_CONTROL_TESTED] || push.states.at[at] != 0u)
        return;
    uint rank = push.ranks.at[at];
    push.states.at[at] = rank;
    uvec3 dense = uvec3(push.dense[0], push.dense[1], push.dense[2]);
    push.kept.at[rank] = pack_brick(block_at(at, dense, push.parents));
}
