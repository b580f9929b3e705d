/* GLSL only: what is parked where a dual method's vertex will go. */
#ifndef HEWN_SHADERS_ISO_DUAL_RECORD_H
#define HEWN_SHADERS_ISO_DUAL_RECORD_H

#include "iso/edge_vertex.h"

/* A vertex stands for a loop of a cell: its brick's slot, the cell's place in the brick, the edges that the loop
 * passes, a bit each, and how many loops the cell has. edge_vertex(links, edges, slot, at, edge) numbers the crossing
 * on such an edge. */
struct DualRecord {
    uint slot;
    uvec3 at;
    uint edges;
    uint loops;
};

DualRecord dual_record(Floats positions, uint vertex)
{
    uint packed = floatBitsToUint(positions.at[3u * vertex + 1u]);
    DualRecord record;
    record.slot = floatBitsToUint(positions.at[3u * vertex]);
    record.at = uvec3(packed, packed >> 3, packed >> 6) & 7u;
    record.edges = packed >> 9;
    record.loops = floatBitsToUint(positions.at[3u * vertex + 2u]);
    return record;
}

vec3 load_vector(Floats from, uint at)
{
    return vec3(from.at[3u * at], from.at[3u * at + 1u], from.at[3u * at + 2u]);
}

#endif
