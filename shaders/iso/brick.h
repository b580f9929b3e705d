/* GLSL only: bricks by coordinate, and the signs of a brick walked layer by layer. */
#ifndef HEWN_SHADERS_ISO_BRICK_H
#define HEWN_SHADERS_ISO_BRICK_H

#include "shared/iso.h"

uvec3 unpack_brick(uint packed)
{
    return uvec3(packed, packed >> 10, packed >> 20) & 1023u;
}

uint pack_brick(uvec3 brick)
{
    return brick.x | brick.y << 10 | brick.z << 20;
}

/* Seven bits an axis, which is enough for grids of up to HEWN_SHORT_SAMPLES. */
uint shorten_brick(uint packed)
{
    return (packed & 127u) | (packed >> 10 & 127u) << 7 | (packed >> 20 & 127u) << 14;
}

uvec3 unpack_short_brick(uint packed)
{
    return uvec3(packed, packed >> 7, packed >> 14) & 127u;
}

/* Sign word of a slot, or what a stand-in says. */
uint sign_word(Uints signs, uint slot, uint word)
{
    uint bits = slot == HEWN_ALL_INSIDE ? 0xFFFFFFFFu : 0u;
    if (slot < HEWN_ALL_OUTSIDE)
        bits = signs.at[slot * HEWN_BRICK_WORDS + word];
    return bits;
}

/* A layer of samples in its two words (rows 0 to 3 and 4 to 7), each as it is and shifted by one sample in x, in y and
 * in both. */
struct Layer {
    uvec4 rows[2];
};

uvec4 shifted_rows(uint own, uint next, uint beside, uint beside_next)
{
    uint up = own >> 8 | next << 24, beside_up = beside >> 8 | beside_next << 24;
    uint right = (own >> 1 & 0x7F7F7F7Fu) | (beside & 0x01010101u) << 7;
    uint right_up = (up >> 1 & 0x7F7F7F7Fu) | (beside_up & 0x01010101u) << 7;
    return uvec4(own, right, up, right_up);
}

/* `slots` are the brick's own and its neighbours in x, in y and in both. */
Layer load_layer(Uints signs, uvec4 slots, uint layer)
{
    uint first = sign_word(signs, slots.x, 2u * layer), second = sign_word(signs, slots.x, 2u * layer + 1u);
    uint beside = sign_word(signs, slots.y, 2u * layer), beside_second = sign_word(signs, slots.y, 2u * layer + 1u);
    uint up = sign_word(signs, slots.z, 2u * layer), beside_up = sign_word(signs, slots.w, 2u * layer);
    Layer loaded;
    loaded.rows[0] = shifted_rows(first, second, beside, beside_second);
    loaded.rows[1] = shifted_rows(second, up, beside_second, beside_up);
    return loaded;
}

/* The layer above layer z: in the brick itself, or the lowest one of those that `links` name from 4 on. */
Layer load_layer_above(Uints signs, Uints links, uint link, uvec4 slots, uint z)
{
    uvec4 above = slots;
    if (z == 7u)
        above = uvec4(links.at[link + 4u], links.at[link + 5u], links.at[link + 6u], links.at[link + 7u]);
    return load_layer(signs, above, (z + 1u) & 7u);
}

uvec4 lower_slots(Uints links, uint link)
{
    return uvec4(links.at[link], links.at[link + 1u], links.at[link + 2u], links.at[link + 3u]);
}

/* Bit i of component a is set where sample i of the word has a coordinate below `limit` along axis a. */
uvec3 below_each(uvec3 base, uint word, uvec3 limit)
{
    uint z = base.z + (word >> 1);
    uint columns = limit.x > base.x ? min(limit.x - base.x, 8u) : 0u;
    uint row = columns == 8u ? 0xFFu : (1u << columns) - 1u;
    uint y = base.y + 4u * (word & 1u);
    uint rows = limit.y > y ? min(limit.y - y, 4u) : 0u;
    return uvec3(row * 0x01010101u, rows == 4u ? ~0u : (1u << 8u * rows) - 1u, z < limit.z ? ~0u : 0u);
}

/* The same for all axes at once: cells exist there. */
uint below(uvec3 base, uint word, uvec3 limit)
{
    uvec3 each = below_each(base, word, limit);
    return each.x & each.y & each.z;
}

/* Which cells between two layers' words hold surface. */
uint surface_cells(uvec4 lower, uvec4 upper, uint exist)
{
    uvec4 any = lower | upper, all = lower & upper;
    return (any.x | any.y | any.z | any.w) & ~(all.x & all.y & all.z & all.w) & exist;
}

/* The pattern of corner signs of the cell at `bit`. */
uint cell_pattern(uvec4 lower, uvec4 upper, uint bit)
{
    uvec4 corners = (lower >> bit & 1u) | (upper >> bit & 1u) << 4;
    return corners.x | corners.y << 1 | corners.z << 2 | corners.w << 3;
}

#endif
