/* GLSL only: the quads that a cell owns. */
#ifndef HEWN_SHADERS_ISO_DUAL_QUAD_MASKS_H
#define HEWN_SHADERS_ISO_DUAL_QUAD_MASKS_H

#include "iso/brick.h"

/* A cell owns the quads of its edges 3, 7 and 11, the far ones along each axis: the edge's other three cells are above.
 * Bit i of component a: cell i of the word owns a quad around its edge along axis a, which is crossed and has four
 * cells. `exist` and `inner`: below_each() of the cells, and of those that another one follows. */
uvec3 own_quads(uvec4 lower, uvec4 upper, uvec3 exist, uvec3 inner)
{
    uvec3 crossed = upper.www ^ uvec3(upper.zy, lower.w);
    return crossed & exist & inner.yzx & inner.zxy;
}

#endif
