/* GLSL only: records of the vertices on a brick's edges. `packed`: the brick's coordinates. */
#ifndef HEWN_SHADERS_ISO_SPREAD_H
#define HEWN_SHADERS_ISO_SPREAD_H

#include "iso/brick.h"

/* Steps through the brick's words and their bits in one loop, so that lanes with many bits in one word do not hold the
 * others up. */
void spread_vertices(Uints edges, Uints vertices, uint slot, uint packed, uint vertex)
{
    uint word = 0u, mask = 0u, short_brick = shorten_brick(packed) << 11;
    uint pair = 2u * slot * HEWN_BRICK_EDGE_WORDS;
    while (word < HEWN_BRICK_EDGE_WORDS || mask != 0u) {
        if (mask == 0u) {
            mask = edges.at[pair];
            edges.at[pair + 1u] = vertex;
            pair += 2u;
            word++;
        }
        if (mask != 0u) {
            vertices.at[3u * vertex] = packed;
            vertices.at[3u * vertex + 1u] = 32u * (word - 1u) + uint(findLSB(mask)) + short_brick;
            mask &= mask - 1u;
            vertex++;
        }
    }
}

#endif
