/* GLSL only: the loops of cells. */
#ifndef HEWN_SHADERS_ISO_DUAL_TABLE_H
#define HEWN_SHADERS_ISO_DUAL_TABLE_H

#define DUAL_NO_FACE 6u

/* hewn_dual_table. */
layout(set = 0, binding = 0, scalar) uniform Table
{
    uvec3 table[512];
};

uvec3 dual_entry(uint pattern, bool turned)
{
    return table[2u * pattern + (turned ? 1u : 0u)];
}

uint entry_loops(uvec3 entry)
{
    return entry.x & 7u;
}

uint entry_doubtful_face(uvec3 entry)
{
    return entry.x >> 4;
}

/* The edges of a loop, a bit each. */
uint entry_loop_edges(uvec3 entry, uint loop)
{
    return (loop < 2u ? entry.y : entry.z) >> 16u * (loop & 1u) & 0xFFFu;
}

#endif
