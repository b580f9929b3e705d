/* Lines of numbers from a file or standard input, any number of them, a part at a time. */
#ifndef HEWN_SRC_APP_NUMBER_LINES_H
#define HEWN_SRC_APP_NUMBER_LINES_H

#include "hewn/base.h"

typedef struct hewn_number_lines hewn_number_lines;

/* Each line has `width` numbers with blanks, tabs, commas or semicolons between them; empty lines and what follows a #
 * are passed over. `what` says in messages what a line is ("a point is three numbers, x y z"). "-" is standard input.
 * HEWN_BAD_INPUT for a file that cannot be read, as everywhere; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_number_lines_open(const char *path, uint32_t width, const char *what, hewn_number_lines **out,
                                   hewn_error *error);
void hewn_number_lines_close(hewn_number_lines **lines);

/* The next rows, at most `most`; *count is less where the file ends. HEWN_BAD_INPUT with file and line for what is no
 * such line (also: a number that is not finite, a line of more than 4,096 characters) and where reading fails;
 * HEWN_CANCELLED after a signal, also where it waits for a pipe. */
hewn_result hewn_number_lines_read(hewn_number_lines *lines, double *rows, size_t most, size_t *count,
                                   hewn_error *error);

/* Says that row `index` of the last part is not as it should be, naming file and line. */
hewn_result hewn_number_lines_refuse(const hewn_number_lines *lines, size_t index, const char *why, hewn_error *error);

#endif
