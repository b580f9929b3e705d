/* GLSL only: from a brick's coordinates to its slot, down the levels of culling. Included below the kernel's `push`,
 * which has `top`, `levels` and `states` as hewn_link_push has them. */
#ifndef HEWN_SHADERS_ISO_SLOT_H
#define HEWN_SHADERS_ISO_SLOT_H

/* The slot of the brick, or a stand-in: outside where there is no such brick, also below 0 (wrapped around). */
uint find_slot(uvec3 brick)
{
    uvec3 top = uvec3(push.top[0], push.top[1], push.top[2]);
    uvec3 block = brick >> 2u * (push.levels - 1u);
    if (any(greaterThanEqual(block, top)))
        return HEWN_ALL_OUTSIDE;
    uint state = push.states[0].at[block.x + top.x * (block.y + top.y * block.z)];
    for (uint level = 1u; level < push.levels; level++) {
        if (state >= HEWN_ALL_OUTSIDE)
            break;
        uvec3 child = brick >> 2u * (push.levels - 1u - level) & 3u;
        state = push.states[level].at[64u * state + child.x + 4u * child.y + 16u * child.z];
    }
    return state;
}

#endif
