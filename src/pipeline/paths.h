/* What jobs do about the files that they are given, before and after the work. */
#ifndef HEWN_SRC_PIPELINE_PATHS_H
#define HEWN_SRC_PIPELINE_PATHS_H

#include "hewn/io.h"

/* Finds out whether `path` can be written, without writing it. HEWN_IO. */
hewn_result hewn_output_check(const char *path, hewn_error *error);

/* The format to write: `format` where it is known, else that of the name. HEWN_INVALID_ARGUMENT where nobody knows,
 * where it cannot be written, or not to standard output. */
hewn_result hewn_output_format(const char *path, hewn_mesh_format format, hewn_mesh_format *out, hewn_error *error);

/* The same for reading. */
hewn_result hewn_input_format(const char *path, hewn_mesh_format format, hewn_mesh_format *out, hewn_error *error);

/* Whoever could not read the input has a bad input, which the error then names; only a refused output is a failure of
 * input and output. Returns the result. */
hewn_result hewn_blame_input(hewn_result result, const char *path, hewn_error *error);

/* The name of a file without folder and extensions, "mesh" for standard input; cut where it does not fit. */
void hewn_path_stem(const char *path, char *out, size_t size);

#endif
