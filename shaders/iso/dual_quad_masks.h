/* GLSL only: the quads that a cell owns. */
#ifndef HEWN_SHADERS_ISO_DUAL_QUAD_MASKS_H
#define HEWN_SHADERS_ISO_DUAL_QUAD_MASKS_H

#include "iso/brick.h"

/* A cell owns the quads of its edges 3, 7 and 11, the far ones along each axis: the edge's other three cells are above.
 * Bit i of component a: cell i of the word owns a quad around its edge along axis a, which is crossed and has four
 * cells. */
uvec3 own_quads(uvec4 lower, uvec4 upper, uvec3 first, uint word, uvec3 cells)
{
    uvec3 crossed = upper.www ^ uvec3(upper.zy, lower.w);
    uvec3 inner = cells - 1u;
    crossed.x &= below(first, word, uvec3(cells.x, inner.yz));
    crossed.y &= below(first, word, uvec3(inner.x, cells.y, inner.z));
    crossed.z &= below(first, word, uvec3(inner.xy, cells.z));
    return crossed;
}

#endif
