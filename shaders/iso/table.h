/* GLSL only: the triangles of marching cubes. */
#ifndef HEWN_SHADERS_ISO_TABLE_H
#define HEWN_SHADERS_ISO_TABLE_H

/* hewn_mc_table, four words a pattern. In a uniform buffer, whose words cost less to gather on a CPU device. */
layout(set = 0, binding = 0, scalar) uniform Table
{
    uvec4 table[256];
};

/* The three edges of a pattern's triangle, four bits each: two triangles to a word. */
uint triangle_edges(uvec4 entry, uint which)
{
    uint word = which < 2u ? entry.y : which < 4u ? entry.z : entry.w;
    return word >> 16u * (which & 1u);
}

#endif
