/* A field's box in cells of an octree, each with the tape that is enough there. */
#ifndef HEWN_SRC_RENDER_OCTREE_H
#define HEWN_SRC_RENDER_OCTREE_H

#include <stdatomic.h>

#include "hewn/field.h"
#include "lanes/tape.h"

typedef enum hewn_cell_state {
    HEWN_CELL_EMPTY, /* the field is above 0 in all of it */
    HEWN_CELL_FULL,  /* it is below 0 */
    HEWN_CELL_MIXED
} hewn_cell_state;

typedef struct hewn_cell {
    float lo[3], hi[3];
    uint32_t children; /* the first of eight, x fastest; 0: none */
    hewn_cell_state state;
    bool is_long;   /* its tape */
    float least;    /* the field is nowhere below this in the cell and a little beyond */
    uint32_t owner; /* the cell that the tape was made for */
    uint32_t parent;
    const hewn_lane_tape *tape; /* enough in the cell and a little beyond: see HEWN_CELL_MARGIN */
    hewn_lane_tape *own;        /* the same where it was made for this cell, else NULL */
} hewn_cell;

/* How far beyond a cell what is said of it holds: this times the longest side of the smallest cells. */
#define HEWN_CELL_MARGIN 0.004

typedef struct hewn_octree {
    hewn_lane_tape *whole;
    hewn_cell *cells; /* the root first */
    size_t count, capacity;
    float margin;
    bool is_whole;         /* then each cell keeps its tape, else those whose children all have their own lose it */
    size_t made;           /* cells that are there from the start; the others only have places */
    atomic_uchar *divided; /* of each cell, whether it has made its children there */
    atomic_uint *finest;   /* the cell of each part of a lattice as fine as the smallest cells are, x fastest; marked
                              where a cell that is made is there */
    float scale[3];        /* from coordinates to those of the lattice */
} hewn_octree;

/* Where it is not to be `whole`, the smallest cells, which are most of all, are left to hewn_octree_reach().
 * HEWN_OUT_OF_MEMORY, and what hewn_lane_tape_create() returns. */
hewn_result hewn_octree_create(const hewn_field *field, hewn_node root, const hewn_box *box, bool whole,
                               hewn_octree *out, hewn_error *error);
void hewn_octree_destroy(hewn_octree *octree);

/* The smallest cell that a point is in; points outside count as if they were on the nearest side. Of a whole octree. */
const hewn_cell *hewn_octree_find(const hewn_octree *octree, const float p[3]);

/* The same of any octree: a cell is made when it is first asked for, by whichever thread asks first, and is the same
 * whoever it is; `work` is the thread's own. */
const hewn_cell *hewn_octree_reach(const hewn_octree *octree, hewn_lane_work *work, const float p[3]);

#endif
