/* The vertices of a cell in the dual methods: one for each loop that the surface draws around the cell. Derived, not
 * listed. After Nielson 2004, 'Dual marching cubes', and Schaefer, Ju and Warren 2007, 'Manifold dual contouring'.
 *
 * Loops are those of marching cubes: on an ambiguous face the outside is joined. Each crossed grid edge becomes a quad
 * between the loops that pass it in its four cells, and each cut on a face an edge between the loops that it is part of
 * in the two cells. The quads around a vertex follow its loop once around, so they are one ring.
 *
 * One thing can go wrong: where both cuts of an ambiguous face belong to one loop in both cells, the two cuts become
 * two edges between the same two vertices. (It is the only way; Wenger 2013, 'Isosurfaces', chapter 3.) A face whose
 * two cuts belong to one loop is called doubtful; where it is doubtful in both of its cells, the inside is joined there
 * instead, in both. What makes that enough is enumerated in tests/unit/test_dual_cells.c: of 256 patterns 36 have a
 * doubtful face, and it is their only ambiguous one; their one loop then becomes two with one of the new cuts each. So
 * no turn can undo another or make a new doubtful face, and whether a face is turned depends on two patterns alone. */
#ifndef HEWN_SRC_ISO_DUAL_CELLS_H
#define HEWN_SRC_ISO_DUAL_CELLS_H

#include "hewn/base.h"

#define HEWN_DUAL_MOST_LOOPS 4
#define HEWN_DUAL_NO_FACE 6u

typedef struct hewn_dual_cell {
    uint32_t loop_count;
    uint32_t edges[HEWN_DUAL_MOST_LOOPS]; /* that each loop passes, a bit each; loops by their lowest edge */
    uint32_t next[12]; /* the edge after each crossed one, the inside to the right seen from outside the cell */
} hewn_dual_cell;

/* The loops of a pattern of corner signs, bit c set where corner c is inside. `turned`: bit f set where the inside is
 * joined across face f; only ambiguous faces matter. */
void hewn_dual_cell_derive(uint32_t pattern, uint32_t turned, hewn_dual_cell *out);

/* The face whose two cuts belong to one loop, or HEWN_DUAL_NO_FACE. */
uint32_t hewn_dual_doubtful_face(uint32_t pattern);

/* As shaders read it. Entry 2 * pattern is the pattern's own, entry 2 * pattern + 1 that with its doubtful face turned.
 * Word 0: number of loops in bits 0 to 2, doubtful face in bits 4 to 6. Words 1 and 2: edges of loops 0 and 1, 2 and 3,
 * 16 bits each. */
#define HEWN_DUAL_ENTRY_WORDS 3
typedef struct hewn_dual_table {
    uint32_t words[512][HEWN_DUAL_ENTRY_WORDS];
} hewn_dual_table;

void hewn_dual_table_derive(hewn_dual_table *out);

#endif
