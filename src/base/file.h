/* Files: read whole with a size limit, and written under a temporary name that only success renames. */
#ifndef HEWN_SRC_BASE_FILE_H
#define HEWN_SRC_BASE_FILE_H

#include "hewn/base.h"

/* Reads a regular file, pipe or ("-") standard input of at most `limit` bytes. `*bytes` is owned by the caller
 * (hewn_free) and has a NUL after its `*length` bytes. HEWN_IO names the file and the reason (HEWN_BAD_INPUT for a
 * folder or more than `limit` bytes). */
hewn_result hewn_file_read(const char *path, size_t limit, char **bytes, size_t *length, hewn_error *error);

/* Writes all of it to an open file, in as many steps as that takes; false where that fails, and errno says why. */
bool hewn_file_put(int file, const void *bytes, size_t length);

/* A buffered output that becomes visible under its name only when finished. Not thread-safe. */
typedef struct hewn_output hewn_output;

/* Opens `path` for writing: a temporary file of an unpredictable name beside it, or standard output for "-". An
 * existing file keeps its mode, a new one gets 0666 less the umask; a device or pipe is written in place. A folder, a
 * missing or closed folder around it and a file that may not be written are HEWN_IO here, before any work. */
hewn_result hewn_output_create(const char *path, hewn_output **out, hewn_error *error);

/* Appends bytes. An error (a full disk) is returned at once and again by every later call. */
hewn_result hewn_output_write(hewn_output *output, const void *bytes, size_t length, hewn_error *error);

/* The file that the output is until it is finished, for whoever has to end in a hurry and remove it; NULL where there
 * is none. Valid as long as the output. */
const char *hewn_output_temporary(const hewn_output *output);

/* Hands everything to the system and closes the file, so that of what may still fail only the renaming is left: for
 * files that belong together. Nothing can be written any more. */
hewn_result hewn_output_settle(hewn_output *output, hewn_error *error);

/* Flushes, renames over `path` and destroys the output; on failure nothing is left behind. */
hewn_result hewn_output_finish(hewn_output **output, hewn_error *error);

/* Gives up: removes the temporary file. On &NULL does nothing. */
void hewn_output_destroy(hewn_output **output);

#endif
