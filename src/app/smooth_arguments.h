/* The options of smoothing on a command line. */
#ifndef HEWN_SRC_APP_SMOOTH_ARGUMENTS_H
#define HEWN_SRC_APP_SMOOTH_ARGUMENTS_H

#include "app/options.h"
#include "hewn/file_job.h"

/* Reads all options of `hewn smooth` that say how. HEWN_INVALID_ARGUMENT, also for one that the method has not. */
hewn_result hewn_smooth_arguments_read(const hewn_arguments *arguments, hewn_file_smooth *out, hewn_error *error);

/* A method by name, as `option` gives it. HEWN_INVALID_ARGUMENT. */
hewn_result hewn_smooth_method_parse(const char *text, const char *option, hewn_smooth_method *out, hewn_error *error);

/* A line or two on standard error of what was done. */
void hewn_smooth_print(const hewn_file_report *report);

#endif
