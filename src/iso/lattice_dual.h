/* Dual meshes of a lattice: a vertex in each cell for each loop of the surface around it, and a quad for each crossed
 * edge, between its four cells. Loops are those of iso/dual_cells.h, so the mesh is a manifold. Vertices lie at the
 * mean of the crossings that their loop passes (Gibson 1998, 'Constrained elastic surface nets', without its
 * relaxation), or where the planes of these meet (Ju, Losasso, Schaefer and Warren 2002, 'Dual contouring of Hermite
 * data').
 *
 * Crossings are found as vertices on edges are by other methods, into a mesh of their own. */
#ifndef HEWN_SRC_ISO_LATTICE_DUAL_H
#define HEWN_SRC_ISO_LATTICE_DUAL_H

#include "iso/lattice_cells.h"
#include "iso/mc33.h"

/* Cells as records of the other table: no triangles, and a word for each vertex, whose bits are the edges of its loop.
 * What decides is whether a neighbour is in doubt about the same face; its number is in bits 16 to 18 of a head.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_lattice_dual_table_make(hewn_mc33_table *out, hewn_error *error);

/* The record of the cell at (i, j, k), whose head has HEWN_MC33_DECIDES. */
uint32_t hewn_lattice_dual_decide(const hewn_lattice *lattice, uint32_t head, const uint32_t at[3]);

/* Places the vertices of a cell at `i` of its row, between crossings `names`, and puts their numbers into the quads of
 * these. */
void hewn_lattice_dual_place(hewn_lattice_cell_row *row, uint32_t i, const uint32_t names[16], uint32_t pattern,
                             const uint32_t *record, bool turn);

/* Turns quads, the first four of six indices each, into triangles: cut along the shorter diagonal, or where vertices
 * are at meeting planes along the one that passes nearest to the crossing. Of the slab's quads those from number
 * `first` of the whole on, up to before `end`. */
void hewn_lattice_dual_cut(const hewn_lattice *lattice, uint64_t first, uint64_t end, hewn_triangles *out);

#endif
