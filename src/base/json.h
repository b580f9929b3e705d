/* Writing JSON into a hewn_text: commas and quoting are kept right here, nesting is the caller's. */
#ifndef HEWN_SRC_BASE_JSON_H
#define HEWN_SRC_BASE_JSON_H

#include "base/text.h"

typedef struct hewn_json {
    hewn_text *text;
    int depth;
    bool first; /* nothing yet at this level */
} hewn_json;

hewn_json hewn_json_begin(hewn_text *text);

/* In an object pass the key; in an array, or at the top, pass NULL. */
void hewn_json_object(hewn_json *json, const char *key);
void hewn_json_array(hewn_json *json, const char *key);
void hewn_json_end_object(hewn_json *json);
void hewn_json_end_array(hewn_json *json);

void hewn_json_string(hewn_json *json, const char *key, const char *value); /* NULL is null; bad UTF-8 becomes U+FFFD */
void hewn_json_bool(hewn_json *json, const char *key, bool value);
void hewn_json_integer(hewn_json *json, const char *key, int64_t value);
void hewn_json_unsigned(hewn_json *json, const char *key, uint64_t value);
void hewn_json_number(hewn_json *json, const char *key,
                      double value); /* shortest that reads back; NaN and infinities are null */

#endif
