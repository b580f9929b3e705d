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
    const char *name, *option;
    double least, most; /* most 0: none */
    uint32_t methods;
    const char *whose;
    size_t offset; /* in hewn_smooth_desc */
} parameter;

#define OF(method) (1u << HEWN_SMOOTH_##method)

static const parameter parameters[] = {
    {"strength", "--strength", 0, 1, OF(TAUBIN) | OF(LAPLACIAN), "taubin and laplacian",
     offsetof(hewn_smooth_desc, strength)},
    {"passband", "--passband", 0, 2, OF(TAUBIN), "taubin", offsetof(hewn_smooth_desc, passband)},
    {"step", "--step", 0, 0, OF(COTAN) | OF(IMPLICIT), "cotan and implicit", offsetof(hewn_smooth_desc, step)},
    {"angle", "--angle", 0, 180, OF(BILATERAL), "bilateral", offsetof(hewn_smooth_desc, angle)},
    {"radius", "--radius", 0, 0, OF(BILATERAL), "bilateral", offsetof(hewn_smooth_desc, radius)},
};

static hewn_result read_parameter(const hewn_arguments *arguments, const parameter *one, hewn_smooth_desc *desc,
                                  hewn_error *error)
{
    const char *text = hewn_arguments_value(arguments, one->name);
    double value;
    if (!text)
        return HEWN_OK;
    HEWN_TRY(hewn_number_parse(text, one->option, &value, error));
    if (!(one->methods >> desc->method & 1))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is for %s, not for %s", one->option, one->whose,
                         hewn_smooth_method_name(desc->method));
    if (!(value > one->least))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s must be greater than 0, not %s", one->option, text);
    if (one->most > 0 && value > one->most)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is at most %g, not %s", one->option, one->most, text);
    memcpy((char *)desc + one->offset, &value, sizeof value);
    return HEWN_OK;
}

static hewn_result read_share(const hewn_arguments *arguments, const char *name, const char *option,
                              const hewn_smooth_desc *desc, double *out, hewn_error *error)
{
    const char *text = hewn_arguments_value(arguments, name);
    if (!text)
        return HEWN_OK;
    HEWN_TRY(hewn_number_parse(text, option, out, error));
    if (desc->method != HEWN_SMOOTH_HC)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is for hc, not for %s", option,
                         hewn_smooth_method_name(desc->method));
    return *out >= 0 && *out <= 1 ? HEWN_OK
                                  : hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is from 0 to 1, not %s", option, text);
}

static hewn_result read_parameters(const hewn_arguments *arguments, hewn_smooth_desc *desc, hewn_error *error)
{
    const char *iterations = hewn_arguments_value(arguments, "iterations");
    if (iterations)
        HEWN_TRY(hewn_count_parse(iterations, "--iterations", 1, &desc->iterations, error));
    for (size_t i = 0; i < sizeof parameters / sizeof *parameters; i++)
        HEWN_TRY(read_parameter(arguments, &parameters[i], desc, error));
    desc->push = 0.5;
    HEWN_TRY(read_share(arguments, "original", "--original", desc, &desc->original, error));
    HEWN_TRY(read_share(arguments, "push", "--push", desc, &desc->push, error));
    double strength = desc->strength > 0 ? desc->strength : 0.5;
    if (desc->method == HEWN_SMOOTH_TAUBIN && desc->passband * strength >= 1)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--passband must be below %g with this strength, not %g",
                         1 / strength, desc->passband);
    return HEWN_OK;
}

/* --- locks -------------------------------------------------------------------------------------------------------- */

/* One of "boundary", "labels", "features:ANGLE". */
static hewn_result read_lock(const char *word, size_t length, hewn_file_smooth *out, hewn_error *error)
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
        HEWN_TRY(hewn_number_parse(angle, "--lock features:", &out->desc.lock_angle, error));
        if (out->desc.lock_angle > 0 && out->desc.lock_angle < 180)
            return HEWN_OK;
    }
    return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                     "--lock takes boundary, labels and features:ANGLE (0 to 180 degrees), not '%.*s'", (int)length,
                     word);
}

static hewn_result read_locks(const hewn_arguments *arguments, hewn_file_smooth *out, hewn_error *error)
{
    const char *at = hewn_arguments_value(arguments, "lock");
    while (at) {
        size_t length = strcspn(at, ",");
        HEWN_TRY(read_lock(at, length, out, error));
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

/* --- what people see ---------------------------------------------------------------------------------------------- */

void hewn_smooth_print(const hewn_file_report *report)
{
    const hewn_smooth_report *done = &report->smooth;
    fprintf(stderr, "  %s, %" PRIu32 " %s; vertices moved by %.4g in the mean, %.4g at most",
            hewn_smooth_method_name(report->smooth_method), done->iterations,
            done->iterations == 1 ? "iteration" : "iterations", done->mean_move, done->largest_move);
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
