#include "app/rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/error.h"

hewn_result hewn_rows_open(const char *path, hewn_rows *out, hewn_error *error)
{
    *out = (hewn_rows){0};
    return hewn_output_create(path ? path : "-", &out->output, error);
}

static void begin_word(hewn_rows *rows)
{
    if (rows->text.length > 0 && rows->text.bytes[rows->text.length - 1] != '\n')
        hewn_text_append_bytes(&rows->text, " ", 1);
}

void hewn_rows_word(hewn_rows *rows, const char *word)
{
    begin_word(rows);
    hewn_text_append(&rows->text, word);
}

void hewn_rows_number(hewn_rows *rows, double value, bool single)
{
    char digits[48];
    int most = single ? 9 : 17;
    if (!isfinite(value)) {
        hewn_rows_word(rows, isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
        return;
    }
    for (int precision = single ? 6 : 15; precision <= most; precision++) {
        snprintf(digits, sizeof digits, "%.*g", precision, value);
        double back = strtod(digits, NULL);
        if (single ? (float)back == (float)value : back == value)
            break;
    }
    hewn_rows_word(rows, digits);
}

void hewn_rows_end(hewn_rows *rows)
{
    hewn_text_append_bytes(&rows->text, "\n", 1);
}

hewn_result hewn_rows_flush(hewn_rows *rows, hewn_error *error)
{
    HEWN_TRY(hewn_text_status(&rows->text, error));
    hewn_result result = HEWN_OK;
    if (rows->text.length > 0)
        result = hewn_output_write(rows->output, rows->text.bytes, rows->text.length, error);
    rows->text.length = 0;
    return result;
}

hewn_result hewn_rows_close(hewn_rows *rows, hewn_result result, hewn_error *error)
{
    if (result == HEWN_OK)
        result = hewn_rows_flush(rows, error);
    if (result == HEWN_OK)
        result = hewn_output_finish(&rows->output, error);
    hewn_output_destroy(&rows->output);
    hewn_text_clear(&rows->text);
    return result;
}
