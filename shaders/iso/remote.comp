/* Marks the blocks of 2 x 2 x 2 cells beyond the neighbourhood of the surface: neither in them nor in those around them
 * does a cell have corners of both signs. One invocation a brick. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/brick.h"
#include "shared/invocation.h"

layout(local_size_x = 32) in;
layout(push_constant, scalar) uniform Push
{
    hewn_remote_push push;
};

#include "iso/slot.h"

uvec2 load_cuts(uvec3 brick)
{
    uint slot = find_slot(brick);
    uvec2 cuts = uvec2(0u); /* where there are no samples of both signs there is no cut */
    if (slot < HEWN_ALL_OUTSIDE)
        cuts = uvec2(push.cuts.at[2u * slot], push.cuts.at[2u * slot + 1u]);
    return cuts;
}

/* What blocks beside them in x, y or z make of a brick's neighbourhood: `side` 0 is the brick before it, 1 itself, 2
 * the one after it. */
uvec2 spread_x(uvec2 cuts, uint side)
{
    uvec2 own = cuts | cuts << 1u & 0xEEEEEEEEu | cuts >> 1u & 0x77777777u;
    return side == 1u ? own : side == 0u ? cuts >> 3u & 0x11111111u : cuts << 3u & 0x88888888u;
}

uvec2 spread_y(uvec2 cuts, uint side)
{
    uvec2 own = cuts | cuts << 4u & 0xFFF0FFF0u | cuts >> 4u & 0x0FFF0FFFu;
    return side == 1u ? own : side == 0u ? cuts >> 12u & 0x000F000Fu : cuts << 12u & 0xF000F000u;
}

uvec2 spread_z(uvec2 cuts, uint side)
{
    uvec2 own = cuts | cuts << 16u | cuts >> 16u | uvec2(cuts.y << 16, cuts.x >> 16);
    return side == 1u ? own : side == 0u ? uvec2(cuts.y >> 16, 0u) : uvec2(0u, cuts.x << 16);
}

void main()
{
    uint slot = invocation();
    if (slot >= push.count)
        return;
    uvec3 first = unpack_brick(push.bricks.at[slot]) - 1u;
    uvec2 near = uvec2(0u);
    for (uint z = 0u; z < 3u; z++) {
        uvec2 near_xy = uvec2(0u);
        for (uint y = 0u; y < 3u; y++) {
            uvec2 near_x = uvec2(0u);
            for (uint x = 0u; x < 3u; x++)
                near_x |= spread_x(load_cuts(first + uvec3(x, y, z)), x);
            near_xy |= spread_y(near_x, y);
        }
        near |= spread_z(near_xy, z);
    }
    push.remote.at[2u * slot] = ~near.x;
    push.remote.at[2u * slot + 1u] = ~near.y;
}
