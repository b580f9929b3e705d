/* Marks the blocks of 2 x 2 x 2 cells in which a cell has corners of both signs: one invocation a brick. */
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "iso/brick.h"
#include "shared/invocation.h"

layout(local_size_x = 32) in;
layout(push_constant, scalar) uniform Push
{
    hewn_cut_push push;
};

/* From four rows of eight cells to two rows of four blocks, bit x + 4 y. */
uint halve(uint word)
{
    word |= word >> 1;
    word = (word | word >> 8) & 0x00550055u;
    word = (word | word >> 1) & 0x00330033u;
    word = (word | word >> 2) & 0x000F000Fu;
    return (word | word >> 12) & 0xFFu;
}

void main()
{
    uint slot = invocation();
    if (slot >= push.count)
        return;
    uvec3 base = 8u * unpack_brick(push.bricks.at[slot]);
    uvec3 cells = uvec3(push.cells[0], push.cells[1], push.cells[2]);
    uint link = slot * HEWN_BRICK_LINKS;
    uvec4 slots = lower_slots(push.links, link);
    Layer lower = load_layer(push.signs, slots, 0u);
    uvec2 cuts = uvec2(0u);
    for (uint z = 0u; z < 8u; z++) {
        Layer upper = load_layer_above(push.signs, push.links, link, slots, z);
        uint layer = 0u;
        for (uint half_of = 0u; half_of < 2u; half_of++) {
            uint exist = below(base, 2u * z + half_of, cells);
            layer |= halve(surface_cells(lower.rows[half_of], upper.rows[half_of], exist)) << 8u * half_of;
        }
        layer <<= 16u * (z >> 1 & 1u);
        cuts |= z < 4u ? uvec2(layer, 0u) : uvec2(0u, layer);
        lower = upper;
    }
    push.cuts.at[2u * slot] = cuts.x;
    push.cuts.at[2u * slot + 1u] = cuts.y;
}
