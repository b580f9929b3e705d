#include "app/number.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* Reads `length` characters as a finite decimal number. */
static bool read_number(const char *text, size_t length, double *out)
{
    char digits[128];
    if (length == 0 || length >= sizeof digits || strspn(text, "0123456789+-.eE") < length)
        return false;
    memcpy(digits, text, length);
    digits[length] = '\0';
    char *end;
    *out = strtod(digits, &end);
    return *end == '\0' && isfinite(*out);
}

hewn_result hewn_number_parse(const char *text, const char *option, double *out, hewn_error *error)
{
    if (read_number(text, strlen(text), out))
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s takes a number, not '%s'", option, text);
}

hewn_result hewn_count_parse(const char *text, const char *option, uint32_t least, uint32_t *out, hewn_error *error)
{
    size_t length = strlen(text);
    size_t digits = strspn(text, "0123456789");
    bool negative = text[0] == '-' && length > 1 && strspn(text + 1, "0123456789") == length - 1;
    if (!negative && (length == 0 || digits != length))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s takes a whole number, not '%s'", option, text);
    unsigned long long value = negative ? 0 : strtoull(text, NULL, 10); /* ULLONG_MAX where it is more */
    if (negative || value < least)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s must be at least %u, not %s", option, least, text);
    *out = value < UINT32_MAX ? (uint32_t)value : UINT32_MAX;
    return HEWN_OK;
}

hewn_result hewn_size_parse(const char *text, const char *option, uint64_t *out, hewn_error *error)
{
    static const char units[] = "KMG";
    size_t digits = strspn(text, "0123456789");
    const char *unit = text[digits] ? strchr(units, text[digits]) : NULL;
    bool known = text[digits] == '\0' || (unit && text[digits + 1] == '\0');
    if (digits == 0 || !known)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "%s takes a whole number of bytes, with K, M or G after it for more, not '%s'", option, text);
    unsigned shift = unit ? 10 * (unsigned)(unit - units + 1) : 0;
    unsigned long long value = strtoull(text, NULL, 10); /* ULLONG_MAX where it is more */
    if (value == 0 || value > (uint64_t)INT64_MAX >> shift)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s makes no sense with %s bytes", option, text);
    *out = (uint64_t)value << shift;
    return HEWN_OK;
}

hewn_result hewn_bounds_parse(const char *text, const char *option, hewn_box *out, hewn_error *error)
{
    double sides[6];
    size_t count = 0;
    const char *at = text;
    for (;;) {
        size_t length = strcspn(at, ",");
        if (count < 6 && !read_number(at, length, &sides[count]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s: '%.*s' is not a number", option, (int)length, at);
        ++count;
        at += length;
        if (*at == '\0')
            break;
        ++at;
    }
    if (count != 6)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s takes six numbers, x0,y0,z0,x1,y1,z1, not %zu", option,
                         count);
    for (int axis = 0; axis < 3; ++axis) {
        out->lo[axis] = sides[axis];
        out->hi[axis] = sides[axis + 3];
        if (!(out->lo[axis] < out->hi[axis]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s: %c0 must be less than %c1, but %g is not less than %g",
                             option, "xyz"[axis], "xyz"[axis], out -> lo[axis], out -> hi[axis]);
    }
    return HEWN_OK;
}

hewn_result hewn_setting_parse(const char *text, char **name, double *value, hewn_error *error)
{
    *name = NULL;
    size_t length = strcspn(text, "=");
    if (text[length] != '=' || length == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "-D takes NAME=VALUE, not '%s'", text);
    if (!read_number(text + length + 1, strlen(text + length + 1), value))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "-D %.*s takes a number, not '%s'", (int)length, text,
                         text + length + 1);
    *name = hewn_alloc(length + 1, 1);
    if (!*name)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the arguments");
    snprintf(*name, length + 1, "%s", text);
    return HEWN_OK;
}
