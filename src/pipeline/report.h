/* Filling in a report. */
#ifndef HEWN_SRC_PIPELINE_REPORT_H
#define HEWN_SRC_PIPELINE_REPORT_H

#include "hewn/job.h"

/* Adds a stage, in seconds since the job began. Stages past the report's room for them are dropped. */
void hewn_report_add_stage(hewn_report *report, const char *name, double begin, double end);

/* Copies what the report says of the scene: its files and its parameters in force. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_report_add_scene(hewn_report *report, const hewn_scene *scene, hewn_error *error);

/* The most bytes that this process had resident so far; 0 where the system does not say. */
uint64_t hewn_peak_host_bytes(void);

/* Those that it has now. */
uint64_t hewn_host_bytes(void);

#endif
