/* Values of corners: they have connections of their own, cut open along seams, and follow the rules of subdivision
 * there. */
#ifndef HEWN_SRC_SUBDIVIDE_SEAMS_H
#define HEWN_SRC_SUBDIVIDE_SEAMS_H

#include "subdivide/subdivision.h"

/* A subdivision of the values that corners have: `values` are `stride` bytes a corner of `base`'s control mesh. Two
 * faces beside an edge share values where the bytes at both its ends agree. Corners keep their numbers at all levels;
 * `*sources` gets a corner for each value of level 0 (hewn_free). The limit is taken where `base` takes it.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_sub_seams(const hewn_subdivision *base, const void *values, size_t stride, hewn_uv_rule rule,
                           hewn_subdivision **out, uint32_t **sources, hewn_error *error);

#endif
