/* The parts of a command line that name files and their formats: the operand, -o, --report and --to. */
#ifndef HEWN_SRC_APP_PATH_ARGUMENTS_H
#define HEWN_SRC_APP_PATH_ARGUMENTS_H

#include "app/options.h"
#include "hewn/io.h"

/* The one operand; HEWN_INVALID_ARGUMENT for none, several or an empty one. */
hewn_result hewn_input_argument_read(const hewn_arguments *arguments, const char **out, hewn_error *error);

/* A mesh format by name, as --from and --to give it. HEWN_INVALID_ARGUMENT. */
hewn_result hewn_format_parse(const char *text, const char *option, hewn_mesh_format *out, hewn_error *error);

/* The value of -o. `what` is what goes there, `example` a name for it. HEWN_INVALID_ARGUMENT where there is none or an
 * empty one. */
hewn_result hewn_output_argument_read(const hewn_arguments *arguments, const char *what, const char *example,
                                      const char **output, hewn_error *error);

/* The same for a mesh, with --report (NULL where it is not given) and --to (unchanged where it is not given). A binary
 * mesh is not for a terminal. */
hewn_result hewn_mesh_output_read(const hewn_arguments *arguments, const char **output, const char **report,
                                  hewn_mesh_format *format, hewn_error *error);

/* HEWN_INVALID_ARGUMENT where `output` is "-" and that is a terminal, for what is binary; `what` is its name. */
hewn_result hewn_output_spare_terminal(const char *output, const char *what, hewn_error *error);

#endif
