/* GLSL only: where the choices of a tested block stand, and whose list they are about. */
#ifndef HEWN_SHADERS_ISO_CHOICES_H
#define HEWN_SHADERS_ISO_CHOICES_H

/* Selects the parent's list; returns the first word of the block's choices. */
uint select_parent(uint at, bool top, Uints parent_ranges)
{
    uint count = (field_end - field_begin) / FIELD_WORDS;
    if (top)
        return at * ((count + 15u) >> 4);
    uint parent = at >> 6;
    field_select(parent);
    count = parent_ranges.at[2u * parent + 1u];
    return 4u * parent_ranges.at[2u * parent] + 64u * parent + (at & 63u) * ((count + 15u) >> 4);
}

#endif
