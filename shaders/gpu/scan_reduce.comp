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
    uint count = level_count();
    uint here = block_count(block, count);
    Uints values = block_values(block);
    uint lane = gl_LocalInvocationID.x;
    uint low = 0u, high = 0u;
    for (uint i = 0u; i < HEWN_SCAN_ITEMS; i++) {
        uint item = i * HEWN_SCAN_GROUP + lane;
        if (item < here) {
            uint value = values.at[item * push.stride];
            low += value;
            high += uint(low < value);
            if (push.stride == 2u)
                high += values.at[item * 2u + 1u];
        }
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
        Uints sum = Uints(advance(uvec2(push.sums), block, 8u));
        sum.at[0] = lows[0];
        sum.at[1] = highs[0];
    }
}
