/* GLSL only: which grid edges are crossed. */
#ifndef HEWN_SHADERS_ISO_CROSSED_H
#define HEWN_SHADERS_ISO_CROSSED_H

#include "iso/brick.h"

/* Writes the crossed edges that leave a word's samples upward, and counts them. `exist`: below_each() of the cells,
 * since an edge along an axis is there where a cell follows along that axis. */
uint write_crossed(Uints edges, uint slot, uint word, uvec4 lower, uvec4 upper, uvec3 exist)
{
    uvec3 crossed = (lower.xxx ^ uvec3(lower.yz, upper.x)) & exist;
    uint at = 2u * (slot * HEWN_BRICK_EDGE_WORDS + word);
    edges.at[at] = crossed.x;
    edges.at[at + 2u * HEWN_BRICK_WORDS] = crossed.y;
    edges.at[at + 4u * HEWN_BRICK_WORDS] = crossed.z;
    ivec3 counts = bitCount(crossed);
    return uint(counts.x + counts.y + counts.z);
}

#endif
