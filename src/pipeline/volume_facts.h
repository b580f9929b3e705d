/* What there is to tell of a volume file. */
#ifndef HEWN_SRC_PIPELINE_VOLUME_FACTS_H
#define HEWN_SRC_PIPELINE_VOLUME_FACTS_H

#include "base/json.h"
#include "hewn/job.h"
#include "hewn/volume_io.h"

/* The request above, the findings below; leave it with hewn_volume_facts_clear(). */
typedef struct hewn_volume_facts {
    const char *path; /* "-" is standard input */
    hewn_volume_read_desc read;
    uint64_t frame;      /* the one whose values are looked at */
    const hewn_iso *iso; /* NULL: none is looked for */
    double began;        /* CLOCK_MONOTONIC seconds */

    hewn_volume_format format;
    hewn_volume volume;
    hewn_volume_range range;
    double iso_value;
    hewn_report_stage stages[2]; /* load, measure */
} hewn_volume_facts;

/* HEWN_INVALID_ARGUMENT for an unknown format or a frame that is not there; HEWN_BAD_INPUT for a file that cannot be
 * read or used, or has no such iso value; HEWN_LIMIT, HEWN_CANCELLED, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_volume_facts_find(hewn_volume_facts *job, hewn_error *error);

/* The findings as JSON to a file, "-" is standard output. HEWN_IO, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_volume_facts_write(const hewn_volume_facts *job, const char *path, hewn_error *error);

void hewn_volume_facts_clear(hewn_volume_facts *job);

#endif
