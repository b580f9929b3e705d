/* The counts of a repair, one by one, for people and for JSON. */
#ifndef HEWN_SRC_PIPELINE_REPAIR_COUNTS_H
#define HEWN_SRC_PIPELINE_REPAIR_COUNTS_H

#include "hewn/repair.h"

typedef struct hewn_repair_count {
    const char *name; /* as in hewn_repair_report */
    const char *text; /* for people */
    size_t offset;    /* of the uint64_t in hewn_repair_report */
} hewn_repair_count;

/* In the order in which the work is done; NULL past the last one. Static storage. */
const hewn_repair_count *hewn_repair_count_at(size_t index);

uint64_t hewn_repair_count_of(const hewn_repair_report *report, const hewn_repair_count *count);

#endif
