#include "json_read.h"

#include <ctype.h>

#include "run.h"

/* Each skip_x() takes the place where an x should start and returns the one behind it, or NULL. */
static const char *skip_value(const char *at);

static const char *skip_blanks(const char *at)
{
    return at + strspn(at, " \t\r\n");
}

static const char *skip_string(const char *at)
{
    if (*at++ != '"')
        return NULL;
    for (; *at != '"'; at++) {
        if ((unsigned char)*at < 0x20)
            return NULL;
        if (*at != '\\')
            continue;
        at++;
        if (*at == 'u') {
            for (int i = 0; i < 4; i++)
                if (!isxdigit((unsigned char)*++at))
                    return NULL;
        } else if (!*at || !strchr("\"\\/bfnrt", *at)) {
            return NULL;
        }
    }
    return at + 1;
}

static const char *skip_digits(const char *at)
{
    return isdigit((unsigned char)*at) ? at + strspn(at, "0123456789") : NULL;
}

static const char *skip_number(const char *at)
{
    at += *at == '-';
    if (*at == '0' && isdigit((unsigned char)at[1]))
        return NULL;
    at = skip_digits(at);
    if (at && *at == '.')
        at = skip_digits(at + 1);
    if (at && (*at == 'e' || *at == 'E')) {
        at++;
        at = skip_digits(at + (*at == '+' || *at == '-'));
    }
    return at;
}

/* An object's member up to its value, which may be on the way in an array's place too. */
static const char *skip_name(const char *at)
{
    at = skip_string(at);
    if (!at)
        return NULL;
    at = skip_blanks(at);
    return *at == ':' ? skip_blanks(at + 1) : NULL;
}

static const char *skip_container(const char *at)
{
    bool object = *at == '{';
    char end = object ? '}' : ']';
    at = skip_blanks(at + 1);
    if (*at == end)
        return at + 1;
    for (;;) {
        if (object)
            at = skip_name(at);
        at = at ? skip_value(at) : NULL;
        if (!at)
            return NULL;
        at = skip_blanks(at);
        if (*at == end)
            return at + 1;
        if (*at != ',')
            return NULL;
        at = skip_blanks(at + 1);
    }
}

static const char *skip_value(const char *at)
{
    static const char *const words[] = {"true", "false", "null"};
    for (int i = 0; i < 3; i++)
        if (strncmp(at, words[i], strlen(words[i])) == 0)
            return at + strlen(words[i]);
    if (*at == '"')
        return skip_string(at);
    if (*at == '{' || *at == '[')
        return skip_container(at);
    return skip_number(at);
}

bool json_is_valid(const char *text)
{
    const char *end = skip_value(skip_blanks(text));
    return end && *skip_blanks(end) == '\0';
}

/* For text that is known to be valid. */
static const char *sure(const char *at)
{
    if (!at) {
        fail_msg("the JSON is not valid");
        abort(); /* tells readers and analysers that fail_msg() does not return */
    }
    return at;
}

/* The value of one member or element of the container at `at`. */
static const char *find_child(const char *at, const char *name, size_t length)
{
    bool object = *at == '{';
    if (!object && *at != '[')
        return NULL;
    size_t index = object ? 0 : strtoul(name, NULL, 10);
    at = skip_blanks(at + 1);
    for (size_t i = 0; *at != '}' && *at != ']'; i++) {
        bool found = !object && i == index;
        if (object) {
            found = strncmp(at + 1, name, length) == 0 && at[1 + length] == '"';
            at = sure(skip_name(at));
        }
        if (found)
            return at;
        at = skip_blanks(sure(skip_value(at)));
        if (*at == ',')
            at = skip_blanks(at + 1);
    }
    return NULL;
}

const char *json_find(const char *text, const char *path)
{
    const char *at = skip_blanks(text);
    while (at && *path) {
        size_t length = strcspn(path, ".");
        at = find_child(at, path, length);
        path += length;
        path += *path == '.';
    }
    return at;
}

static const char *demand(const char *text, const char *path)
{
    const char *at = json_find(text, path);
    if (!at)
        fail_msg("the JSON has no '%s': %s", path, text);
    return sure(at);
}

double json_number(const char *text, const char *path)
{
    const char *at = demand(text, path);
    if (*at != '-' && !isdigit((unsigned char)*at))
        fail_msg("'%s' is no number: %.20s", path, at);
    return strtod(at, NULL);
}

bool json_bool(const char *text, const char *path)
{
    const char *at = demand(text, path);
    if (*at != 't' && *at != 'f')
        fail_msg("'%s' is neither true nor false: %.20s", path, at);
    return *at == 't';
}

bool json_is_null(const char *text, const char *path)
{
    return *demand(text, path) == 'n';
}

size_t json_count(const char *text, const char *path)
{
    const char *at = demand(text, path);
    bool object = *at == '{';
    if (!object && *at != '[')
        fail_msg("'%s' is neither an object nor an array: %.20s", path, at);
    size_t count = 0;
    for (at = skip_blanks(at + 1); *at != '}' && *at != ']'; count++) {
        at = skip_blanks(sure(skip_value(object ? sure(skip_name(at)) : at)));
        if (*at == ',')
            at = skip_blanks(at + 1);
    }
    return count;
}

const char *json_string(const char *text, const char *path)
{
    static char string[1024];
    const char *at = demand(text, path);
    const char *end = skip_string(at);
    if (!end)
        fail_msg("'%s' is no string: %.20s", path, at);
    snprintf(string, sizeof string, "%.*s", (int)(end - at - 2), at + 1);
    return string;
}
