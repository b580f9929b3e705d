/* GLSL only: single cells, by their lowest sample, and where their loops' numbers are. */
#ifndef HEWN_SHADERS_ISO_DUAL_LOOPS_H
#define HEWN_SHADERS_ISO_DUAL_LOOPS_H

#include "iso/brick.h"

/* The brick that owns sample `at` of a brick, which may lie one brick further along each axis. */
uint owner_slot(Uints links, uint slot, uvec3 at)
{
    uvec3 beyond = at >> 3;
    uint link = beyond.x | beyond.y << 1 | beyond.z << 2;
    uint owner = slot;
    if (link != 0u)
        owner = links.at[slot * HEWN_BRICK_LINKS + link];
    return owner;
}

uint sample_number(uvec3 at)
{
    return (at.x & 7u) | (at.y & 7u) << 3 | (at.z & 7u) << 6;
}

/* The pattern of corner signs of the cell at `at`; all its samples are within a brick of the slot's. */
uint load_pattern(Uints links, Uints signs, uint slot, uvec3 at)
{
    uint pattern = 0u;
    for (uint corner = 0u; corner < 8u; corner++) {
        uvec3 there = at + (uvec3(corner, corner >> 1, corner >> 2) & 1u);
        uint number = sample_number(there);
        uint word = sign_word(signs, owner_slot(links, slot, there), number >> 5);
        pattern |= (word >> (number & 31u) & 1u) << corner;
    }
    return pattern;
}

/* Where the words of HEWN_BRICK_DUAL_WORDS are that know the cell. */
uint loop_words(uint slot, uint number)
{
    return slot * HEWN_BRICK_DUAL_WORDS + (number >> 5) * HEWN_DUAL_WORDS;
}

#endif
