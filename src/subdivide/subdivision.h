/* What a subdivision is made of. */
#ifndef HEWN_SRC_SUBDIVIDE_SUBDIVISION_H
#define HEWN_SRC_SUBDIVIDE_SUBDIVISION_H

#include "subdivide/points.h"
#include "subdivide/tags.h"

struct hewn_subdivision {
    uint32_t count; /* of levels after the first */
    sub_masks masks;
    bool limit;
    sub_level levels[HEWN_MOST_LEVELS + 1];
    uint64_t *first; /* where each face of the last level begins */
    sub_tag_counts tags;
};

/* All levels after levels[0], which is there with its tags; of the desc, only its memory and progress are looked at. */
hewn_result hewn_subdivision_grow(hewn_subdivision *sub, const hewn_subdivide_desc *desc, hewn_error *error);

/* Values of the last level, not of the limit. */
hewn_result hewn_subdivision_refine(const hewn_subdivision *sub, const double *control, uint32_t width, double *out,
                                    hewn_error *error);

#endif
