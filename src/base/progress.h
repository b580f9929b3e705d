/* Telling the caller how far the work is, and hearing whether to go on. */
#ifndef HEWN_SRC_BASE_PROGRESS_H
#define HEWN_SRC_BASE_PROGRESS_H

#include "base/error.h"

/* HEWN_OK to go on; HEWN_CANCELLED, with the reason written, when the caller wants to stop. `progress` may be NULL. */
static inline hewn_result hewn_progress_report(const hewn_progress *progress, const char *stage, double fraction,
                                               hewn_error *error)
{
    if (progress && progress->report && !progress->report(progress->user, stage, fraction))
        return hewn_fail(error, HEWN_CANCELLED, "cancelled during %s", stage);
    return HEWN_OK;
}

#endif
