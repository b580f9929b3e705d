#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void write_reason(hewn_error *error, hewn_result code, const char *file, uint32_t line, const char *format,
                         va_list arguments)
{
    if (!error)
        return;
    error->code = code;
    error->line = line;
    size_t length = strlen(file);
    const char *tail = length < sizeof error->file ? file : file + (length - sizeof error->file + 1);
    snprintf(error->file, sizeof error->file, "%s", tail);
    vsnprintf(error->message, sizeof error->message, format, arguments);
}

hewn_result hewn_fail(hewn_error *error, hewn_result code, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_reason(error, code, "", 0, format, arguments);
    va_end(arguments);
    return code;
}

hewn_result hewn_fail_at(hewn_error *error, hewn_result code, const char *file, uint32_t line, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_reason(error, code, file ? file : "", line, format, arguments);
    va_end(arguments);
    return code;
}

const char *hewn_result_name(hewn_result result)
{
    switch (result) {
    case HEWN_OK: return "ok";
    case HEWN_INVALID_ARGUMENT: return "invalid argument";
    case HEWN_BAD_INPUT: return "bad input";
    case HEWN_IO: return "input/output error";
    case HEWN_NO_LOADER: return "no Vulkan loader";
    case HEWN_NO_DEVICE: return "no device";
    case HEWN_MISSING_FEATURE: return "missing device feature";
    case HEWN_DEVICE_LOST: return "device lost";
    case HEWN_OUT_OF_DEVICE_MEMORY: return "out of device memory";
    case HEWN_OUT_OF_MEMORY: return "out of memory";
    case HEWN_LIMIT: return "limit exceeded";
    case HEWN_CANCELLED: return "cancelled";
    case HEWN_INTERNAL: return "internal error";
    }
    return "unknown result";
}
