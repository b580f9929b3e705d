#include "app/scene_arguments.h"

#include <string.h>

#include "app/file_arguments.h"
#include "app/number.h"
#include "app/path_arguments.h"
#include "base/alloc.h"
#include "base/error.h"

/* A parameter that is set twice has the last value, as other options do. */
static void set(hewn_scene_arguments *scene, char *name, double value)
{
    for (size_t i = 0; i < scene->count; ++i) {
        if (strcmp(scene->names[i], name) == 0) {
            scene->settings[i].value = value;
            hewn_free(name);
            return;
        }
    }
    scene->names[scene->count] = name;
    scene->settings[scene->count++] = (hewn_scene_setting){.name = name, .value = value};
}

static hewn_result read_settings(const hewn_arguments *arguments, hewn_scene_arguments *scene, hewn_error *error)
{
    scene->settings = hewn_alloc_zero(arguments->given_count, sizeof *scene->settings);
    scene->names = hewn_alloc_zero(arguments->given_count, sizeof *scene->names);
    if (!scene->settings || !scene->names)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the arguments");
    for (size_t i = 0; i < arguments->given_count; ++i) {
        const hewn_given *given = &arguments->given[i];
        if (given->option->letter != 'D')
            continue;
        char *name;
        double value;
        HEWN_TRY(hewn_setting_parse(given->value, &name, &value, error));
        set(scene, name, value);
    }
    scene->desc.settings = scene->settings;
    scene->desc.setting_count = scene->count;
    return HEWN_OK;
}

static hewn_result read_operand(const hewn_arguments *arguments, hewn_scene_arguments *out, hewn_error *error)
{
    *out = (hewn_scene_arguments){0};
    if (arguments->operand_count == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "which file? Give its name");
    if (arguments->operand_count > 1)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "one file at a time, please; '%s' is one too many",
                         arguments->operands[1]);
    out->desc.path = arguments->operands[0];
    out->desc.reader = hewn_scene_reader_standard();
    return out->desc.path[0] ? HEWN_OK : hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file needs a name");
}

hewn_result hewn_scene_arguments_read(const hewn_arguments *arguments, hewn_scene_arguments *out, hewn_error *error)
{
    HEWN_TRY(read_operand(arguments, out, error));
    const char *format = hewn_arguments_value(arguments, "from");
    if (format && strcmp(format, "lua") != 0 && strcmp(format, "vm") != 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--from is lua or vm, not '%s'", format);
    if (format)
        out->desc.format = strcmp(format, "lua") == 0 ? HEWN_SCENE_LUA : HEWN_SCENE_VM;
    else if (strcmp(out->desc.path, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "standard input has no extension: say --from lua or --from vm");
    out->desc.allow_path = hewn_arguments_has(arguments, "allow-path");
    return read_settings(arguments, out, error);
}

hewn_result hewn_scene_arguments_read_mesh_too(const hewn_arguments *arguments, hewn_scene_arguments *out,
                                               hewn_mesh_format *mesh, hewn_error *error)
{
    const char *format = hewn_arguments_value(arguments, "from");
    *mesh = HEWN_MESH_UNKNOWN;
    if (!format || strcmp(format, "lua") == 0 || strcmp(format, "vm") == 0)
        return hewn_scene_arguments_read(arguments, out, error);
    HEWN_TRY(read_operand(arguments, out, error));
    return hewn_format_parse(format, "--from", mesh, error);
}

void hewn_scene_arguments_destroy(hewn_scene_arguments *scene)
{
    for (size_t i = 0; i < scene->count; ++i)
        hewn_free(scene->names[i]);
    hewn_free(scene->names);
    hewn_free(scene->settings);
    *scene = (hewn_scene_arguments){0};
}
