/* What was asked for. */
#ifndef HEWN_SRC_SIMPLIFY_DESC_H
#define HEWN_SRC_SIMPLIFY_DESC_H

#include "hewn/simplify.h"

/* HEWN_INVALID_ARGUMENT for what makes no sense. */
hewn_result hewn_simplify_check(const hewn_simplify_desc *desc, hewn_error *error);

/* Triangles to be left of so many; 0: no number was asked for. */
uint64_t hewn_simplify_target(const hewn_simplify_desc *desc, uint64_t triangles);

#endif
