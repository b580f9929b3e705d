/* What happens in one cell, between eight voxels: which vertices the faces between unlike labels need there so that
 * each label's shell is manifold. Whole numbers only; docs/labels.md has the reasons.
 *
 * Corner c of a cell is off by bit 0, 1, 2 of c along i, j, k. Face f is across axis f / 2, on the low side where f is
 * even. Its corners in order are low, + u, + u + v, + v, where u and v are the axes after its own, cyclically. Edges of
 * the cell between unlike labels are called arcs; each lies in two faces. Where arcs lie in a face there is a node,
 * from which an edge of the mesh passes to the cell beyond: one, or, where two opposite corners of the face have one
 * label that neither of the others has, two, for the label is joined across the face: a split face. */
#ifndef HEWN_SRC_LABELS_CELL_H
#define HEWN_SRC_LABELS_CELL_H

#include "hewn/base.h"

enum { HEWN_CELL_VERTICES = 12, HEWN_CELL_CAPS = 8, HEWN_CELL_NONE = 255 };

/* A polygon that lies within the cell: `corner` is one of the label behind it, `front` one of that before it. */
typedef struct hewn_cell_cap {
    uint8_t corner, front, count;
    uint8_t vertices[HEWN_CELL_VERTICES];
} hewn_cell_cap;

typedef struct hewn_cell_link {
    uint8_t a, b;
    bool junction; /* three faces meet */
} hewn_cell_link;

typedef struct hewn_label_cell {
    uint32_t key;
    uint8_t vertex_count;
    uint8_t split[6];    /* 0: no; 1: corners 0 and 2 of the face are apart; 2: corners 1 and 3 are */
    uint8_t arcs[6];     /* how many lie in the face */
    uint8_t node[6][2];  /* the vertex of each node; HEWN_CELL_NONE: there is no such node */
    uint8_t places[6];   /* vertices that the cell owns before the face's own two, for even faces that are split */
    uint8_t owned_count; /* vertices of the cell and of its split even faces */
    uint8_t cap_count, link_count;
    hewn_cell_cap caps[HEWN_CELL_CAPS];
    hewn_cell_link links[12]; /* edges within the cell */
    double offset[HEWN_CELL_VERTICES][3];
} hewn_label_cell;

/* A cell as a number: equal for cells that come to the same. Bits 3c - 3 to 3c - 1 hold the class of corner c, where
 * equal labels have equal classes, numbered from 0 in the order in which they appear; 6 bits more tell which labels are
 * joined where both diagonals of a face are of one label: that with the lower number. */
uint32_t hewn_cell_key(const uint16_t labels[8]);

static inline unsigned hewn_cell_class(uint32_t key, unsigned corner)
{
    return corner == 0 ? 0 : key >> (3 * corner - 3) & 7;
}

/* Finds out what a cell of that key holds. */
void hewn_cell_derive(uint32_t key, hewn_label_cell *out);

/* Where corner `corner` comes in the order of face `face`; the corner must lie in it. */
extern const uint8_t hewn_cell_order[6][8];

/* The arc from corner `low` along `axis`: going around it counter-clockwise, seen from its high end, one comes into the
 * cell through face `in` and leaves through `out`. */
typedef struct hewn_cell_arc {
    uint8_t low, axis, in, out;
} hewn_cell_arc;
extern const hewn_cell_arc hewn_cell_arcs[12]; /* number 4 axis + bits of `low` along the axes after it */

/* The vertex of an arc at face `face`, one of its two. */
static inline unsigned hewn_cell_node(const hewn_label_cell *cell, unsigned face, unsigned low, unsigned axis)
{
    unsigned apart = cell->split[face], order = hewn_cell_order[face][low];
    if (apart == 0)
        return 0;
    if ((order & 1) != apart - 1)
        order = hewn_cell_order[face][low | 1u << axis];
    return order >> 1;
}

/* Cells that were derived, found by key. For one thread. */
typedef struct hewn_cell_memo {
    hewn_label_cell **slots;
    size_t slot_count, count;
} hewn_cell_memo;

/* NULL: out of memory. */
const hewn_label_cell *hewn_cell_find(hewn_cell_memo *memo, uint32_t key);
void hewn_cell_memo_free(hewn_cell_memo *memo);

#endif
