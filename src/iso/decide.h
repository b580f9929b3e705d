/* How the values at its corners cut a cell where the signs leave a choice (iso/mc33.h), on the host. */
#ifndef HEWN_SRC_ISO_DECIDE_H
#define HEWN_SRC_ISO_DECIDE_H

#include "iso/mc33.h"

/* Of the `ambiguous` faces, bit n for the n-th of them from the lowest: whether the inside is joined across it. Values
 * below 0 are inside, and 0 counts as just outside. Exact, but for values of a face that differ by more than 10^130. */
uint32_t hewn_decide_faces(const double values[8], uint32_t ambiguous);

/* How the cell is joined within. Exact, but for values that differ by more than 10^60. */
hewn_mc33_join hewn_decide_join(const double values[8]);

#endif
