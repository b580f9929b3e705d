/* How few triangles there can be. */
#ifndef HEWN_SRC_SIMPLIFY_LEAST_H
#define HEWN_SRC_SIMPLIFY_LEAST_H

#include "simplify/work.h"

/* About how many triangles the topology takes: 4 a component, 12 a handle, 5 a boundary loop. 0 where the
 * mesh is not manifold. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_least(const simplify_work *work, uint32_t *least, hewn_error *error);

#endif
