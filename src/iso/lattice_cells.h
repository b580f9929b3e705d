/* Cells of a row, cut one after the other: triangles, and the vertices that lie in cells. */
#ifndef HEWN_SRC_ISO_LATTICE_CELLS_H
#define HEWN_SRC_ISO_LATTICE_CELLS_H

#include "iso/lattice.h"

/* The row of cells that is being emitted: how many vertices on edges of each of its rows of samples lie before the cell
 * at hand. Whoever has a crossed edge is active, so each crossed edge is passed. */
typedef struct hewn_lattice_cell_row {
    const hewn_lattice *lattice;
    hewn_triangles *out;
    uint32_t j, k;         /* of its cells */
    uint32_t along[4];     /* edges along i, of rows (j, k), (j + 1, k), (j, k + 1), (j + 1, k + 1) */
    uint32_t beside[2];    /* along j, of rows (j, k), (j, k + 1) */
    uint32_t upright[2];   /* along k, of rows (j, k), (j + 1, k) */
    uint32_t centre;       /* the next one's number */
    uint64_t centre_place; /* and its place among the slab's vertices */
    uint64_t triangle;     /* the next one's place */
} hewn_lattice_cell_row;

/* `begins` are those four rows of samples, around cells (., j, k). */
hewn_lattice_cell_row hewn_lattice_begin_cells(const hewn_lattice *lattice, hewn_triangles *out,
                                               const hewn_lattice_row *const begins[4], uint32_t j, uint32_t k);

/* The next active cell, which is at `i`, by its patch's record (iso/mc33.h); `turn`: its triangles are turned over. */
void hewn_lattice_cut_cell(hewn_lattice_cell_row *row, uint32_t i, uint32_t pattern, const uint32_t *record, bool turn);

#endif
