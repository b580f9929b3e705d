/* Which vertices the caller wants to stay: the same rules as in simplification, for vertices all of whose triangles are
 * there. */
#ifndef HEWN_SRC_OUTCORE_LOCKS_H
#define HEWN_SRC_OUTCORE_LOCKS_H

#include "hewn/simplify.h"

/* Sets locked[v] of the ends of edges of triangles that are boundaries, bend or part labels, as far as `desc` wants
 * these to stay. `preserve` is not 0. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_locks_find(const hewn_model *triangles, const hewn_simplify_desc *desc, uint32_t preserve,
                            uint8_t *locked, hewn_error *error);

#endif
