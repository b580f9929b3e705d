/* Filling in a hewn_error in one expression: `return hewn_fail(error, HEWN_IO, "...", ...)`. */
#ifndef HEWN_SRC_BASE_ERROR_H
#define HEWN_SRC_BASE_ERROR_H

#include "hewn/base.h"

/* Writes the reason (where `error` is not NULL) and returns `code`. */
hewn_result hewn_fail(hewn_error *error, hewn_result code, const char *format, ...) HEWN_PRINTF(3, 4);

/* The same, naming a file and a 1-based line (0 for none). */
hewn_result hewn_fail_at(hewn_error *error, hewn_result code, const char *file, uint32_t line, const char *format, ...)
    HEWN_PRINTF(5, 6);

/* Returns early with the failure of `call`, if it is one. */
#define HEWN_TRY(call)                                                                                                 \
    do {                                                                                                               \
        hewn_result hewn_try_result = (call);                                                                          \
        if (hewn_try_result != HEWN_OK)                                                                                \
            return hewn_try_result;                                                                                    \
    } while (0)

#endif
