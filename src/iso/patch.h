/* Pieces of surface within a cell, made of triangles between given loops.
 *
 * A loop lists the crossed edges of the cell that it passes, in the order in which triangles pass them. No edge that a
 * patch adds lies in a face of the cell, since the neighbouring cell could add the same one; so what a patch adds
 * belongs to it alone, and each loop's own edges are used exactly once. */
#ifndef HEWN_SRC_ISO_PATCH_H
#define HEWN_SRC_ISO_PATCH_H

#include "hewn/base.h"

#define HEWN_PATCH_MOST_TRIANGLES 20
#define HEWN_PATCH_MOST_CENTRES 4
#define HEWN_PATCH_FIRST_CENTRE 12u /* what a corner is called that is a vertex in the cell: this and the following */

typedef struct hewn_loop {
    uint32_t length;
    uint32_t edges[12];
} hewn_loop;

/* Triangles of a cell, and its vertices in the cell. Bits 0 to 11 of such a vertex are the edges of which it is the
 * mean crossing; where bits 12 to 14 are not 0 they are a face + 1, and the vertex lies halfway from there to the mean
 * of those crossings that are in that face. */
typedef struct hewn_patch {
    uint32_t triangle_count;
    uint8_t corners[HEWN_PATCH_MOST_TRIANGLES][3];
    uint32_t centre_count;
    uint32_t centres[HEWN_PATCH_MOST_CENTRES];
} hewn_patch;

/* Adds a disc in the loop: of all ways to cut it, the one whose diagonals are shortest in sum (of squares, for
 * crossings in the middle of their edges), the first found of equal ones; a fan around a vertex in the cell where there
 * is none. */
void hewn_patch_add_disc(hewn_patch *patch, const hewn_loop *loop);

/* Adds a band of triangles from loop to loop, with a vertex in the cell beside each face that both loops pass. False
 * where there is no such band. */
bool hewn_patch_add_annulus(hewn_patch *patch, const hewn_loop *one, const hewn_loop *other);

#endif
