/* Simplification as a step of a job, and the report. */
#ifndef HEWN_SRC_PIPELINE_SIMPLIFY_STEP_H
#define HEWN_SRC_PIPELINE_SIMPLIFY_STEP_H

#include "base/json.h"
#include "hewn/simplify.h"

/* The object "simplify". */
void hewn_simplify_json(hewn_json *json, const hewn_simplify_report *report);

#endif
