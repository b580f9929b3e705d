/* Cells along a Morton curve: those of an octree node follow each other (Morton 1966). */
#ifndef HEWN_SRC_ISO_MORTON_H
#define HEWN_SRC_ISO_MORTON_H

#include "hewn/base.h"

/* The bits of three coordinates below 2^21 in turn, x lowest: shifted right by 3 l, the code of the node of 2^l cells a
 * side. */
uint64_t hewn_morton_code(const uint32_t cell[3]);

/* Sorts codes, and what goes with each (may be NULL); equal ones keep their order. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_morton_sort(uint64_t *codes, uint32_t *values, size_t count, hewn_error *error);

#endif
