/* Numbers to text and back, exactly and whatever the locale: the C++ library's charconv behind a C face. */
#ifndef HEWN_SRC_IO_SHIM_NUMBER_H
#define HEWN_SRC_IO_SHIM_NUMBER_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { HEWN_NUMBER_ROOM = 32 }; /* bytes that any number printed here fits in */

/* Writes the shortest text that reads back as the same number (finite), without a NUL, and returns its end. */
char *hewn_number_print_float(char *to, float value);
char *hewn_number_print_double(char *to, double value);
char *hewn_number_print_unsigned(char *to, uint64_t value);

/* Reads a number at `at` and returns what follows it, or NULL where there is none. "+1", ".5", "1.", "inf" and "nan"
 * are numbers; what is too large becomes infinite, what is too small 0. */
const char *hewn_number_parse_float(const char *at, const char *end, float *out);
const char *hewn_number_parse_double(const char *at, const char *end, double *out);
/* NULL also where it does not fit. */
const char *hewn_number_parse_integer(const char *at, const char *end, int64_t *out);

#ifdef __cplusplus
}
#endif
#endif
