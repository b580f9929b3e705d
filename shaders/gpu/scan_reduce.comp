#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
/* Sums each block of a level into the level above (two words a sum). At the top the sum is the total. */
#include "shared/scan.h"

layout(local_size_x = HEWN_SCAN_GROUP) in;
layout(push_constant, scalar) uniform Push
{
    hewn_scan_push push;
};

#include "gpu/scan_block.h"

shared uint lows[HEWN_SCAN_GROUP];
shared uint highs[HEWN_SCAN_GROUP];

void main()
{
    uint block = block_index();
    uint here = block_count(block, level_count());
    uint lane = gl_LocalInvocationID.x;
    Uints values = advance(push.values, block, HEWN_SCAN_BLOCK);
    uint low = 0u, high = 0u;
    for (uint item = lane; item < here; item += HEWN_SCAN_GROUP) {
        uint value = values.at[item];
        low += value;
        high += uint(low < value);
    }
    if (uvec2(push.highs) != uvec2(0)) {
        values = advance(push.highs, block, HEWN_SCAN_BLOCK);
        for (uint item = lane; item < here; item += HEWN_SCAN_GROUP)
            high += values.at[item];
    }
    lows[lane] = low;
    highs[lane] = high;
    for (uint step = HEWN_SCAN_GROUP / 2u; step > 0u; step /= 2u) {
        barrier();
        if (lane < step) {
            uint other = lows[lane + step];
            lows[lane] += other;
            highs[lane] += highs[lane + step] + uint(lows[lane] < other);
        }
    }
    if (lane == 0u && (here > 0u || block == 0u)) {
        advance(push.sums, block, 1u).at[0] = lows[0];
        advance(push.sum_highs, block, 1u).at[0] = highs[0];
    }
}
