#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
/* From a count that only the device knows: how much there is of each level, and how many workgroups take it. */
#include "shared/scan.h"

layout(local_size_x = 1) in;
layout(push_constant, scalar) uniform Push
{
    hewn_scan_prepare_push push;
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Levels
{
    hewn_scan_level at[];
};

void main()
{
    Levels levels = Levels(uvec2(push.levels));
    uint count = min(push.counter.at[0], push.capacity);
    for (uint i = 0u; i < HEWN_SCAN_LEVELS; i++) {
        uint blocks = max(count / HEWN_SCAN_BLOCK + uint(count % HEWN_SCAN_BLOCK != 0u), 1u);
        levels.at[i].groups[0] = min(blocks, HEWN_SCAN_ROW);
        levels.at[i].groups[1] = (blocks + HEWN_SCAN_ROW - 1u) / HEWN_SCAN_ROW;
        levels.at[i].groups[2] = 1u;
        levels.at[i].count = count;
        count = blocks;
    }
}
