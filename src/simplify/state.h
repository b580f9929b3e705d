/* A copy of a mesh while it is simplified, to go back to. */
#ifndef HEWN_SRC_SIMPLIFY_STATE_H
#define HEWN_SRC_SIMPLIFY_STATE_H

#include "simplify/work.h"

/* Owned; zero is the empty one. Of wedges only those that corners still have are held. */
typedef struct simplify_state {
    simplify_work work;
    uint32_t *wedges; /* numbers of the wedges that are held */
    size_t wedge_count;
    double *values, *sums; /* of these */
} simplify_state;

/* Copies `work`, which must be in order (hewn_simplify_order()), over what `state` held. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_save(const simplify_work *work, simplify_state *state, hewn_error *error);

/* Makes `work` what it was when it was saved. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_restore(const simplify_state *state, simplify_work *work, hewn_error *error);

void hewn_simplify_forget(simplify_state *state);

#endif
