/* When the stages of a job begin and end, for its report. */
#ifndef HEWN_SRC_PIPELINE_STAGES_H
#define HEWN_SRC_PIPELINE_STAGES_H

#include "hewn/job.h"

/* The report's stages and the clock that they go by. */
typedef struct hewn_stages {
    double began, stage; /* CLOCK_MONOTONIC seconds: of the job, and of the stage */
    hewn_report_stage *list;
    uint32_t *count, room;
} hewn_stages;

/* Of a job that began at `began`, or now where that is 0. */
hewn_stages hewn_stages_start(double began, hewn_report_stage *list, uint32_t room, uint32_t *count);

void hewn_stage_begin(hewn_stages *stages);

/* Notes the stage under its name; one for which there is no room is left out. */
void hewn_stage_end(hewn_stages *stages, const char *name);

/* Seconds since the job began. */
double hewn_stages_seconds(const hewn_stages *stages);

#endif
