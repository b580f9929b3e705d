#include "app/smooth_arguments.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "app/number.h"
#include "base/error.h"

hewn_result hewn_smooth_method_parse(const char *text, const char *option, hewn_smooth_method *out, hewn_error *error)
{
    if (hewn_smooth_method_find(text, out))
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                     "%s is taubin, laplacian, cotan, implicit, bilateral or hc, not '%s'", option, text);
}

/* --- numbers ------------------------------------------------------------------------------------------------------ */

/* A number that only some methods have, one bit a method, and its range. */
typedef struct parameter {
    const char *name;
    double least, most; /* most 0: none */
    uint32_t methods;
    const char *whose;
    size_t offset; /* in hewn_smooth_desc */
} parameter;

#define OF(method) (1u << HEWN_SMOOTH_##method)

static const parameter parameters[] = {
    {"strength", 0, 1, OF(TAUBIN) | OF(LAPLACIAN), "taubin and laplacian", offsetof(hewn_smooth_desc, strength)},
    {"passband", 0, 2, OF(TAUBIN), "taubin", offsetof(hewn_smooth_desc, passband)},
    {"step", 0, 0, OF(COTAN) | OF(IMPLICIT), "cotan and implicit", offsetof(hewn_smooth_desc, step)},
    {"angle", 0, 180, OF(BILATERAL), "bilateral", offsetof(hewn_smooth_desc, angle)},
    {"radius", 0, 0, OF(BILATERAL), "bilateral", offsetof(hewn_smooth_desc, radius)},
};

/* `option` is how the user wrote it. */
static hewn_result read_parameter(const char *text, const char *option, const parameter *one, hewn_smooth_desc *desc,
                                  hewn_error *error)
{
    double value;
    HEWN_TRY(hewn_number_parse(text, option, &value, error));
    if (!(one->methods >> desc->method & 1))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is for %s, not for %s", option, one->whose,
                         hewn_smooth_method_name(desc->method));
    if (!(value > one->least))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s must be greater than 0, not %s", option, text);
    if (one->most > 0 && value > one->most)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is at most %g, not %s", option, one->most, text);
    memcpy((char *)desc + one->offset, &value, sizeof value);
    return HEWN_OK;
}

static hewn_result read_share(const char *text, const char *option, const hewn_smooth_desc *desc, double *out,
                              hewn_error *error)
{
    HEWN_TRY(hewn_number_parse(text, option, out, error));
    if (desc->method != HEWN_SMOOTH_HC)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is for hc, not for %s", option,
                         hewn_smooth_method_name(desc->method));
    return *out >= 0 && *out <= 1 ? HEWN_OK
                                  : hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is from 0 to 1, not %s", option, text);
}

static hewn_result read_remeasure(const char *text, const char *option, hewn_smooth_desc *desc, hewn_error *error)
{
    HEWN_TRY(hewn_count_parse(text, option, 1, &desc->remeasure, error));
    if (desc->method != HEWN_SMOOTH_COTAN && desc->method != HEWN_SMOOTH_IMPLICIT)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is for cotan and implicit, not for %s", option,
                         hewn_smooth_method_name(desc->method));
    return HEWN_OK;
}

/* One number by its name; `*known` tells whether there is one of that name. */
static hewn_result read_named(const char *name, const char *text, const char *option, hewn_smooth_desc *desc,
                              bool *known, hewn_error *error)
{
    *known = true;
    if (strcmp(name, "iterations") == 0)
        return hewn_count_parse(text, option, 1, &desc->iterations, error);
    if (strcmp(name, "remeasure") == 0)
        return read_remeasure(text, option, desc, error);
    if (strcmp(name, "original") == 0)
        return read_share(text, option, desc, &desc->original, error);
    if (strcmp(name, "push") == 0)
        return read_share(text, option, desc, &desc->push, error);
    for (size_t i = 0; i < sizeof parameters / sizeof *parameters; i++)
        if (strcmp(name, parameters[i].name) == 0)
            return read_parameter(text, option, &parameters[i], desc, error);
    *known = false;
    return HEWN_OK;
}

