/* Monotonic time, and the timeline of named stages that reports print. */
#ifndef HEWN_SRC_BASE_CLOCK_H
#define HEWN_SRC_BASE_CLOCK_H

#include "hewn/base.h"

/* Seconds on the monotonic clock, from an arbitrary origin. */
double hewn_clock_now(void);

#endif
