#include "base/json.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"

hewn_json hewn_json_begin(hewn_text *text)
{
    return (hewn_json){.text = text, .depth = 0, .first = true};
}

static void break_line(hewn_json *json)
{
    hewn_text_append(json->text, "\n");
    for (int level = 0; level < json->depth; level++)
        hewn_text_append(json->text, "  ");
}

static void quote(hewn_text *text, const char *string)
{
    const unsigned char *at = (const unsigned char *)string;
    hewn_text_append(text, "\"");
    while (*at) {
        uint32_t value;
        size_t length = hewn_utf8_next((const char *)at, SIZE_MAX, &value);
        if (length == 0) {
            hewn_text_append(text, "\xef\xbf\xbd");
            at++;
            continue;
        }
        if (*at == '"' || *at == '\\')
            hewn_text_print(text, "\\%c", *at);
        else if (*at == '\n')
            hewn_text_append(text, "\\n");
        else if (*at == '\t')
            hewn_text_append(text, "\\t");
        else if (*at < 0x20 || *at == 0x7f)
            hewn_text_print(text, "\\u%04x", *at);
        else
            hewn_text_append_bytes(text, (const char *)at, length);
        at += length;
    }
    hewn_text_append(text, "\"");
}

/* What stands before a value: comma, line break, key. Numbers and strings of an array share a line. */
static void introduce(hewn_json *json, const char *key, bool container)
{
    if (!json->first)
        hewn_text_append(json->text, ",");
    if (json->depth > 0 && (key || container))
        break_line(json);
    else if (!json->first)
        hewn_text_append(json->text, " ");
    if (key) {
        quote(json->text, key);
        hewn_text_append(json->text, ": ");
    }
    json->first = false;
}

static void open_container(hewn_json *json, const char *key, const char *bracket)
{
    introduce(json, key, true);
    hewn_text_append(json->text, bracket);
    json->depth++;
    json->first = true;
}

static void close_container(hewn_json *json, const char *bracket, bool own_line)
{
    json->depth--;
    if (!json->first && own_line)
        break_line(json);
    hewn_text_append(json->text, bracket);
    json->first = false;
    if (json->depth == 0)
        hewn_text_append(json->text, "\n");
}

void hewn_json_object(hewn_json *json, const char *key)
{
    open_container(json, key, "{");
}

void hewn_json_array(hewn_json *json, const char *key)
{
    open_container(json, key, "[");
}

void hewn_json_end_object(hewn_json *json)
{
    close_container(json, "}", true);
}

void hewn_json_end_array(hewn_json *json)
{
    const hewn_text *text = json->text;
    char last = text->length > 0 ? text->bytes[text->length - 1] : '\0';
    close_container(json, "]", last == '}' || last == ']');
}

void hewn_json_string(hewn_json *json, const char *key, const char *value)
{
    introduce(json, key, false);
    if (value)
        quote(json->text, value);
    else
        hewn_text_append(json->text, "null");
}

void hewn_json_bool(hewn_json *json, const char *key, bool value)
{
    introduce(json, key, false);
    hewn_text_append(json->text, value ? "true" : "false");
}

void hewn_json_integer(hewn_json *json, const char *key, int64_t value)
{
    introduce(json, key, false);
    hewn_text_print(json->text, "%" PRId64, value);
}

void hewn_json_unsigned(hewn_json *json, const char *key, uint64_t value)
{
    introduce(json, key, false);
    hewn_text_print(json->text, "%" PRIu64, value);
}

void hewn_json_number(hewn_json *json, const char *key, double value)
{
    introduce(json, key, false);
    if (!isfinite(value)) {
        hewn_text_append(json->text, "null");
        return;
    }
    char digits[48];
    for (int precision = 15; precision <= 17; precision++) {
        snprintf(digits, sizeof digits, "%.*g", precision, value);
        if (strtod(digits, NULL) == value)
            break;
    }
    /* The caller's locale may have another decimal mark, even one of several bytes. */
    char plain[48];
    size_t length = 0;
    for (const char *at = digits; *at; at++) {
        if (strchr("+-eE", *at) || isdigit((unsigned char)*at))
            plain[length++] = *at;
        else if (length == 0 || plain[length - 1] != '.')
            plain[length++] = '.';
    }
    hewn_text_append_bytes(json->text, plain, length);
}
