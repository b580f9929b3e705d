/* Subdivision as a step of a job: tags from a file, polygons cut where asked for, and the report. */
#ifndef HEWN_SRC_PIPELINE_SUBDIVIDE_STEP_H
#define HEWN_SRC_PIPELINE_SUBDIVIDE_STEP_H

#include "base/json.h"
#include "hewn/file_job.h"

/* The errors of hewn_model_subdivide(), and those of a file of tags. */
hewn_result hewn_subdivide_step(hewn_model *model, const hewn_file_subdivide *subdivide, const hewn_progress *progress,
                                hewn_subdivide_report *report, hewn_error *error);

/* The object "subdivide". */
void hewn_subdivide_json(hewn_json *json, hewn_scheme scheme, const hewn_subdivide_report *report);

#endif
