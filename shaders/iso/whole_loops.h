/* GLSL only: whether an invocation's loops have all run to their ends. Some CPU drivers give an invocation so many
 * iterations (65,535 on llvmpipe, of all its loops together), and where they are spent each loop that follows ends
 * after its first. So does this one. */
#ifndef HEWN_SHADERS_ISO_WHOLE_LOOPS_H
#define HEWN_SHADERS_ISO_WHOLE_LOOPS_H

/* `count` is any number of things, which is below 2^31: so there are two turns, which no compiler can know. Nor may it
 * be told by the loop's own condition, which it takes for granted behind the loop. */
bool loops_were_cut(uint count)
{
    uint grown = 0u, all = 2u + (count >> 31);
    for (uint turn = 0u; turn < all; turn++)
        grown = 3u * grown + 1u;
    return grown < 4u;
}

#endif
