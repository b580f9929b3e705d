/* Which faces of which levels become the result, where not all of the last level do. */
#ifndef HEWN_SRC_SUBDIVIDE_PICK_H
#define HEWN_SRC_SUBDIVIDE_PICK_H

#include "subdivide/subdivision.h"

typedef struct sub_picked {
    uint32_t level, face;
} sub_picked;

/* In the order of the control mesh' faces. Owned. */
typedef struct sub_picks {
    sub_picked *faces;
    size_t count, room;
    uint8_t **refined; /* of each level but the last: whether a face was passed over for its children */
    uint32_t levels;
    uint64_t coarse; /* picked of a level before the last */
} sub_picks;

/* Picks faces whose next level lies within `error_bound` (0: the last level's) of them, by positions of the last
 * level; none that touch a boundary of the control mesh where `inner`, which `*dropped` counts. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_sub_pick(const hewn_subdivision *sub, const double *positions, double error_bound, bool inner,
                          sub_picks *out, uint64_t *dropped, hewn_error *error);
void hewn_sub_picks_free(sub_picks *picks);

/* Calls `each` for every corner of a picked face: the vertex in the numbers of `sub`, which is the one that was picked
 * from or one of its corner values, and the corner of the face's level (that of the last corner passed, for vertices
 * that finer neighbours have on its edges). */
typedef void (*sub_corner_visitor)(void *user, uint32_t vert, uint32_t corner);
void hewn_sub_walk(const hewn_subdivision *base, const hewn_subdivision *sub, const sub_picks *picks,
                   const sub_picked *face, sub_corner_visitor each, void *user);

/* The face and the corner of the control mesh that one of a level comes from. */
uint32_t hewn_sub_face_origin(const hewn_subdivision *sub, uint32_t level, uint32_t face);
uint32_t hewn_sub_corner_origin(const hewn_subdivision *sub, uint32_t level, uint32_t corner);

#endif
