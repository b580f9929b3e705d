/* Rows of numbers as text, to a file that appears when it is complete, or to standard output. */
#ifndef HEWN_SRC_APP_ROWS_H
#define HEWN_SRC_APP_ROWS_H

#include "base/file.h"
#include "base/text.h"

typedef struct hewn_rows {
    hewn_output *output;
    hewn_text text;
} hewn_rows;

/* `path` may be NULL: standard output. */
hewn_result hewn_rows_open(const char *path, hewn_rows *out, hewn_error *error);

/* A word or a number of the row, after a blank where it is not the first. Numbers in the fewest digits that read back;
 * "nan", "inf" and "-inf". With `single` digits enough for single precision. */
void hewn_rows_word(hewn_rows *rows, const char *word);
void hewn_rows_number(hewn_rows *rows, double value, bool single);
void hewn_rows_end(hewn_rows *rows);

/* Hands what was gathered to the file; call now and then. */
hewn_result hewn_rows_flush(hewn_rows *rows, hewn_error *error);

/* Completes the file, or, where `result` is a failure, removes it; returns the first failure. */
hewn_result hewn_rows_close(hewn_rows *rows, hewn_result result, hewn_error *error);

#endif
