#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

void hewn_text_append_bytes(hewn_text *text, const char *bytes, size_t length)
{
    if (text->failed)
        return;
    void *items = text->bytes;
    if (hewn_reserve(&items, &text->capacity, text->length + length + 1, 1, NULL) != HEWN_OK) {
        text->failed = true;
        return;
    }
    text->bytes = items;
    memcpy(text->bytes + text->length, bytes, length);
    text->length += length;
    text->bytes[text->length] = '\0';
}

void hewn_text_append(hewn_text *text, const char *string)
{
    hewn_text_append_bytes(text, string, strlen(string));
}

void hewn_text_print(hewn_text *text, const char *format, ...)
{
    char line[512];
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (length >= 0 && (size_t)length < sizeof line) {
        hewn_text_append_bytes(text, line, (size_t)length);
    } else if (length >= 0) {
        char *long_line = hewn_alloc((size_t)length + 1, 1);
        if (long_line) {
            vsnprintf(long_line, (size_t)length + 1, format, again);
            hewn_text_append_bytes(text, long_line, (size_t)length);
            hewn_free(long_line);
        } else {
            text->failed = true;
        }
    }
    va_end(again);
}

hewn_result hewn_text_status(const hewn_text *text, hewn_error *error)
{
    if (text->failed)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory writing a text of %zu bytes", text->length);
    return HEWN_OK;
}

void hewn_text_clear(hewn_text *text)
{
    hewn_free(text->bytes);
    *text = (hewn_text){0};
}
