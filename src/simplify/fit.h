/* Vertices of a simplified mesh moved so that its input is nearer. */
#ifndef HEWN_SRC_SIMPLIFY_FIT_H
#define HEWN_SRC_SIMPLIFY_FIT_H

#include "simplify/gap.h"

/* Moves smooth vertices of `work`, which `gauge` has measured into `gaps`; measures again, and takes back what came out
 * far away and further than before, or flipped. If the greatest distance or the number of flipped triangles is larger
 * still, nothing is moved. `gaps` is that of what comes out. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_fit(simplify_work *work, simplify_gauge *gauge, simplify_gaps *gaps, hewn_error *error);

#endif
