/* What is promised of a result is proven before it is handed out. */
#ifndef HEWN_SRC_SIMPLIFY_PROMISE_H
#define HEWN_SRC_SIMPLIFY_PROMISE_H

#include "simplify/run.h"

/* Runs until what was asked for holds: the distance, no new self-intersections. After a run that does not, what became
 * the offending places may only change less, in the end not at all, and all is done again. It ends because that only
 * becomes more, and the input itself holds every promise. */
hewn_result hewn_simplify_promised(simplify_input *in, simplify_result *out, hewn_simplify_report *report,
                                   hewn_error *error);

#endif
