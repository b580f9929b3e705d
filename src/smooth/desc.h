/* The parameters of smoothing: defaults, and what is out of range. */
#ifndef HEWN_SRC_SMOOTH_DESC_H
#define HEWN_SRC_SMOOTH_DESC_H

#include "hewn/smooth.h"

/* Fills in what zero stands for, but for lengths that depend on the mesh. HEWN_INVALID_ARGUMENT. */
hewn_result hewn_smooth_settle(hewn_smooth_desc *desc, hewn_error *error);

#endif
