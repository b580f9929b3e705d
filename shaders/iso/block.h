/* GLSL only: the blocks that culling tests. */
#ifndef HEWN_SHADERS_ISO_BLOCK_H
#define HEWN_SHADERS_ISO_BLOCK_H

#include "iso/brick.h"

/* The coordinates of tested block `at`: in order on the top level (`dense` is its size), else child at % 64 of a
 * parent. */
uvec3 block_at(uint at, uvec3 dense, Uints parents)
{
    if (dense.x != 0u)
        return uvec3(at % dense.x, at / dense.x % dense.y, at / (dense.x * dense.y));
    uvec3 parent = unpack_brick(parents.at[at >> 6]);
    return HEWN_LEVEL_RATIO * parent + (uvec3(at, at >> 2, at >> 4) & 3u);
}

#endif
