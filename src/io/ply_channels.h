/* The values of a PLY element while they are read, and the channels that they become. */
#ifndef HEWN_SRC_IO_PLY_CHANNELS_H
#define HEWN_SRC_IO_PLY_CHANNELS_H

#include "io/ply_layout.h"

/* Room for the values of `count` items, lists aside. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_ply_layout_begin(hewn_ply_layout *layout, uint64_t count, hewn_error *error);

/* Room for so many values of a list. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_ply_column_reserve(hewn_ply_column *column, size_t count, hewn_error *error);

/* Keeps a face that was read, of so many corners: its lists must have as many values for each corner as those of other
 * faces, or none, which means zeroes. HEWN_BAD_INPUT, naming the line of `scan`; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_ply_layout_end_item(hewn_ply_layout *layout, uint64_t corners, const hewn_scan *scan,
                                     hewn_error *error);

/* Forgets what lists had for the face. */
void hewn_ply_layout_drop_item(hewn_ply_layout *layout);

/* Hands over the positions, or NULL. */
void hewn_ply_layout_take_positions(hewn_ply_layout *layout, double **out);

/* Makes the values channels of a model; those of the layout's faces begin at face `first`, and the others get zeroes.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_ply_channels_add(hewn_model *model, hewn_ply_layout *layout, uint64_t first, hewn_error *error);

/* Takes a comment "value DOMAIN CHANNEL NUMBER = NAME", as Hewn writes it, into the model; passes over any other.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_ply_channels_name(hewn_model *model, hewn_word comment, hewn_error *error);

/* How those comments call a domain: "vertex", "corner" or "face". */
const char *hewn_ply_domain_name(hewn_domain domain);

#endif
