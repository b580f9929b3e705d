/* The options of smoothing on a command line. */
#ifndef HEWN_SRC_APP_SMOOTH_ARGUMENTS_H
#define HEWN_SRC_APP_SMOOTH_ARGUMENTS_H

#include "app/options.h"
#include "hewn/file_job.h"

/* Reads all options of `hewn smooth` that say how. HEWN_INVALID_ARGUMENT, also for one that the method has not. */
hewn_result hewn_smooth_arguments_read(const hewn_arguments *arguments, hewn_file_smooth *out, hewn_error *error);

/* What `option` takes: METHOD, METHOD:KEY=VALUE,KEY=VALUE..., or the pairs alone, for taubin. Keys are the options of
 * `hewn smooth` by name (but mask), `lock` as often as needed, and volume=keep or volume=free. HEWN_INVALID_ARGUMENT.
 */
hewn_result hewn_smooth_spec_parse(const char *text, const char *option, hewn_file_smooth *out, hewn_error *error);

/* A method by name, as `option` gives it. HEWN_INVALID_ARGUMENT. */
hewn_result hewn_smooth_method_parse(const char *text, const char *option, hewn_smooth_method *out, hewn_error *error);

#define HEWN_OPTION_SMOOTH                                                                                             \
    {                                                                                                                  \
        0, "smooth", "METHOD",                                                                                         \
            "Smooth the mesh on the way by taubin, laplacian, cotan, implicit, bilateral or hc; METHOD:KEY=VALUE,... " \
            "with what `hewn smooth` has: taubin:iterations=30,passband=0.05, implicit:step=0.5,volume=keep, "         \
            "lock=boundary. Lengths are in the input's unit."                                                          \
    }

/* A line or two on standard error of what was done. */
void hewn_smooth_print(const hewn_smooth_report *done, hewn_smooth_method method);

#endif
