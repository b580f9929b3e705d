/* Triangles from where they bring little to where they bring much. */
#ifndef HEWN_SRC_SIMPLIFY_EXCHANGE_H
#define HEWN_SRC_SIMPLIFY_EXCHANGE_H

#include "simplify/samples.h"

/* Splits edges where samples are far away, or triangles turned away, and collapses others in their stead; then fits
 * vertices again. There come to be no more than `target` triangles, or as many as there are. `work` has samples and is
 * in order, and is in order then. Nothing is done with attributes and in complexes. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_exchange(simplify_work *work, uint32_t target, hewn_error *error);

#endif