static hewn_result check_passband(const hewn_smooth_desc *desc, const char *option, hewn_error *error)
{
    double strength = desc->strength > 0 ? desc->strength : 0.5;
    if (desc->method == HEWN_SMOOTH_TAUBIN && desc->passband * strength >= 1)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s must be below %g with this strength, not %g", option,
                         1 / strength, desc->passband);
    return HEWN_OK;
}

static hewn_result read_parameters(const hewn_arguments *arguments, hewn_smooth_desc *desc, hewn_error *error)
{
    static const char *const names[] = {"iterations", "strength", "passband", "step", "remeasure",
                                        "angle",      "radius",   "original", "push"};
    desc->push = 0.5;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *text = hewn_arguments_value(arguments, names[i]);
        char option[32];
        bool known;
        snprintf(option, sizeof option, "--%s", names[i]);
        if (text)
            HEWN_TRY(read_named(names[i], text, option, desc, &known, error));
    }
    return check_passband(desc, "--passband", error);
}

/* --- locks -------------------------------------------------------------------------------------------------------- */

/* One of "boundary", "labels", "features:ANGLE". */
static hewn_result read_lock(const char *word, size_t length, const char *option, hewn_file_smooth *out,
                             hewn_error *error)
{
    static const char features[] = "features:";
    const size_t prefix = sizeof features - 1;
    char angle[32];
    if (length == 8 && memcmp(word, "boundary", 8) == 0) {
        out->desc.lock_boundary = true;
        return HEWN_OK;
    }
    if (length == 6 && memcmp(word, "labels", 6) == 0) {
        out->lock_labels = true;
        return HEWN_OK;
    }
    if (length > prefix && memcmp(word, features, prefix) == 0 && length - prefix < sizeof angle) {
        memcpy(angle, word + prefix, length - prefix);
        angle[length - prefix] = '\0';
        HEWN_TRY(hewn_number_parse(angle, option, &out->desc.lock_angle, error));
        if (out->desc.lock_angle > 0 && out->desc.lock_angle < 180)
            return HEWN_OK;
    }
    return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                     "%s takes boundary, labels and features:ANGLE (0 to 180 degrees), not '%.*s'", option, (int)length,
                     word);
}

static hewn_result read_locks(const hewn_arguments *arguments, hewn_file_smooth *out, hewn_error *error)
{
    const char *at = hewn_arguments_value(arguments, "lock");
    while (at) {
        size_t length = strcspn(at, ",");
        HEWN_TRY(read_lock(at, length, "--lock", out, error));
        at = at[length] ? at + length + 1 : NULL;
    }
    return HEWN_OK;
}

static hewn_result read_volume(const hewn_arguments *arguments, hewn_smooth_volume *out, hewn_error *error)
{
    bool keep = hewn_arguments_has(arguments, "keep-volume"), leave = hewn_arguments_has(arguments, "free-volume");
    if (keep && leave)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "either --keep-volume or --free-volume");
    *out = keep ? HEWN_SMOOTH_VOLUME_KEPT : leave ? HEWN_SMOOTH_VOLUME_FREE : HEWN_SMOOTH_VOLUME_DEFAULT;
    return HEWN_OK;
}

hewn_result hewn_smooth_arguments_read(const hewn_arguments *arguments, hewn_file_smooth *out, hewn_error *error)
{
    *out = (hewn_file_smooth){0};
    const char *method = hewn_arguments_value(arguments, "method");
    if (method)
        HEWN_TRY(hewn_smooth_method_parse(method, "--method", &out->desc.method, error));
    HEWN_TRY(read_parameters(arguments, &out->desc, error));
    HEWN_TRY(read_locks(arguments, out, error));
    HEWN_TRY(read_volume(arguments, &out->desc.volume, error));
    out->mask = hewn_arguments_value(arguments, "mask");
    return HEWN_OK;
}

