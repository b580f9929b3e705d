#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
/* Replaces the values of each block by their exclusive prefix sums, counted from the start of the level: the level above
 * holds, as prefix sums too, what comes before each block. Only low words take part: prefixes are wanted modulo 2^32. */
#include "shared/scan.h"

layout(local_size_x = HEWN_SCAN_GROUP) in;
layout(push_constant, scalar) uniform Push
{
    hewn_scan_push push;
};

#include "gpu/scan_block.h"

shared uint sums[HEWN_SCAN_GROUP];

void main()
{
    uint block = block_index();
    uint here = block_count(block, level_count());
    uint lane = gl_LocalInvocationID.x;
    Uints values = advance(push.values, block, HEWN_SCAN_BLOCK);
    uint first = lane * HEWN_SCAN_ITEMS;
    uint kept[HEWN_SCAN_ITEMS];
    uint sum = 0u;
    for (uint i = 0u; i < HEWN_SCAN_ITEMS; i++) {
        kept[i] = 0u;
        if (first + i < here)
            kept[i] = values.at[first + i];
        sum += kept[i];
    }
    sums[lane] = sum;
    uint total = sum;
    for (uint step = 1u; step < HEWN_SCAN_GROUP; step *= 2u) {
        barrier();
        uint before = lane >= step ? sums[lane - step] : 0u;
        barrier();
        total += before;
        sums[lane] = total;
    }
    uint prefix = total - sum;
    if (uvec2(push.sums) != uvec2(0) && here > 0u)
        prefix += advance(push.sums, block, 1u).at[0];
    for (uint i = 0u; i < HEWN_SCAN_ITEMS; i++) {
        if (first + i < here)
            values.at[first + i] = prefix;
        prefix += kept[i];
    }
}
