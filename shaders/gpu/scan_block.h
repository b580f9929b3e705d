/* GLSL only: where a block of a level lies. Included by the prefix sum's shaders after their push constants `push`. */

/* The word `index` of an array. An address is two words here: 64-bit integers are not everywhere. */
Uints advance(Uints array, uint index, uint words)
{
    uvec2 address = uvec2(array);
    uint low, high, carry;
    umulExtended(index, words * 4u, high, low);
    uint x = uaddCarry(address.x, low, carry);
    return Uints(uvec2(x, address.y + high + carry));
}

uint block_index()
{
    return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

uint level_count()
{
    uint count = push.count;
    if (uvec2(push.counter) != uvec2(0))
        count = push.counter.at[0];
    return count;
}

/* How many values of the block there are, 0 for a workgroup past the end. The product may wrap only past the end. */
uint block_count(uint block, uint count)
{
    uint blocks = count / HEWN_SCAN_BLOCK + uint(count % HEWN_SCAN_BLOCK != 0u);
    return block < blocks ? min(count - block * HEWN_SCAN_BLOCK, HEWN_SCAN_BLOCK) : 0u;
}
