/* Reading JSON, as far as tests need it: the whole text must be valid, values are found by their path. */
#ifndef HEWN_TESTS_CLI_JSON_READ_H
#define HEWN_TESTS_CLI_JSON_READ_H

#include <stdbool.h>
#include <stddef.h>

/* Whether the text is one JSON value (RFC 8259) with nothing but blanks around it. */
bool json_is_valid(const char *text);

/* Where the value of "certificate.bounds.lo.0" starts: names of members and numbers of elements, joined by dots. NULL
 * where there is none. The text must be valid. */
const char *json_find(const char *text, const char *path);

/* These fail the test where there is no such value of the kind. */
double json_number(const char *text, const char *path);
bool json_bool(const char *text, const char *path);
bool json_is_null(const char *text, const char *path);
size_t json_count(const char *text, const char *path); /* elements or members */

/* The string without escapes being resolved, in a static buffer. */
const char *json_string(const char *text, const char *path);

#endif
