/* Reading a mesh file and examining it, without writing any. */
#ifndef HEWN_SRC_PIPELINE_EXAMINE_H
#define HEWN_SRC_PIPELINE_EXAMINE_H

#include "hewn/check.h"
#include "hewn/distance.h"
#include "hewn/io.h"
#include "hewn/job.h"

/* The request above, the findings below; leave it with hewn_examination_clear(). */
typedef struct hewn_examination {
    const char *path;        /* "-" is standard input */
    hewn_mesh_format format; /* HEWN_MESH_UNKNOWN: from the path; known afterwards */
    uint32_t required;       /* bits of hewn_requirement, for the JSON */
    bool skip_self_intersections;
    const char *against;             /* a second file, to measure the distance to; NULL: none */
    hewn_mesh_format against_format; /* HEWN_MESH_UNKNOWN: from the path; known afterwards */
    double began;                    /* CLOCK_MONOTONIC seconds */
    const hewn_progress *progress;

    hewn_model model;
    hewn_check *check;
    hewn_distance distance;      /* where there is something to measure against, in the unit of the first */
    hewn_report_stage stages[3]; /* load, check, measure */
} hewn_examination;

/* HEWN_INVALID_ARGUMENT for an unknown format; HEWN_BAD_INPUT for a file that cannot be read or used; HEWN_LIMIT,
 * HEWN_CANCELLED, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_examine(hewn_examination *job, hewn_error *error);

/* The findings as JSON to a file, "-" is standard output. HEWN_IO, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_examination_write(const hewn_examination *job, const char *path, hewn_error *error);

void hewn_examination_clear(hewn_examination *job);

#endif
