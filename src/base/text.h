/* A string that grows: for generated shaders and JSON. Failure is sticky, so writers need not check each call. */
#ifndef HEWN_SRC_BASE_TEXT_H
#define HEWN_SRC_BASE_TEXT_H

#include "hewn/base.h"

typedef struct hewn_text {
    char *bytes; /* NUL-terminated once anything was appended; owned */
    size_t length;
    size_t capacity;
    bool failed; /* out of memory at some point; what was appended since is lost */
} hewn_text;

void hewn_text_append(hewn_text *text, const char *string);
void hewn_text_append_bytes(hewn_text *text, const char *bytes, size_t length);
void hewn_text_print(hewn_text *text, const char *format, ...) HEWN_PRINTF(2, 3);

/* HEWN_OUT_OF_MEMORY if any append failed. */
hewn_result hewn_text_status(const hewn_text *text, hewn_error *error);

/* Frees the bytes and makes the text empty again. */
void hewn_text_clear(hewn_text *text);

#endif
