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

hewn_result hewn_bytes_parse(const char *text, const char *option, uint64_t *out, hewn_error *error)
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

/* Numbers with commas between; `count` is how many there are, of which the first `most` are read. */
static hewn_result read_list(const char *text, const char *option, double *out, size_t most, size_t *count,
                             hewn_error *error)
{
    *count = 0;
    for (const char *at = text;; ++at) {
        size_t length = strcspn(at, ",");
        if (*count < most && !read_number(at, length, &out[*count]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s: '%.*s' is not a number", option, (int)length, at);
        ++*count;
        at += length;
        if (*at == '\0')
            return HEWN_OK;
    }
}

static hewn_result check_sides(const hewn_box *box, const char *option, hewn_error *error)
{
    for (int axis = 0; axis < 3; ++axis)
        if (!(box->lo[axis] < box->hi[axis]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s: %c0 must be less than %c1, but %g is not less than %g",
                             option, "xyz"[axis], "xyz"[axis], box -> lo[axis], box -> hi[axis]);
    return HEWN_OK;
}

hewn_result hewn_bounds_parse(const char *text, const char *option, hewn_box *out, hewn_error *error)
{
    double sides[6];
    size_t count;
    HEWN_TRY(read_list(text, option, sides, 6, &count, error));
    if (count != 6)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s takes six numbers, x0,y0,z0,x1,y1,z1, not %zu", option,
                         count);
    *out = (hewn_box){{sides[0], sides[1], sides[2]}, {sides[3], sides[4], sides[5]}};
    return check_sides(out, option, error);
}

hewn_result hewn_plane_bounds_parse(const char *text, const char *option, hewn_box *out, hewn_error *error)
{
    double sides[6];
    size_t count;
    HEWN_TRY(read_list(text, option, sides, 6, &count, error));
    if (count == 4)
        *out = (hewn_box){{sides[0], sides[1], 0}, {sides[2], sides[3], 1}};
    else if (count == 6 && sides[2] == sides[5])
        *out = (hewn_box){{sides[0], sides[1], sides[2]}, {sides[3], sides[4], sides[2] + fmax(1, fabs(sides[2]))}};
    else
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "%s takes four numbers, x0,y0,x1,y1, or six with one z, x0,y0,z,x1,y1,z; not '%s'", option,
                         text);
    return check_sides(out, option, error);
}

hewn_result hewn_triple_parse(const char **text, const char *option, double out[3], hewn_error *error)
{
    for (int axis = 0; axis < 3; ++axis) {
        size_t length = strcspn(*text, ",:/");
        if (!read_number(*text, length, &out[axis]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s: '%.*s' is not a number", option, (int)length, *text);
        *text += length;
        if (axis < 2 && **text != ',')
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s: a place is three numbers, x,y,z", option);
        *text += axis < 2;
    }
    return HEWN_OK;
}

hewn_result hewn_size_parse(const char *text, const char *option, uint32_t *width, uint32_t *height, hewn_error *error)
{
    double sides[2];
    size_t length = strcspn(text, "x");
    bool good = text[length] == 'x' && read_number(text, length, &sides[0]) &&
                read_number(text + length + 1, strlen(text + length + 1), &sides[1]);
    for (int i = 0; i < 2 && good; ++i)
        good = sides[i] >= 1 && sides[i] <= 1048576 && sides[i] == floor(sides[i]);
    if (!good)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is WIDTHxHEIGHT in whole numbers, not '%s'", option, text);
    *width = (uint32_t)sides[0];
    *height = (uint32_t)sides[1];
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
