/* Reading and simplifying a mesh file within a limit of memory, as steps of a job. */
#ifndef HEWN_SRC_PIPELINE_OUTCORE_STEP_H
#define HEWN_SRC_PIPELINE_OUTCORE_STEP_H

#include "hewn/file_job.h"
#include "pipeline/stages.h"

/* What of a limit a job may use for its own. */
typedef struct hewn_outcore_budget {
    uint64_t limit, program, left; /* bytes: asked for, taken by the program itself, what is left beside it */
} hewn_outcore_budget;

/* HEWN_OUT_OF_MEMORY where nothing useful is left, saying how much there has to be. */
hewn_result hewn_outcore_budget_make(uint64_t limit, hewn_outcore_budget *out, hewn_error *error);

/* Reads the job's input, whole where that fits, else in parts; and where it cannot be simplified in memory does that
 * out of it: `*done` tells, and `out` is then simplified. Fills in the report's counts, and with `done` what was done.
 * Unit and axes are as the file says. Errors as of hewn_file_convert(). */
hewn_result hewn_outcore_step(const hewn_file_job_desc *desc, hewn_file_report *report, hewn_stages *stages,
                              hewn_model *out, bool *done, hewn_error *error);

#endif
