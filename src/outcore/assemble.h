/* What is left of a mesh on disk as a model in memory. */
#ifndef HEWN_SRC_OUTCORE_ASSEMBLE_H
#define HEWN_SRC_OUTCORE_ASSEMBLE_H

#include "outcore/store.h"

/* Of a store whose triangles hewn_store_bounds() has found sound: vertices in the order of their numbers, without those
 * that no triangle names, and triangles in that of the list, which is empty then. `frozen` gets a byte a vertex, 1
 * where it is locked; the caller's (hewn_free). HEWN_IO, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_store_assemble(hewn_store *store, hewn_model *out, uint8_t **frozen, hewn_error *error);

#endif
