/* GLSL only: where a block of a level lies. Included by the prefix sum's shaders after their push constants `push`. */

/* An address is two words here: 64-bit integers are not everywhere. */
uvec2 advance(uvec2 address, uint times, uint bytes)
{
    uint low, high, carry;
    umulExtended(times, bytes, high, low);
    uint x = uaddCarry(address.x, low, carry);
    return uvec2(x, address.y + high + carry);
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

/* The block's first value: from here on, offsets are small. */
Uints block_values(uint block)
{
    return Uints(advance(uvec2(push.values), block, HEWN_SCAN_BLOCK * 4u * push.stride));
}
