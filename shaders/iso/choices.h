/* GLSL only: where the choices of a tested block stand, and whose list they are about. */
#ifndef HEWN_SHADERS_ISO_CHOICES_H
#define HEWN_SHADERS_ISO_CHOICES_H

/* Selects the parent's list; returns the first word of the block's choices, of which there are `words`. */
uint select_parent(uint at, bool top, Uints parent_ranges, out uint words)
{
    words = ((field_end - field_begin) + 15u) >> 4;
    if (top)
        return at * words;
    uint parent = at >> 6;
    field_select(parent);
    words = (parent_ranges.at[2u * parent + 1u] + 15u) >> 4;
    return 4u * parent_ranges.at[2u * parent] + 64u * parent + (at & 63u) * words;
}

#endif
