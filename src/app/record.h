/* What the commands for mesh files say on standard error of the work that they did. */
#ifndef HEWN_SRC_APP_RECORD_H
#define HEWN_SRC_APP_RECORD_H

#include "hewn/file_job.h"

/* One line: files, counts, unit, axes, and what was done to them. */
void hewn_record_print(const hewn_file_report *report);

/* A line of what the format could not hold, and one for each word of the caller that went before the file's. */
void hewn_notes_print(const hewn_file_job_desc *desc, const hewn_file_report *report);

#endif
