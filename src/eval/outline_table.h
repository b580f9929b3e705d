/* A table that tells a shader which sides of an outline matter where: cells of the plane, each with the sides that can
 * be nearest somewhere in it, and with what the others do to the parity of crossings. Made on the host, read by
 * shaders/field/outline_table_point.glsl. Private to this room.
 *
 * Distances and signs have the bits that walking over all sides gives, in single precision and for every point up to
 * HEWN_TABLE_REACH times the outline's size away from it: what is left out is farther off than rounding can hide, and a
 * side whose crossing rounding could decide stays. Farther out a cell has the outermost sides in 64 directions, by
 * which a distance is off by less than what intervals allow for rounding. */
#ifndef HEWN_SRC_EVAL_OUTLINE_TABLE_H
#define HEWN_SRC_EVAL_OUTLINE_TABLE_H

#include "hewn/base.h"

/* The plane is a square around the outline, divided evenly, and around it rings, each four times as large as what it
 * surrounds, which is divided into 8 x 8 cells. Crowded cells are divided into 4 x 4 up to three times.
 *
 * Words: two for each cell, the first entry's word and counts: sides, then turns from bit 14 on, then from bit 28 on
 * whether an odd number of sides is crossed, and in bit 31 whether the cell is divided: then the first entry is that of
 * its own cells. At an entry's word stand the heights from which on a ray along x crosses another side that is left
 * out, then the sides: ax, ay, bx, by, and the inverse of the square of the length. */
enum {
    HEWN_TABLE_RINGS = 6,
    HEWN_TABLE_TURNS_AT = 14,
    HEWN_TABLE_ODD_AT = 28,
    HEWN_TABLE_SIDE = 5,
    HEWN_TABLE_NUMBERS =
        5 /* the outline's size, the middle's x and y, the inverse of half the square, cells across it */
};
#define HEWN_TABLE_REACH 4096

typedef struct hewn_outline_table {
    uint32_t *words;
    size_t word_count;
    float numbers[HEWN_TABLE_NUMBERS];
    uint32_t longest; /* sides and turns of the cell that has most of them */
} hewn_outline_table;

/* Of sides as devices have them, HEWN_TABLE_SIDE numbers each, no coordinate larger than `size`. Empty (no words), and
 * HEWN_OK, where a table is no good: one place has more than `most` sides and turns, or the outline is too small, too
 * large or too crowded. The caller frees the words. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_outline_table_create(const float (*sides)[HEWN_TABLE_SIDE], uint32_t count, float size, uint32_t most,
                                      hewn_outline_table *out, hewn_error *error);

#endif
