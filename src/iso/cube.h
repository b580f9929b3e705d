/* The cell that extraction cuts: its corners, edges and faces by number.
 *
 * Corner c is at (c & 1, c >> 1 & 1, c >> 2 & 1). Edge 4 * axis + i runs along `axis`; the bits of i are its place on
 * the other two axes, the lower axis first. */
#ifndef HEWN_SRC_ISO_CUBE_H
#define HEWN_SRC_ISO_CUBE_H

#include "hewn/base.h"

/* The corner at which an edge starts; it ends at `corner | 1 << axis`. */
uint32_t hewn_cube_edge_start(uint32_t edge);

/* The edge between two corners that differ in one axis. */
uint32_t hewn_cube_edge_between(uint32_t corner, uint32_t other);

/* The corners of face 2 * axis + side in order, counter-clockwise seen from outside the cell. */
void hewn_cube_face_corners(uint32_t face, uint32_t corners[4]);

/* Whether an edge lies in a face. */
bool hewn_cube_edge_in_face(uint32_t edge, uint32_t face);

/* Whether two edges lie in one face of the cell. */
bool hewn_cube_edges_share_face(uint32_t edge, uint32_t other);

#endif