/* --- METHOD:KEY=VALUE,... ----------------------------------------------------------------------------------------- */

static hewn_result read_pair(const char *key, const char *value, const char *option, hewn_file_smooth *out,
                             hewn_error *error)
{
    char shown[96];
    bool known;
    snprintf(shown, sizeof shown, "%s %s=", option, key);
    if (strcmp(key, "lock") == 0)
        return read_lock(value, strlen(value), shown, out, error);
    if (strcmp(key, "volume") == 0) {
        bool keep = strcmp(value, "keep") == 0;
        out->desc.volume = keep ? HEWN_SMOOTH_VOLUME_KEPT : HEWN_SMOOTH_VOLUME_FREE;
        return keep || strcmp(value, "free") == 0
                   ? HEWN_OK
                   : hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is keep or free, not '%s'", shown, value);
    }
    HEWN_TRY(read_named(key, value, shown, &out->desc, &known, error));
    return known ? HEWN_OK
                 : hewn_fail(error, HEWN_INVALID_ARGUMENT,
                             "%s knows iterations, strength, passband, step, angle, radius, original, push, volume and "
                             "lock, not '%s'",
                             option, key);
}

/* KEY=VALUE, `length` characters of it. */
static hewn_result split_pair(const char *at, size_t length, const char *option, hewn_file_smooth *out,
                              hewn_error *error)
{
    char key[32], value[64];
    const char *equals = memchr(at, '=', length);
    size_t key_length = equals ? (size_t)(equals - at) : length;
    size_t value_length = equals ? length - key_length - 1 : 0;
    if (!equals || key_length >= sizeof key || value_length >= sizeof value)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s takes METHOD:KEY=VALUE,KEY=VALUE, not '%.*s'", option,
                         (int)length, at);
    memcpy(key, at, key_length);
    key[key_length] = '\0';
    memcpy(value, equals + 1, value_length);
    value[value_length] = '\0';
    return read_pair(key, value, option, out, error);
}

hewn_result hewn_smooth_spec_parse(const char *text, const char *option, hewn_file_smooth *out, hewn_error *error)
{
    char method[32], passband[64];
    size_t length = strcspn(text, ":=");
    bool named = text[length] != '='; /* else it begins with a pair */
    const char *at = named ? text + length + (text[length] == ':') : text;
    *out = (hewn_file_smooth){.desc = {.push = 0.5}};
    if (named) {
        snprintf(method, sizeof method, "%.*s", (int)(length < 31 ? length : 31), text);
        HEWN_TRY(hewn_smooth_method_parse(method, option, &out->desc.method, error));
    }
    if (named && text[length] == ':' && !*at)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s takes METHOD:KEY=VALUE,KEY=VALUE, not '%s'", option, text);
    while (*at) {
        size_t end = strcspn(at, ",");
        HEWN_TRY(split_pair(at, end, option, out, error));
        at += end + (at[end] == ',');
    }
    snprintf(passband, sizeof passband, "%s passband=", option);
    return check_passband(&out->desc, passband, error);
}

/* --- what people see ---------------------------------------------------------------------------------------------- */

void hewn_smooth_print(const hewn_smooth_report *done, hewn_smooth_method method)
{
    fprintf(stderr, "  %s, %" PRIu32 " %s; vertices moved by %.4g in the mean, %.4g at most",
            hewn_smooth_method_name(method), done->iterations, done->iterations == 1 ? "iteration" : "iterations",
            done->mean_move, done->largest_move);
    if (done->locked_vertices > 0)
        fprintf(stderr, ", %" PRIu64 " stayed", done->locked_vertices);
    fprintf(stderr, "\n  volume %.6g -> %.6g, area %.6g -> %.6g\n", done->volume_before, done->volume_after,
            done->area_before, done->area_after);
    if (done->clamped_vertices > 0)
        fprintf(stderr,
                "hewn: note: the step was too long for %" PRIu64 " vertices, which went less far; "
                "--method implicit takes any\n",
                done->clamped_vertices);
}
