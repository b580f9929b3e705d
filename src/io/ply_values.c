#include "io/ply_values.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "io/bytes.h"

hewn_scalar hewn_ply_scalar_of(hewn_ply_type type)
{
    switch (type) {
    case HEWN_PLY_UINT8: return HEWN_SCALAR_UINT8;
    case HEWN_PLY_FLOAT: return HEWN_SCALAR_FLOAT;
    case HEWN_PLY_NONE:
    case HEWN_PLY_UINT32:
    case HEWN_PLY_DOUBLE: return HEWN_SCALAR_DOUBLE;
    case HEWN_PLY_INT8:
    case HEWN_PLY_INT16:
    case HEWN_PLY_UINT16:
    case HEWN_PLY_INT32: return HEWN_SCALAR_INT32;
    }
    return HEWN_SCALAR_DOUBLE;
}

/* --- binary ------------------------------------------------------------------------------------------------------- */

/* One loop for each pair of type and scalar, so that the choice is made once for a run. */
#define RUN(scalar_type, value)                                                                                        \
    for (size_t i = 0; i < count; i++, from += from_stride, to += to_stride) {                                         \
        scalar_type item = (scalar_type)(value);                                                                       \
        memcpy(to, &item, sizeof item);                                                                                \
    }                                                                                                                  \
    break

#define BOTH(scalar_type, value, value_big)                                                                            \
    if (run->big) {                                                                                                    \
        RUN(scalar_type, value_big);                                                                                   \
    }                                                                                                                  \
    RUN(scalar_type, value)

static void decode_to_double(const hewn_ply_run *run)
{
    const char *from = run->from;
    char *to = run->to;
    size_t count = run->count, from_stride = run->from_stride, to_stride = run->to_stride;
    switch (run->type) {
    case HEWN_PLY_NONE: break;
    case HEWN_PLY_INT8: RUN(double, (signed char)*from);
    case HEWN_PLY_UINT8: RUN(double, (unsigned char)*from);
    case HEWN_PLY_INT16: BOTH(double, (int16_t)hewn_get_u16(from), (int16_t)hewn_get_u16_big(from));
    case HEWN_PLY_UINT16: BOTH(double, hewn_get_u16(from), hewn_get_u16_big(from));
    case HEWN_PLY_INT32: BOTH(double, (int32_t)hewn_get_u32(from), (int32_t)hewn_get_u32_big(from));
    case HEWN_PLY_UINT32: BOTH(double, hewn_get_u32(from), hewn_get_u32_big(from));
    case HEWN_PLY_FLOAT: BOTH(double, hewn_get_float(from), hewn_get_float_big(from));
    case HEWN_PLY_DOUBLE: BOTH(double, hewn_get_double(from), hewn_get_double_big(from));
    }
}

static void decode_as_it_is(const hewn_ply_run *run)
{
    const char *from = run->from;
    char *to = run->to;
    size_t count = run->count, from_stride = run->from_stride, to_stride = run->to_stride;
    switch (run->type) {
    case HEWN_PLY_INT8: RUN(int32_t, (signed char)*from);
    case HEWN_PLY_UINT8: RUN(uint8_t, *from);
    case HEWN_PLY_INT16: BOTH(int32_t, (int16_t)hewn_get_u16(from), (int16_t)hewn_get_u16_big(from));
    case HEWN_PLY_UINT16: BOTH(int32_t, hewn_get_u16(from), hewn_get_u16_big(from));
    case HEWN_PLY_INT32:
    case HEWN_PLY_FLOAT: BOTH(uint32_t, hewn_get_u32(from), hewn_get_u32_big(from)); /* the bits alone */
    case HEWN_PLY_NONE:
    case HEWN_PLY_UINT32:
    case HEWN_PLY_DOUBLE: break;
    }
}

void hewn_ply_decode(const hewn_ply_run *run)
{
    if (run->scalar == HEWN_SCALAR_DOUBLE)
        decode_to_double(run);
    else
        decode_as_it_is(run);
}

/* --- text --------------------------------------------------------------------------------------------------------- */

static hewn_result read_whole(hewn_scan *scan, hewn_word word, hewn_ply_type type, double *out, hewn_error *error)
{
    static const struct {
        int64_t least, most;
        const char *name;
    } ranges[] = {[HEWN_PLY_INT8] = {INT8_MIN, INT8_MAX, "char"},     [HEWN_PLY_UINT8] = {0, UINT8_MAX, "uchar"},
                  [HEWN_PLY_INT16] = {INT16_MIN, INT16_MAX, "short"}, [HEWN_PLY_UINT16] = {0, UINT16_MAX, "ushort"},
                  [HEWN_PLY_INT32] = {INT32_MIN, INT32_MAX, "int"},   [HEWN_PLY_UINT32] = {0, UINT32_MAX, "uint"}};
    int64_t whole;
    if (!hewn_word_integer(word, &whole))
        return hewn_scan_fail(scan, word, "a whole number is expected", error);
    if (whole < ranges[type].least || whole > ranges[type].most)
        return hewn_fail_at(error, HEWN_BAD_INPUT, scan->name, scan->line, "%lld is no value of type %s",
                            (long long)whole, ranges[type].name);
    *out = (double)whole;
    return HEWN_OK;
}

hewn_result hewn_ply_read_word(hewn_scan *scan, hewn_ply_type type, double *out, hewn_error *error)
{
    hewn_word word = hewn_scan_word(scan);
    float single;
    bool good;
    *out = 0;
    if (type < HEWN_PLY_FLOAT)
        return read_whole(scan, word, type, out, error);
    if (type == HEWN_PLY_FLOAT) { /* straight to float: rounding twice could miss the nearest one */
        good = hewn_word_float(word, &single);
        *out = good ? (double)single : 0;
    } else {
        good = hewn_word_double(word, out);
    }
    return good ? HEWN_OK : hewn_scan_fail(scan, word, "a number is expected", error);
}

void hewn_ply_store(double value, hewn_scalar scalar, char *to)
{
    union {
        double real;
        float single;
        int32_t whole;
        uint8_t byte;
    } item;
    switch (scalar) {
    case HEWN_SCALAR_DOUBLE: item.real = value; break;
    case HEWN_SCALAR_FLOAT: item.single = (float)value; break;
    case HEWN_SCALAR_INT32: item.whole = (int32_t)value; break;
    case HEWN_SCALAR_UINT8: item.byte = (uint8_t)value; break;
    }
    memcpy(to, &item, hewn_scalar_size(scalar));
}
