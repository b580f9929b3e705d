/* Triangles that face away from the input. */
#ifndef HEWN_SRC_SIMPLIFY_TURNED_H
#define HEWN_SRC_SIMPLIFY_TURNED_H

#include "simplify/samples.h"

/* Takes away triangles whose normal points away from that of the input's triangle nearest to their middle, where an
 * edge of theirs may be collapsed so that none is left there and nothing is further away than somewhere else, or
 * something else helps. `*left`: how many there still are. `work` has samples. The same for any number of threads.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_right(simplify_work *work, uint32_t *left, hewn_error *error);

#endif
