/* Smoothing as a step of a job: what the model itself says of locks and masks, and the report. */
#ifndef HEWN_SRC_PIPELINE_SMOOTH_STEP_H
#define HEWN_SRC_PIPELINE_SMOOTH_STEP_H

#include "base/json.h"
#include "hewn/file_job.h"

/* HEWN_INVALID_ARGUMENT for a mask that the model has not; the errors of hewn_model_smooth(). */
hewn_result hewn_smooth_step(hewn_model *model, const hewn_file_smooth *smooth, const hewn_progress *progress,
                             hewn_smooth_report *report, hewn_error *error);

/* The object "smooth". */
void hewn_smooth_json(hewn_json *json, hewn_smooth_method method, const hewn_smooth_report *report);

#endif
