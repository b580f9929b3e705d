/* GLSL only: the numbers of vertices. */
#ifndef HEWN_SHADERS_ISO_EDGE_VERTEX_H
#define HEWN_SHADERS_ISO_EDGE_VERTEX_H

#include "iso/brick.h"

/* The vertex on an edge of the cell at `sample_at`: the brick that owns the edge knows its rank. Where a part of the
 * grid ends, nobody may own it: then what comes out is some number, and of no use. */
uint edge_vertex(Uints links, Uints edges, uint slot, uvec3 sample_at, uint edge)
{
    uint axis = edge >> 2;
    uint low = edge & 1u, high = edge >> 1 & 1u;
    uvec3 at = sample_at;
    at += axis == 0u ? uvec3(0u, low, high) : axis == 1u ? uvec3(low, 0u, high) : uvec3(low, high, 0u);
    uvec3 beyond = at >> 3;
    uint link = beyond.x | beyond.y << 1 | beyond.z << 2;
    uint owner = slot;
    if (link != 0u)
        owner = links.at[slot * HEWN_BRICK_LINKS + link];
    owner = owner < HEWN_ALL_OUTSIDE ? owner : slot;
    at &= 7u;
    uint number = at.x | at.y << 3 | at.z << 6;
    uint pair = 2u * (owner * HEWN_BRICK_EDGE_WORDS + axis * HEWN_BRICK_WORDS + (number >> 5));
    uint before = edges.at[pair] & ((1u << (number & 31u)) - 1u);
    return edges.at[pair + 1u] + uint(bitCount(before));
}

#endif
