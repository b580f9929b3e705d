/* An edge that runs the other way between its two triangles. */
#ifndef HEWN_SRC_SIMPLIFY_SWAP_H
#define HEWN_SRC_SIMPLIFY_SWAP_H

#include "simplify/work.h"

/* Whether the edge of a half-edge may be swapped: it is no feature and not between vertices that stay, its triangles
 * bend little and lie around it so that those after the swap face as they do, none is a sliver that was none, and the
 * edge that it would become is not there yet. Never in a complex. */
bool hewn_simplify_may_swap(const simplify_work *work, uint32_t h);

/* The two triangles keep their numbers and that of their common edge's halves. */
void hewn_simplify_swap(simplify_work *work, uint32_t h);

#endif
