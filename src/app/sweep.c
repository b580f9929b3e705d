#include "app/sweep.h"

#include <stdio.h>
#include <string.h>

#include "app/number.h"
#include "base/alloc.h"
#include "base/error.h"

/* "FROM:TO:COUNT" after the name; `text` is the whole, for messages. */
static hewn_result read_range(const char *range, const char *text, hewn_sweep *out, hewn_error *error)
{
    char part[3][64];
    const char *at = range;
    for (int i = 0; i < 3; i++) {
        size_t length = strcspn(at, ":");
        bool last = at[length] == '\0';
        if (length == 0 || length >= sizeof part[i] || last != (i == 2))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--sweep is NAME=FROM:TO:COUNT, not '%s'", text);
        memcpy(part[i], at, length);
        part[i][length] = '\0';
        at += length + (last ? 0 : 1);
    }
    HEWN_TRY(hewn_number_parse(part[0], "--sweep's FROM", &out->from, error));
    HEWN_TRY(hewn_number_parse(part[1], "--sweep's TO", &out->to, error));
    HEWN_TRY(hewn_count_parse(part[2], "--sweep's COUNT", 1, &out->count, error));
    if (out->count > HEWN_SWEEP_MOST)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--sweep's COUNT is at most %d, not %s", (int)HEWN_SWEEP_MOST,
                         part[2]);
    return HEWN_OK;
}

static hewn_result copy_settings(const hewn_scene_arguments *scene, hewn_sweep *out, hewn_error *error)
{
    out->setting_count = scene->count + 1;
    out->settings = hewn_alloc_zero(out->setting_count, sizeof *out->settings);
    if (!out->settings)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the arguments");
    for (size_t i = 0; i < scene->count; i++) {
        out->settings[i] = scene->settings[i];
        if (strcmp(scene->settings[i].name, out->name) == 0)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "-D and --sweep both set %s", out->name);
    }
    out->settings[scene->count].name = out->name;
    return HEWN_OK;
}

hewn_result hewn_sweep_read(const hewn_arguments *arguments, const hewn_scene_arguments *scene, hewn_sweep *out,
                            hewn_error *error)
{
    const char *text = hewn_arguments_value(arguments, "sweep");
    *out = (hewn_sweep){0};
    if (!text)
        return HEWN_OK;
    const char *sign = strchr(text, '=');
    if (!sign || sign == text)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--sweep is NAME=FROM:TO:COUNT, not '%s'", text);
    if (scene->desc.path && strcmp(scene->desc.path, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--sweep runs the scene many times, so it cannot be standard input");
    out->name = hewn_alloc((size_t)(sign - text) + 1, 1);
    if (!out->name)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the arguments");
    memcpy(out->name, text, (size_t)(sign - text));
    out->name[sign - text] = '\0';
    HEWN_TRY(read_range(sign + 1, text, out, error));
    return copy_settings(scene, out, error);
}

void hewn_sweep_destroy(hewn_sweep *sweep)
{
    hewn_free(sweep->name);
    hewn_free(sweep->settings);
    *sweep = (hewn_sweep){0};
}

static double value_of(const hewn_sweep *sweep, uint32_t step)
{
    if (step == 0 || sweep->count == 1)
        return sweep->from;
    double part = (double)step / (sweep->count - 1);
    return step + 1 == sweep->count ? sweep->to : sweep->from * (1 - part) + sweep->to * part;
}

void hewn_sweep_set(hewn_sweep *sweep, uint32_t step, hewn_scene_desc *scene)
{
    sweep->settings[sweep->setting_count - 1].value = value_of(sweep, step);
    scene->settings = sweep->settings;
    scene->setting_count = sweep->setting_count;
}

char *hewn_sweep_path(const hewn_sweep *sweep, const char *path, uint32_t step)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    size_t stem = dot && dot != name ? (size_t)(dot - path) : strlen(path), room = strlen(path) + 16;
    char *out = hewn_alloc(room, 1);
    if (out)
        snprintf(out, room, "%.*s-%0*u%s", (int)stem, path,
                 sweep->count > 99999  ? 6
                 : sweep->count > 9999 ? 5
                                       : 4,
                 step + 1, path + stem);
    return out;
}

hewn_result hewn_sweep_blame(const hewn_sweep *sweep, uint32_t step, hewn_result result, hewn_error *error)
{
    char message[sizeof error->message];
    if (result == HEWN_OK || result == HEWN_CANCELLED)
        return result;
    snprintf(message, sizeof message, "%s", error->message);
    int length = snprintf(error->message, sizeof error->message, "step %u of %u (%.40s = %.9g): ", step + 1,
                          sweep->count, sweep->name, value_of(sweep, step));
    if (length > 0 && (size_t)length < sizeof error->message)
        snprintf(error->message + length, sizeof error->message - (size_t)length, "%.*s",
                 (int)(sizeof error->message - (size_t)length - 1), message);
    return result;
}
