/* Vertices moved to where the input is nearer. */
#ifndef HEWN_SRC_SIMPLIFY_FIT_H
#define HEWN_SRC_SIMPLIFY_FIT_H

#include "simplify/samples.h"

/* `work` has samples and is in order. `back`: distances from the mesh to the input count as well as those of samples,
 * which takes several times as long. The same for any number of threads. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_fit(simplify_work *work, bool back, hewn_error *error);

#endif
