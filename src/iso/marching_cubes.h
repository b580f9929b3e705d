/* The triangles of marching cubes for each of the 256 patterns of corner signs, derived, not listed.
 *
 * One rule settles every ambiguous face, the same seen from both of its cells: inside corners are cut off one by one
 * (outside stays connected across the face). The cuts on the six faces join into closed loops around the cell, and
 * every loop is triangulated without a diagonal that lies in a face of the cell, since the neighbouring cell could draw
 * the same one. So each face cut is shared by exactly two loops and each diagonal belongs to one cell: the mesh is a
 * closed 2-manifold for any signs. Lorensen and Cline 1987; the face rule is one of the repairs discussed by Nielson
 * and Hamann 1991. */
#ifndef HEWN_SRC_ISO_MARCHING_CUBES_H
#define HEWN_SRC_ISO_MARCHING_CUBES_H

#include "hewn/base.h"

#define HEWN_MC_MAX_TRIANGLES 6
#define HEWN_MC_ENTRY_WORDS 4

/* An entry as shaders read it: word 0 is the number of triangles; then three 4-bit edge numbers a triangle, eight to a
 * word. */
typedef struct hewn_mc_table {
    uint32_t words[256][HEWN_MC_ENTRY_WORDS];
} hewn_mc_table;

/* Fills the table. Bit c of a pattern is set where corner c is inside. Triangles turn counter-clockwise seen from
 * outside the shape. */
void hewn_mc_table_derive(hewn_mc_table *out);

#endif
