/* Vertices at equal positions become one, for formats that cannot share them. */
#ifndef HEWN_SRC_IO_WELDER_H
#define HEWN_SRC_IO_WELDER_H

#include "io/builder.h"

/* An open-addressing table of vertices, keyed by the bits of their positions. Zero knows no vertex: those that the
 * builder has by the first call stay apart, and all later ones must be added through the welder, until it is cleared.
 */
typedef struct hewn_welder {
    uint64_t *slots;   /* half a hash above a vertex's number, or all bits */
    size_t slot_count; /* a power of two, at least twice the vertices */
    uint64_t first;    /* vertex that the welder knows */
} hewn_welder;

/* Makes room for so many vertices at once; not needed. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_welder_reserve(hewn_welder *welder, const hewn_builder *builder, uint64_t vertices, hewn_error *error);

/* Finds the vertex at a position that is finite, or adds it; -0 counts as 0 and is added as 0. HEWN_LIMIT where indices
 * end; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_welder_add(hewn_welder *welder, hewn_builder *builder, const double position[3], uint32_t *vertex,
                            hewn_error *error);

/* Asks for the memory that hewn_welder_add() of this position will need, which may then be there when it comes. */
void hewn_welder_expect(const hewn_welder *welder, const double position[3]);

/* Frees the table and makes it zero. */
void hewn_welder_clear(hewn_welder *welder);

#endif
