/* What is sharp in a control mesh. */
#ifndef HEWN_SRC_SUBDIVIDE_TAGS_H
#define HEWN_SRC_SUBDIVIDE_TAGS_H

#include "subdivide/level.h"

/* How many edges and vertices the desc has made sharp. */
typedef struct sub_tag_counts {
    uint64_t creases, corners;
} sub_tag_counts;

/* Puts creases, corners, the angle of creases and the rule for boundaries into level 0. HEWN_BAD_INPUT for a tag that
 * cannot be, HEWN_OUT_OF_MEMORY. `positions` may be NULL where no angle is given. */
hewn_result hewn_sub_tag(sub_level *level, const double *positions, const hewn_subdivide_desc *desc,
                         sub_tag_counts *counts, hewn_error *error);

#endif
