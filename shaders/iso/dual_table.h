/* GLSL only: the loops of cells. */
#ifndef HEWN_SHADERS_ISO_DUAL_TABLE_H
#define HEWN_SHADERS_ISO_DUAL_TABLE_H

#define DUAL_NO_FACE 6u

/* hewn_dual_table, four words an entry. */
layout(set = 0, binding = 0, scalar) uniform Table
{
    uvec4 table[512];
};

uvec4 dual_entry(uint pattern, bool turned)
{
    return table[2u * pattern + (turned ? 1u : 0u)];
}

uint entry_loops(uvec4 entry)
{
    return entry.x & 7u;
}

uint entry_doubtful_face(uvec4 entry)
{
    return entry.x >> 4;
}

/* The edges of a loop, a bit each. */
uint entry_loop_edges(uvec4 entry, uint loop)
{
    return (loop < 2u ? entry.y : entry.z) >> 16u * (loop & 1u) & 0xFFFu;
}

uint entry_edge_loop(uvec4 entry, uint edge)
{
    return entry.w >> 2u * edge & 3u;
}

#endif
