/* GLSL only: a walk through the cells of a brick that hold surface, and their records in the table of configurations.
 */
#ifndef HEWN_SHADERS_ISO_WALK_H
#define HEWN_SHADERS_ISO_WALK_H

#include "iso/brick.h"

#define MC33_DECIDES 0x80000000u

/* The kernel's own: a cell by its sample's number in the brick, and its pattern. */
void visit_cell(uint slot, uint number, uint pattern);

void walk_cells(Uints links, Uints signs, uvec3 base, uvec3 cells, uint slot)
{
    uint link = slot * HEWN_BRICK_LINKS;
    uvec4 slots = lower_slots(links, link);
    Layer lower = load_layer(signs, slots, 0u);
    for (uint z = 0u; z < 8u; z++) {
        Layer upper = load_layer_above(signs, links, link, slots, z);
        for (uint half_of = 0u; half_of < 2u; half_of++) {
            uvec4 under = lower.rows[half_of], over = upper.rows[half_of];
            uint word = 2u * z + half_of;
            uint cut = surface_cells(under, over, below(base, word, cells));
            while (cut != 0u) {
                uint bit = uint(findLSB(cut));
                cut &= cut - 1u;
                visit_cell(slot, 32u * word + bit, cell_pattern(under, over, bit));
            }
        }
        lower = upper;
    }
}

/* Where a record's triangles begin. */
uint record_triangles(uint place, uint centres)
{
    return place + 1u + ((centres + 1u) >> 1);
}

/* Half `which` of the words from `place` on. */
uint half_word(Uints table, uint place, uint which)
{
    return table.at[place + (which >> 1)] >> 16u * (which & 1u) & 0xFFFFu;
}

#endif
