/* The part of a command line that says where a result goes: -o and --report. */
#ifndef HEWN_SRC_APP_OUTPUT_ARGUMENTS_H
#define HEWN_SRC_APP_OUTPUT_ARGUMENTS_H

#include "app/options.h"
#include "hewn/io.h"

/* The value of -o. `what` is what goes there, `example` a name for it. HEWN_INVALID_ARGUMENT where there is none or an
 * empty one. */
hewn_result hewn_output_arguments_read(const hewn_arguments *arguments, const char *what, const char *example,
                                       const char **output, hewn_error *error);

/* The same for a mesh, with --report (NULL where it is not given) and --to (unchanged where it is not given). A binary
 * mesh is not for a terminal. */
hewn_result hewn_output_arguments_read_mesh(const hewn_arguments *arguments, const char **output, const char **report,
                                            hewn_mesh_format *format, hewn_error *error);

/* HEWN_INVALID_ARGUMENT where `output` is "-" and that is a terminal; `what` is binary: "PNG is". */
hewn_result hewn_output_arguments_spare_terminal(const char *output, const char *what, hewn_error *error);

#endif
