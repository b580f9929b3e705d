/* The last collapses, which keep the greatest distance small. */
#ifndef HEWN_SRC_SIMPLIFY_BALANCE_H
#define HEWN_SRC_SIMPLIFY_BALANCE_H

#include "simplify/run.h"
#include "simplify/work.h"

/* Collapses edges until `target` triangles are left. `input` is what `work` was built of. */
hewn_result hewn_simplify_balanced(simplify_work *work, const hewn_polygons *input, uint32_t target, hewn_error *error);

#endif
